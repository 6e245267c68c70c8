//! Scattering at surfaces.
//!
//! The contract, for every model:
//! - Directions are [`Local`]: in the shading frame, unit, pointing away from the surface. `wi` is
//!   the known one, `wo` the one that is sampled or asked about.
//! - [`Transport`] says what is carried *along the path being built*: a path from the sensor carries
//!   radiance, `wo` then points to the light's side; a path from a light carries importance.
//! - [`BsdfModel::eval`] includes `|cos θ_o|` to the shading normal and is zero for Dirac lobes;
//!   [`BsdfModel::density`] is exactly the density of what [`BsdfModel::sample`] does with the
//!   finite lobes, the chance of not choosing a Dirac lobe included.
//! - A Dirac lobe has a coefficient and a selection probability, apart: the coefficient belongs to
//!   the integrand, the probability to the sampler.
//!
//! A new model is a file, a line in `bsdf_models!` and an arm in the importer. The tests pick it up
//! from its [`BsdfModel::examples`].

mod bend;
mod bent;
mod bump_map;
mod clearcoat;
mod coat;
mod coating;
mod conductor;
mod conductor_presets;
mod dielectric;
mod diffuse;
mod diffuse_lanes;
mod diffuse_transmitter;
mod disney;
mod error;
mod event;
mod fresnel;
mod inversion;
mod ior_presets;
mod mask;
mod matt;
mod microfacet;
mod mixture;
mod normal_map;
mod null;
mod phong;
mod plastic;
mod principled;
mod principled_parameters;
mod principled_thin;
mod quadrature;
mod rough_coat;
mod rough_coating;
mod rough_conductor;
mod rough_dielectric;
mod rough_diffuse;
mod rough_plastic;
mod sole_diffuse;
mod thin_dielectric;
mod tilt;
mod two_sided;
mod varnish;
mod ward;

pub use bend::Bend;
pub use bent::{Bent, Lean};
pub use bump_map::{BumpMap, Heights};
pub use coating::Coating;
pub use conductor::Conductor;
pub use conductor_presets::{conductor, conductor_names};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use diffuse_lanes::DiffuseLanes;
pub use diffuse_transmitter::DiffuseTransmitter;
pub use error::BsdfError;
pub use event::{BsdfSample, Component, DiracEvent, Lobe, LobeSet};
pub use fresnel::{ComplexIor, Refraction, RelativeIor};
pub use inversion::{SampleNumbers, Sampled, Spare};
pub use ior_presets::{ior, ior_names};
pub use mask::Mask;
pub use microfacet::{MicrofacetKind, Microfacets, Roughness};
pub use mixture::Mixture;
pub use normal_map::{NormalMap, Normals};
pub use null::Null;
pub use phong::Phong;
pub use plastic::Plastic;
pub use principled::Principled;
pub use principled_parameters::{PrincipledParameters, PrincipledThinParameters};
pub use principled_thin::PrincipledThin;
pub use rough_coating::RoughCoating;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_diffuse::RoughDiffuse;
pub use rough_plastic::RoughPlastic;
pub use sole_diffuse::SoleDiffuse;
pub use thin_dielectric::ThinDielectric;
pub use tilt::Leaning;
pub use two_sided::TwoSided;
pub use ward::{Ward, WardKind};

use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;

/// What a path carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance: the path was started at the sensor.
    Radiance,
    /// Importance: the path was started at a light.
    Importance,
}

impl Transport {
    /// That of the same path, built the other way round.
    #[inline]
    pub fn adjoint(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

/// What a material can answer; see the module's contract.
pub trait BsdfModel {
    /// Materials that stand for the model in tests and benchmarks: each feature, each limit.
    fn examples() -> Vec<Self>
    where
        Self: Sized;

    /// The lobes that this model has anywhere on its surface.
    fn lobes(&self) -> LobeSet;

    /// Samples a direction.
    ///
    /// - `u_lobe`, `u`: uniform in `[0, 1)`.
    ///
    /// `None` when nothing is scattered from `wi`, or the numbers hit a direction without value.
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample>;

    /// Value of the finite lobes times `|cos θ_o|`.
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb;

    /// Density with which [`BsdfModel::sample`] makes `wo` by a finite lobe.
    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity;

    /// [`BsdfModel::eval`] and [`BsdfModel::density`] in one, where they share work.
    #[inline]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        (
            self.eval(wi, wo, at, transport),
            self.density(wi, wo, at, transport),
        )
    }

