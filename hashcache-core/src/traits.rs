//! What crates swap: ray casting, sampling, radiance caches.

use glam::{Vec2, Vec3};

use crate::geometry::{Hit, Ray};
use crate::record::VertexRecord;

/// Casts rays against a scene.
///
/// # Laws
/// `closest` returns the hit with the smallest `t` in `(t_min, t_max)`; `occluded(r)` is `closest(r).is_some()`.
/// A ray with a component that is not finite meets nothing; `t_max` alone may be infinite.
///
/// # Example
/// A scene of one triangle that covers the plane y = 0:
///
/// ```
/// use hashcache_core::geometry::{Hit, Ray};
/// use hashcache_core::glam::Vec3;
/// use hashcache_core::traits::RayCaster;
///
/// struct Floor;
///
/// impl RayCaster for Floor {
///     fn closest(&self, ray: &Ray) -> Option<Hit> {
///         let finite = ray.origin.is_finite() && ray.direction.is_finite() && ray.t_min.is_finite();
///         let t = -ray.origin.y / ray.direction.y;
///         // False for NaN: a ray along the floor meets nothing.
///         let inside = t > ray.t_min && t < ray.t_max;
///         (finite && inside).then_some(Hit { t, u: 0.0, v: 0.0, triangle: 0, instance: 0 })
///     }
///
///     fn occluded(&self, ray: &Ray) -> bool {
///         self.closest(ray).is_some()
///     }
/// }
///
/// let down = Ray { origin: Vec3::Y * 3.0, t_min: 0.0, direction: Vec3::NEG_Y, t_max: f32::INFINITY };
/// assert_eq!(Floor.closest(&down).unwrap().t, 3.0);
/// assert!(Floor.closest(&Ray { t_max: 3.0, ..down }).is_none(), "the segment is open at its end");
/// assert!(!Floor.occluded(&Ray { origin: Vec3::NAN, ..down }));
/// assert_eq!(Floor.occluded(&down), Floor.closest(&down).is_some());
/// ```
pub trait RayCaster {
    /// The nearest hit.
    fn closest(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything lies on the segment.
    fn occluded(&self, ray: &Ray) -> bool;
}

/// A stream of random numbers for one path: each call moves on to the next dimension.
///
/// # Laws
/// Values lie in `[0, 1)`. Two samplers started alike return the same bits.
///
/// # Example
/// A counter and a hash:
///
/// ```
/// use hashcache_core::glam::Vec2;
/// use hashcache_core::hash::{pcg, to_unit_f32};
/// use hashcache_core::traits::Sampler;
///
/// #[derive(Clone)]
/// struct Counter(u32);
///
/// impl Sampler for Counter {
///     fn next_1d(&mut self) -> f32 {
///         self.0 = self.0.wrapping_add(1);
///         to_unit_f32(pcg(self.0))
///     }
///
///     fn next_2d(&mut self) -> Vec2 {
///         Vec2::new(self.next_1d(), self.next_1d())
///     }
/// }
///
/// let (mut a, mut b) = (Counter(42), Counter(42));
/// let mut sum = 0.0;
/// for _ in 0..1000 {
///     let x = a.next_1d();
///     assert!((0.0..1.0).contains(&x));
///     assert_eq!(x.to_bits(), b.next_1d().to_bits());
///     sum += x;
/// }
/// // Five standard deviations of a mean of 1000 uniform numbers, √(1/12000) = 0.009.
/// assert!((sum / 1000.0 - 0.5).abs() < 0.046);
/// ```
pub trait Sampler {
    /// One number.
    fn next_1d(&mut self) -> f32;

    /// Two numbers that are stratified together where the sampler stratifies.
    fn next_2d(&mut self) -> Vec2;
}

/// A cache's answer for one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Illumination by emitters seen directly, as in [`VertexRecord::direct`].
    pub direct: Vec3,
    /// Illumination that arrived after a further scattering, as in [`VertexRecord::further`].
    pub further: Vec3,
    /// Number of samples behind the answer; 0: the cache had none, and the vertex's own value was returned.
    pub samples: u32,
    /// Variance of the luminance of `direct` and `further` together, as an estimate of the light there: its error squared,
    /// from the noise of the samples behind it. 0: not known.
    pub variance: f32,
}

/// A store of illumination at path vertices, for host programs that bring their own loop.
///
/// # Laws
/// Energy recorded = energy stored + energy reported lost. An estimate is finite whatever was recorded.
/// The order of `record` calls between two `end_frame`s does not change any estimate after the second.
///
/// # Example
/// One cell for the whole scene, and only the red channel of the light that arrives after a further bounce:
///
/// ```
/// use hashcache_core::counters::Counters;
/// use hashcache_core::exact::{Quantum, mean, quantize};
/// use hashcache_core::glam::Vec3;
/// use hashcache_core::record::VertexRecord;
/// use hashcache_core::traits::{Estimate, RadianceCache};
///
/// struct OneCell {
///     quantum: Quantum,
///     open: (u64, u32),
///     shown: (u64, u32),
///     counters: Counters,
/// }
///
/// impl RadianceCache for OneCell {
///     fn record(&mut self, vertex: &VertexRecord) {
///         let deposit = quantize(self.quantum, vertex.further[0]);
///         self.counters.note(&deposit, true);
///         self.open.0 += deposit.value;
///         self.open.1 += 1;
///     }
///
///     fn estimate(&self, _: &VertexRecord) -> Estimate {
///         let (sum, samples) = self.shown;
///         let further = Vec3::X * mean(self.quantum, sum, samples);
///         Estimate { direct: Vec3::ZERO, further, samples, variance: 0.0 }
///     }
///
///     fn end_frame(&mut self) {
///         self.shown = self.open;
///     }
/// }
///
/// let quantum = Quantum::new(0).unwrap();
/// let fill = |reds: &[f32]| {
///     let mut cache = OneCell { quantum, open: (0, 0), shown: (0, 0), counters: Counters::default() };
///     for red in reds {
///         cache.record(&VertexRecord { further: [*red, 0.0, 0.0, 0.0], ..bytemuck::Zeroable::zeroed() });
///     }
///     cache.end_frame();
///     cache
/// };
/// let reds = [0.1, 3.0, f32::NAN, 1e9, 0.7, f32::INFINITY];
/// let (there, back) = (fill(&reds), fill(&[1e9, 0.7, f32::INFINITY, 0.1, f32::NAN, 3.0]));
/// let vertex: VertexRecord = bytemuck::Zeroable::zeroed();
/// assert_eq!(there.estimate(&vertex), back.estimate(&vertex));
/// assert!(there.estimate(&vertex).further.is_finite());
/// assert_eq!(there.counters.balance(), 0);
/// assert_eq!(there.counters.non_finite, 2);
/// ```
pub trait RadianceCache {
    /// Adds a vertex's illumination.
    fn record(&mut self, vertex: &VertexRecord);

    /// Illumination at a vertex: shared where the cache has samples, else the vertex's own.
    fn estimate(&self, vertex: &VertexRecord) -> Estimate;

    /// Makes everything recorded since the last call available to `estimate`.
    fn end_frame(&mut self);
}
