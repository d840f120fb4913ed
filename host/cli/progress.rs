//! A progress bar on stderr, if that is a terminal and the work takes long enough.

use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// How long the work takes before the bar appears.
const PATIENCE: Duration = Duration::from_millis(500);
const STEPS: u64 = 1000;

pub(super) struct Bar {
    /// The work's name.
    what: &'static str,
    started: Instant,
    enabled: bool,
    bar: OnceLock<ProgressBar>,
}

impl Bar {
    pub(super) fn new(what: &'static str, quiet: bool) -> Self {
        Self {
            what,
            started: Instant::now(),
            enabled: !quiet && std::io::stderr().is_terminal(),
            bar: OnceLock::new(),
        }
    }

    /// Shows how much is done, from 0 to 1.
    pub(super) fn set(&self, done: f64) {
        if !self.enabled || self.started.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let style = ProgressStyle::with_template("{msg} {bar:32} {percent:>3} %  {eta} left");
            ProgressBar::new(STEPS)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
                .with_message(self.what)
        });
        // Bands finish in any order, but the bar never goes backwards.
        let position = (done * STEPS as f64) as u64;
        bar.set_position(position.max(bar.position()));
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}
