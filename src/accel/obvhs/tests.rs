//! Both tracers on the same geometry: what they say is compared ray by ray in `report::crosscheck`; here
//! each kind of geometry is met at all, and the rules of the interface hold.

use embree4_sys::{CurveBasis, CurveBuffer, IndexBuffer, VertexBuffer};

use crate::accel::{Accel, AccelError, Engine, Geometry, Hit, Instance, Ray};
use crate::math::Vec3;
use crate::random::{Purpose, Stream};

const NO_GROUPS: [Vec<Geometry>; 0] = [];

fn point(stream: &mut Stream) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| 2.0 * stream.next_f32() - 1.0))
}

fn triangles(stream: &mut Stream, count: u32) -> Geometry {
    let vertices = (0..count).flat_map(|_| {
        let middle = point(stream);
        [(); 3].map(|()| (middle + 0.4 * point(stream)).to_array())
    });
    let vertices = VertexBuffer::new(vertices.collect());
    let corners = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Geometry::Triangles(vertices, IndexBuffer::new(corners.collect()))
}

fn curves(stream: &mut Stream, basis: CurveBasis) -> Geometry {
    let mut points = Vec::new();
    let mut place = point(stream);
    for _ in 0..6 {
        points.push(place.extend(0.1 + 0.02 * stream.next_f32()).to_array());
        // Bent by less than its radius, or circles across it would meet on the inner side.
        place += 0.2 * point(stream) + 0.4 * Vec3::X;
    }
    let segments = (0..=6 - basis.points_per_segment() as u32).collect();
    Geometry::Curves(basis, CurveBuffer::new(points, segments))
}

/// A slanted, stretched and moved space.
const MAP: [[f32; 4]; 3] = [
    [0.7, 0.1, 0.2, 0.1],
    [-0.2, 0.5, 0.0, -0.2],
    [0.0, 0.3, -0.9, 0.3],
];

fn one_of_each(stream: &mut Stream) -> [Geometry; 6] {
    [
        triangles(stream, 30),
        curves(stream, CurveBasis::Linear),
        curves(stream, CurveBasis::BSpline),
        Geometry::Sphere {
            centre: point(stream),
            radius: 0.4,
        },
        Geometry::Disk(MAP),
        Geometry::Cylinder(MAP),
    ]
}

fn near(a: &Hit, b: &Hit) -> bool {
    let normals = [a.normal, b.normal].map(|normal| Vec3::from_array(normal).normalize());
    let same_turn = |a: f32, b: f32| (a - b).abs() < 2e-3 || (a - b).abs() > 1.0 - 2e-3;
    (a.distance - b.distance).abs() < 2e-4 * a.distance.max(1.0)
        && same_turn(a.u, b.u)
        && same_turn(a.v, b.v)
        && normals[0].dot(normals[1]) > 0.999
}

#[test]
fn each_kind_of_geometry_is_met_where_embree_meets_it() {
    let mut stream = Stream::new(1, Purpose::Check, 0, 0);
    for round in 0..4 {
        for geometry in one_of_each(&mut stream) {
            let group = || [vec![geometry.clone()]];
            let turned = Instance {
                group: 0,
                to_world: [MAP[1], MAP[2], MAP[0]],
            };
            let [embree, obvhs] = [Engine::Embree, Engine::Obvhs]
                .map(|engine| Accel::build(engine, [geometry.clone()], group(), [turned]).unwrap());
            let (mut met, mut differ) = (0, 0);
            for _ in 0..3000 {
                let origin = 3.0 * point(&mut stream);
                let ray = Ray::new(origin, point(&mut stream) - origin);
                let found = [embree.intersect(&ray), obvhs.intersect(&ray)];
                assert_eq!(obvhs.is_occluded(&ray), found[1].is_some());
                match found {
                    [None, None] => {}
                    [Some(a), Some(b)] => {
                        met += 1;
                        let same = (a.geometry, a.instance, a.primitive)
                            == (b.geometry, b.instance, b.primitive);
                        differ += usize::from(!(same && near(&a, &b)));
                    }
                    _ => differ += 1,
                }
            }
            assert!(met > 50, "{round}: {met} hits on {geometry:?}");
            assert!(
                differ * 100 <= met,
                "{round}: {differ} of {met} on {geometry:?}"
            );
        }
    }
}

