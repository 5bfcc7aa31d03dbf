//! Progress on standard error: a bar on a terminal, plain lines otherwise, nothing when quiet.

use std::io::{self, IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Shortest time between two plain lines, so that a log of a long render stays short.
const BETWEEN_LINES: Duration = Duration::from_secs(2);

/// Where progress is shown.
pub struct Display {
    quiet: bool,
    bar: Option<ProgressBar>,
    last_line: Instant,
}

impl Display {
    /// Shows nothing before the first report.
    pub fn new(quiet: bool) -> Self {
        let bar = (!quiet && io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{msg:8} [{bar:40}] {percent:>3} %  {elapsed} (about {eta} more)");
            bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { quiet, bar, last_line: Instant::now() }
    }

    /// The same for work whose steps print lines of their own: a bar where there is one, and nothing else.
    pub fn position(&self, what: &'static str, done: u64, total: u64) {
        if let Some(bar) = &self.bar {
            bar.set_length(total);
            bar.set_message(what);
            bar.set_position(done);
        }
    }

    /// `done` of `total` steps are done.
    pub fn report(&mut self, what: &'static str, done: u64, total: u64) {
        if self.bar.is_some() {
            self.position(what, done, total);
        } else if !self.quiet && done < total && self.last_line.elapsed() >= BETWEEN_LINES {
            self.last_line = Instant::now();
            self.line(&format!("{what} {} %", 100 * done / total));
        }
    }

    /// A line that stays, above the bar.
    pub fn line(&self, text: &str) {
        if !self.quiet {
            let write = || {
                // Nobody is left to tell when standard error is closed.
                let _ = writeln!(io::stderr(), "{text}");
            };
            match &self.bar {
                Some(bar) => bar.suspend(write),
                None => write(),
            }
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
