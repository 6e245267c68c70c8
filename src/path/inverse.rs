//! From a path back to the uniform numbers that it is made of.
//!
//! A path, and the technique that is to make it, tell most of a sample's numbers; what they leave open is
//! drawn. Numbers found so for the path of a sample of uniform numbers are spread as those numbers were: a
//! chain can go from paths to numbers and back without a change of its target but the Jacobian, which is the
//! density of the path.
//!
//! The price of positions that are rounded: numbers found make the path up to rounding, which grows from
//! vertex to vertex. And a technique by which a path is unlikely needs numbers as fine as that: a lobe of
//! probability 2⁻²⁰ has 4 bits of a number.

use super::bidirectional::kept;
use super::tracer::survival_of;
use super::{Bidirectional, Event, Path, PathSpace, PathTracing, PathVertex, VertexKind};
use crate::bsdf::{BsdfModel, BsdfSample, SampleNumbers, Sampled, Spare, Transport};
use crate::emitter::{EmitterModel, RayOfLight};
use crate::math::{Rgb, Vec2, Vec3, warp};
use crate::random::{PrimarySample, Stream};
use crate::sensor::SensorModel;

/// What Russian roulette looks at.
enum Roulette {
    /// What the path has come to, as in [`PathTracing`].
    Path { throughput: Rgb, eta: f32 },
    /// The last event, as in [`Bidirectional`].
    Event,
}

impl Roulette {
    const PATH: Self = Self::Path {
        throughput: Rgb::WHITE,
        eta: 1.0,
    };

    /// The probability that a path goes on with a sample; `None` where there is no roulette.
    fn survival(
        &mut self,
        sample: &BsdfSample,
        transport: Transport,
        is_played: bool,
    ) -> Option<f32> {
        match self {
            Self::Path { throughput, eta } => {
                *throughput *= sample.weight;
                *eta *= sample.eta;
                let survival = survival_of(throughput.max_channel() / (*eta * *eta));
                if is_played {
                    *throughput *= 1.0 / survival;
                }
                is_played.then_some(survival)
            }
            Self::Event => is_played.then(|| survival_of(kept(sample, transport))),
        }
    }
}

/// A subpath whose numbers are looked for.
struct Subpath<'a, 's, N> {
    space: &'a PathSpace<'s>,
    /// What it carries.
    transport: Transport,
    /// Number of edges from which on there is Russian roulette.
    rr_depth: u32,
    roulette: Roulette,
    /// Stands in for what the path leaves open.
    spare: &'a mut Stream,
    to: &'a mut N,
}

impl<N: PrimarySample> Subpath<'_, '_, N> {
    /// A pair of numbers for what is left open.
    fn open(&mut self) -> Vec2 {
        self.spare.next_vec2()
    }

    /// The numbers of what happens at a vertex; `None` where no numbers lead on to the next one.
    ///
    /// - `around`: the vertex between those before and after it on the subpath.
    /// - `edges`: of the subpath up to the vertex.
    fn scatter(&mut self, around: [&PathVertex; 3], edges: u32) -> Option<()> {
        let [before, vertex, after] = around;
        let space = self.space;
        let lobes = space.scene.objects().get(vertex.object()?)?.lobes;
        let (bsdf, frame) = (space.bsdf(vertex)?, vertex.point.shading_frame());
        let wi = frame.to_local(space.edge(vertex, before)?.0);
        let sampled = match vertex.event.component() {
            Some(component) => Sampled::Dirac(component),
            None => Sampled::Finite(frame.to_local(space.edge(vertex, after)?.0)),
        };
        let spare = Spare {
            lobe: self.spare.next_f32(),
            numbers: SampleNumbers {
                u_lobe: self.spare.next_f32(),
                u: self.open(),
            },
        };
        let point = &vertex.point;
        let found = bsdf.invert(wi, sampled, point, self.transport, spare)?;
        let u_lobe = if lobes.single { 0.0 } else { found.u_lobe };
        let again = bsdf.sample(wi, point, self.transport, u_lobe, found.u)?;
        // Where rounding has led to another lobe, the path does not come back.
        if Event::of(&again) != vertex.event {
            return None;
        }
        if !lobes.single {
            self.to.put_1d(u_lobe);
        }
        self.to.put_2d(found.u);
        let is_played = edges >= self.rr_depth;
        if let Some(survival) = self.roulette.survival(&again, self.transport, is_played) {
            let number = warp::within(self.spare.next_f32(), 0.0, survival);
            self.to.put_1d(number);
        }
        Some(())
    }

