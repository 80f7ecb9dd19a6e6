//! What a Newton's method keeps between systems.

use super::contraction::Contractions;
use super::renewal::Renewal;
use super::round_off::Floor;
use crate::assembly::{Equations, Unknowns, VectorsAvq, clone_fields};

/// Where a matrix was assembled: the factorization is made again from it, bit by bit.
#[derive(Debug, PartialEq)]
pub struct FactoredAt<S> {
    pub t: f64,
    pub base: VectorsAvq<S>,
    /// Unknowns, before they are brought onto the equations inside nodes.
    pub unknowns: Unknowns<S>,
}

impl<S> FactoredAt<S> {
    pub(super) fn clear(&mut self) {
        let (VectorsAvq { a, v, q }, Unknowns { x, mu, local_mu }) = (&mut self.base, &mut self.unknowns);
        [a, v, q, x, mu, local_mu].into_iter().for_each(Vec::clear);
        self.t = 0.0;
    }
}

clone_fields!(FactoredAt { t, base, unknowns });

#[derive(Debug, PartialEq)]
pub struct KeptFactorization<S> {
    /// The equations for which the matrix was factored last, if the factorization is still in use.
    pub factored: Option<Equations>,
    pub at: FactoredAt<S>,
    /// Corrections that are round-off: of metrics (projections of coordinates, then of velocities) and of other systems.
    pub floors: [Option<Floor>; 3],
    pub measured: Option<Equations>,
    pub measured_for: usize,
    pub contractions: Contractions,
    pub renewal: Renewal,
}

clone_fields!(KeptFactorization { factored, at, floors, measured, measured_for, contractions, renewal });
