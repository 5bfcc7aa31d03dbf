//! What a vertex pays for its material: resolve it, choose a lobe, evaluate it for a light, draw a direction. Beside
//! Lambert's share of the same: a cosine and a direction by the cosine.
#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

#[path = "../tests/common/bsdfs.rs"]
mod bsdfs;

use std::hint::black_box;

use bsdfs::{NORMAL, at_cosine, coated, glass, glossy, metal, pane};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use hashcache_core::traits::Sampler;
use pt_integrator::bsdf::{Bsdf, BsdfInputs};
use pt_integrator::glam::{Vec2, Vec3};
use pt_integrator::sampler::Independent;
use pt_integrator::sampling::{Basis, cosine_pdf, sample_cosine};

const VERTICES: u32 = 1024;

/// A view, a light and two numbers for each vertex.
fn vertices() -> Vec<(Vec3, Vec3, f32, Vec2)> {
    (0..VERTICES)
        .map(|i| {
            let mut draw = Independent::new(i, 5);
            let local = sample_cosine(draw.next_2d());
            let light = Basis::new(NORMAL).to_scene(local.truncate(), local.z);
            (at_cosine(draw.next_1d()), light, draw.next_1d(), draw.next_2d())
        })
        .collect()
}

fn lobes(c: &mut Criterion) {
    let vertices = vertices();
    let mut group = c.benchmark_group("pt-integrator/lobes");
    group.throughput(Throughput::Elements(u64::from(VERTICES)));
    group.bench_function("cosine", |b| {
        b.iter(|| {
            vertices.iter().fold(Vec3::ZERO, |sum, &(_, light, _, u)| {
                let normal = black_box(NORMAL);
                let evaluated = cosine_pdf(normal.dot(light));
                let local = sample_cosine(u);
                let drawn = Basis::new(normal).to_scene(local.truncate(), local.z);
                sum + evaluated + drawn * cosine_pdf(local.z)
            })
        });
    });
    let kinds: [(&str, BsdfInputs); 9] = [
        ("lambert", BsdfInputs::lambert(Vec3::splat(0.5))),
        ("mirror", metal(0.0)),
        ("metal", metal(0.4)),
        ("dielectric", glossy(0.4)),
        ("smooth-glass", glass(0.0, 1.5)),
        ("rough-glass", glass(0.4, 1.5)),
        ("smooth-pane", pane(0.0, 1.5)),
        ("rough-pane", pane(0.4, 1.5)),
        ("coated", coated(glossy(0.4), 0.1)),
    ];
    for (name, inputs) in kinds {
        group.bench_function(name, |b| {
            b.iter(|| {
                vertices.iter().fold(Vec3::ZERO, |sum, &(view, light, chance, u)| {
                    let bsdf = Bsdf::new(&black_box(inputs), NORMAL, view, true);
                    let pick = bsdf.pick(chance);
                    let (value, pdf) = bsdf.eval_pdf(pick.lobe, light);
                    let drawn = bsdf.sample(pick.lobe, u).map_or(Vec3::ZERO, |s| s.incoming * s.weight);
                    sum + value * pdf + drawn / pick.probability
                })
            });
        });
    }
    group.finish();
}

criterion_group!(benches, lobes);
criterion_main!(benches);
