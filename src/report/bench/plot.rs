//! Error against time, as a picture.

use std::io;

use plotters::coord::Shift;
use plotters::coord::combinators::{BindKeyPoints, LogCoord, WithKeyPoints};
use plotters::prelude::*;

use super::{Measure, Standing};

/// Size of the plot, in pixels at its natural size; the legend stands on its right.
const SIZE: (u32, u32) = (760, 560);

/// Width of a letter of the legend, about, and of all but the letters.
const LETTER: u32 = 8;
const LEGEND: u32 = 56;

/// Distance of the legend's lines, and its top.
const LEGEND_LINE: i32 = 24;
const LEGEND_TOP: i32 = 66;

/// Colours that people with any colour vision tell apart.
///
/// Source: Okabe & Ito 2008.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// What the legend says of the dashed lines.
const GUIDE_NAME: &str = "equal constant, 10 times apart";

const GUIDE: RGBColor = RGBColor(150, 150, 150);
const GRID: RGBColor = RGBColor(232, 232, 232);

/// Free space around the curves, as a factor.
const MARGIN: f64 = 1.6;

/// Distance of two guide lines, as a factor.
const GUIDE_STEP: f64 = 10.0;

/// What the seeds of one budget tell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    seconds: f64,
    error: f64,
    least: f64,
    greatest: f64,
}

/// One integrator with its budgets.
struct Curve<'s> {
    name: &'s str,
    points: Vec<Point>,
}

/// From the smallest to the greatest of what an axis shows.
type Range = std::ops::Range<f64>;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Axis = WithKeyPoints<LogCoord<f64>>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;
type Failed<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

/// A plot of the relative error, without the reference's noise where that is known, against
/// processor time, both logarithmic, as SVG: a curve through the medians of each integrator, with
/// bars from the least to the greatest of the seeds. Dashed lines of slope −1 join what has one
/// efficiency constant.
///
/// - `standings`: those of other scenes are left out.
///
/// `None` where no median error is positive, which a logarithmic axis needs.
///
/// # Errors
/// None are expected: all is written to memory.
pub fn error_plot(scene: &str, standings: &[Standing]) -> io::Result<Option<String>> {
    let of_scene: Vec<&Standing> = standings.iter().filter(|s| s.scene == scene).collect();
    let curves = curves(&of_scene);
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let seconds = range(points().map(|point| point.seconds));
    let errors = range(points().flat_map(|p| [p.least, p.error, p.greatest]));
    let (Some(seconds), Some(errors)) = (seconds, errors) else {
        return Ok(None);
    };
    let mut text = String::new();
    {
        let picture = Picture {
            scene,
            has_noise: of_scene.iter().any(|s| knows_noise(s)),
            curves: &curves,
            seconds,
            errors,
        };
        let size = (SIZE.0 + picture.legend_width(), SIZE.1);
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        let drawn = picture.draw(&area);
        drawn.map_err(|error| io::Error::other(error.to_string()))?;
    }
    Ok(Some(text))
}

fn knows_noise(standing: &Standing) -> bool {
    !standing.spread(Measure::Corrected).median.is_nan()
}

/// The integrators in the order in which they first appear.
fn curves<'s>(standings: &[&'s Standing]) -> Vec<Curve<'s>> {
    let mut curves: Vec<Curve<'s>> = Vec::new();
    for standing in standings {
        let name = standing.integrator.as_str();
        let known = curves.iter().position(|curve| curve.name == name);
        let index = known.unwrap_or_else(|| {
            let points = Vec::new();
            curves.push(Curve { name, points });
            curves.len() - 1
        });
        curves[index].points.extend(point(standing));
    }
    for curve in &mut curves {
        curve.points.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    }
    curves
}

fn point(standing: &Standing) -> Option<Point> {
    let errors = standing.spread(if knows_noise(standing) {
        Measure::Corrected
    } else {
        Measure::RelativeMse
    });
    let seconds = standing.spread(Measure::Cpu).median;
    let can_be_shown = |value: f64| value > 0.0 && value.is_finite();
    (can_be_shown(seconds) && can_be_shown(errors.median)).then_some(Point {
        seconds,
        error: errors.median,
        least: errors.min,
        greatest: errors.max,
    })
}

/// What holds all positive values, and some space around them.
fn range(values: impl Iterator<Item = f64>) -> Option<Range> {
    let positive = values.filter(|value| *value > 0.0 && value.is_finite());
    let (least, greatest) = positive.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    (greatest > 0.0).then(|| least / MARGIN..greatest * MARGIN)
}

