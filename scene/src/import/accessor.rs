//! Typed, bounds-checked reading of accessors.

use gltf::json;
use json::accessor::{ComponentType, Type};
use json::validation::Checked;

use super::document::Document;
use crate::error::SceneError;

/// The elements of an accessor, which have been found to lie inside of their buffer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: ComponentType,
    normalized: bool,
    /// Number of elements.
    pub count: usize,
}

/// Looks up accessor `index`, which must be of one of the given types. Nothing is allocated for it.
pub(crate) fn elements<'a>(document: &'a Document, index: usize, types: &[Type]) -> Result<Elements<'a>, SceneError> {
    let at = document.at();
    let place = || format!("/accessors/{index}");
    let accessor = document.root.accessors.get(index).ok_or_else(|| at.malformed(place(), "does not exist"))?;
    if accessor.sparse.is_some() {
        return Err(at.unsupported(place(), "is sparse", "export it without sparse accessors"));
    }
    let (Checked::Valid(kind), Checked::Valid(component), Some(view)) =
        (accessor.type_, accessor.component_type, accessor.buffer_view)
    else {
        return Err(at.malformed(place(), "has no type, component type or buffer view"));
    };
    if !types.contains(&kind) {
        return Err(at.malformed(place(), format!("holds {kind:?}, expected {types:?}")));
    }
    let component = component.0;
    let size = component.size() * kind.multiplicity();
    let stride = document.root.buffer_views[view.value()].byte_stride.map_or(size, |s| s.0);
    if stride < size {
        return Err(at.malformed(place(), format!("elements of {size} bytes overlap in steps of {stride}")));
    }
    let (count, offset) = (accessor.count.0, accessor.byte_offset.map_or(0, |o| o.0));
    let bytes = document.view(view.value())?;
    // The last element need not fill its stride.
    let end = match count.checked_sub(1) {
        None => Some(offset),
        Some(steps) => steps.checked_mul(stride as u64).and_then(|n| n.checked_add(size as u64)?.checked_add(offset)),
    };
    let end = end.filter(|&end| end <= bytes.len() as u64).ok_or_else(|| {
        let all = bytes.len();
        at.malformed(place(), format!("{count} elements from byte {offset} on reach beyond their view of {all} bytes"))
    })?;
    let bytes = bytes.get(offset as usize..end as usize).unwrap_or_default();
    Ok(Elements { bytes, stride, component, normalized: accessor.normalized, count: count as usize })
}

impl<'a> Elements<'a> {
    /// The first `N` components of every element as numbers, integers normalised where the accessor says so.
    pub fn floats<const N: usize>(self) -> impl Iterator<Item = [f32; N]> + 'a {
        self.bytes.chunks(self.stride).map(move |bytes| std::array::from_fn(|i| self.float(bytes, i)))
    }

    fn float(&self, bytes: &[u8], i: usize) -> f32 {
        let word = || [bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]];
        let half = || [bytes[2 * i], bytes[2 * i + 1]];
        let (value, one) = match self.component {
            ComponentType::F32 => return f32::from_le_bytes(word()),
            ComponentType::I8 => (f32::from(bytes[i] as i8), 127.0),
            ComponentType::U8 => (f32::from(bytes[i]), 255.0),
            ComponentType::I16 => (f32::from(i16::from_le_bytes(half())), 32_767.0),
            ComponentType::U16 => (f32::from(u16::from_le_bytes(half())), 65_535.0),
            ComponentType::U32 => (u32::from_le_bytes(word()) as f32, 4_294_967_295.0),
        };
        if self.normalized { (value / one).max(-1.0) } else { value }
    }

    /// The elements as vertex indices; `None` when they are no unsigned integers.
    pub fn indices(self) -> Option<impl Iterator<Item = u32> + 'a> {
        let signed = matches!(self.component, ComponentType::F32 | ComponentType::I8 | ComponentType::I16);
        (!signed).then(|| {
            self.bytes.chunks(self.stride).map(move |b| match self.component {
                ComponentType::U8 => u32::from(b[0]),
                ComponentType::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
                _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
            })
        })
    }
}
