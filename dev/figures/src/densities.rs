//! Cells and bytes by level (as table 1 of Roth et al. 2020).

use crate::arguments::Arguments;
use crate::subject::{ALL, Subject};
use crate::table;

/// The octree's levels for each scene at a resolution of 2048, finest first.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    println!("{}\n", arguments.changed());
    table::head(&["scene", "resolution", "cells", "density", "data bytes a cell", "hash bytes a cell", "MiB"]);
    for name in arguments.scenes(&ALL) {
        let subject = Subject::read(&name)?;
        let preview = subject.open(&arguments.settings(&[("cache", "octree"), ("octree.resolution", "2048")])?)?;
        let say = |error: hashcache::Error| error.to_string();
        let mut backend = preview.backend().map_err(say)?;
        let stats = preview.session(&mut backend).map_err(say)?.stats().map_err(say)?;
        for level in stats.cache.ok_or("the settings name no cache")?.levels {
            let each = |bytes: u64| format!("{:.2}", bytes as f64 / level.cells.max(1) as f64);
            table::row(&[
                name.clone(),
                level.resolution.to_string(),
                level.cells.to_string(),
                format!("{:.3e}", level.density),
                each(level.data_bytes),
                each(level.hash_bytes),
                format!("{:.2}", (level.data_bytes + level.hash_bytes) as f64 / f64::from(1 << 20)),
            ]);
        }
    }
    Ok(())
}
