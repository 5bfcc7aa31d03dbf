// The hash table of cells. Twins: hashgrid::table::Table. Needs tag and the globals hg_table and hg_params.

// 32-bit words of a cell: count, tag, six sums of two words, two spare.
const HG_CELL_WORDS: u32 = 16u;
const HG_CLAIM_PLACED: u32 = 0u;
const HG_CLAIM_FOUND: u32 = 1u;
const HG_CLAIM_REFUSED: u32 = 2u;
const HG_NO_SLOT: u32 = 0xffffffffu;

struct HgFound {
    slot: u32,
    probes: u32,
    head: vec2<u32>,
}

struct HgCell {
    count: u32,
    direct: array<vec2<u32>, 3>,
    further: array<vec2<u32>, 3>,
}

fn hg_mask() -> u32 {
    return arrayLength(&hg_table) / HG_CELL_WORDS - 1u;
}

fn hg_head(slot: u32) -> vec2<u32> {
    let word = slot * HG_CELL_WORDS;
    return vec2<u32>(atomicLoad(&hg_table[word]), atomicLoad(&hg_table[word + 1u]));
}

fn hg_clear_cell(slot: u32) {
    let word = slot * HG_CELL_WORDS;
    for (var k = 0u; k < HG_CELL_WORDS; k++) {
        atomicStore(&hg_table[word + k], select(0u, HG_EMPTY, k == 1u));
    }
}

fn hg_claim_from(home_slot: u32, fingerprint: u32, head: vec2<u32>) -> u32 {
    var slot = home_slot;
    var mine = HG_NEW | hg_tag(fingerprint, 0u);
    if ((head.y ^ mine) & ~HG_NEW) == 0u {
        return HG_CLAIM_FOUND;
    }
    var placed = false;
    loop {
        let old = atomicMin(&hg_table[slot * HG_CELL_WORDS + 1u], mine);
        if old == HG_EMPTY {
            return HG_CLAIM_PLACED;
        }
        if ((old ^ mine) & ~HG_NEW) == 0u {
            return select(HG_CLAIM_FOUND, HG_CLAIM_PLACED, placed);
        }
        if old > mine {
            placed = true;
            mine = old;
        }
        if hg_tag_distance(mine) + 1u >= hg_params.max_probes {
            return HG_CLAIM_REFUSED;
        }
        mine += 1u;
        slot = (slot + 1u) & hg_mask();
    }
    // Every way through the loop ends in it.
    return HG_CLAIM_REFUSED;
}

fn hg_find_from(home_slot: u32, fingerprint: u32, home_head: vec2<u32>) -> HgFound {
    var slot = home_slot;
    var head = home_head;
    for (var distance = 0u; distance < hg_params.max_probes; distance++) {
        if head.y == HG_EMPTY {
            return HgFound(HG_NO_SLOT, distance + 1u, head);
        }
        if (head.y & ~HG_NEW) == hg_tag(fingerprint, distance) {
            return HgFound(slot, distance + 1u, head);
        }
        slot = (slot + 1u) & hg_mask();
        head = hg_head(slot);
    }
    return HgFound(HG_NO_SLOT, hg_params.max_probes, head);
}

fn hg_is_full(found: HgFound) -> bool {
    return found.head.x >= HC_MAX_DEPOSITS;
}

fn hg_add_sum(word: u32, value: vec2<u32>) {
    if (value.x | value.y) == 0u {
        return;
    }
    let high = hc_carry(atomicAdd(&hg_table[word], value.x), value);
    if high != 0u {
        atomicAdd(&hg_table[word + 1u], high);
    }
}

fn hg_add(slot: u32, head: vec2<u32>, values: array<vec2<u32>, 6>, count: u32) {
    let word = slot * HG_CELL_WORDS;
    if head.y >= HG_NEW {
        atomicAnd(&hg_table[word + 1u], ~HG_NEW);
    }
    atomicAdd(&hg_table[word], count);
    hg_add_sum(word + 2u, values[0]);
    hg_add_sum(word + 4u, values[1]);
    hg_add_sum(word + 6u, values[2]);
    hg_add_sum(word + 8u, values[3]);
    hg_add_sum(word + 10u, values[4]);
    hg_add_sum(word + 12u, values[5]);
}

fn hg_sum(word: u32) -> vec2<u32> {
    return vec2<u32>(atomicLoad(&hg_table[word]), atomicLoad(&hg_table[word + 1u]));
}

fn hg_cell(slot: u32) -> HgCell {
    let word = slot * HG_CELL_WORDS;
    return HgCell(
        atomicLoad(&hg_table[word]),
        array<vec2<u32>, 3>(hg_sum(word + 2u), hg_sum(word + 4u), hg_sum(word + 6u)),
        array<vec2<u32>, 3>(hg_sum(word + 8u), hg_sum(word + 10u), hg_sum(word + 12u)),
    );
}
