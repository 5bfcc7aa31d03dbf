fn hg_deposit_vertex(vertex: HcVertexRecord) {
    hg_count(HC_DEPOSITS, 1u);
    let key = hg_key(hg_params, vertex, HG_SALT_DEPOSIT);
    var found = HgFound(HG_NO_SLOT, 0u, vec2<u32>());
    if key.attributes != HG_NO_KEY {
        let slot = hg_home(key) & hg_mask();
        found = hg_find_from(slot, hg_fingerprint(key), hg_head(slot));
    }
    hg_count(HC_PROBES, found.probes);
    let stored = found.slot != HG_NO_SLOT && !hg_is_full(found);

    var values: array<vec2<u32>, 6>;
    for (var k = 0u; k < 6u; k++) {
        var channel = vertex.direct[k % 3u];
        if k >= 3u {
            channel = vertex.further[k % 3u];
        }
        let quantized = hc_quantize(hg_params.quantum, channel);
        values[k] = quantized.value;
        hg_note(quantized, stored);
        if quantized.outcome == HC_OUTCOME_NON_FINITE {
            hc_raise(2u); // Status::NON_FINITE
        }
    }
    if stored {
        hg_add(found.slot, found.head, values, 1u);
        return;
    }
    hg_count(HC_REFUSALS, 1u);
    if found.slot != HG_NO_SLOT {
        hg_count(HC_OVERFLOWED, 1u);
        hc_raise(4u); // Status::OVERFLOW
    }
}

@compute @workgroup_size(64)
fn hg_deposit_main(
    @builtin(global_invocation_id) gid: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let item = hc_item(gid, groups);
    if item < hc_launch.count && (hg_vertices[item].flags & (HC_VALID | HC_VISIBLE_ONLY)) == HC_VALID {
        hg_deposit_vertex(hg_vertices[item]);
    }
    hg_add_counters(lane);
}
