//! `lumiflow compare` and `lumiflow convert`.

use lumiflow::image::{
    AttributeValue, ExrOptions, Image, Precision, read_bitmap, write_exr, write_png,
};

use super::Place;

const SIDE: u32 = 32;

/// An image of one grey, with the pixels of a tile brighter by `more`.
fn image(place: &Place, name: &str, grey: f32, more: f32) {
    let pixels: Vec<[f32; 3]> = (0..SIDE * SIDE)
        .map(|i| {
            let in_tile = i % SIDE < 16 && i / SIDE < 16;
            [grey + if in_tile { more } else { 0.0 }; 3]
        })
        .collect();
    let mut image = Image::new(SIDE, SIDE);
    image.push_rgb("", Precision::Float, &pixels);
    let _ = write_exr(&place.path(name), &image, &ExrOptions::default()).unwrap();
}

fn close(found: &serde_json::Value, expected: f64) {
    let value = found.as_f64().unwrap_or(f64::NAN);
    assert!(
        (value - expected).abs() <= 1e-5 * expected.abs(),
        "{value} is not {expected}"
    );
}

#[test]
fn known_differences_have_known_errors() {
    let place = Place::new();
    image(&place, "i.exr", 1.1, 0.0);
    image(&place, "r.exr", 1.0, 0.0);
    image(&place, "v.exr", 0.01, 0.0);
    let found = place
        .succeed(&["compare", "i.exr", "r.exr", "--json"])
        .json();
    close(&found["mse"], 0.01);
    close(&found["relmse"], 0.01 / 1.01);
    close(&found["means"]["luminance"]["ratio"], 1.1);
    assert!(found["tiles"].is_null() && found["relmse_corrected"].is_null());
    assert!(
        found["flip"].as_f64().unwrap() < 1e-6,
        "both are white on a monitor"
    );
    let dark = ["compare", "i.exr", "r.exr", "--json", "--exposure", "-1"];
    assert!(place.succeed(&dark).json()["flip"].as_f64().unwrap() > 0.001);
    let mut arguments = vec!["compare", "i.exr", "r.exr", "--json", "--variance", "v.exr"];
    arguments.extend(["--reference-variance", "v.exr", "--tile", "16"]);
    let found = place.succeed(&arguments).json();
    assert!(found["relmse_corrected"].as_f64().unwrap().abs() < 1e-8);
    // 256 pixels a tile, each off by 0.1 with a variance of 0.02: z = 25.6 / sqrt(5.12).
    close(&found["tiles"]["green"]["mean_z2"], 128.0);
    close(&found["tiles"]["green"]["max_z"], 128.0_f64.sqrt());
    close(
        &found["means"]["red"]["standard_error"],
        (0.01 * 2.21_f64 / 1024.0).sqrt(),
    );
}

#[test]
fn scores_of_pixels_that_depend_on_each_other_say_so() {
    let place = Place::new();
    image(&place, "i.exr", 1.1, 0.0);
    let variances = |integrator: &str| {
        let mut image = Image::new(SIDE, SIDE);
        image.push_rgb(
            "",
            Precision::Float,
            &vec![[0.01; 3]; (SIDE * SIDE) as usize],
        );
        let name = AttributeValue::String(integrator.to_owned());
        image
            .metadata
            .insert("lumiflow.integrator".to_owned(), name);
        let _ = write_exr(&place.path("v.exr"), &image, &ExrOptions::default()).unwrap();
        let arguments = ["compare", "i.exr", "i.exr", "--variance", "v.exr"];
        let arguments = [&arguments[..], &["--reference-variance", "v.exr"]].concat();
        let text = place.succeed(&arguments).stdout;
        let found = place
            .succeed(&[&arguments[..], &["--json"]].concat())
            .json();
        (text, found["correlated_pixels"].as_bool())
    };
    let (text, is_correlated) = variances("erpt");
    assert!(text.contains("depend on each other"), "{text}");
    assert_eq!(is_correlated, Some(true));
    let (text, is_correlated) = variances("path");
    assert!(text.contains("noise alone"), "{text}");
    assert_eq!(is_correlated, Some(false));
}

#[test]
fn masks_and_crops_leave_the_planted_error_out() {
    let place = Place::new();
    image(&place, "i.exr", 1.0, 0.5);
    image(&place, "r.exr", 1.0, 0.0);
    let mask: Vec<[f32; 3]> = (0..SIDE * SIDE)
        .map(|i| if i % SIDE < 16 { [1.0; 3] } else { [0.0; 3] })
        .collect();
    write_png(&place.path("m.png"), SIDE, SIDE, &mask, 0.0).unwrap();
    let found = place
        .succeed(&["compare", "i.exr", "r.exr", "--json"])
        .json();
    close(&found["mse"], 0.25 / 4.0);
    let masked = ["compare", "i.exr", "r.exr", "--json", "--mask", "m.png"];
    let found = place.succeed(&masked).json();
    assert_eq!(
        (found["mse"].as_f64(), found["pixels"].as_u64()),
        (Some(0.0), Some(512))
    );
    let cut = ["compare", "i.exr", "r.exr", "--json", "--crop", "8,8,16,16"];
    close(&place.succeed(&cut).json()["mse"], 0.25 / 4.0);
    let beyond = ["compare", "i.exr", "r.exr", "--crop", "20,0,16,16"];
    place.fail(&beyond, 2, "reaches beyond the 32x32 pixels");
}

#[test]
fn people_get_a_table_and_a_picture() {
    let place = Place::new();
    image(&place, "i.exr", 1.0, 0.5);
    image(&place, "r.exr", 1.0, 0.0);
    let done = place.succeed(&["compare", "i.exr", "r.exr", "-o", "heat.png"]);
    for part in ["relMSE", "FLIP", "mean luminance"] {
        assert!(done.stdout.contains(part), "{}", done.stdout);
    }
    let heat = read_bitmap(&place.path("heat.png")).unwrap();
    assert!(heat.rgb(2, 2).g() < 0.1, "too bright is red");
    assert_eq!(heat.rgb(30, 30).to_array(), [1.0; 3]);
    place.fail(
        &["compare", "i.exr", "r.exr", "-o", "heat.exr"],
        2,
        "ends in .png",
    );
    place.fail(&["compare", "i.exr", "absent.exr"], 4, "absent.exr");
}

#[test]
fn images_of_two_sizes_are_not_compared() {
    let place = Place::new();
    image(&place, "i.exr", 1.0, 0.0);
    write_png(&place.path("small.png"), 2, 2, &[[0.0; 3]; 4], 0.0).unwrap();
    place.fail(
        &["compare", "i.exr", "small.png"],
        2,
        "i.exr is 32x32, but small.png is 2x2",
    );
}

#[test]
fn exr_files_become_png_files() {
    let place = Place::new();
    image(&place, "i.exr", 0.25, 0.0);
    place.succeed(&["convert", "i.exr", "o.png", "--exposure", "2"]);
    let png = read_bitmap(&place.path("o.png")).unwrap();
    assert_eq!(png.rgb(3, 3).to_array(), [1.0; 3]);
    let layer = ["convert", "i.exr", "o.png", "--layer", "albedo"];
    place.fail(&layer, 2, "has no layer \"albedo\"; it has no layers");
    place.fail(&["convert", "i.exr", "o.exr"], 2, "ends in .png");
    place.fail(&["convert", "absent.exr", "o.png"], 4, "absent.exr");
}
