//! Triangle meshes: exact hits, misses, and what is refused.

use embree4_sys::{CommittedScene, Error, Hit, IndexBuffer, Ray, VertexBuffer};

use crate::{assert_close, assert_hit, build, ray};

const UP: [f32; 3] = [0.0, 0.0, 1.0];

fn mesh(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<CommittedScene, Error> {
    build(|builder| {
        let vertices = VertexBuffer::new(vertices.to_vec());
        builder
            .add_triangles(&vertices, &IndexBuffer::new(triangles.to_vec()))
            .map(drop)
    })
}

/// Corners at (0, 0), (4, 0) and (0, 2) of the plane z = 3.
fn one_triangle() -> Result<CommittedScene, Error> {
    mesh(
        &[[0.0, 0.0, 3.0], [4.0, 0.0, 3.0], [0.0, 2.0, 3.0]],
        &[[0, 1, 2]],
    )
}

#[test]
fn a_hit_is_what_it_should_be() -> Result<(), Error> {
    let scene = one_triangle()?;
    let expected = Hit {
        distance: 1.5,
        u: 0.25,
        v: 0.5,
        normal: [0.0, 0.0, 8.0],
        primitive: 0,
        geometry: 0,
        instance: None,
    };
    let through = ray([1.0, 1.0, 0.0], [0.0, 0.0, 2.0]);
    assert_hit(scene.intersect(&through), expected);
    assert!(scene.occluded(&through));
    let from_behind = ray([1.0, 1.0, 6.0], [0.0, 0.0, -2.0]);
    assert_hit(scene.intersect(&from_behind), expected);
    assert!(scene.occluded(&from_behind));
    Ok(())
}

#[test]
fn a_ray_beside_or_away_misses() -> Result<(), Error> {
    let scene = one_triangle()?;
    let misses = [
        ray([3.0, 1.0, 0.0], UP),
        ray([1.0, 1.0, 4.0], UP),
        ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ray([f32::NAN, 1.0, 0.0], UP),
        ray([1.0, 1.0, 0.0], [f32::NAN; 3]),
        ray([1.0, 1.0, 0.0], [0.0; 3]),
    ];
    for miss in &misses {
        assert_eq!(scene.intersect(miss), None, "{miss:?}");
        assert!(!scene.occluded(miss), "{miss:?}");
    }
    Ok(())
}

#[test]
fn the_interval_includes_its_ends() -> Result<(), Error> {
    let scene = one_triangle()?;
    let whole = ray([1.0, 0.5, 0.0], UP);
    let Some(Hit { distance, .. }) = scene.intersect(&whole) else {
        panic!("the triangle is there")
    };
    assert_close(distance, 3.0);
    for (near, far, hit) in [
        (0.0, distance, true),
        (2.999, 3.001, true),
        (0.0, 2.999, false),
        (distance, 9.0, true),
        (distance, distance, true),
        (3.001, 9.0, false),
    ] {
        let piece = Ray { near, far, ..whole };
        assert_eq!(scene.intersect(&piece).is_some(), hit, "{near} {far}");
        assert_eq!(scene.occluded(&piece), hit, "{near} {far}");
    }
    Ok(())
}

#[test]
fn the_closest_of_several_geometries_is_named() -> Result<(), Error> {
    let layer = |z: f32| VertexBuffer::new(vec![[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]);
    let scene = build(|builder| {
        for (expected, z) in [5.0, 2.0, 4.0].into_iter().enumerate() {
            let id = builder.add_triangles(&layer(z), &IndexBuffer::new(vec![[2, 0, 1]; 3]))?;
            assert_eq!(id.0 as usize, expected);
        }
        Ok(())
    })?;
    for (start, way, geometry, distance) in [(0.0, UP, 1, 2.0), (9.0, [0.0, 0.0, -1.0], 0, 4.0)] {
        let Some(hit) = scene.intersect(&ray([0.2, 0.2, start], way)) else {
            panic!("three layers are there")
        };
        assert_eq!(hit.geometry, geometry);
        assert_close(hit.distance, distance);
    }
    Ok(())
}

#[test]
fn degenerate_triangles_are_missed_and_spoil_nothing() -> Result<(), Error> {
    let vertices = [
        [0.0, 0.0, 1.0],
        [2.0, 0.0, 1.0],
        [0.0, 2.0, 1.0],
        [0.5, 0.5, 0.5],
    ];
    let scene = mesh(&vertices, &[[3, 3, 3], [0, 1, 1], [0, 1, 2]])?;
    let hit = scene.intersect(&ray([0.5, 0.5, 0.0], UP));
    let Some(Hit {
        primitive: 2,
        distance,
        ..
    }) = hit
    else {
        panic!("{hit:?}")
    };
    assert_close(distance, 1.0);
    let alone = mesh(&vertices, &[[3, 3, 3], [0, 1, 1]])?;
    assert_eq!(alone.intersect(&ray([0.5, 0.5, 0.0], UP)), None);
    Ok(())
}

#[test]
fn bad_meshes_are_refused() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let refused = mesh(&corners, &[[0, 1, 2], [1, 3, 2]]).map(drop);
    assert_eq!(
        refused,
        Err(Error::IndexOutOfRange {
            triangle: 1,
            index: 3,
            vertices: 3
        })
    );
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, 1.9e18] {
        let mut vertices = corners;
        vertices[1][2] = bad;
        let refused = mesh(&vertices, &[[0, 1, 2]]).map(drop);
        assert!(
            matches!(refused, Err(Error::BadVertex { vertex: 1, .. })),
            "{refused:?}"
        );
    }
}

#[test]
fn the_largest_coordinate_that_is_accepted_is_hit() -> Result<(), Error> {
    let far = VertexBuffer::LARGEST;
    let scene = mesh(
        &[[-far, -far, 1.0], [far, -far, 1.0], [0.0, far, 1.0]],
        &[[0, 1, 2]],
    )?;
    assert!(scene.intersect(&ray([0.0; 3], UP)).is_some());
    Ok(())
}
