@compute @workgroup_size(64)
fn hg_claim_main(@builtin(global_invocation_id) gid: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = hc_item(gid, groups);
    if item >= hc_launch.count || (hg_vertices[item].flags & (HC_VALID | HC_VISIBLE_ONLY)) != HC_VALID {
        return;
    }
    let key = hg_key(hg_params, hg_vertices[item], HG_SALT_DEPOSIT);
    if key.attributes == HG_NO_KEY {
        return;
    }
    let slot = hg_home(key) & hg_mask();
    if hg_claim_from(slot, hg_fingerprint(key), hg_head(slot)) == HG_CLAIM_REFUSED {
        hc_raise(1u); // Status::TABLE_FULL
    }
}
