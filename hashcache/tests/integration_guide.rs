//! INTEGRATION.md says what frames do: the buffers and passes of its tables are those of frames that are run here.

mod common;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;
use std::sync::LazyLock;

use backend_api::{Access, Binding, BufferDesc, BufferId, Kernel};
use common::{Watch, Watched};
use hashcache::choice::{CacheKind, DirectLight, FilterKind};
use hashcache::{CacheStats, Preview, Settings, Stats};
use hashcache_core::octree::kernels::REKEY;

const GUIDE: &str = include_str!("../../INTEGRATION.md");

/// What the guide calls by name: does not compile when one of them is called otherwise.
#[expect(unused_imports, reason = "names, not uses")]
mod names {
    use backend_cpu::rays::CpuScene;
    use hashcache::Session;
    use hashcache_core::counters::Counters;
    use hashcache_core::exact::{MAX_DEPOSITS, Quantum, quantize};
    use hashcache_core::octree::{ExactCell, OctreeCache, OctreeSettings, OctreeStages, Sample, build};
    use hashcache_core::record::VertexRecord;
    use hashcache_core::stages::{CacheStages, EstimateRecord};
    use hashcache_core::traits::{RadianceCache, RayCaster};
    use hashgrid::kernels::WGSL_KEY;
    use hashgrid::merge::Merge;
    use hashgrid::temporal::Rule;
    use hashgrid::validate::Summary;
    use hashgrid::{GridStages, OwnedGrid, Table, Word, levels, names, points, vertex};
    use layered_filter::kernels::FilterCounters;
    use layered_filter::{
        Behind, Denoiser, FilterStages, FrontPixel, LayerPixel, Light, NoisePixel, PreparedGuide, filter,
    };
    use pt_integrator::path::{RayCounts, trace_path_vertices};
}

/// Notes what a backend is asked for.
#[derive(Default)]
struct Noted {
    /// Name and bytes of each buffer.
    buffers: HashMap<BufferId, BufferDesc>,
    /// Bytes by name of all buffers made and not given back.
    bytes: BTreeMap<&'static str, u64>,
    /// Kernels in the order of their first use, with the buffers that they read and write.
    passes: Vec<(&'static str, Uses)>,
}

/// Names of buffers that a kernel reads, and of those that it writes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Uses {
    reads: BTreeSet<String>,
    writes: BTreeSet<String>,
}

impl Watch for Noted {
    fn created(&mut self, buffer: BufferId, desc: &BufferDesc) {
        self.buffers.insert(buffer, *desc);
        *self.bytes.entry(desc.name).or_default() += desc.size;
    }

    fn destroyed(&mut self, buffer: BufferId) {
        let BufferDesc { name, size } = self.buffers[&buffer];
        *self.bytes.get_mut(name).unwrap() -= size;
    }

    fn dispatched(&mut self, kernel: &'static Kernel, bindings: &[Binding]) {
        let at = self.passes.iter().position(|(name, _)| *name == kernel.name).unwrap_or(self.passes.len());
        if at == self.passes.len() {
            self.passes.push((kernel.name, Uses::default()));
        }
        for (decl, binding) in kernel.bindings.iter().zip(bindings) {
            let uses = &mut self.passes[at].1;
            let names = if decl.access == Access::In { &mut uses.reads } else { &mut uses.writes };
            names.insert(self.buffers[&binding.buffer].name.to_owned());
        }
    }
}

