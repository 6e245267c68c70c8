//! How many rays a second one core traces in a Cornell box: the limit that a renderer is measured
//! against.
//!
//! `cargo run --release -p embree4-sys --example throughput`
//!
//! The box has 36 triangles. The rays are those of a path tracer that bounces diffusely, in its
//! order, so neighbours share nothing; shadow rays go from each bounce to a point of the lamp. The
//! best of several rounds is printed, since anything else on the machine only slows it down.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use embree4_sys::{
    BuildOptions, CommittedScene, Device, IndexBuffer, Ray, SceneBuilder, VertexBuffer,
    flush_denormals,
};

type Vector = [f32; 3];
/// Four corners in order around the quadrilateral.
type Quad = [Vector; 4];

/// Few enough that a round takes milliseconds and some rounds are not interrupted.
const RAY_COUNT: usize = 50_000;
const ROUNDS: usize = 100;
const LAMP_HEIGHT: f32 = 0.998;

fn main() -> Result<(), Box<dyn Error>> {
    flush_denormals();
    let device = Device::new("threads=1")?;
    println!("Embree {}, one core, Mrays/s", device.version().library);
    println!(
        "{:34}{:>11}{:>11}{:>15}{:>15}",
        "Cornell box, 36 triangles", "intersect", "occluded", "intersect_all", "occluded_all"
    );
    let quads = cornell_box();
    for robust in [true, false] {
        let options = BuildOptions {
            robust,
            ..BuildOptions::default()
        };
        for (layout, per_geometry) in [
            ("1 geometry", 18),
            ("9 geometries", 2),
            ("18 geometries", 1),
        ] {
            let scene = mesh_scene(&device, options, quads.chunks(per_geometry))?;
            let label = format!("{layout}{}", if robust { "" } else { ", not robust" });
            measure(&label, &scene);
        }
    }
    let mut builder = SceneBuilder::new(&device)?;
    add_quads(&mut builder, &quads[..6])?;
    builder.add_sphere([-0.35, -0.6, -0.3], 0.4)?;
    builder.add_sphere([0.4, -0.65, 0.3], 0.35)?;
    measure("12 triangles, 2 exact spheres", &builder.commit()?);
    Ok(())
}

fn measure(label: &str, scene: &CommittedScene) {
    let (rays, shadow_rays) = path_tracer_rays(scene);
    let count =
        |rays: &[Ray], trace: &dyn Fn(&Ray) -> bool| rays.iter().filter(|ray| trace(ray)).count();
    let closest = best_rate(|| count(&rays, &|ray| scene.intersect(ray).is_some()));
    let shadow = best_rate(|| count(&shadow_rays, &|ray| scene.occluded(ray)));
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    let closest_all = best_rate(|| {
        hits.clear();
        scene.intersect_all(rays.iter().copied(), &mut hits);
        hits.len()
    });
    let shadow_all = best_rate(|| {
        occluded.clear();
        scene.occluded_all(shadow_rays.iter().copied(), &mut occluded);
        occluded.len()
    });
    println!("{label:34}{closest:11.2}{shadow:11.2}{closest_all:15.2}{shadow_all:15.2}");
}

/// Millions of rays a second, where a round traces [`RAY_COUNT`] of them.
fn best_rate(mut trace: impl FnMut() -> usize) -> f64 {
    let mut round = || {
        let start = Instant::now();
        black_box(trace());
        RAY_COUNT as f64 / start.elapsed().as_secs_f64() / 1e6
    };
    (0..ROUNDS).map(|_| round()).fold(0.0, f64::max)
}

fn mesh_scene<'a>(
    device: &Device,
    options: BuildOptions,
    geometries: impl Iterator<Item = &'a [Quad]>,
) -> Result<CommittedScene, embree4_sys::Error> {
    let mut builder = SceneBuilder::with_options(device, options)?;
    for quads in geometries {
        add_quads(&mut builder, quads)?;
    }
    builder.commit()
}

fn add_quads(builder: &mut SceneBuilder, quads: &[Quad]) -> Result<(), embree4_sys::Error> {
    let triangles = (0u32..).step_by(4).take(quads.len());
    let triangles = triangles
        .flat_map(|k| [[k, k + 1, k + 2], [k, k + 2, k + 3]])
        .collect();
    let vertices = VertexBuffer::new(quads.as_flattened().to_vec());
    builder
        .add_triangles(&vertices, &IndexBuffer::new(triangles))
        .map(drop)
}

