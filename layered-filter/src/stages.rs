//! The filter as the pipeline sees it: buffers, and the kernels in their order.

mod buffers;
mod picture;

use alloc::vec;
use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferId, Error, Items, Kernel, Ticket};
use bytemuck::bytes_of;
use hashcache_core::error::ParamError;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;

use crate::atrous::ATrous;
use crate::bilateral::CrossBilateral;
use crate::denoiser::Denoiser;
use crate::front::{Behind, FrontPixel};
use crate::guide::{GuideScale, PreparedGuide};
use crate::kernels::{
    self, ACCUMULATE, ATROUS, BILATERAL, CLEAR, COMPOSE, FILL, FilterCounters, GATHER, GATHER_FRONT, GIVE, PREPARE,
    RADIANCE,
};
use crate::pixel::{Direct, GatherParams, LayerPixel};
use crate::weights::{WeightSettings, Weights};

use buffers::{Buffers, COUNTERS, FRONT, GUIDE, LIGHT, PIXEL, part};

/// The denoiser of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one a picture, and `Copy` is worth more than its 1.7 kB")]
pub enum Filter {
    /// None: sums are resolved and holes filled, that is all.
    None,
    /// [`CrossBilateral`].
    CrossBilateral(CrossBilateral),
    /// [`ATrous`].
    ATrous(ATrous),
}

impl Filter {
    /// Number of passes over each image.
    pub fn passes(&self) -> u32 {
        match self {
            Self::None => 0,
            Self::CrossBilateral(denoiser) => denoiser.passes(),
            Self::ATrous(denoiser) => denoiser.passes(),
        }
    }

    /// The kernel of a pass.
    pub fn kernel(&self) -> Option<&'static Kernel> {
        match self {
            Self::None => None,
            Self::CrossBilateral(_) => Some(&BILATERAL),
            Self::ATrous(_) => Some(&ATROUS),
        }
    }
}

/// What a picture's filter is built with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSettings {
    /// Pixels of a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Where direct light comes from; [`Direct::Record`] makes it an image of its own.
    pub direct: Direct,
    /// Radius of the scene's bounding sphere in scene units.
    pub radius: f32,
    /// Angle of a pixel, 2·tan(`fov_y`/2)/height.
    pub pixel_angle: f32,
    /// The denoiser of the cache's light (of all light with [`Direct::Estimate`]).
    pub further: Filter,
    /// The denoiser of direct light.
    pub direct_filter: Filter,
    /// The denoiser of light from behind that is filtered with the guides of what it passes.
    pub carried: Filter,
    /// Layers, 1 to [`MAX_LAYERS`]: records and estimates of a pixel that follow each other.
    pub layers: u32,
    /// How layers become a picture; nothing to a single one.
    pub composition: Composition,
}

/// The most layers of a picture.
pub const MAX_LAYERS: u32 = 8;

/// How layers become a picture, deepest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Composition {
    /// Each layer is filtered with its own guides, and what it sends forward is not touched again: all lobes in front are
    /// narrow.
    Layered,
    /// The same, and light that passes rough lobes ([`crate::front::LEAST_ROUGHNESS`]) is filtered once more with the
    /// guides of the vertices that it passes there.
    LayeredRough,
    /// Only the first layer is filtered; all light from behind it at once, with the guides of the vertices that it
    /// passes there.
    Screen,
}

/// A picture's sums, guides and images in the buffers of a backend.
///
/// A frame: [`gather`](Self::gather) for every batch of records and estimates, as often as there are samples;
/// [`filter`](Self::filter); then [`radiance`](Self::radiance) is the picture. Sums stay until [`clear`](Self::clear), so
/// a camera at rest converges.
///
/// Per pixel: 128 bytes of sums, 64 of guides, 16 of radiance and 32 an image (16 for direct light that is not apart), 256
/// or 272 in all. With several layers 128 for each further one and 32 for what is behind; 48 for each layer whose light
/// from behind is filtered, and 32 for the image of it.
#[derive(Debug)]
pub struct FilterStages {
    settings: FilterSettings,
    scale: GuideScale,
    gather: GatherParams,
    surface: Weights,
    buffers: Option<Buffers>,
}

/// Dispatches over sums cover at most this many pixels: 2¹⁹·128 bytes fit the binding of every device.
const CHUNK: u32 = 1 << 19;

