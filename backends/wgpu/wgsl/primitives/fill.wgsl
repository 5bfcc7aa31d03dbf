// Sets every word of a range.

struct PrFill {
    word: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<storage, read_write> pr_buffer: array<u32>;
@group(0) @binding(14) var<uniform> pr_fill: PrFill;

@compute @workgroup_size(256)
fn pr_fill_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if (item < hc_launch.count) {
        pr_buffer[item] = pr_fill.word;
    }
}
