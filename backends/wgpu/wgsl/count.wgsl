// Turns a count that stands in a buffer into the launch of the dispatch behind it.

@group(0) @binding(0) var<storage, read> hc_count_source: array<u32>;
@group(0) @binding(1) var<storage, read_write> hc_count_target: HcLaunch;
@group(0) @binding(2) var<storage, read_write> hc_count_status: array<atomic<u32>>;

@compute @workgroup_size(1)
fn hc_count_main() {
    let count = min(hc_count_source[hc_count_target.source_word], hc_count_target.max_count);
    hc_count_target.count = count;
    if (count == 0u) {
        // Nothing to run is not a dispatch that failed to run.
        hc_count_target.groups_x = 0u;
        hc_count_target.groups_y = 0u;
        hc_count_target.groups_z = 0u;
        atomicAnd(&hc_count_status[hc_count_target.status], 0x7fffffffu);
        return;
    }
    let groups = (count - 1u) / hc_count_target.workgroup_size + 1u;
    let x = min(groups, 65535u);
    hc_count_target.groups_x = x;
    hc_count_target.groups_y = (groups - 1u) / x + 1u;
    hc_count_target.groups_z = 1u;
}
