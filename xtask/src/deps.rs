//! `cargo xtask deps`: the arrows between the workspace's crates.

use std::process::Command;

use serde_json::Value;

use crate::step::{self, Step};

/// Each crate and the crates of ours it may depend on, as ARCHITECTURE.md draws them. `dev/*` may use anything.
const ARROWS: [(&str, &[&str]); 12] = [
    ("hashcache-backend-api", &[]),
    ("hashcache-core", &["hashcache-backend-api"]),
    ("hashcache-hashgrid", &["hashcache-core", "hashcache-backend-api"]),
    ("hashcache-layered-filter", &["hashcache-core", "hashcache-backend-api"]),
    ("hashcache-pt-integrator", &["hashcache-core", "hashcache-backend-api"]),
    ("hashcache-scene", &["hashcache-core", "hashcache-pt-integrator"]),
    ("hashcache-image-metrics", &[]),
    ("hashcache-backend-cpu", &["hashcache-backend-api", "hashcache-core"]),
    ("hashcache-backend-wgpu", &["hashcache-backend-api", "hashcache-core"]),
    (
        "hashcache",
        &[
            "hashcache-core",
            "hashcache-hashgrid",
            "hashcache-layered-filter",
            "hashcache-pt-integrator",
            "hashcache-scene",
            "hashcache-backend-api",
            "hashcache-backend-cpu",
        ],
    ),
    ("hashcache-cli", &["hashcache", "hashcache-image-metrics"]),
    ("xtask", &[]),
];

/// Reads cargo's metadata and fails on an arrow that is not permitted.
pub fn steps() -> Vec<Step> {
    vec![Step::new("compare the crates' dependencies with the permitted arrows", "See ARCHITECTURE.md.", || {
        let text = step::output(
            Command::new(step::cargo())
                .args(["metadata", "--format-version", "1", "--no-deps"])
                .current_dir(step::root()),
        )?;
        let metadata: Value = serde_json::from_str(&text).map_err(|error| format!("cargo metadata: {error}"))?;
        let wrong = forbidden(&metadata);
        if wrong.is_empty() { Ok(()) } else { Err(wrong.join("; ")) }
    })]
}

/// The forbidden arrows of a workspace, as sentences. Development dependencies may point anywhere.
fn forbidden(metadata: &Value) -> Vec<String> {
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    let ours: Vec<&str> = packages.iter().filter_map(|package| package["name"].as_str()).collect();
    let mut wrong = Vec::new();
    for package in packages {
        let Some(name) = package["name"].as_str() else { continue };
        let path = package["manifest_path"].as_str().unwrap_or_default().replace('\\', "/");
        if path.contains("/dev/") {
            continue;
        }
        let Some((_, permitted)) = ARROWS.iter().find(|(from, _)| *from == name) else {
            wrong.push(format!("{name} has no row in xtask/src/deps.rs"));
            continue;
        };
        for dependency in package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default() {
            let Some(to) = dependency["name"].as_str() else { continue };
            if dependency["kind"] != "dev" && ours.contains(&to) && !permitted.contains(&to) {
                wrong.push(format!("{name} → {to} is not permitted"));
            }
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::forbidden;

    fn package(name: &str, path: &str, dependencies: &Value) -> Value {
        json!({"name": name, "manifest_path": path, "dependencies": dependencies})
    }
    use serde_json::Value;

    #[test]
    fn an_arrow_against_the_order_is_named() {
        let metadata = json!({"packages": [
            package("hashcache-core", "/w/hashcache-core/Cargo.toml", &json!([{"name": "hashcache-hashgrid", "kind": null}])),
            package("hashcache-hashgrid", "/w/hashgrid/Cargo.toml", &json!([{"name": "hashcache-core", "kind": null}, {"name": "glam", "kind": null}])),
        ]});
        assert_eq!(forbidden(&metadata), ["hashcache-core → hashcache-hashgrid is not permitted"]);
    }

    #[test]
    fn development_dependencies_and_dev_crates_are_free_and_unknown_crates_are_not() {
        let metadata = json!({"packages": [
            package("hashcache-core", "/w/hashcache-core/Cargo.toml", &json!([{"name": "hashcache-hashgrid", "kind": "dev"}])),
            package("hashcache-hashgrid", "/w/hashgrid/Cargo.toml", &json!([])),
            package("suite", "/w/dev/suite/Cargo.toml", &json!([{"name": "hashcache-hashgrid", "kind": null}])),
            package("newcomer", "/w/newcomer/Cargo.toml", &json!([])),
        ]});
        assert_eq!(forbidden(&metadata), ["newcomer has no row in xtask/src/deps.rs"]);
    }
}
