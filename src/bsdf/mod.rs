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

mod bump_map;
mod coat;
mod conductor;
mod conductor_presets;
mod dielectric;
mod diffuse;
mod error;
mod fresnel;
mod ior_presets;
mod mask;
mod microfacet;
mod null;
mod plastic;
mod quadrature;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod thin_dielectric;
mod two_sided;

pub use bump_map::BumpMap;
pub use conductor::Conductor;
pub use conductor_presets::{conductor, conductor_names};
pub use dielectric::Dielectric;
pub use diffuse::Diffuse;
pub use error::BsdfError;
pub use fresnel::{ComplexIor, Refraction, RelativeIor};
pub use ior_presets::{ior, ior_names};
pub use mask::Mask;
pub use microfacet::{MicrofacetKind, Microfacets, Roughness};
pub use null::Null;
pub use plastic::Plastic;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use thin_dielectric::ThinDielectric;
pub use two_sided::TwoSided;

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

/// The kind of a scattering event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Spread over the hemisphere.
    Diffuse,
    /// Concentrated, but with a density.
    Glossy,
    /// A Dirac: one direction only.
    Specular,
    /// A Dirac straight through, as if there were no surface.
    Null,
}

impl Lobe {
    /// True for lobes without a density.
    #[inline]
    pub fn is_dirac(self) -> bool {
        matches!(self, Self::Specular | Self::Null)
    }
}

/// Which lobes a model can have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LobeSet {
    /// Some lobe has a density: connecting to this surface makes sense.
    pub finite: bool,
    /// Some lobe is a Dirac.
    pub dirac: bool,
    /// Some lobe goes to the other side.
    pub transmission: bool,
    /// There is one lobe only, so that [`BsdfModel::sample`] makes no use of `u_lobe`.
    pub single: bool,
}

impl LobeSet {
    /// All lobes of either.
    pub fn union(self, other: Self) -> Self {
        Self {
            finite: self.finite || other.finite,
            dirac: self.dirac || other.dirac,
            transmission: self.transmission || other.transmission,
            single: self.single && other.single,
        }
    }
}

/// Index of a Dirac component among those of one model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Component(pub u8);

/// A scattering event that was sampled.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The sampled direction `wo`.
    pub direction: Local,
    /// `value / density`: what the path's throughput is multiplied by.
    pub weight: Rgb,
    /// For finite lobes: [`BsdfModel::eval`] at the direction. For Dirac lobes: the coefficient.
    pub value: Rgb,
    /// For finite lobes: density in 1/sr. For Dirac lobes: the probability of selecting the lobe.
    pub density: f32,
    /// Kind of the sampled lobe.
    pub lobe: Lobe,
    /// Which Dirac component; zero for finite lobes.
    pub component: Component,
    /// Index of refraction on `wi`'s side over that on `wo`'s side; 1 unless refracted.
    ///
    /// Radiance that comes back along the path is multiplied by its square, importance is not.
    /// That is no loss of energy, and Russian roulette must not take it for one.
    pub eta: f32,
}

impl BsdfSample {
    /// Makes the sample of a finite lobe; `None` when the direction cannot be sampled.
    #[inline]
    fn finite(
        direction: Local,
        value: Rgb,
        density: SolidAngleDensity,
        lobe: Lobe,
    ) -> Option<Self> {
        (density.0 > 0.0 && density.0.is_finite()).then(|| Self {
            direction,
            weight: value / density.0,
            value,
            density: density.0,
            lobe,
            component: Component(0),
            eta: 1.0,
        })
    }
}

/// A Dirac component followed from one direction.
#[derive(Clone, Copy, Debug)]
pub struct DiracEvent {
    /// The only direction `wo` that the component sends `wi` to.
    pub direction: Local,
    /// Coefficient of the Dirac, `|cos θ_o|` cancelled.
    pub coefficient: Rgb,
    /// Probability with which [`BsdfModel::sample`] selects the component.
    pub probability: f32,
    /// [`Lobe::Specular`] or [`Lobe::Null`].
    pub lobe: Lobe,
    /// As [`BsdfSample::eta`].
    pub eta: f32,
    /// `|cos θ_o| / |cos θ_i|` to the normal that the lobe is written around; 1 unless refracted.
    pub cosine_ratio: f32,
}

impl DiracEvent {
    /// Solid angle around `wi` for each solid angle around [`DiracEvent::direction`].
    ///
    /// Refraction keeps `n² |cos θ| dω`; everything else keeps `dω`.
    #[inline]
    pub fn inverse_stretch(&self) -> f32 {
        self.cosine_ratio / (self.eta * self.eta)
    }

    /// The sample that selected this event; `None` when it has no chance to be selected.
    #[inline]
    fn sampled(self, component: Component) -> Option<BsdfSample> {
        (self.probability > 0.0).then(|| BsdfSample {
            direction: self.direction,
            weight: self.coefficient / self.probability,
            value: self.coefficient,
            density: self.probability,
            lobe: self.lobe,
            component,
            eta: self.eta,
        })
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
    fn density(&self, wi: Local, wo: Local, at: &SurfacePoint) -> SolidAngleDensity;

    /// [`BsdfModel::eval`] and [`BsdfModel::density`] in one, where they share work.
    #[inline]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        (self.eval(wi, wo, at, transport), self.density(wi, wo, at))
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
            #[inline]
            fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
                match self { $(Self::$model(m) => m.eval(wi, wo, at, transport),)* }
            }
            #[inline]
            fn density(&self, wi: Local, wo: Local, at: &SurfacePoint) -> SolidAngleDensity {
                match self { $(Self::$model(m) => m.density(wi, wo, at),)* }
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
            fn albedo(&self, at: &SurfacePoint) -> Rgb {
                match self { $(Self::$model(m) => m.albedo(at),)* }
            }
        }
    };
}

bsdf_models! {
    /// Ideal diffuse reflection.
    Diffuse,
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
    /// A material on bumps.
    BumpMap,
    /// A material with holes.
    Mask,
    /// No surface.
    Null,
}
