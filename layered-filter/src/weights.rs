//! Edge-stopping weights: how much one pixel's illumination says about another's.
//!
//! # Source
//! Roth et al. 2020, equations 2 to 6; the variance-aware luminance weight after Schied et al. 2017, equation 5.

use bytemuck::{Pod, Zeroable};
use hashcache_core::error::ParamError;
use hashcache_core::float;
use hashcache_core::glam::{Mat4, Vec3, Vec4};

use crate::guide::PreparedGuide;
use crate::log::ln;

/// How luminances are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LuminanceWeight {
    /// Not at all: the weight is 1.
    Off,
    /// Equation 6: `w_l = max(0, 1 − ln(1 + s_l·Δl/(Δl+1)))`, `Δl = κ·|l_p − l_q|`. It knows no exposure: choose κ as
    /// 1 / (a typical luminance). Above s = e − 1 a large difference stops altogether.
    Difference {
        /// `s_l`, 0 (off) to 10⁶.
        scale: f32,
        /// κ, 10⁻³⁰ to 10³⁰, in 1/radiance.
        kappa: f32,
    },
    /// `w_l = exp(−|l_p − l_q| / (s_l·σ))` by [`falloff`], where σ is the standard deviation of the pixel's mean: noise
    /// is mixed, edges above it are kept, at any exposure. Where σ is unknown, everything is mixed.
    Deviation {
        /// `s_l`: standard deviations at which the weight is 1/e, 10⁻³ to 10⁶.
        scale: f32,
    },
    /// `w_l = exp(−(l_p − l_q)²/(s_l²·(σ_p² + σ_q²)))` by [`falloff`]: whether two pixels differ by more than their noise,
    /// a test of significance. The same for both, so that neither draws the other's light. Where a variance is unknown,
    /// everything is mixed.
    Significance {
        /// `s_l`: standard deviations of a difference at which the weight is 1/e, 10⁻³ to 10⁶.
        scale: f32,
    },
}

/// Values of [`Weights`]' field `luminance`; 0 is off.
const BY_DIFFERENCE: u32 = 1;
const BY_DEVIATION: u32 = 2;
const BY_SIGNIFICANCE: u32 = 3;

