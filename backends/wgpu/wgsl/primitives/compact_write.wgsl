// Writes the index of every set flag to its place, and the number of them.

@group(0) @binding(0) var<storage, read> pr_flags: array<u32>;
@group(0) @binding(1) var<storage, read> pr_places: array<u32>;
@group(0) @binding(2) var<storage, read_write> pr_indices: array<u32>;
@group(0) @binding(3) var<storage, read_write> pr_kept: array<u32>;

@compute @workgroup_size(256)
fn pr_compact_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if (item >= hc_launch.count) {
        return;
    }
    if (pr_flags[item] != 0u) {
        pr_indices[pr_places[item]] = item;
    }
    if (item == 0u) {
        pr_kept[0] = pr_places[hc_launch.count];
    }
}
