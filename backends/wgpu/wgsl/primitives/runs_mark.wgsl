// One where a run of equal keys begins, zero elsewhere.

@group(0) @binding(0) var<storage, read> pr_keys: array<u32>;
@group(0) @binding(1) var<storage, read_write> pr_marks: array<u32>;

@compute @workgroup_size(256)
fn pr_runs_mark_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if (item >= hc_launch.count) {
        return;
    }
    var mark = 1u;
    if (item > 0u) {
        mark = select(0u, 1u, pr_keys[item] != pr_keys[item - 1u]);
    }
    pr_marks[item] = mark;
}
