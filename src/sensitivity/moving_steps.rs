//! Steps whose ends move with the design: breakpoints that depend on a variable.

use super::breakpoints::Breakpoints;
use super::{Analysis, Forward};
use crate::design::{DesignChain, ModelNumbers, shortest};
use crate::elements::RunScalar;
use crate::integrators::{Clocks, RunError, TimeGrid, moved_apart};
use crate::program::SwitchKind;
use crate::scalar::{TANGENTS, Tangents};
use std::collections::HashSet;

impl Analysis<'_> {
    pub(super) fn breakpoints(&self, numbers: &ModelNumbers<f64>) -> Result<Breakpoints, RunError> {
        let end = self.grid.times[self.grid.steps()];
        Breakpoints::of(self.model, self.functionals, numbers, end).map_err(RunError::Input)
    }

    /// How time goes between the breakpoints of a run for parameters with derivative parts.
    pub(super) fn clocks<S: RunScalar>(&self, p: &[S], forward: &Forward) -> Result<Clocks<S>, RunError> {
        if forward.grid.breakpoints.is_empty() {
            return Ok(Vec::new());
        }
        let parts = self.breakpoints(&forward.numbers)?.parts(p);
        forward.grid.clocks(&parts).map_err(RunError::Input)
    }

    /// The breakpoints of a run, and the derivatives of each functional by those that depend on an active parameter while parameters stay, by a tangent
    /// run for eight of them; no lists if none does. Of breakpoints that coincide the first one stands for all.
    pub(super) fn by_moving_steps(
        &self,
        forward: &Forward,
        chain: &DesignChain,
        active: &[bool],
    ) -> Result<(Breakpoints, Vec<Vec<f64>>), RunError> {
        let map = self.breakpoints(&forward.numbers)?;
        refuse_moved_ends(&map, &forward.grid, active)?;
        let reads = |numbers: &[usize]| numbers.iter().any(|&number| map.all()[number].reads(active));
        let moving: Vec<(&usize, &Vec<usize>)> =
            forward.grid.breakpoints.iter().filter(|(_, numbers)| reads(numbers)).collect();
        if moving.is_empty() {
            return Ok((map, Vec::new()));
        }
        for &(&index, numbers) in &moving {
            if numbers[1..].iter().any(|&other| !move_together(&map, chain, [numbers[0], other])) {
                return Err(RunError::Input(moved_apart(forward.grid.times[index])));
            }
        }
        let lift = |values: &[f64]| values.iter().map(|&value| Tangents::from(value)).collect();
        let ModelNumbers { p, q, v } = &forward.numbers;
        let numbers = ModelNumbers { p: lift(p), q: lift(q), v: lift(v) };
        let count = map.all().len();
        let mut rates = vec![vec![0.0; count]; self.functionals.len()];
        for chunk in moving.chunks(TANGENTS) {
            let mut parts = vec![Tangents::from(0.0); count];
            for (lane, (_, numbers)) in chunk.iter().enumerate() {
                numbers.iter().for_each(|&number| parts[number].add_to_part(lane, 1.0));
            }
            let clocks = forward.grid.clocks(&parts).map_err(RunError::Input)?;
            let (values, _) = self.values_along(&numbers, &clocks, forward)?;
            for (rates, value) in rates.iter_mut().zip(values) {
                chunk.iter().enumerate().for_each(|(lane, (_, numbers))| rates[numbers[0]] = value.part(lane));
            }
        }
        Ok((map, rates))
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
        let mut all = vec![0.0; map.all().len()];
        pair.iter().zip(weights).for_each(|(&number, weight)| all[number] = weight);
        map.add_transposed(&all, &mut bar.p);
        chain.gradient(&bar).into_iter().fold(0.0, |size: f64, rate| size.max(rate.abs()))
    };
    gradient([1.0, -1.0]) <= crate::tolerances::SAME_DERIVATIVE * gradient([1.0, 0.0])
}
