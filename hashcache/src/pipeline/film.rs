//! Whole paths into pixels, and pixels into a picture.

use backend_api::{Backend, Binding, Items, Kernel};
use hashcache_core::stages::CastsRays;
use layered_filter::NoisePixel;
use pt_integrator::film::{FilmPixel, MomentPixel};
use pt_integrator::kernels::{RESOLVE, RESOLVE_MOMENTS, TRACE_FILM, TRACE_MOMENTS};

use super::{Error, PATHS_PER_SUBMIT, Pass, Resident, Work, create, read};
use crate::accuracy::luminance;
use crate::choice::Moments;
use crate::image_file::Image;
use crate::preview::Progress;
use crate::settings::Settings;

/// Sums of whole paths, a pixel each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Film {
    sums: Binding,
    moments: Moments,
}

impl Film {
    pub fn new<B: Backend>(backend: &mut B, settings: &Settings, pixels: u32) -> Result<Self, Error> {
        let moments = settings.path_moments;
        let bytes = match moments {
            Moments::Off => size_of::<FilmPixel>(),
            Moments::On => size_of::<MomentPixel>(),
        };
        Ok(Self { sums: create(backend, "film", u64::from(pixels) * bytes as u64)?, moments })
    }

    /// The buffer, which zeros empty.
    pub const fn sums(&self) -> Binding {
        self.sums
    }

    /// The kernels that trace and that resolve.
    const fn kernels(&self) -> [&'static Kernel; 2] {
        match self.moments {
            Moments::Off => [&TRACE_FILM, &RESOLVE],
            Moments::On => [&TRACE_MOMENTS, &RESOLVE_MOMENTS],
        }
    }

    /// Whole paths into the film.
    pub fn trace<B: CastsRays>(
        &self,
        backend: &mut B,
        pass: &Pass<'_>,
        traced: u32,
        work: &mut Work,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(), Error> {
        let (total, pixels) = (pass.settings.spp, pass.resident.pixels);
        let at_once = (PATHS_PER_SUBMIT / u64::from(pixels)).clamp(1, u64::from(total)) as u32;
        let mut done = 0;
        while done < total {
            let samples = at_once.min(total - done);
            let params = pass.trace_params(0, traced.wrapping_add(done), samples);
            let Resident { triangles, scene, texels, counters, .. } = pass.resident;
            let bindings = [triangles, scene, texels, self.sums, counters];
            work.stage(backend, "trace", |backend| {
                backend.dispatch(self.kernels()[0], bytemuck::bytes_of(&params), &bindings, Items::Count(pixels))
            })?;
            done += samples;
            progress(Progress { stage: "trace", done, total });
        }
        Ok(())
    }

    /// The film's mean as a picture.
    pub fn resolve<B: Backend>(&self, backend: &mut B, pass: &Pass<'_>, work: &mut Work) -> Result<Image, Error> {
        Ok(pass.picture(&self.texels(backend, pass.resident.pixels, work)?))
    }

    /// Each pixel's error by the scatter of its samples; `None` where that is not kept.
    pub fn noise<B: Backend>(&self, backend: &mut B, pixels: u32) -> Result<Option<Vec<NoisePixel>>, Error> {
        if self.moments == Moments::Off {
            return Ok(None);
        }
        let texels = self.texels(backend, pixels, &mut Work::default())?;
        let noise = texels.chunks_exact(16).map(|texel| {
            let [r, g, b, variance]: [f32; 4] = bytemuck::pod_read_unaligned(texel);
            NoisePixel { radiance: luminance([r, g, b]) as f32, variance }
        });
        Ok(Some(noise.collect()))
    }

    fn texels<B: Backend>(&self, backend: &mut B, pixels: u32, work: &mut Work) -> Result<Vec<u8>, Error> {
        let radiance = create(backend, "radiance", u64::from(pixels) * 16)?;
        work.stage(backend, "resolve", |backend| {
            backend.dispatch(self.kernels()[1], &[], &[self.sums, radiance], Items::Count(pixels))
        })?;
        let bytes = read(backend, radiance)?;
        backend.destroy(radiance.buffer)?;
        Ok(bytes)
    }
}
