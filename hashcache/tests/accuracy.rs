//! What pictures know of their own errors, against pictures of many paths.

use hashcache::{Image, Preview, Rendered, Settings};

fn preview(scene: &str, set: &[(&str, &str)]) -> Preview {
    let mut settings = Settings::default();
    for (key, value) in [("size", "24x24"), ("octree.resolution", "32")].iter().chain(set) {
        settings.set(key, value).unwrap_or_else(|error| panic!("{error}"));
    }
    Preview::open(scene, &settings).unwrap_or_else(|error| panic!("{error}"))
}

fn render(scene: &str, set: &[(&str, &str)]) -> Rendered {
    preview(scene, set).render(&mut |_| ()).unwrap()
}

const PLAIN: [(&str, &str); 2] = [("cache", "none"), ("filter", "none")];

fn luminance(pixel: [f32; 3]) -> f64 {
    let [r, g, b] = pixel.map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn mean(image: &Image) -> f64 {
    image.pixels.iter().map(|&pixel| luminance(pixel)).sum::<f64>() / image.pixels.len() as f64
}

/// The share of seeds in which an interval holds the bias of the picture beside it: one that is half as wide fails.
#[test]
fn intervals_of_the_bias_cover_it() {
    const SEEDS: u32 = 40;
    // A seed of its own, so that the truth is independent of what is checked.
    let truth = mean(&render("builtin:cornell", &[&PLAIN[..], &[("spp", "4096"), ("seed", "1000000")]].concat()).image);
    let mut preview = preview("builtin:cornell", &[("check.fraction", "0.25")]);
    let (mut held, mut half) = (0, 0.0);
    for seed in 0..SEEDS {
        preview = preview.with_seed(seed);
        let Rendered { image, stats } = preview.render(&mut |_| ()).unwrap();
        let bias = stats.check.unwrap().bias.unwrap();
        let is = mean(&image) - truth;
        held += u32::from(bias.low <= is && is <= bias.high);
        half += 0.5 * (bias.high - bias.low) / truth / f64::from(SEEDS);
    }
    // 40 seeds at 95 %: fewer than 34 once in 400; at 67 %, as with half the width, 34 once in 80.
    assert!(held >= 34 && half < 0.1, "{held} of {SEEDS}, ±{half}");
}

/// A picture of many paths: nothing is wrong with it, and the check says so. A picture of blurred light: the check tells how
/// wrong it is.
#[test]
fn a_check_tells_what_is_wrong() {
    let set = [&PLAIN[..], &[("spp", "256"), ("check.fraction", "1"), ("check.spp", "64")]].concat();
    let right = render("builtin:cornell", &set).stats.check.unwrap();
    let bias = right.relative_bias.unwrap();
    assert!(bias.low < 0.0 && bias.high > 0.0 && bias.high - bias.low < 0.05, "{bias:?}");
    assert_eq!((right.pixels, right.samples_per_pixel), (24 * 24, 64));
    assert!(right.rays.closest > 24 * 24 * 64 && right.non_finite == 0);

    let set = [("octree.cell", "32"), ("spp", "16"), ("check.fraction", "1"), ("check.spp", "256")];
    let Rendered { image, stats } = render("builtin:cornell", &set);
    let truth = render("builtin:cornell", &[&PLAIN[..], &[("spp", "2048"), ("seed", "1")]].concat()).image;
    let errors = image.pixels.iter().zip(&truth.pixels).map(|(p, t)| (luminance(*p) - luminance(*t)).powi(2));
    let is = errors.sum::<f64>() / (24.0 * 24.0);
    let told = stats.check.unwrap().mse.unwrap();
    assert!((told.value / is - 1.0).abs() < 0.1 && told.low <= is && is <= told.high, "{told:?} for {is}");
}

/// Nothing of a check is in the picture, whatever its launcher; without one there is nothing of it anywhere.
#[test]
fn checks_change_no_bit_and_depend_on_no_thread() {
    let plain = render("builtin:cornell", &[]);
    assert!(plain.stats.check.is_none() && !plain.stats.plan.iter().any(|stage| stage.stage == "check"));
    assert!(plain.stats.saved.iter().any(|saving| saving.feature == "check" && saving.bytes == 24 * 24 * 96));
    let mut told = Vec::new();
    for launcher in [&[("cpu.launcher", "serial")][..], &[("threads", "2")], &[("threads", "3")]] {
        let Rendered { image, stats } = render("builtin:cornell", &[&[("check.fraction", "0.3")], launcher].concat());
        assert!(image == plain.image && stats.rays == plain.stats.rays);
        assert!(stats.plan.last().unwrap().stage == "check" && stats.time_s.stages.contains_key("check"));
        assert!(!stats.saved.iter().any(|saving| saving.feature == "check"));
        told.push(stats.check.unwrap());
    }
    assert!(told[0] == told[1] && told[1] == told[2]);
    assert!((100..250).contains(&told[0].pixels), "{}", told[0].pixels);
    let nobody = render("builtin:cornell", &[("check.fraction", "1e-9")]).stats.check.unwrap();
    assert!(nobody.pixels == 0 && nobody.bias.is_none() && nobody.mse.is_none());
}

/// Frames at rest add paths to the same pixels; pictures beside the picture show them.
#[test]
fn pictures_show_what_was_checked() {
    let preview = preview("builtin:cornell", &[("check.fraction", "0.5"), ("check.spp", "2")]);
    let mut backend = preview.backend().unwrap();
    let mut session = preview.session(&mut backend).unwrap();
    let mut widths = Vec::new();
    for frame in 1..=8 {
        let image = session.frame(preview.camera(), &mut |_| ()).unwrap().image;
        let check = session.stats().unwrap().check.unwrap();
        assert_eq!(check.samples_per_pixel, 2 * frame);
        assert!((check.mean_radiance / mean(&image) - 1.0).abs() < 1e-9);
        let mse = check.mse.unwrap();
        widths.push(mse.high - mse.low);
    }
    assert!(widths[7] < 0.5 * widths[0], "{widths:?}");
    let pixels = session.stats().unwrap().check.unwrap().pixels;
    let aovs = session.aovs().unwrap();
    let of = |name| &aovs.iter().find(|(known, _)| *known == name).unwrap().1.pixels;
    let traced = of("check_samples").iter().filter(|samples| (samples[0] - 16.0).abs() < 0.5).count();
    assert_eq!(traced as u64, pixels);
    assert!(of("check").iter().zip(of("check_samples")).all(|(d, n)| n[0] > 0.0 || d.iter().all(|x| x.to_bits() == 0)));
    assert!(of("stderr").iter().all(|error| error[0] >= 0.0));
}

/// A pixel's standard error, of path tracing, is the scatter of that pixel from seed to seed.
#[test]
fn standard_errors_are_the_scatter_of_pictures() {
    const SEEDS: u32 = 32;
    let mut preview = preview("builtin:cornell", &[&PLAIN[..], &[("spp", "16"), ("path.moments", "on")]].concat());
    let (mut squares, mut told) = (0.0, 0.0);
    let mut images = Vec::new();
    for seed in 0..SEEDS {
        preview = preview.with_seed(seed);
        let Rendered { image, stats } = preview.render(&mut |_| ()).unwrap();
        let stderr = stats.stderr.unwrap();
        assert_eq!((stderr.pixels, stderr.unknown), (24 * 24, 0));
        told += stderr.rms.powi(2) / f64::from(SEEDS);
        images.push(image);
    }
    for i in 0..24 * 24 {
        let of = |image: &Image| luminance(image.pixels[i]);
        let mean = images.iter().map(of).sum::<f64>() / f64::from(SEEDS);
        squares += images.iter().map(|image| (of(image) - mean).powi(2)).sum::<f64>() / f64::from(SEEDS - 1);
    }
    let ratio = (told / (squares / (24.0 * 24.0))).sqrt();
    // Stratified samples scatter less than the independent ones that they are taken for.
    assert!((0.9..3.0).contains(&ratio), "{ratio}");
}

#[test]
fn moments_change_no_bit_and_go_with_whole_paths_only() {
    let plain = render("builtin:cornell", &PLAIN);
    let with = render("builtin:cornell", &[&PLAIN[..], &[("path.moments", "on")]].concat());
    assert!(plain.image == with.image && plain.stats.stderr.is_none() && with.stats.stderr.is_some());
    assert!(render("builtin:cornell", &[]).stats.stderr.unwrap().relative.unwrap() < 1.0);
    for set in [&[][..], &[("cache", "none")]] {
        let mut settings = Settings::default();
        for (key, value) in set.iter().chain(&[("path.moments", "on")]) {
            settings.set(key, value).unwrap();
        }
        assert!(settings.validate().unwrap_err().to_string().contains("path.moments=on does not go with"));
    }
    assert!(
        Settings::default().set("check.spp", "3").is_err() && Settings::default().set("check.fraction", "NaN").is_err()
    );
}
