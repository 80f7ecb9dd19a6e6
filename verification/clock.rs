//! Time that one thread has spent computing, whatever else the machine does.

use costate::integrators::Method;
use costate::sensitivity::Analysis;
use std::time::Instant;

/// A start, to measure from.
pub struct Clock {
    /// Time on the processor until then [s]; `None` where the system does not tell.
    computing: Option<f64>,
    /// Time of day.
    begun: Instant,
}

impl Clock {
    /// Now.
    pub fn start() -> Self {
        Clock { computing: computing(), begun: Instant::now() }
    }

    /// Time on the processor since the start, or time of day where the system does not tell [s].
    pub fn seconds(&self) -> f64 {
        let elapsed = self.begun.elapsed().as_secs_f64();
        self.computing.zip(computing()).map_or(elapsed, |(before, now)| now - before)
    }

    /// True if this system tells how long a thread has been computing.
    pub fn counts_computing() -> bool {
        computing().is_some()
    }
}

/// What the time of a run or sweep is spent on, in the order of [`Counters::nanoseconds`](costate::integrators::Counters::nanoseconds).
pub const PHASES: [&str; 4] = ["residuals", "matrices", "factorizations", "solutions"];

/// What some work gives with an analysis whose runs and sweeps measure what their parts take.
pub fn with_phases<T>(analysis: Analysis, work: impl FnOnce(&Analysis) -> T) -> T {
    let method = Method { measures_phases: true, ..analysis.method.clone() };
    work(&Analysis { method: &method, ..analysis })
}

/// The largest of some numbers; NaN if one of them is, or if there are none, so that what is held to a limit fails.
pub fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|own| if own.is_nan() { f64::NAN } else { own }).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// The number in the middle of a list, of two in the middle the mean: one run that was disturbed does not move it.
pub fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let (lower, upper) = (numbers.len().saturating_sub(1) / 2, numbers.len() / 2);
    if numbers.is_empty() { f64::NAN } else { 0.5 * (numbers[lower] + numbers[upper]) }
}

/// Time that this thread has been on a processor [s]: Linux, the first number of `/proc/thread-self/schedstat`.
fn computing() -> Option<f64> {
    // the number is brought up to date when the thread offers its place to others
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    (nanoseconds > 0.0).then_some(1e-9 * nanoseconds)
}
