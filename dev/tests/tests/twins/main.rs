//! Every WGSL function, struct and constant has its twin in Rust: same name without the prefix, same parameters in the
//! same order, same layout, same value. Both sides are read from their sources, so nothing is left out.

mod constants;
mod kernels;
mod rust_side;
mod wgsl_side;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use naga::{Function as WgslFunction, Module};
use rust_side::{Function, Sources};
use syn::Type;

/// A crate with WGSL: its folder, its prefix, and the crates that it builds on.
struct Crate {
    folder: &'static str,
    prefix: &'static str,
    /// Folders of the crates whose modules stand before its own.
    below: &'static [&'static str],
}

const CRATES: [Crate; 3] = [
    Crate { folder: "hashcache-core", prefix: "hc_", below: &[] },
    Crate { folder: "hashgrid", prefix: "hg_", below: &["hashcache-core"] },
    Crate { folder: "pt-integrator", prefix: "pt_", below: &["hashcache-core"] },
];

/// Functions that only a GPU needs, and why. What they do is compared as a whole, in `parity_grid.rs`.
const GPU_ONLY: [(&str, &str); 9] = [
    ("hg_add_sum", "the host adds 64 bits at once"),
    ("hg_sum", "the host reads 64 bits at once"),
    ("hg_count64", "the host's counters are plain numbers of one thread"),
    ("hg_count", "the host's counters are plain numbers of one thread"),
    ("hg_add_counters", "adds the counters of a workgroup, which the host has not"),
    ("hg_deposit_vertex", "the host works on batches of vertices to overlap cache misses"),
    ("hg_lookup_vertex", "the host works on batches of vertices to overlap cache misses"),
    ("hg_estimate_vertex", "the host works on batches of vertices to overlap cache misses"),
    ("hg_finite", "counts in the workgroup's counters"),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

impl Crate {
    fn module(&self) -> Module {
        let mut source = String::from(backend_wgpu::PRELUDE);
        for folder in self.below.iter().chain([&self.folder]) {
            source.push_str(&wgsl_side::read(&root().join(folder).join("wgsl")));
        }
        wgsl_side::parse(self.folder, &source)
    }

    fn sources(&self) -> Sources {
        let mut sources = Sources::default();
        for folder in self.below.iter().chain([&self.folder]) {
            sources.read(&root().join(folder).join("src"));
        }
        sources
    }

    /// Whether a name is this crate's, and not of the backend's prelude.
    fn owns(&self, name: &str) -> bool {
        let prelude = [format!("fn {name}("), format!("struct {name} "), format!("const {name}:")];
        name.to_ascii_lowercase().starts_with(self.prefix.trim_end_matches('_'))
            && !prelude.iter().any(|text| backend_wgpu::PRELUDE.contains(text))
    }

    /// `HcVertexRecord` → `VertexRecord`.
    fn struct_name<'a>(&self, name: &'a str) -> &'a str {
        &name[self.prefix.len() - 1..]
    }
}

#[test]
fn every_folder_with_wgsl_is_checked() {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(root()).expect("the workspace") {
        let path = entry.expect("a readable folder").path();
        if path.join("wgsl").is_dir() {
            found.extend(path.file_name().map(|name| name.to_string_lossy().into_owned()));
        }
    }
    assert_eq!(found, CRATES.iter().map(|c| c.folder.to_owned()).collect::<BTreeSet<_>>());
}

