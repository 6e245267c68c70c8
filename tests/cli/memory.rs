//! Renders that do not fit into memory.

use std::process::Command;

use super::{Done, Place};

/// Runs the command with at most so many KiB of addresses.
fn within(place: &Place, kibibytes: u32, arguments: &str) -> Done {
    let program = env!("CARGO_BIN_EXE_lumiflow");
    let script = format!("ulimit -v {kibibytes} && exec {program} {arguments}");
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(place.path(""))
        .output();
    Done::from(output.expect("a shell"))
}

#[test]
fn a_film_that_does_not_fit_is_refused_and_nothing_is_written() {
    let place = Place::with_room();
    let files = place.names();
    // 16 bytes for each of three channels: 12 GiB.
    let arguments = "render room.xml --size 16384x16384 --threads 1 -q -o a.exr";
    let done = within(&place, 6 << 20, arguments);
    assert_eq!(done.code, Some(5), "{}", done.stderr);
    let expected =
        "error: the film of 16384x16384 pixels with its layers needs 12.00 GiB of memory, and ";
    assert!(done.stderr.starts_with(expected), "{}", done.stderr);
    assert!(done.stderr.contains("a smaller --size"), "{}", done.stderr);
    assert_eq!(place.names(), files);
}

#[test]
fn a_film_that_fits_is_told_of() {
    let place = Place::with_room();
    let arguments = "render room.xml --size 512x256 --spp 1 --threads 1 -q --json -o a.exr";
    let done = within(&place, 6 << 20, arguments);
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    let memory = &done.json()["memory"];
    assert_eq!(memory["film"], 512 * 256 * 3 * 16);
    let number = |name: &str| memory[name].as_u64().expect("a number");
    assert!(
        number("tree") > 0 && number("tree_peak") >= number("tree"),
        "{memory}"
    );
    assert_eq!(
        (number("buffers") > 0, number("pictures")),
        (true, 0),
        "{memory}"
    );
    assert!(
        number("peak") >= number("load_peak") && number("loaded") > 0,
        "{memory}"
    );
    let variance = format!("{arguments} --aov variance");
    let memory = &within(&place, 6 << 20, &variance).json()["memory"];
    assert_eq!(memory["film"], 512 * 256 * 3 * (16 + 24));
}
