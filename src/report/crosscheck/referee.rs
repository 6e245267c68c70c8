//! The third reckoning: all primitives near a ray, in double precision.
//!
//! There is no tree. Primitives that follow each other in a mesh are kept in boxes of up to 64, and all
//! of these boxes are looked at, which takes some 10 µs for each million triangles.

use glam::DVec3;

use super::exact::{Exact, Line};
use super::subject::{Id, Place, Subject};
use crate::accel::Ray;

/// Primitives in a box.
const RUN: u32 = 64;

/// The referee of a check.
pub(super) struct Referee<'a> {
    pub(super) subject: &'a Subject,
    world: Space,
    groups: Vec<Space>,
    instances: Vec<[DVec3; 2]>,
}

/// Boxes around primitives of one space.
struct Space {
    runs: Vec<Run>,
    bounds: [DVec3; 2],
}

struct Run {
    bounds: [DVec3; 2],
    geometry: u32,
    first: u32,
    count: u32,
}

/// Where a line crosses a primitive.
pub(super) struct Crossing<'c> {
    /// In multiples of the ray's direction.
    pub(super) distance: f64,
    pub(super) id: Id,
    pub(super) exact: &'c Exact,
    /// In the space of the primitive.
    pub(super) line: &'c Line,
    pub(super) place: Option<&'c Place>,
}

const NOTHING: [DVec3; 2] = [DVec3::INFINITY, DVec3::NEG_INFINITY];

fn around([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> [DVec3; 2] {
    [a.min(c), b.max(d)]
}

impl Space {
    fn new(geometries: &[crate::accel::Geometry]) -> Self {
        let (mut runs, mut bounds) = (Vec::new(), NOTHING);
        for (geometry, shape) in (0..).zip(geometries) {
            let count = Exact::count(shape);
            for first in (0..count).step_by(RUN as usize) {
                let count = RUN.min(count - first);
                let boxes = (first..first + count).map(|i| Exact::of(shape, i).bounds());
                let run = Run {
                    bounds: boxes.fold(NOTHING, around),
                    geometry,
                    first,
                    count,
                };
                bounds = around(bounds, run.bounds);
                runs.push(run);
            }
        }
        Self { runs, bounds }
    }
}

impl<'a> Referee<'a> {
    pub(super) fn new(subject: &'a Subject) -> Self {
        let groups: Vec<Space> = subject.groups.iter().map(|g| Space::new(g)).collect();
        let boxes = (0..subject.instances.len() as u32).map(|index| {
            let place = subject.place(index);
            let [low, high] = groups[place.group as usize].bounds;
            let corners = (0..8).map(|corner| {
                let pick = |axis: usize| if (corner >> axis) & 1 == 0 { low } else { high }[axis];
                place.linear * DVec3::new(pick(0), pick(1), pick(2)) + place.origin
            });
            corners.fold(NOTHING, |all, corner| around(all, [corner, corner]))
        });
        Self {
            world: Space::new(&subject.geometries),
            instances: boxes.collect(),
            groups,
            subject,
        }
    }

    /// The corners of the box around everything; the first is above the second where there is nothing.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        self.instances
            .iter()
            .fold(self.world.bounds, |all, own| around(all, *own))
    }

    /// Tells all crossings of a line, in any order and at any distance, until one is enough.
    pub(super) fn crossings(
        &self,
        line: &Line,
        tell: &mut dyn FnMut(&Crossing<'_>) -> bool,
    ) -> bool {
        if self.in_space(&self.world, None, line, None, tell) {
            return true;
        }
        (0..).zip(&self.instances).any(|(index, bounds)| {
            if !line.crosses_box(*bounds) {
                return false;
            }
            let place = self.subject.place(index);
            let own = place.line(line);
            let space = &self.groups[place.group as usize];
            self.in_space(space, Some(index), &own, Some(&place), tell)
        })
    }

    fn in_space(
        &self,
        space: &Space,
        instance: Option<u32>,
        line: &Line,
        place: Option<&Place>,
        tell: &mut dyn FnMut(&Crossing<'_>) -> bool,
    ) -> bool {
        for run in space.runs.iter().filter(|run| line.crosses_box(run.bounds)) {
            for primitive in run.first..run.first + run.count {
                let id = Id {
                    instance,
                    geometry: run.geometry,
                    primitive,
                };
                let exact = &self.subject.exact(id);
                let mut enough = false;
                exact.crossings(line, |distance| {
                    let crossing = Crossing {
                        distance,
                        id,
                        exact,
                        line,
                        place,
                    };
                    enough = enough || tell(&crossing);
                });
                if enough {
                    return true;
                }
            }
        }
        false
    }

    /// The closest hit: its distance and what is hit.
    pub(super) fn closest(&self, ray: &Ray) -> Option<(f64, Id)> {
        let range = f64::from(ray.near())..=f64::from(ray.far());
        let mut best: Option<(f64, Id)> = None;
        self.crossings(&Line::of(ray), &mut |crossing| {
            let is_nearer = best.is_none_or(|(distance, _)| crossing.distance < distance);
            if is_nearer && range.contains(&crossing.distance) {
                best = Some((crossing.distance, crossing.id));
            }
            false
        });
        best
    }
}
