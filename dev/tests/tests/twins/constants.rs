//! Constants of both languages.

use std::collections::BTreeMap;

use hashcache_core::counters::Counters;
use hashcache_core::record::VertexRecord;
use hashcache_core::{exact, hash, level, octree, pack};
use hashgrid::{jitter, lobe, params, points, table, tag};

use crate::{CRATES, wgsl_side};

/// What every WGSL constant must be.
fn twins() -> BTreeMap<&'static str, f64> {
    let unsigned = [
        ("HC_LCG_MULTIPLIER", hash::LCG_MULTIPLIER),
        ("HC_LCG_INCREMENT", hash::LCG_INCREMENT),
        ("HC_HALF_MAX", pack::HALF_MAX),
        ("HC_OCTAHEDRAL_NONE", pack::OCTAHEDRAL_NONE),
        ("HC_MAX_LEVEL", level::MAX_LEVEL),
        ("HC_FRACTION_BITS", exact::FRACTION_BITS),
        ("HC_CLAMP_BITS", exact::CLAMP_BITS),
        ("HC_CEILING_BITS", exact::CEILING_BITS),
        ("HC_UNDERFLOW_BITS", exact::UNDERFLOW_BITS),
        ("HC_MAX_DEPOSITS", exact::MAX_DEPOSITS),
        ("HC_OUTCOME_EXACT", exact::Outcome::Exact as u32),
        ("HC_OUTCOME_UNDERFLOW", exact::Outcome::Underflow as u32),
        ("HC_OUTCOME_CLAMPED", exact::Outcome::Clamped as u32),
        ("HC_OUTCOME_SATURATED", exact::Outcome::Saturated as u32),
        ("HC_OUTCOME_NON_FINITE", exact::Outcome::NonFinite as u32),
        ("HC_OUTCOME_NEGATIVE", exact::Outcome::Negative as u32),
        ("HC_VALID", VertexRecord::VALID),
        ("HC_HEADER_WORDS", octree::header::HEADER_WORDS as u32),
        ("HC_LEVEL_WORDS", octree::header::LEVEL_WORDS as u32),
        ("HC_MAP_WORDS", octree::header::MAP_WORDS as u32),
        ("HC_BUCKET_ENTRIES", octree::table::BUCKET_ENTRIES),
        ("HC_BUCKET_WORDS", octree::table::BUCKET_WORDS),
        ("HC_NO_CELL", octree::NO_CELL),
        ("HC_SECONDARY", VertexRecord::SECONDARY),
        ("HC_VISIBLE_ONLY", VertexRecord::VISIBLE_ONLY),
        ("HC_GUIDE", VertexRecord::GUIDE),
        ("HC_LAYER_SHIFT", VertexRecord::LAYER_SHIFT),
        ("HC_MAX_LAYER", VertexRecord::MAX_LAYER),
        ("HG_CELL_BITS", params::CELL_BITS),
        ("HG_SALT_DEPOSIT", jitter::SALT_DEPOSIT),
        ("HG_SALT_LOOKUP", jitter::SALT_LOOKUP),
        ("HG_FINGERPRINT_MAX", tag::FINGERPRINT_MAX),
        ("HG_FINGERPRINT_BITS", tag::FINGERPRINT_BITS),
        ("HG_DISTANCE_BITS", tag::DISTANCE_BITS),
        ("HG_POINT_BIN", points::POINT_BIN),
        ("HG_SALT_DIRECTION", lobe::SALT_DIRECTION),
        ("HG_EMPTY", tag::EMPTY),
        ("HG_NEW", tag::NEW),
        ("HG_CLAIM_PLACED", table::Claim::Placed as u32),
        ("HG_CLAIM_FOUND", table::Claim::Found as u32),
        ("HG_CLAIM_REFUSED", table::Claim::Refused as u32),
        // Rust's `None`.
        ("HG_NO_KEY", u32::MAX),
        ("HG_NO_SLOT", u32::MAX),
    ];
    let counters = [
        ("HC_LOOKUPS", Counters::LOOKUPS),
        ("HC_HITS", Counters::HITS),
        ("HC_FALLBACKS", Counters::FALLBACKS),
        ("HC_PROBES", Counters::PROBES),
        ("HC_DEPOSITS", Counters::DEPOSITS),
        ("HC_REFUSALS", Counters::REFUSALS),
        ("HC_CLAMPED", Counters::CLAMPED),
        ("HC_SATURATED", Counters::SATURATED),
        ("HC_UNDERFLOWED", Counters::UNDERFLOWED),
        ("HC_NON_FINITE", Counters::NON_FINITE),
        ("HC_NEGATIVE", Counters::NEGATIVE),
        ("HC_OVERFLOWED", Counters::OVERFLOWED),
        ("HC_ENERGY_RECORDED", Counters::ENERGY_RECORDED),
        ("HC_ENERGY_STORED", Counters::ENERGY_STORED),
        ("HC_ENERGY_REFUSED", Counters::ENERGY_REFUSED),
        ("HC_ENERGY_CLAMPED", Counters::ENERGY_CLAMPED),
        ("HC_ENERGY_UNDERFLOWED", Counters::ENERGY_UNDERFLOWED),
        ("HC_COARSER", Counters::COARSER),
        ("HC_WORDS", Counters::WORDS),
        // Words of 32 bits there, of 64 bits here.
        ("HG_CELL_WORDS", 2 * table::CELL_WORDS),
        ("HG_TALLY_WORDS", 2 * Counters::WORDS),
    ];
    let signed = [("HC_OCTAHEDRAL_ONE", pack::OCTAHEDRAL_ONE)];
    let mut all: BTreeMap<_, _> = unsigned.into_iter().map(|(name, v)| (name, f64::from(v))).collect();
    all.extend(counters.into_iter().map(|(name, v)| (name, v as f64)));
    all.extend(signed.into_iter().map(|(name, v)| (name, f64::from(v))));
    all
}

#[test]
fn every_constant_has_a_twin_of_the_same_value() {
    let mut twins = twins();
    let mut wrong = Vec::new();
    for one in &CRATES {
        let module = one.module();
        for (_, constant) in module.constants.iter() {
            let Some(name) = constant.name.as_deref().filter(|name| one.owns(name)) else { continue };
            let value = wgsl_side::constant(&module, constant.init);
            let twin = twins.remove(name);
            if value.is_none() || value != twin {
                wrong.push(format!("{name}: {value:?} in WGSL, {twin:?} in Rust"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(twins.is_empty(), "not in any WGSL: {:?}", twins.keys());
}