/// What the weights are made with. [`Weights::new`] checks it; the default has the values of the paper's evaluation.
///
/// ```
/// # use layered_filter::{WeightSettings, Weights};
/// assert!(Weights::new(&WeightSettings::default()).is_ok());
/// assert!(Weights::new(&WeightSettings { path_scale: -1.0, ..WeightSettings::default() }).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightSettings {
    /// `s_n`: factor of the normals' cosine, 0 to 16. It scales all weights of neighbours against the pixel's own, 1.
    pub normal_scale: f32,
    /// The normals' cosine is squared this often, 0 to 10: a power of 2^n. 0 is the paper's; 7 (a power of
    /// 128) is SVGF's and keeps bumps apart.
    pub normal_squarings: u32,
    /// `s_d`: fall with the difference of path lengths, per scene radius, 0 (off) to 10⁹.
    pub path_scale: f32,
    /// `s_d′`: fall with the difference of the last segments' lengths, per scene radius, 0 (off) to 10⁹.
    pub segment_scale: f32,
    /// A bell over the distance d from the pixel's tangent plane, exp(−(s·d/D)²) by [`falloff`] with D = path length, 0 (off)
    /// to 10⁹. Unlike path lengths it does not fall on surfaces seen at a grazing angle. s = 1/(n·`pixel_angle`) is a
    /// bell n footprints wide.
    pub plane_scale: f32,
    /// A bell over the distance d between the vertices, exp(−(s·d/radius)²) by [`falloff`], 0 (off) to 10⁹: the guide by
    /// world or cell coordinates that the paper suggests for scenes in which path lengths do not tell vertices apart.
    pub position_scale: f32,
    /// `s_c` of a diffuse vertex, 0 (off) to 10⁶.
    pub color_diffuse: f32,
    /// `s_c` of a glossy vertex (shininess above 0), 0 (off) to 10⁶.
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

    /// Weights by surface alone: normals to the power of 8 and a bell of two footprints around the tangent plane, for
    /// pixels of the angle `pixel_angle`.
    ///
    /// Neither colour nor luminance: albedo is divided out already, and luminances of single samples say more about
    /// the noise than about the light. Of the designs that were tried on cached light it has the least error.
    pub fn surface(pixel_angle: f32) -> Self {
        Self {
            normal_squarings: 3,
            path_scale: 0.0,
            segment_scale: 0.0,
            plane_scale: 0.5 / pixel_angle,
            color_diffuse: 0.0,
            color_glossy: 0.0,
            luminance: LuminanceWeight::Off,
            ..Self::PAPER
        }
    }
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
    luminance: u32,
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
            ("normal_scale", s.normal_scale, 16.0),
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
        let (luminance_scale, luminance_kappa, luminance) = match s.luminance {
            LuminanceWeight::Off => (0.0, 1.0, 0),
            LuminanceWeight::Difference { scale, kappa } => {
                ParamError::check_range("luminance scale", f64::from(scale), 0.0, 1e6)?;
                ParamError::check_range("luminance kappa", f64::from(kappa), 1e-30, 1e30)?;
                (scale, kappa, BY_DIFFERENCE)
            }
            LuminanceWeight::Deviation { scale } => {
                ParamError::check_range("luminance scale", f64::from(scale), 1e-3, 1e6)?;
                (scale, 1.0, BY_DEVIATION)
            }
            LuminanceWeight::Significance { scale } => {
                ParamError::check_range("luminance scale", f64::from(scale), 1e-3, 1e6)?;
                (scale, 1.0, BY_SIGNIFICANCE)
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
            luminance,
            reserved: [0; 3],
        })
    }

    /// Whether luminances are compared in standard deviations.
    #[inline]
    pub const fn by_deviation(&self) -> bool {
        self.luminance == BY_DEVIATION
    }

    /// The weight of pixel `q` for pixel `p` by their vertices: `w_n·w_d·w_d′·w_c` and the further ones, each at least 0.
    /// 0 when either has no vertex or a guide that is not finite.
    #[inline]
    pub fn guides(&self, p: &PreparedGuide, q: &PreparedGuide) -> f32 {
        self.guides_of_four(p, [q; 4]).x
    }

    /// [`Weights::guides`] of four pixels at once: what the inner loop calls. Terms that are off cost one comparison.
    #[inline(always)]
    pub fn guides_of_four(&self, p: &PreparedGuide, q: [&PreparedGuide; 4]) -> Vec4 {
        let own = Vec4::from_array(p.normal_path);
        let other = by_component(q.map(|guide| guide.normal_path));
        let cosine = other.x_axis * own.x + other.y_axis * own.y + other.z_axis * own.z;
        let mut cosine = cosine.max(Vec4::ZERO).min(Vec4::ONE);
        for _ in 0..self.normal_squarings {
            cosine *= cosine;
        }
        let mut weight = cosine * self.normal_scale;
        if self.path_scale > 0.0 {
            weight *= fall(self.path_scale, (other.w_axis - own.w).abs());
        }
        if self.segment_scale > 0.0 || self.plane_scale > 0.0 || self.position_scale > 0.0 {
            weight *= self.places(p, own, q);
        }
        if self.color_diffuse > 0.0 || self.color_glossy > 0.0 {
            weight *= self.colors(p, q);
        }
        // A pixel without a vertex has no normal. False for NaN, too.
        Vec4::select(weight.cmpgt(Vec4::ZERO), weight, Vec4::ZERO)
    }

    /// The weights by the last segment, by plane and by position.
    #[inline(always)]
    fn places(&self, p: &PreparedGuide, normal_path: Vec4, q: [&PreparedGuide; 4]) -> Vec4 {
        let own = Vec4::from_array(p.position_segment);
        let other = by_component(q.map(|guide| guide.position_segment));
        let mut weight = Vec4::ONE;
        if self.segment_scale > 0.0 {
            weight *= fall(self.segment_scale, (other.w_axis - own.w).abs());
        }
        if self.plane_scale > 0.0 || self.position_scale > 0.0 {
            let (x, y, z) = (other.x_axis - own.x, other.y_axis - own.y, other.z_axis - own.z);
            if self.plane_scale > 0.0 {
                let off = x * normal_path.x + y * normal_path.y + z * normal_path.z;
                let scaled = off * (self.plane_scale / normal_path.w.max(f32::MIN_POSITIVE));
                weight *= falloff_of_four(scaled * scaled);
            }
            if self.position_scale > 0.0 {
                let squares = (x * x + y * y + z * z) * (self.position_scale * self.position_scale);
                weight *= falloff_of_four(squares);
            }
        }
        weight
    }

    /// `w_c`.
    #[inline(always)]
    fn colors(&self, p: &PreparedGuide, q: [&PreparedGuide; 4]) -> Vec4 {
        let own = Vec4::from_array(p.lab_shininess);
        let other = by_component(q.map(|guide| guide.lab_shininess));
        let scale = if own.w > 0.0 { self.color_glossy } else { self.color_diffuse };
        let (l, a, b) = (other.x_axis - own.x, other.y_axis - own.y, other.z_axis - own.z);
        let distance = map(l * l + a * a + b * b, float::sqrt);
        let difference = map(distance * self.color_kappa + 1.0, ln) * self.recip_color_kappa;
        fall(scale, Vec4::ONE - (difference + 1.0).recip())
    }

    /// What the luminance weight needs to know about pixel `p`: its luminance and the variance of its mean.
    /// `None` in place of a luminance (a hole) takes every neighbour.
    #[inline]
    pub fn luminance_of(&self, luminance: Option<f32>, variance: f32) -> LuminanceAround {
        let Some(luminance) = luminance else { return LuminanceAround { luminance: 0.0, factor: 0.0, compare: Off } };
        match self.luminance {
            BY_DEVIATION => {
                // Rounding of a mean is no noise either: a flat image with σ = 0 keeps neighbours within a few ulps.
                let floor = luminance.abs() * f32::EPSILON * 4.0 + f32::MIN_POSITIVE;
                let deviation = self.luminance_scale * float::sqrt(variance.max(0.0)) + floor;
                LuminanceAround { luminance, factor: 1.0 / deviation, compare: Deviation }
            }
            BY_SIGNIFICANCE => {
                // The same floor; its square counts for each of both, so neither may be 0.
                let floor = luminance.abs() * f32::EPSILON * 4.0 + LEAST_DEVIATION;
                let square = self.luminance_scale * self.luminance_scale;
                let own = square * variance.max(0.0) + floor * floor;
                LuminanceAround { luminance, factor: square, compare: Significance(own) }
            }
            BY_DIFFERENCE => {
                let (factor, scale) = (self.luminance_kappa, self.luminance_scale);
                LuminanceAround { luminance, factor, compare: Difference(scale) }
            }
            _ => LuminanceAround { luminance, factor: 0.0, compare: Off },
        }
    }
}

