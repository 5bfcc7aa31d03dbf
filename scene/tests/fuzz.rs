//! Longer random damage, seeded: files of our own and, where they are present, files that other people made; cameras and
//! camera paths too. A CPU-second by default; `HASHCACHE_FUZZ_SECONDS=600` goes on for longer and `HASHCACHE_FUZZ_SEED`
//! elsewhere. An input that fails is kept and named.

mod common;
mod survive;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;

use cpu_time::ProcessTime;
use hashcache_core::hash::pcg;
use serde_json::{Value, json};
use survive::{Bounds, SMALL, sample, survive_camera, survive_scene};

/// A sequence of draws.
struct Draws(u32);

impl Draws {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(1);
        pcg(self.0) as usize % n.max(1)
    }

    fn one_of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// What numbers and fields are replaced by.
fn hostile() -> Vec<Value> {
    let numbers = [
        json!(0),
        json!(1),
        json!(-1),
        json!(2),
        json!(255),
        json!(65535),
        json!(0x7fff_ffff_u32),
        json!(u32::MAX),
        json!(1_u64 << 32),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(0.5),
        json!(-0.0),
        json!(1e-320),
        json!(1e38),
        json!(1e39),
        json!(1e300),
        json!(5121),
        json!(5123),
        json!(5125),
        json!(5126),
        json!(33071),
    ];
    let others = [
        json!(null),
        json!(true),
        json!([]),
        json!({}),
        json!(""),
        json!("MASK"),
        json!("BLEND"),
        json!("spot"),
        json!("VEC2"),
        json!("../x"),
        json!("data:;base64,AAAA"),
        json!([0, 0]),
        json!([1e39, 1, 1]),
        json!({"index": 0}),
        json!({"index": 9, "texCoord": 4_000_000_000_u32}),
        json!("a\nb\u{2028}"),
    ];
    numbers.into_iter().chain(others).collect()
}

/// A random value inside of `value`, the deeper the likelier.
fn inside<'a>(value: &'a mut Value, draws: &mut Draws) -> &'a mut Value {
    let length = value.as_array().map_or(0, Vec::len) + value.as_object().map_or(0, serde_json::Map::len);
    if length == 0 || draws.below(12) == 0 {
        return value;
    }
    let at = draws.below(length);
    match value {
        Value::Array(list) => inside(&mut list[at], draws),
        Value::Object(map) => inside(map.values_mut().nth(at).unwrap(), draws),
        _ => unreachable!("it has members"),
    }
}

/// Damage that stays JSON.
fn damage_tree(tree: &mut Value, draws: &mut Draws) {
    for _ in 0..=draws.below(3) {
        match draws.below(5) {
            0 | 1 => {
                let new = draws.one_of(&hostile()).clone();
                *inside(tree, draws) = new;
            }
            2 => {
                let other = inside(tree, draws).clone();
                *inside(tree, draws) = other;
            }
            3 => match inside(tree, draws) {
                Value::Array(list) if !list.is_empty() => drop(list.remove(draws.below(list.len()))),
                Value::Object(map) if !map.is_empty() => {
                    let key = map.keys().nth(draws.below(map.len())).unwrap().clone();
                    map.remove(&key);
                }
                _ => {}
            },
            _ => {
                let other = inside(tree, draws).clone();
                match inside(tree, draws) {
                    Value::Array(list) => list.insert(draws.below(list.len() + 1), other),
                    Value::Object(map) => {
                        let key = map.keys().nth(draws.below(map.len().max(1))).cloned().unwrap_or_default();
                        map.insert(key, other);
                    }
                    plain => *plain = other,
                }
            }
        }
    }
}

/// Damage to any bytes.
fn damage_bytes(bytes: &mut Vec<u8>, draws: &mut Draws) {
    const WORDS: [u32; 8] = [0, 1, u32::MAX, 0x7f80_0000, 0x7fc0_0000, 0xff80_0000, 0x7f7f_ffff, 0x8000_0000];
    for _ in 0..=draws.below(6) {
        if bytes.is_empty() {
            return;
        }
        let at = draws.below(bytes.len());
        match draws.below(6) {
            0 | 1 => bytes[at] = draws.below(256) as u8,
            2 => bytes[at] ^= 1 << draws.below(8),
            3 => {
                let word = draws.one_of(&WORDS).to_le_bytes();
                let at = at & !3;
                bytes.iter_mut().skip(at).zip(word).for_each(|(to, from)| *to = from);
            }
            4 => {
                let end = (at + 1 + draws.below(64)).min(bytes.len());
                bytes.drain(at..end);
            }
            _ => {
                let end = (at + 1 + draws.below(64)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                let to = draws.below(bytes.len());
                bytes.splice(to..to, piece);
            }
        }
    }
}

/// A scene: its JSON, its own folder's other files, and what loading it may take.
struct Subject {
    json: Value,
    files: BTreeMap<String, Vec<u8>>,
    bounds: Bounds,
}

/// Our own sample as a `.gltf` with a file beside it.
fn own() -> Subject {
    let mut file = sample();
    file.json["buffers"] = json!([{"byteLength": file.bin.len(), "uri": "own.bin"}]);
    Subject { json: file.json, files: BTreeMap::from([("own.bin".into(), file.bin)]), bounds: SMALL }
}

/// The smaller of the shared scenes: loading them takes tens of milliseconds.
fn shared() -> Vec<Subject> {
    const LARGEST: u64 = 8 << 20;
    let root = common::shared_root();
    let mut folders: Vec<_> = std::fs::read_dir(root.join("scenes")).into_iter().flatten().flatten().collect();
    folders.sort_by_key(std::fs::DirEntry::file_name);
    let mut subjects = Vec::new();
    for folder in folders {
        let mut files = BTreeMap::new();
        read_all(&folder.path(), "", &mut files);
        let size: u64 = files.values().map(|f| f.len() as u64).sum();
        for (name, text) in files.iter().filter(|(name, _)| is_scene(name) && size < LARGEST) {
            println!("{name}: {size} bytes");
            let json = serde_json::from_slice(text).unwrap();
            let files = files.iter().filter(|(n, _)| !is_scene(n)).map(|(n, f)| (n.clone(), f.clone())).collect();
            subjects.push(Subject { json, files, bounds: Bounds { time: Duration::from_secs(20), bytes: 1 << 30 } });
        }
    }
    if subjects.is_empty() {
        println!("skipped: no shared scenes at {}; set HASHCACHE_SHARED", root.display());
    }
    subjects
}

fn is_scene(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|e| e == "gltf")
}

