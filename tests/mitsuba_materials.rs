//! Materials mean what they mean in Mitsuba.
//!
//! Provenance of the numbers: Mitsuba 3.9.1, variant `scalar_rgb`, `BSDF.eval` and `BSDF.sample`
//! with `TransportMode.Radiance`; for Diracs weight times probability.

mod composed;

use std::sync::Arc;

use lumiflow::bsdf::{
    Bsdf, BsdfError, BsdfModel, BumpMap, ComplexIor, Component, Conductor, Dielectric, Diffuse,
    Leaning, Mask, MicrofacetKind, Null, Plastic, RelativeIor, RoughConductor, RoughDielectric,
    RoughPlastic, Roughness, ThinDielectric, Transport, TwoSided,
};
use lumiflow::image::{self, Texels};
use lumiflow::math::{Mat3, Rgb, Vec3};
use lumiflow::texture::{self, Filter, Texture, Wrap};

use crate::support::materials::{direction, surface_point};

/// Our forms are the same and only rounding differs.
const ROUNDING: f32 = 2e-5;
/// Mitsuba has a fit for what smooth plastic's coat reflects of diffuse light.
const DIFFUSE_FIT: f32 = 2e-3;
/// Mitsuba tabulates rough plastic's transmittance at 64 cosines, we at 129.
const TABLE: f32 = 1e-3;
/// Mitsuba's masking of Beckmann is a rational approximation, 0.35 % off at most, for each
/// direction; ours is exact.
const BECKMANN_FIT: f32 = 7e-3;

const RED: Rgb = Rgb::new(0.9, 0.2, 0.1);
const PALE: Rgb = Rgb::new(0.5, 0.7, 0.9);
const GOLD: ComplexIor = ComplexIor {
    eta: Rgb::new(0.143, 0.375, 1.442),
    k: Rgb::new(3.983, 2.386, 1.603),
};

/// `wi` and `wo`, each as angle to the normal and azimuth in degrees.
const PAIRS: [[(f64, f64); 2]; 5] = [
    [(30.0, 20.0), (35.0, 200.0)],
    [(60.0, 110.0), (50.0, 280.0)],
    [(75.0, 0.0), (20.0, 90.0)],
    [(40.0, 0.0), (150.0, 180.0)],
    [(130.0, 50.0), (25.0, 220.0)],
];

fn check_values(bsdf: impl Into<Bsdf>, tolerance: f32, values: [[f32; 3]; 5]) {
    let bsdf = bsdf.into();
    let at = surface_point();
    for ([wi, wo], value) in PAIRS.into_iter().zip(values) {
        let (wi, wo) = (direction(wi.0, wi.1), direction(wo.0, wo.1));
        let found = bsdf.eval(wi, wo, &at, Transport::Radiance);
        let value = Rgb::from(value);
        let error = (found - value).0.abs();
        assert!(
            error.cmple(value.0 * tolerance).all(),
            "{bsdf:?} {wi:?} {wo:?}: {found:?}, not {value:?}"
        );
    }
}

/// Compares the coefficients of all components at 50° from above, then from below.
fn check_diracs(bsdf: impl Into<Bsdf>, values: [&[[f32; 3]]; 2]) {
    let bsdf = bsdf.into();
    let at = surface_point();
    for (angle, values) in [50.0, 130.0].into_iter().zip(values) {
        let wi = direction(angle, 20.0);
        let found: Vec<Rgb> = (0..bsdf.component_count())
            .filter_map(|c| bsdf.follow(wi, &at, Transport::Radiance, Component(c)))
            .map(|event| event.coefficient)
            .collect();
        assert_eq!(found.len(), values.len(), "{bsdf:?} {angle}: {found:?}");
        for (found, value) in found.iter().zip(values) {
            let error = (*found - Rgb::from(*value)).0.abs().max_element();
            assert!(
                error < ROUNDING,
                "{bsdf:?} {angle}: {found:?}, not {value:?}"
            );
        }
    }
}

fn ior(interior: f32, exterior: f32) -> Result<RelativeIor, BsdfError> {
    RelativeIor::new(interior, exterior)
}

#[test]
fn diffuse_and_what_wraps_it() -> Result<(), BsdfError> {
    let values = [
        [0.23467, 0.0521488, 0.0260744],
        [0.184145, 0.0409211, 0.0204606],
        [0.269202, 0.0598227, 0.0299113],
        [0.0; 3],
        [0.0; 3],
    ];
    check_values(Diffuse::new(RED), ROUNDING, values);
    check_values(TwoSided::new(Diffuse::new(RED), None)?, ROUNDING, values);
    let masked = values.map(|value| value.map(|channel| 0.3 * channel));
    check_values(Mask::new(0.3, Diffuse::new(RED)), ROUNDING, masked);
    Ok(())
}

