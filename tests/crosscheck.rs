//! Embree and the tree of obvhs see the same scenes.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64};

use lumiflow::accel::{
    CurveBasis, CurveBuffer, Engine, Geometry, IndexBuffer, Instance, Ray, VertexBuffer,
    prepare_worker,
};
use lumiflow::math::Vec3;
use lumiflow::random::{Purpose, Stream};
use lumiflow::report::crosscheck::{
    Camera, Crosscheck, Outcome, Query, Right, Subject, parse_ray, ray_text,
};
use lumiflow::scene::import::{ImportOptions, import};

use crate::support::effort;
use crate::support::source_code::project;

/// Checks both tracers, obvhs's on a copy that may be broken.
fn check_against(
    subject: &Subject,
    copy: &Subject,
    camera: Option<Camera<'_>>,
    rays: u32,
    threads: usize,
) -> Outcome {
    let embree = subject.build(Engine::Embree).expect("Embree takes it");
    let obvhs = copy.build(Engine::Obvhs).expect("obvhs takes it");
    let check = Crosscheck::new(subject, [&embree, &obvhs], camera, effort::seed(0));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .start_handler(|_| prepare_worker())
        .build()
        .expect("threads");
    pool.install(|| check.run(rays, &AtomicU64::new(0), &AtomicBool::new(false)))
}

/// What both tracers and the referee say of the first real disagreement.
fn first_real(subject: &Subject, outcome: &Outcome) -> String {
    let engines = [Engine::Embree, Engine::Obvhs];
    let [embree, obvhs] = engines.map(|engine| subject.build(engine).expect("it was built"));
    let check = Crosscheck::new(subject, [&embree, &obvhs], None, effort::seed(0));
    let replayed = outcome
        .real
        .iter()
        .map(|found| (found, check.replay(&found.ray)));
    let lines = replayed.take(4).map(|found| format!("{found:?}"));
    lines.collect::<Vec<_>>().join("\n")
}

fn agree(name: &str, subject: &Subject, camera: Option<Camera<'_>>, rays: u32) {
    let outcome = check_against(subject, subject, camera, rays, 2);
    let (total, table) = (outcome.tally.total(), outcome.tally.table());
    assert_eq!(
        outcome.tally.real(),
        0,
        "{name}\n{table}\n{}",
        first_real(subject, &outcome)
    );
    assert_eq!(total.rays, u64::from(rays));
    assert!(
        total.hits * 3 > total.rays,
        "{name}: hits are rare\n{table}"
    );
}

/// The scene files of the project.
fn scenes() -> Vec<PathBuf> {
    let folders = std::fs::read_dir(project().join("scenes")).expect("the folder of scenes");
    let files = folders.map(|folder| folder.expect("a folder").path().join("scene.xml"));
    let mut files: Vec<PathBuf> = files.filter(|file| file.is_file()).collect();
    files.sort();
    files
}

fn agree_on(file: &Path, rays: u32) {
    let imported = import(file, &ImportOptions::default()).expect("the scene is sound");
    let view = imported.views.first().expect("a sensor");
    let camera = Camera {
        sensor: &view.sensor,
        film_size: view.film_size,
    };
    let subject = Subject::of(&imported.scene);
    agree(&file.display().to_string(), &subject, Some(camera), rays);
}

#[test]
fn both_tracers_agree_on_all_scenes() {
    let files = scenes();
    assert!(files.len() >= 10, "{files:?}");
    for file in files {
        agree_on(&file, effort::samples(18_000));
    }
}

fn point(stream: &mut Stream) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| 2.0 * stream.next_f32() - 1.0))
}

/// Triangles of a size, as a mesh of their own corners; slivers where `flat` is small.
fn triangles(stream: &mut Stream, count: u32, size: f32, flat: f32, offset: Vec3) -> Geometry {
    let vertices = (0..count).flat_map(|_| {
        let (middle, side) = (offset + point(stream), size * point(stream));
        let across = flat * size * point(stream);
        [middle, middle + side, middle + 0.5 * side + across].map(|corner| corner.to_array())
    });
    let vertices = VertexBuffer::new(vertices.collect());
    let corners = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Geometry::Triangles(vertices, IndexBuffer::new(corners.collect()))
}

