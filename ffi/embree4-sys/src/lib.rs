//! Placeholder until the binding lands in the next commit.
