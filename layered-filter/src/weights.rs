//! Edge-stopping weights: how much one pixel's illumination says about another's.
//!
//! # Source
//! Roth et al. 2020, equations 2 to 6; the variance-aware luminance weight after Schied et al. 2017, equation 5.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::float;
use hashcache_core::glam::{Vec3, Vec4};

use crate::guide::PreparedGuide;
use crate::log::ln;

/// How luminances are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LuminanceWeight {
    /// Equation 6: w_l = max(0, 1 − ln(1 + s·Δl/(Δl+1))), Δl = κ·|l_p − l_q|. It knows no exposure: choose κ as
    /// 1 / (a typical luminance). Above s = e − 1 a large difference stops altogether.
    Difference {
        /// s_l, 0 (off) to 10⁶.
        scale: f32,
        /// κ, 10⁻³⁰ to 10³⁰, in 1/radiance.
        kappa: f32,
    },
    /// w_l = exp(−|l_p − l_q| / (s·σ_p)) by [`falloff`], where σ_p is the standard deviation of the pixel's mean: noise
    /// is mixed, edges above it are kept, at any exposure. Where σ is unknown, everything is mixed.
    Deviation {
        /// s_l: standard deviations at which the weight is 1/e, 10⁻³ to 10⁶.
        scale: f32,
    },
}

/// What the weights are made with. [`Weights::new`] checks it; the default has the values of the paper's evaluation.
///
/// ```
/// # use layered_filter::{WeightSettings, Weights};
/// assert!(Weights::new(&WeightSettings::default()).is_ok());
/// assert!(Weights::new(&WeightSettings { path_scale: -1.0, ..WeightSettings::default() }).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightSettings {
    /// s_n: factor of the normals' cosine, 0 to 10⁶. It scales all weights of neighbours against the pixel's own, 1.
    pub normal_scale: f32,
    /// The normals' cosine is squared this often, 0 to 10: a power of 2^n. 0 is the paper's; 7 (a power of
    /// 128) is SVGF's and keeps bumps apart.
    pub normal_squarings: u32,
    /// s_d: fall with the difference of path lengths, per scene radius, 0 (off) to 10⁹.
    pub path_scale: f32,
    /// s_d′: fall with the difference of the last segments' lengths, per scene radius, 0 (off) to 10⁹.
    pub segment_scale: f32,
    /// Fall with the distance from the pixel's tangent plane, per path length, 0 (off) to 10⁹. Unlike the lengths it
    /// does not fall on surfaces seen at a grazing angle.
    pub plane_scale: f32,
    /// Fall with the distance between the vertices, per scene radius, 0 (off) to 10⁹: the guide by world or cell
    /// coordinates that the paper suggests for scenes in which path lengths do not tell vertices apart.
    pub position_scale: f32,
    /// s_c of a diffuse vertex, 0 (off) to 10⁶.
    pub color_diffuse: f32,
    /// s_c of a glossy vertex (shininess above 0), 0 (off) to 10⁶.
    pub color_glossy: f32,
    /// κ of the colours' distance, in 1/(units of L\*a\*b\*), 10⁻⁶ to 10⁶. The paper gives no value; 1.
    pub color_kappa: f32,
    /// The weight by luminance.
    pub luminance: LuminanceWeight,
}

impl WeightSettings {
    /// The values of the paper's evaluation (Roth et al. 2020, section 4); κ, which it does not give, is 1.
    pub const PAPER: Self = Self {
        normal_scale: 1.0,
        normal_squarings: 0,
        path_scale: 100.0,
        segment_scale: 400.0,
        plane_scale: 0.0,
        position_scale: 0.0,
        color_diffuse: 1.5,
        color_glossy: 3.0,
        color_kappa: 1.0,
        luminance: LuminanceWeight::Difference { scale: 3.0, kappa: 1.0 },
    };
}

impl Default for WeightSettings {
    /// [`WeightSettings::PAPER`].
    fn default() -> Self {
        Self::PAPER
    }
}

