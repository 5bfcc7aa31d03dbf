//! `hashcache trade`: what settings cost, and what they give for it.

mod front;
mod measure;
mod reference;
mod sheet;
mod sweep;

use std::time::Instant;

use crate::args::Trade;
use crate::failure::Failure;
use crate::folder::Folder;
use crate::outputs::refuse_tone;
use crate::progress::Display;
use crate::render::open;
use measure::{Budget, Measured, measure};
use reference::Reference;
use sheet::{Sheet, Subject};
use sweep::{Sweep, describe};

/// Measures all rows that are not there yet; then the front is what to print.
pub fn run(args: &Trade) -> Result<String, Failure> {
    let sweep = Sweep::new(&args.settings.given()?, &args.vary)?;
    for trial in &sweep.trials {
        refuse_tone(trial.settings.tone_mapping(), "trade", "leave it out")?;
    }
    let folder = Folder::check(&args.output)?;
    let mut sheet = Sheet::read(&folder, &sweep.axes)?;
    Reference::check(args, &folder)?;
    let mut display = Display::new(args.quiet);
    let mut preview = open(&mut display, &args.scene, &sweep.trials[0].settings, None)?;
    for warning in preview.warnings() {
        display.line(&format!("warning: {warning}"));
    }
    let mut budget = Budget::new(args.max_cpu_s);
    let reference = if let Some(path) = &args.reference {
        Reference::read(path, preview.size())?
    } else {
        let (kept, reference) = budget.spend(|| Reference::own(args, &folder, preview, &sweep.base, &mut display))?;
        preview = kept;
        reference
    };
    let seed = sweep.base.seed;
    let scene = args.scene.clone();
    let subject = Subject { scene, reference: reference.name.clone(), seed, seeds: args.seeds };
    let (total, started) = (sweep.trials.len(), Instant::now());
    let mut left_out = 0;
    for (index, trial) in sweep.trials.iter().enumerate() {
        let settings = describe(&trial.settings);
        if sheet.has(&subject, &settings) {
            continue;
        }
        if !budget.allows(trial, args.seeds) {
            left_out += 1;
            continue;
        }
        display.position("sweep", index as u64, total as u64);
        let (kept, measured) = measure(preview, trial, &reference.image, args.seeds, &mut budget)?;
        preview = kept;
        let measured = match measured {
            Ok(measured) => measured,
            Err(needs) => {
                display.line(&format!("left out: {settings}: {needs}"));
                continue;
            }
        };
        display.line(&told(index + 1, total, trial, &measured, &sweep));
        let mut row: Vec<_> = subject.cells().into();
        row.extend(trial.values.iter().map(|value| value.clone().unwrap_or_default()));
        row.push(settings);
        row.extend(measured.cells());
        sheet.add(&folder, row)?;
    }
    display.finish();
    display.line(&format!("{}: swept in {:.0} s", folder.path().display(), started.elapsed().as_secs_f64()));
    if left_out > 0 {
        display.line(&format!("{left_out} rows left out by --max-cpu-s; the same command with a larger one goes on"));
    }
    Ok(front_text(&sheet, &subject, &sweep))
}

/// One line about a row.
fn told(number: usize, total: usize, trial: &sweep::Trial, measured: &Measured, sweep: &Sweep) -> String {
    let pairs = sweep.axes.iter().zip(&trial.values);
    let pairs = pairs.filter_map(|(axis, value)| value.as_ref().map(|value| format!("{}={value}", axis.key)));
    let pairs = pairs.collect::<Vec<_>>().join(" ");
    let [cpu_s, relmse] = [measured.mean("cpu_s"), measured.mean("relmse")];
    format!("{number}/{total} {pairs}: {cpu_s:.3} CPU-s, relMSE {relmse:.5}")
}

/// The table of the front.
fn front_text(sheet: &Sheet, subject: &Subject, sweep: &Sweep) -> String {
    let rows: Vec<_> = sheet.of(subject).collect();
    let number = |row: &[String], column: &str| sheet.cell(row, column).parse().unwrap_or(f64::NAN);
    let points: Vec<_> = rows.iter().map(|row| (number(row, "cpu_s"), number(row, "relmse"))).collect();
    let figures = ["cpu_s", "relmse", "relmse_se", "relmse_trimmed", "flip"];
    let axes: Vec<_> = sweep.axes.iter().map(|axis| axis.key.as_str()).collect();
    let mut lines = vec![figures.iter().chain(&axes).map(|&name| name.to_owned()).collect::<Vec<_>>()];
    for index in front::front(&points) {
        let row = rows[index];
        let numbers = figures.iter().map(|column| match number(row, column) {
            missing if missing.is_nan() => "-".to_owned(),
            value => significant(value),
        });
        let values = axes.iter().map(|key| Some(sheet.cell(row, key)).filter(|value| !value.is_empty()).unwrap_or("-"));
        lines.push(numbers.chain(values.map(str::to_owned)).collect());
    }
    front::aligned(&lines)
}

/// Four digits that count.
fn significant(value: f64) -> String {
    let decimals = if value == 0.0 { 0 } else { (3 - value.abs().log10().floor() as i32).clamp(0, 12) };
    format!("{value:.*}", decimals as usize)
}
