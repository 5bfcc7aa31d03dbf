//! The ray caster's face.

use backend_api::{Error, HitRecord, RayRecord, TraceRays};
use hashcache_core::geometry::{Geometry, Hit, Instance, Ray};
use hashcache_core::traits::RayCaster;

use super::holes::{Holes, Masked, Masks, Solid};
use super::input::{check, triangles};
use super::instance::{Placed, Placements};
use super::lanes::{Lanes, Portable};
#[cfg(target_arch = "x86_64")]
use super::lanes_avx2::Avx2;
use super::layout::{LEAF, Rows, WIDTH};
use super::mesh::Mesh;
use super::ray::{is_usable, is_within_range, rescaled};
use super::triangle::Nearest;

/// A scene's triangles, ready to be met by rays.
///
/// Hits do not depend on the processor: no operation is fused, and every kind of lanes gives the same bits. Of triangles
/// at equal distance the one listed first is met. A ray whose origin or direction is not finite, or whose direction's
/// largest component is below 2⁻¹²⁶, meets nothing. With `t_min` ≥ 0, no ray passes between triangles that share an edge
/// (a mesh whose corners coincide is tight); behind the origin it may, within rounding.
///
/// A ray passes the holes of a triangle ([`Geometry::opacity`]) as if nothing were there; what it meets is what it would
/// meet without the triangles that it passes. A scene without holes runs code without a trace of them.
///
/// # Memory
/// 224 bytes a node and 320 bytes a block: about 80 bytes a triangle, and 8 more for triangles copied into the scene's
/// space. Where there are masks: 4 bytes a triangle, 28 more for each that has one, and their images.
///
/// # Source
/// See the modules: clustering by obvhs, then Ylitie et al. 2017 for the wide nodes, Woop et al. 2013 for the triangles.
///
/// # Examples
/// ```
/// use backend_cpu::rays::CpuScene;
/// use glam::Vec3;
/// use hashcache_core::geometry::{Geometry, Instance, Mesh, Ray};
/// use hashcache_core::traits::RayCaster;
///
/// let scene = CpuScene::build(&Geometry {
///     positions: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     indices: &[[0, 1, 2]],
///     meshes: &[Mesh { first_triangle: 0, triangle_count: 1 }],
///     instances: &[Instance::identity(0)],
///     ..Geometry::default()
/// })?;
/// let origin = Vec3::new(0.25, 0.5, 3.0);
/// let ray = Ray { origin, t_min: 0.0, direction: Vec3::NEG_Z, t_max: f32::INFINITY };
/// let hit = scene.closest(&ray).expect("the ray meets the triangle");
/// assert_eq!((hit.t, hit.u, hit.v), (3.0, 0.25, 0.5));
/// assert!(!scene.occluded(&Ray { t_max: 3.0, ..ray }));
/// # Ok::<(), backend_api::Error>(())
/// ```
pub struct CpuScene {
    /// Meshes placed once or small: their triangles in the scene's space.
    flat: Option<Mesh>,
    /// Instance and triangle of each number in `flat`.
    names: Vec<[u32; 2]>,
    /// Meshes placed more than once.
    placements: Option<Placements>,
    /// Triangles with holes.
    masks: Option<Masks>,
    triangles: u64,
    skipped: u64,
    #[cfg(target_arch = "x86_64")]
    avx2: Option<Avx2>,
}

/// What a scene's hierarchy takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stats {
    /// Triangles in the hierarchies; copies of a mesh that are kept by reference count once.
    pub triangles: u64,
    /// Nodes of eight boxes.
    pub nodes: u64,
    /// Blocks of up to eight triangles.
    pub blocks: u64,
    /// Meshes kept by reference.
    pub references: u64,
    /// Bytes of all of it.
    pub bytes: u64,
    /// Triangles left out: a corner that is not finite or farther than 2⁴⁰ from the origin, or two equal corners.
    pub skipped: u64,
}

/// A mesh is copied into the scene's space when it is placed once or when its copies have at most this many triangles
/// together: one hierarchy is faster than two levels, and this much memory (4 MiB) does not matter.
const COPIED: u64 = 65_536;

