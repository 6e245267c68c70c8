//! What scattering events are: their kinds, and what is known of one.

use crate::math::{Local, Rgb, SolidAngleDensity};

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
    /// There is one lobe only, so that [`super::BsdfModel::sample`] makes no use of `u_lobe`.
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
    /// For finite lobes: [`super::BsdfModel::eval`] at the direction. For Dirac lobes: the coefficient.
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
    pub(super) fn finite(
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
pub struct DiracEvent<Direction = Local> {
    /// The only direction `wo` that the component sends `wi` to.
    pub direction: Direction,
    /// Coefficient of the Dirac, `|cos θ_o|` cancelled.
    pub coefficient: Rgb,
    /// Probability with which [`super::BsdfModel::sample`] selects the component.
    pub probability: f32,
    /// [`Lobe::Specular`] or [`Lobe::Null`].
    pub lobe: Lobe,
    /// As [`BsdfSample::eta`].
    pub eta: f32,
    /// `|cos θ_o| / |cos θ_i|` to the normal that the lobe is written around; 1 unless refracted.
    pub cosine_ratio: f32,
}

impl<Direction> DiracEvent<Direction> {
    /// Solid angle around `wi` for each solid angle around [`DiracEvent::direction`].
    ///
    /// Refraction keeps `n² |cos θ| dω`; everything else keeps `dω`.
    #[inline]
    pub fn inverse_stretch(&self) -> f32 {
        self.cosine_ratio / (self.eta * self.eta)
    }
}

impl DiracEvent {
    /// The sample that selected this event; `None` when it has no chance to be selected.
    #[inline]
    pub(super) fn sampled(self, component: Component) -> Option<BsdfSample> {
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
