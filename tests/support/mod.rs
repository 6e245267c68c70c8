//! What several integration tests share.

pub(crate) mod directions;
pub(crate) mod effort;
pub(crate) mod faulty;
pub(crate) mod materials;