/// A bumpy sheet of shared corners, with degenerate triangles in it, and each triangle `copies` times.
fn sheet(stream: &mut Stream, offset: Vec3, copies: usize) -> Geometry {
    const SIDE: u32 = 16;
    let place = |i: u32| i as f32 / SIDE as f32 * 2.0 - 1.0;
    let corners = (0..=SIDE).flat_map(|y| (0..=SIDE).map(move |x| (x, y)));
    let corners = corners.map(|(x, y)| {
        let height = 0.1 * stream.next_f32();
        (offset + Vec3::new(place(x), place(y), height)).to_array()
    });
    let vertices = VertexBuffer::new(corners.collect());
    let mut indices = Vec::new();
    for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
        let first = y * (SIDE + 1) + x;
        let (right, up) = (first + 1, first + SIDE + 1);
        let cell = [[first, right, up], [right, up + 1, up], [first, first, up]];
        indices.extend((0..copies).flat_map(|_| cell));
    }
    Geometry::Triangles(vertices, IndexBuffer::new(indices))
}

fn of(geometries: Vec<Geometry>) -> Subject {
    Subject {
        geometries,
        ..Subject::default()
    }
}

#[test]
fn both_tracers_agree_on_random_meshes() {
    let mut stream = Stream::new(effort::seed(7), Purpose::Check, 0, 0);
    let rays = effort::samples(9_000);
    let far = Vec3::new(3000.0, -2000.0, 500.0);
    for (name, size, flat, offset) in [
        ("plain", 0.5, 1.0, Vec3::ZERO),
        ("slivers", 0.8, 1e-4, Vec3::ZERO),
        ("thinner slivers", 0.8, 1e-7, Vec3::ZERO),
        ("small", 0.01, 1.0, Vec3::ZERO),
        ("away", 0.5, 1.0, far),
    ] {
        let mut mesh = vec![triangles(&mut stream, 300, size, flat, offset)];
        // Something that most rays hit, where the mesh is nearly nothing.
        mesh.push(sheet(&mut stream, offset, 1));
        agree(name, &of(mesh), None, rays);
    }
    let doubled = sheet(&mut stream, Vec3::ZERO, 3);
    agree("coplanar duplicates", &of(vec![doubled]), None, rays);
    agree(
        "a sheet away",
        &of(vec![sheet(&mut stream, far, 1)]),
        None,
        rays,
    );
}

/// Rays from high above a sheet, so that no edge is a silhouette, aimed at inner edges of it: how many of
/// 30 000 pass through, by a tracer.
fn slipping(engine: Engine, as_instance: bool) -> usize {
    let mut stream = Stream::new(11, Purpose::Check, 0, 0);
    let mesh = sheet(&mut stream, Vec3::ZERO, 1);
    let Geometry::Triangles(vertices, indices) = &mesh else {
        unreachable!("a mesh")
    };
    let (corners, cells) = (vertices.as_slice(), indices.as_slice());
    let rays = (0..30_000).map(|_| {
        // The edge between the two triangles of a cell.
        let cell = 3 * (stream.next_f32() * (cells.len() / 3) as f32) as usize;
        let [_, from, to] = cells[cell].map(|corner| Vec3::from(corners[corner as usize]));
        let aim = from.lerp(to, 0.1 + 0.8 * stream.next_f32());
        let origin = point(&mut stream).with_z(8.0);
        Ray::new(origin, aim - origin)
    });
    let rays: Vec<Ray> = rays.collect();
    let instance = Instance {
        group: 0,
        to_world: [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ],
    };
    let subject = match as_instance {
        true => Subject {
            groups: vec![vec![mesh]],
            instances: vec![instance],
            ..Subject::default()
        },
        false => of(vec![mesh]),
    };
    let accel = subject.build(engine).expect("it is sound");
    assert_eq!(accel.engine(), engine);
    rays.iter()
        .filter(|ray| accel.intersect(ray).is_none())
        .count()
}

#[test]
fn rays_slip_through_between_triangles_only_without_the_robust_mode() {
    for as_instance in [false, true] {
        let [robust, fast, obvhs] = Engine::ALL.map(|engine| slipping(engine, as_instance));
        assert_eq!((robust, obvhs), (0, 0));
        assert!(fast > 100, "{fast} of 30 000");
    }
}

/// A stretched, slanted and moved space.
const MAP: [[f32; 4]; 3] = [
    [0.7, 0.1, 0.2, 0.6],
    [-0.2, 0.5, 0.0, -0.7],
    [0.0, 0.3, -0.9, 0.3],
];

