//! From sums to a picture.

use alloc::vec::Vec;

use backend_api::{Backend, Binding, BufferId, Error, Items};
use bytemuck::{Pod, Zeroable, bytes_of};

use super::buffers::{BEHIND, Buffers, COUNTERS, Deep, FRONT, GUIDE, LIGHT, PIXEL, part};
use super::{CHUNK, Composition, Filter, FilterStages};
use crate::kernels::{
    self, ACCUMULATE, COMPOSE, FILL, FilterCounters, FrontParams, GIVE, ImageParams, NOISE, NoiseParams, PREPARE,
    RADIANCE,
};
use crate::noise::NoisePixel;
use crate::pixel::Direct;
use crate::weights::Weights;

/// Bytes of a pixel's noise.
const NOISE_PIXEL: u64 = size_of::<NoisePixel>() as u64;

impl FilterStages {
    /// Records everything from sums to [`radiance`](Self::radiance).
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn filter<B: Backend>(&self, backend: &mut B) -> Result<(), Error> {
        let buffers = self.buffers(PREPARE.name)?;
        backend.write(buffers.counters, 0, bytes_of(&FilterCounters::default()))?;
        let Some(deep) = &buffers.deep else {
            let [direct, further] = self.layer(backend, buffers, 0, true)?;
            return self.by_chunks(|first, count| {
                let bindings = [
                    part(buffers.pixels[0], PIXEL, first, count),
                    part(direct, LIGHT, first, count),
                    part(further, LIGHT, first, count),
                    part(buffers.radiance, LIGHT, first, count),
                ];
                backend.dispatch(&COMPOSE, &[], &bindings, Items::Count(count))
            });
        };
        self.clear_buffer(backend, deep.behind, BEHIND)?;
        let denoises = self.settings.carried != Filter::None;
        for layer in (0..buffers.pixels.len()).rev() {
            if let (Some(front), Some(carried)) = (buffers.fronts.get(layer).filter(|_| denoises), deep.carried) {
                self.carry(backend, buffers, deep, *front, carried)?;
            }
            let own = self.settings.composition != Composition::Screen || layer == 0;
            let [direct, further] = self.layer(backend, buffers, layer, own)?;
            self.by_chunks(|first, count| {
                let bindings = [
                    part(buffers.pixels[layer], PIXEL, first, count),
                    part(direct, LIGHT, first, count),
                    part(further, LIGHT, first, count),
                    part(deep.behind, BEHIND, first, count),
                ];
                backend.dispatch(&ACCUMULATE, &[], &bindings, Items::Count(count))
            })?;
        }
        self.by_chunks(|first, count| {
            let bindings = [part(deep.behind, BEHIND, first, count), part(buffers.radiance, LIGHT, first, count)];
            backend.dispatch(&RADIANCE, &[], &bindings, Items::Count(count))
        })
    }

    /// Records the adding of all layers' radiance and of its variance to `noise`, [`NoisePixel::default`] for each pixel
    /// before: how wrong the light is that goes into the filter.
    ///
    /// # Errors
    /// Those of the backend; [`Error::UnknownBuffer`] before `prepare`.
    pub fn noise<B: Backend>(&self, backend: &mut B, noise: BufferId) -> Result<(), Error> {
        let direct = u32::from(self.settings.direct == Direct::Record);
        let params = NoiseParams { direct, reserved: [0; 3] };
        self.buffers(NOISE.name)?.pixels.iter().try_for_each(|sums| {
            self.by_chunks(|first, count| {
                let bindings = [part(*sums, PIXEL, first, count), part(noise, NOISE_PIXEL, first, count)];
                backend.dispatch(&NOISE, bytes_of(&params), &bindings, Items::Count(count))
            })
        })
    }

