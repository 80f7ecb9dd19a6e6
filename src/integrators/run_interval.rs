use super::{Scheme, StepSizeState, Table, TimeGrid};

/// Steps of any size laid one after the other; each stretch between breakpoints ends with one.
pub(super) struct RunInterval<'c> {
    stretches: &'c TimeGrid,
    pub grid: &'c mut TimeGrid,
    /// Index of the stretch's end.
    target: usize,
    /// What the selection of later steps depends on.
    pub step_size: StepSizeState,
}

impl<'c> RunInterval<'c> {
    /// At the start of the first stretch, with the steps to be added to `grid`.
    pub fn new(stretches: &'c TimeGrid, grid: &'c mut TimeGrid, step_size: StepSizeState) -> Self {
        RunInterval { stretches, grid, target: 1, step_size }
    }

    pub fn t(&self) -> f64 {
        self.grid.times[self.grid.steps()]
    }

    pub fn at_end(&self) -> bool {
        self.target >= self.stretches.times.len()
    }

    pub fn duration(&self) -> f64 {
        self.stretches.times[self.stretches.steps()] - self.stretches.times[0]
    }

    pub fn at_breakpoint(&self) -> bool {
        self.grid.breakpoints.contains_key(&self.grid.steps())
    }

    /// A step of about the size `h`: start and end as elements see them, and its end.
    pub fn span(&self, h: f64) -> ((f64, f64), f64) {
        let (t, target) = (self.t(), self.stretches.times[self.target]);
        let left = target - t;
        let end = if h >= left * (1.0 - crate::tolerances::SAME_TIME) {
            target
        } else if 2.0 * h > left {
            // two equal steps rather than a long and a tiny one
            t + 0.5 * left
        } else {
            t + h
        };
        let at_breakpoint = end == target && self.stretches.breakpoints.contains_key(&self.target);
        ((t, if at_breakpoint { end.next_down() } else { end }), end)
    }

    /// Which scheme of a table makes a step of about the size `h`.
    pub fn scheme(&mut self, table: &Table, h: f64) -> Scheme {
        let (index, (_, reached)) = (self.grid.steps(), self.span(h));
        self.grid.times.push(reached);
        let scheme = table.scheme_at(self.grid, index);
        self.grid.times.pop();
        scheme
    }

    pub fn advance(&mut self, end: f64) {
        self.grid.times.push(end);
        if end == self.stretches.times[self.target] {
            if let Some(numbers) = self.stretches.breakpoints.get(&self.target) {
                self.grid.breakpoints.insert(self.grid.steps(), numbers.clone());
            }
            self.target += 1;
        }
    }
}
