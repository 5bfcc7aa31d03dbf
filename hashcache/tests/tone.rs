//! From radiance to bytes.

use hashcache::choice::ToneCurve;
use hashcache::image_file::{self, Image};
use hashcache::{ToneMapping, srgb_decode};

const CURVES: [ToneCurve; 2] = [ToneCurve::Srgb, ToneCurve::Filmic];

#[test]
fn bytes_come_back_as_they_were() {
    for byte in 0..=255 {
        assert_eq!(ToneMapping::default().byte(srgb_decode(f32::from(byte) / 255.0)), byte);
    }
}

#[test]
fn a_stop_doubles_radiance() {
    for curve in CURVES {
        let at = |exposure| ToneMapping { exposure, curve };
        for radiance in [1e-12, 1e-3, 0.18, 0.5, 1.0, 3.0] {
            assert_eq!(at(1.0).encode(radiance).to_bits(), at(0.0).encode(2.0 * radiance).to_bits());
            assert_eq!(at(-3.0).encode(8.0 * radiance).to_bits(), at(0.0).encode(radiance).to_bits());
        }
    }
}

#[test]
fn any_radiance_is_encoded_in_order() {
    let radiances = [f32::NEG_INFINITY, -1.0, 0.0, 1e-12, 1e-5, 0.18, 1.0, 7.0, 7.5, 16.0, 17.0, 1e12, f32::MAX];
    for curve in CURVES {
        for exposure in [-100.0, -1.0, 0.0, 0.5, 100.0] {
            let tone = ToneMapping { exposure, curve };
            let encoded = radiances.map(|x| tone.encode(x));
            assert!(encoded.iter().all(|x| (0.0..=1.0).contains(x)), "{tone:?}: {encoded:?}");
            assert!(encoded.windows(2).all(|pair| pair[0] <= pair[1]), "{tone:?}: {encoded:?}");
            assert_eq!(tone.byte(f32::INFINITY), 255, "{tone:?}");
            assert_eq!(tone.byte(f32::NAN), 0, "{tone:?}");
        }
    }
}

#[test]
fn the_filmic_curve_is_the_published_one() {
    // x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), by hand.
    let tone = ToneMapping { exposure: 0.0, curve: ToneCurve::Filmic };
    for (radiance, response) in [(0.18, 0.266_899), (1.0, 0.803_797), (4.0, 0.973_417)] {
        assert!((srgb_decode(tone.encode(radiance)) - response).abs() < 1e-5, "{radiance}");
    }
    // It reaches 1 at (7 + √56)/2 = 7.24.
    let white = tone.encode(9.0);
    assert!(tone.encode(7.23) < white && tone.encode(7.25).to_bits() == white.to_bits());
}

#[test]
fn files_of_radiance_do_not_depend_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let image = Image { width: 2, height: 1, pixels: vec![[0.1, 1.0, 30.0], [0.0, 2.5, 7.0]] };
    let tone = ToneMapping { exposure: 2.0, curve: ToneCurve::Filmic };
    for (name, same) in [("a.exr", true), ("a.hdr", true), ("a.png", false)] {
        let file = folder.path().join(name);
        image_file::write(&file, &image).unwrap();
        let plain = std::fs::read(&file).unwrap();
        image_file::write_toned(&file, &image, tone).unwrap();
        assert_eq!(std::fs::read(&file).unwrap() == plain, same, "{name}");
    }
}
