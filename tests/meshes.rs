//! The meshes of `scenes/` are those that `examples/make_meshes` makes.

use std::fs;
use std::path::Path;

use lumiflow::scene::import::mesh::ply;
use lumiflow::shape::mesh::MeshData;

#[path = "../examples/make_meshes/meshes/mod.rs"]
mod recipes;

/// Sines differ by a rounding from system to system; longest sides are about 1.
const TOLERANCE: f32 = 1e-4;

/// A word about the first difference between two meshes.
fn difference(made: &MeshData, stored: &MeshData) -> Option<String> {
    if made.indices != stored.indices {
        return Some("other triangles".to_owned());
    }
    let pairs = made.positions.as_flattened().iter();
    let pairs = pairs.zip(stored.positions.as_flattened());
    let far = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let same = made.positions.len() == stored.positions.len() && far < TOLERANCE;
    (!same).then(|| format!("other points, by {far}"))
}

fn parsed(bytes: &[u8]) -> MeshData {
    let mesh = ply::parse(bytes, false).expect("a sound mesh");
    assert!(mesh.warnings.is_empty(), "{:?}", mesh.warnings);
    mesh.data
}

#[test]
fn stored_meshes_are_those_that_are_made() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes");
    let (mut found, mut total) = (Vec::new(), 0);
    for (name, make) in recipes::ALL {
        let bytes = fs::read(folder.join(format!("{name}.ply"))).expect(name);
        assert!(bytes.len() < 2 << 20, "{name} is large");
        total += bytes.len();
        let made = make();
        let triangles = made.triangles();
        let made = parsed(&made.to_ply());
        assert_eq!(made.indices.len(), triangles, "{name}");
        found.extend(difference(&made, &parsed(&bytes)).map(|what| format!("{name}: {what}")));
    }
    assert!(
        found.is_empty(),
        "{}; see examples/make_meshes",
        found.join("\n")
    );
    assert!(total <= 13_500_000, "{total}");
    let stored = fs::read_dir(folder).expect("scenes/meshes").count();
    assert_eq!(stored, recipes::ALL.len(), "files without a recipe");
}

#[test]
fn another_mesh_is_told_from_it() {
    let (_, make) = recipes::ALL[0];
    let made = parsed(&make().to_ply());
    let mut moved = made.clone();
    moved.positions[7][0] += 1e-3;
    let mut turned = made.clone();
    turned.indices[7].reverse();
    assert_eq!(difference(&made, &made.clone()), None);
    assert!(difference(&made, &moved).is_some());
    assert!(difference(&made, &turned).is_some());
}
