// The words of an octree: header, records, tables. Replace it to embed the functions elsewhere.
@group(0) @binding(0) var<storage, read> hc_octree: array<u32>;
