use hashcache_core::float;
use proptest::prelude::*;

use crate::any_float;

proptest! {
    /// √ is correctly rounded, by the processor or in software.
    #[test]
    fn sqrt_is_the_nearest_float(x in any_float()) {
        let root = float::sqrt(x);
        if x < 0.0 || x.is_nan() {
            prop_assert!(root.is_nan());
        } else {
            prop_assert_eq!(root, f64::from(x).sqrt() as f32);
        }
    }

    #[test]
    fn rounding_brackets_the_number(x in -1e9_f32..1e9) {
        prop_assert!(float::floor(x) <= x && x - float::floor(x) < 1.0);
        prop_assert!(float::ceil(x) >= x && float::ceil(x) - x < 1.0);
        prop_assert_eq!(float::floor(x), -float::ceil(-x));
    }

    /// Within two units in the last place of the functions computed in f64.
    #[test]
    fn functions_are_accurate(x in -20.0_f32..20.0, u in -1.0_f32..1.0) {
        let near = |got: f32, exact: f64| (f64::from(got) - exact).abs() <= 2.4e-7 * exact.abs().max(1e-6);
        let (xd, ud) = (f64::from(x), f64::from(u));
        prop_assert!(near(float::sin(x), xd.sin()) && near(float::cos(x), xd.cos()));
        prop_assert_eq!(float::sin_cos(x), (float::sin(x), float::cos(x)));
        prop_assert!(near(float::exp(x), xd.exp()) && near(float::exp2(x), xd.exp2()));
        prop_assert!(near(float::acos(u), ud.acos()) && near(float::atan2(u, x), ud.atan2(xd)));
        let y = 1.5 + u;
        prop_assert!((f64::from(float::ln(y)) - f64::from(y).ln()).abs() <= 1.2e-7);
    }
}
