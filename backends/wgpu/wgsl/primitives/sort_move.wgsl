// Moves each pair of a block of 256 to its place: pairs before it by digit and block, plus those before it in its
// own block. The latter are counted in a bit set per digit, so equal digits keep their order.

struct PrSort {
    count: u32,
    blocks: u32,
    shift: u32,
    reserved: u32,
}

@group(0) @binding(0) var<storage, read> pr_keys: array<u32>;
@group(0) @binding(1) var<storage, read> pr_values: array<u32>;
@group(0) @binding(2) var<storage, read> pr_places: array<u32>;
@group(0) @binding(3) var<storage, read_write> pr_keys_out: array<u32>;
@group(0) @binding(4) var<storage, read_write> pr_values_out: array<u32>;
@group(0) @binding(14) var<uniform> pr_sort: PrSort;

// Bit `lane` of the eight words from `digit * 8` on: invocation `lane` holds that digit.
var<workgroup> pr_holders: array<atomic<u32>, 2048>;

@compute @workgroup_size(256)
fn pr_sort_move_main(
    @builtin(global_invocation_id) gid: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = hc_item(gid, groups);
    let block = group.y * groups.x + group.x;
    for (var word = 0u; word < 8u; word++) {
        atomicStore(&pr_holders[lane * 8u + word], 0u);
    }
    workgroupBarrier();
    var key = 0u;
    var digit = 0u;
    if (item < pr_sort.count) {
        key = pr_keys[item];
        digit = (key >> pr_sort.shift) & 255u;
        atomicOr(&pr_holders[digit * 8u + lane / 32u], 1u << (lane % 32u));
    }
    workgroupBarrier();
    if (item < pr_sort.count) {
        var before = 0u;
        for (var word = 0u; word < lane / 32u; word++) {
            before += countOneBits(atomicLoad(&pr_holders[digit * 8u + word]));
        }
        before += countOneBits(atomicLoad(&pr_holders[digit * 8u + lane / 32u]) & ((1u << (lane % 32u)) - 1u));
        let place = pr_places[digit * pr_sort.blocks + block] + before;
        pr_keys_out[place] = key;
        pr_values_out[place] = pr_values[item];
    }
}
