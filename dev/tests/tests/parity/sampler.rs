//! The integers behind the sampler.

use hashcache_dev_tests::gpu;
use hashcache_dev_tests::harness::{Item, call, expect, inputs};
use pt_integrator::sampler;

/// Equal bits for all inputs.
fn tier_0<const N: usize>(name: &'static str, body: &str, twin: impl Fn(&Item) -> [u32; N]) {
    let Some(mut backend) = gpu::backend() else { return };
    let items = inputs();
    let modules = [hashcache_core::wgsl::HASH, include_str!("../../../../pt-integrator/wgsl/sampler.wgsl")];
    let found = call(&mut backend, name, &modules, body, &items);
    for (item, (e, f)) in items.iter().zip(expect(&items, twin).iter().zip(&found)) {
        assert!(e == f, "{name}({item:x?}): {e:x?} in Rust, {f:x?} in WGSL");
    }
}

#[test]
fn points_and_seeds() {
    tier_0("pt_laine_karras", "put(0u, pt_laine_karras(word(0u), word(1u)));", |i| [sampler::laine_karras(i[0], i[1])]);
    tier_0("pt_nested_uniform_scramble", "put(0u, pt_nested_uniform_scramble(word(0u), word(1u)));", |i| {
        [sampler::nested_uniform_scramble(i[0], i[1])]
    });
    tier_0("pt_sobol_second", "put(0u, pt_sobol_second(word(0u)));", |i| [sampler::sobol_second(i[0])]);
    tier_0("pt_sobol_point", "put2(0u, pt_sobol_point(word(0u), word(1u), word(2u)));", |i| {
        sampler::sobol_point(i[0], i[1], i[2])
    });
    tier_0("pt_sobol_value", "put(0u, pt_sobol_value(word(0u), word(1u), word(2u)));", |i| {
        [sampler::sobol_value(i[0], i[1], i[2])]
    });
    tier_0("pt_pixel_seed", "put(0u, pt_pixel_seed(word(0u), word(1u)));", |i| [sampler::pixel_seed(i[0], i[1])]);
    tier_0("pt_vertex_seed", "put(0u, pt_vertex_seed(word(0u), word(1u)));", |i| [sampler::vertex_seed(i[0], i[1])]);
}
