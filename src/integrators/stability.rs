//! Whether equilibria stand: signs of the stiffness on the manifold of the constraints.
//!
//! Of [K, A^T; A, 0] as many eigenvalues are negative as there are constraints, and as many more as K has negative ones where A x = 0
//! (Sylvester's law of inertia). The count takes about as long as one factorization where there are none, as two where there are some; signs
//! that round-off may have made are not known, see `linalg`.

use super::newton::Newton;
use crate::elements::RunScalar;
use crate::linalg::{Inertia, Signs};

/// What the stiffness K of an equilibrium says on its constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stability {
    /// Negative eigenvalues of K; of its symmetric part where loads follow the motion.
    pub negative: usize,
    /// Eigenvalues that are zero but for round-off, likewise: their signs are not known.
    pub neutral: usize,
    /// Where loads follow the motion, so that K is not symmetric: the sign of its determinant, 0 where it is not known.
    pub determinant: Option<f64>,
    /// Of a model that turns, in its frame: there Coriolis forces may hold what the stiffness, with centrifugal forces in it, does not.
    pub turns: bool,
}

/// Whether an equilibrium stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every small disturbance meets a force that leads back. Under loads that follow the motion it may flutter still.
    Stable,
    /// A small disturbance leads away.
    Unstable,
    /// A direction without stiffness, or loads that follow the motion in a way that signs do not decide.
    Undecided,
}

impl Stability {
    /// What the numbers mean.
    pub fn verdict(&self) -> Verdict {
        match *self {
            Stability { negative: 0, neutral: 0, .. } => Verdict::Stable,
            Stability { turns: true, .. } => Verdict::Undecided,
            Stability { determinant: None, negative: 1.., .. } => Verdict::Unstable,
            // as many of the real eigenvalues of M^-1 K are negative as makes an odd number
            Stability { determinant: Some(sign), .. } if sign < 0.0 => Verdict::Unstable,
            _ => Verdict::Undecided,
        }
    }
}

/// The stability of equilibria along a path of loads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityCourse {
    /// Of the last one.
    pub end: Stability,
    /// Load factors before and at the end of the first step that ended in an unstable one, and the number of the step.
    pub lost: Option<([f64; 2], usize)>,
}

impl<S: RunScalar> Newton<'_, S> {
    /// Stability of the equilibrium at which the matrix was assembled last.
    pub(super) fn stability(&mut self) -> Stability {
        let size = self.system.size();
        let first = self.system.multiplier_places().iter().flatten().min().copied().unwrap_or(size);
        self.jacobian.complete(&self.system);
        let values = &self.jacobian.values;
        let Signs { inertia: Inertia { negative, zero, .. }, is_symmetric } = self.factorization.signs(values, first);
        let constraints = size - first;
        let (negative, neutral) = (negative.saturating_sub(constraints), zero);
        let determinant = (!is_symmetric).then(|| {
            let sign = if constraints.is_multiple_of(2) { 1.0 } else { -1.0 };
            if negative + neutral == 0 { 1.0 } else { self.factorization.determinant_sign(values).unwrap_or(0.0) * sign }
        });
        Stability { negative, neutral, determinant, turns: false }
    }
}
