//! `lumiflow convert`.

use super::args::ConvertArgs;
use super::failure::Failure;
use super::outputs::check_file;
use crate::image::{Image, read_exr, write_png};
use crate::output::FileKind;
use crate::scene::import::xml::did_you_mean;

/// Makes a PNG of one layer of an EXR file.
///
/// # Errors
/// Files that cannot be read or written, and a layer that the file does not have.
pub(super) fn run(args: &ConvertArgs) -> Result<(), Failure> {
    if FileKind::of(&args.output) != Some(FileKind::Png) {
        let output = args.output.display();
        return Err(Failure::Usage(format!(
            "{output}: expected a name that ends in .png"
        )));
    }
    check_file(&args.output)?;
    let image = read_exr(&args.input)?;
    let Some(pixels) = layer(&image, &args.layer) else {
        return Err(no_layer(args, &image));
    };
    let (width, height) = (image.width(), image.height());
    write_png(&args.output, width, height, &pixels, args.exposure)?;
    Ok(())
}

/// The pixels of a layer: its colours, its X, Y, Z or U, V as such, or grey for a single channel.
fn layer(image: &Image, name: &str) -> Option<Vec<[f32; 3]>> {
    let data = |letter: &str| {
        let full = match name {
            "" => letter.to_owned(),
            name => format!("{name}.{letter}"),
        };
        image.channel(&full).map(|channel| channel.data.as_slice())
    };
    let pixel_count = image.width() as usize * image.height() as usize;
    let triple = |letters: [&str; 3]| {
        let [first, second] = [data(letters[0])?, data(letters[1])?];
        let third = data(letters[2]);
        let at = |i: usize| [first[i], second[i], third.map_or(0.0, |third| third[i])];
        Some((0..pixel_count).map(at).collect())
    };
    let grey = |letter: &str| Some(data(letter)?.iter().map(|value| [*value; 3]).collect());
    image
        .rgb(name)
        .or_else(|| triple(["X", "Y", "Z"]))
        .or_else(|| triple(["U", "V", ""]))
        .or_else(|| grey("Y"))
        .or_else(|| grey("Z"))
}

fn no_layer(args: &ConvertArgs, image: &Image) -> Failure {
    let names = image.channels.iter();
    let mut layers: Vec<&str> = names
        .filter_map(|channel| channel.name.rsplit_once('.'))
        .map(|(layer, _)| layer)
        .collect();
    layers.sort_unstable();
    layers.dedup();
    let input = args.input.display();
    let hint = did_you_mean(&args.layer, layers.iter().copied());
    let found = match layers.as_slice() {
        [] => "it has no layers".to_owned(),
        layers => format!("it has {}", layers.join(", ")),
    };
    Failure::Usage(match args.layer.as_str() {
        "" => format!("{input} has no channels R, G, B; {found} (--layer)"),
        layer => format!("{input} has no layer \"{layer}\"{hint}; {found}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Precision;

    #[test]
    fn layers_of_all_kinds_are_shown() {
        let mut image = Image::new(2, 1);
        image.push_rgb("", Precision::Float, &[[1.0; 3], [2.0; 3]]);
        image.push("depth.Z", Precision::Float, vec![4.0, 5.0]);
        image.push("uv.U", Precision::Float, vec![0.1, 0.2]);
        image.push("uv.V", Precision::Float, vec![0.3, 0.4]);
        for (channel, value) in [("X", 0.5), ("Y", 0.6), ("Z", 0.7)] {
            image.push(format!("n.{channel}"), Precision::Float, vec![value; 2]);
        }
        assert_eq!(layer(&image, ""), Some(vec![[1.0; 3], [2.0; 3]]));
        assert_eq!(layer(&image, "depth"), Some(vec![[4.0; 3], [5.0; 3]]));
        assert_eq!(
            layer(&image, "uv"),
            Some(vec![[0.1, 0.3, 0.0], [0.2, 0.4, 0.0]])
        );
        assert_eq!(layer(&image, "n"), Some(vec![[0.5, 0.6, 0.7]; 2]));
        assert_eq!(layer(&image, "albedo"), None);
    }
}
