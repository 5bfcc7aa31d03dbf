//! One row: the same picture from several seeds, its cost and its error.

use hashcache::clock::{self, Elapsed};
use hashcache::{Error, Image, Preview, Settings};

use crate::failure::Failure;
use crate::figures::{Figures, view};
use crate::table::cell;
use crate::trade::sweep::{Trial, describe};

/// What one seed's picture took and gave.
struct Shot {
    frame: Elapsed,
    build: Elapsed,
    figures: Figures,
    cells: Option<u64>,
    bytes: Option<u64>,
}

/// What all seeds' pictures took and gave.
pub struct Measured {
    shots: Vec<Shot>,
}

/// Renders a row's pictures. Gives the preview back; the inner error says that memory did not suffice.
pub fn measure(
    mut preview: Preview,
    trial: &Trial,
    reference: &Image,
    seeds: u32,
    budget: &mut Budget,
) -> Result<(Preview, Result<Measured, Error>), Failure> {
    let mut shots = Vec::new();
    for seed in 0..seeds {
        let settings = Settings { seed: trial.settings.seed.wrapping_add(seed), ..trial.settings.clone() };
        preview = preview.with_settings(&settings)?;
        let before = budget.spent;
        match budget.spend(|| shoot(&preview, reference)) {
            Ok(shot) => shots.push(shot),
            Err(Stop::Memory(error)) => return Ok((preview, Err(error))),
            Err(Stop::Failure(failure)) => return Err(failure),
        }
        budget.learn(trial, budget.spent - before);
    }
    Ok((preview, Ok(Measured { shots })))
}

enum Stop {
    Memory(Error),
    Failure(Failure),
}

impl From<Error> for Stop {
    fn from(error: Error) -> Self {
        match error {
            error @ Error::OutOfMemory { .. } => Self::Memory(error),
            error => Self::Failure(error.into()),
        }
    }
}

fn shoot(preview: &Preview, reference: &Image) -> Result<Shot, Stop> {
    let mut backend = preview.backend()?;
    let mut session = preview.session(&mut backend)?;
    let frame = session.frame(preview.camera(), &mut |_| ())?;
    let stats = session.stats()?;
    let figures = view(&frame.image).and_then(|image| Figures::measure(image, view(reference)?));
    let figures = figures.map_err(|error| {
        Stop::Failure(Failure::other(format!("{}: the picture: {error}", describe(preview.settings()))))
    })?;
    let cache = stats.cache.as_ref();
    Ok(Shot {
        frame: frame.elapsed,
        build: Elapsed { wall_s: stats.time_s.build, cpu_s: stats.cpu_s.build },
        figures,
        cells: cache.map(|cache| cache.cells),
        bytes: cache.map(|cache| cache.bytes),
    })
}

impl Measured {
    /// The mean of a column over the seeds; NaN if there is none.
    pub fn mean(&self, column: &str) -> f64 {
        self.means().into_iter().find(|(name, ..)| *name == column).and_then(|(_, mean, _)| mean).unwrap_or(f64::NAN)
    }

    /// The cells of the measured columns, in the sheet's order.
    pub fn cells(&self) -> Vec<String> {
        let means = self.means();
        let (times, figures) = means.split_at(2);
        let pair = |(_, mean, error): &(&str, Option<f64>, Option<f64>)| [cell(*mean), cell(*error)];
        let last = self.shots.last();
        let build = last.map(|shot| shot.build);
        let count = |value: Option<u64>| value.map_or(String::new(), |value| value.to_string());
        let mut cells: Vec<_> = times.iter().flat_map(pair).collect();
        cells.extend([cell(build.map(|build| build.cpu_s)), cell(build.map(|build| build.wall_s))]);
        cells.extend(figures.iter().flat_map(pair));
        cells.extend([count(last.and_then(|shot| shot.cells)), count(last.and_then(|shot| shot.bytes))]);
        cells
    }

