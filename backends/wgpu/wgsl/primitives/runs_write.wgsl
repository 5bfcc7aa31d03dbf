// Key and first index of every run.

@group(0) @binding(0) var<storage, read> pr_keys: array<u32>;
@group(0) @binding(1) var<storage, read> pr_places: array<u32>;
@group(0) @binding(2) var<storage, read_write> pr_unique: array<u32>;
@group(0) @binding(3) var<storage, read_write> pr_starts: array<u32>;

@compute @workgroup_size(256)
fn pr_runs_write_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if (item >= hc_launch.count) {
        return;
    }
    let run = pr_places[item];
    if (pr_places[item + 1u] != run) {
        pr_unique[run] = pr_keys[item];
        pr_starts[run] = item;
    }
}
