//! The parts of a surface's reflection that are estimated one at a time.

use glam::Vec3;

/// A part of what a surface does with light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lobe {
    /// Light that has been inside of the surface: Lambert's, less what the interface reflects. The lobe that caches hold.
    Diffuse = 0,
    /// Light reflected by the surface's microfacets.
    Reflection = 1,
    /// Light that passes through the surface.
    Transmission = 2,
    /// Light reflected by the clear coat.
    Coat = 3,
}

impl Lobe {
    /// Every lobe, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::Diffuse, Self::Reflection, Self::Transmission, Self::Coat];
}

/// A lobe that was chosen by chance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobePick {
    /// The lobe.
    pub lobe: Lobe,
    /// How likely it was, in `(0, 1]`; estimates of the lobe are divided by it. Exactly 1 when there was no choice.
    pub probability: f32,
}

/// A direction from which light may come, drawn from one lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit direction towards the light.
    pub incoming: Vec3,
    /// f·|cos θ| / pdf, for the diffuse lobe without its [throughput](super::Bsdf::diffuse_throughput). At most
    /// 1 / [`eta`](Self::eta)².
    pub weight: Vec3,
    /// Density by solid angle; infinite for a delta lobe, so that the power heuristic gives it weight 1.
    pub pdf: f32,
    /// Whether no other direction of this lobe reflects: light is found by following it only.
    pub is_delta: bool,
    /// Whether the direction lies on the other side of the surface.
    pub transmitted: bool,
    /// Refractive index on the light's side over that on the viewer's; 1 unless a solid was entered or left. Radiance
    /// is divided by its square, which leaving the solid undoes; multiply roulette's throughput by the square.
    pub eta: f32,
}