/// Ends of the lines error = c / seconds that cross a rectangle, [`GUIDE_STEP`] apart; one goes
/// through its middle.
fn guides(seconds: &Range, errors: &Range) -> Vec<[(f64, f64); 2]> {
    let middle = (seconds.start * seconds.end * errors.start * errors.end).sqrt();
    let (least, greatest) = (seconds.start * errors.start, seconds.end * errors.end);
    let below = ((middle / least).ln() / GUIDE_STEP.ln()) as i32;
    let above = ((greatest / middle).ln() / GUIDE_STEP.ln()) as i32;
    let constants = (-below..=above).map(|n| middle * GUIDE_STEP.powi(n));
    let line = |constant: f64| {
        let left = seconds.start.max(constant / errors.end);
        let right = seconds.end.min(constant / errors.start);
        [(left, constant / left), (right, constant / right)]
    };
    constants.map(line).collect()
}

/// All that is drawn.
struct Picture<'s> {
    scene: &'s str,
    has_noise: bool,
    curves: &'s [Curve<'s>],
    seconds: Range,
    errors: Range,
}

impl Picture<'_> {
    fn draw<'a>(&self, area: &Area<'a>) -> Result<(), Failed<'a>> {
        area.fill(&WHITE)?;
        let (plot, legend) = area.split_horizontally(SIZE.0);
        let (x, y) = (self.seconds.clone(), self.errors.clone());
        let (x_ticks, y_ticks) = (ticks(&x), ticks(&y));
        let title = format!("{}: error against time", self.scene);
        let mut chart = ChartBuilder::on(&plot)
            .caption(title, ("sans-serif", 20))
            .margin(14)
            .x_label_area_size(48)
            .y_label_area_size(74)
            .build_cartesian_2d(
                x.log_scale().with_key_points(x_ticks),
                y.log_scale().with_key_points(y_ticks),
            )?;
        let label = if self.has_noise {
            "relMSE without the reference's noise"
        } else {
            "relMSE"
        };
        chart
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(WHITE)
            .axis_desc_style(("sans-serif", 16))
            .label_style(("sans-serif", 14))
            .x_desc("processor time in s (all threads together)")
            .y_desc(label)
            .x_label_formatter(&|value| tick(*value))
            .y_label_formatter(&|value| tick(*value))
            .draw()?;
        for ends in guides(&self.seconds, &self.errors) {
            chart.draw_series(DashedLineSeries::new(ends, 4, 5, GUIDE.into()))?;
        }
        for (index, curve) in self.curves.iter().enumerate() {
            self.draw_curve(&mut chart, curve, COLOURS[index % COLOURS.len()])?;
        }
        self.draw_legend(&legend)?;
        area.present()
    }

    fn draw_curve<'b>(
        &self,
        chart: &mut Chart<'_, 'b>,
        curve: &Curve<'_>,
        colour: RGBColor,
    ) -> Result<(), Failed<'b>> {
        let points = &curve.points;
        let line = colour.stroke_width(1);
        // A bar that ends below the plot has no end to show.
        let shown = |error: &f64| *error >= self.errors.start;
        chart.draw_series(points.iter().map(|p| {
            let least = p.least.max(self.errors.start);
            PathElement::new([(p.seconds, least), (p.seconds, p.greatest)], line)
        }))?;
        let ends = points.iter().flat_map(|p| {
            let ends = [p.least, p.greatest].into_iter().filter(shown);
            ends.map(|error| (p.seconds, error))
        });
        chart.draw_series(
            ends.map(|place| EmptyElement::at(place) + PathElement::new([(-5, 0), (5, 0)], line)),
        )?;
        let middle = points.iter().map(|p| (p.seconds, p.error));
        let marks = middle.clone();
        chart.draw_series(marks.map(|place| Circle::new(place, 4, colour.filled())))?;
        chart.draw_series(LineSeries::new(middle, colour.stroke_width(2)))?;
        Ok(())
    }

    /// What the legend says, in the order of the colours.
    fn names(&self) -> Vec<String> {
        let curves = self.curves.iter();
        let names = curves.map(|curve| match curve.points.as_slice() {
            [] => format!("{} (no error above the noise)", curve.name),
            _ => curve.name.to_owned(),
        });
        names.collect()
    }

    fn legend_width(&self) -> u32 {
        let names = self.names();
        let letters = names.iter().map(|name| name.chars().count());
        let letters = letters.max().unwrap_or(0).max(GUIDE_NAME.chars().count());
        LEGEND + LETTER * u32::try_from(letters).unwrap_or(u32::MAX / LETTER - LEGEND)
    }

    fn draw_legend<'a>(&self, area: &Area<'a>) -> Result<(), Failed<'a>> {
        let font = ("sans-serif", 15);
        let place = |index: usize| LEGEND_TOP + LEGEND_LINE * index as i32;
        let names = self.names();
        for (index, name) in names.iter().enumerate() {
            let (y, colour) = (place(index), COLOURS[index % COLOURS.len()]);
            area.draw(&PathElement::new([(4, y), (32, y)], colour.stroke_width(3)))?;
            area.draw(&Circle::new((18, y), 4, colour.filled()))?;
            area.draw(&Text::new(name.clone(), (40, y - 7), font))?;
        }
        let y = place(names.len());
        for x in [4, 13, 22] {
            area.draw(&PathElement::new([(x, y), (x + 5, y)], GUIDE))?;
        }
        area.draw(&Text::new(GUIDE_NAME, (40, y - 7), font))
    }
}

