//! The filter as the pipeline sees it: buffers, and the kernels in their order.

use alloc::vec;
use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferDesc, BufferId, Error, Items, Kernel, Ticket};
use bytemuck::{Pod, bytes_of};
use hashcache_core::error::ParamError;
use hashcache_core::record::VertexRecord;
use hashcache_core::stages::EstimateRecord;

use crate::atrous::ATrous;
use crate::bilateral::CrossBilateral;
use crate::denoiser::Denoiser;
use crate::guide::{GuideScale, PreparedGuide};
use crate::image::Light;
use crate::kernels::{ATROUS, BILATERAL, COMPOSE, FILL, FilterCounters, GATHER, ImageParams, PREPARE};
use crate::pixel::{Direct, GatherParams, LayerPixel};
use crate::weights::{WeightSettings, Weights};

/// The denoiser of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one a picture, and `Copy` is worth more than its 1.6 kB")]
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
}

/// A picture's sums, guides and images in the buffers of a backend.
///
/// A frame: [`gather`](Self::gather) for every batch of records and estimates, as often as there are samples;
/// [`filter`](Self::filter); then [`radiance`](Self::radiance) is the picture. Sums stay until [`clear`](Self::clear), so
/// a camera at rest converges.
///
/// Per pixel: 128 bytes of sums, 64 of guides, 16 of radiance and 32 an image (16 for direct light that is not apart), 256
/// or 272 in all.
#[derive(Debug)]
pub struct FilterStages {
    settings: FilterSettings,
    scale: GuideScale,
    gather: GatherParams,
    surface: Weights,
    buffers: Option<Buffers>,
}

/// Each image has two buffers, which passes read and write in turn.
#[derive(Clone, Copy, Debug)]
struct Buffers {
    pixels: BufferId,
    guides: BufferId,
    further: [BufferId; 2],
    direct: [BufferId; 2],
    radiance: BufferId,
    counters: BufferId,
}

impl Buffers {
    fn all(&self) -> [BufferId; 8] {
        let Self { pixels, guides, further, direct, radiance, counters } = *self;
        [pixels, guides, further[0], further[1], direct[0], direct[1], radiance, counters]
    }
}

const PIXEL: u64 = size_of::<LayerPixel>() as u64;
const LIGHT: u64 = size_of::<Light>() as u64;
const COUNTER_BYTES: u64 = size_of::<FilterCounters>() as u64;

/// Dispatches over sums cover at most this many pixels: 2¹⁹·128 bytes fit the binding of every device.
const CHUNK: u32 = 1 << 19;

impl FilterStages {
    /// A filter for pictures of one size.
    ///
    /// # Errors
    /// [`ParamError`] when a size is not 1 to 65,535 or radius or angle are out of range.
    pub fn new(settings: &FilterSettings) -> Result<Self, ParamError> {
        ParamError::check_range("width", f64::from(settings.width), 1.0, 65_535.0)?;
        ParamError::check_range("height", f64::from(settings.height), 1.0, 65_535.0)?;
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
    pub const fn set_filters(&mut self, further: Filter, direct: Filter) {
        self.settings.further = further;
        self.settings.direct_filter = direct;
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
        let images = if self.settings.direct == Direct::Record { 5 } else { 4 };
        let pixel = PIXEL + size_of::<PreparedGuide>() as u64 + images * LIGHT;
        u64::from(self.pixels()) * pixel + COUNTER_BYTES
    }

    /// Names of the kernels, in their order.
    pub fn kernels(&self) -> Vec<&'static str> {
        let mut names = vec![GATHER.name, PREPARE.name, FILL.name];
        for filter in [&self.settings.further, &self.settings.direct_filter] {
            if let Some(kernel) = filter.kernel().filter(|kernel| !names.contains(&kernel.name)) {
                names.push(kernel.name);
            }
        }
        names.push(COMPOSE.name);
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
        let pixels = u64::from(self.pixels());
        let mut made = Vec::with_capacity(8);
        let sizes = [
            ("lf.pixels", PIXEL * pixels),
            ("lf.guides", size_of::<PreparedGuide>() as u64 * pixels),
            ("lf.further", LIGHT * pixels),
            ("lf.further", LIGHT * pixels),
            ("lf.direct", LIGHT * pixels),
            // What is not apart is not filtered.
            ("lf.direct", LIGHT * if self.settings.direct == Direct::Record { pixels } else { 1 }),
            ("lf.radiance", LIGHT * pixels),
            ("lf.counters", COUNTER_BYTES),
        ];
        for (name, size) in sizes {
            match backend.create(&BufferDesc { name, size }) {
                Ok(buffer) => made.push(buffer),
                Err(error) => {
                    for buffer in made {
                        backend.destroy(buffer)?;
                    }
                    return Err(error);
                }
            }
        }
        let [pixels, guides, f0, f1, d0, d1, radiance, counters] = made[..] else { unreachable!("eight sizes") };
        self.buffers = Some(Buffers { pixels, guides, further: [f0, f1], direct: [d0, d1], radiance, counters });
        Ok(())
    }

