@group(0) @binding(0) var<storage, read_write> toy_values: array<u32>;

@compute @workgroup_size(64)
fn toy_step(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = hc_item(gid, groups);
    if (i >= hc_launch.count) {
        return;
    }
    toy_values[i] = toy_values[i] * 3u + i;
}
