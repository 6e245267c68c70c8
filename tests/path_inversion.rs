//! From paths back to the numbers of the samples that make them: the same paths come out again, by every
//! technique, and numbers found are spread like those given.

use lumiflow::math::Vec2;
use lumiflow::math::statistics::{sidak, two_samples_p};
use lumiflow::mutation::PrimarySpace;
use lumiflow::path::{
    Bidirection, Bidirectional, Connection, Path, PathSpace, PathTracing, VertexKind, Weighing,
    camera_sample,
};
use lumiflow::random::{Numbers, PrimarySample, Purpose, Stream};

use crate::support::effort::{level, samples, seed};
use crate::support::primary::Sample;
use crate::support::seeds::{TRACING, from_both_sides, space};
use crate::support::stages::{SIDE, Stage, stage_of, stages};

/// How numbers are spoilt on their way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    None,
    /// The two of a pair change places.
    Exchanged,
    /// All belong to the vertex before.
    OneVertexEarly,
    /// What is put alone, as choices and the roulette's numbers are, is halved.
    Halved,
}

/// Numbers of one side, put with a mistake.
struct Spoilt<'a> {
    to: &'a mut PrimarySpace,
    mistake: Mistake,
}

impl PrimarySample for Spoilt<'_> {
    fn put_1d(&mut self, number: f32) {
        let factor = if self.mistake == Mistake::Halved {
            0.5
        } else {
            1.0
        };
        self.to.put_1d(number * factor);
    }

    fn put_2d(&mut self, numbers: Vec2) {
        self.to.put_2d(match self.mistake {
            Mistake::Exchanged => Vec2::new(numbers.y, numbers.x),
            _ => numbers,
        });
    }

    fn skip_2d(&mut self) {
        PrimarySample::skip_2d(self.to);
    }

    fn begin_vertex(&mut self, index: u32) {
        let early = u32::from(self.mistake == Mistake::OneVertexEarly && index > 1);
        PrimarySample::begin_vertex(self.to, index - early);
    }
}

/// The first numbers of either side of a sample, and of its first vertices.
fn first(sample: &mut Sample) -> Vec<f32> {
    let mut found = Vec::new();
    for side in sample.rewind() {
        found.extend((0..7).map(|_| side.next_1d()));
        for vertex in 1..=3 {
            Numbers::begin_vertex(side, vertex);
            found.extend((0..6).map(|_| side.next_1d()));
        }
    }
    found
}

/// The path that one technique makes of a sample.
fn path_by<'s>(
    sample: &mut Sample,
    (space, both): (&PathSpace<'s>, &mut Bidirection<'s>),
    tracing: &Bidirectional,
    technique: (usize, usize),
) -> Option<Path> {
    let made = sample.trace_technique((space, both), tracing, technique)?;
    let mut path = Path::default();
    both.assemble(space, &made, &mut path).then_some(path)
}

/// Makes of a sample the one that makes a path by a technique; `None` where there is none.
fn invert(
    sample: &mut Sample,
    space: &PathSpace<'_>,
    tracing: &Bidirectional,
    (path, technique): (&Path, (usize, usize)),
    (number, mistake): (u32, Mistake),
) -> Option<()> {
    sample.begin(seed(45), number);
    let mut spare = Stream::new(seed(46), Purpose::Check, 0, number);
    let [eye, light] = sample.rewind();
    if technique.0 > 0 {
        eye.put_2d(path.raster() / SIDE as f32);
    } else {
        PrimarySample::skip_2d(eye);
    }
    let [mut eye, mut light] = [eye, light].map(|to| Spoilt { to, mistake });
    tracing.invert(space, path, technique, &mut spare, [&mut eye, &mut light])
}

/// Whether two paths are the same up to rounding.
fn is_same(path: &Path, other: &Path) -> bool {
    const FAR: f32 = 5e-3;
    let (a, b) = (path.vertices(), other.vertices());
    let pairs = a.iter().zip(b);
    let is_near = |(a, b): (&lumiflow::path::PathVertex, &lumiflow::path::PathVertex)| {
        let is_lens = a.kind == VertexKind::Sensor;
        a.event == b.event
            && a.kind == b.kind
            && (is_lens || a.emitter() == b.emitter())
            && a.position().distance(b.position()) < FAR
    };
    a.len() == b.len()
        && pairs.into_iter().all(is_near)
        && path.raster().distance(other.raster()) < 0.1
}

