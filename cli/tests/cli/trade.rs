//! Sweeps of settings.

use std::fs;

use crate::bad_input::{case, check, file, good};
use crate::place::Place;
use crate::table::Table;

const TRADE: [&str; 6] = ["trade", "builtin:cornell", "--size", "32x32", "-o", "out"];
const OWN: [&str; 2] = ["--reference-spp", "64"];
const SMALL: [&str; 6] = ["--vary", "cache=grid,none", "--vary", "spp=1,4", "--filter", "none"];

fn trade(place: &Place, options: &[&[&str]]) -> crate::place::Run {
    place.succeed(&[&TRADE[..], &OWN, &options.concat()].concat())
}

#[test]
fn a_sweep_measures_each_row_and_prints_the_front() {
    let place = Place::new();
    let run = trade(&place, &[&SMALL, &["--seeds", "3"]]);
    assert_eq!(place.names("out"), ["reference.exr", "reference.json", "trade.csv"]);
    let table = Table::read(&place, "out/trade.csv");
    assert_eq!(
        table.columns.join(","),
        "scene,reference,seed,seeds,cache,spp,settings,cpu_s,cpu_s_se,time_s,time_s_se,build_cpu_s,build_time_s,relmse,relmse_se,\
         relmse_trimmed,relmse_trimmed_se,ms_ssim,ms_ssim_se,flip,flip_se,energy_ratio,energy_ratio_se,cache_cells,cache_bytes"
    );
    let trials: Vec<_> = (0..table.rows.len()).map(|row| (table.text(row, "cache"), table.text(row, "spp"))).collect();
    assert_eq!(trials, [("grid", "1"), ("none", "1"), ("grid", "4"), ("none", "4")], "few samples first");
    for row in 0..4 {
        assert_eq!((table.text(row, "scene"), table.text(row, "seeds")), ("builtin:cornell", "3"));
        for column in ["cpu_s", "time_s", "build_time_s", "relmse", "relmse_se", "relmse_trimmed", "flip"] {
            let value = table.number(row, column).unwrap_or_else(|| panic!("{column} of row {row}"));
            assert!(value > 0.0 && value < 100.0, "{column}: {value}");
        }
        let energy = table.number(row, "energy_ratio").unwrap();
        assert!((energy - 1.0).abs() < 0.2, "{energy}");
        assert_eq!(table.number(row, "ms_ssim"), None, "too small for it");
        assert_eq!(table.number(row, "cache_cells").is_some(), table.text(row, "cache") == "grid");
        assert!(table.text(row, "settings").contains("size=32x32"), "{}", table.text(row, "settings"));
    }
    // Four times the samples, about a quarter of the error: 64 samples a pixel tell them apart.
    let ratio = table.number(1, "relmse").unwrap() / table.number(3, "relmse").unwrap();
    assert!((2.0..8.0).contains(&ratio), "{ratio}");
    let front: Vec<_> = run.stdout.lines().collect();
    assert!(front[0].starts_with("cpu_s") && front[0].ends_with("spp"), "{front:?}");
    let least = (0..4).map(|row| table.number(row, "relmse").unwrap()).fold(f64::INFINITY, f64::min);
    let last: f64 = front.last().unwrap().split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((last / least - 1.0).abs() < 1e-3, "the front ends at the least error: {front:?}");
}

