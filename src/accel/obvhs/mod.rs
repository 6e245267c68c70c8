//! The second tracer: a tree of obvhs, walked in double precision.
//!
//! It shares no code with Embree, so that what both say of a ray is believed. From obvhs comes the tree;
//! its own walk is not used, since it compares boxes in single precision without a margin and takes
//! memory for each ray. Everything after the ray's numbers is in `f64`, which costs speed: several
//! times what Embree takes. What is asked is marked as cold, so that it takes no room in loops that
//! Embree is asked in.

mod cone;
mod line;
mod round;
mod solid;
mod spline;
#[cfg(test)]
mod tests;
mod tree;
mod triangle;

use embree4_sys::{Error, MemoryUse, VertexBuffer, check_map};
use glam::{DMat3, DVec3};

use super::{AccelError, Engine, Geometry, Hit, Instance, Ray};
use crate::math::Vec3;
use line::{Box3, Crossing, Line};
use solid::Solid;
use tree::Tree;

/// The release of the crate.
pub const VERSION: &str = "0.2.2";

/// Geometry in obvhs's search structure.
#[derive(Debug)]
pub(super) struct ObvhsAccel {
    world: Level,
    groups: Vec<Level>,
    placed: Vec<Placed>,
    instances: Tree,
}

/// Geometries of one space.
#[derive(Debug)]
struct Level {
    solids: Vec<Solid>,
    members: Vec<Member>,
    tree: Tree,
}

/// A primitive in a tree.
#[derive(Clone, Copy, Debug)]
struct Member {
    geometry: u32,
    primitive: u32,
}

/// A group that stands in the world.
#[derive(Debug)]
struct Placed {
    group: u32,
    inverse: DMat3,
    origin: DVec3,
}

/// The closest crossing so far.
struct Closest {
    member: Member,
    instance: Option<u32>,
    crossing: Crossing,
}

impl ObvhsAccel {
    /// As [`super::Accel::build`].
    pub(super) fn build<G: IntoIterator<Item = Geometry>>(
        geometries: impl IntoIterator<Item = Geometry>,
        groups: impl IntoIterator<Item = G>,
        instances: impl IntoIterator<Item = Instance>,
    ) -> Result<Self, AccelError> {
        let mut count = 0;
        let world = Level::build(geometries, &mut count)?;
        let groups: Result<Vec<_>, _> = groups
            .into_iter()
            .map(|group| Level::build(group, &mut count))
            .collect();
        let groups = groups?;
        let (mut placed, mut boxes) = (Vec::new(), Vec::new());
        for (index, instance) in (count..).zip(instances) {
            let found = Placed::new(&instance, &groups[instance.group as usize]);
            let (place, bounds) = found.map_err(|error| refused(index, error))?;
            placed.push(place);
            boxes.push(bounds);
        }
        Ok(Self {
            world,
            groups,
            placed,
            instances: Tree::build(&boxes)?,
        })
    }

    /// As [`super::Accel::memory`].
    pub(super) fn memory(&self) -> MemoryUse {
        let levels = self.groups.iter().chain([&self.world]);
        let held = levels.map(Level::bytes).sum::<usize>()
            + size_of_val(self.placed.as_slice())
            + self.instances.bytes();
        MemoryUse {
            held: held as u64,
            peak: held as u64,
        }
    }

    /// As [`super::Accel::intersect`].
    #[cold]
    #[inline(never)]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let line = Line::new(ray)?;
        let (mut limit, mut closest) = (f64::INFINITY, None);
        self.world.closest(&line, &mut limit, &mut closest, None);
        self.instances
            .walk(&line, &mut limit, |index, limit: &mut f64| {
                let placed = &self.placed[index as usize];
                let number = self.world.solids.len() as u32 + index;
                let group = &self.groups[placed.group as usize];
                group.closest(&placed.line(&line), limit, &mut closest, Some(number));
                false
            });
        closest.map(|closest: Closest| closest.hit())
    }

    /// As [`super::Accel::is_occluded`].
    #[cold]
    #[inline(never)]
    pub(super) fn is_occluded(&self, ray: &Ray) -> bool {
        let Some(line) = Line::new(ray) else {
            return false;
        };
        let mut endless = f64::INFINITY;
        self.world.is_crossed(&line)
            || self.instances.walk(&line, &mut endless, |index, _| {
                let placed = &self.placed[index as usize];
                self.groups[placed.group as usize].is_crossed(&placed.line(&line))
            })
    }

    /// As [`super::Accel::intersect_all`].
    #[cold]
    #[inline(never)]
    pub(super) fn intersect_all(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.intersect(ray)));
    }

    /// As [`super::Accel::are_occluded`].
    #[cold]
    #[inline(never)]
    pub(super) fn are_occluded<'r>(
        &self,
        rays: impl IntoIterator<Item = &'r Ray>,
        occluded: &mut Vec<bool>,
    ) {
        occluded.clear();
        occluded.extend(rays.into_iter().map(|ray| self.is_occluded(ray)));
    }

    /// As [`super::Accel::bounding_box`].
    pub(super) fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        let boxes = [self.world.tree.bounds(), self.instances.bounds()];
        let all = boxes.into_iter().flatten();
        let all = all.reduce(|a, b| Box3 {
            low: a.low.min(b.low),
            high: a.high.max(b.high),
        })?;
        Some((all.low.as_vec3(), all.high.as_vec3()))
    }
}

