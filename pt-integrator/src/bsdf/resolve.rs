//! A material, a normal and a view, resolved.

use glam::Vec3;

use super::Lobe;
use super::fresnel::{Fresnel, Interface, fresnel_dielectric, kept_by_facets, kept_index, roughened};
use super::inputs::{BsdfInputs, unit_color, unit_interval};
use super::microfacet::Ggx;
use crate::sampling::Basis;

/// α = roughness² below which a lobe reflects like a mirror: a blur of a thousandth of a radian.
///
/// Larger: polished metal turns into a mirror. Smaller: densities above 10⁶, which f32 holds with too few digits.
pub const SMALLEST_ALPHA: f32 = 1.0 / 1024.0;

/// Width of a transmitted lobe (α by how far the interface bends) below which light passes as through smooth glass:
/// microfacets that do not bend light do not blur it, and their half vectors lose their digits.
const SMALLEST_BEND: f32 = 1.0 / 4096.0;

/// Refractive index of the clear coat (`KHR_materials_clearcoat`).
const COAT_IOR: f32 = 1.5;

/// How light passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passage {
    /// Not at all, or straight through without any blur.
    Straight,
    /// Through a thin wall of microfacets.
    ThinRough,
    /// Into or out of a smooth solid.
    Refracted,
    /// Into or out of a rough solid.
    RefractedRough,
}

/// Least share expected of rough reflection: facets may reflect light where the surface as a whole would not. 0 would
/// leave such light out.
const SMALLEST_REFLECTION: f32 = 1.0 / 4096.0;

/// Least share expected of rough transmission, and α / 2 more through a solid, for the same reason.
const SMALLEST_PASSAGE: f32 = 1.0 / 64.0;

/// Bound on how much more the facets of a coat of roughness α reflect than their mean plane would: Fresnel's mean is
/// above that of the mean angle, by 1.13 % where α = 0.09, and by less before masking outweighs it. Without it a coat over
/// clear glass would return up to 0.05 % more light than it gets.
#[inline]
fn dimming(alpha: f32) -> f32 {
    if alpha < SMALLEST_ALPHA { 1.0 } else { 1.0 + (0.2 * alpha).min(0.0125) }
}

/// The clear coat. It lies outside of a solid, and on both sides of anything else.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coat {
    pub strength: f32,
    /// [`strength`](Self::strength) as what lies under the coat sees it; see [`dimming`].
    pub dims: f32,
    pub normal: Vec3,
    /// Below [`SMALLEST_ALPHA`]: smooth.
    pub alpha: f32,
    /// The viewer is inside of the solid: neither the view nor reflected light crosses the coat.
    pub is_behind: bool,
    /// Transmitted light crosses it on the other side.
    pub is_beyond: bool,
}

impl Coat {
    const NONE: Self =
        Self { strength: 0.0, dims: 0.0, normal: Vec3::ZERO, alpha: 0.0, is_behind: false, is_beyond: false };

    /// Share of light that the coat reflects, for the cosine between its normal and light or view.
    #[inline]
    pub fn reflected(&self, cosine: f32) -> f32 {
        self.strength * fresnel_dielectric(unit_interval(cosine), COAT_IOR)
    }

    /// Share of light that the coat as a whole lets through, on either way.
    #[inline]
    fn let_through(&self, cosine: f32) -> f32 {
        unit_interval(1.0 - self.dims * fresnel_dielectric(unit_interval(cosine), COAT_IOR))
    }

    /// Share of light from a direction on the viewer's side that gets through the coat.
    #[inline]
    pub fn passed(&self, direction: Vec3) -> f32 {
        if self.strength == 0.0 || self.is_behind { 1.0 } else { self.let_through(self.normal.dot(direction)) }
    }

    /// [`passed`](Self::passed) for a direction on the other side.
    #[inline]
    pub fn passed_beyond(&self, direction: Vec3) -> f32 {
        if self.strength == 0.0 || !self.is_beyond { 1.0 } else { self.let_through(self.normal.dot(direction).abs()) }
    }
}

