@group(0) @binding(0) var<storage, read> inputs: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> outputs: array<array<u32, 40>>;

@compute @workgroup_size(64)
fn parity_core(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if item >= hc_launch.count {
        return;
    }
    let v = inputs[item];
    var out: array<u32, 40>;
    out[0] = hc_pcg(v.x);
    let two = hc_pcg2d(v.xy);
    out[1] = two.x;
    out[2] = two.y;
    let three = hc_pcg3d(v.xyz);
    out[3] = three.x;
    out[4] = three.y;
    out[5] = three.z;
    let four = hc_pcg4d(v);
    out[6] = four.x;
    out[7] = four.y;
    out[8] = four.z;
    out[9] = four.w;
    out[10] = hc_mix(v.x, v.y);
    out[11] = hc_finish(v.x);
    out[12] = bitcast<u32>(hc_to_unit_f32(v.x));
    out[13] = hc_half_from_f32(v.x);
    out[14] = hc_half_to_f32(v.x & 0xffffu);
    out[15] = hc_pack_half2(hc_unpack_half2(v.y));
    let octahedral = bitcast<vec3<u32>>(hc_octahedral_decode_int(v.x));
    out[16] = octahedral.x;
    out[17] = octahedral.y;
    out[18] = octahedral.z;
    out[19] = bitcast<u32>(hc_exponent(bitcast<f32>(v.x)));
    out[20] = hc_level_from_footprint(bitcast<f32>(v.x), bitcast<f32>(v.y));
    let quantum = i32(v.w % 181u) - 100;
    let quanta = hc_quantize(quantum, bitcast<f32>(v.x));
    out[21] = quanta.value.x;
    out[22] = quanta.value.y;
    out[23] = quanta.lost.x;
    out[24] = quanta.lost.y;
    out[25] = quanta.outcome;
    out[26] = bitcast<u32>(hc_dequantize(quantum, v.yz));
    let sum = hc_add64(v.xy, v.zw);
    out[27] = sum.x;
    out[28] = sum.y;
    let difference = hc_sub64(v.xy, v.zw);
    out[29] = difference.x;
    out[30] = difference.y;
    out[31] = select(0u, 1u, hc_less64(v.xy, v.zw));
    out[32] = hc_carry(v.x, v.zw);
    let shifted = hc_shl64(v.xy, v.z & 63u);
    out[33] = shifted.x;
    out[34] = shifted.y;
    outputs[item] = out;
}
