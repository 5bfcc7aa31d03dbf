// Indices of a cache's counters: word pairs, low word at twice the index. Twins: hashcache_core::counters::Counters.

const HC_LOOKUPS: u32 = 0u;
const HC_HITS: u32 = 1u;
const HC_FALLBACKS: u32 = 2u;
const HC_PROBES: u32 = 3u;
const HC_DEPOSITS: u32 = 4u;
const HC_REFUSALS: u32 = 5u;
const HC_CLAMPED: u32 = 6u;
const HC_SATURATED: u32 = 7u;
const HC_UNDERFLOWED: u32 = 8u;
const HC_NON_FINITE: u32 = 9u;
const HC_NEGATIVE: u32 = 10u;
const HC_OVERFLOWED: u32 = 11u;
const HC_ENERGY_RECORDED: u32 = 12u;
const HC_ENERGY_STORED: u32 = 13u;
const HC_ENERGY_REFUSED: u32 = 14u;
const HC_ENERGY_CLAMPED: u32 = 15u;
const HC_ENERGY_UNDERFLOWED: u32 = 16u;
const HC_COARSER: u32 = 17u;
const HC_WORDS: u32 = 18u;
