//! The densities of all bidirectional techniques that make a path, each worked out for itself: slow and
//! plain.

use lumiflow::bsdf::{BsdfModel, Transport};
use lumiflow::emitter::EmitterClass;
use lumiflow::path::{Event, Path, PathSpace, PathVertex, VertexKind};

/// An error that is planted into the densities, to see that it is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mistake {
    None,
    /// The number of light subpaths is forgotten.
    OneLightPath,
    /// Lights are sampled from surfaces as light subpaths sample them.
    DirectAsEmitted,
    /// Densities from the light's side lack the cosine where they arrive.
    NoCosine,
    /// Densities from the light's side lack the distance of the first edge.
    NoDistance,
    /// Light leaves in all directions alike.
    UniformEmission,
    /// The other direction of refraction has the same density.
    NoStretch,
    /// Dirac vertices can be connected.
    DiracConnected,
    /// The other side's subpath always takes the same Dirac component.
    CertainComponent,
    /// Emitters are chosen alike.
    UniformChoice,
}

pub(crate) const MISTAKES: [Mistake; 9] = [
    Mistake::OneLightPath,
    Mistake::DirectAsEmitted,
    Mistake::NoCosine,
    Mistake::NoDistance,
    Mistake::UniformEmission,
    Mistake::NoStretch,
    Mistake::DiracConnected,
    Mistake::CertainComponent,
    Mistake::UniformChoice,
];

/// All densities that belong to a path.
pub(crate) struct Densities<'a> {
    pub(crate) space: &'a PathSpace<'a>,
    /// Light subpaths for each camera sample a pixel.
    pub(crate) light_paths: f64,
    pub(crate) mistake: Mistake,
}

