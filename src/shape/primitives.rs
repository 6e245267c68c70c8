//! Flat shapes as meshes.

use super::mesh::MeshData;

/// The square [-1, 1]² of the plane z = 0, facing +z, with `uv` from (0, 0) to (1, 1).
pub fn rectangle() -> MeshData {
    MeshData {
        positions: vec![[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]],
        indices: vec![[0, 1, 2], [2, 3, 0]],
        normals: Some(vec![[0., 0., 1.]; 4]),
        uvs: Some(vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]]),
        attributes: Vec::new(),
    }
}

/// The cube [-1, 1]³ with its normals outwards, each face with its own `uv` over the unit square.
pub fn cube() -> MeshData {
    // A face's normal, and the directions in which its u and its v grow: from outside, v grows
    // downwards where u grows to the right, as it does in Mitsuba.
    const FACES: [[[f32; 3]; 3]; 6] = [
        [[0., -1., 0.], [0., 0., 1.], [1., 0., 0.]],
        [[0., 1., 0.], [-1., 0., 0.], [0., 0., -1.]],
        [[1., 0., 0.], [0., 1., 0.], [0., 0., -1.]],
        [[0., 0., 1.], [0., 1., 0.], [1., 0., 0.]],
        [[-1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
        [[0., 0., -1.], [0., -1., 0.], [1., 0., 0.]],
    ];
    const CORNERS: [[f32; 2]; 4] = [[0., 1.], [1., 1.], [1., 0.], [0., 0.]];
    let mut cube = MeshData {
        normals: Some(Vec::new()),
        uvs: Some(Vec::new()),
        ..MeshData::default()
    };
    for [normal, along_u, along_v] in FACES {
        let first = cube.positions.len() as u32;
        cube.indices
            .extend([[first, first + 1, first + 2], [first + 3, first, first + 2]]);
        cube.positions.extend(CORNERS.map(|[u, v]| {
            [0, 1, 2]
                .map(|i| normal[i] + along_u[i] * (2.0 * u - 1.0) + along_v[i] * (2.0 * v - 1.0))
        }));
        cube.normals.iter_mut().for_each(|n| n.extend([normal; 4]));
        cube.uvs.iter_mut().for_each(|uv| uv.extend(CORNERS));
    }
    cube
}