/// How a pixel's luminance is compared.
#[derive(Clone, Copy, Debug)]
enum Compare {
    Off,
    Deviation,
    /// With `s_l`.
    Difference(f32),
    /// With `s_l`²·σ² of the pixel; the factor is `s_l`².
    Significance(f32),
}
use Compare::{Deviation, Difference, Off, Significance};

/// A deviation whose square is a normal number.
const LEAST_DEVIATION: f32 = 1e-18;

/// A pixel's luminance, ready to be compared with its neighbours'.
#[derive(Clone, Copy, Debug)]
pub struct LuminanceAround {
    luminance: f32,
    factor: f32,
    compare: Compare,
}

impl LuminanceAround {
    /// `w_l` for a neighbour's luminance and the variance of that, 0 to 1.
    #[inline]
    pub fn weight(&self, luminance: f32, variance: f32) -> f32 {
        self.weight_of_four(Vec4::splat(luminance), Vec4::splat(variance)).x
    }

    /// [`LuminanceAround::weight`] of four neighbours at once.
    #[inline(always)]
    pub fn weight_of_four(&self, luminance: Vec4, variance: Vec4) -> Vec4 {
        match self.compare {
            Off => Vec4::ONE,
            Deviation => falloff_of_four((luminance - self.luminance).abs() * self.factor),
            Significance(own) => {
                let difference = luminance - self.luminance;
                // Squares that leave the range are those of light beyond any noise; ∞/∞ is not.
                let squares = (difference * difference).min(Vec4::splat(f32::MAX));
                // A hole has a variance below 0.
                falloff_of_four(squares / (variance.max(Vec4::ZERO) * self.factor + own))
            }
            Difference(scale) => {
                let difference = (luminance - self.luminance).abs() * self.factor;
                // Saturates at 1 where Δl/(Δl+1) would be ∞/∞.
                let share = Vec4::ONE - (difference + 1.0).recip();
                (Vec4::ONE - map(share * scale + 1.0, ln)).max(Vec4::ZERO)
            }
        }
    }
}

/// 1 − s·Δ, at least 0.
#[inline(always)]
fn fall(scale: f32, difference: Vec4) -> Vec4 {
    (Vec4::ONE - difference * scale).max(Vec4::ZERO)
}

/// exp(−x) for x ≥ 0 with an end: (1 − x/8)⁸, and 0 from 8 on. Within 0.036 of exp(−x), which it meets at 0 in value and
/// slope; four multiplications instead of a call.
///
/// ```
/// # use layered_filter::weights::falloff;
/// assert_eq!((falloff(0.0), falloff(8.0)), (1.0, 0.0));
/// assert!((falloff(1.0) - 0.367_879).abs() < 0.036);
/// ```
#[inline]
pub fn falloff(x: f32) -> f32 {
    falloff_of_four(Vec4::splat(x)).x
}

#[inline(always)]
fn falloff_of_four(x: Vec4) -> Vec4 {
    let base = (Vec4::ONE - x * 0.125).max(Vec4::ZERO);
    let square = base * base;
    let fourth = square * square;
    fourth * fourth
}

/// Four vectors as four components.
#[inline(always)]
fn by_component(vectors: [[f32; 4]; 4]) -> Mat4 {
    let [a, b, c, d] = vectors.map(Vec4::from_array);
    Mat4::from_cols(a, b, c, d).transpose()
}

#[inline(always)]
fn map(v: Vec4, f: impl Fn(f32) -> f32) -> Vec4 {
    Vec4::from_array(v.to_array().map(f))
}

/// The distance of two colours as equation 5 uses it: `Δc = ln(1 + κ‖c_p − c_q‖)/κ`, in L\*a\*b\*.
#[inline]
pub fn color_difference(kappa: f32, p: Vec3, q: Vec3) -> f32 {
    ln(1.0 + kappa * (p - q).length()) / kappa
}
