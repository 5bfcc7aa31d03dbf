//! Laws of triangles with holes, beside a model that looks alpha up in f64.

mod rays_model;

use backend_api::Error;
use backend_cpu::rays::CpuScene;
use glam::{DVec2, DVec3, Vec3};
use hashcache_core::geometry::{Geometry, Hit, Instance, Opacity, OpacityMask, Ray};
use hashcache_core::hash::pcg;
use hashcache_core::texel::Wrap;
use hashcache_core::traits::RayCaster;
use proptest::prelude::*;

use rays_model::{Numbers, Soup, interval_is_open, place, rays, soup};

/// Triangles, some with masks.
struct Lace {
    soup: Soup,
    mask_of_triangle: Vec<u32>,
    masks: Vec<OpacityMask>,
    uv: Vec<[[f32; 2]; 3]>,
    alpha: Vec<u8>,
}

const PLAIN: OpacityMask = OpacityMask {
    first_alpha: 0,
    width: 1,
    height: 1,
    wrap: 0,
    uv_rows: OpacityMask::IDENTITY,
    cutoff: 0.5,
    factor: 1.0,
    reserved: [0; 2],
};

impl Lace {
    /// Every wrapping mode, several sizes, transforms and cutoffs; a third of the triangles has none.
    fn new(soup: Soup, seed: u32, reach: f32) -> Self {
        let mut numbers = Numbers(seed);
        let (mut masks, mut alpha) = (Vec::new(), vec![7; 5]);
        for (s, t) in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror]
            .into_iter()
            .flat_map(|s| [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror].map(|t| (s, t)))
        {
            let (width, height) = (pcg(masks.len() as u32) % 9 + 1, pcg(masks.len() as u32 + 99) % 9 + 1);
            let mut row = || [numbers.next() * 2.0, numbers.next() * 2.0, numbers.next(), 0.0];
            let uv_rows = [row(), row()];
            masks.push(OpacityMask {
                first_alpha: alpha.len() as u32,
                width,
                height,
                wrap: Wrap::word(s, t),
                uv_rows,
                cutoff: 0.5 + 0.2 * numbers.next(),
                factor: 0.9,
                reserved: [0; 2],
            });
            alpha.extend((0..width * height).map(|i| (pcg(seed ^ i) >> 24) as u8));
        }
        let count = soup.indices.len() as u32;
        let mask_of_triangle = (0..count)
            .map(|i| if i.is_multiple_of(3) { Opacity::NO_MASK } else { pcg(i) % masks.len() as u32 })
            .collect();
        let uv = (0..count).map(|_| [0; 3].map(|_| [numbers.next() * reach, numbers.next() * reach])).collect();
        Self { soup, mask_of_triangle, masks, uv, alpha }
    }

    /// Some triangles all hole, the others whole.
    fn of_holes(soup: Soup, is_hole: impl Fn(u32) -> bool) -> Self {
        let count = soup.indices.len() as u32;
        let mask = |i| if is_hole(i) { 0 } else { Opacity::NO_MASK };
        let mask_of_triangle = (0..count).map(mask).collect();
        Self { soup, mask_of_triangle, masks: vec![PLAIN], uv: vec![[[0.3; 2]; 3]; count as usize], alpha: vec![0] }
    }

    fn geometry(&self) -> Geometry<'_> {
        let opacity =
            Opacity { mask_of_triangle: &self.mask_of_triangle, masks: &self.masks, uv: &self.uv, alpha: &self.alpha };
        Geometry { opacity, ..self.soup.geometry() }
    }

    fn scene(&self) -> CpuScene {
        CpuScene::build(&self.geometry()).unwrap()
    }

    /// Whether a ray passes the point of a triangle, and whether that is clear of rounding.
    fn passes(&self, triangle: u32, u: f64, v: f64) -> (bool, bool) {
        let mask = self.mask_of_triangle[triangle as usize];
        if mask == Opacity::NO_MASK {
            return (false, true);
        }
        let mask = &self.masks[mask as usize];
        let [a, b, c] = self.uv[triangle as usize].map(|p| DVec2::new(p[0].into(), p[1].into()));
        let p = a * (1.0 - u - v) + b * u + c * v;
        let row = |r: [f32; 4]| f64::from(r[0]) * p.x + f64::from(r[1]) * p.y + f64::from(r[2]);
        let x = row(mask.uv_rows[0]) * f64::from(mask.width) - 0.5;
        let y = row(mask.uv_rows[1]) * f64::from(mask.height) - 0.5;
        let at = |i: f64, j: f64| {
            let i = wrapped(i as i64, mask.width.into(), mask.wrap & 3);
            let j = wrapped(j as i64, mask.height.into(), mask.wrap >> 2);
            f64::from(self.alpha[mask.first_alpha as usize + (j * i64::from(mask.width) + i) as usize]) / 255.0
        };
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let across = |j: f64| at(x.floor(), j) * (1.0 - fx) + at(x.floor() + 1.0, j) * fx;
        let value = (across(y.floor()) * (1.0 - fy) + across(y.floor() + 1.0) * fy) * f64::from(mask.factor);
        let cutoff = f64::from(mask.cutoff);
        (value < cutoff, (value - cutoff).abs() > 2e-3)
    }

    /// The first hit that is no hole, whether it lies behind holes, and whether rounding can change that.
    fn first_hit(&self, ray: &Ray) -> (Option<(f64, u32, u32)>, bool, bool) {
        let (hits, mut clear) = self.soup.every_hit(ray);
        let (mut first, mut behind): (Option<(f64, u32, u32)>, bool) = (None, false);
        for (t, instance, triangle) in hits {
            let (u, v) = self.weights(ray, instance, triangle);
            let (passes, sure) = self.passes(triangle, u, v);
            if let Some(first) = first {
                clear &= passes || t - first.0 > 1e-3 * t;
                break;
            }
            clear &= sure;
            behind |= passes;
            if !passes {
                first = Some((t, instance, triangle));
            }
        }
        (first, behind, clear)
    }

    fn weights(&self, ray: &Ray, instance: u32, triangle: u32) -> (f64, f64) {
        let [a, b, c] = self.soup.indices[triangle as usize].map(|i| {
            place(&self.soup.instances[instance as usize], Vec3::from(self.soup.positions[i as usize]).as_dvec3())
        });
        let (e1, e2): (DVec3, DVec3) = (b - a, c - a);
        let (d, s) = (ray.direction.as_dvec3(), ray.origin.as_dvec3() - a);
        let det = e1.dot(d.cross(e2));
        (s.dot(d.cross(e2)) / det, d.dot(s.cross(e1)) / det)
    }

    /// Compares with the model; returns how many clear rays passed holes, and how many met something.
    fn compare(&self, rays: &[Ray]) -> [u32; 2] {
        let scene = self.scene();
        let mut counts = [0; 2];
        for ray in rays {
            let hit = scene.closest(ray);
            assert_eq!(scene.occluded(ray), hit.is_some(), "{ray:?}");
            let (first, behind, clear) = self.first_hit(ray);
            if !clear {
                continue;
            }
            let found = hit.map(|hit| (hit.instance, hit.triangle));
            assert_eq!(found, first.map(|(_, i, t)| (i, t)), "{ray:?} {hit:?} {first:?}");
            counts[0] += u32::from(behind);
            counts[1] += u32::from(hit.is_some());
        }
        counts
    }
}

