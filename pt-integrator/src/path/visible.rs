//! What a pixel shows: vertices with direct light, through mirrors and glass, and nothing further.

use glam::Vec3;
use hashcache_core::geometry::Ray;
use hashcache_core::record::VertexRecord;
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
/// chain goes on by that of its other lobes that brings most light, to the surface of the next layer, and so on to the
/// last layer but one; by chance only where little light is expected from there. The last layer is for the rest, the
/// lobes that were passed by on the way and all but the diffuse one where the chain has no more layers: one of them is
/// chosen in proportion to the light expected of it, perhaps none when that is little, and a walk from there chooses
/// among all lobes until it scatters diffusely. So what is seen through glass has no noise of choices, and its
/// reflections, a few percent of the light, have all of it. With a single layer the walk starts at the camera's surface.
/// A pixel's radiance is the sum of all layers' `emitted + throughput · illumination`, `throughput` holding the chances
/// of all choices.
///
/// - `emitted`: light of the segment that ends in the layer, in the last layer of all segments of the walk: emission,
///   the environment, and light that the lobe before it found by next event (weighted against each other).
/// - `direct`: illumination of the diffuse lobe by emitters, an estimate of the same mean as [`super::trace_path`]'s
///   [`PathOutcome::direct`]; `further` is 0.
/// - A surface without a diffuse lobe is a guide ([`PathOutcome::is_guide`]); in the last layer the first surface is,
///   when the walk ends without a diffuse vertex.
/// - Layers between the chain's end and the last are [`PathOutcome::NONE`], and the last is where no lobe was chosen.
///   Scenes of Lambertian surfaces fill the first layer only.
///
/// The settings are taken as they are: see [`DirectSettings::for_scene`]. At most [`MAX_LAYERS`] are filled.
/// `numbers(strategy, layer, i)` makes the sampler of candidate or ray i of a layer. Consecutive indices are stratified
/// together, so a caller passes on indices that go on from sample to sample of a pixel: `Sobol::new(sample · n + i,
/// seed)`, n being [`DirectSettings::all`], [`DirectSettings::scattered`] or 1, with a seed for each strategy and layer.
/// Adds to `counts`. Light that is NaN or infinite is left out in all layers and counted.
///
/// # Source
/// Roth et al. 2020, 3.4 (layers); Chao 1982 (the choice among the rest).
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
            chain.diffuse(0, &Vertex::first(next, arrival.weight), &material, 1.0);
        }
    }
}

impl<'b, const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S> Chain<'_, 'b, NEEDS, C, N> {
    /// A layer shows the diffuse lobe of a vertex, which was chosen with a probability.
    #[inline]
    fn diffuse<M: Scatters>(&mut self, layer: usize, at: &Vertex<'b>, material: &M, probability: f32) {
        let Vertex { next, weight, distance, depth, .. } = at;
        let outcome = &mut self.layers[layer];
        outcome.arrive(&next.surface, *distance, *depth, *weight / probability * material.diffuse_throughput());
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
        let Some(next) = arrival.next else { return };
        let mut sampler = (chain.numbers)(Strategy::Chain, 0, 0);
        let mut at = Vertex::first(next, arrival.weight);
        let last = chain.layers.len() - 1;
        if last == 0 {
            return chain.walk(&mut sampler, at, 0);
        }
        let mut rest = Rest { total: 0.0, kept: None };
        for layer in 0..last {
            let material = Self::at::<NEEDS>(chain.tracer.scene, &at.next.surface);
            let lobes = material.lobes();
            let specular = lobes[Lobe::Reflection as usize..].iter().sum::<f32>();
            if lobes[Lobe::Diffuse as usize] > 0.0 || specular <= 0.0 {
                chain.diffuse(layer, &at, &material, 1.0);
            } else {
                chain.layers[layer].guide(&at.next.surface, at.distance, at.depth);
            }
            let expected = (at.weight * (at.eta * at.eta) * material.specular_throughput()).max_element();
            let main = if layer + 1 < last { strongest(&lobes) } else { None };
            for lobe in SPECULAR.into_iter().filter(|lobe| Some(*lobe) != main) {
                rest.offer(expected * lobes[lobe as usize] / specular, &mut sampler, || (at, lobe, layer));
            }
            let Some(lobe) = main else { break };
            chain.layers[layer].shininess = shininess(material.roughness(lobe));
            let Some(survival) = survival(expected * lobes[lobe as usize] / specular, &mut sampler) else { break };
            let Some(further) = chain.step(&mut sampler, &at, &material, lobe, survival, layer + 1) else { break };
            at = further;
        }
        let Rest { total, kept: Some((weight, (at, lobe, layer))) } = rest else { return };
        let material = Self::at::<NEEDS>(chain.tracer.scene, &at.next.surface);
        if chain.layers[layer].shininess <= 0.0 {
            chain.layers[layer].shininess = shininess(material.roughness(lobe));
        }
        let Some(survival) = survival(total, &mut sampler) else { return };
        let chance = survival * weight / total;
        if let Some(further) = chain.step(&mut sampler, &at, &material, lobe, chance, last) {
            chain.walk(&mut sampler, further, last);
        }
    }
}

