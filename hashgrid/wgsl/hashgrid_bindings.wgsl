// The buffers of this crate's kernels; an embedder puts its own globals of these names here.

@group(0) @binding(0) var<storage, read_write> hg_table: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read> hg_vertices: array<HcVertexRecord>;
@group(0) @binding(2) var<storage, read_write> hg_counters: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> hg_estimates: array<HcEstimateRecord>;
@group(0) @binding(14) var<uniform> hg_params: HgParams;