#[test]
fn the_interval_includes_its_ends_and_broken_rays_miss() {
    let corners = vec![[0.0, 0.0, 3.0], [4.0, 0.0, 3.0], [0.0, 2.0, 3.0]];
    let layer = Geometry::Triangles(
        VertexBuffer::new(corners),
        IndexBuffer::new(vec![[0, 1, 2]]),
    );
    for engine in Engine::ALL {
        let accel = Accel::build(engine, [layer.clone()], NO_GROUPS, []).unwrap();
        let up = Ray::new(Vec3::new(1.0, 0.5, 0.0), Vec3::Z);
        // 3, but for the last bits of what Embree takes for one over a number.
        let distance = accel.intersect(&up).expect("a hit").distance;
        assert!((distance - 3.0).abs() < 3e-6, "{engine}: {distance}");
        for (near, far, expected) in [
            (0.0, distance, true),
            // What Embree does at the near end is as its robust mode has it.
            (distance, 9.0, engine != Engine::EmbreeFast),
            (distance, distance, engine != Engine::EmbreeFast),
            (0.0, 2.999, false),
            (3.001, 9.0, false),
            (4.0, 2.0, false),
            (-1.0, 9.0, false),
            (f32::NAN, 9.0, false),
        ] {
            let ray = up.between(near, far);
            assert_eq!(
                accel.intersect(&ray).is_some(),
                expected,
                "{engine} {ray:?}"
            );
            assert_eq!(accel.is_occluded(&ray), expected, "{engine} {ray:?}");
        }
        for (origin, direction) in [
            (Vec3::new(f32::NAN, 0.0, 0.0), Vec3::Z),
            (up.origin(), Vec3::splat(f32::NAN)),
            (up.origin(), Vec3::ZERO),
            (Vec3::splat(1e30), -Vec3::ONE),
        ] {
            let ray = Ray::new(origin, direction);
            assert_eq!(accel.intersect(&ray), None, "{engine} {ray:?}");
            assert!(!accel.is_occluded(&ray));
        }
    }
}

#[test]
fn nothing_is_missed_and_many_of_the_same_are_no_harm() {
    let empty = Accel::build(Engine::Obvhs, [], NO_GROUPS, []).unwrap();
    assert_eq!(empty.bounding_box(), None);
    assert_eq!(empty.intersect(&Ray::new(Vec3::ZERO, Vec3::X)), None);
    let corners = vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    let same = IndexBuffer::new(vec![[0, 1, 2]; 700]);
    let layer = Geometry::Triangles(VertexBuffer::new(corners), same);
    let accel = Accel::build(Engine::Obvhs, [layer], NO_GROUPS, []).unwrap();
    let hit = accel.intersect(&Ray::new(Vec3::new(0.2, 0.2, 0.0), Vec3::Z));
    assert_eq!(hit.map(|hit| (hit.distance, hit.u)), Some((1.0, 0.2)));
}

#[test]
fn what_embree_refuses_is_refused() {
    let broken = VertexBuffer::new(vec![[0.0; 3], [f32::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let mesh = Geometry::Triangles(broken, IndexBuffer::new(vec![[0, 1, 2]]));
    let sphere = |radius| Geometry::Sphere {
        centre: Vec3::ZERO,
        radius,
    };
    for bad in [mesh, sphere(0.0), Geometry::Disk([[0.0; 4]; 3])] {
        let messages = Engine::ALL.map(|engine| {
            let built = Accel::build(engine, [sphere(1.0), bad.clone()], NO_GROUPS, []);
            let error = built.expect_err("it cannot be built");
            let AccelError::Geometry { index: 1, .. } = error else {
                panic!("{error}")
            };
            error.to_string()
        });
        let [embree, fast, obvhs] = messages;
        assert_eq!(embree.replace("Embree", "obvhs"), obvhs);
        assert_eq!(fast, embree);
    }
}

#[test]
fn the_release_is_that_of_the_lock_file() {
    let lock = include_str!("../../../Cargo.lock");
    let entry = format!("name = \"obvhs\"\nversion = \"{}\"", super::VERSION);
    assert!(lock.contains(&entry), "expected {entry}");
}
