//! Readers of scene descriptions and meshes.
//!
//! [`import`] reads a Mitsuba scene file of any generation into an [`Imported`]: the scene, its
//! views, and what the file asks of the integrator. All problems of the file are reported at once.

pub mod mesh;
pub mod xml;

use std::collections::BTreeMap;

use super::Scene;
use super::options::Options;
use crate::film::{Filter, Window};
use crate::random::SamplerKind;
use crate::sensor::Sensor;
use xml::{Diagnostic, Location};

/// How to import a scene.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Definitions, search paths and strictness.
    pub read: xml::ReadOptions,
    /// Replaces width and height of every film, in pixels.
    pub film_size: Option<(u32, u32)>,
}

/// A scene file, imported.
#[derive(Debug)]
pub struct Imported {
    /// Everything that light can meet.
    pub scene: Scene,
    /// The sensors with their films, in the order of the file; at least one.
    pub views: Vec<View>,
    /// What the file asks of the integrator.
    pub integrator: IntegratorRequest,
    /// Warnings, in the order of the file.
    pub warnings: Vec<Diagnostic>,
    /// Hash of the file, all files that it uses, and the definitions from the command line.
    pub hash: u64,
}

/// A sensor with what it records on.
#[derive(Clone, Debug)]
pub struct View {
    /// The sensor.
    pub sensor: Sensor,
    /// Width and height of the full film, in pixels.
    pub film_size: (u32, u32),
    /// The part of the film that is rendered.
    pub window: Window,
    /// Reconstruction filter.
    pub filter: Filter,
    /// How samples are spread.
    pub sampler: SamplerKind,
    /// Samples a pixel.
    pub sample_count: u32,
    /// Whether the film has an alpha channel.
    pub alpha: bool,
    /// Whether the film stores half floats; otherwise floats.
    pub half: bool,
}

/// What a scene file asks of the integrator.
#[derive(Clone, Debug, Default)]
pub struct IntegratorRequest {
    /// Name of the innermost integrator, as the file has it; empty when the file has none.
    pub name: String,
    /// Where it stands.
    pub location: Option<Location>,
    /// Its options.
    pub options: Options,
    /// Where each option stands.
    pub option_locations: BTreeMap<String, Location>,
    /// Names of the layers that an `aov` integrator around it asks for, in the file's own words.
    pub aovs: Vec<String>,
    /// Whether a `moment` integrator stands around it.
    pub second_moment: bool,
}