/// Checked settings, as the inner loop and kernels read them (64 bytes).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Weights {
    normal_scale: f32,
    normal_squarings: u32,
    path_scale: f32,
    segment_scale: f32,
    plane_scale: f32,
    position_scale: f32,
    color_diffuse: f32,
    color_glossy: f32,
    color_kappa: f32,
    recip_color_kappa: f32,
    luminance_scale: f32,
    luminance_kappa: f32,
    by_deviation: u32,
    reserved: [u32; 3],
}

impl Weights {
    /// Checks the settings.
    ///
    /// # Errors
    /// [`ParamError`] with the setting's name.
    pub fn new(settings: &WeightSettings) -> Result<Self, ParamError> {
        let s = settings;
        ParamError::check_range("normal_squarings", f64::from(s.normal_squarings), 0.0, 10.0)?;
        for (name, scale, max) in [
            ("normal_scale", s.normal_scale, 1e6),
            ("path_scale", s.path_scale, 1e9),
            ("segment_scale", s.segment_scale, 1e9),
            ("plane_scale", s.plane_scale, 1e9),
            ("position_scale", s.position_scale, 1e9),
            ("color_diffuse", s.color_diffuse, 1e6),
            ("color_glossy", s.color_glossy, 1e6),
        ] {
            ParamError::check_range(name, f64::from(scale), 0.0, max)?;
        }
        ParamError::check_range("color_kappa", f64::from(s.color_kappa), 1e-6, 1e6)?;
        let (luminance_scale, luminance_kappa, by_deviation) = match s.luminance {
            LuminanceWeight::Difference { scale, kappa } => {
                ParamError::check_range("luminance scale", f64::from(scale), 0.0, 1e6)?;
                ParamError::check_range("luminance kappa", f64::from(kappa), 1e-30, 1e30)?;
                (scale, kappa, 0)
            }
            LuminanceWeight::Deviation { scale } => {
                ParamError::check_range("luminance scale", f64::from(scale), 1e-3, 1e6)?;
                (scale, 1.0, 1)
            }
        };
        Ok(Self {
            normal_scale: s.normal_scale,
            normal_squarings: s.normal_squarings,
            path_scale: s.path_scale,
            segment_scale: s.segment_scale,
            plane_scale: s.plane_scale,
            position_scale: s.position_scale,
            color_diffuse: s.color_diffuse,
            color_glossy: s.color_glossy,
            color_kappa: s.color_kappa,
            recip_color_kappa: 1.0 / s.color_kappa,
            luminance_scale,
            luminance_kappa,
            by_deviation,
            reserved: [0; 3],
        })
    }

    /// Whether luminances are compared in standard deviations.
    #[inline]
    pub const fn by_deviation(&self) -> bool {
        self.by_deviation != 0
    }

    /// The weight of pixel `q` for pixel `p` by their vertices: w_n·w_d·w_d′·w_c and the further ones, each at least 0.
    /// 0 when either has no vertex or a guide that is not finite.
    #[inline]
    pub fn guides(&self, p: &PreparedGuide, q: &PreparedGuide) -> f32 {
        let (a, b) = (Vec4::from_array(p.normal_path), Vec4::from_array(q.normal_path));
        let product = a * b;
        let mut cosine = (product.x + product.y + product.z).max(0.0).min(1.0);
        for _ in 0..self.normal_squarings {
            cosine *= cosine;
        }
        let path = fall(self.path_scale, (a.w - b.w).abs());

        let (x, y) = (Vec4::from_array(p.position_segment), Vec4::from_array(q.position_segment));
        let apart = y - x;
        let segment = fall(self.segment_scale, apart.w.abs());
        let geometry = self.normal_scale * cosine * path * segment * self.places(a, apart);
        // Also false for NaN.
        if geometry > 0.0 { geometry * self.colors(p, q) } else { 0.0 }
    }

    /// The weights by plane and by position.
    #[inline]
    fn places(&self, normal_path: Vec4, apart: Vec4) -> f32 {
        let mut weight = 1.0;
        if self.plane_scale > 0.0 {
            let off = (normal_path.truncate().dot(apart.truncate())).abs();
            weight *= fall(self.plane_scale, off / normal_path.w.max(f32::MIN_POSITIVE));
        }
        if self.position_scale > 0.0 {
            weight *= fall(self.position_scale, apart.truncate().length());
        }
        weight
    }