/// What became of paths that were made again.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    /// By the technique that had made them, and how many were others then, or nothing.
    own: [u32; 2],
    /// By other techniques.
    others: [u32; 2],
}

impl Tally {
    fn lost(self) -> [f64; 2] {
        [self.own, self.others].map(|[count, lost]| f64::from(lost) / f64::from(count.max(1)))
    }
}

fn made_again(stage: &Stage, mistake: Mistake, count: u32) -> Tally {
    let (space, tracing) = (space(stage), from_both_sides(Weighing::Square));
    let (mut given, mut found) = (Sample::new(), Sample::new());
    let (mut both, mut again) = (Bidirection::default(), Bidirection::default());
    let (mut path, mut tally) = (Path::default(), Tally::default());
    for number in 0..count {
        given.begin(seed(44), number);
        let take = &mut |both: &Bidirection<'_>, made: &Connection| {
            assert!(both.assemble(&space, made, &mut path));
            for light in 0..=made.edges() {
                let technique = (made.edges() - light, light);
                let is_own = light == made.light;
                let inverse = invert(
                    &mut found,
                    &space,
                    &tracing,
                    (&path, technique),
                    (number, mistake),
                );
                // Others may be unable to make it.
                if inverse.is_none() && !is_own {
                    continue;
                }
                let workers = (&space, &mut again);
                let other =
                    inverse.and_then(|()| path_by(&mut found, workers, &tracing, technique));
                let is_lost = other.is_none_or(|other| !is_same(&path, &other));
                let tally = if is_own {
                    &mut tally.own
                } else {
                    &mut tally.others
                };
                tally[0] += 1;
                tally[1] += u32::from(is_lost);
            }
        };
        given.trace((&space, &mut both), &tracing, take);
    }
    tally
}

#[test]
fn paths_come_back_by_every_technique() {
    for stage in stages() {
        let tally = made_again(&stage, Mistake::None, samples(600));
        let is_enough = tally.own[0] > 100 && tally.others[0] > 50;
        assert!(is_enough, "{}: {tally:?}", stage.name);
        let lost = tally.lost();
        assert!(
            lost[0] < 0.01 && lost[1] < 0.01,
            "{}: {lost:?}, {tally:?}",
            stage.name
        );
    }
}

/// The same with Russian roulette, whose numbers are found, too: the value is that of the sample.
#[test]
fn samples_come_back_with_their_roulette() {
    let tracing = from_both_sides(Weighing::Square);
    for stage in stages() {
        let space = space(&stage);
        let (mut given, mut found) = (Sample::new(), Sample::new());
        let (mut both, mut again) = (Bidirection::default(), Bidirection::default());
        let (mut path, mut count, mut lost) = (Path::default(), 0, 0);
        for number in 0..samples(200) {
            given.begin(seed(47), number);
            let take = &mut |both: &Bidirection<'_>, made: &Connection| {
                assert!(both.assemble(&space, made, &mut path));
                let technique = (made.eye, made.light);
                let place = (number, Mistake::None);
                let inverse = invert(&mut found, &space, &tracing, (&path, technique), place);
                let mut is_found = false;
                if inverse.is_some() {
                    let take = &mut |_: &Bidirection<'_>, other: &Connection| {
                        let ratio = other.energy().luminance() / made.energy().luminance();
                        let is_same = (other.eye, other.light) == technique;
                        is_found |= is_same && (ratio - 1.0).abs() < 0.05;
                    };
                    found.trace((&space, &mut again), &tracing, take);
                }
                count += 1;
                lost += u32::from(!is_found);
            };
            given.trace((&space, &mut both), &tracing, take);
        }
        let share = f64::from(lost) / f64::from(count);
        assert!(
            count > 50 && share < 0.02,
            "{}: {lost} of {count}",
            stage.name
        );
    }
}

