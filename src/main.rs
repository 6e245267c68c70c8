//! The `lumiflow` command.

fn main() {}
