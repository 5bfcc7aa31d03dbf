// What layers and directions add to keys, and the home that all normals of a place share. Twins: hashgrid::lobe, similar.
// Needs key and its hc modules.

const HG_SALT_DIRECTION: u32 = 0x165667b1u;

struct HgLobe {
    layer: u32,
    direction_bins: u32,
    direction_jitter: u32,
}

fn hg_attributes(lobe: HgLobe, params: HgParams, vertex: HcVertexRecord, salt: u32) -> u32 {
    let layer = lobe.layer << 30u;
    if lobe.direction_bins == 0u {
        return layer;
    }
    let random = hc_pcg3d(vec3<u32>(vertex.seed, params.seed, salt ^ HG_SALT_DIRECTION));
    let u = hc_draw(random.x >> 16u, lobe.direction_jitter);
    let v = hc_draw(random.y >> 16u, lobe.direction_jitter);
    let bin = hg_normal_bin(hc_octahedral_decode_int(vertex.direction), u, v, lobe.direction_bins);
    return layer | ((bin + 1u) << 19u);
}

fn hg_place_home(key: HgKey) -> u32 {
    return hg_home(HgKey(key.cell, key.attributes & ~(0x7ffu << 8u)));
}
