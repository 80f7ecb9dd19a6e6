use super::grid::beside;
use super::{EndMoves, Scheme, SideChange, StepSizeState, Table, TimeGrid};

/// Steps of any size laid one after the other; each stretch between breakpoints ends with one.
pub(super) struct RunInterval<'c> {
    stretches: &'c TimeGrid,
    pub grid: &'c mut TimeGrid,
    /// Index of the stretch's end.
    target: usize,
    /// What the selection of later steps depends on.
    pub step_size: StepSizeState,
    /// Size of the steps that are laid from an event up to the end of its stretch, where they are given \[s\].
    pub laid: f64,
    /// Events that were found, and steps behind the last of them.
    events: usize,
    behind: usize,
}

/// More steps than there are.
const NONE_LEFT: usize = usize::MAX / 2;

impl<'c> RunInterval<'c> {
    /// At the start of the first stretch, with the steps to be added to `grid`.
    pub fn new(stretches: &'c TimeGrid, grid: &'c mut TimeGrid, step_size: StepSizeState) -> Self {
        RunInterval { stretches, grid, target: 1, step_size, laid: f64::INFINITY, events: 0, behind: 0 }
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

    /// Whether earlier steps do not foretell the next one.
    pub fn at_breakpoint(&self) -> bool {
        self.grid.is_interrupted(self.grid.steps())
    }

    /// Place of the next breakpoint, or of the end of the run, up to which steps may be moved.
    fn stretch_end(&self) -> usize {
        let stretches = self.stretches;
        stretches.breakpoints.range(self.target..).next().map_or(stretches.steps(), |(&place, _)| place)
    }

    /// Its time \[s\].
    pub fn next_breakpoint(&self) -> f64 {
        self.stretches.times[self.stretch_end()]
    }

    /// Time from an end of a step to the next breakpoint, or to the end of the run.
    pub fn stretch_behind(&self, t: f64) -> f64 {
        let all = self.stretches.breakpoints.range(self.target..).map(|(&place, _)| self.stretches.times[place]);
        all.chain([self.stretches.end()]).find(|&end| end > t).map_or(0.0, |end| end - t)
    }

    /// How the end of the next step moves, with the motion of the event before it and those of breakpoints at some times.
    pub fn moves_next(&self) -> (f64, [(f64, f64); 2]) {
        let EndMoves { by_event, by_breakpoints } = self.stretches.moves_of(self.target);
        let at = |(place, share): (usize, f64)| (self.stretches.laid_time(place), share);
        (by_event, by_breakpoints.map(at))
    }

    /// Sides that change at the end of the next step, in a run that is made again.
    pub fn changes_next(&self) -> Option<&[SideChange]> {
        self.stretches.events.get(&self.target).map(Vec::as_slice)
    }

    /// Sides that change at the breakpoint at the end of the next step, in a run that is made again.
    pub fn jumps_next(&self) -> Option<&[SideChange]> {
        self.stretches.jumps.get(&self.target).map(Vec::as_slice)
    }

    /// Whether a step that ends there ends at a breakpoint.
    pub fn is_breakpoint(&self, end: f64) -> bool {
        end == self.stretches.times[self.target] && self.stretches.breakpoints.contains_key(&self.target)
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
        ((t, if at_breakpoint { beside(end, -1.0) } else { end }), end)
    }

    /// Which scheme of a table makes a step of about the size `h`.
    pub fn scheme(&mut self, table: &Table, h: f64) -> Scheme {
        self.scheme_to(table, self.span(h).1)
    }

    /// Which makes a step to an end.
    pub fn scheme_to(&mut self, table: &Table, reached: f64) -> Scheme {
        let index = self.grid.steps();
        if self.stretches.shortest.contains(&(self.target - 1)) {
            return Scheme::Euler;
        }
        self.grid.times.push(reached);
        let is_last = reached >= self.next_breakpoint() && self.grid.is_behind_event(index);
        let scheme = table.scheme_of(self.grid, index, is_last || self.changes_next().is_some());
        self.grid.times.pop();
        scheme
    }

    /// Keeps in mind which scheme makes the next step.
    pub fn note(&mut self, scheme: Scheme) {
        if scheme == Scheme::Euler {
            self.grid.shortest.insert(self.grid.steps());
        }
    }

    /// Takes a step, at whose end sides may change: from there on steps of the size that is given are laid anew.
    pub fn advance_over(&mut self, end: f64, changes: Vec<SideChange>) {
        if changes.is_empty() {
            return self.advance(end);
        }
        let stretch_end = self.stretch_end();
        if end < self.stretches.times[stretch_end] && !self.is_made_again() {
            let size = self.stretches.times[self.target] - self.stretches.times[self.target - 1];
            self.laid = self.laid.min(size);
            self.target = stretch_end;
            self.grid.times.push(end);
        } else {
            self.advance(end);
        }
        (self.events, self.behind) = (self.events + 1, 0);
        self.lay_behind_event();
        self.grid.events.insert(self.grid.steps(), changes);
    }

    /// Makes the next step as long as it was in a run with chosen steps, wherever the event before it is now.
    fn lay_behind_event(&mut self) {
        let sizes = self.events.checked_sub(1).and_then(|event| self.stretches.behind_events.get(event));
        let Some(&(size, share)) = sizes.and_then(|sizes| sizes.get(self.behind)).filter(|_| !self.at_end()) else { return };
        self.laid = match share {
            0.0 => f64::INFINITY,
            // the first of two halves
            ..1.0 => 0.75 * (self.next_breakpoint() - self.t()),
            _ => size,
        };
    }

    /// Ends at an event, where the last step ended.
    pub fn stop(&mut self) {
        if !self.at_end() {
            self.grid.laid_end = Some(self.stretches.end());
            let unreached = self.stretches.breakpoints.range(self.target..);
            self.grid.unreached =
                unreached.map(|(&place, numbers)| (self.stretches.times[place], numbers.clone())).collect();
            self.target = self.stretches.times.len();
        }
    }

    fn is_made_again(&self) -> bool {
        self.stretches.has_events()
    }

    /// Whether a step of a scheme ends within a rounding of where it starts.
    pub fn is_at_once(&self, scheme: Scheme, end: f64) -> bool {
        scheme == Scheme::Euler && end <= self.t().next_up()
    }

    /// Takes a step up to a breakpoint, or one that is no longer than a rounding, at which sides change.
    pub fn advance_to_jump(&mut self, end: f64, changes: Vec<SideChange>) {
        self.advance(end);
        self.grid.jumps.insert(self.grid.steps(), changes);
    }

    pub fn advance(&mut self, end: f64) {
        self.grid.times.push(end);
        if end == self.stretches.times[self.target] {
            if let Some(numbers) = self.stretches.breakpoints.get(&self.target) {
                self.grid.breakpoints.insert(self.grid.steps(), numbers.clone());
            }
            self.target += 1;
            self.laid = f64::INFINITY;
            if self.events > 0 {
                // of another stretch
                self.behind = NONE_LEFT;
            }
        }
        self.behind += 1;
        self.lay_behind_event();
    }
}
