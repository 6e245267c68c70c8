//! Why a mutation makes no proposal.

/// Why a mutation came to nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Rejection {
    /// A ray met nothing where the path needs a surface, or something where it needs nothing.
    Missed,
    /// A surface has no such event as the path has there.
    SignatureChanged,
    /// Something stands between two vertices that were to be connected.
    Occluded,
    /// The proposal is seen off the image, or not at all.
    OffImage,
    /// The proposal carries no light.
    Dark,
    /// The way back would need a larger step than the mutation makes there.
    NoWayBack,
}

impl Rejection {
    /// All reasons, with their names.
    pub const NAMES: [(Self, &'static str); 6] = [
        (Self::Missed, "missed"),
        (Self::SignatureChanged, "signature_changed"),
        (Self::Occluded, "occluded"),
        (Self::OffImage, "off_image"),
        (Self::Dark, "dark"),
        (Self::NoWayBack, "no_way_back"),
    ];

    /// Number of reasons.
    pub const COUNT: usize = Self::NAMES.len();
}
