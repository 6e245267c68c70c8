//! Passes of integrators, on the calling thread.

use std::sync::atomic::AtomicBool;

use lumiflow::accel;
use lumiflow::film::{Filter, PassBuffer, Window};
use lumiflow::integrator::{
    self, Algorithm, Counters, Driver, Integrator, PixelSettings, Progress,
};
use lumiflow::random::SamplerKind;
use lumiflow::scene::Scene;
use lumiflow::scene::options::{OptionReader, OptionValue, Options};
use lumiflow::sensor::Sensor;

use crate::scenes::SIDE;

/// An integrator by name with options: `erpt mutations_per_sample=100`.
pub(crate) fn algorithm(text: &str) -> Box<dyn Algorithm> {
    let mut words = text.split(' ');
    let name = words.next().unwrap_or_default();
    let options: Options = words
        .filter_map(|word| word.split_once('='))
        .map(|(key, value)| (key.to_owned(), OptionValue::parse(value)))
        .collect();
    let made = integrator::from_options(name, &mut OptionReader::new(&options));
    made.unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

/// A render that is prepared.
pub(crate) struct Passes<'s> {
    work: Box<dyn Integrator + 's>,
    buffers: Vec<PassBuffer>,
}

impl<'s> Passes<'s> {
    pub(crate) fn new(algorithm: &'s dyn Algorithm, scene: &'s Scene, sensor: &'s Sensor) -> Self {
        let settings = PixelSettings {
            seed: 1,
            film_size: (SIDE, SIDE),
            window: Window::full(SIDE, SIDE),
            filter: Filter::pixel_box(),
            sampler: SamplerKind::Independent,
            alpha: false,
            second_moment: false,
            aovs: Vec::new(),
            own_layers: Vec::new(),
        };
        let work = algorithm.start(scene, sensor, settings);
        let layers = work.layers();
        let buffers = layers.iter().zip(work.units());
        let buffers = buffers
            .map(|(layer, unit)| PassBuffer::new(work.window(), layer.channels.len(), unit))
            .collect();
        Self { work, buffers }
    }

    /// Does the work of one pass. In a pool of more than one thread, all of them do it.
    #[inline(never)]
    pub(crate) fn run(&self, pass: u32) -> Counters {
        let (never, progress) = (AtomicBool::new(false), Progress::default());
        let driver = Driver::new(&never, &progress);
        let counters = self.work.run_pass(pass, &self.buffers, &driver);
        counters.expect("nobody cancels")
    }
}

/// Calls a function in a pool of one thread, set up as those that render.
pub(crate) fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .start_handler(|_| accel::prepare_worker())
        .build();
    pool.expect("a thread can be started").install(work)
}
