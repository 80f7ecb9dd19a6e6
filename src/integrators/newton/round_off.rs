//! The size of corrections that are round-off alone.

use super::Newton;
use crate::assembly::{Equations, Level, StageSystem, Unknowns};
use crate::elements::RunScalar;
use crate::tolerances::{LONG_SUM, STALLED};

/// Corrections that are round-off, and the unknowns of the state where that was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Floor {
    /// Of coordinates and of multipliers.
    pub corrections: [f64; 2],
    /// Largest unknown, and largest multiplier in the scale of the matrix.
    pub unknowns: [f64; 2],
}

/// Factor between the unknowns of two states up to which the round-off of one tells that of the other.
const ALIKE: f64 = 8.0;

impl Floor {
    /// Whether corrections of a state with these unknowns, should they pass for round-off, may do so: where they are tiny, or where the
    /// state is like the one that was measured. Forces of an impact have a round-off that is a motion afterwards.
    pub(super) fn speaks_for(&self, unknowns: [f64; 2], corrections: [f64; 2]) -> bool {
        let mut lists = self.unknowns.into_iter().zip(unknowns).zip(corrections);
        lists.all(|((there, here), correction)| correction <= STALLED * here || there <= ALIKE * here)
    }
}

impl<S: RunScalar> Newton<'_, S> {
    /// Measures the corrections that are round-off alone at a state: what the last bits of (a, v, q) and of forces change in the residual,
    /// through the matrix.
    pub(super) fn round_off(&mut self, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> Floor {
        let step = self.round_off_of(None, stage, unknowns);
        let sizes = [self.size(&unknowns.x), self.multiplier_size(unknowns)];
        Floor { corrections: [step, self.multiplier_step()], unknowns: sizes }
    }

    /// A correction of unknowns that is round-off in the system of stages, where that was measured.
    pub(in crate::integrators) fn measured_round_off(&self) -> f64 {
        self.kept.floors[2].map_or(0.0, |floor| floor.corrections[0])
    }

    /// Size of a correction of coordinates, of their values or of a derivative part, that is round-off alone; the residual is evaluated.
    pub(super) fn round_off_of(&mut self, part: Option<usize>, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) -> f64 {
        self.jacobian.reduce(&self.system, &self.residual, part, &mut self.exact);
        self.residual.last_bits = true;
        self.evaluate(stage, unknowns);
        self.residual.last_bits = false;
        self.jacobian.reduce(&self.system, &self.residual, part, &mut self.rhs);
        self.rhs.iter_mut().zip(&self.exact).for_each(|(other, exact)| *other -= exact);
        self.factorization.solve(&mut self.rhs);
        self.counters.solves += 1;
        self.work.clone_from(unknowns);
        self.jacobian.add_step(&self.system, &self.rhs, part, &mut self.work, &self.coordinate_scales)
    }

    /// Corrections no longer shrink: is that round-off, or a system that does not converge?
    pub(super) fn at_round_off(&mut self, stage: StageSystem<S>, unknowns: &Unknowns<S>, step: f64, scale: f64) -> bool {
        let equations = stage.equations;
        if step <= STALLED * scale {
            return true;
        }
        let force = self.residual.f.iter().fold(0.0, |s: f64, f| s.max(f.value().abs()));
        let length = self.residual.constraint_at().q.iter().fold(0.0, |s: f64, q| s.max(q.value().abs()));
        let gap = match equations.level {
            Level::Position => equations.constraint.alpha,
            Level::Velocity | Level::Acceleration => 0.0,
        };
        let largest_gap = self.residual.g.iter().fold(0.0, |s: f64, g| s.max(g.value().abs())) * gap;
        let small_force = force <= self.residual.force_floor(&self.system, stage, unknowns);
        let small_gap = largest_gap <= LONG_SUM * length.max(f64::MIN_POSITIVE);
        small_force && small_gap
    }
}

/// Which of the three kinds of systems that share a matrix it is.
pub(crate) fn kind(equations: &Equations) -> usize {
    match (equations.metric, equations.level) {
        (true, Level::Position) => 0,
        (true, _) => 1,
        (false, _) => 2,
    }
}
