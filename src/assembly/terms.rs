//! The terms of a system and the points at which they are taken: whoever adds or differentiates them does not ask what kind of system it is.

use super::constraint_programs::ConstraintPart;
use super::{Equations, Force, VectorsAvq};
use crate::scalar::Scalar;
use smallvec::{SmallVec, smallvec};

/// A point of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TermPoint {
    /// The base, moved by the unknowns as the residual is.
    Solution,
    /// The base itself.
    Base,
    /// The point of the step before.
    Before,
    /// Where constraints hold; reactions act there, too, unless they have a point of their own.
    Constraints,
    /// Where reactions act.
    Reactions,
}

impl TermPoint {
    /// All of them, in the order of their numbers.
    pub const ALL: [TermPoint; 5] =
        [TermPoint::Solution, TermPoint::Base, TermPoint::Before, TermPoint::Constraints, TermPoint::Reactions];
}

/// What is taken at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// What elements add, times a factor.
    Elements(Force, f64),
    /// Equations and reactions of joints.
    Constraints(ConstraintPart),
}

impl Equations {
    /// The terms of the residual, that at the solution first.
    pub fn terms(&self) -> SmallVec<[(Term, TermPoint); 4]> {
        let elements = |force, factor, point| (Term::Elements(force, factor), point);
        let joints = |part, point| (Term::Constraints(part), point);
        let at_solution = elements(Force::of(self), 1.0, TermPoint::Solution);
        if let Some(step) = self.variational {
            return smallvec![
                at_solution,
                elements(Force::Impulse(step.before()), -1.0, TermPoint::Before),
                joints(ConstraintPart::Equations, TermPoint::Constraints),
                joints(ConstraintPart::Reactions(step.reaction()), TermPoint::Reactions),
            ];
        }
        let mut terms = smallvec![at_solution, joints(ConstraintPart::Both, TermPoint::Constraints)];
        if self.is_difference() {
            terms.push(elements(Force::Residual, -1.0, TermPoint::Base));
        }
        terms
    }

    /// What elements add at a point that the unknowns do not move: it is subtracted.
    pub(crate) fn subtracted(&self) -> Option<(Force, TermPoint)> {
        self.terms().into_iter().skip(1).find_map(|(term, point)| match term {
            Term::Elements(force, _) => Some((force, point)),
            Term::Constraints(_) => None,
        })
    }

    /// Equations and reactions of joints, and where they are taken.
    pub(crate) fn constraint_terms(&self) -> impl Iterator<Item = (ConstraintPart, TermPoint)> {
        self.terms().into_iter().filter_map(|(term, point)| match term {
            Term::Constraints(part) => Some((part, point)),
            Term::Elements(..) => None,
        })
    }

    /// Whether anything is taken at a point.
    pub fn is_taken_at(&self, point: TermPoint) -> bool {
        self.terms().iter().any(|(_, own)| *own == point)
    }

    /// Whether reactions act at a point of their own, which the unknowns do not move.
    pub fn parts_reactions(&self) -> bool {
        self.variational.is_some()
    }

    /// From the base to a point, before the unknowns move it: times the velocity of the base \[s\].
    pub fn offset(&self, point: TermPoint) -> f64 {
        let Some(step) = self.variational else { return 0.0 };
        match point {
            TermPoint::Solution | TermPoint::Base => 0.0,
            TermPoint::Before => step.to_before(),
            TermPoint::Constraints => step.to_end(),
            TermPoint::Reactions => step.to_start(),
        }
    }

    /// Time at a point, for equations at time `t` \[s\].
    pub fn time_at(&self, point: TermPoint, t: f64) -> f64 {
        t + self.offset(point)
    }

    /// A point before the unknowns move it: the base, or what is written to `moved`.
    pub fn point_of<'b, S: Scalar>(
        &self,
        point: TermPoint,
        base: &'b VectorsAvq<S>,
        moved: &'b mut VectorsAvq<S>,
    ) -> &'b VectorsAvq<S> {
        if self.variational.is_none() || matches!(point, TermPoint::Solution | TermPoint::Base) {
            return base;
        }
        let offset = self.offset(point);
        moved.a.clear();
        moved.a.resize(base.q.len(), S::zero());
        moved.v.clone_from(&base.v);
        moved.q.clear();
        moved.q.extend(base.q.iter().zip(&base.v).map(|(&q, &v)| q + v * offset));
        moved
    }
}
