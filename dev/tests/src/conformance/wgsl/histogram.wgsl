@group(0) @binding(0) var<storage, read> toy_values: array<u32>;
@group(0) @binding(1) var<storage, read_write> toy_bins: array<atomic<u32>>;

@compute @workgroup_size(64)
fn toy_histogram(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = hc_item(gid, groups);
    if (i >= hc_launch.count) {
        return;
    }
    atomicAdd(&toy_bins[toy_values[i] % arrayLength(&toy_bins)], 1u);
}
