//! The momenta that a variational integrator keeps.

use super::{Problem, StepRecord};
use crate::assembly::Impulse;
use crate::elements::{ElementIn, State};

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
    let impulse = Impulse { momentum: 1.0, force: rule.alpha * rule.h };
    for element in &problem.model.elements {
        let dofs: Vec<usize> = element.nodes.iter().flat_map(|node| problem.model.nodes[node.0].dofs.clone()).collect();
        let (v, q): (Vec<f64>, Vec<f64>) = dofs.iter().map(|&dof| (at.v[dof], at.q[dof])).unzip();
        let p = &problem.p[element.parameters.clone()];
        let physics: &dyn ElementIn<f64> = &*element.physics;
        let mut add = |weight: f64, r: &[f64]| dofs.iter().zip(r).for_each(|(&dof, r)| momentum[dof] += weight * r);
        for term in impulse.terms() {
            let scaled = |factor: f64| -> Vec<f64> { v.iter().map(|v| factor * v).collect() };
            let mut r = vec![0.0; dofs.len()];
            let state = State { a: &scaled(term.a), v: &scaled(term.v), q: &q };
            physics.add_residual(state, p, stage.solve.t, &mut r);
            add(term.weight, &r);
        }
        let mut r = vec![0.0; dofs.len()];
        physics.add_momentum_rate(&v, &q, p, &mut r);
        add(impulse.force, &r);
    }
    momentum
}
