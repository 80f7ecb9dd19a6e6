use super::joints::Surfaces;
use super::{NodeKind, Parameter};
use crate::scalar::Scalar;
use std::hash::Hash;

/// A holonomic constraint g(q, p, t) = 0: nothing but g is written.
///
/// The reaction A^T mu with A = dg/dq, the velocity level dg/dt = 0, the acceleration level d2g/dt2 = 0, projections and
/// all their derivatives are made of its recording.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait Constraint: Hash + Send + Sync + 'static {
    /// Number of equations; the largest if [`equations`](Constraint::equations) chooses.
    const EQUATIONS: usize;
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Kinds of its nodes, in the order in which their coordinates stand: a model is checked against them.
    fn nodes(&self) -> Vec<NodeKind>;
    /// Number of equations of this instance.
    fn equations(&self) -> usize {
        Self::EQUATIONS
    }
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// g(q, p, t), into `g`, which holds zeros before; scale the rows so that they are lengths or angles.
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]);
    /// How its surfaces slip on each other, where friction of them is known: its first parameters are those of [`Surfaces`](super::joints::Surfaces).
    fn surfaces(&self) -> Option<Surfaces> {
        None
    }
    /// Whether it drives: its points are places to measure from and to, where pictures draw neither a link nor ground.
    fn is_driver(&self) -> bool {
        false
    }
}
