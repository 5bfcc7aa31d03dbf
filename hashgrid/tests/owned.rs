//! The owning grid keeps the law of its trait: the order of `record` has no influence.

use bytemuck::Zeroable;
use hashcache_core::record::VertexRecord;
use hashcache_core::traits::RadianceCache;
use hashgrid::{OwnedGrid, Params, Settings};

fn vertex(i: u32) -> VertexRecord {
    VertexRecord {
        position_footprint: [i as f32 * 0.003, 0.0, 0.0, 0.001],
        direct: [i as f32, 0.1, 0.0, 0.0],
        seed: i,
        flags: VertexRecord::VALID,
        ..VertexRecord::zeroed()
    }
}

#[test]
fn the_order_of_records_has_no_influence() {
    let grid = |order: &dyn Fn(u32) -> u32| {
        let params = Params::new(&Settings { max_probes: 4, ..Settings::default() }).unwrap();
        let mut grid = OwnedGrid::new(params, 64).unwrap();
        for frame in 0..3 {
            for i in 0..500 {
                grid.record(&vertex(order(i) + 100 * frame));
            }
            grid.end_frame();
        }
        (0..700).map(|i| grid.estimate(&vertex(i))).collect::<Vec<_>>()
    };
    let forward = grid(&|i| i);
    assert!(forward == grid(&|i| 499 - i));
    assert!(forward == grid(&|i| (i * 7) % 500));
    let answered = forward.iter().filter(|estimate| estimate.samples > 0).count();
    assert!(answered > 100 && answered < 700, "{answered}");
}

#[test]
fn estimates_change_at_the_end_of_a_frame_only() {
    let mut grid = OwnedGrid::new(Params::new(&Settings::default()).unwrap(), 64).unwrap();
    grid.record(&vertex(1));
    assert_eq!(grid.estimate(&vertex(1)).samples, 0);
    grid.end_frame();
    assert_eq!(grid.estimate(&vertex(1)).samples, 1);
    assert_eq!((grid.counters().fallbacks, grid.counters().hits), (1, 1));
    assert!(OwnedGrid::new(*grid.params(), 100).is_err());
    assert!(OwnedGrid::new(*grid.params(), usize::MAX).is_err());
}
