//! Functions and structs of a crate, read from its sources.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use syn::{Expr, Fields, FnArg, ImplItem, Item, Lit, Pat, Signature, Type};

/// A function: where it stands, its parameters (without `self`) and whether it has one.
pub struct Function {
    pub file: PathBuf,
    pub has_self: bool,
    pub parameters: Vec<(String, Type)>,
}

/// What a crate's sources declare, by name.
#[derive(Default)]
pub struct Sources {
    pub functions: BTreeMap<String, Vec<Function>>,
    structs: BTreeMap<String, syn::ItemStruct>,
}

/// A 32-bit word of a struct: byte offset, the field it belongs to, and `u`, `i` or `f`.
pub type Word = (u32, String, char);

impl Sources {
    /// Adds all sources below `folder`; modules of tests are left out.
    pub fn read(&mut self, folder: &Path) {
        let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for path in entries.map(|entry| entry.expect("a readable folder").path()) {
            if path.is_dir() {
                self.read(&path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).expect("a readable file");
                let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
                self.add_items(&path, file.items);
            }
        }
    }

    fn add_items(&mut self, file: &Path, items: Vec<Item>) {
        for item in items {
            match item {
                Item::Fn(function) => self.add_function(file, &function.sig),
                Item::Impl(block) => {
                    for item in &block.items {
                        if let ImplItem::Fn(function) = item {
                            self.add_function(file, &function.sig);
                        }
                    }
                }
                Item::Struct(item) => {
                    self.structs.insert(item.ident.to_string(), item);
                }
                Item::Mod(module) if module.ident != "tests" => {
                    self.add_items(file, module.content.map(|(_, items)| items).unwrap_or_default());
                }
                _ => {}
            }
        }
    }

    fn add_function(&mut self, file: &Path, signature: &Signature) {
        let mut function = Function { file: file.to_owned(), has_self: false, parameters: Vec::new() };
        for argument in &signature.inputs {
            match argument {
                FnArg::Receiver(_) => function.has_self = true,
                FnArg::Typed(argument) => {
                    let name = match &*argument.pat {
                        Pat::Ident(name) => name.ident.to_string(),
                        _ => "(a pattern)".to_owned(),
                    };
                    function.parameters.push((name, (*argument.ty).clone()));
                }
            }
        }
        self.functions.entry(signature.ident.to_string()).or_default().push(function);
    }

    /// Field names of a struct, in order.
    pub fn fields(&self, name: &str) -> Option<Vec<String>> {
        let fields = self.structs.get(name)?.fields.iter();
        Some(fields.filter_map(|field| Some(field.ident.as_ref()?.to_string())).collect())
    }

    /// The words of a `repr(C)` struct and its size in bytes.
    pub fn layout(&self, name: &str) -> Result<(Vec<Word>, u32), String> {
        let mut words = Vec::new();
        let (size, _) = self.struct_layout(name, "", 0, &mut words)?;
        Ok((words, size))
    }

    fn struct_layout(&self, name: &str, prefix: &str, at: u32, words: &mut Vec<Word>) -> Result<(u32, u32), String> {
        let item = self.structs.get(name).ok_or_else(|| format!("no struct {name}"))?;
        let is_repr = |attribute: &syn::Attribute| {
            let list = attribute.meta.require_list().map(|list| list.tokens.to_string());
            attribute.path().is_ident("repr") && list.is_ok_and(|list| list == "C" || list == "transparent")
        };
        if !item.attrs.iter().any(is_repr) {
            return Err(format!("struct {name} is neither repr(C) nor repr(transparent)"));
        }
        let (mut end, mut alignment) = (0, 1);
        for field in &item.fields {
            let path = match (&item.fields, &field.ident) {
                (Fields::Named(_), Some(ident)) if prefix.is_empty() => ident.to_string(),
                (Fields::Named(_), Some(ident)) => format!("{prefix}.{ident}"),
                _ => prefix.to_owned(),
            };
            // A struct around one number is that number.
            let path = if item.fields.len() == 1 && !prefix.is_empty() { prefix.to_owned() } else { path };
            let (_, field_alignment) = self.type_layout(&field.ty, &path, 0, &mut Vec::new())?;
            let start = u32::next_multiple_of(end, field_alignment);
            let (size, _) = self.type_layout(&field.ty, &path, at + start, words)?;
            end = start + size;
            alignment = alignment.max(field_alignment);
        }
        Ok((end.next_multiple_of(alignment), alignment))
    }

    /// Size and alignment of a type; its words are added.
    fn type_layout(&self, ty: &Type, name: &str, at: u32, words: &mut Vec<Word>) -> Result<(u32, u32), String> {
        match ty {
            Type::Array(array) => {
                let Expr::Lit(syn::ExprLit { lit: Lit::Int(length), .. }) = &array.len else {
                    return Err(format!("{name}: an array whose length is no literal"));
                };
                let length: u32 = length.base10_parse().map_err(|error| error.to_string())?;
                let (size, alignment) = self.type_layout(&array.elem, name, 0, &mut Vec::new())?;
                for k in 0..length {
                    self.type_layout(&array.elem, name, at + k * size, words)?;
                }
                Ok((length * size, alignment))
            }
            Type::Path(path) => {
                let ident = path.path.segments.last().ok_or("an empty path")?.ident.to_string();
                let kind = match ident.as_str() {
                    "u32" | "u64" => 'u',
                    "i32" => 'i',
                    "f32" => 'f',
                    other => return self.struct_layout(other, name, at, words),
                };
                let count = if ident == "u64" { 2 } else { 1 };
                words.extend((0..count).map(|k| (at + 4 * k, name.to_owned(), kind)));
                Ok((4 * count, 4 * count))
            }
            _ => Err(format!("{name}: a type without a fixed layout")),
        }
    }
}
