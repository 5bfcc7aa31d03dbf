//! Some of a picture's pixels, traced once more by paths that know of no cache.

use backend_api::{Binding, Items};
use hashcache_core::stages::CastsRays;
use pt_integrator::film::PairedPixel;
use pt_integrator::kernels::TRACE_PAIRS;
use pt_integrator::path::RayCounts;

use super::{Error, PATHS_PER_SUBMIT, Pass, Resident, Work, create, part, read, upload_all};
use crate::accuracy::{CheckStats, Compared, bias, is_chosen, luminance, mean_square, path_seed, probabilities};
use crate::image_file::Image;
use crate::preview::{Preview, Progress};
use crate::settings::Settings;
use crate::stats::Rays;

/// Pixels of one dispatch: 2¹⁹ · 80 bytes stay below every device's binding limit and begin where bindings may.
const AT_ONCE: u32 = 1 << 19;

/// The pixels that are checked, what paths tell of them, and how the picture differs.
#[derive(Debug)]
pub(super) struct Check {
    /// By rising index, each with the probability of its choice.
    pixels: Vec<(u32, f64)>,
    /// A [`PairedPixel`] each; none when no pixel was chosen.
    sums: Option<Binding>,
    counters: Binding,
    /// Paths in each half.
    traced: u32,
    /// The last picture's.
    figures: Option<CheckStats>,
    /// Last picture − paths, a pixel each.
    differences: Vec<[f32; 3]>,
}

impl Check {
    /// Nothing without any share.
    pub fn new<B: CastsRays>(backend: &mut B, preview: &Preview) -> Result<Option<Self>, Error> {
        if preview.settings().check_fraction <= 0.0 {
            return Ok(None);
        }
        let counters = create(backend, "check counters", (RayCounts::WORDS * 8) as u64)?;
        let (pixels, differences) = (Vec::new(), Vec::new());
        Ok(Some(Self { pixels, sums: None, counters, traced: 0, figures: None, differences }))
    }

    /// Chooses the pixels of a picture, all without paths.
    fn choose<B: CastsRays>(&mut self, backend: &mut B, settings: &Settings, image: &Image) -> Result<(), Error> {
        if let Some(sums) = self.sums.take() {
            backend.destroy(sums.buffer)?;
        }
        let luminances: Vec<f64> = image.pixels.iter().map(|&pixel| luminance(pixel)).collect();
        let chances = (0..).zip(probabilities(&luminances, settings.check_fraction));
        self.pixels = chances.filter(|&(pixel, chance)| is_chosen(pixel, settings.seed, chance)).collect();
        self.traced = 0;
        let empty: Vec<_> = self.pixels.iter().map(|&(pixel, _)| PairedPixel::new(pixel)).collect();
        if !empty.is_empty() {
            let [sums] = upload_all(backend, [("checked pixels", bytemuck::cast_slice(&empty))])?;
            self.sums = Some(sums);
        }
        Ok(())
    }

    /// More paths through the pixels, all of them anew where the camera moved, and what they tell of the picture.
    pub fn frame<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        moved: bool,
        image: &Image,
        work: &mut Work,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(), Error> {
        if moved {
            self.choose(backend, pass.settings, image)?;
        }
        if let Some(sums) = self.sums {
            self.trace(backend, pass, sums, work, progress)?;
        }
        self.compare(backend, pass, image)
    }

    fn trace<B: CastsRays>(
        &mut self,
        backend: &mut B,
        pass: &Pass<'_>,
        sums: Binding,
        work: &mut Work,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(), Error> {
        let count = self.pixels.len() as u32;
        let Resident { triangles, scene, texels, .. } = pass.resident;
        let half = pass.settings.check_spp / 2;
        let at_once = (PATHS_PER_SUBMIT / (2 * u64::from(count))).clamp(1, u64::from(half)) as u32;
        let mut done = 0;
        while done < half {
            let samples = at_once.min(half - done);
            let mut params = pass.trace_params(0, self.traced, samples);
            params.seed = path_seed(pass.settings.seed);
            work.stage(backend, "check", |backend| {
                (0..count).step_by(AT_ONCE as usize).try_for_each(|first| {
                    let count = AT_ONCE.min(count - first);
                    let film = part(sums, size_of::<PairedPixel>(), first, count);
                    let bindings = [triangles, scene, texels, film, self.counters];
                    backend.dispatch(&TRACE_PAIRS, bytemuck::bytes_of(&params), &bindings, Items::Count(count))
                })
            })?;
            done += samples;
            self.traced = self.traced.wrapping_add(samples);
            progress(Progress { stage: "check", done: 2 * done, total: 2 * half });
        }
        Ok(())
    }

    /// How a picture of the pixels differs from the paths so far.
    pub fn compare<B: CastsRays>(&mut self, backend: &mut B, pass: &Pass<'_>, image: &Image) -> Result<(), Error> {
        let sums = self.sums.map_or(Ok(Vec::new()), |sums| read(backend, sums))?;
        let all = image.pixels.len() as u64;
        let mut compared = Vec::with_capacity(self.pixels.len());
        self.differences.clear();
        for (sum, &(_, probability)) in sums.chunks_exact(size_of::<PairedPixel>()).zip(&self.pixels) {
            let sum: PairedPixel = bytemuck::pod_read_unaligned(sum);
            let [a, b] = sum.means().map(|mean| mean.to_array());
            let picture = image.pixels[sum.pixel as usize];
            compared.push(Compared { picture: luminance(picture), truths: [luminance(a), luminance(b)], probability });
            self.differences.push(std::array::from_fn(|c| picture[c] - (0.5 * a[c] + 0.5 * b[c])));
        }
        let counts = Resident { counters: self.counters, ..pass.resident }.ray_counts(backend)?;
        let mean = image.pixels.iter().map(|&pixel| luminance(pixel)).sum::<f64>() / all.max(1) as f64;
        let bias = bias(&compared, all);
        self.figures = Some(CheckStats {
            pixels: self.pixels.len() as u64,
            samples_per_pixel: self.traced.saturating_mul(2),
            mean_radiance: mean,
            bias,
            relative_bias: bias.filter(|_| mean > 0.0).map(|bias| bias.scaled(1.0 / mean)),
            mse: mean_square(&compared, all),
            rays: Rays {
                closest: counts.closest,
                shadow_asked: counts.shadow_asked,
                shadow_traced: counts.shadow_traced,
            },
            non_finite: counts.non_finite,
        });
        Ok(())
    }

    /// The last picture's figures.
    pub fn figures(&self) -> Option<CheckStats> {
        self.figures
    }

    /// Last picture − paths at the pixels that were checked, black elsewhere; and the number of paths.
    pub fn pictures(&self, width: u32, height: u32) -> [(&'static str, Image); 2] {
        let black = vec![[0.0; 3]; width as usize * height as usize];
        let mut images = [black.clone(), black];
        let paths = self.figures.map_or(0.0, |figures| figures.samples_per_pixel as f32);
        for (&(pixel, _), &difference) in self.pixels.iter().zip(&self.differences) {
            images[0][pixel as usize] = difference;
            images[1][pixel as usize] = [paths; 3];
        }
        let [differences, samples] = images.map(|pixels| Image { width, height, pixels });
        [("check", differences), ("check_samples", samples)]
    }
}
