// One for every set flag, zero for the others.

@group(0) @binding(0) var<storage, read> pr_flags: array<u32>;
@group(0) @binding(1) var<storage, read_write> pr_marks: array<u32>;

@compute @workgroup_size(256)
fn pr_mark_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if (item < hc_launch.count) {
        pr_marks[item] = select(0u, 1u, pr_flags[item] != 0u);
    }
}
