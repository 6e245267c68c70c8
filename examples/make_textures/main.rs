//! Writes the textures of `scenes/` again.
//!
//! ```sh
//! cargo run --release --example make_textures            # into scenes/textures
//! cargo run --release --example make_textures -- /tmp/t  # somewhere else
//! ```
//!
//! Every texture is a formula of [`textures`]; nothing is photographed or taken from elsewhere.

mod textures;

use std::path::PathBuf;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder = env::args().nth(1).map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/textures"),
        PathBuf::from,
    );
    fs::create_dir_all(&folder)?;
    for (name, make) in textures::ALL {
        let bytes = make().to_png();
        println!("{name:10} {:6} bytes", bytes.len());
        fs::write(folder.join(format!("{name}.png")), bytes)?;
    }
    Ok(())
}
