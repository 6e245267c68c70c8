//! Samplers follow their densities: histograms of directions, Pearson's χ², level 0.01 for the
//! family.

use lumiflow::bsdf::{BsdfModel, Diffuse, MicrofacetKind, RoughConductor, Roughness, Transport};
use lumiflow::math::Local;
use lumiflow::math::statistics::sidak;
use lumiflow::random::{Purpose, Stream};

use crate::support::directions::direction_p;
use crate::support::effort::{level, seed};
use crate::support::faulty::{Fault, Faulty};
use crate::support::materials::{Case, cases, direction, numbers, surface_point};

/// Chance that `sampler`'s finite lobes have the density of `claim`.
fn material_p(
    sampler: &dyn BsdfModel,
    claim: &dyn BsdfModel,
    wi: Local,
    transport: Transport,
    stream: &mut Stream,
) -> f64 {
    let at = surface_point();
    let sample = |stream: &mut Stream| {
        let (u_lobe, u) = numbers(stream);
        let sample = sampler.sample(wi, &at, transport, u_lobe, u)?;
        (!sample.lobe.is_dirac()).then_some(sample.direction)
    };
    direction_p(stream, sample, |wo| {
        f64::from(claim.density(wi, wo, &at, transport).0)
    })
}

#[test]
fn materials_sample_what_their_densities_say() {
    let cases: Vec<Case> = cases(seed(11))
        .into_iter()
        .filter(|case| case.bsdf.lobes().finite)
        .collect();
    let level = sidak(level(0.01), cases.len());
    for mut case in cases {
        let bsdf = &case.bsdf;
        let p = material_p(bsdf, bsdf, case.wi, case.transport, &mut case.stream);
        assert!(p > level, "{}: p = {p:.2e}", case.name);
    }
}

#[test]
fn a_density_that_is_a_little_off_is_found() {
    let mut stream = Stream::new(seed(12), Purpose::Check, 0, 0);
    let wi = direction(30.0, 20.0);
    let diffuse = Diffuse::new(0.5);
    let faulty = Faulty {
        bsdf: diffuse.clone().into(),
        fault: Fault::Density,
    };
    let p = material_p(&diffuse, &faulty, wi, Transport::Radiance, &mut stream);
    assert!(p < 1e-6, "{p}");

    // A lobe that is as high as it should be, but 6 % too wide.
    for kind in [MicrofacetKind::Beckmann, MicrofacetKind::Ggx] {
        for alpha in [0.02, 0.3] {
            let metal = |alpha: f32| {
                let roughness = Roughness::new(kind, alpha, 0.5 * alpha);
                RoughConductor::new(roughness, None, 1.0)
            };
            let (right, wide) = (metal(alpha), metal(1.06 * alpha));
            for angle in [0.0, 30.0, 75.0] {
                let wi = direction(angle, 20.0);
                let p = material_p(&right, &wide, wi, Transport::Radiance, &mut stream);
                assert!(p < 1e-3, "{kind:?} {alpha} {angle}: {p}");
            }
        }
    }
}