    /// The numbers of a subpath from the sensor, those of its raster position left out.
    ///
    /// - `eye`: number of its vertices beyond the lens.
    /// - `is_lit`: whether the last of them samples a light.
    fn eye_side(&mut self, path: &Path, eye: usize, is_lit: bool) -> Option<()> {
        let (space, vertices) = (self.space, path.vertices());
        let open = self.open();
        let lens = space.sensor.invert_lens(vertices[0].position(), open);
        self.to.put_2d(lens);
        for index in 1..=eye {
            let vertex = &vertices[index];
            let is_last = index == eye;
            if is_last && !is_lit {
                break;
            }
            self.to.begin_vertex(index as u32);
            let object = space.scene.objects().get(vertex.object()?)?;
            if is_last {
                let numbers = self.toward_light(path)?;
                self.to.put_2d(numbers);
                break;
            }
            if object.lobes.finite {
                self.to.skip_2d();
            }
            let around = [&vertices[index - 1], vertex, &vertices[index + 1]];
            self.scatter(around, index as u32)?;
        }
        Some(())
    }

    /// The numbers with which the vertex before the light samples it.
    fn toward_light(&mut self, path: &Path) -> Option<Vec2> {
        let (vertices, last) = (path.vertices(), path.edges());
        let (vertex, light) = (&vertices[last - 1], &vertices[last]);
        let (toward, _) = self.space.edge(vertex, light)?;
        let at = (light.kind == VertexKind::Surface).then_some(&light.point);
        let open = self.open();
        let lights = self.space.scene.lights();
        lights.invert_toward(light.emitter()?, (vertex.position(), toward), at, open)
    }

    /// The numbers of a subpath from the light, with those of the lens that it is connected to.
    ///
    /// - `light`: number of its vertices, the light's own included.
    fn light_side(&mut self, path: &Path, light: usize) -> Option<()> {
        let (vertices, last) = (path.vertices(), path.edges());
        if light == last {
            let open = self.open();
            let sensor = self.space.sensor;
            self.to
                .put_2d(sensor.invert_lens(vertices[0].position(), open));
        } else {
            self.to.skip_2d();
        }
        self.emission(path, light > 1)?;
        for number in 1..light.saturating_sub(1) {
            let index = last - number;
            self.to.begin_vertex(number as u32);
            let around = [&vertices[index + 1], &vertices[index], &vertices[index - 1]];
            self.scatter(around, number as u32)?;
        }
        Some(())
    }

    /// The numbers of the ray that leaves the light.
    ///
    /// - `goes_on`: whether the vertex before the light is met by it; if not, the ray is not known but for
    ///   where the light is.
    fn emission(&mut self, path: &Path, goes_on: bool) -> Option<()> {
        let (vertices, last) = (path.vertices(), path.edges());
        let (light, next) = (&vertices[last], &vertices[last - 1]);
        let (id, lights) = (light.emitter()?, self.space.scene.lights());
        let is_far = light.kind == VertexKind::Infinity;
        let at = (light.kind == VertexKind::Surface).then_some(&light.point);
        let ray = RayOfLight {
            through: if goes_on {
                next.position()
            } else {
                self.space.scene.bounds().centre
            },
            direction: match (is_far, at) {
                (true, _) => -light.position(),
                (false, Some(at)) if !goes_on => at.geometric_normal,
                (false, None) if !goes_on => Vec3::Z,
                _ => self.space.edge(light, next)?.0,
            },
        };
        let choice = lights.invert_emission_choice(id, self.spare.next_f32())?;
        let open = [self.open(), self.open()];
        let found = lights.get(id).invert_emission(at, ray, open)?;
        self.to.put_1d(choice);
        for (numbers, is_known) in found
            .into_iter()
            .zip([goes_on || !is_far, goes_on || is_far])
        {
            if is_known {
                self.to.put_2d(numbers);
            } else {
                self.to.skip_2d();
            }
        }
        Some(())
    }
}

