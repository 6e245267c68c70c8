//! Finds the installed `OpenEXR`, compiles the C shim against its headers and binds both.

use std::env;
use std::path::{Path, PathBuf};
use std::process::exit;

/// What Rust calls directly; everything else goes through the shim.
const FUNCTIONS: &[&str] = &[
    "openexr_shim_.*",
    "exr_get_library_version",
    "exr_get_default_error_message",
    "exr_finish",
    "exr_get_user_data",
    "exr_get_count",
    "exr_get_storage",
    "exr_get_channels",
    "exr_get_compression",
    "exr_get_pixel_aspect_ratio",
    "exr_get_chunk_count",
    "exr_get_scanlines_per_chunk",
    "exr_get_tile_sizes",
    "exr_get_attribute_count",
    "exr_get_attribute_by_index",
    "exr_attr_[gs]et_(string|int|float|double|chromaticities)",
    "exr_set_longname_support",
    "exr_set_zip_compression_level",
    "exr_set_dwa_compression_level",
    "exr_add_part",
    "exr_add_channel",
    "exr_write_header",
    "exr_read_(scanline|tile)_chunk_info",
];

fn main() {
    println!("cargo::rerun-if-changed=shim/shim.c");
    println!("cargo::rerun-if-changed=shim/shim.h");
    let library = find_library();
    cc::Build::new()
        .file("shim/shim.c")
        .includes(&library.include_paths)
        .std("c11")
        .warnings(true)
        .extra_warnings(true)
        .compile("openexr_shim");
    // After the shim, which needs its symbols.
    for path in &library.link_paths {
        println!("cargo::rustc-link-search=native={}", path.display());
    }
    println!("cargo::rustc-link-lib=OpenEXRCore");
    println!("cargo::metadata=version={}", library.version);
    bind(&library.include_paths);
}

/// Asks pkg-config for `OpenEXR` 3.1 or newer; ends the build with advice where it is missing.
fn find_library() -> pkg_config::Library {
    let found = pkg_config::Config::new()
        .atleast_version("3.1")
        .cargo_metadata(false)
        .probe("OpenEXR");
    found.unwrap_or_else(|error| {
        eprintln!(
            "OpenEXR 3.1 or newer is needed (Debian: apt install libopenexr-dev pkg-config)\n{error}"
        );
        exit(1)
    })
}

/// Writes `bindings.rs` for the headers that were found.
fn bind(include_paths: &[PathBuf]) {
    let mut builder = bindgen::Builder::default()
        .header("shim/shim.h")
        .clang_args(
            include_paths
                .iter()
                .map(|path| format!("-I{}", path.display())),
        )
        .prepend_enum_name(false)
        .generate_comments(false)
        .derive_debug(false)
        .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()));
    for function in FUNCTIONS {
        builder = builder.allowlist_function(function);
    }
    // The functions return plain integers and so do not bring the codes with them.
    builder = builder.allowlist_type("exr_error_code_t");
    let bindings = builder.generate().unwrap_or_else(|error| {
        eprintln!("bindgen could not read openexr.h: {error}");
        exit(1)
    });
    let folder = env::var_os("OUT_DIR").unwrap_or_default();
    if let Err(error) = bindings.write_to_file(Path::new(&folder).join("bindings.rs")) {
        eprintln!("cannot write the bindings: {error}");
        exit(1);
    }
}
