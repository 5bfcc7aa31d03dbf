//! `cargo xtask test` and `cargo xtask ci`.

use std::process::Command;

use crate::step::{self, Step};
use crate::{check, nostd};

/// All that CI runs. With `require_gpu` a missing adapter fails; else `HASHCACHE_GPU` decides, and by default the GPU
/// tests say that they were skipped.
pub fn steps(require_gpu: bool) -> Vec<Step> {
    let mut steps = check::steps();
    steps.extend(nostd::steps());
    let gpu: &[(&str, &str)] = if require_gpu { &[("HASHCACHE_GPU", "require")] } else { &[] };
    steps.push(Step::cargo_with(
        &["test", "--workspace", "--all-features", "--no-fail-fast"],
        gpu,
        "A test failed; its message says what was expected. Run one alone with `cargo test -p PACKAGE TEST`.",
    ));
    steps.push(Step::cargo(
        &["run", "--quiet", "-p", "hashcache-hashgrid", "--no-default-features", "--example", "embed"],
        "The embedding example of hashgrid fails without default features.",
    ));
    for [package, example] in
        [["hashcache-hashgrid", "points"], ["hashcache-layered-filter", "mirror"], ["hashcache", "ambient_occlusion"]]
    {
        steps.push(Step::cargo(
            &["run", "--quiet", "-p", package, "--example", example],
            "An example that INTEGRATION.md names fails.",
        ));
    }
    if !require_gpu {
        steps.push(Step::new("look for a Vulkan driver", "", || {
            if !has_vulkan() {
                eprintln!(
                    "    no Vulkan driver was found, so the GPU tests were skipped; to run them: \
                     apt-get install -y --no-install-recommends mesa-vulkan-drivers libvulkan1"
                );
            }
            Ok(())
        }));
    }
    steps
}

/// Whether the Vulkan loader and at least one driver are installed (Linux; elsewhere the tests decide).
fn has_vulkan() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let loader = step::output(Command::new("ldconfig").arg("-p")).is_ok_and(|list| list.contains("libvulkan.so.1"));
    let driver = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"]
        .iter()
        .any(|folder| std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()));
    loader && (driver || std::env::var_os("VK_ICD_FILENAMES").is_some())
}
