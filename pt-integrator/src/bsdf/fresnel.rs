//! How much light an interface reflects.

use glam::Vec3;
use hashcache_core::float;

use super::inputs::unit_interval;

/// Share of unpolarised light that a smooth dielectric interface reflects, `[0, 1]`; 1 beyond the critical angle.
///
/// `cosine` is that of the angle to the normal, `[0, 1]`; `eta` the refractive index behind the interface over that
/// before it, above 0.
///
/// # Source
/// Fresnel's equations as in Walter et al. 2007, eq. 22, by amplitudes.
///
/// ```
/// use pt_integrator::bsdf::fresnel_dielectric;
/// assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-7);
/// assert_eq!(fresnel_dielectric(0.0, 1.5), 1.0);
/// assert_eq!(fresnel_dielectric(0.5, 1.0), 0.0);
/// assert_eq!(fresnel_dielectric(0.5, 1.0 / 1.5), 1.0, "total reflection");
/// ```
#[inline]
pub fn fresnel_dielectric(cosine: f32, eta: f32) -> f32 {
    let squared = eta * eta;
    // η·cos of the refracted angle, squared. In this form nothing cancels near η = 1.
    let bent = (eta - 1.0) * (eta + 1.0) + cosine * cosine;
    if bent < 0.0 {
        return 1.0;
    }
    // MIN_POSITIVE below keeps 0 / 0 away where both indices are equal and the angle is right.
    let bent = float::sqrt(bent);
    let [above, below] = [cosine - bent, cosine + bent];
    let [parallel_above, parallel_below] = [squared * cosine - bent, squared * cosine + bent];
    // The mean of both polarisations' squared ratios, with one division.
    let (s, p, both) = (above * parallel_below, parallel_above * below, below * parallel_below);
    // Rounding may give 1 + 2⁻²³. NaN becomes 1.
    (0.5 * (s * s + p * p) / (both * both + f32::MIN_POSITIVE)).min(1.0)
}

/// (1 − `cosine`)⁵: by which share of its way to 1 reflectance has come, from normal to grazing incidence.
///
/// # Source
/// Schlick 1994, eq. 15.
#[inline]
pub fn schlick_weight(cosine: f32) -> f32 {
    let x = unit_interval(1.0 - cosine);
    let squared = x * x;
    squared * squared * x
}

/// Reflectance of a mix of dielectric and metal, resolved to `constant + exact · F + schlick · (1 − cos θ)⁵`.
///
/// The dielectric's reflectance is `specular · (k + (1 − k)·F)`: `k` moves reflectance at normal incidence from F₀ to
/// min(F₀ · specular colour, 1), and leaves 1 at grazing incidence.
///
/// # Source
/// glTF 2.0, appendix B; glTF material extensions, `KHR_materials_specular`.
///
/// # Deviation
/// Both take Schlick's approximation for dielectrics; this is exact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fresnel {
    /// Refractive index behind the interface over that before it; 0 for the infinite one.
    pub eta: f32,
    /// Whether exact reflectance is asked for; otherwise Schlick's stands in its place.
    is_exact: bool,
    /// Plain reflectance at normal incidence.
    normal: f32,
    constant: Vec3,
    exact: Vec3,
    schlick: Vec3,
    /// What total reflection adds where light would otherwise have passed.
    total: f32,
    /// The dielectric's strongest channel: `specular · k` and `specular · (1 − k)`.
    strongest: [f32; 2],
}

/// Reflectance of plain interfaces at an angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Angle {
    exact: f32,
    schlick: f32,
    /// 1 beyond the critical angle, 0 before it.
    total: f32,
}

/// What makes a [`Fresnel`], all of it in range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface {
    pub base_color: Vec3,
    pub metallic: f32,
    /// Of the solid over its outside; 0: infinite.
    pub ior: f32,
    pub specular: f32,
    pub specular_color: Vec3,
    /// Share of the dielectric's remaining light that is bent into or out of a solid.
    pub refracted: f32,
    /// The light comes from inside of the solid.
    pub inside: bool,
}

impl Fresnel {
    /// No interface: nothing is reflected or bent.
    pub const NONE: Self = Self {
        eta: 1.0,
        is_exact: false,
        normal: 0.0,
        constant: Vec3::ZERO,
        exact: Vec3::ZERO,
        schlick: Vec3::ZERO,
        total: 0.0,
        strongest: [0.0; 2],
    };