impl Densities<'_> {
    /// Density of sampling a vertex from the eye's side, in the measure of its kind.
    fn by_eye(&self, path: &Path, index: usize) -> f64 {
        let vertices = path.vertices();
        if index == 1 {
            let pixels = self.space.pixels_around(&vertices[0], &vertices[1]);
            return pixels.unwrap_or(0.0);
        }
        let (before, vertex) = (&vertices[index - 1], &vertices[index]);
        self.scattering(path, index - 1, false) * self.space.solid_angle_per_area(before, vertex)
    }

    /// Density of sampling a vertex from the light's side.
    fn by_light(&self, path: &Path, index: usize) -> f64 {
        let (vertices, last) = (path.vertices(), path.edges());
        let vertex = &vertices[index];
        let lights = self.space.scene.lights();
        if index == last {
            let (point, direction) = self.emission(path);
            let is_far = vertex.kind == VertexKind::Infinity;
            let id = vertex.emitter().expect("the last vertex is a light");
            let choice = match self.mistake {
                Mistake::UniformChoice => 1.0 / lights.emitters().len() as f64,
                _ => f64::from(lights.emission_probability(id)),
            };
            return choice * if is_far { direction } else { point };
        }
        let next = &vertices[index + 1];
        let per_area = self.arriving(vertex, next);
        if index + 1 == last {
            let (point, direction) = self.emission(path);
            let is_far = next.kind == VertexKind::Infinity;
            return per_area * if is_far { point } else { direction };
        }
        self.scattering(path, index + 1, true) * per_area
    }

    /// Solid angle, at the vertex nearer to the light, for each area around a vertex on a surface.
    fn arriving(&self, vertex: &PathVertex, from: &PathVertex) -> f64 {
        let (direction, distance_squared) = self.space.edge(vertex, from).expect("an edge");
        let cos = match self.mistake {
            Mistake::NoCosine => 1.0,
            _ => f64::from(vertex.geometric_cos(direction)),
        };
        match (self.mistake, from.event) {
            (Mistake::NoDistance, Event::Emission(_)) => cos,
            _ => cos / f64::from(distance_squared),
        }
    }

    /// Densities of the light's point and of the direction of its ray.
    fn emission(&self, path: &Path) -> (f64, f64) {
        let (vertices, last) = (path.vertices(), path.edges());
        let (light, before) = (&vertices[last], &vertices[last - 1]);
        let (direction, _) = self.space.edge(before, light).expect("an edge");
        let at = (light.kind == VertexKind::Surface).then_some(&light.point);
        let id = light.emitter().expect("the last vertex is a light");
        let found = self
            .space
            .scene
            .lights()
            .emission_density(id, at, -direction);
        let onward = match self.mistake {
            Mistake::UniformEmission if at.is_some() => 0.25 * std::f64::consts::FRAC_1_PI,
            _ => f64::from(found.direction.0),
        };
        (f64::from(found.point.0), onward)
    }

    /// Density with which the light's vertex is sampled from the one before.
    fn direct(&self, path: &Path) -> f64 {
        let (vertices, last) = (path.vertices(), path.edges());
        let (light, before) = (&vertices[last], &vertices[last - 1]);
        if self.mistake == Mistake::DirectAsEmitted {
            return self.by_light(path, last);
        }
        let lights = self.space.scene.lights();
        let id = light.emitter().expect("the last vertex is a light");
        let from = before.position();
        match light.event {
            Event::Emission(EmitterClass::Area) => {
                let density = lights.density_toward(id, from, &light.point).0;
                f64::from(density) * self.space.solid_angle_per_area(before, light)
            }
            Event::Emission(EmitterClass::Environment) => {
                f64::from(lights.environment_density(from, light.position()).0)
            }
            Event::Emission(EmitterClass::Collimated) => 0.0,
            _ => f64::from(lights.probability(id, from)),
        }
    }

    /// Density with which a vertex between sends a subpath on, per solid angle of the direction that it takes;
    /// of a Dirac event per solid angle of the direction to the light, so that those of both sides can be
    /// compared.
    ///
    /// - `to_eye`: whether the subpath comes from the light.
    fn scattering(&self, path: &Path, index: usize, to_eye: bool) -> f64 {
        let vertices = path.vertices();
        let vertex = &vertices[index];
        let frame = vertex.point.shading_frame();
        let local = |other: usize| {
            let (direction, _) = self.space.edge(vertex, &vertices[other]).expect("an edge");
            frame.to_local(direction)
        };
        let (eye, light) = (local(index - 1), local(index + 1));
        let bsdf = self.space.bsdf(vertex).expect("a surface");
        let (wi, wo, transport) = if to_eye {
            (light, eye, Transport::Importance)
        } else {
            (eye, light, Transport::Radiance)
        };
        let Some(component) = vertex.event.component() else {
            return f64::from(bsdf.density(wi, wo, &vertex.point, transport).0);
        };
        let follow = |wi, transport| bsdf.follow(wi, &vertex.point, transport, component);
        let forward = follow(eye, Transport::Radiance).expect("the path exists");
        if !to_eye {
            return f64::from(forward.probability);
        }
        let probability = match self.mistake {
            Mistake::CertainComponent => 1.0,
            _ => {
                follow(light, Transport::Importance).map_or(0.0, |back| f64::from(back.probability))
            }
        };
        match self.mistake {
            Mistake::NoStretch => probability,
            _ => probability / f64::from(forward.inverse_stretch()),
        }
    }

    /// Densities of all techniques, by the number of vertices of the eye subpath.
    pub(crate) fn all(&self, path: &Path) -> Vec<f64> {
        let last = path.edges();
        let eye: Vec<f64> = (1..=last).map(|index| self.by_eye(path, index)).collect();
        let light: Vec<f64> = (1..=last).map(|i| self.by_light(path, i)).collect();
        (0..=last)
            .map(|technique| {
                if !self.is_possible(path, technique) {
                    return 0.0;
                }
                let eye: f64 = eye[..technique].iter().product();
                let is_direct = technique > 0 && technique + 1 == last;
                let light = if is_direct {
                    self.direct(path)
                } else {
                    light[technique..].iter().product()
                };
                let is_image = technique == 0 && self.mistake != Mistake::OneLightPath;
                eye * light * if is_image { self.light_paths } else { 1.0 }
            })
            .collect()
    }

    /// Whether a technique makes such paths.
    fn is_possible(&self, path: &Path, technique: usize) -> bool {
        let (vertices, last) = (path.vertices(), path.edges());
        let is_dirac_light = match vertices[last].event {
            Event::Emission(class) => class.is_dirac(),
            _ => false,
        };
        if technique == last {
            return !is_dirac_light;
        }
        let is_open = |index: usize| {
            let is_between = (1..last).contains(&index);
            !is_between || !vertices[index].event.is_dirac()
        };
        self.mistake == Mistake::DiracConnected || is_open(technique) && is_open(technique + 1)
    }
}
