//! Any bytes as a Wavefront OBJ file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiflow::scene::import::mesh::obj;
use lumiflow_fuzz::check_mesh;

fuzz_target!(|bytes: &[u8]| {
    match obj::parse(bytes, true) {
        Ok(mesh) => check_mesh(mesh),
        Err(problem) => assert!(!problem.to_string().is_empty()),
    }
});
