struct ToyFiveParams {
    words: array<vec4<u32>, 17>,
}

@group(0) @binding(0) var<storage, read> toy_a: array<u32>;
@group(0) @binding(1) var<storage, read> toy_b: array<u32>;
@group(0) @binding(2) var<storage, read_write> toy_results: array<u32>;
@group(0) @binding(3) var<storage, read_write> toy_bins: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> toy_sums: array<atomic<u32>>;
@group(0) @binding(14) var<uniform> toy_params: ToyFiveParams;

@compute @workgroup_size(64)
fn toy_five(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = hc_item(gid, groups);
    if (i >= hc_launch.count) {
        return;
    }
    let product = toy_a[i] * toy_b[i];
    let before = atomicAdd(&toy_sums[0], product);
    atomicAdd(&toy_sums[1], select(0u, 1u, before + product < before));
    atomicAdd(&toy_bins[i % arrayLength(&toy_bins)], toy_a[i]);
    toy_results[i] = product + toy_params.words[16].w;
}
