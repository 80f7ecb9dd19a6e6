use std::collections::BTreeSet;

/// Most steps of a run: their ends are kept.
pub const MOST_STEPS: usize = 10_000_000;

/// The ends of all steps, and which of them are breakpoints of a load or driver.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeGrid {
    /// Start, ends of steps; increasing.
    pub times: Vec<f64>,
    /// Indices into `times` at which the acceleration is solved anew.
    pub breakpoints: BTreeSet<usize>,
}

impl TimeGrid {
    /// Steps of equal size from 0 to `end`, divided where a breakpoint falls inside one.
    ///
    /// # Errors
    /// An end or step number that is not positive, in words.
    pub fn uniform(end: f64, steps: usize, breakpoints: &[f64]) -> Result<Self, String> {
        if !(end > 0.0 && end.is_finite() && (1..=MOST_STEPS).contains(&steps)) {
            return Err(format!(
                "a simulation needs an end time above 0, at least 1 and at most {MOST_STEPS} steps, not {end} s and {steps} steps"
            ));
        }
        let h = end / steps as f64;
        let mut times: Vec<f64> = (0..=steps).map(|i| if i == steps { end } else { i as f64 * h }).collect();
        let mut marked = Vec::new();
        for &breakpoint in breakpoints.iter().filter(|&&breakpoint| breakpoint > 0.0 && breakpoint < end) {
            // an end of a step within round-off of the breakpoint is moved there; otherwise the step is divided
            let place = times.partition_point(|&t| t < breakpoint);
            let near = |t: f64| (t - breakpoint).abs() <= 1e-9 * h;
            if near(times[place]) {
                times[place] = breakpoint;
            } else if near(times[place - 1]) {
                times[place - 1] = breakpoint;
            } else {
                times.insert(place, breakpoint);
            }
            marked.push(breakpoint);
        }
        let breakpoints = times.iter().enumerate().filter(|(_, t)| marked.contains(t)).map(|(i, _)| i).collect();
        Ok(TimeGrid { times, breakpoints })
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.times.len() - 1
    }

    /// "step 412 (t = 1.03 s)" for the step of index 411.
    pub fn place(&self, index: usize) -> String {
        let t = self.times.get(index).copied().unwrap_or(f64::NAN);
        format!("step {} (t = {t} s)", index + 1)
    }

    /// Sum of the first `steps` step sizes \[s\].
    pub fn duration(&self, steps: usize) -> f64 {
        (0..steps).map(|index| self.span(index)).map(|(t, end)| end - t).sum()
    }

    /// Start and end of step `index` as elements see them: before a breakpoint the end is the last number below it.
    pub fn span(&self, index: usize) -> (f64, f64) {
        let end = self.times[index + 1];
        (self.times[index], if self.breakpoints.contains(&(index + 1)) { end.next_down() } else { end })
    }
}
