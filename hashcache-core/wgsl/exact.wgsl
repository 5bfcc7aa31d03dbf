// Exact sums. A 64-bit word is a vec2<u32>, low word first; a Quantum is the exponent of L0. Twins:
// hashcache_core::exact.

const HC_FRACTION_BITS: u32 = 20u;
const HC_CLAMP_BITS: u32 = 33u;
const HC_CEILING_BITS: u32 = 44u;
const HC_UNDERFLOW_BITS: u32 = 20u;
const HC_MAX_DEPOSITS: u32 = 1073741824u;

const HC_OUTCOME_EXACT: u32 = 0u;
const HC_OUTCOME_UNDERFLOW: u32 = 1u;
const HC_OUTCOME_CLAMPED: u32 = 2u;
const HC_OUTCOME_SATURATED: u32 = 3u;
const HC_OUTCOME_NON_FINITE: u32 = 4u;
const HC_OUTCOME_NEGATIVE: u32 = 5u;

struct HcQuantized {
    value: vec2<u32>,
    lost: vec2<u32>,
    outcome: u32,
}

fn hc_carry(old_lo: u32, add: vec2<u32>) -> u32 {
    return add.y + select(0u, 1u, old_lo + add.x < old_lo);
}

fn hc_add64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x + b.x, a.y + hc_carry(a.x, b));
}

fn hc_sub64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x - b.x, a.y - b.y - select(0u, 1u, a.x < b.x));
}

fn hc_less64(a: vec2<u32>, b: vec2<u32>) -> bool {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

// For shifts below 64.
fn hc_shl64(v: vec2<u32>, shift: u32) -> vec2<u32> {
    if shift >= 32u {
        return vec2<u32>(0u, v.x << (shift - 32u));
    }
    if shift == 0u {
        return v;
    }
    return vec2<u32>(v.x << shift, (v.y << shift) | (v.x >> (32u - shift)));
}

// mantissa / 2^shift to the nearest integer, ties up, for mantissas of at most 24 bits.
fn hc_round_shift(mantissa: u32, shift: u32) -> u32 {
    if shift == 0u {
        return mantissa;
    }
    if shift > 24u {
        return 0u;
    }
    return (mantissa + (1u << (shift - 1u))) >> shift;
}

// mantissa / 2^shift quanta, for shifts above 0.
fn hc_quantize_below(mantissa: u32, shift: u32) -> HcQuantized {
    let value = hc_round_shift(mantissa, shift);
    if value > 0u {
        return HcQuantized(vec2<u32>(value, 0u), vec2<u32>(), HC_OUTCOME_EXACT);
    }
    let lost = hc_round_shift(mantissa, shift - HC_UNDERFLOW_BITS);
    return HcQuantized(vec2<u32>(), vec2<u32>(lost, 0u), HC_OUTCOME_UNDERFLOW);
}

fn hc_quantize(q: i32, x: f32) -> HcQuantized {
    let bits = bitcast<u32>(x);
    let magnitude = bits & 0x7fffffffu;
    if magnitude >= 0x7f800000u {
        return HcQuantized(vec2<u32>(), vec2<u32>(), HC_OUTCOME_NON_FINITE);
    }
    if magnitude == 0u {
        return HcQuantized(vec2<u32>(), vec2<u32>(), HC_OUTCOME_EXACT);
    }
    if bits != magnitude {
        return HcQuantized(vec2<u32>(), vec2<u32>(), HC_OUTCOME_NEGATIVE);
    }
    var biased = magnitude >> 23u;
    var mantissa = magnitude & 0x007fffffu;
    if biased == 0u {
        biased = 1u;
    } else {
        mantissa |= 0x00800000u;
    }
    let shift = i32(biased) - 150 - (q - i32(HC_FRACTION_BITS));
    if shift < 0 {
        return hc_quantize_below(mantissa, u32(-shift));
    }
    let wide = hc_shl64(vec2<u32>(mantissa, 0u), u32(min(shift, 22)));
    let clamp_value = vec2<u32>(0u, 1u << (HC_CLAMP_BITS - 32u));
    if !hc_less64(clamp_value, wide) {
        return HcQuantized(wide, vec2<u32>(), HC_OUTCOME_EXACT);
    }
    let ceiling = vec2<u32>(0u, 1u << (HC_CEILING_BITS - 32u));
    if hc_less64(ceiling, wide) {
        return HcQuantized(clamp_value, hc_sub64(ceiling, clamp_value), HC_OUTCOME_SATURATED);
    }
    return HcQuantized(clamp_value, hc_sub64(wide, clamp_value), HC_OUTCOME_CLAMPED);
}

fn hc_dequantize(q: i32, sum: vec2<u32>) -> f32 {
    if (sum.x | sum.y) == 0u {
        return 0.0;
    }
    let zeros = select(countLeadingZeros(sum.y), 32u + countLeadingZeros(sum.x), sum.y == 0u);
    // The leading bit stands at bit 63: 24 bits of mantissa, 40 bits to round, ties to even.
    let v = hc_shl64(sum, zeros);
    let mantissa = v.y >> 8u;
    let rest = v.y & 0xffu;
    let up = rest > 0x80u || (rest == 0x80u && (v.x != 0u || (mantissa & 1u) == 1u));
    let biased = u32(63 - i32(zeros) + q - i32(HC_FRACTION_BITS) + 127);
    // A mantissa that rounds up to 2^24 carries into the exponent.
    return bitcast<f32>((biased << 23u) + (mantissa - 0x00800000u) + select(0u, 1u, up));
}

// Tier 1: the division may be rounded differently from device to device.
fn hc_mean(q: i32, sum: vec2<u32>, count: u32) -> f32 {
    if count == 0u {
        return 0.0;
    }
    return hc_dequantize(q, sum) / f32(count);
}
