//! Disney's materials, mixtures, and normals from pictures.

use std::sync::Arc;

use lumiflow::bsdf::{
    Bsdf, BsdfError, BumpMap, Diffuse, Leaning, MicrofacetKind, Mixture, NormalMap, Principled,
    PrincipledParameters, PrincipledThin, PrincipledThinParameters, RelativeIor, RoughConductor,
    RoughDielectric, Roughness,
};
use lumiflow::image::{self, Texels};
use lumiflow::math::{Mat3, Rgb};
use lumiflow::texture::{self, Filter, Texture, Wrap};

use super::{RED, ROUNDING, bumps, check_values, ior, leaning};

const ORANGE: Rgb = Rgb::new(0.8, 0.3, 0.1);

fn plain(ior: RelativeIor) -> PrincipledParameters {
    PrincipledParameters::new(ORANGE, ior)
}

#[test]
fn principled_reflection() -> Result<(), BsdfError> {
    // The index that `specular` 0.7 stands for.
    let index = 2.0 / (1.0 - (0.08_f32 * 0.7).sqrt()) - 1.0;
    let cloth = PrincipledParameters {
        roughness: 0.8.into(),
        sheen: 0.6.into(),
        sheen_tint: 0.4.into(),
        flatness: 0.6.into(),
        ..plain(ior(index, 1.0)?)
    };
    check_values(
        Principled::new(cloth)?,
        ROUNDING,
        [
            [0.188401, 0.0781982, 0.0341173],
            [0.201614, 0.0916437, 0.0476555],
            [0.259367, 0.103433, 0.0410594],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    let paint = PrincipledParameters {
        roughness: 0.4.into(),
        anisotropic: 0.7.into(),
        metallic: 0.6.into(),
        spec_tint: 0.4.into(),
        clearcoat: 0.8.into(),
        clearcoat_gloss: 0.3.into(),
        ..plain(ior(1.5, 1.0)?)
    };
    check_values(
        Principled::new(paint)?,
        ROUNDING,
        [
            [1.77046, 0.719936, 0.299727],
            [1.39534, 0.574713, 0.246462],
            [0.13844, 0.0530474, 0.0188905],
            [0.0; 3],
            [0.0; 3],
        ],
    );
    Ok(())
}

#[test]
fn principled_transmission() -> Result<(), BsdfError> {
    let glass = PrincipledParameters {
        roughness: 0.6.into(),
        spec_trans: 0.7.into(),
        metallic: 0.2.into(),
        spec_tint: 0.3.into(),
        ..plain(ior(1.4, 1.0)?)
    };
    check_values(
        Principled::new(glass)?,
        ROUNDING,
        [
            [0.178156, 0.0738038, 0.032063],
            [0.207676, 0.0960409, 0.051387],
            [0.0835619, 0.0326756, 0.0123211],
            [4.70448, 2.8809, 1.66329],
            [0.0; 3],
        ],
    );
    Ok(())
}

/// For directions between which Mitsuba shows its rough glass.
#[test]
fn principled_thin() -> Result<(), BsdfError> {
    let plain = |ior: RelativeIor| PrincipledThinParameters::new(ORANGE, ior);
    let paper = PrincipledThinParameters {
        roughness: 0.6.into(),
        sheen: 0.6.into(),
        sheen_tint: 0.4.into(),
        flatness: 0.6.into(),
        diff_trans: 0.8.into(),
        ..plain(ior(1.5, 1.0)?)
    };
    check_values(
        PrincipledThin::new(paper),
        ROUNDING,
        [
            [0.105807, 0.0396882, 0.0132405],
            [0.107168, 0.0413502, 0.0150229],
            [0.145588, 0.0546492, 0.0182738],
            [0.0882126, 0.0330797, 0.0110266],
            [0.0923158, 0.0346184, 0.0115395],
        ],
    );
    let pane = PrincipledThinParameters {
        anisotropic: 0.6.into(),
        spec_trans: 0.8.into(),
        spec_tint: 0.3.into(),
        diff_trans: 1.5.into(),
        ..plain(ior(1.4, 1.0)?)
    };
    check_values(
        PrincipledThin::new(pane),
        ROUNDING,
        [
            [0.0522173, 0.0339344, 0.0266213],
            [0.0849171, 0.0659576, 0.0583737],
            [0.0169026, 0.00797162, 0.00439922],
            [4.32305, 1.62114, 0.540381],
            [0.0851791, 0.0319422, 0.0106474],
        ],
    );
    Ok(())
}

fn metal() -> RoughConductor {
    let roughness = Roughness::isotropic(MicrofacetKind::Ggx, 0.3);
    RoughConductor::new(roughness, None, 0.9)
}

#[test]
fn blends() -> Result<(), BsdfError> {
    let values = [
        [0.424821, 0.297056, 0.278804],
        [0.417589, 0.317333, 0.30301],
        [0.214922, 0.068356, 0.0474181],
        [0.0; 3],
        [0.0; 3],
    ];
    check_values(
        Mixture::blend(0.3, Diffuse::new(RED), metal()),
        ROUNDING,
        values,
    );
    let parts = [(0.7, Bsdf::from(Diffuse::new(RED))), (0.3, metal().into())];
    check_values(Mixture::new(parts)?, ROUNDING, values);
    Ok(())
}

fn normals() -> Texture {
    let colours = vec![
        0.5, 0.5, 1.0, 0.8, 0.4, 0.9, 0.3, 0.7, 0.8, 0.6, 0.2, 0.9, 0.45, 0.65, 0.95, 0.7, 0.7, 0.8,
    ];
    let image = image::Bitmap::new(3, 2, 3, Texels::Float(colours)).expect("3 × 2 colours");
    let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
    texture::Bitmap::new(Arc::new(image), filter, wrap, Mat3::IDENTITY).into()
}

#[test]
fn normals_from_pictures() {
    let check = |shadowing, nested: Bsdf, values: [[f32; 3]; 3]| {
        let [a, b, c] = values;
        let bsdf = NormalMap::new(normals(), leaning(shadowing), nested);
        check_values(bsdf, 5e-5, [a, b, c, [0.0; 3], [0.0; 3]]);
    };
    let diffuse = || Bsdf::from(Diffuse::new(RED));
    check(
        false,
        diffuse(),
        [
            [0.223008, 0.0495574, 0.0247787],
            [0.235996, 0.0524435, 0.0262217],
            [0.233855, 0.0519677, 0.0259838],
        ],
    );
    check(
        true,
        diffuse(),
        [
            [0.222727, 0.0494948, 0.0247474],
            [0.235137, 0.0522526, 0.0261263],
            [0.233775, 0.0519499, 0.025975],
        ],
    );
    let grey = |value: f32| [value; 3];
    let without = [0.284868, 0.400017, 0.0636044].map(grey);
    check(false, metal().into(), without);
    let with = [0.284509, 0.398562, 0.0635827].map(grey);
    check(true, metal().into(), with);
}

/// As Mitsuba 3 does by default: with `flip_invalid_normals`.
#[test]
fn normals_that_turn_to_the_eye() -> Result<(), BsdfError> {
    let turning = Leaning {
        shadowing: true,
        turning: true,
    };
    let red = |scale| BumpMap::new(bumps(), scale, turning, Diffuse::new(RED));
    let none = [0.0; 3];
    check_values(
        red(0.5),
        ROUNDING,
        [
            [0.280675, 0.0623721, 0.0311861],
            [0.1979, 0.0439777, 0.0219889],
            [0.26369, 0.0585977, 0.0292988],
            none,
            none,
        ],
    );
    let steep = [none, none, [0.111864, 0.0248587, 0.0124294], none, none];
    check_values(red(4.0), ROUNDING, steep);
    let roughness = Roughness::isotropic(MicrofacetKind::Ggx, 0.3);
    let glass = RoughDielectric::new(roughness, ior(1.5, 1.0)?, 1.0, 1.0)?;
    let values = [0.0, 0.0, 0.0018992, 0.130298, 0.608375].map(|value| [value; 3]);
    check_values(BumpMap::new(bumps(), 4.0, turning, glass), 5e-5, values);
    Ok(())
}