    #[inline]
    pub fn new(interface: &Interface) -> Self {
        let &Interface { base_color, metallic, ior, specular, specular_color, refracted, inside } = interface;
        let root = (ior - 1.0) / (ior + 1.0);
        // The infinite index reflects in the specular colour: k is that colour, over Schlick's approximation from 0.
        let normal = if ior == 0.0 { 0.0 } else { root * root };
        let tinted = if ior == 0.0 { specular_color } else { specular_color * normal };
        let k = (tinted.min(Vec3::ONE) - normal) / (1.0 - normal);
        let dielectric = specular * (1.0 - metallic);
        let total = (1.0 - specular) * (1.0 - metallic) * refracted;
        let strongest = k.max_element();
        Self {
            // Also where what enters is lost to metal, as F is then asked for in vain.
            is_exact: ior > 0.0 && dielectric + total > 0.0,
            eta: relative_index(ior, inside),
            normal,
            constant: k * dielectric + base_color * metallic,
            exact: (Vec3::ONE - k) * dielectric,
            schlick: (Vec3::ONE - base_color) * metallic,
            total,
            strongest: [specular * strongest, specular * (1.0 - strongest)],
        }
    }

    /// Whether both indices are equal.
    #[inline]
    pub fn is_equal(&self) -> bool {
        self.eta - 1.0 == 0.0
    }

    /// Whether nothing is ever reflected.
    #[inline]
    pub fn is_absent(&self) -> bool {
        let never_total = self.total == 0.0 || self.eta == 0.0 || self.eta >= 1.0;
        let exact = self.exact == Vec3::ZERO || self.is_equal();
        exact && never_total && self.constant == Vec3::ZERO && self.schlick == Vec3::ZERO
    }

    #[inline]
    pub fn at(&self, cosine: f32) -> Angle {
        let schlick = schlick_weight(cosine);
        // Metal needs no more.
        if !self.is_exact {
            return Angle { exact: schlick, schlick, total: 0.0 };
        }
        let exact = fresnel_dielectric(cosine, self.eta);
        let is_total = self.eta < 1.0 && (self.eta - 1.0) * (self.eta + 1.0) + cosine * cosine < 0.0;
        Angle { exact, schlick, total: f32::from(is_total) }
    }

    /// About the mean over the microfacets of roughness α that are seen at this angle.
    #[inline]
    pub fn mean(&self, angle: Angle, cosine: f32, alpha: f32) -> Angle {
        let Angle { mut exact, schlick, mut total } = angle;
        if self.eta > 0.0 && self.eta < 1.0 {
            // What matters is how many of them lie beyond the critical angle.
            let tilt = 0.7 * alpha / (1.0 + 2.0 * alpha);
            let [low, high] = [cosine - tilt, cosine + tilt].map(|cosine| self.at(unit_interval(cosine)));
            (exact, total) = ((low.exact + exact + high.exact) / 3.0, (low.total + total + high.total) / 3.0);
        } else {
            exact = roughened(exact, self.normal, alpha);
        }
        Angle { exact, schlick: roughened(schlick, 0.0, alpha), total }
    }

    /// Share of light that is reflected, `[0, 1]` by channel.
    #[inline]
    pub fn reflected(&self, angle: Angle) -> Vec3 {
        let sum = self.constant + self.exact * angle.exact + self.schlick * angle.schlick;
        // Exact reflectance of an index above 3.7 falls a little below F₀ on its way to 1.
        (sum + self.total * angle.total).clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// Share of light that the dielectric lets in, one number for all channels as in glTF: the strongest reflection's.
    #[inline]
    pub fn entered(&self, angle: Angle) -> f32 {
        let [constant, exact] = self.strongest;
        unit_interval(1.0 - (constant + exact * angle.exact))
    }

    /// [`entered`](Self::entered) for light that passes: none beyond the critical angle.
    #[inline]
    pub fn passed(&self, angle: Angle) -> f32 {
        (1.0 - angle.total) * self.entered(angle)
    }
}

/// Refractive indices are kept where f32 has digits for what they do.
const SMALLEST_IOR: f32 = 0.01;
const LARGEST_IOR: f32 = 100.0;

/// A refractive index in its range; 0 for the infinite one.
#[inline]
pub(crate) fn kept_index(ior: f32) -> f32 {
    if ior > 0.0 { ior.clamp(SMALLEST_IOR, LARGEST_IOR) } else { 0.0 }
}

/// Refractive index behind a solid's face over that before it, for one that was kept; 0 for the infinite one, which bends
/// nothing.
#[inline]
pub(crate) fn relative_index(kept: f32, inside: bool) -> f32 {
    if inside && kept > 0.0 { 1.0 / kept } else { kept }
}

/// Expected reflectance of microfacets of roughness α, between that of their mean plane and that at normal incidence.
///
/// Fitted, as [`kept_by_facets`], to the energies that the tests print. Chances of lobes depend on it, never what a
/// lobe weighs.
#[inline]
pub(super) fn roughened(reflectance: f32, at_normal: f32, alpha: f32) -> f32 {
    at_normal + (reflectance - at_normal) / (1.0 + 10.0 * alpha)
}

/// Expected share of light that microfacets of roughness α send on at first try, seen at this angle.
#[inline]
pub(super) fn kept_by_facets(alpha: f32, cosine: f32) -> f32 {
    1.0 - alpha * alpha * (1.7 - alpha) * (0.3 + 0.7 * cosine)
}
