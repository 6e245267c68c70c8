//! The rays of a render.

use std::path::Path;

use lumiflow::accel::{Query, RawPackets, RawRays, Recording};

use crate::{passes, scenes};

/// Rays that are enough.
const ENOUGH: usize = 600_000;

/// What a render asked of the tracer, and what it did with the answers.
pub(crate) struct Recorded {
    /// `path` or `erpt`.
    pub(crate) name: &'static str,
    /// Passes that it took.
    pub(crate) passes: u32,
    /// All rays in their order, call by call.
    pub(crate) calls: Recording,
    /// Those of which the closest hit was asked.
    pub(crate) closest: RawRays,
    /// Those of which it was asked whether they are free.
    pub(crate) occlusion: RawRays,
    /// Both in packets of eight, for a render that asks about many rays at once.
    pub(crate) packets: Option<[RawPackets; 2]>,
    /// Paths, or mutations where there are any.
    pub(crate) items: u64,
}

impl Recorded {
    /// Renders passes until there are enough rays.
    pub(crate) fn new(file: &Path, text: &'static str) -> Self {
        let (scene, view) = scenes::load(file);
        let scene = scene.recording();
        let algorithm = passes::algorithm(text);
        let render = passes::Passes::new(algorithm.as_ref(), &scene, &view.sensor);
        let take = || scene.accel().take_recording().expect("rays are kept");
        // What was asked to prepare the render is no part of it.
        drop(take());
        let (mut passes, mut rays, mut paths, mut mutations) = (0, 0, 0, 0);
        while rays < ENOUGH {
            let counters = render.run(passes);
            passes += 1;
            rays += counters.rays as usize;
            paths += counters.paths;
            mutations += counters.mutation_count();
        }
        let calls = take();
        assert_eq!(calls.len(), rays, "every ray is kept");
        let rays = |query| {
            let all = calls.rays(query);
            let kept = RawRays::new(&all);
            assert_eq!(kept.as_slice().len(), all.len(), "no ray is broken");
            kept
        };
        let packets = |query| calls.packets(query);
        let together = calls.calls().any(|(_, rays)| rays.len() > 1);
        Self {
            packets: together.then(|| [Query::Closest, Query::Occlusion].map(packets)),
            name: text.split(' ').next().unwrap_or_default(),
            passes,
            closest: rays(Query::Closest),
            occlusion: rays(Query::Occlusion),
            calls,
            items: if mutations > 0 { mutations } else { paths },
        }
    }

    /// Rays of a kind for each path or mutation.
    pub(crate) fn per_item(&self, rays: &RawRays) -> f64 {
        rays.as_slice().len() as f64 / self.items as f64
    }
}