/// A material at a point, seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    pub(super) outgoing: Vec3,
    pub(super) frame: Basis,
    pub(super) ggx: Ggx,
    pub(super) fresnel: Fresnel,
    /// Nothing lies above the diffuse lobe: it is Lambert's.
    pub(super) is_bare: bool,
    pub(super) is_smooth: bool,
    pub(super) passage: Passage,
    pub(super) coat: Coat,
    pub(super) diffuse: Vec3,
    /// What multiplies the reflection lobe: what the coat leaves of the view.
    pub(super) reflects: f32,
    /// What multiplies the transmission lobe, without Fresnel's factor.
    pub(super) passes: Vec3,
    /// Expected share of light by lobe.
    pub(super) albedos: [Vec3; 4],
    pub(super) probabilities: [f32; 4],
}

impl Bsdf {
    /// Resolves a material. `normal` is the unit shading normal on the side of `outgoing`, which is the unit direction
    /// towards where the ray came from. `entering`: a ray that is bent here goes from the outside into the solid.
    ///
    /// A view from below the normal sees no reflection and nothing through the surface. A normal without a direction is
    /// taken as the view's.
    #[inline]
    pub fn new(inputs: &BsdfInputs, normal: Vec3, outgoing: Vec3, entering: bool) -> Self {
        let (normal, outgoing) = units(normal, outgoing);
        let base_color = unit_color(inputs.base_color);
        let [metallic, specular, transmission] =
            [inputs.metallic, inputs.specular, inputs.transmission].map(unit_interval);
        let clearcoat = unit_interval(inputs.clearcoat);
        let mut bsdf = Self::bare(normal, outgoing, base_color * ((1.0 - metallic) * (1.0 - transmission)));
        if metallic + specular + transmission + clearcoat == 0.0 {
            return bsdf;
        }
        let is_solid = !inputs.thin && transmission > 0.0;
        let inside = is_solid && !entering;
        bsdf.fresnel = Fresnel::new(&Interface {
            base_color,
            metallic,
            ior: kept_index(inputs.ior),
            specular,
            specular_color: inputs.specular_color.max(Vec3::ZERO).min(Vec3::splat(f32::MAX)),
            refracted: if is_solid { transmission } else { 0.0 },
            inside,
        });
        let coat_alpha = unit_interval(inputs.clearcoat_roughness * inputs.clearcoat_roughness);
        bsdf.coat = Coat {
            strength: clearcoat,
            dims: clearcoat * dimming(coat_alpha),
            normal: inputs.coat_normal,
            alpha: coat_alpha,
            is_behind: inside,
            is_beyond: inside || !is_solid,
        };
        bsdf.is_bare = bsdf.fresnel.is_absent() && clearcoat == 0.0;
        if !bsdf.is_bare || transmission > 0.0 {
            let passes = base_color * ((1.0 - metallic) * transmission);
            bsdf.resolve(unit_interval(inputs.roughness), passes, is_solid);
        }
        bsdf
    }

    /// A diffuse lobe and nothing else.
    #[inline]
    fn bare(normal: Vec3, outgoing: Vec3, diffuse: Vec3) -> Self {
        let frame = Basis::new(normal);
        Self {
            outgoing,
            frame,
            ggx: Ggx::smooth(frame.to_local(outgoing)),
            fresnel: Fresnel::NONE,
            is_bare: true,
            is_smooth: true,
            passage: Passage::Straight,
            coat: Coat::NONE,
            diffuse,
            reflects: 0.0,
            passes: Vec3::ZERO,
            albedos: [diffuse, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO],
            probabilities: [1.0, 0.0, 0.0, 0.0],
        }
    }

