//! What a pixel shows: vertices with direct light, through mirrors and glass, and nothing further.

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::traits::{RayCaster, Sampler};

use super::direct::Direct;
use super::scatters::{Lambert, Scatters};
use super::step::{Next, Tracer};
use super::trace::{finish, for_needs};
use super::{DirectSettings, PathOutcome, RayCounts, Strategy};
use crate::bsdf::{Bsdf, Lobe};
use crate::scene::Needs;
use crate::view::SceneView;

/// What [`trace_visible`] looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibleSettings {
    /// How direct light is found.
    pub direct: DirectSettings,
    /// Scatterings at most between the camera and the last vertex, that vertex's own included: a vertex behind so many
    /// mirrors shows its emission and nothing else. The first vertex is always there.
    pub max_bounces: u32,
}

/// Most layers of a pixel.
pub const MAX_LAYERS: usize = 8;

/// Expected weight of all that is behind a layer below which a chain goes on by chance, with probability weight over
/// this. Dielectrics reflect a few percent: smaller, and every pixel of a polished floor traces what it hardly shows;
/// larger, and dark reflections get noisier.
const CERTAIN_WEIGHT: f32 = 1.0 / 8.0;

/// Traces a camera ray of unit direction to what a cache is asked for: a vertex for each layer, with the light that
/// comes there straight from emitters.
///
/// The first layer is the surface that the camera sees. Its diffuse lobe becomes `layers[0]`, in every sample. Then the
/// chain goes on by one of its other lobes, chosen by chance, to the surface of the next layer, and so on. In the last
/// layer the chain chooses among all lobes and walks on until it scatters diffusely. A pixel's radiance is the sum of
/// all layers' `emitted + throughput · illumination`, `throughput` holding the chances of all choices.
///
/// - `emitted`: light of the segment that ends in the layer: emission, the environment, and light that the lobe before
///   it found by next event (weighted against each other).
/// - `direct`: illumination of the diffuse lobe by emitters, an estimate of the same mean as [`super::trace_path`]'s
///   [`PathOutcome::direct`]; `further` is 0.
/// - A surface without a diffuse lobe is a guide ([`PathOutcome::is_guide`]); in the last layer the first surface is,
///   when the walk ends without a diffuse vertex.
/// - Layers behind the chain's end are [`PathOutcome::NONE`]. Scenes of Lambertian surfaces fill the first layer only.
///
/// The settings are taken as they are: see [`DirectSettings::for_scene`]. At most [`MAX_LAYERS`] are filled.
/// `numbers(strategy, layer, i)` makes the sampler of candidate or ray i of a layer. Consecutive indices are stratified
/// together, so a caller passes on indices that go on from sample to sample of a pixel: `Sobol::new(sample · n + i,
/// seed)`, n being [`DirectSettings::all`], [`DirectSettings::scattered`] or 1, with a seed for each strategy and layer.
/// Adds to `counts`. Light that is NaN or infinite is left out in all layers and counted.
///
/// # Source
/// Roth et al. 2020, 3.4 (layers).
///
/// # Panics
/// As [`super::trace_path`].
pub fn trace_visible<C: RayCaster, S: Sampler>(
    scene: &SceneView<'_>,
    caster: &C,
    ray: &Ray,
    settings: &VisibleSettings,
    layers: &mut [PathOutcome],
    numbers: impl FnMut(Strategy, u32, u32) -> S,
    counts: &mut RayCounts,
) {
    let trace = for_needs!(scene, visible_for, C, S, _);
    trace(scene, caster, ray, settings, layers, numbers, counts);
}

fn visible_for<const NEEDS: u32, M: Scatters + Chains, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S>(
    scene: &SceneView<'_>,
    caster: &C,
    ray: &Ray,
    settings: &VisibleSettings,
    layers: &mut [PathOutcome],
    numbers: N,
    counts: &mut RayCounts,
) {
    layers.fill(PathOutcome::NONE);
    let shown = layers.len().min(MAX_LAYERS);
    let layers = &mut layers[..shown];
    if layers.is_empty() {
        return;
    }
    let tracer = Tracer::<NEEDS, C> { scene, caster, counts };
    M::follow(Chain { tracer, settings, layers, numbers }, ray);
    finish(layers, counts);
}

/// A chain of layers.
pub(super) struct Chain<'a, 'b, const NEEDS: u32, C, N> {
    tracer: Tracer<'a, 'b, NEEDS, C>,
    settings: &'a VisibleSettings,
    layers: &'a mut [PathOutcome],
    numbers: N,
}

/// Materials whose layers are found.
pub(super) trait Chains: Sized {
    /// Fills the layers, of which there is one at least and all are [`PathOutcome::NONE`].
    fn follow<const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S>(
        chain: Chain<'_, '_, NEEDS, C, N>,
        ray: &Ray,
    );
}

