//! Indices of refraction of named gases, liquids and solids at optical wavelengths.
//!
//! Measured values, read off Mitsuba 3.9.1 (variant `scalar_rgb`) by loading a `dielectric` with each
//! name as its inner medium and vacuum as the outer one.

/// The index of refraction of a named transparent material, relative to vacuum.
///
/// Letter case is ignored. Returns `None` for an unknown name.
pub fn ior(name: &str) -> Option<f32> {
    IORS.iter()
        .find(|row| row.0.eq_ignore_ascii_case(name))
        .map(|row| row.1)
}

/// All names that [`ior`] knows, for "did you mean".
pub fn ior_names() -> impl Iterator<Item = &'static str> {
    IORS.iter().map(|row| row.0)
}

const IORS: &[(&str, f32)] = &[
    ("vacuum", 1.0),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("air", 1.000277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_materials_are_found_under_any_case() {
        assert_eq!(ior("bk7"), Some(1.5046));
        assert_eq!(ior("Water Ice"), Some(1.31));
        assert_eq!(ior("vacuum"), Some(1.0));
        assert_eq!(ior("watr"), None);
        assert!(ior_names().all(|name| ior(name).is_some_and(|value| (1.0..3.0).contains(&value))));
    }
}
