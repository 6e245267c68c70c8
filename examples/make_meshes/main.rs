//! Writes the meshes of `scenes/` again.
//!
//! ```sh
//! cargo run --release --example make_meshes            # into scenes/meshes
//! cargo run --release --example make_meshes -- /tmp/m  # somewhere else
//! ```
//!
//! Every mesh is a formula of [`meshes`]; nothing is scanned or taken from elsewhere.

mod meshes;

use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder = env::args().nth(1).map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes"),
        PathBuf::from,
    );
    fs::create_dir_all(&folder)?;
    let mut total = 0;
    for (name, make) in meshes::ALL {
        let mesh = make();
        let bytes = mesh.to_ply();
        total += bytes.len();
        println!(
            "{name:18} {:6} triangles {:8} bytes",
            mesh.triangles(),
            bytes.len()
        );
        fs::write(folder.join(format!("{name}.ply")), bytes)?;
    }
    println!("{total} bytes in all");
    Ok(())
}
