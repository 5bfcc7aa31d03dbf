//! The kernels' WGSL parses and validates together with a launcher's prelude, and its layouts are Rust's.

use backend_api::{Access, Kernel};
use hashcache_core::counters::Counters;
use hashcache_core::wgsl as hc;
use hashgrid::kernels::{CLAIM, CLEAR, DEPOSIT, LOOKUP, WGSL_KEY, WGSL_LOBE, WGSL_POINTS};
use hashgrid::{Key, Params, key, params, tag};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// What a launcher adds, in the shape that `backend_api::Kernel` describes.
const PRELUDE: &str = "
struct HcLaunch { count: u32 }
@group(0) @binding(13) var<uniform> hc_launch: HcLaunch;
@group(0) @binding(15) var<storage, read_write> hc_status: array<atomic<u32>>;
fn hc_raise(flags: u32) { atomicOr(&hc_status[0], flags); }
fn hc_item(gid: vec3<u32>, groups: vec3<u32>) -> u32 { return gid.x; }
";

static KERNELS: [&Kernel; 4] = [&CLEAR, &CLAIM, &DEPOSIT, &LOOKUP];

fn module(kernel: &Kernel) -> naga::Module {
    let source = [PRELUDE].iter().chain(kernel.wgsl.expect("has WGSL").modules).copied().collect::<String>();
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}: {}", kernel.name, error.emit_to_string(&source)));
    if let Err(error) = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module) {
        panic!("{}: {}", kernel.name, error.emit_to_string(&source));
    }
    module
}

#[test]
fn kernels_validate() {
    for kernel in KERNELS {
        let module = module(kernel);
        let wgsl = kernel.wgsl.unwrap();
        let entry = module.entry_points.iter().find(|entry| entry.name == wgsl.entry).expect("the entry point");
        assert_eq!(entry.workgroup_size, [wgsl.workgroup_size, 1, 1]);
    }
}

/// What no kernel uses yet stands on the keys alone.
#[test]
fn building_blocks_validate() {
    let keys = [hc::HASH, hc::JITTER, hc::PACK, hc::LEVEL, hc::RECORD, WGSL_KEY];
    for block in [WGSL_POINTS, WGSL_LOBE] {
        let source = keys.concat() + block;
        let module =
            naga::front::wgsl::parse_str(&source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
        if let Err(error) = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module) {
            panic!("{}", error.emit_to_string(&source));
        }
    }
}

#[test]
fn bindings_are_those_declared() {
    for kernel in KERNELS {
        let module = module(kernel);
        for (index, declared) in kernel.bindings.iter().enumerate() {
            let (_, global) = module
                .global_variables
                .iter()
                .find(|(_, global)| global.name.as_deref() == Some(declared.name))
                .unwrap_or_else(|| panic!("{}: no global {}", kernel.name, declared.name));
            let binding = global.binding.expect("bound");
            assert_eq!((binding.group, binding.binding as usize), (0, index), "{}", declared.name);
            let naga::AddressSpace::Storage { access } = global.space else { panic!("{}", declared.name) };
            let writes = access.contains(naga::StorageAccess::STORE);
            assert_eq!(writes, declared.access != Access::In, "{}", declared.name);
        }
    }
}

#[test]
fn structs_have_the_size_of_their_twins() {
    let module = module(&LOOKUP);
    let size = |name: &str| {
        let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).expect("the struct");
        let naga::TypeInner::Struct { span, .. } = found.inner else { panic!("{name} is no struct") };
        span as usize
    };
    assert_eq!(size("HgParams"), size_of::<Params>());
    assert_eq!(size("HgKey"), size_of::<Key>());
    assert_eq!(size("HcVertexRecord"), KERNELS[1].bindings[1].stride as usize);
    assert_eq!(size("HcEstimateRecord"), KERNELS[3].bindings[3].stride as usize);
}

#[test]
fn constants_are_equal() {
    let module = module(&LOOKUP);
    let value = |name: &str| {
        let (_, found) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name)).expect("the constant");
        match module.global_expressions[found.init] {
            naga::Expression::Literal(naga::Literal::U32(value)) => value,
            ref other => panic!("{name}: {other:?}"),
        }
    };
    assert_eq!(value("HG_CELL_BITS"), params::CELL_BITS);
    assert_eq!(value("HG_SALT_DEPOSIT"), hashgrid::jitter::SALT_DEPOSIT);
    assert_eq!(value("HG_SALT_LOOKUP"), hashgrid::jitter::SALT_LOOKUP);
    assert_eq!(value("HG_FINGERPRINT_MAX"), tag::FINGERPRINT_MAX);
    assert_eq!(value("HG_EMPTY"), tag::EMPTY);
    assert_eq!(value("HG_NEW"), tag::NEW);
    assert_eq!(value("HG_DISTANCE_BITS"), tag::DISTANCE_BITS);
    assert_eq!(value("HG_FINGERPRINT_BITS"), tag::FINGERPRINT_BITS);
    assert_eq!(value("HG_NO_KEY"), key::NO_KEY);
    assert_eq!(value("HG_CELL_WORDS") as usize, 2 * hashgrid::CELL_WORDS);
    assert_eq!(value("HG_TALLY_WORDS") as usize, 2 * Counters::WORDS);
    assert_eq!(value("HG_CLAIM_REFUSED"), hashgrid::Claim::Refused as u32);
}
