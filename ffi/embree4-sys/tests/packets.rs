//! Many rays at once are the same as one by one.

use embree4_sys::{
    BuildOptions, CommittedScene, Device, Error, Hit, IndexBuffer, Ray, SceneBuilder, VertexBuffer,
};

use crate::{Numbers, ray};

const ROUNDS: usize = 40_000;

/// A bumpy mesh, a sphere, a disk, and a cylinder.
fn mixed(robust: bool) -> Result<(CommittedScene, Vec<[f32; 3]>), Error> {
    let mut numbers = Numbers(3);
    let side = 40;
    let place = |k: u32| k as f32 / side as f32 * 1.6 - 0.8;
    let grid: Vec<[f32; 3]> = (0..=side)
        .flat_map(|y| (0..=side).map(move |x| (x, y)))
        .map(|(x, y)| [place(x), place(y), 0.1 * numbers.signed()])
        .collect();
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let triangles = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [
                corner(x, y),
                corner(x + 1, y),
                corner(x + 1, y + 1),
                corner(x, y + 1),
            ];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let (vertices, indices) = (VertexBuffer::new(grid.clone()), IndexBuffer::new(triangles));
    let options = BuildOptions {
        robust,
        ..BuildOptions::default()
    };
    let mut builder = SceneBuilder::with_options(&Device::new("threads=1")?, options)?;
    builder.add_triangles(&vertices, &indices)?;
    builder.add_sphere([0.3, 0.2, 0.4], 0.25)?;
    let moved = |z: f32| {
        [
            [0.4, 0.0, 0.1, -0.4],
            [0.0, 0.3, 0.2, 0.3],
            [-0.1, 0.0, 0.4, z],
        ]
    };
    builder.add_disk(moved(0.5))?;
    builder.add_cylinder(moved(-0.5))?;
    Ok((builder.commit()?, grid))
}

/// Rays in all directions, and rays right at vertices and edges, along the axes too; every tenth
/// one is short, every thirtieth broken.
fn rays(vertices: &[[f32; 3]]) -> Vec<Ray> {
    let mut numbers = Numbers(7);
    let mut some = |count: u64| (numbers.bits() % count) as usize;
    let mut aims = Vec::new();
    for _ in 0..ROUNDS {
        let first = some(vertices.len() as u64 - 1);
        aims.push((vertices[first], vertices[first + 1], some(3), some(30)));
    }
    let mut numbers = Numbers(11);
    let aimed = |(from, to, axis, kind): ([f32; 3], [f32; 3], usize, usize)| {
        let share = [0.0, 0.5 + 0.5 * numbers.signed()][kind % 2];
        let aim = [0, 1, 2].map(|k| from[k] + share * (to[k] - from[k]));
        let origin = numbers.point();
        match kind {
            0 => ray([f32::NAN; 3], aim),
            1..10 => ray(origin, numbers.point()),
            10..13 => Ray {
                far: 0.1 * origin[0].abs(),
                ..ray(origin, numbers.point())
            },
            13..22 => ray(origin, [0, 1, 2].map(|k| aim[k] - origin[k])),
            _ => {
                let (mut start, mut along) = (aim, [0.0; 3]);
                (start[axis], along[axis]) = (-2.0, 1.0);
                ray(start, along)
            }
        }
    };
    aims.into_iter().map(aimed).collect()
}

fn hits(scene: &CommittedScene, rays: &[Ray]) -> Vec<Option<Hit>> {
    let mut hits = Vec::new();
    scene.intersect_all(rays.iter().copied(), &mut hits);
    hits
}

fn occluded(scene: &CommittedScene, rays: &[Ray]) -> Vec<bool> {
    let mut occluded = Vec::new();
    scene.occluded_all(rays.iter().copied(), &mut occluded);
    occluded
}

#[test]
fn many_rays_find_what_each_one_finds() -> Result<(), Error> {
    for robust in [true, false] {
        let (scene, vertices) = mixed(robust)?;
        let rays = rays(&vertices);
        let found = (hits(&scene, &rays), occluded(&scene, &rays));
        assert_eq!((found.0.len(), found.1.len()), (ROUNDS, ROUNDS));
        let mut met = [0; 5];
        for (index, ray) in rays.iter().enumerate() {
            let alone = scene.intersect(ray);
            assert_eq!(found.0[index], alone, "robust: {robust}, {ray:?}");
            assert_eq!(
                found.1[index],
                scene.occluded(ray),
                "robust: {robust}, {ray:?}"
            );
            met[alone.map_or(4, |hit| hit.geometry as usize)] += 1;
        }
        assert!(met.iter().all(|count| *count > ROUNDS / 100), "{met:?}");
    }
    Ok(())
}

#[test]
fn what_a_ray_finds_does_not_depend_on_the_others() -> Result<(), Error> {
    depends_on_itself(true)?;
    depends_on_itself(false)
}

fn depends_on_itself(robust: bool) -> Result<(), Error> {
    let (scene, vertices) = mixed(robust)?;
    let rays = rays(&vertices);
    let (hits_of_all, occluded_of_all) = (hits(&scene, &rays), occluded(&scene, &rays));
    for step in [1, 3, 7] {
        // Other neighbours, another lane, and fewer rays in the last packet.
        let order = |index: usize| index * step % (ROUNDS - 1);
        let picked: Vec<Ray> = (0..ROUNDS - 5).map(|index| rays[order(index)]).collect();
        let found = hits(&scene, &picked)
            .into_iter()
            .zip(occluded(&scene, &picked));
        for (index, found) in found.enumerate() {
            let expected = (hits_of_all[order(index)], occluded_of_all[order(index)]);
            assert_eq!(found, expected, "{:?}", picked[index]);
        }
    }
    assert!(hits(&scene, &[]).is_empty());
    Ok(())
}