#[test]
fn every_function_has_a_twin() {
    let mut wrong = Vec::new();
    let mut gpu_only: BTreeSet<&str> = GPU_ONLY.iter().map(|(name, _)| *name).collect();
    let mut checked = 0;
    for one in &CRATES {
        let (module, sources) = (one.module(), one.sources());
        for (_, function) in module.functions.iter() {
            let name = function.name.as_deref().unwrap_or_default();
            if !one.owns(name) || gpu_only.remove(name) {
                continue;
            }
            checked += 1;
            let twins = sources.functions.get(&name[one.prefix.len()..]).map(Vec::as_slice).unwrap_or_default();
            if !twins.iter().any(|twin| is_twin(&module, function, twin)) {
                wrong.push(describe(name, &module, function, twins));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(gpu_only.is_empty(), "declared GPU only, and there is no such function: {gpu_only:?}");
    assert!(checked > 60, "only {checked} functions were found");
}

/// Same parameters in the same order. In Rust, storage may come first, as `self` or as a reference, where WGSL has a
/// global; or `self` is WGSL's first parameter.
fn is_twin(module: &Module, wgsl: &WgslFunction, rust: &Function) -> bool {
    let all = rust.parameters.as_slice();
    let matches = |wgsl: &[naga::FunctionArgument], rust: &[(String, Type)]| {
        wgsl.len() == rust.len() && wgsl.iter().zip(rust).all(|(w, (name, ty))| same_parameter(module, w, name, ty))
    };
    let arguments = wgsl.arguments.as_slice();
    if rust.has_self {
        return matches(arguments, all) || matches(arguments.get(1..).unwrap_or_default(), all);
    }
    let storage_first = matches!(all.first(), Some((_, Type::Reference(_))));
    matches(arguments, all) || (storage_first && matches(arguments, &all[1..]))
}

fn same_parameter(module: &Module, wgsl: &naga::FunctionArgument, name: &str, ty: &Type) -> bool {
    let types = wgsl_side::rust_types(module, wgsl.ty);
    let ty = rust_type(ty);
    let plain = ["u32", "i32", "f32", "bool", "u64"];
    let is_plain = plain.contains(&ty.as_str()) || ty.starts_with('[');
    wgsl.name.as_deref() == Some(name.trim_start_matches('_')) && (!is_plain || types.contains(&ty))
}

/// A type's text for what can be compared; empty for the rest.
fn rust_type(ty: &Type) -> String {
    match ty {
        Type::Path(path) => path.path.segments.last().map(|segment| segment.ident.to_string()).unwrap_or_default(),
        Type::Array(array) => match &array.len {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(length), .. }) => {
                format!("[{};{length}]", rust_type(&array.elem))
            }
            _ => String::new(),
        },
        _ => String::new(),
    }
}

fn describe(name: &str, module: &Module, wgsl: &WgslFunction, twins: &[Function]) -> String {
    let parameter = |a: &naga::FunctionArgument| {
        format!("{}: {:?}", a.name.as_deref().unwrap_or("?"), wgsl_side::rust_types(module, a.ty))
    };
    let wgsl: Vec<_> = wgsl.arguments.iter().map(parameter).collect();
    let mut lines = vec![format!("{name}({}) has no twin", wgsl.join(", "))];
    for twin in twins {
        let rust: Vec<_> = twin.parameters.iter().map(|(name, ty)| format!("{name}: {}", rust_type(ty))).collect();
        let receiver = if twin.has_self { "self, " } else { "" };
        lines.push(format!("    {}: ({receiver}{})", twin.file.display(), rust.join(", ")));
    }
    lines.join("\n")
}

#[test]
fn structs_in_buffers_have_the_layout_of_their_twins() {
    let mut wrong = Vec::new();
    let mut checked = BTreeSet::new();
    for one in &CRATES {
        let (module, sources) = (one.module(), one.sources());
        let shared = wgsl_side::shared_structs(&module);
        for (handle, ty) in module.types.iter() {
            let Some(name) = ty.name.as_deref().filter(|name| shared.contains(*name)) else { continue };
            if backend_wgpu::PRELUDE.contains(&format!("struct {name} ")) {
                continue;
            }
            // A struct of a crate below has a prefix of the same length.
            let twin = one.struct_name(name);
            match (wgsl_side::layout(&module, handle), sources.layout(twin)) {
                (Ok(wgsl), Ok(rust)) if wgsl == rust => drop(checked.insert(name.to_owned())),
                (wgsl, rust) => wrong.push(format!("{name}:\n  WGSL {wgsl:?}\n  Rust {rust:?}")),
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for name in ["HcVertexRecord", "HcEstimateRecord", "HgParams"] {
        assert!(checked.contains(name), "{name} was not found in any buffer");
    }
}

/// Structs that never stand in a buffer may hold their values in another form; their fields have the same names in
/// the same order, Rust's may be more.
#[test]
fn structs_of_values_have_the_fields_of_their_twins() {
    let mut wrong = Vec::new();
    for one in &CRATES {
        let (module, sources) = (one.module(), one.sources());
        for (_, ty) in module.types.iter() {
            let (Some(name), naga::TypeInner::Struct { members, .. }) = (ty.name.as_deref(), &ty.inner) else {
                continue;
            };
            if !one.owns(name) || wgsl_side::shared_structs(&module).contains(name) {
                continue;
            }
            let Some(fields) = sources.fields(one.struct_name(name)) else {
                wrong.push(format!("{name} has no twin"));
                continue;
            };
            let mut rest = fields.iter();
            for member in members {
                let member = member.name.as_deref().unwrap_or_default();
                if !rest.any(|field| field == member) {
                    wrong.push(format!("{name}: no field {member} in its place among {fields:?}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The computed layout is the compiler's.
#[test]
fn layouts_are_computed_right() {
    use hashcache_core::record::VertexRecord;
    use hashcache_core::stages::EstimateRecord;
    use std::mem::offset_of;

    let sources = CRATES[1].sources();
    let (words, size) = sources.layout("VertexRecord").expect("a plain struct");
    assert_eq!(size as usize, size_of::<VertexRecord>());
    let offset = |name: &str| words.iter().find(|word| word.1 == name).map(|word| word.0 as usize);
    assert_eq!(offset("direct"), Some(offset_of!(VertexRecord, direct)));
    assert_eq!(offset("emitted"), Some(offset_of!(VertexRecord, emitted)));
    assert_eq!(offset("flags"), Some(offset_of!(VertexRecord, flags)));
    assert_eq!(sources.layout("EstimateRecord").expect("plain").1 as usize, size_of::<EstimateRecord>());
    assert_eq!(sources.layout("Params").expect("plain").1 as usize, size_of::<hashgrid::Params>());
}
