//! Frames of a session: what they share, and what they must not.

use hashcache::{Image, Preview, Settings};

/// Side of the pictures: enough cells for means, few enough pixels for a fast test.
const SIZE: &str = "48x48";

fn preview(scene: &str, set: &[(&str, &str)]) -> Preview {
    let mut settings = Settings::default();
    settings.set("size", SIZE).unwrap();
    for (key, value) in set {
        settings.set(key, value).unwrap();
    }
    Preview::open(scene, &settings).unwrap()
}

fn mean(image: &Image) -> f64 {
    let sum: f64 = image.pixels.iter().flatten().map(|&x| f64::from(x)).sum();
    sum / (3 * image.pixels.len()) as f64
}

fn relmse(image: &Image, reference: &Image) -> f64 {
    let pairs = image.pixels.iter().flatten().zip(reference.pixels.iter().flatten());
    let errors = pairs.map(|(&i, &r)| (f64::from(i) - f64::from(r)).powi(2) / (f64::from(r).powi(2) + 0.01));
    errors.sum::<f64>() / (3 * image.pixels.len()) as f64
}

/// Pictures of `frames` frames at rest.
fn frames(preview: &Preview, frames: u32) -> Vec<Image> {
    let mut backend = preview.backend().unwrap();
    let mut session = preview.session(&mut backend).unwrap();
    (0..frames).map(|_| session.frame(preview.camera(), &mut |_| ()).unwrap().image).collect()
}

#[test]
fn every_cache_and_filter_keeps_the_energy_of_path_tracing() {
    let reference = preview("builtin:cornell", &[("cache", "none"), ("filter", "none"), ("spp", "256")]);
    let reference = reference.render(&mut |_| ()).unwrap().image;
    for cache in ["octree", "grid", "none"] {
        for filter in ["layered", "screen", "none"] {
            for direct in ["cached", "traced"] {
                if cache == "none" && direct == "traced" {
                    continue;
                }
                let set = [("cache", cache), ("filter", filter), ("cache.direct", direct), ("spp", "16")];
                let image = preview("builtin:cornell", &set).render(&mut |_| ()).unwrap().image;
                let ratio = mean(&image) / mean(&reference);
                // 16·2,304 paths know the mean to about 0.6 %; cells at the lamp and the box's open front add bias.
                assert!((ratio - 1.0).abs() < 0.03, "{cache} {filter} {direct}: energy {ratio}");
                let error = relmse(&image, &reference);
                assert!(error < 0.05, "{cache} {filter} {direct}: relMSE {error}");
            }
        }
    }
}

#[test]
fn resting_frames_converge() {
    let reference = preview("builtin:cornell", &[("cache", "none"), ("filter", "none"), ("spp", "256")]);
    let reference = reference.render(&mut |_| ()).unwrap().image;
    for cache in ["octree", "grid"] {
        let images = frames(&preview("builtin:cornell", &[("cache", cache)]), 12);
        let (first, last) = (relmse(&images[0], &reference), relmse(&images[11], &reference));
        // What cells of two footprints blur stays: at this size half of the first frame's error.
        assert!(last < 0.65 * first, "{cache}: {first} → {last}");
    }
}

#[test]
fn a_stored_path_of_any_length_gives_the_same_mean() {
    let means: Vec<f64> = ["1", "3", "5", "8"]
        .iter()
        .map(|store| {
            let set = [("cache.store", *store), ("spp", "16"), ("cache.crf", "1")];
            mean(&preview("builtin:furnace", &set).render(&mut |_| ()).unwrap().image)
        })
        .collect();
    for mean in &means {
        assert!((mean / means[0] - 1.0).abs() < 0.02, "{means:?}");
    }
}

#[test]
fn light_that_changes_leaves_no_ghost() {
    for cache in ["octree", "grid"] {
        let preview = preview("builtin:cornell", &[("cache", cache)]);
        let mut backend = preview.backend().unwrap();
        let mut session = preview.session(&mut backend).unwrap();
        let mut shown = |factor| {
            session.scale_light(factor).unwrap();
            mean(&session.frame(preview.camera(), &mut |_| ()).unwrap().image)
        };
        let bright = shown(1.0);
        assert_eq!(shown(0.0).to_bits(), 0, "{cache}: old light shows in the dark");
        let half = shown(0.5);
        assert!((half / bright - 0.5).abs() < 0.05, "{cache}: {half} is not half of {bright}");
        assert!(session.scale_light(f32::NAN).is_err() && session.scale_light(-1.0).is_err());
    }
}

#[test]
fn light_that_changes_fades_where_cells_keep_a_history() {
    let means = |history| {
        let preview = preview("builtin:cornell", &[("cache", "grid"), ("filter", "none"), ("grid.history", history)]);
        let mut backend = preview.backend().unwrap();
        let mut session = preview.session(&mut backend).unwrap();
        let lights = [[1.0; 4], [0.0; 4]].concat();
        let shown = lights.into_iter().map(|factor| {
            session.scale_light(factor).unwrap();
            mean(&session.frame(preview.camera(), &mut |_| ()).unwrap().image)
        });
        shown.collect::<Vec<_>>()
    };
    // Kept longer, old light is brighter; and it goes.
    let (short, long) = (means("20"), means("2000"));
    assert!(long[4] > short[4] && short[4] > 0.0, "{short:?} {long:?}");
    assert!(short[4..].windows(2).all(|pair| pair[1] < 0.9 * pair[0]), "{short:?}");
    assert!(means("0")[4..].iter().all(|mean| *mean == 0.0));
}

#[test]
fn a_moved_camera_shows_its_own_view_with_the_cache_of_the_old_one() {
    let preview = preview("builtin:cornell", &[]);
    let mut backend = preview.backend().unwrap();
    let mut session = preview.session(&mut backend).unwrap();
    let still = *preview.camera();
    let mut aside = still;
    aside.position += aside.right * 0.05;
    let alone = session.frame(&still, &mut |_| ()).unwrap().image;
    for _ in 0..8 {
        session.frame(&aside, &mut |_| ()).unwrap();
    }
    let after = session.frame(&still, &mut |_| ()).unwrap().image;
    let reference = frames(&preview, 40).pop().unwrap();
    assert!(relmse(&after, &reference) < 0.7 * relmse(&alone, &reference), "nothing was learnt from the other view");
    let mut small = still;
    small.width = 8;
    assert!(session.frame(&small, &mut |_| ()).is_err(), "a camera for another picture");
}

#[test]
fn threads_do_not_change_a_bit() {
    for set in [&[("cache", "octree")][..], &[("cache", "grid"), ("cache.direct", "traced"), ("cache.store", "3")]] {
        let of = |launcher: &[(&str, &str)]| frames(&preview("builtin:cornell", &[set, launcher].concat()), 3);
        let serial = of(&[("cpu.launcher", "serial")]);
        assert!(of(&[("threads", "2")]) == serial, "{set:?}");
        assert!(of(&[("threads", "3")]) == serial, "{set:?}");
    }
}
