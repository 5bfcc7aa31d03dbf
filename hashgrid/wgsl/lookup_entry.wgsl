// The cell that the vertex falls into with the jitter of `salt`; count 0 where there is none.
fn hg_lookup_vertex(vertex: HcVertexRecord, salt: u32) -> HgCell {
    let key = hg_key(hg_params, vertex, salt);
    if key.attributes == HG_NO_KEY {
        return HgCell();
    }
    let slot = hg_home(key) & hg_mask();
    let found = hg_find_from(slot, hg_fingerprint(key), hg_head(slot));
    hg_count(HC_PROBES, found.probes);
    if found.slot == HG_NO_SLOT {
        return HgCell();
    }
    return hg_cell(found.slot);
}

fn hg_finite(value: vec4<f32>) -> vec4<f32> {
    var finite = vec4<f32>();
    for (var k = 0u; k < 3u; k++) {
        if (bitcast<u32>(value[k]) & 0x7fffffffu) < 0x7f800000u {
            finite[k] = value[k];
        } else {
            hg_count(HC_NON_FINITE, 1u);
            hc_raise(2u); // Status::NON_FINITE
        }
    }
    return finite;
}

fn hg_estimate_vertex(vertex: HcVertexRecord) -> HcEstimateRecord {
    var cell = HgCell();
    if (vertex.flags & HC_VALID) != 0u {
        hg_count(HC_LOOKUPS, 1u);
        cell = hg_lookup_vertex(vertex, HG_SALT_LOOKUP);
        if cell.count == 0u {
            cell = hg_lookup_vertex(vertex, HG_SALT_DEPOSIT);
        }
        hg_count(select(HC_HITS, HC_FALLBACKS, cell.count == 0u), 1u);
    }
    if cell.count == 0u {
        return HcEstimateRecord(hg_finite(vertex.direct), hg_finite(vertex.further));
    }
    let q = hg_params.quantum;
    let n = cell.count;
    return HcEstimateRecord(
        vec4<f32>(hc_mean(q, cell.direct[0], n), hc_mean(q, cell.direct[1], n), hc_mean(q, cell.direct[2], n), f32(n)),
        vec4<f32>(hc_mean(q, cell.further[0], n), hc_mean(q, cell.further[1], n), hc_mean(q, cell.further[2], n), 0.0),
    );
}

@compute @workgroup_size(64)
fn hg_lookup_main(
    @builtin(global_invocation_id) gid: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = hc_item(gid, groups);
    if item < hc_launch.count {
        hg_estimates[item] = hg_estimate_vertex(hg_vertices[item]);
    }
    hg_add_counters(lane);
}
