//! What two tracers say of the same rays, compared.
//!
//! Rays of nine kinds are aimed at the scene's own geometry. Where the tracers disagree, a third, slow
//! reckoning in double precision, the referee, says which answers can be right for a ray that is off by
//! no more than the rounding of floats, and from that what kind of disagreement it is. What that
//! tolerance is and why: `docs/crosscheck.md`.

mod address;
mod compare;
mod exact;
mod judge;
mod rays;
mod referee;
mod round;
mod subject;
mod tally;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

pub use address::{Kind, RayAddress, parse_ray, ray_text};
pub use compare::{Answers, Class, Finding, Query, Right};
pub use rays::Camera;
pub use subject::Subject;
pub use tally::{KindTally, Tally};

use crate::accel::{Accel, Ray};
use compare::Comparison;
use rays::Aim;
use referee::Referee;

/// Rays that are traced together.
const BATCH: u32 = 2048;

/// Real disagreements that are kept with their rays.
const KEPT: usize = 20;

/// A check of two tracers on one geometry.
pub struct Crosscheck<'a> {
    referee: Referee<'a>,
    embree: &'a Accel,
    obvhs: &'a Accel,
    aim: Aim<'a>,
    seed: u64,
}

/// What a check found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Counts by kind.
    pub tally: Tally,
    /// The first real disagreements, in the order of the rays.
    pub real: Vec<Finding>,
    /// Whether it was cancelled before all rays were traced.
    pub interrupted: bool,
}

impl<'a> Crosscheck<'a> {
    /// Prepares a check.
    ///
    /// - `subject`: what the referee looks at, and what rays are aimed at.
    /// - `embree`, `obvhs`: the tracers that were built of it.
    /// - `camera`: where primary rays come from; without one, from around the geometry.
    /// - `seed`: start of the random numbers.
    pub fn new(
        subject: &'a Subject,
        [embree, obvhs]: [&'a Accel; 2],
        camera: Option<Camera<'a>>,
        seed: u64,
    ) -> Self {
        let referee = Referee::new(subject);
        Self {
            aim: Aim::new(subject, camera, referee.bounds()),
            referee,
            embree,
            obvhs,
            seed,
        }
    }

    /// Compares the tracers on rays of all kinds, with the threads of the pool that this runs in.
    ///
    /// - `rays`: how many, all kinds together.
    /// - `done`: counts rays that are compared.
    /// - `cancelled`: ends the check before the next batch.
    ///
    /// What is found depends on geometry, seed and number of rays alone.
    pub fn run(&self, rays: u32, done: &AtomicU64, cancelled: &AtomicBool) -> Outcome {
        let batches: Vec<Outcome> = (0..rays.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| {
                if cancelled.load(Relaxed) {
                    return Outcome {
                        interrupted: true,
                        ..Outcome::default()
                    };
                }
                let first = batch * BATCH;
                let outcome = self.batch(first..rays.min(first.saturating_add(BATCH)));
                done.fetch_add(u64::from(rays.min(first + BATCH) - first), Relaxed);
                outcome
            })
            .collect();
        let mut all = Outcome::default();
        for batch in batches {
            all.tally.add(&batch.tally);
            all.real.extend(batch.real);
            all.real.truncate(KEPT);
            all.interrupted |= batch.interrupted;
        }
        all
    }

    /// One ray of a check; `None` for an address that no ray has, as where there is nothing to aim at.
    pub fn ray(&self, address: RayAddress) -> Option<Ray> {
        self.aim.ray(address, self.seed)
    }

    /// All about one ray: what the tracers and the referee say, and what is made of it.
    pub fn replay(&self, ray: &Ray) -> (Answers, Vec<(Query, Class, Right)>) {
        // As packets, like the rays of a check: at the ends of an interval, single rays may differ.
        let engines = [self.embree, self.obvhs];
        let answers = Answers {
            closest: engines.map(|accel| {
                let mut hits = Vec::new();
                accel.intersect_all(std::slice::from_ref(ray), &mut hits);
                hits[0]
            }),
            occluded: engines.map(|accel| {
                let mut occluded = Vec::new();
                accel.are_occluded([ray], &mut occluded);
                occluded[0]
            }),
            referee: self.referee.closest(ray),
        };
        let found = self.comparison().compare(ray, &answers);
        (answers, found)
    }

    fn comparison(&self) -> Comparison<'_> {
        Comparison {
            referee: &self.referee,
        }
    }

    fn batch(&self, numbers: std::ops::Range<u32>) -> Outcome {
        let addresses: Vec<RayAddress> = numbers.map(RayAddress::of).collect();
        let aimed = addresses.into_iter().filter_map(|address| {
            let ray = self.ray(address)?;
            Some((address, ray))
        });
        let (addresses, rays): (Vec<_>, Vec<_>) = aimed.unzip();
        let mut hits = [Vec::new(), Vec::new()];
        let mut occluded = [Vec::new(), Vec::new()];
        for (side, accel) in [self.embree, self.obvhs].into_iter().enumerate() {
            accel.intersect_all(&rays, &mut hits[side]);
            accel.are_occluded(&rays, &mut occluded[side]);
        }
        let mut outcome = Outcome::default();
        for (i, (address, ray)) in addresses.iter().zip(&rays).enumerate() {
            let answers = Answers {
                closest: [hits[0][i], hits[1][i]],
                occluded: [occluded[0][i], occluded[1][i]],
                referee: None,
            };
            let kind = &mut outcome.tally.kinds[address.kind as usize];
            kind.rays += 1;
            kind.hits += u64::from(answers.closest[0].is_some());
            let found = self.comparison().compare(ray, &answers);
            for (query, class, right) in found {
                kind.count(query, class, right);
                if class == Class::Real {
                    outcome.real.push(Finding {
                        address: *address,
                        ray: *ray,
                        query,
                        right,
                    });
                }
            }
        }
        outcome.real.truncate(KEPT);
        outcome
    }
}
