//! A progress bar for people, silence for pipes.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on stderr while stderr is a terminal, and nothing otherwise; it disappears when it is dropped.
pub struct Progress(Option<ProgressBar>);

impl Progress {
    /// Starts a bar named `label` for `total` steps.
    pub fn new(label: &str, total: u64) -> Self {
        // at most 10 drawings per second, however often a step reports
        let target = ProgressDrawTarget::stderr_with_hz(10);
        if target.is_hidden() || !costate::exchange::is_first() {
            return Self(None);
        }
        let bar = ProgressBar::with_draw_target(Some(total), target).with_prefix(label.to_owned());
        if let Ok(style) = ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len}  {elapsed} (left: {eta})") {
            bar.set_style(style);
        }
        Self(Some(bar))
    }

    /// Says that `done` steps are complete; cheap enough for every step.
    pub fn set(&self, done: u64) {
        self.0.iter().for_each(|bar| bar.set_position(done));
    }
}
