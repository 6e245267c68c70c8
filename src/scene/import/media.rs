//! Media: read and kept, but not rendered.

use super::loader::Loader;
use super::xml::{ColourUse, ElementId, ElementKind, ElementReader};
use crate::math::Rgb;

/// What fills a volume, as the file has it. Nothing renders it.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// The plugin, such as `homogeneous`.
    pub plugin: String,
    /// Part of the light that is absorbed on each metre, for small parts, in 1/m.
    pub absorption: Rgb,
    /// Part of the light that is scattered on each metre, for small parts, in 1/m.
    pub scattering: Rgb,
    /// How it is scattered.
    pub phase: Phase,
}

/// How a medium scatters light.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Into all directions alike.
    Isotropic,
    /// Henyey and Greenstein's function.
    HenyeyGreenstein {
        /// Mean cosine of the angle by which light turns, between −1 and 1.
        mean_cosine: f32,
    },
    /// A plugin that is not known.
    Other(String),
}

impl Loader<'_> {
    /// Reads the media inside of an element, each once, and says at the first that none is rendered.
    pub(super) fn media_of(&mut self, reader: &mut ElementReader<'_>) {
        for medium in reader.children(ElementKind::Medium) {
            if self.media.iter().any(|(known, _)| *known == medium) {
                continue;
            }
            if self.media.is_empty() {
                let message = "media are not rendered; the space is taken as empty";
                self.problems.warning(self.location(medium), message);
            }
            let read = self.medium(medium);
            self.media.push((medium, read));
        }
    }

    fn medium(&self, id: ElementId) -> Medium {
        let mut reader = self.reader(id);
        let plugin = reader.plugin().to_owned();
        let phase = reader.child(ElementKind::Phase);
        let phase = phase.map_or(Phase::Isotropic, |phase| self.phase(phase));
        let (absorption, scattering) = if plugin == "homogeneous" {
            let coefficients = coefficients(&mut reader);
            reader.finish();
            coefficients
        } else {
            // What varies over space stands in volumes, which are not read.
            (Rgb::BLACK, Rgb::BLACK)
        };
        Medium {
            plugin,
            absorption,
            scattering,
            phase,
        }
    }

    fn phase(&self, id: ElementId) -> Phase {
        let mut reader = self.reader(id);
        let phase = match reader.plugin() {
            "isotropic" => Phase::Isotropic,
            "hg" => Phase::HenyeyGreenstein {
                mean_cosine: reader.float("g", 0.8),
            },
            other => return Phase::Other(other.to_owned()),
        };
        reader.finish();
        phase
    }
}

/// What a homogeneous medium absorbs and scatters, in 1/m.
fn coefficients(reader: &mut ElementReader<'_>) -> (Rgb, Rgb) {
    let scale = reader.float("scale", 1.0);
    let absorption = reader.colour("sigma_a", ColourUse::Index);
    let scattering = reader.colour("sigma_s", ColourUse::Index);
    let both = reader.colour("sigma_t", ColourUse::Index);
    let albedo = reader.colour("albedo", ColourUse::Reflectance);
    if absorption.is_some() || scattering.is_some() {
        let [absorption, scattering] =
            [absorption, scattering].map(|c| c.unwrap_or(Rgb::BLACK) * scale);
        return (absorption, scattering);
    }
    let both = both.unwrap_or(Rgb::WHITE) * scale;
    let scattering = both * albedo.unwrap_or(Rgb::grey(0.75));
    (Rgb(both.0 - scattering.0), scattering)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::import::{ImportOptions, import};

    #[test]
    fn media_are_kept_once_each_and_warned_of_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("scene.xml");
        let scene = "<scene version='3.0.0'><sensor type='perspective'/>
            <medium type='homogeneous' id='milk'><float name='sigma_t' value='4'/>
            <rgb name='albedo' value='0.5 0.75 1'/>
            <phase type='hg'><float name='g' value='0.6'/></phase></medium>
            <medium type='homogeneous' id='ink'><float name='sigmaA' value='2'/>
            <float name='scale' value='10'/></medium>
            <shape type='sphere'><ref id='milk' name='interior'/></shape>
            <shape type='cube'><ref id='ink' name='interior'/><ref id='milk' name='exterior'/></shape>
            <shape type='cube'><medium type='heterogeneous' name='interior'/></shape></scene>";
        std::fs::write(&file, scene).unwrap();
        let imported = import(&file, &ImportOptions::default()).unwrap();
        let [milk, ink, smoke] = imported.media.as_slice() else {
            panic!("{:?}", imported.media)
        };
        assert_eq!(milk.scattering, Rgb::new(2.0, 3.0, 4.0));
        assert_eq!(milk.absorption, Rgb::new(2.0, 1.0, 0.0));
        let phase = Phase::HenyeyGreenstein { mean_cosine: 0.6 };
        assert_eq!(milk.phase, phase);
        assert_eq!(
            (ink.absorption, ink.scattering),
            (Rgb::grey(20.0), Rgb::BLACK)
        );
        assert_eq!(
            (ink.phase.clone(), smoke.plugin.as_str()),
            (Phase::Isotropic, "heterogeneous")
        );
        let warnings: Vec<_> = imported.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(warnings[0].ends_with("media are not rendered; the space is taken as empty"));
    }
}
