// Exclusive prefix sums of blocks of 1024 words: 256 invocations, four words each.

struct PrScan {
    // Words to sum up.
    count: u32,
    // Blocks of 1024 words.
    blocks: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<storage, read> pr_input: array<u32>;
@group(0) @binding(1) var<storage, read_write> pr_output: array<u32>;
@group(0) @binding(2) var<storage, read_write> pr_block_sums: array<u32>;
@group(0) @binding(14) var<uniform> pr_scan: PrScan;

var<workgroup> pr_lane_sums: array<u32, 256>;

@compute @workgroup_size(256)
fn pr_scan_main(
    @builtin(global_invocation_id) gid: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    hc_item(gid, groups);
    let block = group.y * groups.x + group.x;
    let first = block * 1024u + lane * 4u;
    var before: array<u32, 4>;
    var sum = 0u;
    for (var k = 0u; k < 4u; k++) {
        before[k] = sum;
        if (first + k < pr_scan.count) {
            sum += pr_input[first + k];
        }
    }
    pr_lane_sums[lane] = sum;
    workgroupBarrier();
    for (var distance = 1u; distance < 256u; distance *= 2u) {
        var left = 0u;
        if (lane >= distance) {
            left = pr_lane_sums[lane - distance];
        }
        workgroupBarrier();
        pr_lane_sums[lane] += left;
        workgroupBarrier();
    }
    let lanes_before = pr_lane_sums[lane] - sum;
    for (var k = 0u; k < 4u; k++) {
        if (first + k < pr_scan.count) {
            pr_output[first + k] = lanes_before + before[k];
        }
    }
    if (lane == 255u && block < pr_scan.blocks) {
        pr_block_sums[block] = pr_lane_sums[255];
        if (pr_scan.blocks == 1u) {
            pr_output[pr_scan.count] = pr_lane_sums[255];
        }
    }
}
