//! Finds Embree, compiles the C shim against its headers, and makes the bindings.
//!
//! Order: the prefix in `EMBREE_DIR`; else what `LUMIFLOW_EMBREE` asks for (`4` or `3`; `4` also
//! looks into `target/embree4` of the workspace, which `prefix.sh` fills); else the system's
//! Embree 4; else the system's Embree 3.13.

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// An Embree that is installed: headers and library belong together.
struct Installation {
    major: u32,
    /// The folder that contains `rtcore.h`.
    headers: PathBuf,
    /// The folder that contains the shared library.
    libraries: PathBuf,
    /// Whether the loader has to be told the folder of the library.
    private: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    for variable in ["EMBREE_DIR", "LUMIFLOW_EMBREE"] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    match find() {
        Ok(installation) => build(&installation),
        Err(explanation) => {
            for line in explanation.lines() {
                println!("cargo::error={line}");
            }
            Ok(())
        }
    }
}

fn find() -> Result<Installation, String> {
    if let Some(prefix) = env::var_os("EMBREE_DIR").filter(|value| !value.is_empty()) {
        let prefix = PathBuf::from(prefix);
        return in_prefix(&prefix, 4)
            .or_else(|| in_prefix(&prefix, 3))
            .ok_or_else(|| {
                format!(
                    "EMBREE_DIR={} holds no Embree: expected include/embree4/rtcore.h and \
                 lib/libembree4.so, or the same with 3",
                    prefix.display()
                )
            });
    }
    let choice = env::var("LUMIFLOW_EMBREE").unwrap_or_default();
    let found = match choice.as_str() {
        "" => in_system(4).or_else(|| in_system(3)),
        "3" => in_system(3),
        "4" => in_prefix(&workspace_prefix(), 4).or_else(|| in_system(4)),
        other => return Err(format!("LUMIFLOW_EMBREE={other} is not known; use 3 or 4")),
    };
    found.ok_or_else(|| {
        let wanted = match choice.as_str() {
            "" => "Embree 4 or 3.13".to_owned(),
            major => format!("Embree {major} (LUMIFLOW_EMBREE={major})"),
        };
        format!(
            "{wanted} was not found.\n\
             Debian 13 (Embree 4) and Debian 12 (Embree 3.13): apt-get install libembree-dev\n\
             Embree 4 on Debian 12: ffi/embree4-sys/prefix.sh target/embree4, then LUMIFLOW_EMBREE=4\n\
             Elsewhere: set EMBREE_DIR to the folder that has include/embree4 and lib/libembree4.so"
        )
    })
}

fn workspace_prefix() -> PathBuf {
    let manifest = env::var_os("CARGO_MANIFEST_DIR")
        .map(PathBuf::from)
        .unwrap_or_default();
    manifest
        .ancestors()
        .nth(2)
        .unwrap_or(&manifest)
        .join("target/embree4")
}

fn in_prefix(prefix: &Path, major: u32) -> Option<Installation> {
    let found = installation(prefix, &["lib", "lib64"], major)?;
    // The loader needs a path that stays right from any working directory.
    let libraries = fs::canonicalize(&found.libraries).ok()?;
    Some(Installation {
        libraries,
        private: true,
        ..found
    })
}

fn in_system(major: u32) -> Option<Installation> {
    let architecture = env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let multiarch = format!("lib/{architecture}-linux-gnu");
    ["/usr", "/usr/local", "/opt/homebrew"]
        .iter()
        .find_map(|prefix| installation(Path::new(prefix), &[&multiarch, "lib64", "lib"], major))
}

fn installation(prefix: &Path, library_folders: &[&str], major: u32) -> Option<Installation> {
    let headers = prefix.join(format!("include/embree{major}"));
    let header = headers.join("rtcore.h");
    let target = env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    let suffix = if target == "macos" { "dylib" } else { "so" };
    let library = format!("libembree{major}.{suffix}");
    let libraries = library_folders
        .iter()
        .map(|folder| prefix.join(folder))
        .find(|folder| folder.join(&library).exists())?;
    println!(
        "cargo::rerun-if-changed={}",
        libraries.join(&library).display()
    );
    header.exists().then_some(Installation {
        major,
        headers,
        libraries,
        private: false,
    })
}

fn build(installation: &Installation) -> Result<(), Box<dyn Error>> {
    let libraries = installation.libraries.display();
    println!("cargo::rustc-link-search=native={libraries}");
    println!("cargo::rustc-link-lib=dylib=embree{}", installation.major);
    if installation.private {
        // For this package's own tests and examples; the root build script does the same for its
        // own with the directory it gets as DEP_EMBREE_RPATH.
        println!("cargo::rustc-link-arg=-Wl,-rpath,{libraries}");
        println!("cargo::metadata=rpath={libraries}");
    }
    compile_shim(installation);
    generate_bindings(installation)
}

fn compile_shim(installation: &Installation) {
    let sources = ["csrc/shim.c", "csrc/raw.c", "csrc/analytic.c"];
    println!("cargo::rerun-if-changed=csrc");
    cc::Build::new()
        .files(sources)
        .std("c11")
        .opt_level(3)
        // The same bits with and without fused multiply-add in the instruction set.
        .flag("-ffp-contract=off")
        // Reads what Embree has written in the pieces that it was written in.
        .flag_if_supported("-fno-tree-slp-vectorize")
        .flag("-isystem")
        .flag(&installation.headers)
        .warnings(true)
        .extra_warnings(true)
        .compile("embree_shim");
}

fn generate_bindings(installation: &Installation) -> Result<(), Box<dyn Error>> {
    println!(
        "cargo::rerun-if-changed={}",
        installation.headers.join("rtcore_config.h").display()
    );
    let target = bindgen::RustTarget::stable(85, 0).map_err(|error| error.to_string())?;
    let bindings = bindgen::Builder::default()
        .header("csrc/shim.h")
        .clang_arg(format!("-I{}", installation.headers.display()))
        .rust_target(target)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .allowlist_function("shim_.*")
        .allowlist_function("rtc(New|Release)(Device|Scene|Geometry)")
        .allowlist_function("rtcCommit(Scene|Geometry)")
        .allowlist_function("rtcGetDevice(Error|Property)")
        .allowlist_function("rtcSetDevice(Error|MemoryMonitor)Function")
        .allowlist_function("rtcSetScene(Flags|BuildQuality)")
        .allowlist_function("rtcGetSceneBounds")
        .allowlist_function("rtcAttachGeometryByID")
        .allowlist_function("rtcGetGeometry(BufferData)?")
        .allowlist_function("rtcSetSharedGeometryBuffer")
        .allowlist_function("rtcSetGeometry(Mask|InstancedScene|Transform)")
        .allowlist_var("RTC_(VERSION_MAJOR|VERSION_MINOR|VERSION_PATCH)")
        .default_enum_style(bindgen::EnumVariation::Consts)
        .prepend_enum_name(false)
        .derive_default(true)
        // Its pointers have no default.
        .no_default("ShimCurves")
        .generate()?;
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo did not set OUT_DIR")?);
    bindings.write_to_file(out.join("bindings.rs"))?;
    Ok(())
}