fn wrapped(i: i64, n: i64, wrap: u32) -> i64 {
    match wrap {
        1 => i.clamp(0, n - 1),
        2 => {
            let j = i.rem_euclid(2 * n);
            if j < n { j } else { 2 * n - 1 - j }
        }
        _ => i.rem_euclid(n),
    }
}

#[test]
fn what_is_met_is_what_the_model_meets() {
    let mut total = [0; 2];
    for (seed, scale) in [(1, 1e-4), (2, 1.0), (3, 1e7)] {
        for (count, size) in [(1, 1.0), (7, 0.7), (60, 0.5), (400, 0.2)] {
            let lace = Lace::new(soup(seed * 1_000_000, count, scale, size), seed, 3.0);
            let counts = lace.compare(&rays(seed * 77_777, scale, 300));
            total = [total[0] + counts[0], total[1] + counts[1]];
        }
    }
    assert!(total[0] > 200 && total[1] > 400, "{total:?}");
}

#[test]
fn placed_meshes_have_holes_too() {
    let mut soup = soup(5, 300, 1.0, 0.1);
    let mut numbers = Numbers(99);
    let instance = |_| {
        let mut instance = Instance::identity(0);
        for (axis, row) in instance.to_scene.iter_mut().enumerate() {
            *row = [numbers.next() * 0.3, numbers.next() * 0.3, numbers.next() * 0.3, numbers.next() * 6.0];
            row[axis] += 1.0;
        }
        instance
    };
    soup.instances = (0..250).map(instance).collect();
    let lace = Lace::new(soup, 4, 3.0);
    assert_eq!(lace.scene().stats().references, 250);
    let counts = lace.compare(&rays(7, 6.0, 300));
    assert!(counts[0] > 15 && counts[1] > 30, "{counts:?}");
}