fn read_all(folder: &Path, prefix: &str, files: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            read_all(&entry.path(), &format!("{name}/"), files);
        } else {
            files.insert(name, std::fs::read(entry.path()).unwrap());
        }
    }
}

/// One damaged scene; `dir` holds the subject's files in good order, before and after.
fn try_scene(dir: &Path, subject: &Subject, draws: &mut Draws) {
    let path = dir.join("scene.gltf");
    let mut text = match draws.below(4) {
        0 => {
            let mut text = serde_json::to_vec(&subject.json).unwrap();
            damage_bytes(&mut text, draws);
            text
        }
        1 => serde_json::to_vec(&subject.json).unwrap(),
        _ => {
            let mut tree = subject.json.clone();
            damage_tree(&mut tree, draws);
            serde_json::to_vec(&tree).unwrap()
        }
    };
    let names: Vec<&String> = subject.files.keys().collect();
    let broken = (!names.is_empty() && draws.below(3) == 0).then(|| *draws.one_of(&names));
    if let Some(name) = broken {
        let mut bytes = subject.files[name].clone();
        damage_bytes(&mut bytes, draws);
        std::fs::write(dir.join(name), bytes).unwrap();
    }
    if draws.below(64) == 0 {
        text.truncate(draws.below(text.len()));
    }
    std::fs::write(&path, text).unwrap();
    survive_scene(&path, subject.bounds);
    if let Some(name) = broken {
        std::fs::write(dir.join(name), &subject.files[name]).unwrap();
    }
}

fn try_camera(dir: &Path, draws: &mut Draws) {
    let view = json!({"position": [0, 1, 5], "target": [0, 1, 0], "up": [0, 1, 0], "fov_y_deg": 45});
    let mut tree = if draws.below(2) == 0 {
        view
    } else {
        let key = |time: f64| {
            let mut key = view.clone();
            key["time"] = json!(time);
            key["position"][0] = json!(time);
            key
        };
        json!({"keys": [key(0.0), key(1.0), key(3.0)], "frames": 9})
    };
    damage_tree(&mut tree, draws);
    let mut text = serde_json::to_vec(&tree).unwrap();
    if draws.below(3) == 0 {
        damage_bytes(&mut text, draws);
    }
    let path = dir.join("camera.json");
    std::fs::write(&path, text).unwrap();
    // A million frames are checked one by one.
    survive_camera(&path, Bounds { time: Duration::from_secs(20), ..SMALL });
}

#[test]
fn damaged_files_are_answered() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |v| v.parse().unwrap());
    let (seconds, seed) = (number("HASHCACHE_FUZZ_SECONDS", 1), number("HASHCACHE_FUZZ_SEED", 1) as u32);
    let subjects: Vec<Subject> = std::iter::once(own()).chain(shared()).collect();
    let dirs: Vec<tempfile::TempDir> = subjects.iter().map(|_| tempfile::tempdir().unwrap()).collect();
    for (subject, dir) in subjects.iter().zip(&dirs) {
        for (name, bytes) in &subject.files {
            let path = dir.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
    }
    let start = ProcessTime::now();
    let (mut cases, mut failed) = (0_u32, Vec::new());
    while start.elapsed() < Duration::from_secs(seconds) {
        let mut draws = Draws(pcg(seed ^ pcg(cases)));
        // Our own holds everything and is fast; the others hold what people make.
        let which = if draws.below(8) == 0 { draws.below(subjects.len()) } else { 0 };
        let dir = &dirs[which];
        let camera = draws.below(16) == 0;
        let attempt = catch_unwind(AssertUnwindSafe(|| {
            if camera {
                try_camera(dir.path(), &mut draws);
            } else {
                try_scene(dir.path(), &subjects[which], &mut draws);
            }
        }));
        if attempt.is_err() {
            let kept = std::env::temp_dir().join(format!("hashcache-fuzz-{seed}-{cases}"));
            std::fs::create_dir_all(&kept).unwrap();
            let mut files = BTreeMap::new();
            read_all(dir.path(), "", &mut files);
            for (name, bytes) in files {
                std::fs::create_dir_all(kept.join(&name).parent().unwrap()).unwrap();
                std::fs::write(kept.join(name), bytes).unwrap();
            }
            failed.push(kept);
            for (name, bytes) in &subjects[which].files {
                std::fs::write(dir.path().join(name), bytes).unwrap();
            }
        }
        cases += 1;
    }
    println!("{cases} cases, {} failed", failed.len());
    assert!(failed.is_empty(), "{failed:?}");
}
