//! Scenes: what is read from files and what a render runs over.

pub mod import;
