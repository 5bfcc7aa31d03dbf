// Levels of detail from exponent bits. Twins: hashcache_core::level.

const HC_MAX_LEVEL: u32 = 31u;

fn hc_exponent(x: f32) -> i32 {
    return i32((bitcast<u32>(x) >> 23u) & 0xffu) - 127;
}

fn hc_level_from_footprint(footprint: f32, recip_base: f32) -> u32 {
    let bits = bitcast<u32>(footprint * recip_base);
    // Above +infinity's bits lie NaN, and all negative numbers.
    if bits > 0x7f800000u {
        return 0u;
    }
    return min(max(bits >> 23u, 127u) - 127u, HC_MAX_LEVEL);
}
