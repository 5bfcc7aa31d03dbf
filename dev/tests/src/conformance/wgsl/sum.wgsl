@group(0) @binding(0) var<storage, read> toy_values: array<vec2<u32>>;
@group(0) @binding(1) var<storage, read_write> toy_sums: array<atomic<u32>>;

@compute @workgroup_size(64)
fn toy_sum(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = hc_item(gid, groups);
    if (i >= hc_launch.count) {
        return;
    }
    let value = toy_values[i];
    let low = 2u * (value.x % (arrayLength(&toy_sums) / 2u));
    let before = atomicAdd(&toy_sums[low], value.x);
    let carry = select(0u, 1u, before + value.x < before);
    atomicAdd(&toy_sums[low + 1u], value.y + carry);
}
