//! Rays a second against a million triangles, on one thread, beside obvhs' compressed eight-wide hierarchy.
//!
//! `cargo bench -p hashcache-backend-cpu --bench rays`; an element is a ray. The rays are those of the check figures.
//! Rows `…/mask_elsewhere` add one triangle with a hole that no ray meets: what the code for masks costs triangles without.
//! Rows `…/lace` give half of the triangles a chequered mask.

#[path = "../tests/rays_mesh/mod.rs"]
mod rays_mesh;

use std::hint::black_box;
use std::time::Duration;

use backend_cpu::rays::CpuScene;
use criterion::{Bencher, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3A;
use hashcache_core::geometry::{Geometry, Opacity, OpacityMask, Ray};
use hashcache_core::traits::RayCaster;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as BvhRay, RayHit};
use obvhs::triangle::Triangle;
use rays_mesh::{Blob, Rays};

/// The hierarchy and triangle test of obvhs, as its documentation shows them.
struct Baseline {
    tree: CwBvh,
    triangles: Vec<Triangle>,
}

impl Baseline {
    fn new(blob: &Blob) -> Self {
        let corner = |i: u32| Vec3A::from(blob.positions[i as usize]);
        let triangle = |t: &[u32; 3]| Triangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) };
        let triangles: Vec<Triangle> = blob.indices.iter().map(triangle).collect();
        let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
        let tree = build_cwbvh_from_tris(&triangles, params, &mut Duration::default());
        let triangles = tree.primitive_indices.iter().map(|&i| triangles[i as usize]).collect();
        Self { tree, triangles }
    }

    fn closest(&self, ray: &Ray) -> f32 {
        let mut hit = RayHit::none();
        self.tree.ray_traverse(converted(ray), &mut hit, |r, id| self.triangles[id].intersect(r));
        hit.t
    }

    fn occluded(&self, ray: &Ray) -> bool {
        !self.tree.ray_traverse_miss(converted(ray), |r, id| self.triangles[id].intersect(r))
    }
}

fn converted(ray: &Ray) -> BvhRay {
    BvhRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

/// Times `cast` for all rays, one after the other.
fn each<T>(b: &mut Bencher<'_>, rays: &[Ray], cast: impl Fn(&Ray) -> T) {
    b.iter(|| {
        for ray in rays {
            black_box(cast(black_box(ray)));
        }
    });
}

/// The blob with a mask for every triangle that `has_mask` names.
fn masked(blob: &Blob, has_mask: impl Fn(usize) -> bool) -> CpuScene {
    const CHEQUERS: OpacityMask = OpacityMask {
        first_alpha: 0,
        width: 2,
        height: 2,
        wrap: 0,
        uv_rows: OpacityMask::IDENTITY,
        cutoff: 0.5,
        factor: 1.0,
        reserved: [0; 2],
    };
    let count = blob.indices.len();
    let opacity = Opacity {
        mask_of_triangle: &(0..count).map(|i| if has_mask(i) { 0 } else { Opacity::NO_MASK }).collect::<Vec<_>>(),
        masks: &[CHEQUERS],
        uv: &vec![[[0.0, 0.0], [1.5, 0.0], [0.0, 1.5]]; count],
        alpha: &[255, 0, 0, 255],
    };
    CpuScene::build(&Geometry { opacity, ..blob.geometry() }).expect("the blob is a valid mesh")
}

fn rays(c: &mut Criterion) {
    let blob = Blob::new(512, 1024);
    let scene = CpuScene::build(&blob.geometry()).expect("the blob is a valid mesh");
    println!("{:?}", scene.stats());
    // The last triangle is at the blob's pole, which no ray of these meets.
    let [elsewhere, lace] = [masked(&blob, |i| i + 1 == blob.indices.len()), masked(&blob, |i| i % 2 == 0)];
    println!("lace: {:?}", lace.stats());
    let baseline = Baseline::new(&blob);
    let rays = Rays::new(&blob, &scene, 256);
    let count = |rays: &[Ray]| rays.iter().filter(|r| scene.closest(r).is_some()).count();
    let same =
        |rays: &[Ray]| rays.iter().filter(|r| scene.closest(r).is_some() == baseline.closest(r).is_finite()).count();
    for (kind, rays) in [("primary", &rays.primary), ("diffuse", &rays.diffuse)] {
        println!("{kind}: {} of {} rays hit, {} agree with obvhs", count(rays), rays.len(), same(rays));
    }
    let mut group = c.benchmark_group("backend-cpu/rays");
    group.sample_size(10);
    for (kind, rays) in [("primary", &rays.primary), ("diffuse", &rays.diffuse)] {
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(format!("{kind}/wide"), |b| each(b, rays, |r| scene.closest(r)));
        group.bench_function(format!("{kind}/obvhs"), |b| each(b, rays, |r| baseline.closest(r)));
        group.bench_function(format!("{kind}/mask_elsewhere"), |b| each(b, rays, |r| elsewhere.closest(r)));
        group.bench_function(format!("{kind}/lace"), |b| each(b, rays, |r| lace.closest(r)));
    }
    for (kind, rays) in [("shadow", &rays.shadow), ("occlusion", &rays.ambient)] {
        group.throughput(Throughput::Elements(rays.len() as u64));
        group.bench_function(format!("{kind}/wide"), |b| each(b, rays, |r| scene.occluded(r)));
        group.bench_function(format!("{kind}/obvhs"), |b| each(b, rays, |r| baseline.occluded(r)));
        group.bench_function(format!("{kind}/mask_elsewhere"), |b| each(b, rays, |r| elsewhere.occluded(r)));
        group.bench_function(format!("{kind}/lace"), |b| each(b, rays, |r| lace.occluded(r)));
    }
    group.finish();
    let mut build = c.benchmark_group("backend-cpu/rays/build");
    build.sample_size(10).throughput(Throughput::Elements(blob.indices.len() as u64));
    build.bench_function("wide", |b| b.iter(|| CpuScene::build(&blob.geometry())));
    build.bench_function("obvhs", |b| b.iter(|| Baseline::new(&blob).triangles.len()));
    build.finish();
}

criterion_group!(benches, rays);
criterion_main!(benches);
