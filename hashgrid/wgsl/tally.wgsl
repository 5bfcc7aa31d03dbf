// Counters of a workgroup, which then become one addition to the shared ones. Twins: Counters::note, add_counters.

// Two words for each of hashcache_core's counters.
const HG_TALLY_WORDS: u32 = 36u;

var<workgroup> hg_tally: array<atomic<u32>, HG_TALLY_WORDS>;

fn hg_count64(counter: u32, value: vec2<u32>) {
    if (value.x | value.y) == 0u {
        return;
    }
    let high = hc_carry(atomicAdd(&hg_tally[2u * counter], value.x), value);
    if high != 0u {
        atomicAdd(&hg_tally[2u * counter + 1u], high);
    }
}

fn hg_count(counter: u32, value: u32) {
    hg_count64(counter, vec2<u32>(value, 0u));
}

fn hg_note(deposit: HcQuantized, stored: bool) {
    switch deposit.outcome {
        case HC_OUTCOME_CLAMPED: { hg_count(HC_CLAMPED, 1u); }
        case HC_OUTCOME_SATURATED: { hg_count(HC_SATURATED, 1u); }
        case HC_OUTCOME_UNDERFLOW: { hg_count(HC_UNDERFLOWED, 1u); }
        case HC_OUTCOME_NON_FINITE: { hg_count(HC_NON_FINITE, 1u); }
        case HC_OUTCOME_NEGATIVE: { hg_count(HC_NEGATIVE, 1u); }
        default: {}
    }
    let underflow = deposit.outcome == HC_OUTCOME_UNDERFLOW;
    let cut = select(deposit.lost, vec2<u32>(), underflow);
    hg_count64(HC_ENERGY_RECORDED, hc_add64(deposit.value, cut));
    hg_count64(HC_ENERGY_CLAMPED, cut);
    hg_count64(HC_ENERGY_UNDERFLOWED, select(vec2<u32>(), deposit.lost, underflow));
    hg_count64(select(HC_ENERGY_REFUSED, HC_ENERGY_STORED, stored), deposit.value);
}

// Called by all invocations of a workgroup.
fn hg_add_counters(lane: u32) {
    workgroupBarrier();
    if lane < HC_WORDS {
        let value = vec2<u32>(atomicLoad(&hg_tally[2u * lane]), atomicLoad(&hg_tally[2u * lane + 1u]));
        if (value.x | value.y) != 0u {
            let high = hc_carry(atomicAdd(&hg_counters[2u * lane], value.x), value);
            if high != 0u {
                atomicAdd(&hg_counters[2u * lane + 1u], high);
            }
        }
    }
}
