//! The space of paths of one scene, seen by one sensor.

use std::cell::Cell;

use super::{Event, PathVertex, VertexKind};
use crate::accel::Ray;
use crate::bsdf::{Bsdf, BsdfModel, Transport};
use crate::emitter::{EmitterClass, EmitterModel};
use crate::math::{Local, Rgb, Vec2, Vec3};
use crate::scene::{Interaction, Object, Scene};
use crate::sensor::{Sensor, SensorModel};
use crate::shape::SurfacePoint;

/// What counts as a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathRules {
    /// The sensor sees through emitting surfaces, and no environment.
    pub hide_emitters: bool,
    /// Directions that lie on different sides of the true and the shaded surface are black.
    pub strict_normals: bool,
}

/// The paths of a scene that a sensor sees: what scatters where, what sees what, and at what value.
///
/// Holds a counter of rays; every unit of work has a space of its own.
#[derive(Debug)]
pub struct PathSpace<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// The sensor.
    pub sensor: &'s Sensor,
    /// What counts as a path.
    pub rules: PathRules,
    rays: Cell<u64>,
}

impl<'s> PathSpace<'s> {
    /// Makes the space.
    pub fn new(scene: &'s Scene, sensor: &'s Sensor, rules: PathRules) -> Self {
        Self {
            scene,
            sensor,
            rules,
            rays: Cell::new(0),
        }
    }

    /// Number of rays traced so far.
    pub fn rays(&self) -> u64 {
        self.rays.get()
    }

    #[inline]
    fn count_ray(&self) {
        self.rays.set(self.rays.get() + 1);
    }

