//! Tests of triangle meshes.

use super::*;
use crate::math::Mat4;
use crate::shape::primitives;

/// A cube whose normals are changed, or left as they are.
fn cube(change: impl Fn(&mut [f32; 3])) -> TriangleMesh {
    let mut data = primitives::cube();
    data.normals.iter_mut().flatten().for_each(change);
    data.into()
}

#[test]
fn normals_are_kept_where_they_say_more_than_the_triangles() {
    let keeps = |change: fn(&mut [f32; 3])| cube(change).normals.is_some();
    assert!(!keeps(|_| ()));
    assert!(!keeps(|normal| *normal = normal.map(|c| c * 7.0)));
    assert!(!keeps(|normal| normal[0] += 0.5 * FLAT));
    assert!(keeps(
        |normal| *normal = [normal[1], normal[2], normal[0] + 2.0 * FLAT]
    ));
    assert!(keeps(
        |normal| normal[0] += if normal[0] == 0.0 { 2.0 * FLAT } else { 0.0 }
    ));
    // The other side is the front.
    assert!(keeps(|normal| *normal = normal.map(|c| -c)));
    assert!(keeps(|normal| *normal = [0.0; 3]));
    assert!(keeps(|normal| *normal = [f32::NAN; 3]));
    // A single one that leans, and a triangle that has none of its own.
    let mut data = primitives::cube();
    data.normals.as_mut().unwrap()[23][1] += 0.1;
    assert!(TriangleMesh::from(data).normals.is_some());
    let mut data = primitives::cube();
    data.indices.push([0, 1, 1]);
    assert!(TriangleMesh::from(data).normals.is_some());
}

#[test]
fn the_halves_of_a_wall_have_one_frame() {
    for turn in 0..4 {
        let turn = Mat4::from_rotation_y(turn as f32 * std::f32::consts::FRAC_PI_2);
        for data in [primitives::cube(), primitives::rectangle()] {
            let mut placed = data;
            placed.transform(turn);
            let mesh = TriangleMesh::from(placed);
            for half in 0..mesh.triangles().as_slice().len() as u32 / 2 {
                let frames = [2 * half, 2 * half + 1].map(|triangle| {
                    let point = mesh.point(triangle, Vec2::splat(0.25));
                    (point.shading_normal, point.shading_frame())
                });
                let [(one, frame), (other, beside)] = frames;
                if one == other {
                    assert_eq!(frame, beside, "{one}");
                }
            }
        }
    }
}

#[test]
fn meshes_too_large_to_prepare_have_the_same_points() {
    let mut mesh = TriangleMesh::from(primitives::cube());
    let barycentrics = [(0.2, 0.3), (0.0, 0.5), (1e-7, 1e-7), (0.999_999, 0.0)];
    let points = |mesh: &TriangleMesh| -> Vec<String> {
        let triangles = 0..mesh.triangles().as_slice().len() as u32;
        triangles
            .flat_map(|index| barycentrics.map(|(b1, b2)| (index, Vec2::new(b1, b2))))
            .map(|(index, b)| format!("{:?}", mesh.point(index, b)))
            .collect()
    };
    let unprepared = points(&mesh);
    assert_eq!((mesh.prepare_points(11), mesh.facets.len()), (0, 0));
    assert_eq!(mesh.prepare_points(12), 12);
    assert_eq!(points(&mesh), unprepared);
}