/// Five walls and the lamp of the cube [-1, 1]³, then the six sides of two turned blocks.
fn cornell_box() -> Vec<Quad> {
    let walls = block([0.0; 3], [1.0; 3], 0.0);
    let mut quads: Vec<Quad> = walls.into_iter().take(5).collect();
    quads.push(
        [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]]
            .map(|[x, z]| [x, LAMP_HEIGHT, z]),
    );
    quads.extend(block([-0.35, -0.4, -0.3], [0.3, 0.6, 0.3], 0.3));
    quads.extend(block([0.35, -0.7, 0.35], [0.3, 0.3, 0.3], -0.3));
    quads
}

/// The sides of a box around `center`, turned about the y axis by `angle` in radians. The last one
/// faces +z.
fn block(center: Vector, half: Vector, angle: f32) -> [Quad; 6] {
    let (sine, cosine) = angle.sin_cos();
    let side = |axis: usize, sign: f32| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[s, t]: [f32; 2]| {
            let mut corner = [0.0; 3];
            corner[axis] = sign * half[axis];
            corner[(axis + 1) % 3] = s * half[(axis + 1) % 3];
            corner[(axis + 2) % 3] = t * half[(axis + 2) % 3];
            let [x, y, z] = corner;
            [
                center[0] + cosine * x + sine * z,
                center[1] + y,
                center[2] + cosine * z - sine * x,
            ]
        })
    };
    [
        side(0, -1.0),
        side(0, 1.0),
        side(1, -1.0),
        side(1, 1.0),
        side(2, -1.0),
        side(2, 1.0),
    ]
}

/// Rays that bounce through the scene, and for each one that hits a ray to the lamp.
fn path_tracer_rays(scene: &CommittedScene) -> (Vec<Ray>, Vec<Ray>) {
    let mut numbers = Numbers(1);
    let (mut rays, mut shadow_rays) = (Vec::new(), Vec::new());
    let camera = |numbers: &mut Numbers| {
        let aim = [0.35 * numbers.signed(), 0.35 * numbers.signed(), -1.0];
        Ray {
            origin: [0.0, 0.0, 3.8],
            direction: aim,
            near: 0.0,
            far: f32::INFINITY,
        }
    };
    let mut ray = camera(&mut numbers);
    while rays.len() < RAY_COUNT {
        let hit = scene.intersect(&ray).filter(|_| numbers.signed() < 0.6);
        let Some(hit) = hit else {
            ray = camera(&mut numbers);
            continue;
        };
        let origin: Vector = [0, 1, 2].map(|k| ray.origin[k] + hit.distance * ray.direction[k]);
        let lamp = [
            0.25 * numbers.signed(),
            LAMP_HEIGHT,
            0.25 * numbers.signed(),
        ];
        let to_lamp = [0, 1, 2].map(|k| lamp[k] - origin[k]);
        shadow_rays.push(Ray {
            origin,
            direction: to_lamp,
            near: 1e-4,
            far: 0.999,
        });
        let direction = diffuse_direction(hit.normal, ray.direction, &mut numbers);
        ray = Ray {
            origin,
            direction,
            near: 1e-4,
            far: f32::INFINITY,
        };
        rays.push(ray);
    }
    (rays, shadow_rays)
}

/// A cosine-distributed direction on the side that the ray came from: the unit normal plus a point
/// of the unit sphere.
fn diffuse_direction(normal: Vector, incoming: Vector, numbers: &mut Numbers) -> Vector {
    let normal = unit(normal);
    let side = -dot(normal, incoming).signum();
    let on_sphere = loop {
        let point = [numbers.signed(), numbers.signed(), numbers.signed()];
        if (0.01..1.0).contains(&dot(point, point)) {
            break unit(point);
        }
    };
    unit([0, 1, 2].map(|axis| 1.001 * side * normal[axis] + on_sphere[axis]))
}

fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(vector: Vector) -> Vector {
    let scale = 1.0 / dot(vector, vector).sqrt();
    vector.map(|coordinate| scale * coordinate)
}

/// Uniform numbers from a fixed seed.
struct Numbers(u64);

impl Numbers {
    /// In [-1, 1).
    fn signed(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }
}
