//! Steps whose ends move with the design: breakpoints that depend on a variable.

use super::breakpoints::Breakpoints;
use super::{Analysis, Forward};
use crate::design::{DesignChain, ModelNumbers, shortest};
use crate::elements::RunScalar;
use crate::integrators::{Clocks, RunError, TimeGrid, moved_apart};
use crate::program::SwitchKind;
use std::collections::HashSet;

impl Analysis<'_> {
    pub(super) fn breakpoints(&self, numbers: &ModelNumbers<f64>) -> Result<Breakpoints, RunError> {
        Breakpoints::of(self.model, self.functionals, numbers, self.grid.end()).map_err(RunError::Input)
    }

    /// How time goes between the breakpoints of a run for parameters with derivative parts.
    pub(super) fn clocks<S: RunScalar>(&self, p: &[S], forward: &Forward) -> Result<Clocks<S>, RunError> {
        if forward.grid.moving_ends().next().is_none() {
            return Ok(Vec::new());
        }
        let parts = self.breakpoints(&forward.numbers)?.parts(p);
        forward.grid.clocks(&parts).map_err(RunError::Input)
    }

    /// The breakpoints of a run that depend on an active parameter, each with its place among the ends of steps and its number: of those that coincide
    /// the first one stands for all.
    pub(super) fn moving_breakpoints(
        &self,
        map: &Breakpoints,
        grid: &TimeGrid,
        chain: &DesignChain,
        active: &[bool],
    ) -> Result<Vec<(usize, usize)>, RunError> {
        refuse_moved_ends(map, grid, active)?;
        let reads = |numbers: &[usize]| numbers.iter().any(|&number| map.all()[number].reads(active));
        let moving = grid.moving_ends().filter(|(_, numbers)| reads(numbers));
        let placed = moving.map(|(place, numbers)| {
            match numbers[1..].iter().any(|&other| !move_together(map, chain, [numbers[0], other])) {
                true => Err(RunError::Input(moved_apart(grid.times[place]))),
                false => Ok((place, numbers[0])),
            }
        });
        placed.collect()
    }
}

/// That no variable moves a jump that lies at the start or at the end of a run; one behind an event that ends the run is not in it.
fn refuse_moved_ends(map: &Breakpoints, grid: &TimeGrid, active: &[bool]) -> Result<(), RunError> {
    let within: HashSet<usize> = grid.breakpoints.values().flatten().copied().collect();
    let last = grid.times[grid.steps()];
    let is_behind = |t: f64| last < grid.end() && t > last;
    let mut all = (0..).zip(map.all()).filter(|(number, own)| !within.contains(number) && !is_behind(own.at.t));
    let Some((_, own)) = all.find(|(_, own)| own.kind == Some(SwitchKind::Jump) && own.reads(active)) else { return Ok(()) };
    let end = if own.at.t > 0.5 * grid.times[grid.steps()] { "end" } else { "start" };
    Err(RunError::Input(format!(
        "\"{}\" jumps at t = {} s, the {end} of the run, and a design variable moves the jump: to one side the run has it, to the other it \
         has not, so that there is no derivative; let the run {end} elsewhere, or take another design",
        own.part,
        shortest(own.at.t)
    )))
}

/// Whether two breakpoints have the same derivatives by the design.
fn move_together(map: &Breakpoints, chain: &DesignChain, pair: [usize; 2]) -> bool {
    let ModelNumbers { p, q, v } = chain.real();
    let gradient = |weights: [f64; 2]| {
        let mut bar = ModelNumbers { p: vec![0.0; p.len()], q: vec![0.0; q.len()], v: vec![0.0; v.len()] };
        map.add_transposed(pair.into_iter().zip(weights), &mut bar.p);
        chain.gradient(&bar).into_iter().fold(0.0, |size: f64, rate| size.max(rate.abs()))
    };
    gradient([1.0, -1.0]) <= crate::tolerances::SAME_DERIVATIVE * gradient([1.0, 0.0])
}
