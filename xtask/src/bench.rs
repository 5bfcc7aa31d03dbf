//! `cargo xtask bench`: criterion's figures as ratios to the baseline of the same run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::step::{self, Step};

/// Packages that have benchmarks.
const PACKAGES: [&str; 5] = [
    "hashcache-core",
    "hashcache-hashgrid",
    "hashcache-layered-filter",
    "hashcache-backend-cpu",
    "hashcache-pt-integrator",
];

/// Runs the benchmarks and prints ratios.
pub fn steps(package: Option<&str>, filter: Option<&str>) -> Vec<Step> {
    let mut steps: Vec<Step> = PACKAGES
        .iter()
        .filter(|name| package.is_none_or(|wanted| wanted == **name))
        .map(|name| {
            let mut arguments = vec!["bench", "-p", name, "--all-features"];
            if let Some(filter) = filter {
                arguments.extend(["--", filter]);
            }
            Step::cargo(&arguments, "A benchmark failed.")
        })
        .collect();
    steps.push(Step::new("ratios", "Run the benchmarks first.", || {
        let mut found = BTreeMap::new();
        collect(&step::target().join("criterion"), &mut found)?;
        for line in ratios(&found) {
            println!("{line}");
        }
        Ok(())
    }));
    steps
}

/// Reads `new/benchmark.json` and `new/estimates.json` of every benchmark below `folder`: full id → nanoseconds.
fn collect(folder: &Path, found: &mut BTreeMap<String, f64>) -> Result<(), String> {
    let entries = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for entry in entries.flatten().filter(|entry| entry.path().is_dir()) {
        let path = entry.path();
        if entry.file_name() != "new" {
            collect(&path, found)?;
            continue;
        }
        let read = |name: &str| -> Result<Value, String> {
            let file = path.join(name);
            let text = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
            serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))
        };
        let (id, estimates) = (read("benchmark.json")?, read("estimates.json")?);
        if let (Some(id), Some(time)) = (id["full_id"].as_str(), estimates["median"]["point_estimate"].as_f64()) {
            found.insert(id.to_owned(), time);
        }
    }
    Ok(())
}

/// One line a benchmark. Its baseline is the entry of the same group and case whose function is called
/// `baseline…`: `group/baseline…/case` for `group/function/case`.
fn ratios(found: &BTreeMap<String, f64>) -> Vec<String> {
    let split = |id: &str| -> (String, String, String) {
        let mut parts: Vec<&str> = id.split('/').collect();
        let function = parts.iter().position(|part| part.starts_with("baseline")).unwrap_or(parts.len().min(3) - 1);
        let name = parts.remove(function);
        (parts[..function].join("/"), name.to_owned(), parts[function..].join("/"))
    };
    let mut lines = Vec::new();
    for (id, time) in found {
        let (group, function, case) = split(id);
        let rates: Vec<String> = found
            .iter()
            .filter(|(other, _)| {
                let (other_group, other_function, other_case) = split(other);
                other_function.starts_with("baseline")
                    && !function.starts_with("baseline")
                    && other_group == group
                    && other_case == case
            })
            .map(|(other, baseline)| format!("{:.2}× {}", baseline / time, split(other).1))
            .collect();
        lines.push(format!("{id:<64} {time:>14.1} ns  {}", rates.join(", ")));
    }
    lines
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::ratios;

    #[test]
    fn a_ratio_is_taken_to_the_baseline_of_the_same_group_and_case() {
        let found = BTreeMap::from([
            ("grid/lookup/baseline_raw/1M".to_owned(), 10.0),
            ("grid/lookup/batched/1M".to_owned(), 20.0),
            ("grid/lookup/batched/4M".to_owned(), 20.0),
        ]);
        let lines = ratios(&found);
        assert!(lines[1].ends_with("0.50× baseline_raw"), "{}", lines[1]);
        assert!(lines[2].ends_with("ns  "), "{}", lines[2]);
    }
}
