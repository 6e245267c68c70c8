//! No memory is allocated while a chain runs.
//!
//! A test binary of its own: its allocator counts.

use std::hint::black_box;
use std::path::Path as FilePath;
use std::sync::atomic::AtomicBool;

use allocation_counter::measure;
use lumiflow::film::{Accumulator, Canvas, Filter, Layer, PassBuffer, Unit, Window};
use lumiflow::image::{ExrOptions, Precision};
use lumiflow::integrator::{self, Counters, Driver, PixelSettings, Progress, Rendered};
use lumiflow::math::Vec2;
use lumiflow::mutation::{
    AngleKernel, CausticKernel, Chain, Choice, Fault, Mutate, Mutation, Perturbation, RasterDomain,
    RasterKernel,
};
use lumiflow::output::{LayerChoice, Picture, SaveOptions, save};
use lumiflow::path::{Heuristic, Path, PathRules, PathSpace, PathTracing, camera_sample};
use lumiflow::random::{PixelAddress, Purpose, Sampler, SamplerKind, Stream};
use lumiflow::scene::Scene;
use lumiflow::scene::import::{ImportOptions, View, import};
use lumiflow::scene::options::{OptionReader, OptionValue, Options};

const SIDE: u32 = 16;
const STEPS: u32 = 10_000;

/// A scene of the project, on a small film.
fn load(name: &str) -> (Scene, View) {
    let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{name}/scene.xml"));
    let options = ImportOptions {
        film_size: Some((SIDE, SIDE)),
        ..ImportOptions::default()
    };
    let mut imported = import(&file, &options).expect("the scene is right");
    (imported.scene, imported.views.swap_remove(0))
}

fn perturbation() -> Perturbation {
    Perturbation {
        raster: RasterKernel::Square { side: 9.0 },
        angle: AngleKernel::default(),
        caustic: CausticKernel::Logarithmic(AngleKernel::default()),
        lens: 0.25,
        domain: RasterDomain {
            low: Vec2::ZERO,
            high: Vec2::splat(SIDE as f32),
        },
        fault: Fault::None,
    }
}

/// A path that a mutation applies to.
fn seed_for(space: &PathSpace<'_>, mutation: Mutation) -> Option<Path> {
    let tracing = PathTracing {
        max_depth: 10,
        rr_depth: 10,
        heuristic: Heuristic::default(),
    };
    let mut path = Path::default();
    for pixel in 0..16 * SIDE * SIDE {
        let address = PixelAddress {
            seed: 1,
            purpose: Purpose::Check,
            pixel,
            sample: 0,
        };
        let mut sampler = Sampler::new(SamplerKind::Independent, address);
        let raster = sampler.next_2d() * SIDE as f32;
        let ray = camera_sample(space, raster, &mut sampler);
        let mut seed = None;
        tracing.trace(
            space,
            &mut path,
            (raster, &ray),
            &mut sampler,
            &mut |found| {
                let fits = found
                    .path
                    .filter(|path| mutation.site(path).is_some() && path.edges() > 2);
                seed = fits.cloned().or(seed.take());
            },
        );
        if seed.is_some() {
            return seed;
        }
    }
    None
}

/// Runs a chain of one kind of mutation; returns how many were accepted.
fn run_chain(space: &PathSpace<'_>, chain: &mut Chain, seed: &Path, mutation: Mutation) -> u64 {
    let mut weights = [0.0; Mutation::COUNT];
    weights[mutation as usize] = 1.0;
    let choice = Choice {
        weights,
        by_rule: false,
    };
    let perturbation = perturbation();
    let mut random = Stream::new(2, Purpose::Check, mutation as u32, 0);
    chain.start(seed);
    for _ in 0..STEPS {
        if let Some(proposed) = chain.propose(space, &perturbation, &choice, &mut random) {
            let is_accepted = f64::from(random.next_f32()) < proposed.acceptance;
            chain.settle(proposed, is_accepted);
        }
    }
    chain.statistics[mutation as usize].accepted
}

#[test]
fn chains_of_every_mutation_allocate_nothing() {
    let mut run = [0; Mutation::COUNT];
    for name in ["cornell-box", "cornell-caustic", "glass-in-glass"] {
        let (scene, view) = load(name);
        let space = PathSpace::new(&scene, &view.sensor, PathRules::default());
        for mutation in Mutation::ALL {
            let Some(seed) = seed_for(&space, *mutation) else {
                continue;
            };
            let mut chain = Chain::default();
            let mut accepted = 0;
            let info = measure(|| accepted = run_chain(&space, &mut chain, &seed, *mutation));
            assert_eq!(info.count_total, 0, "{name}, {mutation:?}");
            run[*mutation as usize] += accepted;
        }
    }
    // Each of them went somewhere.
    assert!(run.iter().all(|accepted| *accepted > 100), "{run:?}");
}

