//! The linear equations at a point, for those who find their own way to a solution.

use super::Newton;
use crate::assembly::{Equations, Residual, StageSystem, Unknowns, VectorsAvq};
use crate::elements::RunScalar;

impl<S: RunScalar> Newton<'_, S> {
    /// Zeros, with the multipliers of a mechanism that is let go in a state where these exist: without reactions a joint holds nothing up,
    /// and the first matrix of an equilibrium may be singular.
    pub(in crate::integrators) fn reactions_at_release(&mut self, base: &VectorsAvq<S>, p: &[S], t: f64) -> Unknowns<S> {
        let mut unknowns = Residual::unknowns(&self.system);
        let stage = StageSystem { equations: &Equations::acceleration(), base, p, t };
        if self.solve(stage, &mut unknowns).is_err() {
            return Residual::unknowns(&self.system);
        }
        unknowns.x.fill(S::zero());
        unknowns
    }
}

impl Newton<'_, f64> {
    /// Evaluates and factors the equations at a point; or the name of the unknown that they do not determine.
    pub(in crate::integrators) fn linearize(
        &mut self,
        stage: StageSystem<f64>,
        unknowns: &mut Unknowns<f64>,
    ) -> Result<(), String> {
        self.residual.start(&self.system, stage);
        self.evaluate(stage, unknowns);
        let factored = self.factorize(stage, unknowns);
        factored.map_err(|singular| self.system.unknown_name(singular.unknown, &self.jacobian))
    }

    /// What takes the residual of the point to zero, to first order.
    pub(in crate::integrators) fn correction(&mut self) -> Unknowns<f64> {
        self.jacobian.reduce(&self.system, &self.residual, None, &mut self.rhs);
        self.solved()
    }

    /// How the unknowns move when forces are added to the residual, and gaps to the constraints.
    pub(in crate::integrators) fn response(&mut self, forces: &[f64], gaps: &[f64]) -> Unknowns<f64> {
        self.rhs.fill(0.0);
        let forces: Vec<f64> = forces.iter().map(|force| -force).collect();
        self.jacobian.restrict_left(&self.system, &forces, &mut self.rhs);
        for (place, gap) in self.system.multiplier_places().iter().zip(gaps) {
            if let Some(place) = *place {
                self.rhs[place] = -gap;
            }
        }
        self.solved()
    }

    fn solved(&mut self) -> Unknowns<f64> {
        self.counters.solves += 1;
        self.factorization.solve(&mut self.rhs);
        let mut unknowns = Residual::unknowns(&self.system);
        self.jacobian.add_step(&self.system, &self.rhs, None, &mut unknowns, &self.coordinate_scales);
        unknowns
    }
}
