//! Claims that every mesh must meet that a reader lets through.

use lumiflow::math::{Mat4, Vec3};
use lumiflow::scene::import::mesh::ImportedMesh;
use lumiflow::shape::mesh::MeshData;

/// Checks a mesh and what is done with it before rendering.
pub fn check_mesh(mesh: ImportedMesh) {
    let mut data = mesh.data;
    assert!(!data.indices.is_empty());
    assert_sound(&data);
    let degenerate = data.degenerate_count();
    assert!(degenerate <= data.indices.len());
    let area = data.surface_area();
    assert!(area.is_finite() && area >= 0.0);

    let triangles = data.indices.len();
    data.apply_max_smooth_angle(30.0);
    assert_sound(&data);
    assert_eq!(data.indices.len(), triangles);
    assert_eq!(data.degenerate_count(), degenerate);

    data.compute_vertex_normals();
    data.flip_normals();
    assert_sound(&data);
    data.transform(Mat4::from_scale(Vec3::new(-0.5, 0.0, 0.25)));
    assert_sound(&data);
}

fn assert_sound(data: &MeshData) {
    assert_eq!(data.validate(), Ok(()));
    for normal in data.normals.iter().flatten() {
        assert!((Vec3::from_array(*normal).length() - 1.0).abs() < 1e-5);
    }
}
