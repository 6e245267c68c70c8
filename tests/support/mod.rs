//! What several integration tests share.

pub(crate) mod claims;
pub(crate) mod directions;
pub(crate) mod effort;
pub(crate) mod factors;
pub(crate) mod faulty;
pub(crate) mod flow;
pub(crate) mod grid;
pub(crate) mod hard_scenes;
pub(crate) mod materials;
pub(crate) mod moments;
pub(crate) mod planted;
pub(crate) mod primary;
pub(crate) mod render;
pub(crate) mod same_mean;
pub(crate) mod scenes;
pub(crate) mod seeds;
pub(crate) mod source_code;
pub(crate) mod stages;
pub(crate) mod techniques;
pub(crate) mod two_sided_light;
