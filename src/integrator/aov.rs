//! Layers that describe the first surface that a pixel sees.

use super::pixel::PixelSettings;
use crate::bsdf::BsdfModel;
use crate::emitter::SceneBounds;
use crate::film::{Canvas, Layer, Unit};
use crate::math::{Vec2, Vec3};
use crate::scene::{Interaction, Scene};

/// What a layer says about the first surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Share of light that the material scatters.
    Albedo,
    /// Shading normal, in world space.
    ShadingNormal,
    /// Normal of the true geometry, in world space.
    GeometricNormal,
    /// Distance from the camera, in m.
    Depth,
    /// World-space position, in m.
    Position,
    /// Texture coordinates.
    Uv,
}

/// The value of a layer at one camera sample.
enum AovValue {
    One(f32),
    Two(Vec2),
    Three(Vec3),
}

impl Aov {
    /// All layers, with their names.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("albedo", Self::Albedo),
        ("sh_normal", Self::ShadingNormal),
        ("geo_normal", Self::GeometricNormal),
        ("depth", Self::Depth),
        ("position", Self::Position),
        ("uv", Self::Uv),
    ];

    /// The layer of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES
            .into_iter()
            .find(|(candidate, _)| *candidate == name)
            .map(|(_, aov)| aov)
    }

    /// Name and channels.
    pub fn layer(self) -> Layer {
        let name = Self::NAMES
            .into_iter()
            .find(|(_, aov)| *aov == self)
            .map_or("", |(n, _)| n);
        let channels = match self {
            Self::Albedo => "RGB",
            Self::ShadingNormal | Self::GeometricNormal | Self::Position => "XYZ",
            Self::Depth => "Z",
            Self::Uv => "UV",
        };
        Layer::new(name, channels)
    }

    /// The fixed-point unit: lengths go by the size of the scene.
    pub(super) fn unit(self, bounds: SceneBounds) -> Unit {
        let reach = f64::from(bounds.radius) + f64::from(bounds.centre.length());
        match self {
            Self::Depth | Self::Position => Unit::for_magnitude(reach),
            _ => Unit::for_magnitude(1.0),
        }
    }

    /// The value at the first surface; zero where there is none.
    fn value(self, scene: &Scene, first: Option<&Interaction<'_>>) -> AovValue {
        let vector =
            |of: fn(&Interaction<'_>) -> Vec3| AovValue::Three(first.map_or(Vec3::ZERO, of));
        match self {
            Self::Albedo => vector(|i| i.bsdf.albedo(&i.point).0),
            Self::ShadingNormal => vector(|i| i.point.shading_normal),
            Self::GeometricNormal => vector(|i| i.point.geometric_normal),
            Self::Position => vector(|i| i.point.position),
            Self::Depth => AovValue::One(first.map_or(0.0, |i| i.distance)),
            Self::Uv => AovValue::Two(first.map_or(Vec2::ZERO, |i| scene.coordinates(i))),
        }
    }
}

/// Adds one camera sample to all layers about the first surface.
///
/// - `layers`: the buffers of [`PixelSettings::aovs`], in their order.
pub(super) fn add_all(
    settings: &PixelSettings,
    scene: &Scene,
    first: Option<&Interaction<'_>>,
    raster: Vec2,
    layers: &[impl Canvas],
) {
    let filter = &settings.filter;
    for (aov, layer) in settings.aovs.iter().zip(layers) {
        match aov.value(scene, first) {
            AovValue::One(value) => layer.add(filter, raster, [value]),
            AovValue::Two(value) => layer.add(filter, raster, value.to_array()),
            AovValue::Three(value) => layer.add(filter, raster, value.to_array()),
        }
    }
}