/// All hits of both, bit by bit.
fn same(a: &CpuScene, b: &CpuScene, rays: &[Ray], rename: impl Fn(u32) -> u32) -> u32 {
    let mut met = 0;
    for ray in rays {
        let hit = a.closest(ray);
        let other = b.closest(ray).map(|hit| Hit { triangle: rename(hit.triangle), ..hit });
        assert_eq!(hit, other, "{ray:?}");
        assert_eq!(a.occluded(ray), b.occluded(ray), "{ray:?}");
        met += u32::from(hit.is_some());
    }
    met
}

#[test]
fn a_hole_is_as_if_the_triangle_were_not_there() {
    let whole = soup(11, 600, 1.0, 0.4);
    let kept: Vec<u32> = (0..600).filter(|i| pcg(*i).is_multiple_of(4)).collect();
    let corners = |i: &u32| whole.indices[*i as usize].map(|c| Vec3::from(whole.positions[c as usize]));
    let rest = Soup::new(&kept.iter().map(corners).collect::<Vec<_>>());
    let lace = Lace::of_holes(soup(11, 600, 1.0, 0.4), |i| !pcg(i).is_multiple_of(4));
    let rays = rays(12, 1.0, 2000);
    let met = same(&lace.scene(), &rest.scene(), &rays, |i| kept[i as usize]);
    assert!(met > 800, "{met}");
}

#[test]
fn a_mask_elsewhere_changes_no_bit() {
    // One triangle of 600 has a hole, behind everything: the code for masks runs, and finds the same.
    let solid = soup(21, 600, 1.0, 0.4);
    let mut lace = Lace::of_holes(soup(21, 600, 1.0, 0.4), |i| i == 600);
    lace.soup.positions.extend([[1e6, 1e6, 1e6], [1e6, 2e6, 1e6], [2e6, 1e6, 1e6]]);
    lace.soup.indices.push([1800, 1801, 1802]);
    lace.soup.meshes[0].triangle_count += 1;
    lace.mask_of_triangle.push(0);
    lace.uv.push([[0.0; 2]; 3]);
    assert!(lace.scene().stats().bytes > solid.scene().stats().bytes);
    let met = same(&lace.scene(), &solid.scene(), &rays(22, 1.0, 2000), |i| i);
    assert!(met > 1000, "{met}");
}

#[test]
fn masks_without_holes_take_nothing() {
    let solid = soup(31, 50, 1.0, 0.4);
    for (cutoff, factor, alpha) in [(0.0, 1.0, 0), (1.0, 1.0, 255), (0.5, 0.51, 255), (-1.0, -1.0, 255)] {
        let mut lace = Lace::of_holes(soup(31, 50, 1.0, 0.4), |_| true);
        lace.masks[0] = OpacityMask { cutoff, factor, ..PLAIN };
        lace.alpha = vec![alpha];
        assert_eq!(lace.scene().stats(), solid.scene().stats(), "cutoff {cutoff}, factor {factor}, alpha {alpha}");
    }
}