impl Level {
    /// Size of what it holds, without the buffers that it shares.
    fn bytes(&self) -> usize {
        let (solids, members) = (self.solids.as_slice(), self.members.as_slice());
        size_of_val(solids) + size_of_val(members) + self.tree.bytes()
    }

    fn build(
        geometries: impl IntoIterator<Item = Geometry>,
        count: &mut usize,
    ) -> Result<Self, AccelError> {
        let (mut solids, mut members, mut boxes) = (Vec::new(), Vec::new(), Vec::new());
        for geometry in geometries {
            let solid = Solid::new(geometry).map_err(|error| refused(*count, error))?;
            let geometry = solids.len() as u32;
            for primitive in 0..solid.primitive_count() {
                members.push(Member {
                    geometry,
                    primitive,
                });
                boxes.push(solid.bounds(primitive));
            }
            solids.push(solid);
            *count += 1;
        }
        Ok(Self {
            solids,
            members,
            tree: Tree::build(&boxes)?,
        })
    }

    /// Looks for a crossing nearer than `limit`, and lowers that.
    fn closest(
        &self,
        line: &Line,
        limit: &mut f64,
        closest: &mut Option<Closest>,
        instance: Option<u32>,
    ) {
        self.tree.walk(line, limit, |index, limit: &mut f64| {
            let member = self.members[index as usize];
            let solid = &self.solids[member.geometry as usize];
            if let Some(crossing) = solid.cross(member.primitive, line) {
                if crossing.distance < *limit {
                    *limit = crossing.distance;
                    *closest = Some(Closest {
                        member,
                        instance,
                        crossing,
                    });
                }
            }
            false
        });
    }

    fn is_crossed(&self, line: &Line) -> bool {
        let mut endless = f64::INFINITY;
        self.tree.walk(line, &mut endless, |index, _| {
            let member = self.members[index as usize];
            let solid = &self.solids[member.geometry as usize];
            solid.cross(member.primitive, line).is_some()
        })
    }
}

impl Placed {
    /// The instance of a group, and the box around it.
    fn new(instance: &Instance, group: &Level) -> Result<(Self, Box3), Error> {
        check_map("an instance", &instance.to_world)?;
        let (linear, origin) = solid::affine(&instance.to_world);
        let inverse = linear.inverse();
        let bounds = group.tree.bounds().map_or(Box3::EMPTY, |bounds| {
            let (middle, half) = (
                0.5 * (bounds.low + bounds.high),
                0.5 * (bounds.high - bounds.low),
            );
            let middle = linear * middle + origin;
            let axes = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::abs);
            let reach = DMat3::from_cols(axes[0], axes[1], axes[2]) * half;
            let rounding = (middle.abs() + reach) * 1e-12;
            Box3 {
                low: middle - reach - rounding,
                high: middle + reach + rounding,
            }
        });
        let largest = f64::from(VertexBuffer::LARGEST);
        if bounds != Box3::EMPTY && bounds.low.abs().max(bounds.high.abs()).max_element() > largest
        {
            return Err(Error::BadShape {
                what: "an instance",
                parameter: "matrix",
                value: format!("{:?}; it moves the group too far out", instance.to_world),
            });
        }
        let placed = Self {
            group: instance.group,
            inverse,
            origin,
        };
        Ok((placed, bounds))
    }

    /// A line of the world in the space of the group; distances along it stay what they are.
    fn line(&self, line: &Line) -> Line {
        line.mapped(
            self.inverse * (line.origin - self.origin),
            self.inverse * line.direction,
        )
    }
}

impl Closest {
    fn hit(&self) -> Hit {
        let crossing = &self.crossing;
        Hit {
            distance: crossing.distance as f32,
            u: crossing.u as f32,
            v: crossing.v as f32,
            normal: crossing.normal.as_vec3().to_array(),
            primitive: self.member.primitive,
            geometry: self.member.geometry,
            instance: self.instance,
        }
    }
}

fn refused(index: usize, error: Error) -> AccelError {
    AccelError::Geometry {
        engine: Engine::Obvhs,
        index,
        error,
    }
}
