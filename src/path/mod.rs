//! Path space: what paths are made of, what they are worth, and how techniques that make them are
//! weighed.
//!
//! The state of a Markov chain is the positions of a path's vertices *and* the event at each. A
//! vertex's value is written as seen from the eye's side, in solid angle; the product of the values is
//! then the measurement contribution in the coordinates in which the path tracer generates paths.
//! Other coordinates bring scalar factors, which are written where they are used.

mod bidirectional;
mod density;
mod dirac;
mod inverse;
mod light_path;
mod mis;
mod section;
mod space;
mod tracer;
mod verify;
mod vertex;

pub use bidirectional::{
    Backlog, Bidirection, Bidirectional, Connection, Departure, Escape, EyeSubpath, LightImage,
    LightSubpath, SubVertex, Techniques, Weighing,
};
pub use density::{Coordinates, Generation, Technique};
pub use dirac::Followed;
pub use light_path::{CAPACITY, Path, Signature};
pub use mis::Heuristic;
pub use space::{PathRules, PathSpace};
pub use tracer::{Found, PathTracing, camera_sample};
pub use verify::{Broken, Claim, Tolerance};
pub use vertex::{Event, PathVertex, VertexKind};

pub(crate) use light_path::{colour, luminance};
