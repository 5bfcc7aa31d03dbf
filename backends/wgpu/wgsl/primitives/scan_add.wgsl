// Adds what stands before each block of 1024 words; the word behind the last becomes the whole sum.

struct PrScan {
    count: u32,
    blocks: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<storage, read> pr_before_block: array<u32>;
@group(0) @binding(1) var<storage, read_write> pr_output: array<u32>;
@group(0) @binding(14) var<uniform> pr_scan: PrScan;

@compute @workgroup_size(256)
fn pr_scan_add_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if (item >= hc_launch.count) {
        return;
    }
    if (item == pr_scan.count) {
        pr_output[item] = pr_before_block[pr_scan.blocks];
    } else {
        pr_output[item] += pr_before_block[item / 1024u];
    }
}