/// A vertex of a chain and the way there.
#[derive(Clone, Copy)]
struct Vertex<'b> {
    next: Next<'b>,
    /// The camera's weight of light that leaves it.
    weight: Vec3,
    /// Refractive index of what the chain is in over that at the camera.
    eta: f32,
    /// Length of the path from the camera.
    distance: f32,
    /// Scatterings before it.
    depth: u32,
}

impl<'b> Vertex<'b> {
    /// The one that the camera sees.
    const fn first(next: Next<'b>, weight: Vec3) -> Self {
        Self { distance: next.distance, next, weight, eta: 1.0, depth: 0 }
    }
}

/// The lobes by which chains go on.
const SPECULAR: [Lobe; 3] = [Lobe::Reflection, Lobe::Transmission, Lobe::Coat];

/// The lobe that brings most light, but for the diffuse one.
#[inline]
fn strongest(lobes: &[f32; 4]) -> Option<Lobe> {
    let weight = |lobe: Lobe| lobes[lobe as usize];
    let strongest = SPECULAR.into_iter().reduce(|best, lobe| if weight(lobe) > weight(best) { lobe } else { best });
    strongest.filter(|lobe| weight(*lobe) > 0.0)
}

/// What a record tells of a lobe that a chain goes on by: above 0 even for the roughest, since 0 says that it ends.
#[inline]
fn shininess(roughness: f32) -> f32 {
    (1.0 - roughness).max(VertexRecord::LEAST_SHININESS)
}

/// The probability by which something of this expected weight is traced; `None`: chance decided against it.
#[inline]
fn survival(expected: f32, sampler: &mut impl Sampler) -> Option<f32> {
    let survival = (expected / CERTAIN_WEIGHT).min(1.0);
    // Nothing is drawn for what is certain. False for NaN.
    (survival >= 1.0 || survival > 0.0 && sampler.next_1d() < survival).then_some(survival)
}

/// Lobes that a chain passed by: one is kept, by chance in proportion to its weight.
///
/// # Source
/// Chao 1982 (reservoir sampling with unequal probabilities).
struct Rest<'b> {
    total: f32,
    kept: Option<(f32, (Vertex<'b>, Lobe, usize))>,
}

impl<'b> Rest<'b> {
    #[inline]
    fn offer(&mut self, weight: f32, sampler: &mut impl Sampler, lobe: impl FnOnce() -> (Vertex<'b>, Lobe, usize)) {
        // Nor is NaN.
        if weight > 0.0 {
            self.total += weight;
            if self.kept.is_none() || sampler.next_1d() * self.total < weight {
                self.kept = Some((weight, lobe()));
            }
        }
    }
}

impl<'b, const NEEDS: u32, C: RayCaster, S: Sampler, N: FnMut(Strategy, u32, u32) -> S> Chain<'_, 'b, NEEDS, C, N> {
    /// Goes on by a lobe that was chosen with a probability; what is emitted there belongs to `layer`.
    fn step(
        &mut self,
        sampler: &mut S,
        at: &Vertex<'b>,
        material: &Bsdf,
        lobe: Lobe,
        probability: f32,
        layer: usize,
    ) -> Option<Vertex<'b>> {
        let Vertex { next, weight, eta, distance, depth } = at;
        if *depth >= self.settings.max_bounces {
            return None;
        }
        let weight = *weight / probability;
        let met = self.tracer.next_event(sampler, &next.surface, material, lobe, next.medium);
        let last = depth + 1 == self.settings.max_bounces;
        let arrival = self.tracer.scatter(sampler, &next.surface, material, lobe, next.medium, last);
        self.layers[layer].emitted += weight * (met + arrival.emitted);
        let further = arrival.next?;
        let weight = weight * arrival.weight;
        let distance = distance + further.distance;
        (weight.max_element() > 0.0).then_some(Vertex {
            next: further,
            weight,
            eta: eta * arrival.eta,
            distance,
            depth: depth + 1,
        })
    }

    /// Chooses among all lobes until the diffuse one is chosen.
    fn walk(&mut self, sampler: &mut S, mut at: Vertex<'b>, layer: usize) {
        loop {
            let material = <Bsdf as Scatters>::at::<NEEDS>(self.tracer.scene, &at.next.surface);
            let (lobe, probability) = Scatters::pick(&material, sampler);
            if lobe == Lobe::Diffuse {
                // In place of the walk's first surface.
                self.layers[layer].is_guide = false;
                return self.diffuse(layer, &at, &material, probability);
            }
            if !self.layers[layer].is_guide {
                self.layers[layer].guide(&at.next.surface, at.distance, at.depth);
            }
            let Some(further) = self.step(sampler, &at, &material, lobe, probability, layer) else { return };
            at = further;
        }
    }
}