    /// w_c; 0 when either pixel has no vertex.
    #[inline]
    fn colors(&self, p: &PreparedGuide, q: &PreparedGuide) -> f32 {
        let (a, b) = (Vec4::from_array(p.lab_shininess), Vec4::from_array(q.lab_shininess));
        if !(a.w >= 0.0 && b.w >= 0.0) {
            return 0.0;
        }
        let scale = if a.w > 0.0 { self.color_glossy } else { self.color_diffuse };
        let distance = (a - b).truncate().length();
        let difference = ln(1.0 + self.color_kappa * distance) * self.recip_color_kappa;
        fall(scale, difference / (difference + 1.0))
    }

    /// What the luminance weight needs to know about pixel `p`: its luminance and the variance of its mean.
    /// `None` in place of a luminance (a hole) takes every neighbour.
    #[inline]
    pub fn luminance_of(&self, luminance: Option<f32>, variance: f32) -> LuminanceAround {
        let Some(luminance) = luminance else {
            return LuminanceAround { luminance: 0.0, factor: 0.0, scale: 0.0, by_deviation: false };
        };
        if self.by_deviation() {
            // Rounding of a mean is no noise either: a flat image with σ = 0 keeps neighbours within a few ulps.
            let floor = luminance.abs() * f32::EPSILON * 4.0 + f32::MIN_POSITIVE;
            let deviation = self.luminance_scale * float::sqrt(variance.max(0.0)) + floor;
            LuminanceAround { luminance, factor: 1.0 / deviation, scale: 0.0, by_deviation: true }
        } else {
            let (factor, scale) = (self.luminance_kappa, self.luminance_scale);
            LuminanceAround { luminance, factor, scale, by_deviation: false }
        }
    }
}

/// A pixel's luminance, ready to be compared with its neighbours'.
#[derive(Clone, Copy, Debug)]
pub struct LuminanceAround {
    luminance: f32,
    factor: f32,
    scale: f32,
    by_deviation: bool,
}

impl LuminanceAround {
    /// w_l for a neighbour's luminance, 0 to 1; 0 for NaN.
    #[inline]
    pub fn weight(&self, luminance: f32) -> f32 {
        let difference = (self.luminance - luminance).abs() * self.factor;
        if self.by_deviation {
            return falloff(difference);
        }
        // Saturates at 1 where Δl/(Δl+1) would be ∞/∞.
        let share = 1.0 - 1.0 / (difference + 1.0);
        (1.0 - ln(1.0 + self.scale * share)).max(0.0)
    }
}

/// 1 − s·Δ, at least 0; NaN gives 0.
#[inline]
fn fall(scale: f32, difference: f32) -> f32 {
    (1.0 - scale * difference).max(0.0)
}

/// exp(−x) for x ≥ 0 with an end: (1 − x/8)⁸, and 0 from 8 on. Within 0.036 of exp(−x), which it meets at 0 in value and
/// slope; three multiplications instead of a call. NaN gives 0.
///
/// ```
/// # use layered_filter::weights::falloff;
/// assert_eq!((falloff(0.0), falloff(8.0)), (1.0, 0.0));
/// assert!((falloff(1.0) - (-1.0_f32).exp()).abs() < 0.036);
/// # #[allow(clippy::disallowed_methods)] fn _exp() {}
/// ```
#[inline]
pub fn falloff(x: f32) -> f32 {
    let base = (1.0 - x * 0.125).max(0.0);
    let square = base * base;
    let fourth = square * square;
    fourth * fourth
}

/// The distance of two colours as equation 5 uses it: Δc = ln(1 + κ‖c_p − c_q‖)/κ, in L\*a\*b\*.
#[inline]
pub fn color_difference(kappa: f32, p: Vec3, q: Vec3) -> f32 {
    ln(1.0 + kappa * (p - q).length()) / kappa
}