/// Where an axis has its numbers: 1, 2 and 5 times powers of ten, or powers of ten alone where these
/// would be many.
fn ticks(range: &Range) -> Vec<f64> {
    let powers = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let factors: &[f64] = if range.end / range.start > 2e3 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let all = powers.flat_map(|power| factors.iter().map(move |f| f * 10_f64.powi(power)));
    all.filter(|tick| range.contains(tick)).collect()
}

/// A number beside an axis.
fn tick(value: f64) -> String {
    if (1e-4..1e5).contains(&value) {
        // Rounds what the axis computed.
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Trial, standings, tests::trial};
    use super::*;

    fn timed(integrator: &str, seed: u64, seconds: f64, constant: f64) -> Trial {
        let mut trial = trial(integrator, &format!("{seconds} s"), seed, 0.0);
        trial.cpu_seconds = seconds;
        trial.errors.relative_mse = 0.001 + constant / seconds;
        trial
    }

    fn race() -> Vec<Trial> {
        let seeds = || (1..=3).map(|seed| (seed, 0.9 + 0.1 * seed as f64));
        let run = |(seed, factor): (u64, f64)| {
            [1.0, 4.0, 16.0].map(|seconds| {
                [
                    timed("path", seed, seconds, 0.2 * factor),
                    timed("erpt:chain_length=50", seed, seconds, 0.1 * factor),
                ]
            })
        };
        seeds().flat_map(run).flatten().collect()
    }

    #[test]
    fn every_integrator_has_a_curve() {
        let found = standings(&race());
        let text = error_plot("box, small", &found).unwrap().unwrap();
        for part in [
            "<svg",
            "path",
            "erpt:chain_length=50",
            "processor time in s",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        for colour in ["#0072B2", "#D55E00"] {
            let curve = text.split("<polyline").skip(1).filter(|line| {
                let line = line.split("/>").next().unwrap_or_default();
                line.contains(colour) && line.contains("stroke-width=\"2\"")
            });
            assert_eq!(curve.count(), 1, "{text}");
        }
        assert!(!text.contains("#009E73"));
        assert_eq!(error_plot("other", &found).unwrap(), None);
    }

    #[test]
    fn what_noise_hides_has_no_point_but_a_name() {
        let mut trials = race();
        trials.push(timed("hidden", 1, 2.0, -0.0005));
        let text = error_plot("box, small", &standings(&trials))
            .unwrap()
            .unwrap();
        assert!(text.contains("hidden (no error above the noise)"), "{text}");
        let hidden = [timed("hidden", 1, 2.0, -0.0005)];
        assert_eq!(error_plot("box, small", &standings(&hidden)).unwrap(), None);
    }

    #[test]
    fn guides_have_slope_minus_one_and_stay_inside() {
        let (seconds, errors) = (0.5..40.0, 1e-4..0.3);
        let lines = guides(&seconds, &errors);
        assert!(lines.len() >= 3, "{lines:?}");
        for [(x0, y0), (x1, y1)] in lines {
            assert!((x0 * y0 / (x1 * y1) - 1.0).abs() < 1e-12);
            assert!(x0 < x1 && x0 >= seconds.start && x1 <= seconds.end);
            assert!(y1 >= errors.start * (1.0 - 1e-12) && y0 <= errors.end * (1.0 + 1e-12));
        }
        assert_eq!(guides(&(1.0..1.1), &(1.0..1.1)).len(), 1);
    }

    #[test]
    fn ticks_are_short() {
        assert_eq!(tick(0.1 + 0.2), "0.3");
        assert_eq!(tick(20.0), "20");
        assert_eq!(tick(5e-4), "0.0005");
        assert_eq!(tick(3e-5), "3e-5");
        assert_eq!(ticks(&(0.3..12.0)), [0.5, 1.0, 2.0, 5.0, 10.0]);
        assert_eq!(ticks(&(0.05..120.0)), [0.1, 1.0, 10.0, 100.0]);
    }
}
