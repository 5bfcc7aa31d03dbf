// Directions and half floats in few bits. Twins: hashcache_core::pack.

const HC_HALF_MAX: u32 = 0x7bffu;
const HC_OCTAHEDRAL_ONE: i32 = 32767;
const HC_OCTAHEDRAL_NONE: u32 = 0x80008000u;

// v / 2^shift to the nearest integer, ties to even, for 1 <= shift <= 24.
fn hc_round_even(v: u32, shift: u32) -> u32 {
    return (v + (1u << (shift - 1u)) - 1u + ((v >> shift) & 1u)) >> shift;
}

// pack2x16float overflows differently from driver to driver, hence integers.
fn hc_half_from_f32(bits: u32) -> u32 {
    let sign = (bits >> 16u) & 0x8000u;
    let magnitude = bits & 0x7fffffffu;
    if magnitude > 0x7f800000u {
        return 0x7e00u;
    }
    if magnitude >= 0x477ff000u {
        return sign | HC_HALF_MAX;
    }
    let exponent = magnitude >> 23u;
    if exponent < 113u {
        if exponent < 102u {
            return sign;
        }
        let mantissa = (magnitude & 0x007fffffu) | 0x00800000u;
        return sign | hc_round_even(mantissa, 126u - exponent);
    }
    return sign | (hc_round_even(magnitude, 13u) - (112u << 10u));
}

fn hc_half_to_f32(half: u32) -> u32 {
    let sign = (half & 0x8000u) << 16u;
    let exponent = (half >> 10u) & 31u;
    let mantissa = half & 0x03ffu;
    if exponent == 31u {
        return sign | 0x7f800000u | select(0x00400000u | (mantissa << 13u), 0u, mantissa == 0u);
    }
    if exponent == 0u {
        if mantissa == 0u {
            return sign;
        }
        let shift = countLeadingZeros(mantissa) - 21u;
        return sign | ((113u - shift) << 23u) | (((mantissa << shift) & 0x03ffu) << 13u);
    }
    return sign | ((exponent + 112u) << 23u) | (mantissa << 13u);
}

fn hc_pack_half2(v: vec2<f32>) -> u32 {
    return hc_half_from_f32(bitcast<u32>(v.x)) | (hc_half_from_f32(bitcast<u32>(v.y)) << 16u);
}

fn hc_unpack_half2(packed: u32) -> vec2<f32> {
    return vec2<f32>(bitcast<f32>(hc_half_to_f32(packed & 0xffffu)), bitcast<f32>(hc_half_to_f32(packed >> 16u)));
}

// v with the sign of s, 0 counting as positive.
fn hc_outward(v: f32, s: f32) -> f32 {
    return select(v, -v, s < 0.0);
}

// Nearest integer of v * 32767, halves away from 0.
fn hc_snorm(v: f32) -> i32 {
    let magnitude = i32(floor(abs(v) * f32(HC_OCTAHEDRAL_ONE) + 0.5));
    return select(magnitude, -magnitude, v < 0.0);
}

// Tier 1: divisions may be rounded differently from device to device.
fn hc_octahedral_encode(n: vec3<f32>) -> u32 {
    let bits = bitcast<vec3<u32>>(n) & vec3<u32>(0x7fffffffu);
    let largest = max(bits.x, max(bits.y, bits.z));
    if largest < 0x00800000u || largest >= 0x7f800000u {
        return 0u;
    }
    let v = n / bitcast<f32>(largest);
    let sum = abs(v.x) + abs(v.y) + abs(v.z);
    var p = v.xy / sum;
    if v.z < 0.0 {
        p = vec2<f32>(hc_outward(1.0 - abs(p.y), p.x), hc_outward(1.0 - abs(p.x), p.y));
    }
    return (bitcast<u32>(hc_snorm(p.x)) & 0xffffu) | (bitcast<u32>(hc_snorm(p.y)) << 16u);
}

fn hc_octahedral_decode(code: u32) -> vec3<f32> {
    let v = vec3<f32>(hc_octahedral_decode_int(code));
    return v / sqrt(dot(v, v));
}

fn hc_octahedral_component(code: u32, offset: u32) -> i32 {
    return max(extractBits(bitcast<i32>(code), offset, 16u), -HC_OCTAHEDRAL_ONE);
}

// |x| + |y| + |z| = HC_OCTAHEDRAL_ONE.
fn hc_octahedral_decode_int(code: u32) -> vec3<i32> {
    let x = hc_octahedral_component(code, 0u);
    let y = hc_octahedral_component(code, 16u);
    let z = HC_OCTAHEDRAL_ONE - abs(x) - abs(y);
    if z >= 0 {
        return vec3<i32>(x, y, z);
    }
    let folded_x = HC_OCTAHEDRAL_ONE - abs(y);
    let folded_y = HC_OCTAHEDRAL_ONE - abs(x);
    return vec3<i32>(select(folded_x, -folded_x, x < 0), select(folded_y, -folded_y, y < 0), z);
}