#[test]
fn both_tracers_agree_on_round_shapes_and_instances() {
    let mut stream = Stream::new(effort::seed(8), Purpose::Check, 0, 0);
    let rays = effort::samples(9_000);
    let shapes = vec![
        Geometry::Sphere {
            centre: Vec3::new(-0.5, 0.2, 0.1),
            radius: 0.6,
        },
        Geometry::Disk(MAP),
        Geometry::Cylinder(MAP),
        sheet(&mut stream, Vec3::ZERO, 1),
    ];
    agree("shapes", &of(shapes.clone()), None, rays);
    let turned = [MAP[1], MAP[2], MAP[0]];
    let mirrored = MAP.map(|[x, y, z, w]| [-x, y, z, 40.0 * w]);
    let instances = [MAP, turned, mirrored];
    let subject = Subject {
        geometries: vec![triangles(&mut stream, 50, 0.5, 1.0, Vec3::ZERO)],
        groups: vec![shapes],
        instances: instances
            .map(|to_world| Instance { group: 0, to_world })
            .to_vec(),
    };
    agree("instances", &subject, None, rays);
}

#[test]
fn both_tracers_agree_on_wires() {
    let mut stream = Stream::new(effort::seed(9), Purpose::Check, 0, 0);
    let points = (0..12).map(|i| {
        let middle = Vec3::new(0.2 * i as f32, 0.0, 0.0) + 0.15 * point(&mut stream);
        middle.extend(0.15 + 0.05 * stream.next_f32()).to_array()
    });
    let curves = CurveBuffer::new(points.collect(), (0..11).collect());
    let wires = Geometry::Curves(CurveBasis::Linear, curves);
    agree("wires", &of(vec![wires]), None, effort::samples(1_800));
}

/// The same mesh with its list of triangles changed.
fn changed(subject: &Subject, change: impl FnOnce(&mut Vec<[u32; 3]>)) -> Subject {
    let Geometry::Triangles(vertices, triangles) = &subject.geometries[0] else {
        unreachable!("a mesh")
    };
    let mut triangles = triangles.as_slice().to_vec();
    change(&mut triangles);
    let triangles = IndexBuffer::new(triangles);
    of(vec![Geometry::Triangles(vertices.clone(), triangles)])
}

#[test]
fn planted_errors_are_found_and_can_be_replayed() {
    let mut stream = Stream::new(10, Purpose::Check, 0, 0);
    let sound = of(vec![sheet(&mut stream, Vec3::ZERO, 1)]);
    // A triangle that has no corners apart stands for one that is not there, so that no other one is
    // renamed; and one whose last corner is another's.
    let dropped = changed(&sound, |triangles| triangles[300] = [0, 0, 0]);
    let swapped = changed(&sound, |triangles| triangles[300][2] += 1);
    let embree = sound.build(Engine::Embree).unwrap();
    for (name, broken) in [("dropped", dropped), ("swapped", swapped)] {
        let outcome = check_against(&sound, &broken, None, 18_000, 2);
        assert!(
            outcome.tally.real() > 5,
            "{name}\n{}",
            outcome.tally.table()
        );
        let obvhs = broken.build(Engine::Obvhs).unwrap();
        let check = Crosscheck::new(&sound, [&embree, &obvhs], None, effort::seed(0));
        for found in &outcome.real {
            assert_eq!(found.right, Right::Embree, "{name}: {found:?}");
            assert_eq!(check.ray(found.address), Some(found.ray));
            let (_, again) = check.replay(&parse_ray(&ray_text(&found.ray)).unwrap());
            let same = |(query, _, right): &(Query, _, Right)| {
                (*query, *right) == (found.query, found.right)
            };
            assert!(again.iter().any(same), "{name}: {found:?}, again {again:?}");
        }
    }
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let mut stream = Stream::new(11, Purpose::Check, 0, 0);
    let sound = of(vec![sheet(&mut stream, Vec3::ZERO, 1)]);
    let broken = changed(&sound, |triangles| triangles[100] = [0, 0, 0]);
    let found = [1, 3].map(|threads| check_against(&sound, &broken, None, 9_000, threads));
    assert_eq!(found[0].tally, found[1].tally);
    assert_eq!(found[0].real, found[1].real);
    assert!(!found[0].real.is_empty());
}
