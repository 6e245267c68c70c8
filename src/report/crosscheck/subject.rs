//! The geometry that a check is about.

use glam::{DMat3, DVec3};

use super::exact::{Exact, Line};
use crate::accel::{Accel, AccelError, Engine, Geometry, Hit, Instance, Ray};
use crate::scene::Scene;
use crate::shape::ShapeModel;

/// Geometry as tracers are given it.
#[derive(Clone, Debug, Default)]
pub struct Subject {
    /// What stands in the world.
    pub geometries: Vec<Geometry>,
    /// What stands wherever an instance places it.
    pub groups: Vec<Vec<Geometry>>,
    /// The instances.
    pub instances: Vec<Instance>,
}

/// Which primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Id {
    /// Index in the instances.
    pub(super) instance: Option<u32>,
    pub(super) geometry: u32,
    pub(super) primitive: u32,
}

/// Where a group stands, in double precision.
pub(super) struct Place {
    pub(super) group: u32,
    pub(super) linear: DMat3,
    pub(super) inverse: DMat3,
    pub(super) origin: DVec3,
}

impl Subject {
    /// What a scene's rays can meet.
    pub fn of(scene: &Scene) -> Self {
        let geometries = |objects: &[crate::scene::Object]| -> Vec<Geometry> {
            objects.iter().map(|o| o.shape.geometry()).collect()
        };
        let instances = scene.instances().iter();
        Self {
            geometries: geometries(scene.objects_in_world()),
            groups: scene.groups().map(geometries).collect(),
            instances: instances
                .map(|instance| Instance {
                    group: instance.group.0,
                    to_world: instance.placement.to_world(),
                })
                .collect(),
        }
    }

    /// Builds a tracer's search structure of it.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn build(&self, engine: Engine) -> Result<Accel, AccelError> {
        let geometries = self.geometries.iter().cloned();
        let groups = self.groups.iter().cloned();
        Accel::build(engine, geometries, groups, self.instances.iter().copied())
    }

    /// The primitive of a hit.
    pub(super) fn id(&self, hit: &Hit) -> Id {
        let instance = hit.instance.map(|id| id - self.geometries.len() as u32);
        Id {
            instance,
            geometry: hit.geometry,
            primitive: hit.primitive,
        }
    }

    /// A primitive in double precision.
    pub(super) fn exact(&self, id: Id) -> Exact {
        let geometries = match id.instance {
            None => &self.geometries,
            Some(index) => &self.groups[self.instances[index as usize].group as usize],
        };
        Exact::of(&geometries[id.geometry as usize], id.primitive)
    }

    /// Where an instance stands.
    pub(super) fn place(&self, instance: u32) -> Place {
        let instance = &self.instances[instance as usize];
        let column = |i: usize| DVec3::from_array(instance.to_world.map(|row| f64::from(row[i])));
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        Place {
            group: instance.group,
            linear,
            inverse: linear.inverse(),
            origin: column(3),
        }
    }
}

impl Place {
    /// A line in the space of the group; distances along it stay what they are.
    pub(super) fn line(&self, line: &Line) -> Line {
        Line {
            origin: self.inverse * (line.origin - self.origin),
            direction: self.inverse * line.direction,
        }
    }

    /// The largest factor by which lengths grow.
    pub(super) fn stretch(&self) -> f64 {
        let axes = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        axes.iter()
            .map(|axis| axis.length_squared())
            .sum::<f64>()
            .sqrt()
    }

    /// Size of the products that coordinates in the group's space are sums of, for a ray up to a
    /// distance: single precision errs by as much times the rounding of a float.
    pub(super) fn products(&self, ray: &Ray, distance: f64) -> f64 {
        let absolute = |m: &DMat3| DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        let travelled = ray.direction().as_dvec3().abs() * distance;
        let size = ray.origin().as_dvec3().abs() + self.origin.abs() + travelled;
        (absolute(&self.inverse) * size).length()
    }
}