/// Share of a path tracer's paths that do not come back.
fn lost_of_path_tracing(stage: &Stage, tracing: &PathTracing) -> f64 {
    let space = space(stage);
    let (mut given, mut found) = (Sample::new(), Sample::new());
    let (mut path, mut again, mut first) = (Path::default(), Path::default(), Path::default());
    let (mut count, mut lost) = (0, 0);
    for number in 0..samples(400) {
        given.begin(seed(48), number);
        let [eye, _] = given.rewind();
        let raster = eye.next_2d() * SIDE as f32;
        let ray = camera_sample(&space, raster, eye);
        tracing.trace(&space, &mut path, (raster, &ray), eye, &mut |made| {
            let Some(path) = made.path else { return };
            first.copy_from(path);
            found.begin(seed(49), number);
            let mut spare = Stream::new(seed(50), Purpose::Check, 0, number);
            let [eye, _] = found.rewind();
            eye.put_2d(raster / SIDE as f32);
            let mut is_found = false;
            if tracing
                .invert(&space, &first, made.is_explicit, &mut spare, eye)
                .is_some()
            {
                let [eye, _] = found.rewind();
                let place = eye.next_2d() * SIDE as f32;
                let ray = camera_sample(&space, place, eye);
                tracing.trace(&space, &mut again, (place, &ray), eye, &mut |other| {
                    let ratio = other.luminance() / made.luminance();
                    is_found |= other.edges == made.edges
                        && other.is_explicit == made.is_explicit
                        && (ratio - 1.0).abs() < 0.05
                        && other.path.is_some_and(|path| is_same(&first, path));
                });
            }
            count += 1;
            lost += u32::from(!is_found);
        });
    }
    assert!(count > 50, "{}: {count}", stage.name);
    f64::from(lost) / f64::from(count)
}

#[test]
fn paths_of_the_path_tracer_come_back() {
    for stage in stages() {
        let share = lost_of_path_tracing(&stage, &TRACING);
        assert!(share < 0.02, "{}: {share}", stage.name);
    }
}

/// Smallest chance that one of the first numbers is spread as those of samples that have made such paths.
fn spread_p(stage: &Stage, mistake: Mistake) -> f64 {
    const CELLS: usize = 8;
    let (space, tracing) = (space(stage), from_both_sides(Weighing::Square));
    let (mut given, mut found) = (Sample::new(), Sample::new());
    let mut both = Bidirection::default();
    let mut cells: Vec<[[f64; CELLS]; 2]> = Vec::new();
    for number in 0..samples(40_000) {
        given.begin(seed(51), number);
        // The technique is not chosen by what is found: that would tell of numbers that the path leaves open.
        let edges = 2 + number as usize % 3;
        let light = number as usize / 3 % (edges + 1);
        let technique = (edges - light, light);
        let (mut path, mut is_made) = (Path::default(), false);
        let take = &mut |both: &Bidirection<'_>, made: &Connection| {
            if (made.eye, made.light) == technique {
                is_made = both.assemble(&space, made, &mut path);
            }
        };
        given.trace((&space, &mut both), &tracing, take);
        if !is_made {
            continue;
        }
        let which = (number / 60 % 2) as usize;
        let numbers = if which == 0 {
            first(&mut given)
        } else {
            let place = (number, mistake);
            if invert(&mut found, &space, &tracing, (&path, technique), place).is_none() {
                continue;
            }
            first(&mut found)
        };
        cells.resize(numbers.len(), [[0.0; CELLS]; 2]);
        for (cells, number) in cells.iter_mut().zip(numbers) {
            cells[which][(number * CELLS as f32) as usize] += 1.0;
        }
    }
    let ps = cells.iter().filter_map(|[a, b]| two_samples_p(a, b));
    let (least, count) = ps.fold((1.0_f64, 0), |(least, count), p| (least.min(p), count + 1));
    // As of one test.
    1.0 - (1.0 - least).powi(count)
}

#[test]
fn numbers_found_are_spread_like_those_given() {
    let stages = stages();
    let level = sidak(level(0.01), stages.len());
    for stage in stages {
        let p = spread_p(&stage, Mistake::None);
        assert!(p > level, "{}: {p}", stage.name);
    }
}

#[test]
fn planted_errors_of_numbers_are_found() {
    let stage = stage_of("diffuse box");
    for mistake in [Mistake::Exchanged, Mistake::OneVertexEarly] {
        let [own, others] = made_again(&stage, mistake, 100).lost();
        assert!(own > 0.2 && others > 0.2, "{mistake:?}: {own}, {others}");
    }
    let p = spread_p(&stage, Mistake::Halved);
    assert!(p < 1e-6, "{p}");
}