/// A frame of a built-in scene: what the backend was asked for, the figures, and what the guide's letters stand for.
struct Frame {
    bytes: BTreeMap<&'static str, u64>,
    passes: Vec<(&'static str, Uses)>,
    stats: Stats,
    letters: BTreeMap<&'static str, u64>,
}

fn frame(scene: &str, set: &[(&str, &str)]) -> Frame {
    let mut settings = Settings::default();
    for (key, value) in set {
        settings.set(key, value).unwrap();
    }
    let preview = Preview::open(scene, &settings).unwrap();
    let mut backend = Watched::new(Noted::default());
    let stats = preview.render_on(&mut backend, &mut |_| ()).unwrap().stats;
    let letters = letters(&preview, &stats);
    Frame { bytes: backend.watch.bytes, passes: backend.watch.passes, stats, letters }
}

/// What the letters of the guide's formulas stand for.
fn letters(preview: &Preview, stats: &Stats) -> BTreeMap<&'static str, u64> {
    let (settings, plan, (width, height)) = (preview.settings(), preview.plan(), preview.size());
    let batch = 1_u64 << 19;
    let side = |side: u32| (f64::from(side) * f64::from(settings.crf)).round() as u64;
    let (pixels, paths, store) = (u64::from(width * height), side(width) * side(height), u64::from(settings.store));
    let layers = u64::from(plan.layers);
    let shown = plan.cache == CacheKind::None || plan.reuses_paths;
    let of = |kind: &str| stats.cache.as_ref().filter(|cache| cache.kind == kind);
    let fronts = match settings.filter {
        FilterKind::Screen => u64::from(layers > 1),
        _ if plan.needs.rough_lobes => layers - 1,
        _ => 0,
    };
    BTreeMap::from([
        ("P", pixels),
        // A batch of paths is a multiple of 16.
        ("R", store * if shown { paths } else { paths.min((batch / store) & !15) }),
        ("l", layers),
        ("V", (pixels * layers).min(batch)),
        ("f", fronts),
        ("A", if settings.direct == DirectLight::Traced { pixels } else { 1 }),
        ("S", of("grid").map_or(0, |cache| cache.bytes / 64)),
        ("C", of("octree").map_or(0, |cache| cache.cells)),
        ("O", of("octree").map_or(0, |cache| (cache.bytes - 48 * cache.cells) / 4)),
        ("F", (paths * store).max(1 << 16)),
    ])
}

/// Frames that between them have every buffer and pass.
static FRAMES: LazyLock<Vec<Frame>> = LazyLock::new(|| {
    let small = ("size", "64x48");
    let grid = ("cache", "grid");
    let sets: [(&str, &[_]); 9] = [
        ("builtin:cornell", &[small]),
        ("builtin:cornell", &[small, grid]),
        ("builtin:cornell", &[small, grid, ("cache.store", "3")]),
        ("builtin:cornell", &[small, ("cache", "none")]),
        ("builtin:cornell", &[small, ("cache", "none"), ("filter", "none")]),
        ("builtin:cornell", &[small, ("cache.direct", "traced"), ("cache.crf", "0.5")]),
        ("builtin:interior", &[small]),
        ("builtin:interior", &[small, ("filter", "screen")]),
        // More records and more looks than a batch has.
        ("builtin:interior", &[("size", "480x300"), grid, ("cache.store", "4"), ("max_bounces", "2")]),
    ];
    sets.iter().map(|(scene, set)| frame(scene, set)).collect()
});

/// The rows of the guide's table whose header begins with `head`: cells without white space around.
fn table(head: &str) -> Vec<Vec<&'static str>> {
    let rows =
        GUIDE.lines().skip_while(|line| !line.starts_with(head)).skip(2).take_while(|line| line.starts_with('|'));
    let rows: Vec<Vec<_>> = rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect()).collect();
    assert!(!rows.is_empty(), "no table {head}");
    rows
}

