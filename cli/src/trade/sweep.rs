//! Which settings are tried: the values of each axis, and all combinations that make sense.

use std::collections::HashSet;

use hashcache::choice::{CacheKind, Choice, DirectLight, FilterKind};
use hashcache::{Settings, SettingsError};
use serde_json::Value;

use crate::args::Given;
use crate::failure::Failure;

/// A setting and the values it takes in turn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    pub key: String,
    pub values: Vec<String>,
}

/// Settings to be tried.
#[derive(Clone, Debug)]
pub struct Trial {
    pub settings: Settings,
    /// The value on each axis; `None` where it has no effect.
    pub values: Vec<Option<String>>,
}

/// All settings to be tried, those with few samples first.
#[derive(Debug)]
pub struct Sweep {
    pub axes: Vec<Axis>,
    pub trials: Vec<Trial>,
    /// What is common to all.
    pub base: Settings,
}

/// The usual axes, apart from caches, filters and direct light, of which every value is tried. What the library does not
/// know is left out. Cells and resolutions span the range in which noise and blur change places on the test scenes.
const USUAL: [(&str, &[&str]); 3] = [
    ("grid.cell", &["6", "12", "24", "48"]),
    ("octree.resolution", &["auto", "256", "512", "1024", "2048"]),
    ("spp", &["1", "4", "16", "64"]),
];

/// Settings that decide what the picture shows. With another value the reference would not be one.
const OF_THE_PICTURE: [&str; 5] = ["size", "camera", "env", "env_scale", "max_bounces"];

impl Sweep {
    /// The combinations of what `--vary` lists, else of the usual axes that no option fixes.
    pub fn new(given: &Given, vary: &[String]) -> Result<Self, Failure> {
        let axes = if vary.is_empty() { usual(given) } else { asked_for(given, vary)? };
        let trials = combinations(&given.settings, &axes);
        if trials.is_empty() {
            // All of them conflict, so the first tells why.
            let mut first = given.settings.clone();
            apply(&mut first, &axes, &vec![0; axes.len()]);
            let why = first.validate().err().map_or("no settings are left".to_owned(), |error| error.to_string());
            return Err(Failure::usage(format!("nothing to sweep: {why}")));
        }
        Ok(Self { axes, trials, base: given.settings.clone() })
    }
}

/// The usual axes, without those that are fixed or have one value only.
fn usual(given: &Given) -> Vec<Axis> {
    let known = Settings::keys();
    let choices =
        [("cache", CacheKind::names()), ("filter", FilterKind::names()), ("cache.direct", DirectLight::names())];
    let lists = choices.into_iter().chain(USUAL.iter().map(|(key, values)| (*key, values.to_vec())));
    let axes = lists.filter(|(key, _)| known.contains(key) && !given.keys.iter().any(|fixed| fixed == key));
    let possible = |key: &str, value: &str| Settings::default().set(key, value).is_ok();
    let axes = axes.map(|(key, values)| Axis {
        key: key.to_owned(),
        values: values.into_iter().filter(|value| possible(key, value)).map(str::to_owned).collect(),
    });
    axes.filter(|axis| axis.values.len() > 1).collect()
}

/// The axes that the user lists.
fn asked_for(given: &Given, vary: &[String]) -> Result<Vec<Axis>, Failure> {
    let mut axes: Vec<Axis> = Vec::new();
    for text in vary {
        let refused = |why: &str| Err(Failure::usage(format!("--vary {text}: {why}")));
        let Some((key, values)) = text.split_once('=') else {
            return refused("KEY=V1,V2,... expected, as in --vary spp=1,4,16");
        };
        if OF_THE_PICTURE.contains(&key) {
            return refused(
                "changes the picture itself, so that no one reference fits; use --set and a folder for each",
            );
        }
        if key == "seed" {
            return refused("a row is a mean over seeds; use --seeds");
        }
        if given.keys.iter().any(|fixed| fixed == key) || axes.iter().any(|axis| axis.key == key) {
            return refused(&format!("{key} is given twice; leave one out"));
        }
        let values: Vec<String> = values.split(',').map(str::to_owned).collect();
        for value in &values {
            let tried = Settings::default().set(key, value);
            tried.map_err(|error: SettingsError| Failure::usage(format!("--vary {error}")))?;
        }
        axes.push(Axis { key: key.to_owned(), values });
    }
    Ok(axes)
}

/// All combinations that are valid and differ, few samples first and else in the axes' order.
fn combinations(base: &Settings, axes: &[Axis]) -> Vec<Trial> {
    let mut seen = HashSet::new();
    let mut trials = Vec::new();
    let mut index = vec![0; axes.len()];
    loop {
        let mut settings = base.clone();
        let values = apply(&mut settings, axes, &index);
        if settings.validate().is_ok() && seen.insert(values.clone()) {
            trials.push(Trial { settings, values });
        }
        // The last axis turns fastest.
        let Some(turned) = (0..axes.len()).rev().find(|&i| index[i] + 1 < axes[i].values.len()) else { break };
        index[turned] += 1;
        index[turned + 1..].fill(0);
    }
    trials.sort_by_key(|trial| trial.settings.spp);
    trials
}

