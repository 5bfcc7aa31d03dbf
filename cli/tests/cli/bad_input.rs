//! Bad input: one line, the right exit status, and nothing left behind.

use std::fs;

use crate::place::Place;
use crate::scene::Scene;

/// What is tried: its name, what lies in the folder, the command line, the exit status, and a word of the line.
pub struct Case {
    name: &'static str,
    prepare: fn(&Place),
    args: &'static [&'static str],
    status: i32,
    says: &'static str,
}

pub const fn case(
    name: &'static str,
    prepare: fn(&Place),
    args: &'static [&'static str],
    status: i32,
    says: &'static str,
) -> Case {
    Case { name, prepare, args, status, says }
}

pub fn nothing(_: &Place) {}

pub fn good(place: &Place) {
    Scene::lit_floor().write(place);
}

pub fn file(place: &Place, name: &str, bytes: impl AsRef<[u8]>) {
    fs::write(place.path(name), bytes).expect("written");
}

/// The usual command line.
pub const RENDER: &[&str] = &["render", "scene.gltf", "--size", "8x8", "-o", "out.png"];

pub fn check(cases: &[Case]) {
    let mut wrong = Vec::new();
    for case in cases {
        let place = Place::new();
        (case.prepare)(&place);
        let before = place.contents();
        let run = place.run(case.args);
        let line = run.stderr.trim_end();
        println!("{:<28} {} {line}", case.name, run.status);
        let laws = [
            (run.status == case.status, "exit status"),
            (run.stdout.is_empty(), "empty standard output"),
            (run.stderr.starts_with("error: ") && run.stderr.ends_with('\n'), "an error line"),
            (run.stderr.lines().count() == 1 && !line.contains(char::is_control), "one line"),
            (line.contains(case.says), case.says),
            (place.contents() == before, "no file left, changed or removed"),
        ];
        let broken: Vec<_> = laws.iter().filter(|(held, _)| !held).map(|(_, law)| *law).collect();
        if !broken.is_empty() {
            wrong.push(format!(
                "{}: not held: {}; status {}, {:?}",
                case.name,
                broken.join(", "),
                run.status,
                run.stderr
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