impl Chains for Lambert {
    fn follow<const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S>(
        mut chain: Chain<'_, '_, NEEDS, C, N>,
        ray: &Ray,
    ) {
        let arrival = chain.tracer.look(ray);
        chain.layers[0] = PathOutcome::seen(ray.direction, arrival.emitted);
        if let Some(next) = arrival.next {
            let material = Self::at::<NEEDS>(chain.tracer.scene, &next.surface);
            chain.diffuse(0, &Place { next: &next, material: &material, distance: next.distance, depth: 0 }, Vec3::ONE);
        }
    }
}

/// A vertex of a chain.
struct Place<'a, 'b, M> {
    next: &'a Next<'b>,
    material: &'a M,
    /// Length of the path from the camera.
    distance: f32,
    /// Scatterings before it.
    depth: u32,
}

impl<'b, const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S> Chain<'_, 'b, NEEDS, C, N> {
    /// A layer shows the diffuse lobe of a vertex; `weight` is the camera's.
    #[inline]
    fn diffuse<M: Scatters>(&mut self, layer: usize, place: &Place<'_, 'b, M>, weight: Vec3) {
        let Place { next, material, distance, depth } = *place;
        let outcome = &mut self.layers[layer];
        outcome.arrive(&next.surface, distance, depth, weight * material.diffuse_throughput());
        let mut direct = Direct {
            tracer: &mut self.tracer,
            surface: &next.surface,
            material,
            medium: next.medium,
            settings: &self.settings.direct,
        };
        outcome.direct = direct.all(|strategy, i| (self.numbers)(strategy, layer as u32, i));
    }
}

impl Chains for Bsdf {
    fn follow<const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S>(
        mut chain: Chain<'_, '_, NEEDS, C, N>,
        ray: &Ray,
    ) {
        let arrival = chain.tracer.look(ray);
        chain.layers[0] = PathOutcome::seen(ray.direction, arrival.emitted);
        let Some(mut next) = arrival.next else { return };
        let mut sampler = (chain.numbers)(Strategy::Chain, 0, 0);
        let mut weight = arrival.weight;
        let (mut distance, mut eta) = (next.distance, 1.0);
        let (mut layer, mut depth) = (0, 0);
        loop {
            let material = Self::at::<NEEDS>(chain.tracer.scene, &next.surface);
            let place = Place { next: &next, material: &material, distance, depth };
            let is_last = layer + 1 == chain.layers.len();
            let picked = if is_last {
                let (lobe, probability) = Scatters::pick(&material, &mut sampler);
                if lobe == Lobe::Diffuse {
                    // In place of the walk's first surface.
                    chain.layers[layer].is_guide = false;
                    chain.diffuse(layer, &place, weight / probability);
                    return;
                }
                let outcome = &mut chain.layers[layer];
                if !outcome.is_guide {
                    outcome.guide(&next.surface, distance, depth);
                }
                (lobe, probability)
            } else {
                if material.lobes()[Lobe::Diffuse as usize] > 0.0 || material.pick_specular(0.0).is_none() {
                    chain.diffuse(layer, &place, weight);
                } else {
                    chain.layers[layer].guide(&next.surface, distance, depth);
                }
                let Some(picked) = go_on(&material, weight * (eta * eta), &mut sampler) else { return };
                chain.layers[layer].shininess = 1.0 - material.roughness(picked.0);
                layer += 1;
                picked
            };
            if depth >= chain.settings.max_bounces {
                return;
            }
            let (lobe, probability) = picked;
            weight /= probability;
            let surface = &next.surface;
            let met = chain.tracer.next_event(&mut sampler, surface, &material, lobe, next.medium);
            let last = depth + 1 == chain.settings.max_bounces;
            let arrival = chain.tracer.scatter(&mut sampler, surface, &material, lobe, next.medium, last);
            let outcome = &mut chain.layers[layer];
            outcome.emitted += weight * (met + arrival.emitted);
            let Some(further) = arrival.next else { return };
            weight *= arrival.weight;
            if weight.max_element() <= 0.0 {
                return;
            }
            eta *= arrival.eta;
            distance += further.distance;
            depth += 1;
            next = further;
        }
    }
}

/// By which lobe a chain leaves a layer, and the probability of that. `None`: it ends here.
#[inline]
fn go_on(material: &Bsdf, weight: Vec3, sampler: &mut impl Sampler) -> Option<(Lobe, f32)> {
    // A Lambertian surface draws nothing.
    material.pick_specular(0.0)?;
    let picked = material.pick_specular(sampler.next_1d())?;
    let expected = (weight * material.specular_throughput()).max_element();
    let survival = (expected / CERTAIN_WEIGHT).min(1.0);
    // Chance takes what is left of the number.
    if picked.u < survival { Some((picked.lobe, picked.probability * survival)) } else { None }
}