    /// The first surface that a ray meets.
    ///
    /// - `from_sensor`: whether emitting surfaces may be hidden from it.
    #[inline(always)]
    pub fn meet(&self, ray: Ray, from_sensor: bool) -> Option<Interaction<'s>> {
        if from_sensor && self.rules.hide_emitters {
            return self.meet_past_emitters(ray);
        }
        self.count_ray();
        self.scene.intersect(&ray)
    }

    /// Lets a ray meet its first surface, and makes a vertex there, whose value is yet to be found; returns
    /// the object there. As [`PathSpace::meet`] and [`PathVertex::surface`], without a copy of the point where
    /// emitters are not hidden.
    ///
    /// - `vertex`: becomes it, where there is a surface.
    #[inline(always)]
    pub fn meet_at(
        &self,
        ray: Ray,
        from_sensor: bool,
        event: Event,
        vertex: &mut PathVertex,
    ) -> Option<&'s Object> {
        let object = if from_sensor && self.rules.hide_emitters {
            let met = self.meet_past_emitters(ray)?;
            vertex.point = met.point;
            (met.object, &self.scene.objects()[met.object as usize])
        } else {
            self.count_ray();
            let hit = self.scene.hit(&ray)?;
            self.scene.put_surface(&ray, &hit, &mut vertex.point)
        };
        let (index, object) = object;
        vertex.lie_on((index, object.emitter), event);
        Some(object)
    }

    /// The first surface that a ray meets and that does not emit.
    #[inline(never)]
    fn meet_past_emitters(&self, mut ray: Ray) -> Option<Interaction<'s>> {
        loop {
            self.count_ray();
            let met = self.scene.intersect(&ray)?;
            if met.emitter.is_none() {
                return Some(met);
            }
            let direction = ray.direction();
            let left = ray.far() - met.distance;
            ray = Ray::new(met.point.ray_origin(direction), direction).between(0.0, left);
        }
    }

    /// The ray that leaves a surface vertex in a unit direction.
    #[inline]
    pub fn leave(&self, vertex: &PathVertex, direction: Vec3) -> Ray {
        Ray::new(vertex.point.ray_origin(direction), direction)
    }

    /// Unit direction from one vertex to another, and the squared length of the edge in m²: one for an
    /// edge to infinity. `None` for vertices at the same place.
    #[inline]
    pub fn edge(&self, from: &PathVertex, to: &PathVertex) -> Option<(Vec3, f32)> {
        if to.kind == VertexKind::Infinity {
            return Some((to.position(), 1.0));
        }
        let edge = to.position() - from.position();
        let distance_squared = edge.length_squared();
        let direction = edge * (1.0 / distance_squared.sqrt());
        (distance_squared > 0.0 && direction.is_finite()).then_some((direction, distance_squared))
    }

    /// Solid angle at `from` for each unit of area around `to`, in 1/m²: `|cos θ| / d²`; for a point
    /// light `1 / d²`, for a vertex at infinity one.
    #[inline]
    pub fn solid_angle_per_area(&self, from: &PathVertex, to: &PathVertex) -> f64 {
        match self.edge(from, to) {
            Some((direction, distance_squared)) => {
                f64::from(to.geometric_cos(direction)) / f64::from(distance_squared)
            }
            None => 0.0,
        }
    }

    /// True when nothing stands between two vertices.
    ///
    /// - `from`: on a surface.
    /// - `to`: on a surface, at a point light or at infinity.
    #[inline]
    pub fn is_visible(&self, from: &PathVertex, to: &PathVertex) -> bool {
        self.count_ray();
        match to.kind {
            VertexKind::Infinity => self
                .scene
                .is_visible_to_infinity(&from.point, to.position()),
            VertexKind::Surface => {
                let target = to.point.ray_origin(from.position() - to.position());
                self.scene.is_visible(&from.point, target)
            }
            VertexKind::Point | VertexKind::Sensor => {
                self.scene.is_visible(&from.point, to.position())
            }
        }
    }

    /// Raster position at which a surface vertex is seen through a point of the lens; `None` where it
    /// is hidden, clipped or behind the sensor.
    ///
    /// - `lens`: position on the lens, in world space.
    #[inline]
    pub fn seen_at(&self, vertex: &PathVertex, lens: &PathVertex) -> Option<Vec2> {
        let (raster, ray) = self.sight(vertex, lens)?;
        if self.rules.hide_emitters {
            return self.is_free_past_emitters(ray).then_some(raster);
        }
        self.count_ray();
        (!self.scene.accel().is_occluded(&ray)).then_some(raster)
    }

    /// Raster position at which a vertex is seen through a point of the lens if the ray between them is
    /// free; `None` where it is clipped or behind the sensor.
    ///
    /// - `vertex`: on a surface, or at infinity.
    #[inline]
    pub fn sight(&self, vertex: &PathVertex, lens: &PathVertex) -> Option<(Vec2, Ray)> {
        let (direction, distance_squared) = self.edge(lens, vertex)?;
        let raster = self.sensor.raster_at(lens.position(), direction)?;
        let (near, far) = self.sensor.clip(direction);
        if vertex.kind == VertexKind::Infinity {
            let ray = Ray::new(lens.position(), direction).between(near, far);
            return Some((raster, ray));
        }
        let distance = distance_squared.sqrt();
        let origin = vertex.point.ray_origin(-direction);
        let target = lens.position() + direction * near;
        (distance >= near && distance <= far).then(|| (raster, Ray::segment(origin, target)))
    }

    /// True when a piece of a line meets no surface that does not emit.
    pub fn is_free_past_emitters(&self, ray: Ray) -> bool {
        let target = ray.at(ray.far());
        let mut segment = ray;
        loop {
            self.count_ray();
            let Some(met) = self.scene.intersect(&segment) else {
                return true;
            };
            if met.emitter.is_none() {
                return false;
            }
            segment = Ray::segment(met.point.ray_origin(ray.direction()), target);
        }
    }

    /// Whether each of many rays meets anything.
    ///
    /// - `occluded`: filled anew, one a ray.
    #[inline]
    pub fn are_occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        self.rays.set(self.rays.get() + rays.len() as u64);
        self.scene.accel().are_occluded(rays, occluded);
    }

    /// The point of the lens from which a ray leaves to a vertex: the given one, except where rays are
    /// parallel.
    #[inline]
    pub fn lens_before(&self, vertex: &PathVertex, lens: &PathVertex) -> PathVertex {
        match vertex.kind {
            VertexKind::Infinity => *lens,
            _ => PathVertex::sensor(self.sensor.lens_before(vertex.position(), lens.position())),
        }
    }

    /// The material at a vertex.
    #[inline]
    pub fn bsdf(&self, vertex: &PathVertex) -> Option<&'s Bsdf> {
        let object = self.scene.objects().get(vertex.object()?)?;
        Some(self.scene.bsdf(object.bsdf))
    }

    /// `f_s · |n_s · ω_l|` of the finite lobes: radiance from `to_light` scattered to `to_eye`.
    // By a call, directions would pass through memory, written and read in different pieces.
    #[inline(always)]
    pub fn finite_value(&self, vertex: &PathVertex, to_eye: Vec3, to_light: Vec3) -> Rgb {
        let object = vertex.object();
        let Some(object) = object.and_then(|index| self.scene.objects().get(index)) else {
            return Rgb::BLACK;
        };
        let (bsdf, point) = (|| self.scene.bsdf(object.bsdf), &vertex.point);
        match object.diffuse.filter(|_| !self.rules.strict_normals) {
            // Cosines are enough: no frame is made.
            Some(diffuse) => {
                let normal = point.shading_normal;
                let cosines = (to_eye.dot(normal), to_light.dot(normal));
                diffuse.eval(cosines, bsdf, point.uv)
            }
            None => self.scattered_by_other(bsdf(), point, to_eye, to_light),
        }
    }

    /// [`PathSpace::finite_value`] of materials that are not diffuse.
    #[inline(never)]
    fn scattered_by_other(
        &self,
        bsdf: &Bsdf,
        point: &SurfacePoint,
        to_eye: Vec3,
        to_light: Vec3,
    ) -> Rgb {
        let frame = point.shading_frame();
        let (wi, wo) = (frame.to_local(to_eye), frame.to_local(to_light));
        if !self.sides_agree(point, (wi.cos(), to_eye), (wo.cos(), to_light)) {
            return Rgb::BLACK;
        }
        bsdf.eval(wi, wo, point, Transport::Radiance)
    }

    /// What an emitter's vertex sends in a unit direction away from it.
    ///
    /// Radiance of areas and environments, intensity of point lights; the irradiance of a directional
    /// light and the flux of a beam are kept in the vertex, whatever the direction.
    #[inline]
    pub fn emission(&self, vertex: &PathVertex, to_eye: Vec3) -> Rgb {
        let (Some(id), Event::Emission(class)) = (vertex.emitter(), vertex.event) else {
            return Rgb::BLACK;
        };
        let emitter = self.scene.lights().get(id);
        match class {
            EmitterClass::Area => emitter.radiance(&vertex.point, to_eye),
            EmitterClass::Point => emitter.intensity(to_eye),
            EmitterClass::Directional | EmitterClass::Collimated => vertex.value,
            EmitterClass::Environment => emitter.environment_radiance(vertex.position()),
        }
    }

    /// False where `strict_normals` forbids a pair of directions, each given with its signed cosine to the
    /// shading normal.
    #[inline]
    pub(super) fn sides_agree(&self, point: &SurfacePoint, a: (f32, Vec3), b: (f32, Vec3)) -> bool {
        let normal = point.geometric_normal;
        !self.rules.strict_normals || (is_same_side(normal, a) && is_same_side(normal, b))
    }

    /// [`PathSpace::sides_agree`] at a surface that a ray has just met.
    ///
    /// - `local`, `world`: the other direction, in both frames.
    #[inline]
    pub(super) fn strict_agrees(&self, met: &Interaction<'_>, local: Local, world: Vec3) -> bool {
        let normal = met.point.geometric_normal;
        !self.rules.strict_normals
            || (is_same_side(normal, (met.wi.cos(), met.back))
                && is_same_side(normal, (local.cos(), world)))
    }
}

/// True when a direction, given with its signed cosine to the shading normal, lies on the same side of the
/// true and of the shaded surface.
#[inline]
fn is_same_side(normal: Vec3, (cos, world): (f32, Vec3)) -> bool {
    normal.dot(world) * cos > 0.0
}
