@compute @workgroup_size(64)
fn hg_clear_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if item < hc_launch.count {
        hg_clear_cell(item);
    }
}
