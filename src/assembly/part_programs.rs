use super::Equations;
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::jacobian::numbers_of;
use super::numbering::System;
use crate::program::Program;
use std::sync::Arc;

/// The programs that evaluations execute for one kind of element or constraint: to be counted, printed or timed.
pub struct PartPrograms {
    /// R(a, v, q, p, t) of an element; reactions and equations of a constraint.
    pub residual: Arc<Program>,
    /// The matrix, reduced to the unknowns of the nodes.
    pub matrix: Arc<Program>,
    /// Products of adjoint variables with the derivatives towards (a, v, q) and all parameters, for one functional and for two together.
    pub products: [Arc<Program>; 2],
}

impl System<'_> {
    /// Programs of the residuals of all kinds of elements, then of all kinds of constraints whose multipliers are unknowns.
    pub fn part_programs(&self, equations: &Equations) -> Vec<PartPrograms> {
        let moves = numbers_of(equations.residual).1;
        let elements = self.element_batches(Force::Residual).iter().map(|batch| {
            let (formula, layout) = (&batch.formula, batch.layout);
            PartPrograms {
                residual: Arc::clone(formula.values()),
                matrix: element_programs::matrix(formula, layout, &batch.nodes, moves),
                products: [1, 2]
                    .map(|count| element_programs::products(formula, layout, &vec![true; layout.parameters], count)),
            }
        });
        let moves = numbers_of(equations.constraint).1;
        let constraints = self.constraint_batches().iter().map(|batch| {
            let physics = self.constraint_of(batch);
            let (asked, _) = Asked::of(ConstraintPart::Both, equations, physics);
            PartPrograms {
                residual: constraint_programs::values(physics, asked),
                matrix: constraint_programs::matrix(physics, asked, &batch.nodes, moves),
                products: [1, 2]
                    .map(|count| constraint_programs::products(physics, asked, &vec![true; batch.layout.parameters], count)),
            }
        });
        elements.chain(constraints).collect()
    }
}
