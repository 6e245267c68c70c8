//! Parts of images side by side, with names.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::image::srgb_decode;
use crate::math::Rgb;
use crate::report::Pixels;

/// Tiles that are narrower are enlarged, by a whole factor; in pixels.
const NARROWEST: u32 = 160;

/// Space between tiles, in pixels.
const GAP: u32 = 10;

const WEIGHT: FontWeight = FontWeight::Regular;
const HEIGHT: RasterHeight = RasterHeight::Size16;
const LINE: u32 = HEIGHT.val() as u32 + 2;
const LETTER: u32 = get_raster_width(WEIGHT, HEIGHT) as u32;

/// A part of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Its pixels; `None` leaves the place empty.
    pub pixels: Option<Pixels>,
    /// What is written below it.
    pub caption: String,
}

/// A table of tiles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// What stands above the columns.
    pub columns: Vec<String>,
    /// The rows, each with what stands on its left and a tile for each column. All tiles of a row
    /// have one size.
    pub rows: Vec<(String, Vec<Tile>)>,
}

impl Sheet {
    /// The picture: dark letters on white; pixels of small tiles are enlarged to squares.
    pub fn picture(&self) -> Pixels {
        let heights: Vec<u32> = self
            .rows
            .iter()
            .map(|(_, tiles)| row_height(tiles))
            .collect();
        let tile_width = self.rows.iter().map(|(_, tiles)| tile_size(tiles).0).max();
        let tile_width = tile_width.unwrap_or(0).max(NARROWEST);
        let letters = (tile_width / LETTER).max(1) as usize;
        let names = self.rows.iter().map(|(name, _)| name.len() as u32);
        let left = GAP + names.max().unwrap_or(0) * LETTER + GAP;
        let heads: Vec<Vec<String>> = self.columns.iter().map(|c| broken(c, letters)).collect();
        let head = heads.iter().map(Vec::len).max().unwrap_or(0) as u32 * LINE + GAP;

        let columns = self.columns.len() as u32;
        let rows: u32 = heights.iter().map(|height| height + GAP).sum();
        let mut canvas = Canvas::new(left + columns * (tile_width + GAP), GAP + head + rows);
        let place = |column: usize| left + column as u32 * (tile_width + GAP);
        for (column, lines) in heads.iter().enumerate() {
            for (index, line) in lines.iter().enumerate() {
                canvas.write(place(column), GAP + index as u32 * LINE, line);
            }
        }
        let mut top = GAP + head;
        for ((name, tiles), height) in self.rows.iter().zip(&heights) {
            canvas.write(GAP, top, name);
            let below = top + tile_size(tiles).1;
            for (column, tile) in tiles.iter().enumerate() {
                if let Some(pixels) = &tile.pixels {
                    canvas.paste(place(column), top, pixels);
                }
                canvas.write(place(column), below + 2, &tile.caption);
            }
            top += height + GAP;
        }
        canvas.0
    }
}

fn scale(pixels: &Pixels) -> u32 {
    NARROWEST.div_ceil(pixels.width.max(1))
}

/// Width and height of the tiles of a row on the picture.
fn tile_size(tiles: &[Tile]) -> (u32, u32) {
    let pixels = tiles.iter().filter_map(|tile| tile.pixels.as_ref());
    let sizes = pixels.map(|pixels| (pixels.width * scale(pixels), pixels.height * scale(pixels)));
    sizes.fold((0, 0), |most, size| {
        (most.0.max(size.0), most.1.max(size.1))
    })
}

fn row_height(tiles: &[Tile]) -> u32 {
    tile_size(tiles).1 + LINE + 2
}

/// A text in lines of so many letters.
fn broken(text: &str, letters: usize) -> Vec<String> {
    let all: Vec<char> = text.chars().collect();
    all.chunks(letters)
        .map(|line| line.iter().collect())
        .collect()
}

/// A white picture to draw on; what lies beyond its edges is not drawn.
struct Canvas(Pixels);

impl Canvas {
    fn new(width: u32, height: u32) -> Self {
        Self(Pixels {
            width,
            height,
            colours: vec![Rgb::WHITE; width as usize * height as usize],
        })
    }

    fn set(&mut self, x: u32, y: u32, colour: Rgb) {
        if x < self.0.width && y < self.0.height {
            let index = y as usize * self.0.width as usize + x as usize;
            self.0.colours[index] = colour;
        }
    }

    fn paste(&mut self, left: u32, top: u32, pixels: &Pixels) {
        let scale = scale(pixels);
        for y in 0..pixels.height * scale {
            for x in 0..pixels.width * scale {
                let index = (y / scale) as usize * pixels.width as usize + (x / scale) as usize;
                self.set(left + x, top + y, pixels.colours[index]);
            }
        }
    }

    /// Writes a line; letters without a picture appear as `?`.
    fn write(&mut self, left: u32, top: u32, text: &str) {
        for (index, letter) in text.chars().enumerate() {
            let known = get_raster(letter, WEIGHT, HEIGHT);
            let Some(raster) = known.or_else(|| get_raster('?', WEIGHT, HEIGHT)) else {
                continue;
            };
            let left = left + index as u32 * LETTER;
            for (y, row) in raster.rows().enumerate() {
                for (x, ink) in row.iter().enumerate().filter(|(_, ink)| **ink > 0) {
                    let grey = Rgb::grey(srgb_decode(1.0 - f32::from(*ink) / 255.0));
                    self.set(left + x as u32, top + y as u32, grey);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(width: u32, height: u32, colour: Rgb) -> Option<Pixels> {
        Some(Pixels {
            width,
            height,
            colours: vec![colour; (width * height) as usize],
        })
    }

    fn tile(pixels: Option<Pixels>) -> Tile {
        Tile {
            pixels,
            caption: "0.1".to_owned(),
        }
    }

    fn count(picture: &Pixels, colour: Rgb) -> usize {
        picture.colours.iter().filter(|c| **c == colour).count()
    }

    #[test]
    fn tiles_keep_their_colours_and_small_ones_grow() {
        let (red, blue) = (Rgb::new(0.7, 0.0, 0.0), Rgb::new(0.0, 0.0, 0.4));
        let sheet = Sheet {
            columns: vec![
                "reference".to_owned(),
                "a name that is longer than a tile".to_owned(),
            ],
            rows: vec![
                (
                    "1 s".to_owned(),
                    vec![tile(flat(16, 8, red)), tile(flat(16, 8, blue))],
                ),
                ("4 s".to_owned(), vec![tile(flat(16, 8, red)), tile(None)]),
            ],
        };
        let picture = sheet.picture();
        assert_eq!(count(&picture, red), 2 * 160 * 80);
        assert_eq!(count(&picture, blue), 160 * 80);
        let all = (picture.width * picture.height) as usize;
        assert_eq!(picture.colours.len(), all);
        // Letters are darker than the ground.
        let is_dark = |colour: &&Rgb| colour.luminance() < 0.1 && **colour != blue;
        assert!(picture.colours.iter().filter(is_dark).count() > 50);
        assert!(2 * count(&picture, Rgb::WHITE) > all / 4);
    }

    #[test]
    fn large_tiles_stay_as_they_are() {
        let red = Rgb::new(0.7, 0.0, 0.0);
        let sheet = Sheet {
            columns: vec!["a".to_owned()],
            rows: vec![(String::new(), vec![tile(flat(200, 3, red))])],
        };
        let picture = sheet.picture();
        assert_eq!(count(&picture, red), 600);
        assert!(picture.width >= 200 && picture.height >= 3);
        assert_eq!(broken("abcdefg", 3), ["abc", "def", "g"]);
    }
}
