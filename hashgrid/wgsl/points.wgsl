// Where implicit progressive points are, in integers. Twins: hashgrid::points. Needs key and its hc modules.

const HG_POINT_BIN: u32 = 2047u;

struct HgSpot {
    level: u32,
    fixed: vec3<i32>,
}

struct HgPoint {
    owner: HgKey,
    offset: vec3<i32>,
}

// The level is HG_NO_KEY where there is no spot.
fn hg_point_spot(params: HgParams, place: vec4<f32>) -> HgSpot {
    let bits = bitcast<vec4<u32>>(place);
    let magnitude = bits & vec4<u32>(0x7fffffffu);
    let largest = max(magnitude.x, max(magnitude.y, magnitude.z));
    let lowest = hg_lowest_level(largest, params.base_exponent);
    if max(largest, magnitude.w) >= 0x7f800000u || lowest > i32(HC_MAX_LEVEL) {
        return HgSpot(HG_NO_KEY, vec3<i32>());
    }
    let level = hg_footprint_level(hg_footprint_in_cells(params, bits.w), lowest).x;
    let scale = i32(HG_CELL_BITS) - params.base_exponent - level;
    return HgSpot(u32(level), vec3<i32>(hg_fixed(bits.x, scale), hg_fixed(bits.y, scale), hg_fixed(bits.z, scale)));
}

fn hg_point_cube(spot: HgSpot) -> HgKey {
    return HgKey((spot.fixed + hg_origin_shift(spot.level)) >> vec3<u32>(HG_CELL_BITS), spot.level | (HG_POINT_BIN << 8u));
}

fn hg_point_pick(cube: HgKey) -> u32 {
    return hc_pcg4d(vec4<u32>(bitcast<vec3<u32>>(cube.cell), cube.attributes)).x >> 29u;
}

fn hg_point_owner(cube: HgKey) -> HgKey {
    var own = cube;
    for (var step = 0u; step < HC_MAX_LEVEL; step++) {
        let above = hg_coarser(own);
        let bits = vec3<u32>(own.cell & vec3<i32>(1));
        if above.attributes == HG_NO_KEY || hg_point_pick(above) != (bits.x | (bits.y << 1u) | (bits.z << 2u)) {
            break;
        }
        own = above;
    }
    return own;
}

fn hg_point_place(cube: HgKey) -> vec3<i32> {
    var inner = cube;
    var place = vec3<u32>();
    var bits = HG_CELL_BITS;
    while bits > 0u {
        let octant = hg_point_pick(inner);
        let below = hg_finer(inner, octant);
        if below.attributes == HG_NO_KEY {
            break;
        }
        bits -= 1u;
        place |= (vec3<u32>(octant, octant >> 1u, octant >> 2u) & vec3<u32>(1u)) << vec3<u32>(bits);
        inner = below;
    }
    let rest = hc_pcg4d(vec4<u32>(bitcast<vec3<u32>>(inner.cell), inner.attributes)).yzw;
    return vec3<i32>(place | ((rest >> vec3<u32>(24u)) >> vec3<u32>(HG_CELL_BITS - bits)));
}

fn hg_point_offset(at: vec3<i32>, delta: vec3<i32>, cube: HgKey) -> vec3<i32> {
    return 512 * delta + 2 * hg_point_place(cube) + 1 - at;
}

fn hg_distance_squared(offset: vec3<i32>) -> u32 {
    return u32(offset.x * offset.x + offset.y * offset.y + offset.z * offset.z);
}

fn hg_beyond(at: i32, delta: i32) -> i32 {
    let low = 512 * delta - at;
    return select(select(0, low + 512, low < -512), low, low > 0);
}

fn hg_cube_distance(at: vec3<i32>, delta: vec3<i32>) -> u32 {
    return hg_distance_squared(vec3<i32>(hg_beyond(at.x, delta.x), hg_beyond(at.y, delta.y), hg_beyond(at.z, delta.z)));
}

fn hg_point_inside(spot: HgSpot) -> vec3<i32> {
    return 2 * ((spot.fixed + hg_origin_shift(spot.level)) & vec3<i32>(255)) + 1;
}

fn hg_point_neighbour(cube: HgKey, index: i32) -> vec3<i32> {
    return vec3<i32>(index % 6, (index / 6) % 6, index / 36) - 2 - (cube.cell & vec3<i32>(1));
}

fn hg_reach(delta: vec3<i32>) -> i32 {
    let m = abs(delta);
    return max(m.x, max(m.y, m.z));
}

fn hg_point_nearest(spot: HgSpot) -> array<HgPoint, 3> {
    let cube = hg_point_cube(spot);
    let at = hg_point_inside(spot);
    var points = array<HgPoint, 3>();
    var distances = vec3<u32>(0xffffffffu);
    for (var pass_index = 0; pass_index < 2; pass_index++) {
        for (var index = 0; index < 216; index++) {
            let delta = hg_point_neighbour(cube, index);
            if (hg_reach(delta) > 1) != (pass_index == 1) || hg_cube_distance(at, delta) >= distances.z {
                continue;
            }
            let other = HgKey(cube.cell + delta, cube.attributes);
            let offset = hg_point_offset(at, delta, other);
            let distance = hg_distance_squared(offset);
            if distance >= distances.z {
                continue;
            }
            let found = HgPoint(other, offset);
            if distance < distances.x {
                points = array<HgPoint, 3>(found, points[0], points[1]);
                distances = vec3<u32>(distance, distances.xy);
            } else if distance < distances.y {
                points = array<HgPoint, 3>(points[0], found, points[1]);
                distances = vec3<u32>(distances.x, distance, distances.y);
            } else {
                points[2] = found;
                distances.z = distance;
            }
        }
    }
    for (var k = 0; k < 3; k++) {
        points[k].owner = hg_point_owner(points[k].owner);
    }
    return points;
}

fn hg_high_product(a: u32, b: u32) -> u32 {
    let middle = (a >> 16u) * (b & 0xffffu) + (((a & 0xffffu) * (b & 0xffffu)) >> 16u);
    let other = (a & 0xffffu) * (b >> 16u) + (middle & 0xffffu);
    return (a >> 16u) * (b >> 16u) + (middle >> 16u) + (other >> 16u);
}

fn hg_point_choose(distances: vec3<u32>, random: u32) -> u32 {
    let d = max(distances, vec3<u32>(1u));
    let weights = (vec3<u32>(d.x << countLeadingZeros(d.x)) / d) >> vec3<u32>(2u);
    let draw = hg_high_product(random, weights.x + weights.y + weights.z);
    return select(0u, 1u, draw >= weights.x) + select(0u, 1u, draw >= weights.x + weights.y);
}

fn hg_point_draw(spot: HgSpot, seed: u32) -> u32 {
    return hc_pcg4d(vec4<u32>(bitcast<vec3<u32>>(spot.fixed), seed ^ (spot.level << 27u))).z;
}
