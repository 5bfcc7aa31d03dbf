// Integer hashes. Twins: hashcache_core::hash.

const HC_LCG_MULTIPLIER: u32 = 1664525u;
const HC_LCG_INCREMENT: u32 = 1013904223u;

// Jarzynski & Olano 2020, `pcg`.
fn hc_pcg(v: u32) -> u32 {
    let state = v * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn hc_lcg(v: u32) -> u32 {
    return v * HC_LCG_MULTIPLIER + HC_LCG_INCREMENT;
}

// Jarzynski & Olano 2020, `pcg2d`.
fn hc_pcg2d(v: vec2<u32>) -> vec2<u32> {
    var x = hc_lcg(v.x);
    var y = hc_lcg(v.y);
    x += y * HC_LCG_MULTIPLIER;
    y += x * HC_LCG_MULTIPLIER;
    x ^= x >> 16u;
    y ^= y >> 16u;
    x += y * HC_LCG_MULTIPLIER;
    y += x * HC_LCG_MULTIPLIER;
    return vec2<u32>(x ^ (x >> 16u), y ^ (y >> 16u));
}

// Jarzynski & Olano 2020, `pcg3d`.
fn hc_pcg3d(v: vec3<u32>) -> vec3<u32> {
    var x = hc_lcg(v.x);
    var y = hc_lcg(v.y);
    var z = hc_lcg(v.z);
    x += y * z;
    y += z * x;
    z += x * y;
    x ^= x >> 16u;
    y ^= y >> 16u;
    z ^= z >> 16u;
    x += y * z;
    y += z * x;
    z += x * y;
    return vec3<u32>(x, y, z);
}

// Jarzynski & Olano 2020, `pcg4d`.
fn hc_pcg4d(v: vec4<u32>) -> vec4<u32> {
    var x = hc_lcg(v.x);
    var y = hc_lcg(v.y);
    var z = hc_lcg(v.z);
    var w = hc_lcg(v.w);
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16u;
    y ^= y >> 16u;
    z ^= z >> 16u;
    w ^= w >> 16u;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    return vec4<u32>(x, y, z, w);
}

// One round of MurmurHash3_x86_32; end with hc_finish.
fn hc_mix(h: u32, v: u32) -> u32 {
    var k = v * 0xcc9e2d51u;
    k = (k << 15u) | (k >> 17u);
    k *= 0x1b873593u;
    let r = h ^ k;
    return ((r << 13u) | (r >> 19u)) * 5u + 0xe6546b64u;
}

// MurmurHash3's fmix32.
fn hc_finish(h: u32) -> u32 {
    let a = (h ^ (h >> 16u)) * 0x85ebca6bu;
    let b = (a ^ (a >> 13u)) * 0xc2b2ae35u;
    return b ^ (b >> 16u);
}

// In [0, 1): the top 24 bits.
fn hc_to_unit_f32(v: u32) -> f32 {
    return f32(v >> 8u) * (1.0 / 16777216.0);
}
