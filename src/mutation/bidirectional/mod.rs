//! The bidirectional mutation, which changes the length and the events of a path.
//!
//! A piece of the path is taken out, possibly all of it but the sensor, and a piece of about the same length put in:
//! its vertices are made by scattering from both ends that stay, and joined by a connection. Which vertices stay is part of the move, and the
//! move back keeps the same; so that the density of a move is the chance of keeping them, times the mean
//! over all ways of making the new vertices from the two ends.

mod build;
mod choice;
mod density;
mod fault;

use super::{Perturbation, Rejection};
use crate::path::{Event, Path, PathSpace};
use crate::random::Stream;
use crate::sensor::SensorModel;
use choice::Kept;
use density::Section;

pub use fault::SectionFault;

/// Takes a piece out of a path and puts another in.
///
/// Differs: moves that keep other vertices and happen to make the same path are not counted in the
/// density, there and back: what stays is part of the move. A light is chosen by sampling towards it, by sampling a ray of it, or by chance; not
/// by a new direction from a point that stays.
///
/// Paths that can be no seeds are not proposed: those that path tracing cannot find, from a light at a point or of one direction
/// by mirrors and glass; or those that subpaths from both sides cannot find, without an edge between two scattering vertices.
///
/// Source: Veach & Guibas 1997; van Antwerpen 2011, Sec. 6.3.
#[derive(Clone, Debug)]
pub struct BidirectionalMutation {
    /// Fewest and most edges of paths.
    edges: (usize, usize),
    /// The light's side under way, the light first.
    light: Path,
    /// Whether subpaths from both sides find seeds, not path tracing.
    both_sides: bool,
    /// What is wrong on purpose: nothing, except in tests of tests.
    fault: SectionFault,
}

impl BidirectionalMutation {
    /// Makes the mutation; all of its memory is allocated here.
    ///
    /// - `fewest`, `most`: edges that paths may have, fewest at least one.
    pub fn new(fewest: usize, most: usize) -> Self {
        Self {
            edges: (fewest, most),
            light: Path::default(),
            both_sides: false,
            fault: SectionFault::None,
        }
    }

    /// The same among all paths that subpaths from both sides find.
    #[must_use]
    pub fn among_seeds_of_both_sides(self) -> Self {
        Self {
            both_sides: true,
            ..self
        }
    }

    /// The same with a fault.
    #[must_use]
    pub fn with_fault(self, fault: SectionFault) -> Self {
        Self { fault, ..self }
    }

    /// Whether a path is one of those that are moved.
    pub fn applies(&self, path: &Path) -> bool {
        (self.edges.0..=self.edges.1).contains(&path.edges())
    }

    /// Makes a proposal; returns the ratio `f(ȳ) T(ȳ → x̄) / (f(x̄) T(x̄ → ȳ))`.
    ///
    /// - `proposal`: whatever it was, the new path.
    ///
    /// # Errors
    /// Why there is none; the proposal is then in disorder.
    pub fn propose(
        &mut self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        (current, proposal): (&Path, &mut Path),
        random: &mut Stream,
    ) -> Result<f64, Rejection> {
        let vertices = current.vertices().len();
        let kept = Kept::choose(vertices, random);
        let deleted = kept.deleted(vertices);
        let added = kept
            .choose_addition(deleted, self.edges, random)
            .ok_or(Rejection::NoWayBack)?;
        self.build(space, settings, (current, proposal), (kept, added), random)?;
        let section = |path| Section {
            path,
            kept,
            pixels: settings.domain.pixels(),
            fault: self.fault,
        };
        let (before, after) = (section(current), section(proposal));
        let keep = |fault, factor| self.fault.keep(fault, factor);
        let deletion = kept.probability(proposal.vertices().len()) / kept.probability(vertices);
        let addition = kept.addition_probability((added, deleted), self.edges)
            / kept.addition_probability((deleted, added), self.edges);
        let making = before.density(space) / after.density(space);
        Ok(proposal.luminance() / current.luminance()
            * keep(SectionFault::Deletion, deletion)
            * keep(SectionFault::Addition, addition)
            * making)
    }

    /// Samples a path of which only the sensor is given: returns its contribution over its density, as luminance. The
    /// mean, zero for what is rejected, is the light of all paths with so many edges, in all pixels together.
    ///
    /// # Errors
    /// As [`BidirectionalMutation::propose`].
    pub fn sample_afresh(
        &mut self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        (edges, path): (usize, &mut Path),
        random: &mut Stream,
    ) -> Result<f64, Rejection> {
        let kept = Kept {
            sensor: 1,
            light: 0,
        };
        let mut lens = Path::default();
        lens.start(
            space.sensor.sample_lens(random.next_vec2()),
            Default::default(),
        );
        self.build(space, settings, (&lens, path), (kept, edges), random)?;
        let section = Section {
            path,
            kept,
            pixels: settings.domain.pixels(),
            fault: self.fault,
        };
        Ok(path.luminance() / section.density(space))
    }

    /// Makes the new path.
    fn build(
        &mut self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        (current, proposal): (&Path, &mut Path),
        (kept, added): (Kept, usize),
        random: &mut Stream,
    ) -> Result<(), Rejection> {
        let split = kept
            .choose_split(added, random)
            .ok_or(Rejection::NoWayBack)?;
        let old = current.vertices();
        proposal.copy_from(current);
        proposal.truncate(kept.sensor);
        if kept.sensor == 1 && space.sensor.has_lens() {
            let lens = space.sensor.sample_lens(random.next_vec2());
            proposal.vertices_mut()[0].point.position = lens;
        }
        let is_met = kept.light == 0 && split.light == 0;
        let from_sensor = (split.sensor, is_met);
        build::extend_from_sensor(space, &settings.domain, proposal, from_sensor, random)?;
        let end = proposal.edges();
        // The light's side, the light first.
        let light = &mut self.light;
        light.start(Default::default(), Default::default());
        if kept.light > 0 {
            light.truncate(0);
            for vertex in old[old.len() - kept.light..].iter().rev() {
                light.push(*vertex);
            }
            build::extend_from_light(space, light, split.light, random)?;
        } else if split.light == 1 {
            let from = proposal.vertices()[end];
            let sampled = build::sample_light(space, &from, random.next_vec2())?;
            light.vertices_mut()[0] = sampled;
        } else if split.light > 1 {
            build::emit(space, light, random)?;
            build::extend_from_light(space, light, split.light - 2, random)?;
        }
        if !is_met {
            for vertex in self.light.vertices().iter().rev() {
                proposal.push(*vertex);
            }
            build::connect(space, proposal, end)?;
        }
        if !settings.domain.contains(proposal.raster()) {
            return Err(Rejection::OffImage);
        }
        if !has_seeds(proposal, self.both_sides) {
            return Err(Rejection::SignatureChanged);
        }
        if proposal.vertices()[1..].iter().any(|v| v.value.is_black()) {
            return Err(Rejection::Dark);
        }
        Ok(())
    }
}

/// Whether a path can be found: what cannot be is no seed, and a chain must not go there, or it would take energy
/// along from what has seeds.
///
/// - `both_sides`: by subpaths from both sides; if not, by path tracing.
fn has_seeds(path: &Path, both_sides: bool) -> bool {
    let (vertices, last) = (path.vertices(), path.edges());
    let is_open = |index: usize| vertices[index].event.is_connectable();
    match vertices[last].event {
        Event::Emission(class) if class.is_dirac() => {
            let first = if both_sides { 0 } else { last - 1 };
            // Nobody sees the light itself.
            last > 1 && (first..last).any(|index| is_open(index) && is_open(index + 1))
        }
        _ => true,
    }
}
