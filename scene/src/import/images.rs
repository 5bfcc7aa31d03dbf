//! The images that textures show, each decoded once.

use std::collections::HashMap;

use super::document::Document;
use super::resource;
use crate::error::SceneError;
use crate::progress::{Listener, Progress};
use crate::texture::{self, Header};
use crate::warning::Warnings;
use crate::{LoadOptions, parallel};

/// The images that have been asked for, in the order of their first use.
#[derive(Default)]
pub(crate) struct Images {
    order: Vec<usize>,
    slots: HashMap<usize, usize>,
}

/// Where a decoded image is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// Index of the upper left texel.
    pub first: u32,
    /// Texels a row, rows.
    pub size: [u32; 2],
}

/// All images as texels.
pub(crate) struct Decoded {
    /// RGBA8 words.
    pub texels: Vec<u32>,
    /// By slot.
    pub places: Vec<Place>,
}

impl Decoded {
    /// The texels of the image in this slot.
    pub fn image(&self, slot: usize) -> &[u32] {
        let Place { first, size: [width, height] } = self.places[slot];
        &self.texels[first as usize..][..width as usize * height as usize]
    }
}

/// The bytes of an image file.
enum Encoded<'a> {
    Own(Vec<u8>),
    View(&'a [u8]),
}

impl Encoded<'_> {
    fn bytes(&self) -> &[u8] {
        match self {
            Self::Own(bytes) => bytes,
            Self::View(bytes) => bytes,
        }
    }
}

impl Images {
    /// The slot of the glTF image with this index.
    pub fn slot(&mut self, index: usize) -> usize {
        *self.slots.entry(index).or_insert_with(|| {
            self.order.push(index);
            self.order.len() - 1
        })
    }

    /// Number of images.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Reads and decodes all of them: on several threads, into one list whose size is known before.
    pub fn decode(
        &self,
        document: &Document,
        options: &LoadOptions,
        progress: Listener,
        warnings: &mut Warnings,
    ) -> Result<Decoded, SceneError> {
        let at = document.at();
        let mut files = Vec::with_capacity(self.order.len());
        let mut places = Vec::with_capacity(self.order.len());
        let (mut total, mut bytes_left) = (0_u64, options.max_bytes);
        for &index in &self.order {
            let encoded = read(document, index, &mut bytes_left, options)?;
            let place = || format!("/images/{index}");
            let header = texture::header(encoded.bytes()).map_err(|why| refused(document, index, &why))?;
            let first = total;
            total += header.texels();
            if total > u64::from(options.max_texels) {
                let what = format!("{} more texels", header.texels());
                return Err(at.too_large(place(), what, options.max_texels.into(), "max_texels"));
            }
            if header.deep {
                warnings.add("textures of 16 bits a channel are shown with 8", place);
            }
            places.push(Place { first: first as u32, size: [header.width, header.height] });
            files.push((index, encoded, header));
        }
        let mut texels = vec![0; total as usize];
        let done = std::sync::Mutex::new(0);
        progress(Progress { what: "textures", done: 0, total });
        let work = |((index, encoded, header), out): ((usize, Encoded, Header), &mut [u32])| {
            texture::decode(encoded.bytes(), &header, out).map_err(|why| refused(document, index, &why))?;
            // Told under the lock, so that what is told never goes back.
            let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            *done += header.texels();
            progress(Progress { what: "textures", done: *done, total });
            Ok(())
        };
        let mut rest = texels.as_mut_slice();
        let jobs = files.into_iter().map(|file| {
            let (out, after) = std::mem::take(&mut rest).split_at_mut(file.2.texels() as usize);
            rest = after;
            (file, out)
        });
        let results = parallel::map(jobs.collect(), parallel::threads(options.threads), work);
        results.into_iter().collect::<Result<(), SceneError>>()?;
        Ok(Decoded { texels, places })
    }
}

/// The file's bytes. All images together may take what is left of the bytes allowed.
fn read<'a>(
    document: &'a Document,
    index: usize,
    bytes_left: &mut u64,
    options: &LoadOptions,
) -> Result<Encoded<'a>, SceneError> {
    let at = document.at();
    let place = format!("/images/{index}");
    let source = &document.root.images[index];
    let encoded = match (&source.uri, source.buffer_view) {
        (Some(uri), _) => {
            let place = format!("{place}/uri");
            Encoded::Own(resource::read_uri(at, &document.base, uri, &place, options.max_bytes)?)
        }
        // Part of a buffer, which has been counted.
        (None, Some(view)) => return Ok(Encoded::View(document.view(view.value())?)),
        (None, None) => return Err(at.malformed(place, "has neither uri nor bufferView")),
    };
    let length = encoded.bytes().len() as u64;
    *bytes_left = bytes_left.checked_sub(length).ok_or_else(|| {
        at.too_large(&place, format!("image files with {length} more bytes"), options.max_bytes, "max_bytes")
    })?;
    Ok(encoded)
}

fn refused(document: &Document, index: usize, why: &str) -> SceneError {
    let what = format!("is no usable PNG or JPEG image: {why}");
    document.at().unsupported(format!("/images/{index}"), what, "convert the image to PNG or JPEG")
}
