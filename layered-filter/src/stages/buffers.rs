//! The buffers of a picture.

use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error};

use super::{Composition, FilterSettings};
use crate::front::{Behind, FrontPixel};
use crate::guide::PreparedGuide;
use crate::image::Light;
use crate::kernels::FilterCounters;
use crate::pixel::{Direct, LayerPixel};

pub(super) const PIXEL: u64 = size_of::<LayerPixel>() as u64;
pub(super) const FRONT: u64 = size_of::<FrontPixel>() as u64;
pub(super) const BEHIND: u64 = size_of::<Behind>() as u64;
pub(super) const GUIDE: u64 = size_of::<PreparedGuide>() as u64;
pub(super) const LIGHT: u64 = size_of::<Light>() as u64;
pub(super) const COUNTERS: u64 = size_of::<FilterCounters>() as u64;

/// Images have two buffers, which passes read and write in turn.
#[derive(Clone, Debug)]
pub(super) struct Buffers {
    /// Sums, the first layer's first.
    pub pixels: Vec<BufferId>,
    /// Sums of vertices that chains go on from, of the first layers: those that are filtered once more.
    pub fronts: Vec<BufferId>,
    pub guides: BufferId,
    pub further: [BufferId; 2],
    pub direct: [BufferId; 2],
    pub radiance: BufferId,
    pub counters: BufferId,
    /// With several layers only.
    pub deep: Option<Deep>,
}

/// What only pictures with several layers have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deep {
    pub behind: BufferId,
    /// Where light is filtered once more; without such light there is none.
    pub carried: Option<[BufferId; 2]>,
}

/// Number of layers whose fronts are kept.
pub(super) const fn fronts(layers: u32, composition: Composition) -> u32 {
    match composition {
        _ if layers <= 1 => 0,
        Composition::Layered => 0,
        Composition::LayeredRough => layers - 1,
        Composition::Screen => 1,
    }
}

/// Bytes of a pixel in all buffers.
pub(super) const fn pixel_bytes(direct: Direct, layers: u32, composition: Composition) -> u64 {
    let images = match direct {
        Direct::Record => 5,
        Direct::Estimate => 4,
    };
    let fronts = fronts(layers, composition) as u64;
    let deep = if layers > 1 { BEHIND } else { 0 };
    let carried = if fronts > 0 { 2 * LIGHT } else { 0 };
    layers as u64 * PIXEL + fronts * FRONT + GUIDE + images * LIGHT + deep + carried
}

impl Buffers {
    /// Creates all or none.
    pub fn new<B: Backend>(backend: &mut B, settings: &FilterSettings, pixels: u64) -> Result<Self, Error> {
        let mut made = Vec::new();
        Self::create(backend, settings, pixels, &mut made).or_else(|error| {
            for buffer in made {
                backend.destroy(buffer)?;
            }
            Err(error)
        })
    }

    fn create<B: Backend>(
        backend: &mut B,
        settings: &FilterSettings,
        pixels: u64,
        made: &mut Vec<BufferId>,
    ) -> Result<Self, Error> {
        let mut buffer = |name, size| -> Result<BufferId, Error> {
            let buffer = backend.create(&BufferDesc { name, size })?;
            made.push(buffer);
            Ok(buffer)
        };
        let sums = (0..settings.layers).map(|_| buffer("lf.pixels", PIXEL * pixels)).collect::<Result<_, _>>()?;
        let kept = fronts(settings.layers, settings.composition);
        let fronts = (0..kept).map(|_| buffer("lf.fronts", FRONT * pixels)).collect::<Result<_, _>>()?;
        // What is not apart is not filtered.
        let second_direct = if settings.direct == Direct::Record { pixels } else { 1 };
        Ok(Self {
            pixels: sums,
            fronts,
            guides: buffer("lf.guides", GUIDE * pixels)?,
            further: [buffer("lf.further", LIGHT * pixels)?, buffer("lf.further", LIGHT * pixels)?],
            direct: [buffer("lf.direct", LIGHT * pixels)?, buffer("lf.direct", LIGHT * second_direct)?],
            radiance: buffer("lf.radiance", LIGHT * pixels)?,
            counters: buffer("lf.counters", COUNTERS)?,
            deep: if settings.layers > 1 {
                let behind = buffer("lf.behind", BEHIND * pixels)?;
                let mut image = || buffer("lf.carried", LIGHT * pixels);
                Some(Deep { behind, carried: if kept > 0 { Some([image()?, image()?]) } else { None } })
            } else {
                None
            },
        })
    }

    /// Sums over samples: buffers and bytes of a pixel.
    pub fn sums(&self) -> impl Iterator<Item = (BufferId, u64)> {
        let pixels = self.pixels.iter().map(|buffer| (*buffer, PIXEL));
        pixels.chain(self.fronts.iter().map(|buffer| (*buffer, FRONT)))
    }

    /// Gives all back.
    pub fn destroy<B: Backend>(self, backend: &mut B) -> Result<(), Error> {
        let Self { pixels, fronts, guides, further, direct, radiance, counters, deep } = self;
        let deep = deep.iter().flat_map(|deep| [deep.behind].into_iter().chain(deep.carried.into_iter().flatten()));
        let images = [guides, further[0], further[1], direct[0], direct[1], radiance, counters];
        for buffer in pixels.into_iter().chain(fronts).chain(images).chain(deep) {
            backend.destroy(buffer)?;
        }
        Ok(())
    }
}

/// Elements `first .. first + count` of a buffer.
pub(super) fn part(buffer: BufferId, stride: u64, first: u32, count: u32) -> Binding {
    Binding { buffer, offset: u64::from(first) * stride, size: u64::from(count) * stride }
}
