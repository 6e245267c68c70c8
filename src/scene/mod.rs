//! Scenes: what is to be rendered, and how it is read from files.

pub mod import;
