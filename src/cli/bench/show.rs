//! What a race shows of a scene: the plot, and the images side by side.

use std::path::Path;

use super::files::Folder;
use super::race::{Rules, Slot};
use super::stage::Stage;
use crate::cli::args::Crop;
use crate::cli::failure::Failure;
use crate::cli::pictures::pixels;
use crate::image::write_png;
use crate::report::{Measure, Pixels, Sheet, Tile, Trial, error_plot, standings, three_digits};

/// Draws a scene's plot and crops, as far as there is something to draw.
///
/// - `measured`: the renders of the scene that were measured.
///
/// # Errors
/// For images that cannot be read, and files that cannot be written.
pub(super) fn show(
    folder: &Folder<'_>,
    rules: &Rules<'_>,
    stage: &Stage,
    measured: &[&Slot],
) -> Result<(), Failure> {
    let scene = &stage.course.name;
    let trials = measured.iter().filter_map(|slot| slot.trial().cloned());
    let trials: Vec<Trial> = trials.collect();
    let plot = error_plot(scene, &standings(&trials));
    let plot = plot.map_err(|error| Failure::File(error.to_string()))?;
    if let Some(text) = plot {
        folder.put(&folder.plot(scene), text.as_bytes())?;
    }
    let first = measured.iter().filter(|slot| slot.seed == rules.args.seed);
    let first: Vec<&Slot> = first.copied().collect();
    if first.is_empty() {
        return Ok(());
    }
    let picture = sheet(folder, rules, stage, &first)?.picture();
    let colours: Vec<[f32; 3]> = picture.colours.iter().map(|c| c.to_array()).collect();
    let path = folder.path(&folder.crops(scene));
    write_png(&path, picture.width, picture.height, &colours, 0.0)?;
    Ok(())
}

/// The parts that are shown: a column for the reference and for each entrant, a row for each budget.
fn sheet(
    folder: &Folder<'_>,
    rules: &Rules<'_>,
    stage: &Stage,
    first: &[&Slot],
) -> Result<Sheet, Failure> {
    let labels = rules.entrants.iter().map(|entrant| entrant.label.clone());
    let mut sheet = Sheet {
        columns: std::iter::once("reference".to_owned())
            .chain(labels)
            .collect(),
        rows: Vec::new(),
    };
    for (effort, budget) in rules.efforts.iter().enumerate() {
        let mut images: Vec<Option<(Pixels, String)>> = Vec::new();
        for entrant in 0..rules.entrants.len() {
            let mut found = first.iter();
            let slot = found.find(|slot| (slot.entrant, slot.effort) == (entrant, effort));
            images.push(slot.map(|slot| image(folder, slot)).transpose()?);
        }
        for part in &stage.shown {
            let name = if stage.shown.len() > 1 {
                format!("{} ({},{})", budget.label, part.x, part.y)
            } else {
                budget.label.clone()
            };
            let cut = |image: &Pixels| shown(image, part, rules.args.exposure);
            let mut tiles = vec![Tile {
                pixels: cut(&stage.yardstick.whole),
                caption: String::new(),
            }];
            tiles.extend(images.iter().map(|image| {
                Tile {
                    pixels: image.as_ref().and_then(|(pixels, _)| cut(pixels)),
                    caption: image
                        .as_ref()
                        .map_or(String::new(), |(_, text)| text.clone()),
                }
            }));
            sheet.rows.push((name, tiles));
        }
    }
    Ok(sheet)
}

/// The image of a render, with what is written below it.
fn image(folder: &Folder<'_>, slot: &Slot) -> Result<(Pixels, String), Failure> {
    let path = folder.of_run(&slot.stem, "exr");
    let error = slot
        .trial()
        .map_or(f64::NAN, |trial| Measure::RelativeMse.of(trial));
    Ok((
        pixels(Path::new(&path))?,
        format!("relMSE {}", three_digits(error)),
    ))
}

/// A part of an image as it is shown.
fn shown(image: &Pixels, part: &Crop, exposure: f32) -> Option<Pixels> {
    let mut cut = image.crop(part.x, part.y, part.width, part.height)?;
    for colour in &mut cut.colours {
        *colour *= exposure.exp2();
    }
    Some(cut)
}
