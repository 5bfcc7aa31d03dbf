//! A glTF file as parsed, checked JSON and its buffers.

use std::collections::HashSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use gltf::json;
use json::mesh::Semantic;
use json::validation::{Checked, Error as Breach, Validate as _};

use super::resource;
use crate::LoadOptions;
use crate::error::{At, SceneError, one_line};

/// Extensions that are read, as far as the crate's page says; what a file asks of them beyond that is named in a warning.
/// Any other in `extensionsRequired` is refused, as glTF asks for.
pub(crate) const SUPPORTED: [&str; 10] = [
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// A parsed file. All indices in [`Document::root`] have been checked, except that 64-bit ones wrap to 32 bits.
pub(crate) struct Document {
    /// The file's name as shown in messages.
    pub name: String,
    /// The folder of the files that it names.
    pub base: PathBuf,
    /// The JSON.
    pub root: json::Root,
    /// The file's bytes when it is a GLB.
    file: Vec<u8>,
    buffers: Vec<Buffer>,
}

/// Where a buffer's bytes are.
enum Buffer {
    Own(Vec<u8>),
    Glb(Range<usize>),
}

impl Document {
    /// Reads, parses and checks a file and all of its buffers.
    pub fn open(path: &Path, options: &LoadOptions) -> Result<Self, SceneError> {
        let name = path.to_string_lossy().into_owned();
        let base = path.parent().unwrap_or(Path::new("")).to_owned();
        Self::parse(name, base, resource::read_file(path, options.max_bytes)?, options)
    }

    /// Parses and checks a file's bytes.
    pub fn parse(name: String, base: PathBuf, file: Vec<u8>, options: &LoadOptions) -> Result<Self, SceneError> {
        let at = At { file: &name };
        let (text, bin) = if file.starts_with(b"glTF") { split_glb(at, &file)? } else { (0..file.len(), None) };
        // Some exporters write a byte order mark, which JSON does not have.
        let text = &file[text];
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let mut root: json::Root = json::deserialize::from_slice(text)
            .map_err(|e| at.json("glTF", &e, "export or download the file again"))?;
        check(at, &mut root)?;
        let file = if bin.is_some() { file } else { Vec::new() };
        let mut document = Self { name, base, root, file, buffers: Vec::new() };
        document.read_buffers(bin, options)?;
        Ok(document)
    }

    /// The file, for errors.
    pub fn at(&self) -> At<'_> {
        At { file: &self.name }
    }

    /// The bytes of a buffer view.
    pub fn view(&self, index: usize) -> Result<&[u8], SceneError> {
        let place = || format!("/bufferViews/{index}");
        let view = self.root.buffer_views.get(index).ok_or_else(|| self.at().malformed(place(), "does not exist"))?;
        let buffer = match self.buffers.get(view.buffer.value()) {
            Some(Buffer::Own(bytes)) => bytes.as_slice(),
            Some(Buffer::Glb(range)) => &self.file[range.clone()],
            None => return Err(self.at().malformed(place(), "its buffer does not exist")),
        };
        let offset = view.byte_offset.map_or(0, |o| o.0);
        let bytes = usize::try_from(offset)
            .ok()
            .zip(offset.checked_add(view.byte_length.0).and_then(|end| usize::try_from(end).ok()))
            .and_then(|(start, end)| buffer.get(start..end));
        bytes.ok_or_else(|| {
            let (length, all) = (view.byte_length.0, buffer.len());
            let what = format!("{length} bytes from {offset} on lie outside the buffer of {all} bytes");
            self.at().malformed(place(), what)
        })
    }

    fn read_buffers(&mut self, mut bin: Option<Range<usize>>, options: &LoadOptions) -> Result<(), SceneError> {
        let at = At { file: &self.name };
        let mut left = options.max_bytes;
        for (i, buffer) in self.root.buffers.iter().enumerate() {
            let place = format!("/buffers/{i}");
            let length = buffer.byte_length.0;
            left = left.checked_sub(length).ok_or_else(|| {
                at.too_large(
                    &place,
                    format!("buffers up to here take more than {length} bytes"),
                    options.max_bytes,
                    "max_bytes",
                )
            })?;
            let too_short = |have: usize| at.malformed(&place, format!("{length} bytes announced, {have} there"));
            if let Some(uri) = &buffer.uri {
                let mut bytes = resource::read_uri(at, &self.base, uri, &format!("{place}/uri"), options.max_bytes)?;
                if (bytes.len() as u64) < length {
                    return Err(too_short(bytes.len()));
                }
                bytes.truncate(length as usize);
                bytes.shrink_to_fit();
                self.buffers.push(Buffer::Own(bytes));
            } else {
                // Only the first buffer may stand for the GLB's binary chunk.
                let range = bin
                    .take()
                    .filter(|_| i == 0)
                    .ok_or_else(|| at.malformed(&place, "has no bytes: no uri, no binary chunk"))?;
                if (range.len() as u64) < length {
                    return Err(too_short(range.len()));
                }
                self.buffers.push(Buffer::Glb(range.start..range.start + length as usize));
            }
        }
        Ok(())
    }
}