    /// Name, mean and standard error: CPU time, wall time, then the figures.
    fn means(&self) -> Vec<(&'static str, Option<f64>, Option<f64>)> {
        let column = |name: &'static str, value: &dyn Fn(&Shot) -> Option<f64>| {
            let values: Option<Vec<f64>> = self.shots.iter().map(value).collect();
            let (mean, error) = values.map_or((None, None), |values| mean_and_error(&values));
            (name, mean, error)
        };
        let mut columns =
            vec![column("cpu_s", &|shot| Some(shot.frame.cpu_s)), column("time_s", &|shot| Some(shot.frame.wall_s))];
        for (index, name) in Figures::NAMES.iter().enumerate() {
            columns.push(column(name, &|shot| shot.figures.values()[index]));
        }
        columns
    }
}

/// The mean and its standard error, which one value does not show.
fn mean_and_error(values: &[f64]) -> (Option<f64>, Option<f64>) {
    if values.is_empty() {
        return (None, None);
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (n - 1.0);
    (Some(mean), (values.len() > 1).then(|| (variance / n).sqrt()))
}

/// CPU-seconds of this run: spent, allowed, and what rows took so far.
pub struct Budget {
    most: f64,
    pub spent: f64,
    /// Settings but the samples, samples, CPU-seconds of one picture.
    known: Vec<(Settings, u32, f64)>,
}

impl Budget {
    pub fn new(most: Option<f64>) -> Self {
        Self { most: most.unwrap_or(f64::INFINITY), spent: 0.0, known: Vec::new() }
    }

    /// Runs work and counts it.
    pub fn spend<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (value, elapsed) = clock::measure(work);
        self.spent += elapsed.cpu_s;
        value
    }

    fn learn(&mut self, trial: &Trial, cpu_s: f64) {
        self.known.push((but_samples(&trial.settings), trial.settings.spp, cpu_s));
    }

    /// Whether a row fits. Its cost is that of the same settings with fewer samples, in proportion; else the mean of all
    /// rows with as many.
    pub fn allows(&self, trial: &Trial, seeds: u32) -> bool {
        let (settings, spp) = (but_samples(&trial.settings), trial.settings.spp);
        let sibling = self.known.iter().filter(|(known, ..)| *known == settings).max_by_key(|(_, spp, _)| *spp);
        let cost = if let Some((_, known, cost)) = sibling {
            cost * f64::from(spp) / f64::from(*known)
        } else {
            let alike: Vec<_> = self.known.iter().filter(|(_, known, _)| *known == spp).map(|known| known.2).collect();
            mean_and_error(&alike).0.unwrap_or(0.0)
        };
        self.spent + cost * f64::from(seeds) <= self.most
    }
}

fn but_samples(settings: &Settings) -> Settings {
    Settings { spp: 0, ..settings.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(spp: u32) -> Trial {
        Trial { settings: Settings { spp, ..Settings::default() }, values: Vec::new() }
    }

    #[test]
    fn means_have_standard_errors() {
        assert_eq!(mean_and_error(&[]), (None, None));
        assert_eq!(mean_and_error(&[3.0]), (Some(3.0), None));
        // Variance 4 over 4 values.
        assert_eq!(mean_and_error(&[1.0, 1.0, 1.0, 5.0]), (Some(2.0), Some(1.0)));
    }

    #[test]
    fn a_budget_leaves_out_what_would_break_it() {
        let mut budget = Budget::new(Some(10.0));
        assert!(budget.allows(&trial(1 << 20), 9), "nothing is known yet");
        budget.learn(&trial(1), 2.0);
        assert!(budget.allows(&trial(4), 1) && !budget.allows(&trial(4), 2) && !budget.allows(&trial(16), 1));
        budget.spent = 9.0;
        assert!(!budget.allows(&trial(1), 1));
        let mut other = trial(1);
        other.settings.seed = 7;
        assert!(!budget.allows(&other, 1), "rows with as many samples cost as much");
        assert!(Budget::new(None).allows(&trial(1 << 24), 1024));
    }
}
