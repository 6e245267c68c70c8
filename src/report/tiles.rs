//! Does noise explain the difference? Sums over tiles, in units of their standard errors.

use super::pixels::{QUANTITIES, Subject, quantities, variances};
use crate::math::statistics::two_sided_p;

/// z-scores of the tiles of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileScores {
    /// Tiles that were tested. Tiles that agree to rounding and have no variance are not.
    pub tiles: usize,
    /// Mean of z², one where noise is all there is.
    pub mean_square: f64,
    /// Largest |z|; infinite where tiles without variance differ, and where a value is not finite.
    pub largest: f64,
    /// Share of the tiles with |z| > 3: 0.27 % where noise is all there is.
    pub beyond_three: f64,
    /// Chance that noise alone gives a largest |z| at least as large.
    pub p_of_largest: f64,
}

/// z-scores of luminance, red, green and blue; `None` unless the variances of both images are known.
///
/// Assumes that pixels are independent, which filters wider than a pixel make wrong: z² is then
/// above one without any error.
///
/// - `side`: of a tile in pixels, positive; tiles at the right and lower edge can be smaller.
pub fn tile_scores(subject: &Subject<'_>, side: u32) -> Option<[TileScores; QUANTITIES]> {
    subject.variance.and(subject.reference_variance)?;
    let scores = tiles(subject, side);
    Some(std::array::from_fn(|quantity| {
        summarise(scores.iter().filter_map(|z| z[quantity]))
    }))
}

/// Sums over a tile.
#[derive(Clone, Copy, Default)]
struct Sums {
    difference: f64,
    variance: f64,
    /// Of the larger of both values' sizes.
    size: f64,
}

/// z of each quantity of each tile; `None` where there is nothing to test.
fn tiles(subject: &Subject<'_>, side: u32) -> Vec<[Option<f64>; QUANTITIES]> {
    let (width, height) = (subject.image.width, subject.image.height);
    let columns = width.div_ceil(side);
    let mut sums = vec![[Sums::default(); QUANTITIES]; (columns * height.div_ceil(side)) as usize];
    for index in subject.indices() {
        let (x, y) = (index as u32 % width, index as u32 / width);
        let tile = &mut sums[(y / side * columns + x / side) as usize];
        let own = quantities(subject.image.colours[index]);
        let other = quantities(subject.reference.colours[index]);
        let spread = subject.variance_of_difference(index).unwrap_or_default();
        for (quantity, spread) in variances(spread).into_iter().enumerate() {
            let sums = &mut tile[quantity];
            let (own, other) = (own[quantity], other[quantity]);
            sums.difference += own - other;
            sums.variance += spread;
            sums.size += own.abs().max(other.abs());
        }
    }
    sums.into_iter().map(|tile| tile.map(z_score)).collect()
}

/// A difference in units of its standard error; infinite where a value is not finite.
fn z_score(sums: Sums) -> Option<f64> {
    let rounding = f64::from(f32::EPSILON) * sums.size;
    if sums.variance == 0.0 && sums.difference.abs() <= rounding {
        return None;
    }
    let z = sums.difference / sums.variance.sqrt();
    Some(if z.is_nan() { f64::INFINITY } else { z })
}

