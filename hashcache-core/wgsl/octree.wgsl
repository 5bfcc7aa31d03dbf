// Which cells an octree stores, and their indices. Twins: hashcache_core::octree. Needs hash and the global hc_octree.

// Words of the header, of a level's record, of a map's record.
const HC_HEADER_WORDS: u32 = 16u;
const HC_LEVEL_WORDS: u32 = 8u;
const HC_MAP_WORDS: u32 = 4u;
const HC_BUCKET_ENTRIES: u32 = 4u;
const HC_BUCKET_WORDS: u32 = 12u;
// Rust's `None`.
const HC_NO_CELL: u32 = 0xffffffffu;

struct HcGrid {
    origin: vec3<f32>,
    recip_cell: f32,
    resolution: u32,
    levels: u32,
}

struct HcBlockEntry {
    occupancy: u32,
    base: u32,
}

// High word of a product, from products of halves.
fn hc_multiply_high(a: u32, b: u32) -> u32 {
    let low = (a & 0xffffu) * (b & 0xffffu);
    let cross = (a >> 16u) * (b & 0xffffu) + (low >> 16u);
    let other = (a & 0xffffu) * (b >> 16u) + (cross & 0xffffu);
    return (a >> 16u) * (b >> 16u) + (cross >> 16u) + (other >> 16u);
}

fn hc_cell_bit(coordinates: vec3<u32>) -> u32 {
    return 1u << ((coordinates.x & 3u) | ((coordinates.y & 3u) << 2u) | ((coordinates.z & 1u) << 4u));
}

fn hc_block_key(block: vec3<u32>) -> u32 {
    return (block.x & 1023u) | ((block.y & 1023u) << 10u) | ((block.z & 2047u) << 20u);
}

fn hc_bucket_pair(key: u32, seed: u32, buckets: u32) -> vec2<u32> {
    let h = hc_pcg2d(vec2<u32>(key, seed));
    return vec2<u32>(hc_multiply_high(h.x, buckets), hc_multiply_high(h.y, buckets));
}

// The position of a cell's block, in blocks from the level's corner; below the corner it wraps to large numbers.
fn hc_relative_block(coordinates: vec3<u32>, corner: vec3<u32>) -> vec3<u32> {
    return (coordinates - corner) >> vec3<u32>(2u, 2u, 1u);
}

// The map of a block within its level; HC_NO_CELL beyond the last.
fn hc_map_of(block: vec3<u32>, maps_log2: u32) -> u32 {
    let at = block >> vec3<u32>(10u, 10u, 11u);
    if ((at.x | at.y | at.z) >> maps_log2) != 0u {
        return HC_NO_CELL;
    }
    return at.x | (at.y << maps_log2) | (at.z << (2u * maps_log2));
}

fn hc_grid() -> HcGrid {
    return HcGrid(
        vec3<f32>(bitcast<f32>(hc_octree[4]), bitcast<f32>(hc_octree[5]), bitcast<f32>(hc_octree[6])),
        bitcast<f32>(hc_octree[8]),
        hc_octree[9],
        hc_octree[10],
    );
}

// Cells of a level along an edge of the root cube.
fn hc_side(level: u32) -> u32 {
    return (2u * hc_octree[9]) >> level;
}

// The cell of the finest level that holds the point; HC_NO_CELL in all components outside the cube and for NaN.
fn hc_coordinates(p: vec3<f32>) -> vec3<u32> {
    let grid = hc_grid();
    let q = (p - grid.origin) * grid.recip_cell;
    let side = f32(2u * grid.resolution);
    if all(q >= vec3<f32>(0.0)) && all(q < vec3<f32>(side)) {
        return vec3<u32>(q);
    }
    return vec3<u32>(HC_NO_CELL);
}

// Where the entry of a cell's block stands; HC_NO_CELL when there is none.
fn hc_place(level: u32, coordinates: vec3<u32>) -> u32 {
    let levels = hc_octree[10];
    if level >= levels {
        return HC_NO_CELL;
    }
    let record = HC_HEADER_WORDS + level * HC_LEVEL_WORDS;
    let corner = vec3<u32>(hc_octree[record], hc_octree[record + 1u], hc_octree[record + 2u]);
    let block = hc_relative_block(coordinates, corner);
    let of_level = hc_map_of(block, hc_octree[record + 3u]);
    if of_level == HC_NO_CELL {
        return HC_NO_CELL;
    }
    let map = HC_HEADER_WORDS + levels * HC_LEVEL_WORDS + (hc_octree[record + 4u] + of_level) * HC_MAP_WORDS;
    let buckets = hc_octree[map + 1u];
    if buckets == 0u {
        return HC_NO_CELL;
    }
    let key = hc_block_key(block);
    let pair = hc_bucket_pair(key, hc_octree[map + 2u], buckets);
    for (var k = 0u; k < 2u * HC_BUCKET_ENTRIES; k++) {
        let bucket = select(pair.x, pair.y, k >= HC_BUCKET_ENTRIES);
        let place = hc_octree[map] + bucket * HC_BUCKET_WORDS + k % HC_BUCKET_ENTRIES;
        if hc_octree[place] == key {
            return place;
        }
    }
    return HC_NO_CELL;
}

fn hc_entry(place: u32) -> HcBlockEntry {
    return HcBlockEntry(hc_octree[place + HC_BUCKET_ENTRIES], hc_octree[place + 2u * HC_BUCKET_ENTRIES]);
}

// Index of a cell, from its coordinates on its level; HC_NO_CELL where no geometry is.
fn hc_cell(level: u32, coordinates: vec3<u32>) -> u32 {
    let place = hc_place(level, coordinates);
    if place == HC_NO_CELL {
        return HC_NO_CELL;
    }
    let entry = hc_entry(place);
    let bit = hc_cell_bit(coordinates);
    if (entry.occupancy & bit) == 0u {
        return HC_NO_CELL;
    }
    return entry.base + countOneBits(entry.occupancy & (bit - 1u));
}
