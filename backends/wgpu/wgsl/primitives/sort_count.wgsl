// Counts the digits of each block of 256 keys. The table is ordered by digit, then by block, so that its prefix sums
// are the places of a stable sort.

struct PrSort {
    // Keys.
    count: u32,
    // Blocks of 256 keys.
    blocks: u32,
    // Lowest bit of the digit.
    shift: u32,
    reserved: u32,
}

@group(0) @binding(0) var<storage, read> pr_keys: array<u32>;
@group(0) @binding(1) var<storage, read_write> pr_table: array<u32>;
@group(0) @binding(14) var<uniform> pr_sort: PrSort;

var<workgroup> pr_counts: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn pr_sort_count_main(
    @builtin(global_invocation_id) gid: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = hc_item(gid, groups);
    let block = group.y * groups.x + group.x;
    atomicStore(&pr_counts[lane], 0u);
    workgroupBarrier();
    if (item < pr_sort.count) {
        atomicAdd(&pr_counts[(pr_keys[item] >> pr_sort.shift) & 255u], 1u);
    }
    workgroupBarrier();
    if (block < pr_sort.blocks) {
        pr_table[lane * pr_sort.blocks + block] = atomicLoad(&pr_counts[lane]);
    }
}