fn summarise(scores: impl Iterator<Item = f64>) -> TileScores {
    let (mut tiles, mut squares, mut largest, mut beyond) = (0, 0.0, 0.0_f64, 0);
    for z in scores {
        tiles += 1;
        squares += z * z;
        largest = largest.max(z.abs());
        beyond += usize::from(z.abs() > 3.0);
    }
    let count = tiles as f64;
    // One minus the chance that all stay below, without cancellation.
    let p_of_largest = -(count * (-two_sided_p(largest)).ln_1p()).exp_m1();
    TileScores {
        tiles,
        mean_square: squares / count,
        largest,
        beyond_three: beyond as f64 / count,
        p_of_largest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::random::{Purpose, Stream};
    use crate::report::Pixels;

    const SIDE: u32 = 128;

    fn flat(value: f32) -> Pixels {
        Pixels {
            width: SIDE,
            height: SIDE,
            colours: vec![Rgb::grey(value); (SIDE * SIDE) as usize],
        }
    }

    /// Noise of standard deviation one in each channel, by the sum of twelve uniform numbers.
    fn noisy(mean: f32, seed: u64) -> Pixels {
        let mut stream = Stream::new(seed, Purpose::Check, 0, 0);
        let mut pixels = flat(mean);
        for colour in &mut pixels.colours {
            let mut normal = || (0..12).map(|_| stream.next_f32()).sum::<f32>() - 6.0;
            *colour += Rgb::new(normal(), normal(), normal());
        }
        pixels
    }

    fn scores(image: &Pixels, reference: &Pixels, counted: &[bool]) -> [TileScores; QUANTITIES] {
        let ones = flat(1.0);
        let subject = Subject {
            image,
            reference,
            variance: Some(&ones),
            reference_variance: Some(&ones),
            counted,
        };
        tile_scores(&subject, 16).unwrap()
    }

    #[test]
    fn noise_alone_has_a_mean_square_of_one() {
        let found = scores(&noisy(10.0, 1), &noisy(10.0, 2), &[]);
        for channel in &found[1..] {
            assert_eq!(channel.tiles, 64);
            assert!((channel.mean_square - 1.0).abs() < 0.6, "{channel:?}");
            assert!(channel.p_of_largest > 1e-3, "{channel:?}");
        }
        // Independent channels, tested as if they went together.
        assert!(found[0].mean_square < 1.0);
    }

    #[test]
    fn a_planted_error_in_one_tile_is_found_and_can_be_masked() {
        let mut image = noisy(10.0, 1);
        for y in 32..48 {
            for x in 64..80 {
                // The sum over 256 pixels moves by 256, its standard error is √512 ≈ 23.
                image.colours[(y * SIDE + x) as usize] += Rgb::new(0.0, 1.0, 0.0);
            }
        }
        let reference = noisy(10.0, 2);
        let found = scores(&image, &reference, &[]);
        assert!(
            found[2].largest > 8.0 && found[2].p_of_largest < 1e-9,
            "{found:?}"
        );
        assert!(found[1].p_of_largest > 1e-3 && found[3].p_of_largest > 1e-3);
        let counted: Vec<bool> = (0..SIDE * SIDE)
            .map(|i| !((64..80).contains(&(i % SIDE)) && (32..48).contains(&(i / SIDE))))
            .collect();
        let masked = scores(&image, &reference, &counted);
        assert!(masked[2].p_of_largest > 1e-3, "{masked:?}");
        assert_eq!(masked[2].tiles, 63);
    }

    #[test]
    fn a_small_error_everywhere_shows_in_the_mean_square() {
        let found = scores(&noisy(10.1, 1), &noisy(10.0, 2), &[]);
        // A shift of 25.6 in each tile adds (25.6/22.6)² = 1.28.
        assert!(found[1].mean_square > 1.7, "{:?}", found[1]);
    }

    #[test]
    fn differences_without_variance_are_certain_and_agreement_is_not_tested() {
        let zeros = flat(0.0);
        let mut image = flat(1.0);
        image.colours[0] = Rgb::new(1.0, 2.0, 1.0);
        let reference = flat(1.0);
        let subject = Subject {
            image: &image,
            reference: &reference,
            variance: Some(&zeros),
            reference_variance: Some(&zeros),
            counted: &[],
        };
        let found = tile_scores(&subject, 16).unwrap();
        assert_eq!((found[2].tiles, found[2].largest), (1, f64::INFINITY));
        assert_eq!(found[1].tiles, 0);
        // What rounding makes of a mean is no difference.
        let rounded = flat(1.0 + f32::EPSILON);
        let nearly = Subject {
            image: &rounded,
            ..subject
        };
        assert_eq!(tile_scores(&nearly, 16).unwrap()[1].tiles, 0);
        let mut not_finite = image.clone();
        not_finite.colours[0] = Rgb::grey(f32::NAN);
        let broken = Subject {
            image: &not_finite,
            ..subject
        };
        assert_eq!(tile_scores(&broken, 16).unwrap()[1].largest, f64::INFINITY);
        let without = Subject {
            variance: None,
            ..subject
        };
        assert!(tile_scores(&without, 16).is_none());
    }
}
