//! A renderer for hard light: caustics, glass in glass, light through a door ajar.

pub mod accel;
pub mod bsdf;
pub mod cli;
pub mod emitter;
pub mod energy;
pub mod film;
pub mod image;
pub mod integrator;
pub mod math;
pub mod mutation;
pub mod output;
pub mod path;
pub mod random;
pub mod report;
pub mod scene;
pub mod sensor;
pub mod shape;
pub mod texture;
