//! Lights that are no surfaces.

mod daylight;

use super::loader::Loader;
use super::xml::{ColourSource, ColourUse, ElementId, ElementReader};
use crate::emitter::{
    Beam, Collimated, Constant, Directional, Emitter, EmitterClass, EmitterError, EmitterModel,
    Envmap, Point, Projector, Spot,
};
use crate::math::{Rgb, Transform, Vec2, Vec3};
use crate::sensor::PerspectiveSettings;
use crate::texture::{Texture, TextureModel};

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 11] = [
    "area",
    "collimated",
    "constant",
    "directional",
    "envmap",
    "point",
    "projector",
    "sky",
    "spot",
    "sun",
    "sunsky",
];

impl Loader<'_> {
    /// Builds a light and adds it to the scene; what cannot be built is noted.
    pub(super) fn emitter(&mut self, id: ElementId) {
        let mut reader = self.reader(id);
        reader.ignore(&["sampling_weight"]);
        let built: Option<Emitter> = match reader.plugin() {
            "point" => Some(self.point(&mut reader).into()),
            "spot" => self.spot(&mut reader),
            "directional" => self.directional(&mut reader),
            "constant" => {
                let radiance = reader.colour("radiance", ColourUse::Emission);
                Some(Constant::new(radiance.unwrap_or(Rgb::WHITE)).into())
            }
            "envmap" => self.envmap(&mut reader),
            "projector" => self.projector(&mut reader),
            "collimated" => collimated(&mut reader),
            "area" => {
                self.problems
                    .error(self.location(id), "emitter \"area\" belongs into a shape");
                None
            }
            "sky" | "sun" | "sunsky" => self.daylight(&mut reader),
            _ => {
                self.unknown_plugin(id, KNOWN, "left out");
                return;
            }
        };
        reader.finish();
        if let Some(emitter) = built {
            self.add_emitter(id, emitter);
        }
    }

    /// Adds a light to the scene, unless it is a second environment.
    fn add_emitter(&mut self, id: ElementId, emitter: Emitter) {
        if emitter.class() == EmitterClass::Environment {
            if let Some(first) = self.environment {
                let first = self.location(first);
                let message = format!("a second environment: the first stands at {first}");
                self.problems
                    .unsupported(self.location(id), message, "left out");
                return;
            }
            self.environment = Some(id);
        }
        self.builder.add_emitter(emitter);
    }

    /// Radiance of the area light inside a shape.
    pub(super) fn area_radiance(&mut self, id: ElementId) -> Option<Texture> {
        let mut reader = self.reader(id);
        if reader.plugin() != "area" {
            self.unknown_plugin(id, ["area"], "left out");
            return None;
        }
        reader.ignore(&["sampling_weight"]);
        let radiance = match reader.texture("radiance", ColourUse::Emission) {
            Some(ColourSource::Constant(colour)) => Some(colour.into()),
            Some(ColourSource::Texture(texture)) => self.luminous(texture),
            None => Some(1.0.into()),
        };
        reader.finish();
        radiance
    }

    /// A texture of light: negative values are clamped, with a warning.
    fn luminous(&mut self, id: ElementId) -> Option<Texture> {
        let texture = self.texture(id)?;
        let Some(clamped) = texture.without_negatives() else {
            return Some(texture);
        };
        let message = "some values of this light's texture are negative; clamped";
        self.problems.warning(self.location(id), message);
        Some(clamped)
    }

    fn point(&self, reader: &mut ElementReader<'_>) -> Point {
        let to_world = reader.transform("to_world");
        let place = reader.vector3("position").unwrap_or(Vec3::ZERO);
        let intensity = reader
            .colour("intensity", ColourUse::Emission)
            .unwrap_or(Rgb::WHITE);
        Point::new(to_world.point(place), intensity)
    }

    fn spot(&mut self, reader: &mut ElementReader<'_>) -> Option<Emitter> {
        let to_world = reader.transform("to_world");
        let intensity = reader
            .colour("intensity", ColourUse::Emission)
            .unwrap_or(Rgb::WHITE);
        let cutoff = reader.float("cutoff_angle", 20.0);
        let beam = reader.float("beam_width", cutoff * 0.75);
        let texture = match reader.texture("texture", ColourUse::Reflectance) {
            Some(ColourSource::Texture(texture)) => self.luminous(texture),
            Some(ColourSource::Constant(colour)) => Some(colour.into()),
            None => None,
        };
        let beam = Beam {
            cutoff: cutoff.to_radians(),
            full: beam.to_radians(),
        };
        noted(
            reader,
            "cutoff_angle",
            Spot::new(to_world.matrix(), intensity, beam, texture),
        )
    }

    fn projector(&mut self, reader: &mut ElementReader<'_>) -> Option<Emitter> {
        let to_world = reader.transform("to_world");
        let scale = reader.float("scale", 1.0);
        let (degrees, axis) = self.field_of_view(reader);
        let slide: Texture = match reader.texture("irradiance", ColourUse::Emission) {
            Some(ColourSource::Texture(texture)) => self.luminous(texture)?,
            Some(ColourSource::Constant(colour)) => colour.into(),
            None => 1.0.into(),
        };
        let size = match &slide {
            Texture::Bitmap(bitmap) => bitmap.size(),
            _ => Vec2::ONE,
        };
        if !(degrees > 0.0 && degrees < 180.0) {
            let expected = "expected more than 0 and less than 180";
            reader.error(
                "fov",
                format!("the field of view is {degrees} degrees, {expected}"),
            );
            return None;
        }
        let half_extent = PerspectiveSettings::half_extent(degrees, axis, size);
        let built = Projector::new(to_world.matrix(), slide, scale, half_extent);
        noted(reader, "scale", built)
    }

    fn directional(&self, reader: &mut ElementReader<'_>) -> Option<Emitter> {
        let to_world = reader.transform("to_world");
        let direction = reader.vector3("direction");
        let irradiance = reader
            .colour("irradiance", ColourUse::Emission)
            .unwrap_or(Rgb::WHITE);
        let world = to_world.vector(direction.unwrap_or(Vec3::Z));
        noted(reader, "direction", Directional::new(world, irradiance))
    }

    fn envmap(&mut self, reader: &mut ElementReader<'_>) -> Option<Emitter> {
        let to_world: Transform = reader.transform("to_world");
        let scale = reader.float("scale", 1.0);
        reader.ignore(&["mis_compensation"]);
        let file = reader.file("filename")?;
        let location = reader.element().location.clone();
        let bitmap = self.read_bitmap(&file, &location)?;
        noted(
            reader,
            "filename",
            Envmap::new(bitmap, to_world.matrix(), scale),
        )
    }
}

/// Notes why an emitter's numbers make no emitter.
fn noted<E: Into<Emitter>>(
    reader: &ElementReader<'_>,
    property: &str,
    built: Result<E, EmitterError>,
) -> Option<Emitter> {
    built
        .map(E::into)
        .map_err(|error| reader.error(property, error.to_string()))
        .ok()
}

/// A beam without width. Its flux is called `power`; `irradiance`, as of parallel light, means the same.
fn collimated(reader: &mut ElementReader<'_>) -> Option<Emitter> {
    let to_world = reader.transform("to_world");
    let names = ["power", "irradiance"];
    let [power, irradiance] = names.map(|name| reader.colour(name, ColourUse::Emission));
    if power.is_some() && irradiance.is_some() {
        reader.error("irradiance", "\"power\" and \"irradiance\" are the same");
        return None;
    }
    let flux = power.or(irradiance).unwrap_or(Rgb::WHITE);
    noted(reader, "to_world", Collimated::new(to_world.matrix(), flux))
}
