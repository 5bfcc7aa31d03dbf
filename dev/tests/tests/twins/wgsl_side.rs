//! WGSL as naga sees it.

use std::collections::BTreeSet;
use std::path::Path;
use std::{fs, iter};

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{
    AddressSpace, ArraySize, Expression, Handle, Literal, Module, Scalar, ScalarKind, Type, TypeInner, VectorSize,
};

use crate::rust_side::Word;

/// All `.wgsl` files of a folder, by name, one after the other.
pub fn read(folder: &Path) -> String {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.sort();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "wgsl"));
    paths.iter().map(|path| fs::read_to_string(path).expect("a readable file") + "\n").collect()
}

/// Parses and validates.
pub fn parse(name: &str, source: &str) -> Module {
    let module =
        naga::front::wgsl::parse_str(source).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)));
    if let Err(error) = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module) {
        panic!("{name}: {}", error.emit_to_string(source));
    }
    module
}

/// A constant's value as a number.
pub fn constant(module: &Module, init: Handle<Expression>) -> Option<f64> {
    let Expression::Literal(literal) = module.global_expressions[init] else { return None };
    Some(match literal {
        Literal::U32(v) => f64::from(v),
        Literal::I32(v) => f64::from(v),
        Literal::F32(v) => f64::from(v),
        _ => return None,
    })
}

/// Structs that stand in buffers: those that a storage or uniform variable holds.
pub fn shared_structs(module: &Module) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (_, variable) in module.global_variables.iter() {
        if matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. }) {
            collect(module, variable.ty, &mut found);
        }
    }
    found
}

fn collect(module: &Module, ty: Handle<Type>, found: &mut BTreeSet<String>) {
    match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => {
            found.extend(module.types[ty].name.clone());
            for member in members {
                collect(module, member.ty, found);
            }
        }
        TypeInner::Array { base, .. } => collect(module, *base, found),
        _ => {}
    }
}

/// Words and size of a struct.
pub fn layout(module: &Module, ty: Handle<Type>) -> Result<(Vec<Word>, u32), String> {
    let TypeInner::Struct { span, .. } = module.types[ty].inner else { return Err("no struct".to_owned()) };
    let mut words = Vec::new();
    add_words(module, ty, "", 0, &mut words)?;
    Ok((words, span))
}

fn add_words(module: &Module, ty: Handle<Type>, name: &str, at: u32, words: &mut Vec<Word>) -> Result<(), String> {
    match module.types[ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => words.push((at, name.to_owned(), kind(scalar)?)),
        TypeInner::Vector { size: VectorSize::Tri, .. } => return Err(format!("{name}: 12-byte vectors never cross")),
        TypeInner::Vector { size, scalar } => {
            let kind = kind(scalar)?;
            words.extend((0..size as u32).map(|k| (at + 4 * k, name.to_owned(), kind)));
        }
        TypeInner::Array { base, size: ArraySize::Constant(length), stride } => {
            for k in 0..length.get() {
                add_words(module, base, name, at + k * stride, words)?;
            }
        }
        TypeInner::Struct { ref members, .. } => {
            for member in members {
                let own = member.name.as_deref().unwrap_or_default();
                // `reserved_0`, `reserved_1` are the words of `reserved`.
                let own = own.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
                let path = if name.is_empty() { own.to_owned() } else { format!("{name}.{own}") };
                add_words(module, member.ty, &path, at + member.offset, words)?;
            }
        }
        _ => return Err(format!("{name}: a type that does not stand in buffers")),
    }
    Ok(())
}

fn kind(scalar: Scalar) -> Result<char, String> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Uint, 4) => Ok('u'),
        (ScalarKind::Sint, 4) => Ok('i'),
        (ScalarKind::Float, 4) => Ok('f'),
        _ => Err("a scalar of another width than 32 bits".to_owned()),
    }
}

/// How a parameter's type is written in Rust, where that is certain: scalars, and vectors as arrays.
pub fn rust_types(module: &Module, ty: Handle<Type>) -> Vec<String> {
    let scalar_name = |scalar: Scalar| match scalar.kind {
        ScalarKind::Uint => "u32",
        ScalarKind::Sint => "i32",
        ScalarKind::Float => "f32",
        _ => "bool",
    };
    match module.types[ty].inner {
        TypeInner::Scalar(scalar) => vec![scalar_name(scalar).to_owned()],
        TypeInner::Vector { size, scalar } => {
            let array = format!("[{};{}]", scalar_name(scalar), size as u32);
            let glam = match scalar.kind {
                ScalarKind::Float => Some(format!("Vec{}", size as u32)),
                _ => None,
            };
            let word = (size == VectorSize::Bi && scalar == Scalar::U32).then(|| "u64".to_owned());
            iter::once(array).chain(glam).chain(word).collect()
        }
        _ => Vec::new(),
    }
}
