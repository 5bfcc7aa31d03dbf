//! Runs of pixels whose records fit one binding.

use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;

/// Vertex records of one batch: 2¹⁹ · 96 bytes stay below 64 MiB and below every device's binding limit.
pub(crate) const BATCH: u32 = 1 << 19;

/// Pixels (or paths) of a batch with so many records each: a multiple of 16, so that the sums of a batch's pixels, 128
/// bytes or 48, begin at a multiple of 256 bytes.
pub(super) const fn at_once(each: u32) -> u32 {
    (BATCH / each) & !15
}

/// Records that there is room for when pixels are only looked at, `layers` each.
pub(super) fn looks(pixels: u32, layers: u32) -> u32 {
    pixels.saturating_mul(layers).min(BATCH)
}

/// Bytes of the records of pixels that are only looked at, and of their estimates.
pub(crate) fn look_bytes(pixels: u32, layers: u32) -> u64 {
    u64::from(looks(pixels, layers)) * (size_of::<VertexRecord>() + size_of::<EstimateRecord>()) as u64
}

#[cfg(test)]
mod tests {
    use layered_filter::{FrontPixel, LayerPixel, MAX_LAYERS};

    use super::*;
    use crate::settings::MAX_STORE;

    #[test]
    fn batches_of_every_size_begin_where_bindings_may() {
        for each in 1..=MAX_LAYERS.max(MAX_STORE) {
            let pixels = at_once(each) as usize;
            assert!(pixels > 0 && pixels * each as usize <= BATCH as usize, "{each} records each");
            for stride in [size_of::<LayerPixel>(), size_of::<FrontPixel>()] {
                assert_eq!(pixels * stride % 256, 0, "{each} records each, sums of {stride} bytes");
            }
        }
    }
}
