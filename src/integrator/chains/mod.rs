//! What all algorithms share that run Markov chains of paths: where seeds come from, how paths are
//! mutated, where energy lands.

mod both_sides;
mod energy;
mod film;
mod landing;
mod layers;
mod mutations;
mod noise_filter;
mod options;
mod walker;

pub(super) use film::ChainFilm;
pub(super) use landing::Landing;
pub(super) use layers::{OWN_LAYERS, Places};
pub(super) use mutations::{MutationOptions, angle_kernel, angle_of_pixel, lens_aperture};
pub(super) use options::{SeedOptions, from_both_sides};
pub(super) use walker::{Kernel, PathWalker, Pause};
