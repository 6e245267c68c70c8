//! Devices, empty scenes, instances, bounds and threads.

use std::sync::Arc;

use embree4_sys::{
    Bounds, BuildOptions, BuildQuality, CommittedScene, Device, Error, Hit, IndexBuffer, Ray,
    SceneBuilder, VertexBuffer, flush_denormals,
};

use crate::{IDENTITY, Numbers, assert_hit, build, ray};

fn triangle() -> (VertexBuffer, IndexBuffer) {
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    (
        VertexBuffer::new(corners),
        IndexBuffer::new(vec![[0, 1, 2]]),
    )
}

#[test]
fn the_library_is_the_one_of_the_headers() -> Result<(), Error> {
    let versions = Device::new("")?.version();
    assert_eq!(versions.header.major, versions.library.major);
    assert!(versions.library.major == 3 || versions.library.major == 4);
    let text = versions.library.to_string();
    assert_eq!(text.split('.').count(), 3, "{text}");
    Ok(())
}

#[test]
fn memory_is_counted_and_given_back() -> Result<(), Error> {
    let device = Device::new("")?;
    let before = device.memory();
    let side = 100_u32;
    let corner = |i: u32| [(i % side) as f32, (i / side) as f32, 0.0];
    let corners = VertexBuffer::new((0..side * side).map(corner).collect());
    let squares = (0..side * (side - 1)).filter(|i| i % side + 1 < side);
    let triangles = IndexBuffer::new(squares.map(|i| [i, i + 1, i + side]).collect());
    let mut builder = SceneBuilder::new(&device)?;
    builder.add_triangles(&corners, &triangles)?;
    let scene = builder.commit()?;
    let built = device.memory();
    // A leaf holds three corners of each triangle.
    let least = before.held + 36 * triangles.as_slice().len() as u64;
    assert!(built.held >= least && built.peak >= built.held, "{built:?}");
    drop(scene);
    let after = device.memory();
    assert_eq!((after.held, after.peak), (before.held, built.peak));
    Ok(())
}

#[test]
fn a_bad_configuration_is_refused_with_words() {
    for config in ["threads=many", "threads=2\0,verbose=0"] {
        match Device::new(config) {
            Err(error @ Error::Device { .. }) => {
                let text = error.to_string();
                assert!(!text.ends_with(": "), "{text}");
                assert!(!text.contains("unknown error"), "{text}");
            }
            other => panic!("{config:?} gave {other:?}"),
        }
    }
}

#[test]
fn an_empty_scene_is_missed() -> Result<(), Error> {
    let (vertices, _) = triangle();
    let empty = build(|_| Ok(()))?;
    let without_triangles = build(|builder| {
        builder
            .add_triangles(&vertices, &IndexBuffer::new(vec![]))
            .map(drop)
    })?;
    let without_vertices = build(|builder| {
        builder
            .add_triangles(&VertexBuffer::new(vec![]), &IndexBuffer::new(vec![]))
            .map(drop)
    })?;
    for scene in [empty, without_triangles, without_vertices] {
        let up = ray([0.2, 0.2, -1.0], [0.0, 0.0, 1.0]);
        assert_eq!(scene.intersect(&up), None);
        assert!(!scene.occluded(&up));
        assert_eq!(scene.bounds(), None);
    }
    Ok(())
}

#[test]
fn every_option_builds_and_hits() -> Result<(), Error> {
    let device = Device::new("")?;
    let (vertices, indices) = triangle();
    for quality in [BuildQuality::Low, BuildQuality::Medium, BuildQuality::High] {
        for robust in [false, true] {
            let options = BuildOptions { robust, quality };
            let mut builder = SceneBuilder::with_options(&device, options)?;
            builder.add_triangles(&vertices, &indices)?;
            builder.add_sphere([4.0, 0.0, 0.0], 1.0)?;
            let scene = builder.commit()?;
            assert!(
                scene.occluded(&ray([0.2, 0.2, -1.0], [0.0, 0.0, 1.0])),
                "{options:?}"
            );
            assert!(
                scene.occluded(&ray([4.0, 0.2, -9.0], [0.0, 0.0, 1.0])),
                "{options:?}"
            );
        }
    }
    Ok(())
}

#[test]
fn bounds_hold_everything() -> Result<(), Error> {
    let (vertices, indices) = triangle();
    let scene = build(|builder| {
        builder.add_triangles(&vertices, &indices)?;
        builder.add_sphere([0.0, 0.0, 10.0], 2.0).map(drop)
    })?;
    let Some(Bounds { lower, upper }) = scene.bounds() else {
        panic!("not empty")
    };
    let expected = [([-2.0, -2.0, 0.0], lower), ([2.0, 2.0, 12.0], upper)];
    for (exact, found) in expected {
        for (axis, exact) in exact.into_iter().enumerate() {
            assert!((found[axis] - exact).abs() < 1e-5, "{found:?}");
        }
    }
    assert!(lower[0] <= -2.0 && upper[2] >= 12.0);
    Ok(())
}

