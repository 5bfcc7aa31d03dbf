// One dispatch, as the host or `hc_count_main` fills it in.
struct HcLaunch {
    // Items of the dispatch.
    count: u32,
    // Index of the dispatch's word in `hc_status`.
    status: u32,
    // Invocations of one workgroup; workgroups are one-dimensional.
    workgroup_size: u32,
    // Upper bound of `count` where a buffer holds it.
    max_count: u32,
    // Where in the bound range the count's word stands.
    source_word: u32,
    // Workgroups of the launch, folded so that no dimension exceeds 65535.
    groups_x: u32,
    groups_y: u32,
    groups_z: u32,
}
