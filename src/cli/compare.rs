//! `lumiflow compare`.

use std::path::Path;

use serde_json::{Value, json};

use super::args::CompareArgs;
use super::console::print_line;
use super::failure::{Failure, sizes_differ};
use super::outputs::check_file;
use super::pictures::{cropped, has_correlated_pixels, pixels, variance};
use crate::image::{ImageError, write_png};
use crate::output::FileKind;
use crate::report::{
    Comparison, Pixels, Subject, TileScores, compare, heat_map, mean_flip, tile_scores,
};

/// Relative error at which the picture of the error has its full colour.
const HEAT_SCALE: f32 = 0.5;

/// Names of the quantities in the order of the reports.
const QUANTITIES: [&str; 4] = ["luminance", "red", "green", "blue"];

/// All that was measured.
struct Findings {
    comparison: Comparison,
    flip: f64,
    tiles: Option<[TileScores; 4]>,
    tile: u32,
    /// Whether pixels of a file with variances depend on each other.
    are_correlated: bool,
    /// Pixels that count and are not finite, of the image and of the reference.
    not_finite: [usize; 2],
}

/// Measures how far an image is from a reference.
///
/// # Errors
/// Files that cannot be read or written, and images of different sizes.
pub(super) fn run(args: &CompareArgs) -> Result<(), Failure> {
    if let Some(output) = &args.output {
        if FileKind::of(output) != Some(FileKind::Png) {
            let output = output.display();
            return Err(Failure::Usage(format!(
                "{output}: expected a name that ends in .png"
            )));
        }
        check_file(output)?;
    }
    let image = pixels(&args.image)?;
    let size = (image.width, image.height);
    let reader = Reader { args, size };
    let image = reader.fit(image, &args.image)?;
    let reference = reader.fit(pixels(&args.reference)?, &args.reference)?;
    let own_variance = reader.optional(args.variance.as_deref(), variance)?;
    let reference_variance = reader.optional(args.reference_variance.as_deref(), variance)?;
    let mask = reader.optional(args.mask.as_deref(), pixels)?;
    let counted: Vec<bool> = mask.map_or_else(Vec::new, |mask| {
        mask.colours
            .iter()
            .map(|colour| colour.is_black())
            .collect()
    });
    let subject = Subject {
        image: &image,
        reference: &reference,
        variance: own_variance.as_ref(),
        reference_variance: reference_variance.as_ref(),
        counted: &counted,
    };
    let comparison = compare(&subject);
    if comparison.pixels == 0 {
        return Err(Failure::Usage(
            "the mask leaves no pixel to compare".to_owned(),
        ));
    }
    let variances = [&args.variance, &args.reference_variance];
    let findings = Findings {
        are_correlated: variances
            .into_iter()
            .flatten()
            .any(|path| has_correlated_pixels(path)),
        comparison,
        flip: mean_flip(&subject, args.exposure),
        tiles: tile_scores(&subject, args.tile),
        tile: args.tile,
        not_finite: [subject.not_finite(&image), subject.not_finite(&reference)],
    };
    if let Some(output) = &args.output {
        let colours = heat_map(&subject, HEAT_SCALE);
        write_png(output, image.width, image.height, &colours, 0.0)?;
    }
    print_line(&if args.json {
        findings.json().to_string()
    } else {
        findings.table()
    })
}

/// Reads what belongs to images of one size.
struct Reader<'a> {
    args: &'a CompareArgs,
    size: (u32, u32),
}

impl Reader<'_> {
    /// Checks the size of an image and cuts the wanted part out.
    fn fit(&self, image: Pixels, path: &Path) -> Result<Pixels, Failure> {
        let size = (image.width, image.height);
        if size != self.size {
            return Err(sizes_differ(&self.args.image, self.size, path, size));
        }
        cropped(image, self.args.crop)
    }

    fn optional(
        &self,
        path: Option<&Path>,
        read: fn(&Path) -> Result<Pixels, ImageError>,
    ) -> Result<Option<Pixels>, Failure> {
        path.map(|path| self.fit(read(path)?, path)).transpose()
    }
}

impl Findings {
    fn json(&self) -> Value {
        let found = &self.comparison;
        let by_quantity = |of: &dyn Fn(usize) -> Value| -> Value {
            let pairs = QUANTITIES.iter().enumerate();
            pairs.map(|(i, name)| ((*name).to_owned(), of(i))).collect()
        };
        let ratio = |i: usize| {
            let ratio = found.ratios[i];
            json!({ "ratio": ratio.value, "standard_error": ratio.standard_error })
        };
        let tiles = self.tiles.map(|tiles| {
            by_quantity(&|i| {
                let scores = tiles[i];
                json!({
                    "tiles": scores.tiles,
                    "mean_z2": scores.mean_square,
                    // JSON has no infinity.
                    "max_z": scores.largest.min(f64::MAX),
                    "share_beyond_3": scores.beyond_three,
                    "p_of_max": scores.p_of_largest,
                })
            })
        });
        json!({
            "pixels": found.pixels,
            "mse": found.mse,
            "err": found.luminance_mse,
            "relmse": found.relative_mse,
            "reference_noise": found.reference_noise,
            "relmse_corrected": found.corrected_relative_mse(),
            "means": by_quantity(&ratio),
            "flip": self.flip,
            "tile_size": self.tile,
            "tiles": tiles,
            "correlated_pixels": self.are_correlated,
            "not_finite": { "image": self.not_finite[0], "reference": self.not_finite[1] },
        })
    }

    fn table(&self) -> String {
        let found = &self.comparison;
        let mut lines = vec![
            row("pixels", &found.pixels.to_string()),
            row("MSE", &format!("{:.4e}", found.mse)),
            row("relMSE", &format!("{:.4e}", found.relative_mse)),
        ];
        if let (Some(noise), Some(rest)) = (found.reference_noise, found.corrected_relative_mse()) {
            let text = format!("{rest:.4e} (the reference's noise is {noise:.4e})");
            lines.push(row("  corrected", &text));
        }
        for (name, ratio) in QUANTITIES.iter().zip(&found.ratios) {
            let error = ratio.standard_error;
            let error = error.map_or_else(String::new, |error| format!(" ± {error:.5}"));
            lines.push(row(
                &format!("mean {name}"),
                &format!("{:.5}{error}", ratio.value),
            ));
        }
        lines.push(row("FLIP", &format!("{:.5}", self.flip)));
        if let Some(tiles) = &self.tiles {
            let side = self.tile;
            // Only replicas of whole renders tell how much the means of such tiles vary.
            let of_noise = if self.are_correlated {
                "chains make neighbours depend on each other: these, and ±, know less than all of it"
            } else {
                "noise alone gives a mean z² of 1"
            };
            lines.push(format!(
                "z-scores of tiles of {side}x{side} pixels; {of_noise}"
            ));
            for (name, scores) in QUANTITIES.iter().zip(tiles) {
                lines.push(row(&format!("  {name}"), &tile_text(scores)));
            }
        }
        let [image, reference] = self.not_finite;
        if image + reference > 0 {
            let text = format!("{image} pixels of the image, {reference} of the reference");
            lines.push(row("not finite", &text));
        }
        lines.join("\n")
    }
}

fn row(name: &str, value: &str) -> String {
    format!("{name:<16}{value}")
}

fn tile_text(scores: &TileScores) -> String {
    format!(
        "mean z² {:.3}, max |z| {:.2} (p = {:.2e}), |z| > 3 in {:.2} % of {} tiles",
        scores.mean_square,
        scores.largest,
        scores.p_of_largest,
        100.0 * scores.beyond_three,
        scores.tiles
    )
}