/// Sets each axis to one of its values where that has an effect.
fn apply(settings: &mut Settings, axes: &[Axis], index: &[usize]) -> Vec<Option<String>> {
    let mut values = vec![None; axes.len()];
    // What decides whether others have an effect comes first.
    let rank = |key: &str| if key.starts_with("cache.") { 1 } else { 2 * usize::from(key.contains('.')) };
    for turn in 0..3 {
        for ((axis, &i), value) in axes.iter().zip(index).zip(&mut values) {
            let takes_part = rank(&axis.key) == turn && has_effect(&axis.key, settings);
            // The value was tried when the axis was made.
            if takes_part && settings.set(&axis.key, &axis.values[i]).is_ok() {
                *value = Some(axis.values[i].clone());
            }
        }
    }
    values
}

/// Whether a setting changes anything: those of a cache or filter do for that one alone.
fn has_effect(key: &str, settings: &Settings) -> bool {
    let Some((part, _)) = key.split_once('.') else { return true };
    match part {
        "cache" => settings.cache != CacheKind::None,
        "filter" => settings.filter != FilterKind::None,
        "direct" => settings.cache != CacheKind::None && settings.direct == DirectLight::Traced,
        part if CacheKind::names().contains(&part) => settings.cache.name() == part,
        part if FilterKind::names().contains(&part) => settings.filter.name() == part,
        _ => true,
    }
}

/// The settings that are not at their default, as `--set` takes them. The seed, which is no trait of a row, is left out.
pub fn describe(settings: &Settings) -> String {
    let default = Settings::default().to_json();
    let differs =
        settings.to_json().into_iter().filter(|(key, value)| key != "seed" && default.get(key) != Some(value));
    let pairs = differs.map(|(key, value)| match &value {
        Value::String(text) => format!("{key}={text}"),
        // Settings are f32; as f64 they would show digits that they do not have.
        Value::Number(number) if number.is_f64() => format!("{key}={}", number.as_f64().unwrap_or_default() as f32),
        value => format!("{key}={value}"),
    });
    pairs.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(pairs: &[(&str, &str)]) -> Given {
        let mut settings = Settings::default();
        for (key, value) in pairs {
            settings.set(key, value).unwrap();
        }
        Given { settings, keys: pairs.iter().map(|(key, _)| (*key).to_owned()).collect() }
    }

    fn sweep(pairs: &[(&str, &str)], vary: &[&str]) -> Sweep {
        let vary: Vec<_> = vary.iter().map(|&text| text.to_owned()).collect();
        Sweep::new(&given(pairs), &vary).unwrap()
    }

    #[test]
    fn a_caches_settings_are_varied_for_it_alone() {
        let sweep = sweep(&[], &["cache=grid,none", "grid.cell=8,16", "cache.direct=cached,traced", "spp=2,1"]);
        // Two cells × two sources of direct light with the grid, one without, by two numbers of samples.
        assert_eq!(sweep.trials.len(), (2 * 2 + 1) * 2);
        let none: Vec<_> = sweep.trials.iter().filter(|trial| trial.settings.cache == CacheKind::None).collect();
        assert!(none.iter().all(|trial| trial.values[1..3] == [None, None]));
        let spp: Vec<_> = sweep.trials.iter().map(|trial| trial.settings.spp).collect();
        assert!(spp.is_sorted() && spp[0] == 1, "few samples first");
        let different: HashSet<_> = sweep.trials.iter().map(|trial| describe(&trial.settings)).collect();
        assert_eq!(different.len(), sweep.trials.len());
    }

    #[test]
    fn the_usual_sweep_has_all_choices_and_keeps_what_is_fixed() {
        let all = sweep(&[], &[]);
        for cache in CacheKind::names() {
            assert!(all.trials.iter().any(|trial| trial.settings.cache.name() == cache), "{cache}");
        }
        for filter in FilterKind::names() {
            assert!(all.trials.iter().any(|trial| trial.settings.filter.name() == filter), "{filter}");
        }
        let one = sweep(&[("spp", "3"), ("cache", "grid")], &[]);
        assert!(one.trials.iter().all(|trial| trial.settings.spp == 3 && trial.settings.cache == CacheKind::Grid));
        assert!(one.axes.iter().all(|axis| axis.key != "spp" && axis.key != "cache"));
    }

    #[test]
    fn what_cannot_be_swept_is_refused() {
        let refused = |pairs: &[(&str, &str)], vary: &[&str]| {
            let vary: Vec<_> = vary.iter().map(|&text| text.to_owned()).collect();
            let failure = Sweep::new(&given(pairs), &vary).unwrap_err();
            assert_eq!(failure.status, 2);
            failure.to_string()
        };
        assert!(refused(&[], &["spp"]).contains("KEY="));
        assert!(refused(&[], &["spp="]).contains("spp="));
        assert!(refused(&[], &["spp=1,,2"]).contains("spp="));
        assert!(refused(&[], &["sbb=1"]).contains("sbb"));
        assert!(refused(&[], &["spp=1", "spp=2"]).contains("twice"));
        assert!(refused(&[("spp", "1")], &["spp=2"]).contains("twice"));
        assert!(refused(&[], &["max_bounces=1,2"]).contains("picture"));
        assert!(refused(&[], &["seed=1,2"]).contains("--seeds"));
        assert!(
            refused(&[("cache", "none")], &["cache.direct=traced", "threads=2", "cpu.launcher=serial"])
                .contains("serial")
        );
    }
}