    /// Follows one Dirac component; `None` where it does not exist for `wi`.
    ///
    /// Components are numbered from zero to [`BsdfModel::component_count`].
    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let _ = (wi, at, transport, component);
        None
    }

    /// Number of Dirac components.
    fn component_count(&self) -> u8 {
        0
    }

    /// Goes back from a direction or a component to the numbers that [`BsdfModel::sample`] makes it of.
    ///
    /// Several numbers can lead to one direction. Among them the result is drawn with the density that
    /// uniform numbers have, given what was sampled: of a sample of uniform numbers, and with a uniform
    /// `spare`, it is uniform again. `None` where nothing is sampled so.
    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers>;

    /// Share of light that is scattered, roughly: the `albedo` layer and nothing else uses it.
    fn albedo(&self, at: &SurfacePoint) -> Rgb;
}

/// Writes the enum of all materials and forwards [`BsdfModel`] to its variants.
///
/// Sampling and evaluating are inlined where paths ask for them, and of the variants only diffuse ones:
/// answers that pass through memory cost as much as making them. All others are `inline(never)`, or
/// the loop of a path would not fit into the processor.
macro_rules! bsdf_models {
    ($($(#[$doc:meta])* $model:ident,)*) => {
        /// Any material.
        #[derive(Clone, Debug)]
        pub enum Bsdf {
            $($(#[$doc])* $model($model),)*
        }

        $(impl From<$model> for Bsdf {
            fn from(model: $model) -> Self {
                Self::$model(model)
            }
        })*

        impl Bsdf {
            /// Name of the model, as the code spells it.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$model(_) => stringify!($model),)* }
            }

            /// [`BsdfModel::eval`], out of line.
            #[inline(never)]
            fn eval_apart(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
                match self { $(Self::$model(m) => m.eval(wi, wo, at, transport),)* }
            }
        }

        impl BsdfModel for Bsdf {
            /// The examples of all models.
            fn examples() -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend($model::examples().into_iter().map(Self::from));)*
                all
            }
            #[inline]
            fn lobes(&self) -> LobeSet {
                match self { $(Self::$model(m) => m.lobes(),)* }
            }
            #[inline(always)]
            fn sample(&self, wi: Local, at: &SurfacePoint, transport: Transport, u_lobe: f32, u: Vec2)
                -> Option<BsdfSample> {
                match self { $(Self::$model(m) => m.sample(wi, at, transport, u_lobe, u),)* }
            }
            #[inline(always)]
            fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
                match self {
                    Self::Diffuse(m) => m.eval(wi, wo, at, transport),
                    Self::TwoSided(m) => m.eval(wi, wo, at, transport),
                    other => other.eval_apart(wi, wo, at, transport),
                }
            }
            #[inline]
            fn density(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> SolidAngleDensity {
                match self { $(Self::$model(m) => m.density(wi, wo, at, transport),)* }
            }
            #[inline(always)]
            fn eval_with_density(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport)
                -> (Rgb, SolidAngleDensity) {
                match self { $(Self::$model(m) => m.eval_with_density(wi, wo, at, transport),)* }
            }
            #[inline]
            fn follow(&self, wi: Local, at: &SurfacePoint, transport: Transport, component: Component)
                -> Option<DiracEvent> {
                match self { $(Self::$model(m) => m.follow(wi, at, transport, component),)* }
            }
            fn component_count(&self) -> u8 {
                match self { $(Self::$model(m) => m.component_count(),)* }
            }
            fn invert(&self, wi: Local, sampled: Sampled, at: &SurfacePoint, transport: Transport, spare: Spare)
                -> Option<SampleNumbers> {
                match self { $(Self::$model(m) => m.invert(wi, sampled, at, transport, spare),)* }
            }
            fn albedo(&self, at: &SurfacePoint) -> Rgb {
                match self { $(Self::$model(m) => m.albedo(at),)* }
            }
        }
    };
}

bsdf_models! {
    /// Ideal diffuse reflection.
    Diffuse,
    /// Grooves with diffuse flanks.
    RoughDiffuse,
    /// Diffuse transmission.
    DiffuseTransmitter,
    /// A material for each side.
    TwoSided,
    /// A smooth boundary between transparent substances.
    Dielectric,
    /// A pane without thickness.
    ThinDielectric,
    /// A rough boundary between transparent substances.
    RoughDielectric,
    /// Smooth metal.
    Conductor,
    /// Rough metal.
    RoughConductor,
    /// A diffuse base under a smooth coat.
    Plastic,
    /// A diffuse base under a rough coat.
    RoughPlastic,
    /// A diffuse surface with Phong's highlight.
    Phong,
    /// A diffuse surface with Ward's highlight.
    Ward,
    /// Disney's material for bodies.
    Principled,
    /// Disney's material for thin things.
    PrincipledThin,
    /// A material under a smooth coat.
    Coating,
    /// A material under a rough coat.
    RoughCoating,
    /// A weighted sum of materials.
    Mixture,
    /// A material on bumps.
    BumpMap,
    /// A material with the normals of a texture.
    NormalMap,
    /// A material with holes.
    Mask,
    /// No surface.
    Null,
}