/// The places of a GLB's JSON and binary chunk.
fn split_glb(at: At, file: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), SceneError> {
    const HEADER: usize = 12;
    const CHUNK_HEADER: usize = 8;
    let word = |i: usize| file.get(i..i + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let (version, length) = word(4).zip(word(8)).ok_or_else(|| at.malformed("the header", "the file ends in it"))?;
    if version != 2 {
        return Err(at.unsupported("the header", format!("GLB version {version}"), "export it as glTF 2.0"));
    }
    let length = length as usize;
    if length > file.len() || length < HEADER {
        return Err(at.malformed("the header", format!("{length} bytes announced, {} there", file.len())));
    }
    let chunk = |start: usize| -> Result<(Range<usize>, u32), SceneError> {
        let place = || format!("the chunk at byte {start}");
        let (size, kind) =
            word(start).zip(word(start + 4)).ok_or_else(|| at.malformed(place(), "the file ends in its header"))?;
        let first = start + CHUNK_HEADER;
        let end = first.checked_add(size as usize).filter(|&end| end <= length);
        let end = end.ok_or_else(|| at.malformed(place(), format!("its {size} bytes reach beyond the file")))?;
        Ok((first..end, kind))
    };
    let (text, kind) = chunk(HEADER)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(at.malformed("the first chunk", "is not JSON"));
    }
    let mut start = text.end.next_multiple_of(4);
    // Chunks of unknown kinds may follow and are to be skipped.
    while start < length {
        let (range, kind) = chunk(start)?;
        if kind == u32::from_le_bytes(*b"BIN\0") {
            return Ok((text, Some(range)));
        }
        start = range.end.next_multiple_of(4);
    }
    Ok((text, None))
}

/// Refuses what is not glTF 2.0, what needs an unknown extension, and every index that points nowhere.
fn check(at: At, root: &mut json::Root) -> Result<(), SceneError> {
    let version = &root.asset.version;
    if version.split('.').next() != Some("2") {
        return Err(at.unsupported("/asset/version", format!("glTF {version:?}"), "export it as glTF 2.0"));
    }
    if let Some((i, name)) = root.extensions_required.iter().enumerate().find(|(_, n)| !SUPPORTED.contains(&n.as_str()))
    {
        let advice = match name.as_str() {
            "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
                "export it without mesh compression"
            }
            "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" | "MSFT_texture_dds" => {
                "export it with PNG or JPEG textures"
            }
            _ => "export it without this extension",
        };
        let what = format!("needs extension {name:?}, which is not supported");
        return Err(at.unsupported(format!("/extensionsRequired/{i}"), what, advice));
    }
    // Nobody reads the bounds that accessors announce, and the validator below clones them once a primitive.
    for accessor in &mut root.accessors {
        (accessor.min, accessor.max) = (None, None);
    }
    // The validator indexes with these before it has checked them.
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if position.is_some_and(|a| a.value() >= root.accessors.len()) {
                let place = format!("/meshes/{m}/primitives/{p}/attributes/POSITION");
                return Err(at.malformed(place, "points to an accessor that does not exist"));
            }
        }
    }
    let mut first = None;
    root.validate(root, json::Path::new, &mut |path, breach| {
        if first.is_none() && breach != Breach::Unsupported {
            let place = pointer(path().as_str());
            let unread_bound = place.ends_with("/min") || place.ends_with("/max");
            if !(breach == Breach::Missing && unread_bound) {
                first = Some((place, breach));
            }
        }
    });
    match first {
        None => Ok(()),
        Some((place, breach)) => Err(at.malformed(
            place,
            match breach {
                Breach::IndexOutOfBounds => "points to something that does not exist",
                Breach::Missing => "is missing",
                Breach::Oversize => "is too large for this machine",
                _ => "has a value that glTF does not know",
            },
        )),
    }
}

/// The validator's `meshes[0].attributes["POSITION"]` as the JSON pointer `/meshes/0/attributes/POSITION`.
fn pointer(path: &str) -> String {
    let path = path.split(" = ").next().unwrap_or(path);
    let mut out = String::with_capacity(path.len() + 1);
    let mut before = "";
    for part in path.split(['.', '[', ']']).filter(|p| !p.is_empty()) {
        out.push('/');
        out.push_str(&escape(if before == "extensions" { extension(part) } else { part.trim_matches('"') }));
        before = part;
    }
    out
}

/// An extension's name; the validator knows it by the parser's name for it.
fn extension(field: &str) -> &str {
    match field {
        "khrLightsPunctual" => "KHR_lights_punctual",
        "emissiveStrength" => "KHR_materials_emissive_strength",
        "ior" => "KHR_materials_ior",
        "specular" => "KHR_materials_specular",
        "transmission" => "KHR_materials_transmission",
        "unlit" => "KHR_materials_unlit",
        "volume" => "KHR_materials_volume",
        "textureTransform" => "KHR_texture_transform",
        other => other,
    }
}

/// One member's name inside a JSON pointer (RFC 6901).
pub(crate) fn escape(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

/// The names of extensions that the file uses and that are not read, each with its place.
pub(crate) fn foreign_extensions(root: &json::Root) -> Vec<(usize, String)> {
    let mut seen = HashSet::new();
    let names = root.extensions_used.iter().enumerate();
    names
        .filter(|(_, n)| !SUPPORTED.contains(&n.as_str()) && seen.insert(n.as_str()))
        .map(|(i, n)| (i, one_line(n)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_pointers() {
        assert_eq!(
            pointer("meshes[3].primitives[0].attributes[\"POSITION\"]"),
            "/meshes/3/primitives/0/attributes/POSITION"
        );
        assert_eq!(pointer("extensionsRequired[0] = \"X\""), "/extensionsRequired/0");
        assert_eq!(
            pointer("materials[0].extensions.volume.thicknessTexture.index"),
            "/materials/0/extensions/KHR_materials_volume/thicknessTexture/index"
        );
        assert_eq!(escape("a/b~c"), "a~1b~0c");
    }
}