/// Number of allocations in a unit of work, and of mutations.
fn allocations((scene, view): &(Scene, View), text: &str) -> (u64, u64) {
    let (name, text) = text.split_once(' ').unwrap_or((text, ""));
    let words = text.split(' ').filter_map(|word| word.split_once('='));
    let options: Options = words
        .map(|(key, value)| (key.to_owned(), OptionValue::parse(value)))
        .collect();
    let algorithm = integrator::from_options(name, &mut OptionReader::new(&options));
    let algorithm = algorithm.expect("the options are right");
    let settings = PixelSettings {
        seed: 3,
        film_size: (SIDE, SIDE),
        window: Window::full(SIDE, SIDE),
        filter: view.filter,
        sampler: SamplerKind::Independent,
        alpha: true,
        second_moment: false,
        aovs: Vec::new(),
        own_layers: vec!["proposals".to_owned(), "acceptance".to_owned()],
    };
    let render = algorithm.start(scene, &view.sensor, settings);
    let layers: Vec<PassBuffer> = render
        .layers()
        .iter()
        .zip(render.units())
        .map(|(layer, unit)| PassBuffer::new(render.window(), layer.channels.len(), unit))
        .collect();
    let mut mutations = 0;
    let (never, progress) = (AtomicBool::new(false), Progress::default());
    let driver = Driver::new(&never, &progress);
    // The measure is of one thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread can be started");
    let info = pool.install(|| {
        measure(|| {
            let counters = render.run_pass(0, &layers, &driver);
            mutations = counters.map_or(0, |counters| counters.mutation_count());
        })
    });
    (info.count_total, mutations)
}

#[test]
fn more_mutations_need_no_more_allocations() {
    let scene = load("cornell-caustic");
    for (few, many) in [
        (
            "erpt mutations_per_sample=1",
            "erpt mutations_per_sample=200",
        ),
        (
            "erpt mutations_per_sample=1 expected_values=false",
            "erpt mutations_per_sample=200",
        ),
        (
            "erpt flow=detailed chain_length=1",
            "erpt flow=detailed chain_length=50",
        ),
        (
            "erpt flow=iterated flow_depth=1 mutations_per_sample=1",
            "erpt flow=iterated flow_depth=8 mutations_per_sample=20",
        ),
        (
            "mlt chains=4 mutations_per_pixel=1 luminance_samples=500",
            "mlt chains=4 mutations_per_pixel=30 luminance_samples=500",
        ),
        (
            "pssmlt chains=4 mutations_per_pixel=1 luminance_samples=500",
            "pssmlt chains=4 mutations_per_pixel=30 luminance_samples=500",
        ),
        (
            "mmlt chains=4 mutations_per_pixel=1 luminance_samples=500",
            "mmlt chains=4 mutations_per_pixel=30 luminance_samples=500",
        ),
    ] {
        let (few_allocations, few_mutations) = allocations(&scene, few);
        let (many_allocations, many_mutations) = allocations(&scene, many);
        assert!(
            many_mutations > 5 * few_mutations,
            "{many}: {many_mutations}, {few_mutations}"
        );
        assert_eq!(many_allocations, few_allocations, "{many}");
    }
}

#[test]
fn allocations_are_counted() {
    let info = measure(|| {
        black_box(vec![1_u8; 16]);
    });
    assert_eq!(info.count_total, 1);
}

/// A film of two passes, with the spread of its replicas.
fn film(window: Window) -> Rendered {
    let (layer, unit) = (Layer::new("", "RGBA"), Unit::for_magnitude(1.0));
    let mut pass = PassBuffer::new(window, 4, unit);
    let mut sums = Accumulator::new(4 * window.pixel_count(), unit, Some(1));
    for value in [0.25, 0.75] {
        pass.add(&Filter::pixel_box(), Vec2::splat(0.5), [value; 4]);
        sums.fold(&mut pass);
    }
    Rendered {
        means: vec![sums.mean()],
        layers: vec![(layer, sums)],
        window,
        passes: 2,
        counters: Counters::default(),
    }
}

#[test]
fn writing_a_picture_holds_a_few_rows_of_it() {
    let (width, height) = (64, 2048);
    let rendered = film(Window::full(width, height));
    let choice = LayerChoice {
        precision: Precision::Float,
        variance: true,
    };
    let options = SaveOptions {
        exr: ExrOptions::default(),
        exposure: 0.0,
    };
    let folder = tempfile::tempdir().expect("a folder");
    let written = measure(|| {
        let picture = Picture::new(&rendered, (width, height), choice);
        let saved = save(&folder.path().join("a.exr"), &picture, &options);
        assert_eq!(saved.expect("the file can be written"), 0);
    });
    // A chunk has sixteen rows of seven channels; names and the like are small.
    let chunk = 7 * 16 * u64::from(width) * 4;
    assert!(
        written.bytes_max < 2 * chunk,
        "{written:?}, a chunk has {chunk}"
    );
    // A copy of a single channel would be found.
    assert!(2 * chunk < 4 * u64::from(width) * u64::from(height));
}
