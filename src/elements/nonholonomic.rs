use super::{NodeKind, Parameter};
use crate::scalar::Scalar;
use std::hash::Hash;

/// A constraint on velocities, h(v, q, p, t) = B(q, p, t) v + b(q, p, t) = 0, that is no derivative of any g: rolling, blades, wheels.
///
/// Nothing but h is written. The reaction B^T mu, the acceleration level dh/dt = 0, projections of velocities and all their
/// derivatives are made of its recording. Coordinates are not restricted by it: their projection leaves it alone.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait NonholonomicConstraint: Hash + Send + Sync + 'static {
    /// Number of equations.
    const EQUATIONS: usize;
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Kinds of its nodes, in the order in which their coordinates stand: a model is checked against them.
    fn nodes(&self) -> Vec<NodeKind>;
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// h(v, q, p, t), linear in v, into `h`, which holds zeros before; scale the rows so that they are velocities or angular velocities.
    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, h: &mut [S]);
}

/// A [`NonholonomicConstraint`] among the constraints of a model.
#[derive(Hash)]
pub struct Nonholonomic<C>(pub C);
