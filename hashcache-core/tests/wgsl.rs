//! Every WGSL module parses and validates, alone and together with the others.

use hashcache_core::wgsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn validate(name: &str, source: &str) -> naga::Module {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
    if let Err(error) = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module) {
        panic!("{name}: {}", error.emit_to_string(source));
    }
    module
}

#[test]
fn every_module_stands_alone() {
    let names = ["hash", "jitter", "pack", "level", "exact", "counters", "record"];
    for (name, source) in names.iter().zip(wgsl::ALL) {
        validate(name, source);
    }
}

#[test]
fn the_octree_needs_hashes_and_its_global() {
    let module = validate("octree", &[wgsl::HASH, wgsl::OCTREE_BINDINGS, wgsl::OCTREE].concat());
    assert!(module.functions.iter().any(|(_, function)| function.name.as_deref() == Some("hc_cell")));
}

#[test]
fn modules_concatenate_and_keep_their_prefix() {
    let module = validate("all modules", &wgsl::ALL.concat());
    assert!(module.functions.len() > 20);
    for (_, function) in module.functions.iter() {
        assert!(function.name.as_ref().is_some_and(|name| name.starts_with("hc_")), "{:?}", function.name);
    }
    for (_, constant) in module.constants.iter() {
        assert!(constant.name.as_ref().is_none_or(|name| name.starts_with("HC_")), "{:?}", constant.name);
    }
}
