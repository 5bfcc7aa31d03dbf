// Path vertices and estimates in buffers. Twins: hashcache_core::record::VertexRecord, stages::EstimateRecord.

// VertexRecord::VALID.
const HC_VALID: u32 = 1u;
// VertexRecord::SECONDARY.
const HC_SECONDARY: u32 = 2u;
// VertexRecord::VISIBLE_ONLY.
const HC_VISIBLE_ONLY: u32 = 4u;
// VertexRecord::GUIDE.
const HC_GUIDE: u32 = 8u;
// VertexRecord::LAYER_SHIFT, MAX_LAYER.
const HC_LAYER_SHIFT: u32 = 8u;
const HC_MAX_LAYER: u32 = 15u;

struct HcVertexRecord {
    position_footprint: vec4<f32>,
    direct: vec4<f32>,
    further: vec4<f32>,
    // w: shininess of the lobe by which the chain goes on.
    throughput: vec4<f32>,
    emitted: vec4<f32>,
    normal: u32,
    direction: u32,
    seed: u32,
    flags: u32,
}

struct HcEstimateRecord {
    direct: vec4<f32>,
    further: vec4<f32>,
}