#[test]
fn smooth_boundaries() -> Result<(), BsdfError> {
    check_diracs(
        Dielectric::new(ior(1.5, 1.0)?, 0.9, PALE),
        [
            &[[0.0518966; 3], [0.209408, 0.293172, 0.376935]],
            &[[0.9; 3]],
        ],
    );
    check_diracs(
        Dielectric::new(ior(1.0, 1.33)?, 1.0, 1.0),
        [&[[1.0; 3]], &[[0.0332499; 3], [0.546526; 3]]],
    );
    let pane: &[[f32; 3]] = &[[0.0981346; 3], [0.712769; 3]];
    check_diracs(ThinDielectric::new(ior(1.5, 1.0)?, 0.9, 0.8), [pane, pane]);
    check_diracs(
        Conductor::new(Some(GOLD), 0.9),
        [&[[0.868092, 0.721089, 0.308902]], &[]],
    );
    check_diracs(Conductor::new(None, 0.9), [&[[0.9; 3]], &[]]);
    check_diracs(
        Mask::new(0.3, Diffuse::new(RED)),
        [&[[0.7; 3]], &[[0.7; 3]]],
    );
    check_diracs(Null, [&[[1.0; 3]], &[[1.0; 3]]]);
    Ok(())
}

#[test]
fn plastic() -> Result<(), BsdfError> {
    let linear = Plastic::new(ior(1.5, 1.0)?, 0.8, RED, false);
    check_diracs(linear.clone(), [&[[0.0461304; 3]], &[]]);
    check_values(
        linear,
        DIFFUSE_FIT,
        [
            [0.237265, 0.0527255, 0.0263628],
            [0.174223, 0.0387161, 0.0193581],
            [0.212727, 0.0472728, 0.0236364],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    check_values(
        Plastic::new(ior(1.9, 1.0)?, 1.0, RED, true),
        DIFFUSE_FIT,
        [
            [0.168745, 0.0138382, 0.00634699],
            [0.122813, 0.0100714, 0.00461934],
            [0.150511, 0.0123429, 0.00566116],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    Ok(())
}

#[test]
fn rough_plastic() -> Result<(), BsdfError> {
    use MicrofacetKind::{Beckmann, Ggx};
    check_values(
        RoughPlastic::new(Ggx, 0.1, ior(1.5, 1.0)?, 1.0, RED, false),
        TABLE,
        [
            [0.48651, 0.321138, 0.297513],
            [0.258875, 0.138068, 0.12081],
            [0.198256, 0.0446181, 0.0226699],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    check_values(
        RoughPlastic::new(Ggx, 0.5, ior(1.5, 1.0)?, 1.0, RED, true),
        TABLE,
        [
            [0.134289, 0.0354554, 0.0247096],
            [0.112521, 0.0448617, 0.0375054],
            [0.117757, 0.0261215, 0.0161583],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    check_values(
        RoughPlastic::new(Beckmann, 0.3, ior(1.9, 1.0)?, 0.8, RED, true),
        BECKMANN_FIT,
        [
            [0.222054, 0.0929872, 0.0857036],
            [0.249098, 0.156165, 0.15092],
            [0.139129, 0.0134278, 0.00633411],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    Ok(())
}

#[test]
fn rough_metal() {
    use MicrofacetKind::{Beckmann, Ggx};
    check_values(
        RoughConductor::new(Roughness::isotropic(Ggx, 0.3), Some(GOLD), 0.9),
        ROUNDING,
        [
            [0.839259, 0.696288, 0.283926],
            [0.927262, 0.771755, 0.340199],
            [0.085266, 0.070738, 0.0290947],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    check_values(
        RoughConductor::new(Roughness::new(Ggx, 0.1, 0.5), Some(GOLD), 1.0),
        ROUNDING,
        [
            [1.29386, 1.07345, 0.437722],
            [0.279122, 0.232312, 0.102406],
            [0.00388763, 0.00322524, 0.00132655],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    check_values(
        RoughConductor::new(Roughness::isotropic(Beckmann, 0.3), Some(GOLD), 1.0),
        BECKMANN_FIT,
        [
            [0.969605, 0.804429, 0.328023],
            [1.38001, 1.14858, 0.506306],
            [0.00282589, 0.00234441, 0.000964259],
            [0.0; 3],
            [0.0; 3],
        ],
    );
}

#[test]
fn rough_glass() -> Result<(), BsdfError> {
    use MicrofacetKind::{Beckmann, Ggx};
    check_values(
        RoughDielectric::new(Roughness::isotropic(Ggx, 0.3), ior(1.5, 1.0)?, 0.9, PALE)?,
        ROUNDING,
        [
            [0.0366335; 3],
            [0.0662131; 3],
            [0.00392507; 3],
            [3.13618, 4.39066, 5.64513],
            [0.0312532, 0.0437545, 0.0562557],
        ],
    );
    check_values(
        RoughDielectric::new(Roughness::new(Ggx, 0.2, 0.5), ior(1.0, 1.33)?, 1.0, 1.0)?,
        ROUNDING,
        [
            [0.0234913; 3],
            [0.581438; 3],
            [0.00112403; 3],
            [0.0755466; 3],
            [0.897161; 3],
        ],
    );
    check_values(
        RoughDielectric::new(
            Roughness::isotropic(Beckmann, 0.3),
            ior(1.5, 1.0)?,
            1.0,
            1.0,
        )?,
        BECKMANN_FIT,
        [
            [0.0423231; 3],
            [0.0985427; 3],
            [0.000130085; 3],
            [8.60218; 3],
            [0.0; 3],
        ],
    );
    Ok(())
}

/// Bumps on the skew coordinates of [`surface_point`].
fn bumps() -> Texture {
    let heights = vec![0.1, 0.25, 0.4, 0.35, 0.8, 0.2];
    let image = image::Bitmap::new(3, 2, 1, Texels::Float(heights)).expect("3 × 2 heights");
    let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
    texture::Bitmap::new(Arc::new(image), filter, wrap, Mat3::IDENTITY).into()
}

/// With `flip_invalid_normals` off.
fn leaning(shadowing: bool) -> Leaning {
    Leaning {
        shadowing,
        turning: false,
    }
}

#[test]
fn bumps_of_finite_lobes() -> Result<(), BsdfError> {
    let values = [
        [0.280675, 0.0623721, 0.0311861],
        [0.1979, 0.0439777, 0.0219889],
        [0.0; 3],
        [0.0; 3],
        [0.0; 3],
    ];
    let red =
        |scale, shadowing| BumpMap::new(bumps(), scale, leaning(shadowing), Diffuse::new(RED));
    check_values(red(0.5, true), ROUNDING, values);
    check_values(TwoSided::new(red(0.5, true), None)?, ROUNDING, values);
    check_values(red(4.0, true), ROUNDING, [[0.0; 3]; 5]);
    check_values(
        red(0.5, false),
        ROUNDING,
        [
            [0.281704, 0.0626008, 0.0313004],
            [0.199987, 0.0444416, 0.0222208],
            [0.0; 3],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    let metal = RoughConductor::new(
        Roughness::new(MicrofacetKind::Ggx, 0.1, 0.5),
        Some(GOLD),
        1.0,
    );
    check_values(
        BumpMap::new(bumps(), 0.3, leaning(true), metal),
        ROUNDING,
        [
            [0.087548, 0.0726339, 0.029618],
            [0.651558, 0.542288, 0.239047],
            [0.00717935, 0.0059561, 0.00244975],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    let roughness = Roughness::isotropic(MicrofacetKind::Ggx, 0.3);
    let glass = RoughDielectric::new(roughness, ior(1.5, 1.0)?, 1.0, 1.0)?;
    check_values(
        BumpMap::new(bumps(), 0.3, leaning(true), glass),
        ROUNDING,
        [
            [0.0208111; 3],
            [0.0560726; 3],
            [0.00381059; 3],
            [1.65973; 3],
            [0.0610939; 3],
        ],
    );
    Ok(())
}

#[test]
fn bumps_seen_from_behind() -> Result<(), BsdfError> {
    let bump = |nested: Bsdf| BumpMap::new(bumps(), 0.5, leaning(true), nested);
    let red = || Bsdf::from(Diffuse::new(RED));
    let around = TwoSided::new(bump(red()), None)?;
    let inside = bump(TwoSided::new(red(), None)?.into());
    let (wi, wo) = (direction(130.0, 50.0), direction(150.0, 200.0));
    for (bsdf, value) in [
        (Bsdf::from(around), [0.283948, 0.0630997, 0.0315498]),
        (inside.into(), [0.160511, 0.0356692, 0.0178346]),
    ] {
        let found = bsdf.eval(wi, wo, &surface_point(), Transport::Radiance);
        let error = (found - Rgb::from(value)).0.abs().max_element();
        assert!(error < ROUNDING, "{found:?}, not {value:?}");
    }
    Ok(())
}

#[test]
fn bumpy_mirrors_and_glass() -> Result<(), BsdfError> {
    let bump = |nested: Bsdf| BumpMap::new(bumps(), 0.3, leaning(true), nested);
    let mirror = bump(Conductor::new(None, 1.0).into());
    check_diracs(mirror.clone(), [&[[0.883699; 3]], &[]]);
    let glass = bump(Dielectric::new(ior(1.5, 1.0)?, 1.0, 1.0).into());
    check_diracs(
        glass.clone(),
        [
            &[[0.11485; 3], [0.38652; 3]],
            &[[0.0766497; 3], [2.02094; 3]],
        ],
    );
    for (bsdf, angle, component, expected) in [
        (mirror, 50.0, 0, [-0.91547, -0.37961, 0.13348]),
        (glass.clone(), 50.0, 1, [-0.35347, -0.09866, -0.93023]),
        (glass.clone(), 130.0, 0, [-0.31910, -0.02108, -0.94749]),
        (glass, 130.0, 1, [-0.91064, -0.29132, 0.29303]),
    ] {
        let wi = direction(angle, 20.0);
        let (at, component) = (surface_point(), Component(component));
        let event = bsdf.follow(wi, &at, Transport::Radiance, component);
        let found = event.expect("the component exists").direction.0;
        let error = (found - Vec3::from_array(expected)).length();
        assert!(error < ROUNDING, "{found}, not {expected:?}");
    }
    Ok(())
}