    /// A layer's images of direct and of further light, holes filled, and filtered if asked for.
    fn layer<B: Backend>(
        &self,
        backend: &mut B,
        buffers: &Buffers,
        layer: usize,
        denoise: bool,
    ) -> Result<[BufferId; 2], Error> {
        let counters = Binding { buffer: buffers.counters, offset: 0, size: COUNTERS };
        self.by_chunks(|first, count| {
            let bindings = [
                part(buffers.pixels[layer], PIXEL, first, count),
                part(buffers.guides, GUIDE, first, count),
                part(buffers.direct[0], LIGHT, first, count),
                part(buffers.further[0], LIGHT, first, count),
                counters,
            ];
            backend.dispatch(&PREPARE, bytes_of(&self.scale), &bindings, Items::Count(count))
        })?;
        let further = self.passes(backend, buffers, &self.settings.further, buffers.further, denoise)?;
        let direct = match self.settings.direct {
            // Traced light has no holes to fill.
            Direct::Record if denoise && self.settings.direct_filter != Filter::None => {
                self.passes(backend, buffers, &self.settings.direct_filter, buffers.direct, true)?
            }
            _ => buffers.direct[0],
        };
        Ok([direct, further])
    }

    /// Filters light from behind with the guides of what it passes.
    fn carry<B: Backend>(
        &self,
        backend: &mut B,
        buffers: &Buffers,
        deep: &Deep,
        front: BufferId,
        carried: [BufferId; 2],
    ) -> Result<(), Error> {
        let all = u32::from(self.settings.composition == Composition::Screen);
        let params = FrontParams { scale: self.scale, all, ..FrontParams::zeroed() };
        self.by_chunks(|first, count| {
            let bindings = [
                part(front, FRONT, first, count),
                part(buffers.guides, GUIDE, first, count),
                part(carried[0], LIGHT, first, count),
                part(deep.behind, BEHIND, first, count),
            ];
            backend.dispatch(&kernels::FRONT, bytes_of(&params), &bindings, Items::Count(count))
        })?;
        let filtered = self.denoise(backend, buffers, &self.settings.carried, carried)?;
        self.by_chunks(|first, count| {
            let bindings = [part(filtered, LIGHT, first, count), part(deep.behind, BEHIND, first, count)];
            backend.dispatch(&GIVE, &[], &bindings, Items::Count(count))
        })
    }

    /// Fills an image whose light is in the first of its buffers, and filters it if asked for; returns the buffer where it
    /// ends.
    fn passes<B: Backend>(
        &self,
        backend: &mut B,
        buffers: &Buffers,
        filter: &Filter,
        [from, to]: [BufferId; 2],
        denoise: bool,
    ) -> Result<BufferId, Error> {
        let count = self.pixels();
        let guides = part(buffers.guides, GUIDE, 0, count);
        let counters = Binding { buffer: buffers.counters, offset: 0, size: COUNTERS };
        let bindings = [guides, part(from, LIGHT, 0, count), part(to, LIGHT, 0, count), counters];
        let params = self.block(0, &self.fill_weights(filter));
        backend.dispatch(&FILL, &params, &bindings, Items::Count(count))?;
        if denoise { self.denoise(backend, buffers, filter, [to, from]) } else { Ok(to) }
    }

    /// The passes of a denoiser over the image in the first of two buffers; returns the buffer where it ends.
    fn denoise<B: Backend>(
        &self,
        backend: &mut B,
        buffers: &Buffers,
        filter: &Filter,
        [mut from, mut to]: [BufferId; 2],
    ) -> Result<BufferId, Error> {
        let count = self.pixels();
        let guides = part(buffers.guides, GUIDE, 0, count);
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

    /// All pixels in runs whose sums fit a binding.
    pub(super) fn by_chunks(&self, mut record: impl FnMut(u32, u32) -> Result<(), Error>) -> Result<(), Error> {
        let pixels = self.pixels();
        (0..pixels).step_by(CHUNK as usize).try_for_each(|first| record(first, CHUNK.min(pixels - first)))
    }
}
