//! Planted errors, which prove that the tests of the bidirectional mutation can fail.

/// What is wrong with the density of a move. Builds without debug assertions know no faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SectionFault {
    /// Nothing.
    #[default]
    None,
    /// The chance of taking out these vertices does not count.
    Deletion,
    /// The chance of putting in so many does not count.
    Addition,
    /// Ways with two vertices or more from the light are not counted.
    OneWay,
    /// No density of directions that are sampled from the eye's side.
    Forward,
    /// No solid angle for each area at connections.
    Connection,
    /// No pixels for each area at connections to the lens.
    Lens,
    /// No density of sampled points of lights.
    Explicit,
    /// No density of sampled rays of light.
    Emission,
    /// No cosine where the light's side is connected.
    Cosine,
    /// No cosines, or their part of Dirac events, along the light's side.
    Factor,
}

impl SectionFault {
    /// All faults.
    pub const ALL: [Self; 10] = [
        Self::Deletion,
        Self::Addition,
        Self::OneWay,
        Self::Forward,
        Self::Connection,
        Self::Lens,
        Self::Explicit,
        Self::Emission,
        Self::Cosine,
        Self::Factor,
    ];

    /// True when this is the fault, in a build that knows faults.
    #[inline(always)]
    pub(super) fn is(self, fault: Self) -> bool {
        cfg!(debug_assertions) && self == fault
    }

    /// A factor, or one where leaving it out is the fault.
    #[inline(always)]
    pub(super) fn keep(self, fault: Self, factor: f64) -> f64 {
        if self.is(fault) { 1.0 } else { factor }
    }
}