#[test]
fn a_sweep_goes_on_where_it_stopped() {
    let place = Place::new();
    trade(&place, &[&SMALL, &["-q"]]);
    let whole = fs::read(place.path("out/trade.csv")).unwrap();
    let reference = fs::read(place.path("out/reference.exr")).unwrap();
    // Nothing is left to do.
    trade(&place, &[&SMALL, &["-q"]]);
    assert!(fs::read(place.path("out/trade.csv")).unwrap() == whole);
    // A machine that stopped in the midst of a row.
    let rows: Vec<_> = whole.split_inclusive(|&byte| byte == b'\n').collect();
    let mut broken = rows[..3].concat();
    broken.extend(&rows[3][..10]);
    fs::write(place.path("out/trade.csv"), broken).unwrap();
    trade(&place, &[&SMALL, &["-q"]]);
    let again = fs::read(place.path("out/trade.csv")).unwrap();
    assert!(again.starts_with(&rows[..3].concat()), "rows that were there stay");
    let relmse = |bytes: &[u8]| {
        fs::write(place.path("t.csv"), bytes).unwrap();
        let table = Table::read(&place, "t.csv");
        (0..table.rows.len()).map(|row| table.number(row, "relmse").unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(relmse(&again), relmse(&whole), "the same pictures again");
    assert!(fs::read(place.path("out/reference.exr")).unwrap() == reference);
    // Another seed's rows stand beside, with a reference of their own.
    let run = place.run(&[&TRADE[..], &OWN, &SMALL, &["--seed", "9"]].concat());
    assert!(run.status == 1 && run.stderr.contains("seed"), "{}", run.stderr);
}

#[test]
fn a_budget_keeps_the_sweep_short() {
    let place = Place::new();
    file(&place, "note", "");
    place.succeed(&[
        "render",
        "builtin:cornell",
        "--size",
        "32x32",
        "--cache",
        "none",
        "--spp",
        "64",
        "-o",
        "r.exr",
        "-q",
    ]);
    let args = ["--reference", "r.exr", "--vary", "spp=1,1000000", "--max-cpu-s", "20"];
    let run = place.succeed(&[&TRADE[..], &args].concat());
    assert!(run.stderr.contains("1 rows left out"), "{}", run.stderr);
    let table = Table::read(&place, "out/trade.csv");
    assert_eq!((table.rows.len(), table.text(0, "spp"), table.text(0, "reference")), (1, "1", "r.exr"));
    assert_eq!(table.number(0, "relmse_se"), None, "one seed shows no error");
}

#[test]
fn bad_sweeps() {
    const BAD: &[&str] = &["trade", "scene.gltf", "--size", "8x8", "-o", "out"];
    fn other(place: &Place) {
        good(place);
        fs::create_dir(place.path("out")).unwrap();
    }
    let with = |options: &'static [&'static str]| -> &'static [&'static str] { [BAD, options].concat().leak() };
    check(&[
        case("no folder", good, &["trade", "scene.gltf"], 2, "-o"),
        case("missing scene", |_| (), BAD, 1, "scene.gltf"),
        case("no values", good, with(&["--vary", "spp"]), 2, "KEY="),
        case("unknown setting", good, with(&["--vary", "sbb=1"]), 2, "sbb"),
        case("unknown value", good, with(&["--vary", "cache=grid,tree"]), 2, "cache=tree"),
        case("varied and fixed", good, with(&["--vary", "spp=1,2", "--spp", "4"]), 2, "spp"),
        case("another picture", good, with(&["--vary", "max_bounces=1,2"]), 2, "--set"),
        case("no seeds", good, with(&["--seeds", "0"]), 2, "--seeds"),
        case("a negative budget", good, with(&["--max-cpu-s=-1"]), 2, "--max-cpu-s"),
        case("two references", good, with(&["--reference", "r.exr", "--reference-spp", "4"]), 2, "--reference"),
        case("a missing reference", good, with(&["--reference", "r.exr"]), 1, "r.exr"),
        case(
            "a reference of another size",
            |p| {
                good(p);
                p.succeed(&["render", "builtin:cornell", "--size", "8x9", "-o", "r.exr", "-q"]);
            },
            with(&["--reference", "r.exr"]),
            1,
            "8x9",
        ),
        case("the folder is a file", good, &["trade", "scene.gltf", "-o", "scene.bin"], 1, "scene.bin"),
        case(
            "somebody else's reference",
            |p| {
                other(p);
                file(p, "out/reference.exr", "mine");
            },
            BAD,
            1,
            "--reference",
        ),
        case(
            "somebody else's table",
            |p| {
                other(p);
                file(p, "out/trade.csv", "a,b\n1,2\n");
            },
            BAD,
            1,
            "trade.csv",
        ),
        case(
            "settings that never go together",
            good,
            with(&["--cache", "none", "--set", "cache.direct=traced"]),
            2,
            "cache.direct=traced",
        ),
    ]);
}