impl CpuScene {
    /// Sorts the triangles of `geometry` into hierarchies.
    ///
    /// # Errors
    /// [`Error::BadRange`] when an index, mesh or instance names something that is not there, or a mask does;
    /// [`Error::OutOfMemory`] for 2³⁰ triangles or more, listed or placed.
    pub fn build(geometry: &Geometry<'_>) -> Result<Self, Error> {
        check(geometry)?;
        let mut uses = vec![0u64; geometry.meshes.len()];
        for instance in geometry.instances {
            uses[instance.mesh as usize] += 1;
        }
        let mut scene = Self {
            flat: None,
            names: Vec::new(),
            placements: None,
            masks: Masks::new(geometry),
            triangles: 0,
            skipped: 0,
            #[cfg(target_arch = "x86_64")]
            avx2: Avx2::detect(),
        };
        let (mut flat, mut placed, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
        let mut built = vec![None; geometry.meshes.len()];
        for (number, instance) in geometry.instances.iter().enumerate() {
            let mesh = instance.mesh as usize;
            let copies = uses[mesh] * geometry.meshes[mesh].triangle_count as u64;
            if uses[mesh] > 1 && copies > COPIED {
                let (index, bounds) = *built[mesh].get_or_insert_with(|| {
                    let place = Instance::identity(mesh as u32);
                    let triangles = triangles(geometry, scene.masks.as_ref(), &place, &mut scene.skipped);
                    let bounds = triangles
                        .iter()
                        .flat_map(|t| t.corners)
                        .fold(obvhs::aabb::Aabb::empty(), |mut bounds, p| *bounds.extend(p.into()));
                    scene.triangles += triangles.len() as u64;
                    if !triangles.is_empty() {
                        meshes.push(Mesh::new(&triangles));
                    }
                    (meshes.len().wrapping_sub(1), if triangles.is_empty() { None } else { Some(bounds) })
                });
                let Some(bounds) = bounds else { continue };
                if let Some(place) = Placed::new(instance, number as u32, index, &bounds) {
                    placed.push(place);
                    continue;
                }
            }
            for mut triangle in triangles(geometry, scene.masks.as_ref(), instance, &mut scene.skipped) {
                scene.names.push([number as u32, triangle.id]);
                triangle.id = scene.names.len() as u32 - 1;
                flat.push(triangle);
            }
        }
        scene.triangles += flat.len() as u64;
        if !flat.is_empty() {
            scene.flat = Some(Mesh::new(&flat));
        }
        if !placed.is_empty() {
            scene.placements = Some(Placements::new(placed, meshes));
        }
        Ok(scene)
    }

    /// What the hierarchies take.
    pub fn stats(&self) -> Stats {
        let placements = self.placements.as_ref();
        let meshes = self.flat.iter().chain(placements.into_iter().flat_map(|p| &p.meshes));
        let rows = || meshes.clone().map(|m| &m.rows).chain(placements.map(|p| &p.rows));
        let references = placements.map_or(0, |p| p.placed.len());
        let bytes = rows().map(Rows::bytes).sum::<usize>()
            + references * size_of::<Placed>()
            + self.names.len() * size_of::<[u32; 2]>()
            + self.masks.as_ref().map_or(0, Masks::bytes);
        Stats {
            triangles: self.triangles,
            nodes: rows().map(|r| r.nodes as u64).sum(),
            blocks: rows().map(|r| r.blocks as u64).sum(),
            references: references as u64,
            bytes: bytes as u64,
            skipped: self.skipped,
        }
    }

    #[inline(always)]
    fn closest_with<L: Lanes<WIDTH> + Lanes<LEAF>, H: Holes>(&self, l: L, ray: &Ray, holes: [H; 2]) -> Option<Hit> {
        let mut nearest = Nearest::none(ray.t_max);
        if let Some(mesh) = &self.flat {
            mesh.closest(l, ray, holes[0], &mut nearest);
        }
        let placed = self.placements.as_ref().and_then(|p| p.closest(l, ray, holes[1], &mut nearest));
        if nearest.id == u32::MAX {
            return None;
        }
        let [instance, triangle] = placed.map_or_else(|| self.names[nearest.id as usize], |i| [i, nearest.id]);
        let [u, v] = nearest.weights();
        Some(Hit { t: nearest.t, u, v, triangle, instance })
    }

    #[inline(always)]
    fn occluded_with<L: Lanes<WIDTH> + Lanes<LEAF>, H: Holes>(&self, l: L, ray: &Ray, holes: [H; 2]) -> bool {
        self.flat.as_ref().is_some_and(|m| m.occluded(l, ray, holes[0]))
            || self.placements.as_ref().is_some_and(|p| p.occluded(l, ray, holes[1]))
    }

    /// The masks as numbers of the copied mesh name triangles, and as those of placed meshes do.
    fn masked<'a>(&'a self, masks: &'a Masks) -> [Masked<'a>; 2] {
        [Masked { masks, names: &self.names }, Masked { masks, names: &[] }]
    }

    #[inline(always)]
    fn closest_in_range(&self, ray: &Ray) -> Option<Hit> {
        match &self.masks {
            None => self.closest_among(ray, [Solid; 2]),
            Some(masks) => self.closest_among(ray, self.masked(masks)),
        }
    }

    #[inline(always)]
    fn occluded_in_range(&self, ray: &Ray) -> bool {
        match &self.masks {
            None => self.occluded_among(ray, [Solid; 2]),
            Some(masks) => self.occluded_among(ray, self.masked(masks)),
        }
    }

