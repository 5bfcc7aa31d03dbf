//! The WGSL beside this crate is valid, and each of its functions has a Rust function of the same name and arity.

use hashcache_core::wgsl::HASH;
use pt_integrator::sampler;
use pt_integrator::wgsl::SAMPLER;

/// Name and number of parameters of the Rust functions; the casts fail to compile when an arity changes.
fn twins() -> Vec<(&'static str, usize)> {
    let _: fn(u32, u32) -> u32 = sampler::laine_karras;
    let _: fn(u32, u32) -> u32 = sampler::nested_uniform_scramble;
    let _: fn(u32) -> u32 = sampler::sobol_second;
    let _: fn(u32, u32, u32) -> [u32; 2] = sampler::sobol_point;
    let _: fn(u32, u32, u32) -> u32 = sampler::sobol_value;
    let _: fn(u32, u32) -> u32 = sampler::pixel_seed;
    let _: fn(u32, u32) -> u32 = sampler::vertex_seed;
    vec![
        ("laine_karras", 2),
        ("nested_uniform_scramble", 2),
        ("sobol_second", 1),
        ("sobol_point", 3),
        ("sobol_value", 3),
        ("pixel_seed", 2),
        ("vertex_seed", 2),
    ]
}

#[test]
fn sampler_wgsl_is_valid_and_complete() {
    let module = naga::front::wgsl::parse_str(&[HASH, SAMPLER].concat()).expect("the module parses");
    naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&module)
        .expect("the module is valid");
    let mut found: Vec<(String, usize)> = module
        .functions
        .iter()
        .filter_map(|(_, f)| Some((f.name.as_ref()?.strip_prefix("pt_")?.to_owned(), f.arguments.len())))
        .collect();
    let mut expected: Vec<(String, usize)> = twins().into_iter().map(|(n, a)| (n.to_owned(), a)).collect();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
}
