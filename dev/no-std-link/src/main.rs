//! Links without std.

fn main() {}
