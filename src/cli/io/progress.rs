//! A progress bar for people, silence for pipes.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on stderr while stderr is a terminal, and nothing otherwise; the bar disappears when it is finished or dropped.
pub struct Progress {
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Starts a bar named `label` for `total` steps.
    pub fn new(label: &str, total: u64) -> Self {
        // at most 10 drawings per second, however often a step reports
        let target = ProgressDrawTarget::stderr_with_hz(10);
        if target.is_hidden() || !costate::exchange::is_first() {
            return Self { bar: None };
        }
        let bar = ProgressBar::with_draw_target(Some(total), target);
        if let Ok(style) = ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len}  {elapsed} (left: {eta})") {
            bar.set_style(style);
        }
        bar.set_prefix(label.to_owned());
        Self { bar: Some(bar) }
    }

    /// Says that `done` steps are complete; cheap enough for every step.
    pub fn set(&self, done: u64) {
        if let Some(bar) = &self.bar {
            bar.set_position(done);
        }
    }

    /// Removes the bar.
    pub fn finish(self) {}
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::IsTerminal;

    #[test]
    fn a_pipe_gets_no_bar() {
        let progress = Progress::new("steps", 100);
        assert_eq!(progress.bar.is_some(), std::io::stderr().is_terminal());
        for done in 0..=100 {
            progress.set(done);
        }
        progress.finish();
    }
}
