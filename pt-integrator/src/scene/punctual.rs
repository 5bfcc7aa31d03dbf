//! Lights without extent.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A point, a spot or a direction from which light comes. 64 bytes.
///
/// # Units
/// glTF states candela and lux. They are taken as 1 cd = 1 W/sr and 1 lx = 1 W/m².
///
/// # Source
/// glTF light extension.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PunctualLight {
    /// Position in the scene; w: [`PunctualLight::POINT`] and so on. A directional light has no position.
    pub position: [f32; 4],
    /// Unit direction from the light; w: cosine of the cone's inner half angle. A point has no direction.
    pub direction: [f32; 4],
    /// Linear Rec. 709 radiant intensity in W/sr, of a directional light its irradiance in W/m² on a plane that faces
    /// it; w: cosine of the cone's outer half angle.
    pub intensity: [f32; 4],
    /// Distance in metres at which the light has faded out, 0 for none; then 0, in a packed scene the probability with
    /// which next-event estimation chooses the light; then zeros.
    pub range: [f32; 4],
}

impl PunctualLight {
    /// Kind: shines equally in all directions.
    pub const POINT: f32 = 0.0;
    /// Kind: shines into a cone.
    pub const SPOT: f32 = 1.0;
    /// Kind: shines from infinitely far.
    pub const DIRECTIONAL: f32 = 2.0;

    /// A point of this intensity without a range.
    pub const fn point(position: Vec3, intensity: [f32; 3]) -> Self {
        Self::new(Self::POINT, position, Vec3::NEG_Z, intensity, [-1.0, -1.0])
    }

    /// A spot that shines along `direction` (unit); `cosines` of the half angles of its inner and outer cone.
    pub const fn spot(position: Vec3, direction: Vec3, intensity: [f32; 3], cosines: [f32; 2]) -> Self {
        Self::new(Self::SPOT, position, direction, intensity, cosines)
    }

    /// Light that travels along `direction` (unit) and brings this irradiance.
    pub const fn directional(direction: Vec3, irradiance: [f32; 3]) -> Self {
        Self::new(Self::DIRECTIONAL, Vec3::ZERO, direction, irradiance, [-1.0, -1.0])
    }

    /// Whether the light has no position.
    #[inline]
    pub fn is_directional(&self) -> bool {
        // Kinds are small integers; in between lies none.
        self.position[3] > 1.5
    }

    /// Whether the light has a cone.
    #[inline]
    pub fn is_spot(&self) -> bool {
        self.position[3] > 0.5 && !self.is_directional()
    }

    const fn new(kind: f32, p: Vec3, d: Vec3, [r, g, b]: [f32; 3], [inner, outer]: [f32; 2]) -> Self {
        Self {
            position: [p.x, p.y, p.z, kind],
            direction: [d.x, d.y, d.z, inner],
            intensity: [r, g, b, outer],
            range: [0.0; 4],
        }
    }
}