    /// Records the emptying of all sums: the camera moved.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn clear<B: Backend>(&mut self, backend: &mut B) -> Result<(), Error> {
        let buffer = self.buffers("lf.clear")?.pixels;
        backend.primitive(backend_api::Primitive::Fill { buffer, word: 0 })
    }

    /// Records the adding of a sample to each of `count` pixels from `first` on: pixel `first + i` gets record
    /// i·`record_stride` and estimate i·`estimate_stride`.
    ///
    /// `first` is a multiple of 2 (bindings start at multiples of 256 bytes).
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
        let pixels = part(buffers.pixels, PIXEL, first, count);
        backend.dispatch(&GATHER, bytes_of(&params), &[records, estimates, pixels], Items::Count(count))
    }

    /// Records everything from sums to [`radiance`](Self::radiance).
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn filter<B: Backend>(&self, backend: &mut B) -> Result<(), Error> {
        let buffers = *self.buffers(PREPARE.name)?;
        backend.write(buffers.counters, 0, bytes_of(&FilterCounters { ..FilterCounters::default() }))?;
        let counters = Binding { buffer: buffers.counters, offset: 0, size: COUNTER_BYTES };
        for (first, count) in self.chunks() {
            let bindings = [
                part(buffers.pixels, PIXEL, first, count),
                part(buffers.guides, size_of::<PreparedGuide>() as u64, first, count),
                part(buffers.direct[0], LIGHT, first, count),
                part(buffers.further[0], LIGHT, first, count),
                counters,
            ];
            backend.dispatch(&PREPARE, bytes_of(&self.scale), &bindings, Items::Count(count))?;
        }
        let further = self.passes(backend, &buffers, &self.settings.further, buffers.further)?;
        let direct = match self.settings.direct {
            // Traced light has no holes to fill.
            Direct::Record if self.settings.direct_filter != Filter::None => {
                self.passes(backend, &buffers, &self.settings.direct_filter, buffers.direct)?
            }
            _ => buffers.direct[0],
        };
        for (first, count) in self.chunks() {
            let bindings = [
                part(buffers.pixels, PIXEL, first, count),
                part(direct, LIGHT, first, count),
                part(further, LIGHT, first, count),
                part(buffers.radiance, LIGHT, first, count),
            ];
            backend.dispatch(&COMPOSE, &[], &bindings, Items::Count(count))?;
        }
        Ok(())
    }

    /// Fills and filters an image whose light is in the first of its buffers; returns the buffer where it ends.
    fn passes<B: Backend>(
        &self,
        backend: &mut B,
        buffers: &Buffers,
        filter: &Filter,
        [mut from, mut to]: [BufferId; 2],
    ) -> Result<BufferId, Error> {
        let count = self.pixels();
        let guides = part(buffers.guides, size_of::<PreparedGuide>() as u64, 0, count);
        let counters = Binding { buffer: buffers.counters, offset: 0, size: COUNTER_BYTES };
        let bindings = [guides, part(from, LIGHT, 0, count), part(to, LIGHT, 0, count), counters];
        let params = self.block(0, &self.fill_weights(filter));
        backend.dispatch(&FILL, &params, &bindings, Items::Count(count))?;
        (from, to) = (to, from);
        let Some(kernel) = filter.kernel() else { return Ok(from) };
        for pass in 0..filter.passes() {
            let params = match filter {
                Filter::None => return Ok(from),
                Filter::CrossBilateral(denoiser) => self.block(pass, denoiser),
                Filter::ATrous(denoiser) => self.block(pass, denoiser),
            };
            let bindings = [guides, part(from, LIGHT, 0, count), part(to, LIGHT, 0, count)];
            backend.dispatch(kernel, &params, &bindings, Items::Count(count))?;
            (from, to) = (to, from);
        }
        Ok(from)
    }

    /// The weights by which holes are filled: the filter's own.
    fn fill_weights(&self, filter: &Filter) -> Weights {
        match filter {
            Filter::None => self.surface,
            Filter::CrossBilateral(denoiser) => *denoiser.weights(),
            Filter::ATrous(denoiser) => *denoiser.weights(),
        }
    }

    /// The parameter block of a kernel that reads neighbours.
    fn block<T: Pod>(&self, pass: u32, rest: &T) -> Vec<u8> {
        let head = ImageParams { width: self.settings.width, height: self.settings.height, pass, first: 0 };
        [bytes_of(&head), bytes_of(rest)].concat()
    }

    fn chunks(&self) -> impl Iterator<Item = (u32, u32)> {
        let pixels = self.pixels();
        (0..pixels).step_by(CHUNK as usize).map(move |first| (first, CHUNK.min(pixels - first)))
    }

    /// The picture (`[f32; 4]` a pixel: radiance, 0), once prepared.
    pub fn radiance(&self) -> Option<Binding> {
        self.buffers.map(|buffers| part(buffers.radiance, LIGHT, 0, self.pixels()))
    }

    /// The sums ([`LayerPixel`]), once prepared.
    pub fn sums(&self) -> Option<Binding> {
        self.buffers.map(|buffers| part(buffers.pixels, PIXEL, 0, self.pixels()))
    }

    /// The guides ([`PreparedGuide`]) of the last call of [`filter`](Self::filter), once prepared.
    pub fn guides(&self) -> Option<Binding> {
        self.buffers.map(|buffers| part(buffers.guides, size_of::<PreparedGuide>() as u64, 0, self.pixels()))
    }

    /// Asks for the counters of the last [`filter`](Self::filter) that was submitted; [`counters`](Self::counters) reads
    /// the bytes.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn read_counters<B: Backend>(&self, backend: &mut B) -> Result<Ticket, Error> {
        backend.read(self.buffers("lf.counters")?.counters, 0, COUNTER_BYTES)
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
        for buffer in self.buffers.take().iter().flat_map(Buffers::all) {
            backend.destroy(buffer)?;
        }
        Ok(())
    }

    fn buffers(&self, at: &'static str) -> Result<&Buffers, Error> {
        self.buffers.as_ref().ok_or(Error::UnknownBuffer { at })
    }
}

/// Elements `first .. first + count` of a buffer.
fn part(buffer: BufferId, stride: u64, first: u32, count: u32) -> Binding {
    Binding { buffer, offset: u64::from(first) * stride, size: u64::from(count) * stride }
}

// The strides that the kernels declare are those of the records.
const _: () = assert!(size_of::<VertexRecord>() == 96 && size_of::<EstimateRecord>() == 32);
const _: () = assert!(size_of::<LayerPixel>() == 128 && size_of::<PreparedGuide>() == 64);
