//! What of a glTF file is out of its range: told once here, clamped where it is used.

use super::super::{Model, range};

impl Model<'_> {
    /// Warns of the numbers of materials and lights that are clamped.
    pub(super) fn note_ranges(&self, document: &gltf::Document) {
        for material in document.materials() {
            let index = material.index().unwrap_or_default();
            let title = title("material", index, material.name());
            self.note_material(&title, &material);
        }
        for light in document.lights().into_iter().flatten() {
            let title = title("light", light.index(), light.name());
            self.note(&title, "color", &light.color(), f32::INFINITY);
            self.note(&title, "intensity", &[light.intensity()], f32::INFINITY);
        }
    }

    fn note_material(&self, title: &str, material: &gltf::Material<'_>) {
        let pbr = material.pbr_metallic_roughness();
        self.note(title, "baseColorFactor", &pbr.base_color_factor(), 1.0);
        self.note(title, "metallicFactor", &[pbr.metallic_factor()], 1.0);
        self.note(title, "roughnessFactor", &[pbr.roughness_factor()], 1.0);
        let emission = material.emissive_factor();
        self.note(title, "emissiveFactor", &emission, f32::INFINITY);
        let strength = material.emissive_strength().unwrap_or(1.0);
        self.note(title, "emissiveStrength", &[strength], f32::INFINITY);
        if let Some(glass) = material.transmission() {
            let factor = glass.transmission_factor();
            self.note(title, "transmissionFactor", &[factor], 1.0);
        }
        if let Some(volume) = material.volume() {
            let thickness = volume.thickness_factor();
            self.note(title, "thicknessFactor", &[thickness], f32::INFINITY);
        }
        if let Some(ior) = material.ior().filter(|ior| *ior < 1.0) {
            let message = format!("{title}: ior is {ior}, which is below 1; clamped");
            self.problems.warning(&self.line(1), message);
        }
    }

    /// - `most`: the upper end of the range, which begins at 0.
    fn note(&self, title: &str, factor: &str, values: &[f32], most: f32) {
        if values.iter().all(|value| (0.0..=most).contains(value)) {
            return;
        }
        let values: Vec<String> = values.iter().map(f32::to_string).collect();
        let (values, range) = (values.join(", "), range(most));
        let message = format!("{title}: {factor} is {values}, {range}; clamped");
        self.problems.warning(&self.line(1), message);
    }
}

/// `material 2 ("paint")`.
fn title(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{kind} {index} ({name:?})"),
        None => format!("{kind} {index}"),
    }
}
