// The word that tells whose a slot is. Twins: hashgrid::tag.

const HG_EMPTY: u32 = 0xffffffffu;
const HG_NEW: u32 = 0x80000000u;
const HG_DISTANCE_BITS: u32 = 6u;
const HG_FINGERPRINT_BITS: u32 = 25u;

fn hg_tag(fingerprint: u32, distance: u32) -> u32 {
    return (fingerprint << HG_DISTANCE_BITS) | distance;
}

fn hg_tag_distance(tag: u32) -> u32 {
    return tag & ((1u << HG_DISTANCE_BITS) - 1u);
}

fn hg_tag_fingerprint(tag: u32) -> u32 {
    return (tag & ~HG_NEW) >> HG_DISTANCE_BITS;
}

fn hg_tag_is_new(tag: u32) -> bool {
    return tag >= HG_NEW && tag != HG_EMPTY;
}
