//! Reading pictures that are measured.

use std::path::Path;

use super::args::Crop;
use super::failure::Failure;
use crate::image::{AttributeValue, ImageError, read_bitmap, read_exr};
use crate::integrator::correlates_pixels;
use crate::math::Rgb;
use crate::output::FileKind;
use crate::report::Pixels;

/// The colours of an image of any kind.
pub(super) fn pixels(path: &Path) -> Result<Pixels, ImageError> {
    let bitmap = read_bitmap(path)?;
    let (width, height) = (bitmap.width(), bitmap.height());
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Ok(Pixels {
        width,
        height,
        colours: places.map(|(x, y)| bitmap.rgb(x, y)).collect(),
    })
}

/// Variances: the layer of that name, or else the colours.
pub(super) fn variance(path: &Path) -> Result<Pixels, ImageError> {
    let is_exr = FileKind::of(path) == Some(FileKind::Exr);
    if is_exr {
        let image = read_exr(path)?;
        if let Some(colours) = image.rgb("variance") {
            return Ok(Pixels {
                width: image.width(),
                height: image.height(),
                colours: colours.into_iter().map(Rgb::from).collect(),
            });
        }
    }
    pixels(path)
}

/// Whether a file says that an algorithm has rendered it whose pixels depend on each other.
pub(super) fn has_correlated_pixels(path: &Path) -> bool {
    let is_exr = FileKind::of(path) == Some(FileKind::Exr);
    let image = is_exr.then(|| read_exr(path)).and_then(Result::ok);
    let name = image.and_then(|mut image| image.metadata.remove("lumiflow.integrator"));
    matches!(name, Some(AttributeValue::String(name)) if correlates_pixels(&name))
}

/// Cuts the wanted part out.
///
/// # Errors
/// [`Failure::Usage`] when it reaches beyond the edges.
pub(super) fn cropped(image: Pixels, crop: Option<Crop>) -> Result<Pixels, Failure> {
    let Some(Crop {
        x,
        y,
        width,
        height,
    }) = crop
    else {
        return Ok(image);
    };
    image.crop(x, y, width, height).ok_or_else(|| {
        Failure::Usage(format!(
            "--crop {x},{y},{width},{height} reaches beyond the {}x{} pixels of the images",
            image.width, image.height
        ))
    })
}
