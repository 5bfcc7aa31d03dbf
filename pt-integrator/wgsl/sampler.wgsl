// Sobol' points, Owen-scrambled by hashing: the integers behind `Sobol`, bit for bit. Needs hash.wgsl (`hc_pcg*`).

fn pt_laine_karras(x: u32, seed: u32) -> u32 {
    var v = x;
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16u) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return v;
}

fn pt_nested_uniform_scramble(x: u32, seed: u32) -> u32 {
    return reverseBits(pt_laine_karras(reverseBits(x), seed));
}

fn pt_sobol_second(index: u32) -> u32 {
    var v = index;
    v ^= v >> 16u;
    v ^= (v & 0xff00ff00u) >> 8u;
    v ^= (v & 0xf0f0f0f0u) >> 4u;
    v ^= (v & 0xccccccccu) >> 2u;
    v ^= (v & 0xaaaaaaaau) >> 1u;
    return v;
}

fn pt_sobol_point(index_reversed: u32, seed: u32, dimension: u32) -> vec2<u32> {
    let seeds = hc_pcg3d(vec3<u32>(seed, dimension, 0u));
    let index = reverseBits(pt_laine_karras(index_reversed, seeds.x));
    let x = reverseBits(pt_laine_karras(index, seeds.y));
    let y = reverseBits(pt_laine_karras(pt_sobol_second(index), seeds.z));
    return vec2<u32>(x, y);
}

fn pt_sobol_value(index_reversed: u32, seed: u32, dimension: u32) -> u32 {
    let seeds = hc_pcg3d(vec3<u32>(seed, dimension, 0u));
    let index = reverseBits(pt_laine_karras(index_reversed, seeds.x));
    return reverseBits(pt_laine_karras(index, seeds.y));
}

fn pt_pixel_seed(pixel: u32, seed: u32) -> u32 {
    return hc_pcg2d(vec2<u32>(pixel, seed)).x;
}

fn pt_vertex_seed(pixel_seed: u32, sample: u32) -> u32 {
    return hc_finish(hc_mix(pixel_seed, sample));
}
