//! The matrix of accelerations, which tells how redundant equations depend on the others.

use super::Newton;
use crate::assembly::{Equations, Residual, StageSystem};
use crate::elements::RunScalar;
use crate::linalg::Singular;
use smallvec::SmallVec;

impl<S: RunScalar> Newton<'_, S> {
    /// Factors the matrix of accelerations at a state: rows A of the kept constraint equations beside inertia.
    pub(in crate::integrators) fn factor_accelerations(
        &mut self,
        (q, v): (&[S], &[S]),
        p: &[S],
        t: f64,
    ) -> Result<(), Singular> {
        let equations = Equations::acceleration();
        let (mut base, mut unknowns) = (std::mem::take(&mut self.state), std::mem::take(&mut self.guess));
        base.a.clear();
        base.a.resize(q.len(), S::zero());
        base.v.clear();
        base.v.extend_from_slice(v);
        base.q.clear();
        base.q.extend_from_slice(q);
        Residual::shape(&self.system, &mut unknowns, true);
        let stage = StageSystem { equations: &equations, base: &base, p, t };
        self.residual.start(&self.system, stage);
        self.kept.factored = None;
        self.evaluate(stage, &mut unknowns);
        let factored = self.factorize(stage, &unknowns);
        (self.state, self.guess) = (base, unknowns);
        factored
    }

    /// The kept constraint equation with the largest coefficient c in a_d = sum c_i a_i, where a_d is the row of a dropped one, and
    /// that coefficient: after [`Newton::factor_accelerations`].
    ///
    /// From M y + A^T c = a_d, A y = 0, where y = 0 because a_d depends on A.
    pub(in crate::integrators) fn largest_coefficient(
        &mut self,
        dropped: usize,
        q: &[S],
        p: &[S],
        t: f64,
    ) -> Option<(usize, f64)> {
        let model = self.system.model;
        let joint = model.joint_of(dropped)?;
        type Few = SmallVec<[f64; 32]>;
        let dofs = || joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone());
        let own: Few = dofs().map(|dof| q[dof].value()).collect();
        let numbers: Few = p[joint.parameters.clone()].iter().map(|p| p.value()).collect();
        let mut unit = Few::from_elem(0.0, joint.equations.len());
        unit[dropped - joint.equations.start] = 1.0;
        let row = joint.physics.reaction_in((&own, &numbers, t), &unit, &mut self.formula_work);
        self.row.clear();
        self.row.resize(model.dofs, 0.0);
        dofs().zip(row).for_each(|(dof, &entry)| self.row[dof] = entry);
        self.rhs.fill(0.0);
        self.jacobian.restrict_right(&self.system, &self.row, &mut self.rhs);
        // a matrix that is nearly singular is what is looked for here
        let _ = self.factorization.solve_transposed(&mut self.rhs);
        let kept = self.system.multiplier_places().iter().enumerate();
        let sizes = || kept.clone().filter_map(|(equation, place)| Some((equation, self.rhs[(*place)?].abs())));
        let largest = sizes().fold(0.0, |largest: f64, (_, size)| largest.max(size));
        // of equal ones, as symmetric loops have them, the first, whatever their last bits
        sizes().find(|(_, size)| *size >= 0.999 * largest)
    }
}