/// Whether a technique can make a path: connected vertices scatter by a density, and a ray can meet the light.
fn makes(path: &Path, (eye, light): (usize, usize)) -> bool {
    let (vertices, last) = (path.vertices(), path.edges());
    let Event::Emission(class) = vertices[last].event else {
        return false;
    };
    let is_open = |index: usize| vertices[index].event == Event::Finite;
    let counts = eye + light == last;
    counts
        && match (eye, light) {
            (_, 0) | (0, 1) => !class.is_dirac(),
            (0, _) => is_open(1),
            (_, 1) => is_open(eye) && class.is_connectable(),
            _ => is_open(eye) && is_open(eye + 1),
        }
}

impl PathTracing {
    /// Goes back from a path to the numbers with which [`PathTracing::trace`] makes it, those of the raster
    /// position left out: they come first.
    ///
    /// - `is_explicit`: whether its light is to be sampled from the vertex before, and not met by chance.
    /// - `spare`: numbers for what the path leaves open; see [`BsdfModel::invert`].
    /// - `to`: takes the numbers.
    ///
    /// `None` where no numbers make it so, or rounding does not let the path come back; `to` then has some
    /// of them.
    pub fn invert(
        &self,
        space: &PathSpace<'_>,
        path: &Path,
        is_explicit: bool,
        spare: &mut Stream,
        to: &mut impl PrimarySample,
    ) -> Option<()> {
        let eye = path.edges() - usize::from(is_explicit);
        let can = eye > 0 && makes(path, (eye, usize::from(is_explicit)));
        let mut subpath = Subpath {
            space,
            transport: Transport::Radiance,
            rr_depth: self.rr_depth,
            roulette: Roulette::PATH,
            spare,
            to,
        };
        can.then_some(())?;
        subpath.eye_side(path, eye, is_explicit)
    }
}

impl Bidirectional {
    /// Goes back from a path to the numbers with which [`Bidirectional::trace`] and, without the roulette's,
    /// [`Bidirectional::trace_technique`] make it by a technique; those of the raster position are left out: they
    /// come first on the eye's side.
    ///
    /// - `technique`: numbers of vertices of the eye's and of the light's side, as in
    ///   [`Connection`](super::Connection).
    /// - `spare`: numbers for what the path leaves open; see [`BsdfModel::invert`].
    /// - `sides`: take the numbers of the eye's and of the light's side.
    ///
    /// `None` where the technique does not make it, or rounding does not let the path come back; the sides then
    /// have some of its numbers.
    pub fn invert(
        &self,
        space: &PathSpace<'_>,
        path: &Path,
        technique: (usize, usize),
        spare: &mut Stream,
        [to_eye, to_light]: [&mut impl PrimarySample; 2],
    ) -> Option<()> {
        let ((eye, light), techniques) = (technique, self.techniques);
        if !makes(path, technique) || eye == 0 && !techniques.light_image {
            return None;
        }
        let is_lit = light == 1 && techniques.sample_direct;
        let mut subpath = Subpath {
            space,
            transport: Transport::Radiance,
            rr_depth: self.rr_depth,
            roulette: Roulette::Event,
            spare: &mut *spare,
            to: to_eye,
        };
        if eye > 0 {
            subpath.eye_side(path, eye, is_lit)?;
        }
        let mut subpath = Subpath {
            space,
            transport: Transport::Importance,
            rr_depth: self.rr_depth,
            roulette: Roulette::Event,
            spare,
            to: to_light,
        };
        if light > 0 && (eye == 0 || !is_lit) {
            subpath.light_side(path, light)?;
        }
        Some(())
    }
}
