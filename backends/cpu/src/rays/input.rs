//! What a caller gives: checked, and triangle by triangle.

use backend_api::Error;
use glam::Vec3;
use hashcache_core::geometry::{Geometry, Instance, OpacityError};

use super::holes::{MASKED, Masks};
use super::layout::{Block, LEAF};
use super::mesh::Numbered;

/// Corners farther out, in metres, are left out: products of three coordinates must stay finite.
const FARTHEST: f32 = 1_099_511_627_776.0;

/// Looks every index up once, so that nothing below can fail.
pub(super) fn check(geometry: &Geometry<'_>) -> Result<(), Error> {
    let bad = |offset: u32, size: u32| Error::BadRange { at: "geometry", offset: offset.into(), size: size.into() };
    let mut total = 0u64;
    for instance in geometry.instances {
        let mesh = geometry.meshes.get(instance.mesh as usize).ok_or_else(|| bad(instance.mesh, 1))?;
        total = total.saturating_add(mesh.triangle_count as u64);
    }
    countable(total, geometry.indices.len() as u64)?;
    for mesh in geometry.meshes {
        let end = mesh.first_triangle as u64 + mesh.triangle_count as u64;
        if end > geometry.indices.len() as u64 {
            return Err(bad(mesh.first_triangle, mesh.triangle_count));
        }
    }
    let corner = geometry.indices.iter().flatten().max().copied();
    match corner {
        Some(corner) if corner as usize >= geometry.positions.len() => return Err(bad(corner, 1)),
        _ => {}
    }
    geometry.opacity.check(geometry.indices.len()).map_err(|error| {
        let (offset, size) = match error {
            OpacityError::Index { index, .. } => (index, 1),
            OpacityError::Length { found, expected, .. } => (found, expected),
            OpacityError::Size { mask, .. } => (mask, 1),
            OpacityError::Number { element, .. } => (element, 1),
            _ => (0, 0),
        };
        Error::BadRange { at: "opacity", offset, size }
    })
}

/// Numbers of triangles must leave [`MASKED`] free: those of copied meshes count what is placed, those of meshes kept by
/// reference are places in the list.
fn countable(placed: u64, listed: u64) -> Result<(), Error> {
    let most = placed.max(listed);
    if most < u64::from(MASKED) {
        return Ok(());
    }
    Err(Error::OutOfMemory { size: most.saturating_mul((size_of::<Block>() / LEAF) as u64) })
}

/// The triangles of a placed mesh that rays can meet.
pub(super) fn triangles(
    geometry: &Geometry<'_>,
    masks: Option<&Masks>,
    instance: &Instance,
    skipped: &mut u64,
) -> Vec<Numbered> {
    let mesh = geometry.meshes[instance.mesh as usize];
    let mut triangles = Vec::with_capacity(mesh.triangle_count as usize);
    for id in mesh.first_triangle..mesh.first_triangle + mesh.triangle_count {
        let corners =
            geometry.indices[id as usize].map(|corner| instance.point(Vec3::from(geometry.positions[corner as usize])));
        let [a, b, c] = corners;
        let near = corners.iter().all(|p| p.abs().cmple(Vec3::splat(FARTHEST)).all());
        if near && a != b && b != c && c != a {
            triangles.push(Numbered { corners, id, masked: masks.is_some_and(|masks| masks.has(id)) });
        } else {
            *skipped += 1;
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_triangles_as_numbers_leave_room_for() {
        let most = u64::from(MASKED) - 1;
        assert!(countable(most, most).is_ok());
        for (placed, listed) in [(most + 1, 1), (1, most + 1), (u64::MAX, 0)] {
            assert!(matches!(countable(placed, listed), Err(Error::OutOfMemory { .. })), "{placed} {listed}");
        }
    }
}
