//! Complex refractive indices of named metals and crystals, as linear Rec.709 triples.
//!
//! Measured values, read off Mitsuba 3.9.1 (variant `scalar_rgb`) by loading a `conductor` with each
//! material name and printing its parameters `eta` and `k`. Three numbers stand for a whole curve:
//! the price of rendering in RGB.

use crate::math::Rgb;

/// The index of refraction η and the absorption k of a named material.
///
/// Letter case is ignored, and a name ending in `_palik` means the same as without it where both
/// come from one measurement. `none` is the perfect mirror (η = 0, k = 1).
///
/// Returns (η, k), unitless, or `None` for an unknown name.
pub fn conductor(name: &str) -> Option<(Rgb, Rgb)> {
    let find = |wanted: &str| {
        let row = CONDUCTORS
            .iter()
            .find(|row| row.0.eq_ignore_ascii_case(wanted))?;
        Some((Rgb::from(row.1), Rgb::from(row.2)))
    };
    let short = name.len().checked_sub("_palik".len()).and_then(|end| {
        let (stem, tail) = (name.get(..end)?, name.get(end..)?);
        tail.eq_ignore_ascii_case("_palik").then_some(stem)
    });
    find(name).or_else(|| find(short?))
}

/// All names that [`conductor`] knows, for "did you mean".
pub fn conductor_names() -> impl Iterator<Item = &'static str> {
    CONDUCTORS.iter().map(|row| row.0)
}

/// (name, η, k)
type Row = (&'static str, [f32; 3], [f32; 3]);

#[rustfmt::skip]
const CONDUCTORS: &[Row] = &[
    ("a-C", [2.94405, 2.22714, 1.96816], [0.887465, 0.799299, 0.81529]),
    ("Ag", [0.155276, 0.116728, 0.138388], [4.82835, 3.12222, 2.1469]),
    ("Al", [1.6575, 0.880405, 0.521244], [9.22381, 6.2695, 4.837]),
    ("AlAs", [3.6053, 3.23294, 2.21632], [0.000679437, 0.0, 0.00751271]),
    ("AlSb", [0.0, 4.13937, 4.66925], [0.0, 0.0940091, 1.30057]),
    ("Au", [0.143036, 0.375307, 1.44205], [3.983, 2.38556, 1.60336]),
    ("Be", [4.18501, 3.18503, 2.78406], [3.83547, 3.01012, 2.86899]),
    ("Cr", [4.36967, 2.91651, 1.6549], [5.20655, 4.23131, 3.7547]),
    ("CsI", [2.1449, 1.70232, 1.66243], [0.0, 0.0, 0.0]),
    ("Cu", [0.201005, 0.92375, 1.10222], [3.91326, 2.45305, 2.14209]),
    ("Cu2O", [3.55177, 2.94987, 2.75188], [0.114207, 0.193897, 0.606134]),
    ("Cu_palik", [0.213229, 0.919715, 1.10241], [3.92187, 2.45733, 2.13658]),
    ("CuO", [3.24754, 2.44781, 2.21022], [0.52109, 0.570031, 0.722179]),
    ("d-C", [2.70872, 2.31883, 2.2289], [0.0, 0.0, 0.0]),
    ("Hg", [2.39894, 1.44003, 0.90957], [6.32759, 4.37192, 3.42176]),
    ("HgTe", [4.77904, 3.2312, 2.6599], [1.63161, 1.58081, 1.72929]),
    ("Ir", [3.0863, 2.08219, 1.61791], [5.59215, 4.06709, 3.26731]),
    ("K", [0.0640432, 0.0464098, 0.0381849], [2.1042, 1.34894, 0.913126]),
    ("Li", [0.265791, 0.195618, 0.220949], [3.54015, 2.31112, 1.66861]),
    ("MgO", [2.08958, 1.65072, 1.59488], [0.0, 0.0, 0.0]),
    ("Mo", [4.48397, 3.52513, 2.77631], [4.11144, 3.42083, 3.15061]),
    ("Na_palik", [0.0602694, 0.0561409, 0.0619884], [3.17927, 2.11249, 1.57904]),
    ("Nb", [3.42007, 2.79009, 2.39563], [3.44139, 2.73767, 2.57975]),
    ("Ni_palik", [2.3673, 1.66337, 1.46708], [4.49881, 3.05015, 2.34544]),
    ("Rh", [2.58579, 1.86022, 1.55426], [6.78226, 4.70299, 3.97607]),
    ("Se", [4.05831, 2.84294, 2.82085], [0.75405, 0.638444, 0.521808]),
    ("Se-e", [5.72285, 4.16574, 4.08134], [0.871136, 1.10516, 1.56532]),
    ("SiC", [3.17234, 2.52597, 2.47937], [7.538e-7, 0.0, 1.01925e-5]),
    ("SnTe", [4.52425, 1.98164, 1.28159], [0.0, 0.0, 0.0]),
    ("Ta", [2.06272, 2.39294, 2.62793], [2.40836, 1.74149, 1.94703]),
    ("Te", [7.39023, 4.4821, 2.63711], [3.25602, 3.52706, 3.29205]),
    ("Te-e", [7.50891, 4.29643, 2.36999], [5.58393, 4.94721, 3.99759]),
    ("ThF4", [1.83071, 1.44223, 1.38765], [0.0, 0.0, 0.0]),
    ("TiC", [3.70053, 2.83742, 2.58229], [3.26564, 2.35159, 2.17279]),
    ("TiN", [1.64845, 1.15052, 1.37982], [3.36833, 1.9435, 1.10207]),
    ("TiO2", [3.45661, 2.80174, 2.90517], [0.000105265, 0.0, 0.000652887]),
    ("TiO2-e", [3.10656, 2.51317, 2.58244], [2.97516e-5, 0.0, 0.000182698]),
    ("V_palik", [4.27758, 3.51295, 2.76107], [3.4913, 2.88945, 3.11152]),
    ("VC", [3.65757, 2.75274, 2.53267], [3.0683, 2.19869, 1.96319]),
    ("VN", [2.8656, 2.11919, 1.94009], [3.03224, 2.05612, 1.61631]),
    ("W", [4.37082, 3.30025, 2.99841], [3.50064, 2.60487, 2.27323]),
    ("none", [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gold_is_found_under_any_case() {
        let (eta, k) = conductor("Au").unwrap();
        assert_eq!(eta, Rgb::new(0.143036, 0.375307, 1.44205));
        assert_eq!(k, Rgb::new(3.983, 2.38556, 1.60336));
        assert_eq!(conductor("au"), conductor("Au"));
        assert_eq!(conductor("none"), Some((Rgb::BLACK, Rgb::WHITE)));
        assert_eq!(conductor("Unobtainium"), None);
    }

    #[test]
    fn palik_names_fall_back_to_the_plain_ones() {
        assert_eq!(conductor("W_palik"), conductor("W"));
        assert_ne!(conductor("Cu_palik"), conductor("Cu"));
        assert_eq!(conductor("é_palik"), None);
        assert_eq!(conductor("ééé"), None);
    }

    #[test]
    fn every_row_is_physical_and_named_once() {
        for (index, (name, eta, k)) in CONDUCTORS.iter().enumerate() {
            assert!(
                eta.iter().chain(k).all(|v| v.is_finite() && *v >= 0.0),
                "{name}"
            );
            let twin = CONDUCTORS[..index]
                .iter()
                .find(|row| row.0.eq_ignore_ascii_case(name));
            assert!(twin.is_none(), "{name} stands twice");
        }
        assert_eq!(conductor_names().count(), CONDUCTORS.len());
    }
}
