//! What a kernel declares is what its shader binds.

use backend_api::{Access, Kernel, Status};
use backend_wgpu::PRELUDE;
use hashcache_dev_tests::conformance::toys;
use naga::{AddressSpace, Module, ResourceBinding, StorageAccess, TypeInner};

use crate::{CRATES, root, wgsl_side};

static KERNELS: [&Kernel; 10] = [
    &hashgrid::kernels::CLEAR,
    &hashgrid::kernels::CLAIM,
    &hashgrid::kernels::DEPOSIT,
    &hashgrid::kernels::LOOKUP,
    &toys::SCALE,
    &toys::STEP,
    &toys::HISTOGRAM,
    &toys::SUM,
    &toys::RAISE,
    &toys::FIVE,
];

fn module(kernel: &Kernel) -> Module {
    let wgsl = kernel.wgsl.expect("a kernel with WGSL");
    let source = [&[PRELUDE], wgsl.modules].concat().join("\n");
    wgsl_side::parse(kernel.name, &source)
}

#[test]
fn entry_points_have_the_declared_workgroups() {
    for kernel in KERNELS {
        let (module, wgsl) = (module(kernel), kernel.wgsl.expect("a kernel with WGSL"));
        let entry = module.entry_points.iter().find(|entry| entry.name == wgsl.entry);
        let entry = entry.unwrap_or_else(|| panic!("{}: no entry point {}", kernel.name, wgsl.entry));
        assert_eq!(entry.workgroup_size, [wgsl.workgroup_size, 1, 1], "{}", kernel.name);
    }
}

#[test]
fn globals_have_the_declared_names_access_and_strides() {
    for kernel in KERNELS {
        let module = module(kernel);
        for (k, decl) in kernel.bindings.iter().enumerate() {
            let at = format!("{}, binding {k}", kernel.name);
            let place = ResourceBinding { group: 0, binding: k as u32 };
            let found = module.global_variables.iter().find(|(_, variable)| variable.binding == Some(place));
            let (_, variable) = found.unwrap_or_else(|| panic!("{at}: not in the shader"));
            assert_eq!(variable.name.as_deref(), Some(decl.name), "{at}");
            let access = match decl.access {
                Access::In => StorageAccess::LOAD,
                _ => StorageAccess::LOAD | StorageAccess::STORE,
            };
            assert_eq!(variable.space, AddressSpace::Storage { access }, "{at}");
            let TypeInner::Array { base, stride, .. } = module.types[variable.ty].inner else {
                panic!("{at}: no array")
            };
            let atomic = matches!(module.types[base].inner, TypeInner::Atomic(_));
            match decl.access {
                // Read where nothing writes, an element may be looked at in parts.
                Access::In => assert!(!atomic && decl.stride % stride == 0, "{at}: a stride of {stride}"),
                Access::OutPerItem => assert!(!atomic && decl.stride == stride, "{at}: a stride of {stride}"),
                Access::AtomicU32 | Access::AtomicU64 => assert!(atomic && stride == 4, "{at}: no 32-bit atomics"),
            }
        }
    }
}

#[test]
fn parameter_blocks_have_the_declared_size() {
    for kernel in KERNELS {
        let module = module(kernel);
        let place = ResourceBinding { group: 0, binding: 14 };
        let found = module.global_variables.iter().find(|(_, variable)| variable.binding == Some(place));
        let size = found.map_or(0, |(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()));
        assert_eq!(size, kernel.params_size, "{}", kernel.name);
    }
}

/// Status flags are written as `hc_raise(2u); // Status::NON_FINITE`: the number is the flag's.
#[test]
fn raised_flags_are_the_ones_that_are_named() {
    let flags =
        [("TABLE_FULL", Status::TABLE_FULL), ("NON_FINITE", Status::NON_FINITE), ("OVERFLOW", Status::OVERFLOW)];
    let mut found = 0;
    for one in &CRATES {
        let source = wgsl_side::read(&root().join(one.folder).join("wgsl"));
        for line in source.lines().filter(|line| line.contains("hc_raise(")) {
            let right = flags
                .iter()
                .any(|(name, status)| line.trim() == format!("hc_raise({}u); // Status::{name}", status.bits()));
            assert!(right, "{}: {line}", one.folder);
            found += 1;
        }
    }
    assert!(found > 0);
}
