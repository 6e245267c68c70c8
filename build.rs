//! Lets the loader find a private Embree, and records which revision of the sources is built.
//!
//! Sets environment variables for the crate: `LUMIFLOW_GIT_REVISION`, what `git describe` calls this
//! checkout (`unknown` outside of one), and `LUMIFLOW_OPENEXR_HEADERS`, the version of the `OpenEXR`
//! headers that are built with.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=DEP_EMBREE_RPATH");
    if let Ok(libraries) = env::var("DEP_EMBREE_RPATH") {
        println!("cargo::rustc-link-arg=-Wl,-rpath,{libraries}");
    }
    println!("cargo::rerun-if-env-changed=DEP_OPENEXRCORE_VERSION");
    let headers = env::var("DEP_OPENEXRCORE_VERSION").unwrap_or_else(|_| "unknown".to_owned());
    println!("cargo::rustc-env=LUMIFLOW_OPENEXR_HEADERS={headers}");
    let root = env::var_os("CARGO_MANIFEST_DIR")
        .map(PathBuf::from)
        .unwrap_or_default();
    let revision = revision(&root).unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=LUMIFLOW_GIT_REVISION={revision}");
}

fn revision(root: &Path) -> Option<String> {
    // Edited sources make the revision "dirty"; the index is left out, since git rewrites it for
    // reasons of its own and every change would build the crate again.
    for watched in ["build.rs", "Cargo.toml", "src", "ffi"] {
        println!("cargo::rerun-if-changed={}", root.join(watched).display());
    }
    // Sources that were unpacked inside of somebody else's checkout have no revision.
    let top = PathBuf::from(git(root, &["rev-parse", "--show-toplevel"])?);
    if top.canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    // Every commit and checkout moves one of these. The branch alone is not enough, since git may
    // have packed it away; all of refs is too much, since other worktrees move theirs. Git knows
    // which of them belong to this worktree and which to all.
    let branch = git(root, &["symbolic-ref", "--quiet", "HEAD"]);
    let fixed = ["HEAD", "logs/HEAD", "refs/tags", "packed-refs"];
    for name in fixed.into_iter().chain(branch.as_deref()) {
        let path = root.join(git(root, &["rev-parse", "--git-path", name])?);
        // A path that does not exist would run this script on every build.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(root, &["describe", "--always", "--dirty", "--tags"])
}

/// The output of a git command without its line end; nothing if it fails or git is missing.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git")
        .current_dir(root)
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let text = text.trim();
    (output.status.success() && !text.is_empty()).then(|| text.to_owned())
}