    #[inline(never)]
    fn closest_among<H: Holes>(&self, ray: &Ray, holes: [H; 2]) -> Option<Hit> {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.run(
                #[inline(always)]
                || self.closest_with(avx2, ray, holes),
            );
        }
        self.closest_with(Portable, ray, holes)
    }

    #[inline(never)]
    fn occluded_among<H: Holes>(&self, ray: &Ray, holes: [H; 2]) -> bool {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.avx2 {
            return avx2.run(
                #[inline(always)]
                || self.occluded_with(avx2, ray, holes),
            );
        }
        self.occluded_with(Portable, ray, holes)
    }
}

impl RayCaster for CpuScene {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        if !is_usable(ray) {
            return None;
        }
        if is_within_range(ray.direction.abs().max_element()) {
            return self.closest_in_range(ray);
        }
        let (scaled, factor) = rescaled(ray);
        let hit = self.closest_in_range(&scaled)?;
        Some(Hit { t: hit.t * factor, ..hit })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        is_usable(ray)
            && if is_within_range(ray.direction.abs().max_element()) {
                self.occluded_in_range(ray)
            } else {
                self.occluded_in_range(&rescaled(ray).0)
            }
    }
}

fn plain(ray: &RayRecord) -> Ray {
    Ray { origin: ray.origin.into(), t_min: ray.t_min, direction: ray.direction.into(), t_max: ray.t_max }
}

impl TraceRays for CpuScene {
    fn trace_closest(&self, ray: &RayRecord) -> HitRecord {
        match self.closest(&plain(ray)) {
            Some(Hit { t, u, v, triangle, instance }) => HitRecord { t, u, v, triangle, instance },
            None => {
                HitRecord { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: HitRecord::MISS, instance: HitRecord::MISS }
            }
        }
    }

    fn trace_occluded(&self, ray: &RayRecord) -> bool {
        self.occluded(&plain(ray))
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use glam::Vec3;
    use hashcache_core::geometry::{Mesh as Run, Opacity, OpacityMask};

    use super::*;

    #[test]
    fn every_processor_gives_the_same_bits() {
        let mut state = 1u32;
        let mut next = || {
            state = hashcache_core::hash::pcg(state);
            state as f32 / 2_147_483_648.0 - 1.0
        };
        let mut vector = |scale: f32| Vec3::new(next(), next(), next()) * scale;
        let mut positions = Vec::new();
        for _ in 0..5000 {
            let middle = vector(1.0);
            positions.extend([0; 3].map(|_| (middle + vector(0.05)).to_array()));
        }
        let indices: Vec<[u32; 3]> = (0..5000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let meshes =
            [Run { first_triangle: 0, triangle_count: 4000 }, Run { first_triangle: 4000, triangle_count: 1000 }];
        let mut instances = vec![Instance::identity(0)];
        for i in 0..70 {
            let mut instance = Instance::identity(1);
            instance.to_scene[0][3] = i as f32 * 0.1;
            instance.to_scene[1][0] = 0.3;
            instances.push(instance);
        }
        // A chequerboard of holes in every other triangle.
        let mask = OpacityMask {
            first_alpha: 0,
            width: 2,
            height: 2,
            wrap: 0,
            uv_rows: OpacityMask::IDENTITY,
            cutoff: 0.5,
            factor: 1.0,
            reserved: [0; 2],
        };
        let opacity = Opacity {
            mask_of_triangle: &[0, Opacity::NO_MASK].repeat(2500),
            masks: &[mask],
            uv: &vec![[[0.0, 0.0], [3.0, 1.0], [1.0, 2.0]]; 5000],
            alpha: &[255, 0, 0, 255],
        };
        let solid = Geometry {
            positions: &positions,
            indices: &indices,
            meshes: &meshes,
            instances: &instances,
            opacity: Opacity::NONE,
        };
        let mut met = [0; 2];
        for (geometry, met) in [solid, Geometry { opacity, ..solid }].iter().zip(&mut met) {
            let fast = CpuScene::build(geometry).unwrap();
            assert_eq!(fast.stats().references, 70);
            let mut slow = CpuScene::build(geometry).unwrap();
            if fast.avx2.is_none() {
                println!("skipped: the processor has no AVX2");
            }
            slow.avx2 = None;
            for _ in 0..20_000 {
                let ray = Ray { origin: vector(3.0), t_min: 0.0, direction: vector(1.0), t_max: f32::INFINITY };
                let hit = fast.closest(&ray);
                assert_eq!(hit, slow.closest(&ray), "{ray:?}");
                assert_eq!(fast.occluded(&ray), slow.occluded(&ray), "{ray:?}");
                assert_eq!(fast.occluded(&ray), hit.is_some(), "{ray:?}");
                *met += u32::from(hit.is_some());
            }
        }
        assert!(met[0] > 2000 && met[1] > 1500 && met[1] < met[0], "{met:?}");
    }
}
