// The sum of every run: a difference of two prefix sums, exact because both are taken modulo 2^32.

@group(0) @binding(0) var<storage, read> pr_places: array<u32>;
@group(0) @binding(1) var<storage, read> pr_starts: array<u32>;
@group(0) @binding(2) var<storage, read> pr_prefix: array<u32>;
@group(0) @binding(3) var<storage, read_write> pr_sums: array<u32>;
@group(0) @binding(4) var<storage, read_write> pr_runs: array<u32>;

@compute @workgroup_size(256)
fn pr_runs_sum_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    let runs = pr_places[hc_launch.count];
    if (item == 0u) {
        pr_runs[0] = runs;
    }
    if (item >= runs) {
        return;
    }
    var end = hc_launch.count;
    if (item + 1u < runs) {
        end = pr_starts[item + 1u];
    }
    pr_sums[item] = pr_prefix[end] - pr_prefix[pr_starts[item]];
}