    /// Everything that a Lambertian surface does without.
    #[inline]
    fn resolve(&mut self, roughness: f32, passes: Vec3, is_solid: bool) {
        let view = self.ggx.view;
        let alpha = roughness * roughness;
        self.is_smooth = alpha < SMALLEST_ALPHA;
        let angle = self.fresnel.at(unit_interval(view.z));
        let coat = self.resolve_coat();
        self.diffuse *= self.fresnel.entered(angle) * coat;
        self.albedos[Lobe::Diffuse as usize] = self.diffuse;
        if view.z > 0.0 {
            let mean = if self.is_smooth { angle } else { self.fresnel.mean(angle, view.z, alpha) };
            if !self.is_smooth {
                self.ggx = Ggx::new(alpha, view);
            }
            if !self.fresnel.is_absent() {
                self.reflects = coat;
                let mut reflected = self.fresnel.reflected(mean);
                if !self.is_smooth {
                    reflected = reflected.max(Vec3::splat(SMALLEST_REFLECTION)) * kept_by_facets(alpha, view.z);
                }
                self.albedos[Lobe::Reflection as usize] = reflected * coat;
            }
            self.passage = self.passage_for(alpha, is_solid);
            self.passes = passes * coat;
            let passed = match self.passage {
                Passage::Refracted => self.fresnel.passed(angle),
                Passage::RefractedRough => {
                    let lost = 0.6 * alpha * if self.fresnel.eta < 1.0 { 1.0 } else { 1.0 - view.z };
                    self.fresnel.passed(mean).max(SMALLEST_PASSAGE + 0.5 * alpha) * (1.0 - lost)
                }
                Passage::Straight => self.fresnel.entered(mean),
                Passage::ThinRough => self.fresnel.entered(mean).max(SMALLEST_PASSAGE) * kept_by_facets(alpha, view.z),
            };
            self.albedos[Lobe::Transmission as usize] = self.passes * passed;
        }
        self.choose();
    }

    /// What the coat leaves of the view.
    #[inline]
    fn resolve_coat(&mut self) -> f32 {
        if self.coat.strength == 0.0 || self.coat.is_behind {
            return 1.0;
        }
        self.coat.normal = unit_or(self.coat.normal, self.frame.normal);
        let cosine = self.coat.normal.dot(self.outgoing);
        let reflected = self.coat.reflected(cosine);
        if cosine > 0.0 {
            let mean = if self.coat.alpha < SMALLEST_ALPHA {
                reflected
            } else {
                roughened(reflected, self.coat.reflected(1.0), self.coat.alpha)
                    * kept_by_facets(self.coat.alpha, cosine)
            };
            self.albedos[Lobe::Coat as usize] = Vec3::splat(mean);
        }
        self.coat.let_through(cosine)
    }

    #[inline]
    fn passage_for(&self, alpha: f32, is_solid: bool) -> Passage {
        let eta = self.fresnel.eta;
        if is_solid && eta != 0.0 && !self.fresnel.is_equal() {
            // NaN free: η is above 0.
            let is_blurred = !self.is_smooth && alpha * (1.0 - 1.0 / eta).abs() >= SMALLEST_BEND;
            if is_blurred { Passage::RefractedRough } else { Passage::Refracted }
        } else if self.is_smooth || is_solid {
            Passage::Straight
        } else {
            Passage::ThinRough
        }
    }
}

/// Both of unit length, whatever they were.
#[inline]
fn units(normal: Vec3, outgoing: Vec3) -> (Vec3, Vec3) {
    if is_unit(normal) && is_unit(outgoing) { (normal, outgoing) } else { repaired_units(normal, outgoing) }
}

#[cold]
fn repaired_units(normal: Vec3, outgoing: Vec3) -> (Vec3, Vec3) {
    let outgoing = unit_or(outgoing, unit_or(normal, Vec3::Z));
    (unit_or(normal, outgoing), outgoing)
}

/// Whether the length is 1 but for rounding. Not for NaN.
#[inline]
fn is_unit(v: Vec3) -> bool {
    (v.length_squared() - 1.0).abs() < 1e-4
}

/// `v` when its length is 1 but for rounding, its direction when it has another, else `otherwise`.
#[inline]
fn unit_or(v: Vec3, otherwise: Vec3) -> Vec3 {
    if is_unit(v) { v } else { repaired(v, otherwise) }
}

#[cold]
fn repaired(v: Vec3, otherwise: Vec3) -> Vec3 {
    // Of largest component 1 first, so that no square overflows or vanishes.
    (v / v.abs().max_element()).try_normalize().unwrap_or(otherwise)
}