#[test]
fn masks_that_share_an_image_keep_their_own_holes() {
    // The second mask sees a value more than the first, the third has another cutoff: only the second has a hole.
    let mut lace = Lace::of_holes(soup(61, 600, 1.0, 0.4), |_| true);
    let kept: Vec<u32> = (0..600).filter(|i| i % 3 != 1).collect();
    let corners = |i: &u32| lace.soup.indices[*i as usize].map(|c| Vec3::from(lace.soup.positions[c as usize]));
    let rest = Soup::new(&kept.iter().map(corners).collect::<Vec<_>>());
    lace.mask_of_triangle = (0..600).map(|i| i % 3).collect();
    lace.masks = vec![PLAIN, OpacityMask { width: 2, ..PLAIN }, OpacityMask { width: 2, cutoff: 0.0, ..PLAIN }];
    lace.alpha = vec![255, 0];
    lace.uv.fill([[0.75, 0.5]; 3]);
    let met = same(&lace.scene(), &rest.scene(), &rays(62, 1.0, 1000), |i| kept[i as usize]);
    assert!(met > 400, "{met}");
}

#[test]
fn of_equal_triangles_the_first_without_a_hole_is_met() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for first in [1, 3, 50, 199] {
        let scene = Lace::of_holes(Soup::new(&[triangle; 200]), |i| i < first || (i - first) % 2 == 1).scene();
        let ray = Ray { origin: Vec3::new(0.2, 0.3, 1.0), t_min: 0.0, direction: Vec3::NEG_Z, t_max: 2.0 };
        assert_eq!(scene.closest(&ray).unwrap().triangle, first);
        assert!(scene.occluded(&ray) && !scene.occluded(&Ray { t_max: 1.0, ..ray }));
    }
}

#[test]
fn coordinates_far_out_are_answered_and_stay_answered() {
    for reach in [1e9, 1e30, f32::MAX] {
        let lace = Lace::new(soup(41, 200, 1.0, 0.5), 6, reach);
        let rays = rays(42, 1.0, 500);
        // Built twice: the same answers.
        assert!(same(&lace.scene(), &lace.scene(), &rays, |i| i) > 100);
    }
}

#[test]
fn masks_that_name_nothing_are_refused() {
    let good = || Lace::of_holes(soup(51, 3, 1.0, 0.5), |_| true);
    assert!(CpuScene::build(&good().geometry()).is_ok());
    let spoils: [fn(&mut Lace); 11] = [
        |l| l.mask_of_triangle[1] = 1,
        |l| l.mask_of_triangle.truncate(2),
        |l| l.uv.truncate(2),
        |l| l.alpha.clear(),
        |l| l.masks.clear(),
        |l| l.masks[0].first_alpha = u32::MAX,
        |l| l.masks[0].width = 0,
        |l| (l.masks[0].width, l.masks[0].height) = (u32::MAX, u32::MAX),
        |l| l.masks[0].cutoff = f32::NAN,
        |l| l.masks[0].uv_rows[1][2] = f32::INFINITY,
        |l| l.uv[2][1][0] = f32::NAN,
    ];
    for (number, spoil) in spoils.iter().enumerate() {
        let mut lace = good();
        spoil(&mut lace);
        let refused = CpuScene::build(&lace.geometry()).err();
        assert!(matches!(refused, Some(Error::BadRange { at: "opacity", .. })), "{number}: {refused:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_interval_is_open(seed in any::<u32>(), count in 1usize..60) {
        interval_is_open(&Lace::new(soup(seed, count, 1.0, 0.8), seed, 3.0).scene(), &rays(seed ^ 1, 1.0, 20));
    }
}
