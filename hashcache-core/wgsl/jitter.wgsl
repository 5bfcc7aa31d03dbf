// Jitter in the tangent plane, in integers. Twins: hashcache_core::jitter.

fn hc_draw(bits: u32, range: u32) -> i32 {
    return i32(((bits & 0xffffu) * (2u * range)) >> 16u) - i32(range);
}

fn hc_max_component(v: vec3<i32>) -> u32 {
    let m = abs(v);
    if m.x >= m.y && m.x >= m.z {
        return 0u;
    }
    return select(2u, 1u, m.y >= m.z);
}

fn hc_turn(v: vec3<i32>, axis: u32) -> vec3<i32> {
    if axis == 0u {
        return v;
    }
    return select(v.zxy, v.yzx, axis == 1u);
}

fn hc_turn_back(v: vec3<i32>, axis: u32) -> vec3<i32> {
    return hc_turn(v, (3u - axis) % 3u);
}

fn hc_tangent_offset(n: vec3<i32>, u: i32, v: i32) -> vec3<i32> {
    let axis = hc_max_component(n);
    let t = hc_turn(n, axis);
    return hc_turn_back(vec3<i32>(-(t.y * u + t.z * v) / t.x, u, v), axis);
}
