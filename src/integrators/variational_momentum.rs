//! The momenta that a variational integrator keeps.

use super::{Problem, StepRecord};
use crate::elements::State;

/// Generalized momentum p = D2 L_d + f+ at the end of a step, before the reactions there act: P + alpha h F at the step's quadrature
/// point. Zeros for a step of any other method.
///
/// Its sums over a free mechanism, the momentum and the moment of momentum about any point, are constants of motion to round-off.
///
/// Source: Ebrahimi et al. (2019), equation (15).
pub fn discrete_momentum(problem: &Problem<f64>, step: &StepRecord<f64>) -> Vec<f64> {
    let mut momentum = vec![0.0; problem.model.dofs];
    let Some(stage) = step.stages.first() else { return momentum };
    let Some(rule) = stage.solve.equations.variational else { return momentum };
    let at = stage.solve.point();
    for element in &problem.model.elements {
        let dofs: Vec<usize> = element.nodes.iter().flat_map(|node| problem.model.nodes[node.0].dofs.clone()).collect();
        let (v, q): (Vec<f64>, Vec<f64>) = dofs.iter().map(|&dof| (at.v[dof], at.q[dof])).unzip();
        let p = &problem.p[element.parameters.clone()];
        let still = vec![0.0; dofs.len()];
        let state = State { a: &still, v: &v, q: &q };
        let own = element.physics.impulse_at(state, p, stage.solve.t, [1.0, rule.alpha * rule.h]);
        dofs.iter().zip(own).for_each(|(&dof, own)| momentum[dof] += own);
    }
    momentum
}