/// What stands in backticks.
fn quoted(text: &'static str) -> impl Iterator<Item = &'static str> {
    text.split('`').skip(1).step_by(2)
}

/// The value of a sum of products of numbers and letters; `None` for words.
fn value(formula: &str, letters: &BTreeMap<&'static str, u64>) -> Option<u64> {
    let factor = |factor: &str| factor.parse().ok().or_else(|| letters.get(factor).copied());
    let product = |product: &str| product.split('·').map(|text| factor(text.trim())).product::<Option<u64>>();
    formula.split(',').next().unwrap_or_default().split('+').map(product).sum()
}

#[test]
fn buffers_are_those_of_the_guide() {
    let rows: BTreeMap<_, _> = table("| buffer |")
        .into_iter()
        .flat_map(|row| quoted(row[0]).map(move |name| (name, [row[1], row[2]])))
        .collect();
    let mut seen = BTreeSet::new();
    for Frame { bytes, letters, .. } in FRAMES.iter() {
        for (name, bytes) in bytes.iter().filter(|(_, bytes)| **bytes > 0) {
            let [element, count] = rows.get(name).unwrap_or_else(|| panic!("{name} is not in the guide"));
            let element: u64 = element.parse().unwrap();
            match value(count, letters) {
                Some(count) => assert_eq!(*bytes, element * count, "{name}, {letters:?}"),
                None => assert_eq!(bytes % element, 0, "{name}"),
            }
            seen.insert(*name);
        }
    }
    let listed: BTreeSet<_> = rows.into_keys().collect();
    assert_eq!(listed, seen);
}

#[test]
fn passes_are_those_of_the_guide() {
    let names = |cell| quoted(cell).map(str::to_owned).collect();
    let uses = |row: &[_]| Uses { reads: names(row[3]), writes: names(row[4]) };
    let rows: BTreeMap<_, _> =
        table("| stage |").iter().map(|row| (quoted(row[1]).next().unwrap(), uses(row))).collect();
    let mut seen = BTreeMap::<_, Uses>::new();
    // Asked for beside a frame: which octree suits the camera, and how noisy the picture is.
    let beside = |uses: &Uses| ["probe", "noise"].iter().any(|name| uses.writes.contains(*name));
    for (name, uses) in FRAMES.iter().flat_map(|frame| &frame.passes).filter(|(_, uses)| !beside(uses)) {
        let name = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        let all = seen.entry(name).or_default();
        all.reads.extend(uses.reads.iter().cloned());
        all.writes.extend(uses.writes.iter().cloned());
    }
    // Only finer octrees than a test builds have it; its declaration tells what it binds.
    let part = |reads: bool| {
        let of = REKEY.bindings.iter().filter(|decl| (decl.access == Access::In) == reads);
        of.map(|decl| decl.name.replace("hc_", "octree.")).collect()
    };
    seen.insert(REKEY.name, Uses { reads: part(true), writes: part(false) });
    let other: Vec<_> = seen.iter().filter(|(name, uses)| rows.get(**name) != Some(uses)).collect();
    assert!(other.is_empty(), "not as in the guide: {other:#?}");
    assert_eq!(rows.len(), seen.len());
}

#[test]
fn the_worked_example_is_what_a_frame_takes() {
    let start = GUIDE.find("Worked example").expect("an example");
    let example = GUIDE[start..].split("\n\n").next().unwrap().replace('\n', " ").replace(',', "");
    let of_scene = ["triangles", "scene", "texels", "ray counters"];
    let megabytes = |bytes: u64| format!("{:.1} MB", bytes as f64 * 1e-6);
    for cache in ["octree", "grid"] {
        let Frame { bytes, stats, .. } =
            frame("builtin:cornell", &[("size", "512x512"), ("cache", cache), ("spp", "1")]);
        let total = bytes.iter().filter(|(name, _)| !of_scene.contains(name)).map(|(_, bytes)| bytes).sum();
        let own = stats.cache.unwrap();
        for figure in [megabytes(total), megabytes(own.bytes)] {
            assert!(example.contains(&figure), "{cache}: {figure} is not in: {example}");
        }
        is_healthy(&own);
        assert!(cache == "grid" || example.contains(&format!("{} cells", own.cells)), "{} cells", own.cells);
    }
}

/// Whether a cache's figures are in the guide's ranges.
fn is_healthy(cache: &CacheStats) {
    let energy = cache.energy;
    assert!(cache.hits as f64 > 0.98 * cache.lookups as f64, "{cache:?}");
    assert!(energy.lost < 1e-4 * energy.recorded && cache.insert_failures + cache.non_finite == 0, "{cache:?}");
    assert!((energy.recorded - energy.stored - energy.lost).abs() <= 1e-12 * energy.recorded, "{cache:?}");
    let (probes, bytes) = if cache.kind == "grid" { (1.0..2.0, 128.0..f64::MAX) } else { (3.0..4.0, 49.0..52.0) };
    assert!(probes.contains(&cache.mean_probes) && bytes.contains(&cache.bytes_per_cell), "{cache:?}");
}

#[test]
fn files_that_the_guide_names_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let files: Vec<_> = GUIDE
        .lines()
        .flat_map(quoted)
        .filter(|name| name.split_once('.').is_some_and(|(_, end)| end == "rs"))
        .collect();
    assert!(files.len() > 5 && files.iter().all(|file| root.join(file).is_file()), "{files:?}");
}

#[test]
fn names_with_dots_are_figures_settings_buffers_or_passes() {
    let stats = frame("builtin:cornell", &[("size", "32x32"), ("check.fraction", "1")]).stats;
    let stats = serde_json::to_value(stats).unwrap();
    let settings = Settings::keys();
    let known: BTreeSet<_> =
        table("| stage |").into_iter().chain(table("| buffer |")).flatten().flat_map(quoted).collect();
    let is_key = |text: &&str| text.contains('.') && text.chars().all(|c| c.is_ascii_lowercase() || "._".contains(c));
    let (mut figures, mut unknown) = (0, Vec::new());
    for name in GUIDE.lines().flat_map(quoted).filter(is_key) {
        let figure = stats.pointer(&format!("/{}", name.replace('.', "/"))).is_some();
        figures += u32::from(figure);
        if !figure && !settings.contains(&name) && !known.contains(name) && name != "lf.atrous" {
            unknown.push(name);
        }
    }
    assert!(unknown.is_empty() && figures > 10, "{figures} figures; unknown: {unknown:?}");
}