/// Twice the size, moved by (10, 0, 5).
const DOUBLED: [[f32; 4]; 3] = [
    [2.0, 0.0, 0.0, 10.0],
    [0.0, 2.0, 0.0, 0.0],
    [0.0, 0.0, 2.0, 5.0],
];

fn instances() -> Result<CommittedScene, Error> {
    let device = Device::new("")?;
    let (vertices, indices) = triangle();
    let mut inner = SceneBuilder::new(&device)?;
    inner.add_sphere([0.0, 0.0, 3.0], 1.0)?;
    inner.add_triangles(&vertices, &indices)?;
    let inner = Arc::new(inner.commit()?);
    let mut outer = SceneBuilder::new(&device)?;
    outer.add_triangles(&vertices, &indices)?;
    outer.add_instance(
        Arc::clone(&inner),
        IDENTITY.map(|[x, y, z, _]| [x, y, z, -50.0]),
    )?;
    outer.add_instance(inner, DOUBLED)?;
    outer.commit()
}

#[test]
fn an_instance_is_moved_and_scaled() -> Result<(), Error> {
    let scene = instances()?;
    let on_triangle = Hit {
        distance: 5.0,
        u: 0.25,
        v: 0.5,
        normal: [0.0, 0.0, 1.0],
        primitive: 0,
        geometry: 1,
        instance: Some(2),
    };
    let up = ray([10.5, 1.0, 0.0], [0.0, 0.0, 1.0]);
    assert_hit(scene.intersect(&up), on_triangle);
    assert!(scene.occluded(&up));
    // The sphere is centred at (10, 0, 11) with radius 2 there.
    let down = ray([10.0, 0.0, 20.0], [0.0, 0.0, -1.0]);
    let Some(on_sphere) = scene.intersect(&down) else {
        panic!("the sphere is there")
    };
    assert!((on_sphere.distance - 7.0).abs() < 1e-6, "{on_sphere:?}");
    assert_eq!((on_sphere.geometry, on_sphere.instance), (0, Some(2)));
    assert_eq!(on_sphere.normal, [0.0, 0.0, 1.0]);
    assert!(scene.occluded(&down));
    let own = scene.intersect(&ray([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]));
    assert_eq!(own.map(|hit| (hit.geometry, hit.instance)), Some((0, None)));
    Ok(())
}

#[test]
fn instances_that_cannot_be_are_refused() -> Result<(), Error> {
    let device = Device::new("")?;
    let nested = Arc::new(instances()?);
    let foreign = Arc::new(build(|_| Ok(()))?);
    let own = Arc::new(SceneBuilder::new(&device)?.commit()?);
    let mut builder = SceneBuilder::new(&device)?;
    assert_eq!(
        builder.add_instance(nested, IDENTITY),
        Err(Error::NestedInstance)
    );
    assert_eq!(
        builder.add_instance(foreign, IDENTITY),
        Err(Error::ForeignDevice)
    );
    let flat = [IDENTITY[0], IDENTITY[0], IDENTITY[2]];
    let refused = builder.add_instance(own, flat);
    assert!(
        matches!(
            refused,
            Err(Error::BadShape {
                what: "an instance",
                ..
            })
        ),
        "{refused:?}"
    );
    Ok(())
}

#[test]
fn the_scene_keeps_alive_what_it_needs() -> Result<(), Error> {
    let scene = instances()?;
    let kept = std::thread::spawn(move || {
        let hit = scene.intersect(&ray([10.5, 1.0, 0.0], [0.0, 0.0, 1.0]));
        drop(scene);
        hit.is_some()
    });
    assert!(kept.join().expect("the thread does not panic"));
    Ok(())
}

#[test]
fn eight_threads_see_the_same() -> Result<(), Error> {
    let mut numbers = Numbers(8);
    let vertices: Vec<_> = (0..3000).map(|_| numbers.point()).collect();
    let triangles = (0..1000)
        .map(|first| [3 * first, 3 * first + 1, 3 * first + 2])
        .collect();
    let scene = build(|builder| {
        builder.add_triangles(&VertexBuffer::new(vertices), &IndexBuffer::new(triangles))?;
        builder.add_sphere([0.0; 3], 0.5).map(drop)
    })?;
    let rays: Vec<Ray> = (0..4000)
        .map(|_| ray(numbers.point().map(|x| 2.0 * x), numbers.point()))
        .collect();
    let trace = || -> Vec<(Option<Hit>, bool)> {
        flush_denormals();
        rays.iter()
            .map(|ray| (scene.intersect(ray), scene.occluded(ray)))
            .collect()
    };
    let results: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(trace)).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().expect("no thread panics"))
            .collect()
    });
    assert!(results[0].iter().filter(|(hit, _)| hit.is_some()).count() > 500);
    for other in &results[1..] {
        assert!(other == &results[0]);
    }
    Ok(())
}
