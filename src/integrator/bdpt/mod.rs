//! Bidirectional path tracing, and light tracing alone.

mod layers;
mod render;

use super::Algorithm;
use super::path::depth_limit;
use super::pixel::PixelSettings;
use super::render::Integrator;
use crate::path::{Bidirectional, PathRules, Techniques, Weighing};
use crate::scene::Scene;
use crate::scene::options::{OptionError, OptionReader};
use crate::sensor::Sensor;
pub(super) use layers::OWN_LAYERS;
use render::BidirectionalRender;

/// Traces subpaths from the camera and from the lights, and weighs all ways in which they make a path.
///
/// Source: van Antwerpen 2011, Ch. 5.
#[derive(Clone, Copy, Debug)]
pub struct Bdpt {
    tracing: Bidirectional,
    rules: PathRules,
    /// Connections below this share of the mean luminance are made by Russian roulette.
    connection_roulette: f64,
    /// Most edges of paths whose techniques have layers of their own, where these are wanted.
    technique_edges: usize,
    /// Light subpaths alone make the image.
    light_only: bool,
}

impl Bdpt {
    /// Reads the options of bidirectional path tracing; the names of Mitsuba 0.6's element mean what they mean
    /// there.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let heuristic = super::heuristic(options)?;
        let power = options.float("mis_power", 0.1..=100.0, 2.0)?;
        Ok(Self {
            tracing: Bidirectional {
                weighing: Weighing::new(heuristic, power),
                techniques: Techniques {
                    light_image: options.boolean("light_image", true)?,
                    sample_direct: options.boolean("sample_direct", true)?,
                },
                ..tracing(options, 2)?
            },
            rules: rules(options)?,
            connection_roulette: options.float("connection_roulette", 0.0..=1e6, 0.0)?,
            technique_edges: options.integer("technique_edges", 1..=16, 5)? as usize,
            light_only: false,
        })
    }

    /// Reads the options of light tracing.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn light_tracing(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        Ok(Self {
            tracing: tracing(options, 5)?,
            rules: rules(options)?,
            connection_roulette: 0.0,
            technique_edges: 1,
            light_only: true,
        })
    }
}

/// Reads how far paths go.
///
/// - `rr_depth`: its default. Between two subpaths there are as many connections as pairs of vertices, so that
///   short ones serve best: `docs/bdpt.md`.
fn tracing(options: &mut OptionReader<'_>, rr_depth: i64) -> Result<Bidirectional, OptionError> {
    Ok(Bidirectional {
        max_depth: depth_limit(options.integer("max_depth", -1..=i64::MAX, -1)?),
        rr_depth: depth_limit(options.integer("rr_depth", 1..=i64::MAX, rr_depth)?),
        weighing: Weighing::Balance,
        techniques: Techniques {
            light_image: true,
            sample_direct: true,
        },
        connection_threshold: 0.0,
    })
}

/// Reads what counts as a path.
fn rules(options: &mut OptionReader<'_>) -> Result<PathRules, OptionError> {
    Ok(PathRules {
        hide_emitters: options.boolean("hide_emitters", false)?,
        strict_normals: options.boolean("strict_normals", false)?,
    })
}

impl Algorithm for Bdpt {
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's> {
        Box::new(BidirectionalRender::new(scene, sensor, self, settings))
    }

    fn has_second_moment(&self) -> bool {
        // What light subpaths show lands anywhere, and is no sample of a pixel.
        false
    }

    fn shows_traced_light(&self) -> bool {
        self.tracing.techniques.light_image
    }

    fn own_layers(&self) -> &'static [&'static str] {
        // Light tracing has one technique for each length.
        if self.light_only { &[] } else { OWN_LAYERS }
    }
}
