//! Embree alone finds what the safe face finds.

use embree4_sys::{Error, IndexBuffer, RawPackets, RawRays, Ray, Tally, VertexBuffer};

use crate::{Numbers, build, ray};

const COUNT: usize = 20_000;

/// Rays from within the cube in all directions; every fifth is short, every seventh broken.
fn rays() -> Vec<Ray> {
    let mut numbers = Numbers(5);
    let some = |index: usize| {
        let (origin, direction) = (numbers.point(), numbers.point());
        let far = if index % 5 == 0 { 0.3 } else { f32::INFINITY };
        match index % 7 {
            0 => ray([f32::NAN, 0.0, 0.0], direction),
            _ => Ray {
                far,
                ..ray(origin, direction)
            },
        }
    };
    (0..COUNT).map(some).collect()
}

#[test]
fn recorded_rays_find_the_same_without_the_safe_face() -> Result<(), Error> {
    let mut numbers = Numbers(2);
    let corners = (0..300).map(|_| numbers.point()).collect();
    let triangles = (0..100).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let (vertices, indices) = (VertexBuffer::new(corners), IndexBuffer::new(triangles));
    let scene = build(|builder| {
        builder.add_triangles(&vertices, &indices)?;
        builder.add_sphere([0.3, 0.2, 0.4], 0.25).map(drop)
    })?;
    let (mut closest, mut occluded) = (Tally::default(), Tally::default());
    let rays = rays();
    for ray in &rays {
        closest.add(scene.intersect(ray).map(|hit| hit.distance));
        occluded.add(scene.occluded(ray).then_some(0.0));
    }
    let kept = RawRays::new(rays.iter().copied());
    assert_eq!(kept.as_slice().len(), COUNT - COUNT.div_ceil(7));
    assert_eq!(scene.raw_closest(&kept), closest);
    assert_eq!(scene.raw_occluded(&kept), occluded);
    assert_eq!(closest.hits, occluded.hits);
    assert!(closest.hits > 1000 && closest.hits < kept.as_slice().len() as u64 - 1000);

    // Together, in groups that fill their packets and others that do not.
    for size in [1, 8, 13, COUNT] {
        let packets = RawPackets::new(rays.chunks(size).map(|group| group.iter().copied()));
        assert_eq!(scene.raw_closest_packets(&packets), Some(closest), "{size}");
        assert_eq!(
            scene.raw_occluded_packets(&packets),
            Some(occluded),
            "{size}"
        );
    }

    // A ray more is seen.
    let fewer = RawRays::new(rays[1..].iter().copied());
    let shorter = RawRays::new(fewer.as_slice()[1..].iter().copied());
    assert_eq!(scene.raw_closest(&fewer), closest);
    let first = scene.intersect(&fewer.as_slice()[0]);
    assert_eq!(
        scene.raw_closest(&shorter).hits + u64::from(first.is_some()),
        closest.hits
    );
    Ok(())
}

#[test]
fn no_rays_find_nothing() -> Result<(), Error> {
    let scene = build(|builder| builder.add_sphere([0.0; 3], 1.0).map(drop))?;
    let none = RawRays::new([ray([f32::NAN; 3], [1.0; 3])]);
    assert_eq!(scene.raw_closest(&none), Tally::default());
    assert_eq!(scene.raw_occluded(&none), Tally::default());
    let none = RawPackets::new([[ray([f32::NAN; 3], [1.0; 3])]]);
    assert_eq!(scene.raw_closest_packets(&none), Some(Tally::default()));
    assert_eq!(scene.raw_occluded_packets(&none), Some(Tally::default()));
    Ok(())
}
