//! One step of a verb, and the runner.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

type Action = Box<dyn Fn() -> Result<(), String>>;

/// A thing to do, and what to tell when it fails.
pub struct Step {
    name: String,
    on_failure: String,
    action: Action,
}

impl Step {
    /// A step done by a function of this program.
    pub fn new(name: &str, on_failure: &str, action: impl Fn() -> Result<(), String> + 'static) -> Self {
        Self { name: name.to_owned(), on_failure: on_failure.to_owned(), action: Box::new(action) }
    }

    /// A step that runs cargo with these arguments in the workspace's root.
    pub fn cargo(arguments: &[&str], on_failure: &str) -> Self {
        Self::cargo_with(arguments, &[], on_failure)
    }

    /// As [`Step::cargo`], with further environment variables.
    pub fn cargo_with(arguments: &[&str], environment: &[(&str, &str)], on_failure: &str) -> Self {
        let arguments: Vec<String> = arguments.iter().map(|&a| a.to_owned()).collect();
        let environment: Vec<(String, String)> =
            environment.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect();
        let words = environment.iter().map(|(k, v)| format!("{k}={v}"));
        let words = words.chain(["cargo".to_owned()]).chain(arguments.iter().cloned());
        let name = words.collect::<Vec<_>>().join(" ");
        Self::new(&name, on_failure, move || {
            let mut command = Command::new(cargo());
            command.args(&arguments).envs(environment.iter().map(|(k, v)| (k, v))).current_dir(root());
            run_command(&mut command)
        })
    }
}

/// Runs steps in order, says how long each took, and stops at the first failure unless told to go on.
pub fn run(steps: &[Step], keep_going: bool, list: bool) -> ExitCode {
    if list {
        for step in steps {
            println!("{}", step.name);
        }
        return ExitCode::SUCCESS;
    }
    let mut failures = Vec::new();
    for step in steps {
        eprintln!("==> {}", step.name);
        let start = Instant::now();
        match (step.action)() {
            Ok(()) => eprintln!("    done in {:.1} s", start.elapsed().as_secs_f64()),
            Err(reason) => {
                eprintln!("    failed: {reason}\n    {}", step.on_failure);
                failures.push(step.name.as_str());
                if !keep_going {
                    break;
                }
            }
        }
    }
    if failures.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("failed: {}", failures.join("; "));
    ExitCode::FAILURE
}

/// Runs a command to its end; an exit code other than 0 is an error.
pub fn run_command(command: &mut Command) -> Result<(), String> {
    let program = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{program} ended with {status}")),
        Err(error) => Err(format!("{program} cannot be started: {error}")),
    }
}

/// Runs a command and returns what it printed.
pub fn output(command: &mut Command) -> Result<String, String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| format!("{program} cannot be started: {error}"))?;
    if !output.status.success() {
        return Err(format!(
            "{program} ended with {}: {}",
            output.status,
            String::from_utf8_lossy(&output.stderr).trim()
        ));
    }
    String::from_utf8(output.stdout).map_err(|_| format!("{program} printed something that is not UTF-8"))
}

/// The cargo that started this program.
pub fn cargo() -> impl AsRef<OsStr> {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// The workspace's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace").to_owned()
}

/// Where cargo puts what it builds.
pub fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}