impl FilterStages {
    /// A filter for pictures of one size.
    ///
    /// # Errors
    /// [`ParamError`] when a size is not 1 to 65,535, layers are not 1 to [`MAX_LAYERS`], or radius or angle are out of
    /// range.
    pub fn new(settings: &FilterSettings) -> Result<Self, ParamError> {
        ParamError::check_range("width", f64::from(settings.width), 1.0, 65_535.0)?;
        ParamError::check_range("height", f64::from(settings.height), 1.0, 65_535.0)?;
        ParamError::check_range("layers", f64::from(settings.layers), 1.0, f64::from(MAX_LAYERS))?;
        let scale = GuideScale::new(settings.radius)?;
        let gather = GatherParams::new(settings.pixel_angle, settings.direct, 1, 1)?;
        let surface = Weights::new(&WeightSettings::surface(settings.pixel_angle))?;
        Ok(Self { settings: *settings, scale, gather, surface, buffers: None })
    }

    /// The settings.
    pub const fn settings(&self) -> &FilterSettings {
        &self.settings
    }

    /// Replaces the denoisers; sums stay.
    pub const fn set_filters(&mut self, further: Filter, direct: Filter, carried: Filter) {
        self.settings.further = further;
        self.settings.direct_filter = direct;
        self.settings.carried = carried;
    }

    /// Replaces the pixels' angle, for a camera that was zoomed; [`clear`](Self::clear) belongs to it.
    ///
    /// # Errors
    /// [`ParamError`] when the angle is out of range.
    pub fn set_pixel_angle(&mut self, pixel_angle: f32) -> Result<(), ParamError> {
        self.gather = GatherParams::new(pixel_angle, self.settings.direct, 1, 1)?;
        self.surface = Weights::new(&WeightSettings::surface(pixel_angle))?;
        self.settings.pixel_angle = pixel_angle;
        Ok(())
    }

    /// Number of pixels.
    pub const fn pixels(&self) -> u32 {
        self.settings.width * self.settings.height
    }

    /// Bytes of all buffers.
    pub fn bytes(&self) -> u64 {
        let FilterSettings { direct, layers, composition, .. } = self.settings;
        u64::from(self.pixels()) * Self::pixel_bytes(direct, layers, composition) + COUNTERS
    }

    /// Bytes of a pixel.
    ///
    /// ```
    /// use layered_filter::{Composition, Direct, FilterStages};
    /// assert_eq!(FilterStages::pixel_bytes(Direct::Estimate, 1, Composition::Layered), 256);
    /// assert_eq!(FilterStages::pixel_bytes(Direct::Estimate, 4, Composition::Layered), 672);
    /// // A further layer: 133 bytes at least, 240 at most.
    /// assert_eq!(FilterStages::pixel_bytes(Direct::Estimate, 8, Composition::Layered), 256 + 7 * 128 + 32);
    /// assert_eq!(FilterStages::pixel_bytes(Direct::Estimate, 2, Composition::LayeredRough), 256 + 240);
    /// ```
    pub const fn pixel_bytes(direct: Direct, layers: u32, composition: Composition) -> u64 {
        buffers::pixel_bytes(direct, layers, composition)
    }

