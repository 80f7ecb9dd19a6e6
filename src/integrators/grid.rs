use std::collections::BTreeMap;

/// Most steps of a run: their ends are kept.
pub const MOST_STEPS: usize = 10_000_000;

/// The ends of all steps, and which of them are breakpoints of a load or driver.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeGrid {
    /// Start, ends of steps; increasing.
    pub times: Vec<f64>,
    /// Indices into `times` of breakpoints, each with the numbers of all that lie there, in the order in which they were given.
    pub breakpoints: BTreeMap<usize, Vec<usize>>,
}

/// Times nearer to each other than this share of a step are one but for round-off.
const SAME_TIME: f64 = 1e-9;
/// A stretch longer than a whole number of steps by less than this share of one has that number.
const WHOLE: f64 = 1e-6;

impl TimeGrid {
    /// Steps of equal size from 0 to `end`. Each stretch between breakpoints has steps of its own equal size, as many as it takes for none to be
    /// longer than without breakpoints: a breakpoint beside the end of a step makes no step that is much shorter than the others.
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
        let mut grid = TimeGrid { times: vec![0.0], breakpoints: BTreeMap::new() };
        for (time, numbers) in grouped(breakpoints, end, SAME_TIME * h) {
            grid.add_stretch(time, h);
            grid.breakpoints.insert(grid.steps(), numbers);
        }
        grid.add_stretch(end, h);
        Ok(grid)
    }

    /// Adds steps of equal size, none longer than `h`, up to a time.
    fn add_stretch(&mut self, end: f64, h: f64) {
        let start = self.times[self.steps()];
        let length = end - start;
        let count = (length / h - WHOLE).ceil().max(1.0);
        self.times.extend((1..count as usize).map(|i| start + length * (i as f64 / count)));
        self.times.push(end);
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
        (self.times[index], if self.breakpoints.contains_key(&(index + 1)) { end.next_down() } else { end })
    }
}

/// Breakpoints within a run, in the order of their times, each with the numbers of those that are not farther apart than `near`.
fn grouped(breakpoints: &[f64], end: f64, near: f64) -> Vec<(f64, Vec<usize>)> {
    let mut within: Vec<usize> = (0..breakpoints.len()).collect();
    within.retain(|&number| breakpoints[number] > near && breakpoints[number] < end - near);
    within.sort_by(|&a, &b| breakpoints[a].total_cmp(&breakpoints[b]));
    let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
    for number in within {
        let time = breakpoints[number];
        match groups.last_mut() {
            Some((first, numbers)) if time - *first <= near => numbers.push(number),
            _ => groups.push((time, vec![number])),
        }
    }
    groups
}
