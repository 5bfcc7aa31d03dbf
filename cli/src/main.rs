//! The `hashcache` command.

fn main() {}
