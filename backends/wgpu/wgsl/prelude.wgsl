// What every kernel of this backend starts with: the launch, the item's index, the status word.

@group(0) @binding(13) var<uniform> hc_launch: HcLaunch;
@group(0) @binding(15) var<storage, read_write> hc_status: array<atomic<u32>>;

// Raises flags in the dispatch's status word; the flag "not run" belongs to the backend.
fn hc_raise(flags: u32) {
    atomicOr(&hc_status[hc_launch.status], flags & 0x7fffffffu);
}

// The invocation's item. At or above `hc_launch.count` for invocations that have none. Item 0 reports that the
// dispatch ran.
fn hc_item(gid: vec3<u32>, groups: vec3<u32>) -> u32 {
    if (gid.x == 0u && gid.y == 0u) {
        atomicAnd(&hc_status[hc_launch.status], 0x7fffffffu);
    }
    let row = gid.y * groups.x * hc_launch.workgroup_size;
    let item = row + gid.x;
    // The last row may reach past 2^32; what wraps around has no item.
    return select(item, 0xffffffffu, item < row);
}
