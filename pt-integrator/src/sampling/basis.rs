//! Two directions that complete a normal.

use glam::{Vec2, Vec3};

/// An orthonormal, right-handed basis about a unit normal.
///
/// # Source
/// Duff et al. 2017.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// First tangent.
    pub tangent: Vec3,
    /// Second tangent.
    pub bitangent: Vec3,
    /// The normal.
    pub normal: Vec3,
}

impl Basis {
    /// The basis about `normal`, which must be of unit length.
    ///
    /// ```
    /// use hashcache_core::glam::Vec3;
    /// use pt_integrator::sampling::Basis;
    /// let basis = Basis::new(Vec3::NEG_Z);
    /// assert_eq!(basis.tangent.cross(basis.bitangent), Vec3::NEG_Z);
    /// ```
    #[inline]
    pub fn new(normal: Vec3) -> Self {
        let sign = 1.0_f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// A vector's coordinates in the basis.
    #[inline]
    pub fn to_local(&self, vector: Vec3) -> Vec3 {
        Vec3::new(self.tangent.dot(vector), self.bitangent.dot(vector), self.normal.dot(vector))
    }

    /// The vector with these coordinates in the basis.
    #[inline]
    pub fn to_scene(&self, tangential: Vec2, normal: f32) -> Vec3 {
        self.tangent * tangential.x + self.bitangent * tangential.y + self.normal * normal
    }
}
