//! Vectors, colours, densities and statistics: what every other layer speaks in.
//!
//! Vectors are `glam`'s scalar `Vec2`/`Vec3` (f32), and [`lanes`] where four are dealt with at once: geometry
//! is single precision, products along a path and sums are `f64`.

mod angle;
mod chart;
mod cie;
pub mod distribution;
pub mod error_function;
mod frame;
pub mod lanes;
mod measure;
mod rgb;
mod spectrum;
mod srgb;
pub mod statistics;
mod transform;
pub mod warp;

pub use angle::angle_of;
pub use chart::TriangleChart;
pub use frame::{Frame, Local, rotation_part};
pub use measure::{AreaDensity, SolidAngleDensity};
pub use rgb::Rgb;
pub use spectrum::{SpectralCurve, SpectralCurveError, blackbody, equal_energy_white};
pub use srgb::srgb_to_linear;
pub use transform::{Transform, TransformError};

pub use glam::{Mat3, Mat4, Vec2, Vec3};
