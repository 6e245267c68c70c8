//! The kinds of objects a scene file holds, and which of them may stand inside which.

use std::fmt;

/// What an object of a scene file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// The whole scene.
    Scene,
    /// A surface.
    Shape,
    /// How a surface scatters light.
    Bsdf,
    /// A light (`luminaire` in version 0.4).
    Emitter,
    /// A camera (`camera` in version 0.4).
    Sensor,
    /// A rendering algorithm.
    Integrator,
    /// What the picture is recorded on.
    Film,
    /// A reconstruction filter.
    ReconstructionFilter,
    /// A source of sample points.
    Sampler,
    /// A quantity that varies over a surface.
    Texture,
    /// What fills a volume.
    Medium,
    /// How a medium scatters light.
    Phase,
    /// A quantity that varies over a volume.
    Volume,
    /// Scattering below a surface.
    Subsurface,
}

use ElementKind::{
    Bsdf, Emitter, Film, Integrator, Medium, Phase, ReconstructionFilter, Sampler, Scene, Sensor,
    Shape, Subsurface, Texture, Volume,
};

/// Tag and kind; the first tag of a kind is its name in messages.
const TAGS: &[(&str, ElementKind)] = &[
    ("scene", Scene),
    ("shape", Shape),
    ("bsdf", Bsdf),
    ("emitter", Emitter),
    ("luminaire", Emitter),
    ("sensor", Sensor),
    ("camera", Sensor),
    ("integrator", Integrator),
    ("film", Film),
    ("rfilter", ReconstructionFilter),
    ("sampler", Sampler),
    ("texture", Texture),
    ("medium", Medium),
    ("phase", Phase),
    ("volume", Volume),
    ("subsurface", Subsurface),
];

impl ElementKind {
    /// The kind that a lower-case XML tag stands for.
    pub(super) fn from_tag(tag: &str) -> Option<Self> {
        TAGS.iter().find(|row| row.0 == tag).map(|row| row.1)
    }

    /// All tags of objects.
    pub(super) fn tags() -> impl Iterator<Item = &'static str> {
        TAGS.iter().map(|row| row.0)
    }

    /// The name of the kind in messages: its XML tag.
    pub fn name(self) -> &'static str {
        TAGS.iter()
            .find(|row| row.1 == self)
            .map_or("object", |row| row.0)
    }

    /// The kinds that may stand inside an object of this kind.
    pub(super) fn allowed_children(self) -> &'static [Self] {
        match self {
            Scene => &[
                Shape,
                Bsdf,
                Emitter,
                Sensor,
                Integrator,
                Film,
                ReconstructionFilter,
                Sampler,
                Texture,
                Medium,
                Phase,
                Volume,
                Subsurface,
            ],
            Shape => &[
                Bsdf, Emitter, Sensor, Medium, Subsurface, Shape, Texture, Volume,
            ],
            Bsdf => &[Bsdf, Texture, Volume, Phase],
            Emitter => &[Texture, Medium, Shape],
            Sensor => &[Film, Sampler, Medium, Texture],
            Integrator => &[Integrator, Sampler, Texture],
            Film => &[ReconstructionFilter],
            Texture => &[Texture, Volume],
            Medium | Subsurface => &[Phase, Volume, Texture],
            Phase => &[Phase, Texture, Volume],
            Volume => &[Volume, Texture],
            Sampler | ReconstructionFilter => &[],
        }
    }
}

impl fmt::Display for ElementKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
