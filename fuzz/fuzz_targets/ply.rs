//! Any bytes as a PLY file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiflow::scene::import::mesh::ply;
use lumiflow_fuzz::check_mesh;

fuzz_target!(|bytes: &[u8]| {
    match ply::parse(bytes, true) {
        Ok(mesh) => check_mesh(mesh),
        Err(problem) => assert!(!problem.to_string().is_empty()),
    }
});
