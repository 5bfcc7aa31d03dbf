//! Settings that are accepted work, and those that would not are refused at once.

use hashcache::{Preview, Settings};

/// A frame of an octree's light, of traced direct light and of layers.
fn render(set: &[(&str, &str)]) -> Result<(), hashcache::Error> {
    let mut settings = Settings::default();
    for (key, value) in [("size", "8x6"), ("octree.resolution", "16")].iter().chain(set) {
        settings.set(key, value)?;
    }
    for cache in ["octree", "grid"] {
        settings.set("cache", cache)?;
        Preview::open("builtin:cornell", &settings)?.render(&mut |_| ())?;
    }
    Ok(())
}

#[test]
fn numbers_at_the_ends_of_their_ranges_render() {
    for (key, least, most) in [
        ("filter.layers", "1", "8"),
        ("filter.passes", "1", "8"),
        ("filter.radius", "1", "256"),
        ("filter.samples", "0", "1e9"),
        ("filter.wide_radius", "1", "256"),
        ("filter.wide_samples", "0", "1e9"),
        ("filter.significance", "0.001", "1e6"),
        ("filter.direct_radius", "1", "256"),
        ("filter.luminance", "0.001", "1e6"),
        ("filter.normal", "0", "10"),
        ("filter.path", "0", "1e9"),
        ("filter.segment", "0", "1e9"),
        ("filter.plane", "0.01", "1e4"),
        ("filter.color", "0", "1e6"),
        ("octree.cell", "0.01", "10000"),
        ("octree.jitter", "0", "2"),
        ("octree.min_samples", "0", "16777216"),
        ("octree.shrinkage", "0", "65536"),
        ("octree.max_climb", "0", "31"),
        ("grid.cell", "0.01", "10000"),
        ("grid.jitter", "0", "1"),
        ("grid.normal_bins", "1", "15"),
        ("grid.slots", "64", "4096"),
        ("grid.max_probes", "1", "64"),
        ("cache.store", "1", "8"),
        ("cache.crf", "0.05", "8"),
        ("direct.samples", "1", "256"),
        ("direct.candidates", "1", "64"),
        ("direct.scattered", "0", "64"),
        ("image.exposure", "-100", "100"),
    ] {
        for value in [least, most] {
            render(&[(key, value), ("cache.direct", "traced")]).unwrap_or_else(|e| panic!("{key}={value}: {e}"));
        }
    }
}

#[test]
fn what_has_no_meaning_between_off_and_its_least_is_refused() {
    for (key, least, below) in
        [("filter.wide_radius", "1", "0.5"), ("filter.luminance", "0.001", "0.0009"), ("filter.plane", "0.01", "0.009")]
    {
        render(&[(key, "0")]).unwrap_or_else(|error| panic!("{key}=0: {error}"));
        for value in [below, "-1", "NaN", "1e7"] {
            let told = Settings::default().set(key, value).unwrap_err().to_string();
            assert!(told.contains(&format!("0 (off) or a number from {least} to")), "{told}");
        }
    }
}

/// The plan names the wide pass where the filter has one, and nowhere else.
#[test]
fn plans_name_the_wide_pass() {
    for (set, has) in [
        (&[][..], true),
        (&[("filter", "screen")], true),
        (&[("filter.wide_radius", "0")], false),
        (&[("filter.denoiser", "a-trous")], false),
        (&[("cache", "grid")], false),
        (&[("cache", "none")], false),
        (&[("filter", "none")], false),
    ] {
        let mut settings = Settings::default();
        for (key, value) in set {
            settings.set(key, value).unwrap();
        }
        let plan = Preview::open("builtin:cornell", &settings).unwrap().plan().to_string();
        assert_eq!(plan.contains("after a wide one of up to 24 pixels"), has, "{set:?}:\n{plan}");
    }
}

/// Batches that do not hold the whole picture begin where bindings may.
#[test]
fn pictures_of_several_batches_render() {
    // 2¹⁹ records of three a path: two batches.
    let set = [("size", "512x344"), ("cache.store", "3"), ("needs.force", "layers"), ("filter", "screen")];
    let mut settings = Settings::default();
    for (key, value) in set.iter().chain(&[("filter.wide_radius", "0"), ("octree.resolution", "16")]) {
        settings.set(key, value).unwrap();
    }
    Preview::open("builtin:cornell", &settings).unwrap().render(&mut |_| ()).unwrap();
}

/// A number as the documentation writes it.
fn written(number: &str) -> String {
    let number = number.strip_suffix(".0").unwrap_or(number);
    let number = match number {
        "1000000" => "10⁶",
        "1000000000" => "10⁹",
        "1000000000000" => "10¹²",
        other => other,
    };
    number.replace('-', "−")
}

/// Each setting's documentation tells its range and its default.
#[test]
fn ranges_and_defaults_are_documented() {
    let source = include_str!("../src/settings/mod.rs");
    let defaults = Settings::default().to_json();
    for key in Settings::keys() {
        let start = format!("    /// `{key}`: ");
        assert_eq!(source.matches(&start).count(), 1, "{key} is documented once");
        let lines = source[source.find(&start).unwrap()..].lines();
        let doc: Vec<_> = lines.map_while(|line| line.trim().strip_prefix("/// ")).collect();
        let doc = doc.join(" ");
        let mut settings = Settings::default();
        let told = settings.set(key, "?").err().map(|error| error.to_string());
        let range = told.as_deref().and_then(|told| told.rsplit_once("from ")?.1.split_once(" to "));
        if let Some((least, most)) = range {
            let range = format!("{} to {}", written(least), written(most));
            assert!(doc.contains(&range), "{key} takes {range}: {doc}");
        }
        let default = match &defaults[key] {
            serde_json::Value::Null => continue,
            serde_json::Value::String(name) => format!("`{name}`"),
            number => written(&number.to_string()),
        };
        let [alone, first] = ["by", "By"].map(|by| format!("{by} default {default}"));
        let ends =
            |text: &str| doc.find(text).is_some_and(|at| !doc[at + text.len()..].starts_with(char::is_alphanumeric));
        assert!(ends(&alone) || ends(&first), "{key} is {default} by default: {doc}");
    }
}
