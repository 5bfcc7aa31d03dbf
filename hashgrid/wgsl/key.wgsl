// From a path vertex to its key, in integers. Twins: hashgrid::params, jitter, key. Needs hc: hash, jitter, level, pack,
// record.

const HG_CELL_BITS: u32 = 8u;
const HG_SALT_DEPOSIT: u32 = 0x9e3779b9u;
const HG_SALT_LOOKUP: u32 = 0x7f4a7c15u;
const HG_FINGERPRINT_MAX: u32 = 0x1fffffeu;
// Attributes of the key of a vertex that has none.
const HG_NO_KEY: u32 = 0xffffffffu;

struct HgParams {
    cells_per_footprint: u32,
    base_exponent: i32,
    level_rate: i32,
    jitter: u32,
    normal_bins: u32,
    normal_jitter: u32,
    max_probes: u32,
    seed: u32,
    quantum: i32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

struct HgKey {
    cell: vec3<i32>,
    attributes: u32,
}

fn hg_footprint_in_cells(params: HgParams, footprint: u32) -> f32 {
    let usable = select(min(footprint, 0x5f000000u), 0u, footprint > 0x7fffffffu);
    return bitcast<f32>(usable & 0xfffff000u) * bitcast<f32>(params.cells_per_footprint);
}

fn hg_face_bin(m: i32, t: i32, bins: u32) -> u32 {
    return min((u32(t + m) * bins) / (2u * u32(m)), bins - 1u);
}

fn hg_normal_bin(n: vec3<i32>, u: i32, v: i32, bins: u32) -> u32 {
    let axis = hc_max_component(n);
    let t = hc_turn(n, axis);
    let m = abs(t.x);
    let moved = vec3<i32>(t.x, t.y + ((m * u) >> 15u), t.z + ((m * v) >> 15u));
    let beyond = hc_max_component(moved);
    let b = hc_turn(moved, beyond);
    let face = ((axis + beyond) % 3u) * 2u + select(0u, 1u, b.x < 0);
    return (face * bins + hg_face_bin(abs(b.x), b.y, bins)) * bins + hg_face_bin(abs(b.x), b.z, bins);
}

fn hg_path_change(offset: vec3<i32>, direction: vec3<i32>) -> i32 {
    let along = offset.x * direction.x + offset.y * direction.y + offset.z * direction.z;
    let m = abs(direction);
    let largest = max(m.x, max(m.y, m.z));
    let smallest = min(m.x, min(m.y, m.z));
    let middle = m.x + m.y + m.z - largest - smallest;
    return along / ((962 * largest + 399 * middle + 306 * smallest) >> 10u);
}

fn hg_rescale(v: i32, shift: i32) -> i32 {
    if shift < 0 {
        return v << u32(-shift);
    }
    return v >> u32(shift);
}

fn hg_lowest_level(magnitude: u32, base_exponent: i32) -> i32 {
    return max(i32(magnitude >> 23u) - 148 - base_exponent, 0);
}

fn hg_footprint_level(cells: f32, lowest: i32) -> vec2<i32> {
    let bits = bitcast<u32>(cells);
    if bits < 0x00800000u {
        return vec2<i32>(lowest, 0);
    }
    let exact = hc_exponent(cells);
    let level = clamp(exact, lowest, i32(HC_MAX_LEVEL));
    let mantissa = i32((bits & 0x007fffffu) | 0x00800000u);
    return vec2<i32>(level, hg_rescale(mantissa, clamp(level - exact, -5, 31)));
}

fn hg_moved_level(level: i32, size: i32, lowest: i32) -> i32 {
    let moved = level + 8 - i32(countLeadingZeros(u32(max(size, 1))));
    let least = clamp(level - 2, lowest, level);
    let most = clamp(level + 2, level, i32(HC_MAX_LEVEL));
    return clamp(moved, least, most);
}

fn hg_fixed(x: u32, scale: i32) -> i32 {
    let biased = i32((x >> 23u) & 0xffu);
    if biased == 0 {
        return 0;
    }
    let mantissa = i32((x & 0x007fffffu) | 0x00800000u);
    return hg_rescale(select(mantissa, -mantissa, x > 0x7fffffffu), clamp(150 - biased - scale, -6, 31));
}

fn hg_origin_shift(level: u32) -> i32 {
    return i32(0x2aaaaaaau >> select(level - 8u, level & 1u, level < 8u));
}

fn hg_coarser_offset(level: u32) -> i32 {
    return (hg_origin_shift(level + 1u) - (hg_origin_shift(level) >> 1u)) >> HG_CELL_BITS;
}

fn hg_coarser(key: HgKey) -> HgKey {
    let level = key.attributes & 0xffu;
    if level >= HC_MAX_LEVEL {
        return HgKey(vec3<i32>(0), HG_NO_KEY);
    }
    return HgKey((key.cell >> vec3<u32>(1u)) + hg_coarser_offset(level), key.attributes + 1u);
}

fn hg_finer(key: HgKey, octant: u32) -> HgKey {
    let level = key.attributes & 0xffu;
    if level == 0u {
        return HgKey(vec3<i32>(0), HG_NO_KEY);
    }
    let bits = vec3<i32>(vec3<u32>(octant, octant >> 1u, octant >> 2u) & vec3<u32>(1u));
    return HgKey(2 * (key.cell - hg_coarser_offset(level - 1u)) + bits, key.attributes - 1u);
}

fn hg_key(params: HgParams, vertex: HcVertexRecord, salt: u32) -> HgKey {
    let bits = bitcast<vec4<u32>>(vertex.position_footprint);
    let magnitude = bits & vec4<u32>(0x7fffffffu);
    let largest = max(magnitude.x, max(magnitude.y, magnitude.z));
    let lowest = hg_lowest_level(largest, params.base_exponent);
    if max(largest, magnitude.w) >= 0x7f800000u || lowest > i32(HC_MAX_LEVEL) {
        return HgKey(vec3<i32>(0), HG_NO_KEY);
    }
    let level_size = hg_footprint_level(hg_footprint_in_cells(params, bits.w), lowest);
    let level = level_size.x;

    let random = hc_pcg3d(vec3<u32>(vertex.seed, params.seed, salt));
    let normal = hc_octahedral_decode_int(vertex.normal);
    let u = hc_draw(random.x >> 16u, params.jitter);
    let v = hc_draw(random.y >> 16u, params.jitter);
    let offset = hc_tangent_offset(normal, u, v);
    let lean_u = hc_draw(random.z >> 16u, params.normal_jitter);
    let lean_v = hc_draw(random.x, params.normal_jitter);
    let bin = hg_normal_bin(normal, lean_u, lean_v, params.normal_bins);

    let change = hg_path_change(offset, hc_octahedral_decode_int(vertex.direction));
    let there = hg_moved_level(level, level_size.y + params.level_rate * change, lowest);
    let scale = i32(HG_CELL_BITS) - params.base_exponent - there;
    let shift = hg_origin_shift(u32(there));
    let cell = vec3<i32>(
        (hg_fixed(bits.x, scale) + hg_rescale(offset.x, there - level) + shift) >> HG_CELL_BITS,
        (hg_fixed(bits.y, scale) + hg_rescale(offset.y, there - level) + shift) >> HG_CELL_BITS,
        (hg_fixed(bits.z, scale) + hg_rescale(offset.z, there - level) + shift) >> HG_CELL_BITS,
    );
    return HgKey(cell, u32(there) | (bin << 8u));
}

fn hg_home(key: HgKey) -> u32 {
    return hc_pcg4d(vec4<u32>(bitcast<vec3<u32>>(key.cell), key.attributes)).w;
}

fn hg_fingerprint(key: HgKey) -> u32 {
    let c = bitcast<vec3<u32>>(key.cell);
    let h = hc_mix(hc_mix(hc_mix(hc_mix(0x5bd1e995u, c.x), c.y), c.z), key.attributes);
    return min(hc_finish(h) >> 7u, HG_FINGERPRINT_MAX);
}
