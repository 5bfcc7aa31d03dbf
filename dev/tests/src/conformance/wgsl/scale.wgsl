struct ToyScaleParams {
    factor: u32,
    summand: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<storage, read> toy_input: array<u32>;
@group(0) @binding(1) var<storage, read_write> toy_output: array<vec2<u32>>;
@group(0) @binding(14) var<uniform> toy_params: ToyScaleParams;

@compute @workgroup_size(64)
fn toy_scale(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = hc_item(gid, groups);
    if (i >= hc_launch.count) {
        return;
    }
    let place = (i * 7u + 3u) % arrayLength(&toy_input);
    toy_output[i] = vec2<u32>(toy_input[place] * toy_params.factor + toy_params.summand, i);
}
