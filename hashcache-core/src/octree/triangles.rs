//! All placed triangles of a scene, in one numbering.

use alloc::vec::Vec;
use core::ops::Range;

use glam::Vec3;

use super::error::BuildError;
use crate::geometry::Geometry;

/// The placed triangles of a geometry: those of the first instance first, in the order of its mesh.
#[derive(Debug)]
pub struct Triangles<'a> {
    geometry: Geometry<'a>,
    /// The first triangle of every instance, and their number at the end.
    first: Vec<u32>,
}

impl<'a> Triangles<'a> {
    /// Numbers the triangles.
    ///
    /// # Errors
    /// [`BuildError::TooMany`] from 2³² placed triangles on.
    pub fn new(geometry: &Geometry<'a>) -> Result<Self, BuildError> {
        let mut first = Vec::with_capacity(geometry.instances.len() + 1);
        let mut count = 0_u32;
        first.push(count);
        for instance in geometry.instances {
            let mesh = geometry.meshes[instance.mesh as usize];
            count = count.checked_add(mesh.triangle_count).ok_or(BuildError::TooMany)?;
            first.push(count);
        }
        Ok(Self { geometry: *geometry, first })
    }

    /// Their number.
    pub fn count(&self) -> u32 {
        self.first.last().copied().unwrap_or(0)
    }

    /// The corners of the triangles of a range, with their numbers.
    pub fn range(&self, range: Range<u32>) -> impl Iterator<Item = (u32, [Vec3; 3])> {
        let mut instance = self.first.partition_point(|first| *first <= range.start).saturating_sub(1);
        range.map(move |id| {
            while self.first[instance + 1] <= id {
                instance += 1;
            }
            let placed = &self.geometry.instances[instance];
            let mesh = self.geometry.meshes[placed.mesh as usize];
            let corners = self.geometry.indices[(mesh.first_triangle + id - self.first[instance]) as usize];
            (id, corners.map(|corner| placed.point(Vec3::from_array(self.geometry.positions[corner as usize]))))
        })
    }

    /// The box around all triangles whose corners are finite; `None` when there is none.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let finite = self.range(0..self.count()).filter(|(_, corners)| corners.iter().all(|corner| corner.is_finite()));
        let [low, high] = finite.fold(nothing, |bounds, (_, corners)| {
            corners.iter().fold(bounds, |[low, high], corner| [low.min(*corner), high.max(*corner)])
        });
        (low.x <= high.x).then_some([low, high])
    }
}