    /// Names of the kernels, in the order of their first use.
    pub fn kernels(&self) -> Vec<&'static str> {
        let deep = self.settings.layers > 1;
        let fronts = buffers::fronts(self.settings.layers, self.settings.composition) > 0;
        let mut names = vec![GATHER.name];
        let mut push = |kernel: &Kernel, used: bool| {
            if used && !names.contains(&kernel.name) {
                names.push(kernel.name);
            }
        };
        push(&GATHER_FRONT, fronts);
        push(&PREPARE, true);
        push(&FILL, true);
        let filters = [&self.settings.further, &self.settings.direct_filter];
        for filter in filters {
            if let Some(kernel) = filter.kernel() {
                push(kernel, true);
            }
        }
        push(&COMPOSE, !deep);
        push(&ACCUMULATE, deep);
        if let Some(kernel) = self.settings.carried.kernel() {
            push(&kernels::FRONT, fronts);
            push(kernel, fronts);
            push(&GIVE, fronts);
        }
        push(&RADIANCE, deep);
        names
    }

    /// Creates the buffers, all sums 0; on a further call clears the sums.
    ///
    /// # Errors
    /// Those of the backend.
    pub fn prepare<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        if self.buffers.is_some() {
            return self.clear(backend);
        }
        self.buffers = Some(Buffers::new(backend, &self.settings, self.pixels().into())?);
        Ok(())
    }

    /// Records the emptying of all sums: the camera moved.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn clear<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        self.buffers(CLEAR.name)?.sums().try_for_each(|(buffer, stride)| self.clear_buffer(backend, buffer, stride))
    }

    /// Zeros a buffer of so many bytes a pixel.
    fn clear_buffer<B: Backend>(&self, backend: &mut B, buffer: BufferId, stride: u64) -> Result<(), Error> {
        self.by_chunks(|first, count| {
            let words = part(buffer, stride, first, count);
            backend.dispatch(&CLEAR, &[], &[words], Items::Count((words.size / 16) as u32))
        })
    }

    /// Records the adding of a sample to each of `count` pixels from `first` on: pixel `first + i` gets the records from
    /// i·`record_stride` on, one a layer, and the estimates from i·`estimate_stride` on. Where these are fewer than the
    /// layers, nothing is added to the others: they had better be empty.
    ///
    /// `first` is a multiple of 2, with several layers of 16 (bindings start at multiples of 256 bytes).
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    #[expect(clippy::too_many_arguments, reason = "two bindings with a stride each, and a range")]
    pub fn gather<B: Backend>(
        &self,
        backend: &mut B,
        records: Binding,
        record_stride: u32,
        estimates: Binding,
        estimate_stride: u32,
        first: u32,
        count: u32,
    ) -> Result<(), Error> {
        let buffers = self.buffers(GATHER.name)?;
        let params = self.gather.with_strides(record_stride, estimate_stride);
        for (layer, sums) in (0..record_stride.max(1)).zip(&buffers.pixels) {
            let params = params.with_layer(layer);
            let pixels = part(*sums, PIXEL, first, count);
            match buffers.fronts.get(layer as usize) {
                None => {
                    let bindings = [records, estimates, pixels];
                    backend.dispatch(&GATHER, bytes_of(&params), &bindings, Items::Count(count))?;
                }
                Some(fronts) => {
                    let bindings = [records, estimates, pixels, part(*fronts, FRONT, first, count)];
                    backend.dispatch(&GATHER_FRONT, bytes_of(&params), &bindings, Items::Count(count))?;
                }
            }
        }
        Ok(())
    }

    /// The picture (`[f32; 4]` a pixel: radiance, 0), once prepared.
    pub fn radiance(&self) -> Option<Binding> {
        self.buffers.as_ref().map(|buffers| part(buffers.radiance, LIGHT, 0, self.pixels()))
    }

    /// The sums ([`LayerPixel`]) of a layer, once prepared; `None` for a layer that there is not.
    pub fn sums(&self, layer: u32) -> Option<Binding> {
        let pixels = self.buffers.as_ref()?.pixels.get(layer as usize)?;
        Some(part(*pixels, PIXEL, 0, self.pixels()))
    }

    /// The guides ([`PreparedGuide`]) of the first layer after the last call of [`filter`](Self::filter), once prepared.
    pub fn guides(&self) -> Option<Binding> {
        self.buffers.as_ref().map(|buffers| part(buffers.guides, GUIDE, 0, self.pixels()))
    }

    /// Asks for the counters of the last [`filter`](Self::filter) that was submitted; [`counters`](Self::counters) reads
    /// the bytes.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn read_counters<B: Backend>(&self, backend: &mut B) -> Result<Ticket, Error> {
        backend.read(self.buffers("lf.counters")?.counters, 0, COUNTERS)
    }

    /// The counters in the bytes that a ticket of [`read_counters`](Self::read_counters) was redeemed for.
    pub fn counters(bytes: &[u8]) -> FilterCounters {
        bytemuck::try_pod_read_unaligned(bytes).unwrap_or_default()
    }

    /// Gives the buffers back.
    ///
    /// # Errors
    /// Those of the backend.
    pub fn release<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        self.buffers.take().map_or(Ok(()), |buffers| buffers.destroy(backend))
    }

    fn buffers(&self, at: &'static str) -> Result<&Buffers, Error> {
        self.buffers.as_ref().ok_or(Error::UnknownBuffer { at })
    }
}

// The strides that the kernels declare are those of the records.
const _: () = assert!(size_of::<VertexRecord>() == 96 && size_of::<EstimateRecord>() == 32);
const _: () = assert!(size_of::<LayerPixel>() == 128 && size_of::<PreparedGuide>() == 64);
const _: () = assert!(size_of::<FrontPixel>() == 48 && size_of::<Behind>() == 32);
