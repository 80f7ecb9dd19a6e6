use super::{ByPoints, Parameter, lagrangian_momentum_rate, lagrangian_residual};
use crate::scalar::Scalar;

/// Accelerations, velocities and coordinates of an element's nodes, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct State<'a, S> {
    /// Accelerations d2q/dt2.
    pub a: &'a [S],
    /// Velocities dq/dt.
    pub v: &'a [S],
    /// Coordinates.
    pub q: &'a [S],
}

/// A part of the system with inertia, stiffness or load, written once for every number type.
///
/// Give either [`residual`](Element::residual), or the energies and the non-conservative force, from which
///
/// R = d/dt (dT/dv) - dT/dq + dV/dq - Q
///
/// follows by differentiation. An element may give both when its residual is faster written out; the contract tests then
/// hold the two together. Every physical number is a parameter in `p`; the element itself holds topology and options only.
///
/// Formulas marked `#[inline(always)]` are compiled once more for wide vectors, which matrices and gradients then use where the
/// processor has them.
pub trait Element: Send + Sync + 'static {
    /// Number of coordinates of all its nodes together; the largest if [`dofs`](Element::dofs) chooses.
    const DOFS: usize;
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];
    /// True if [`kinetic`](Element::kinetic) and [`potential`](Element::potential) hold all its energy: energy functionals
    /// refuse elements that say false. Loads and dampers without stored energy say true.
    const ENERGIES: bool = false;
    /// True if R is M(p) a + f(v, q, p, t): the mass matrix depends on parameters alone, or there is none. The contract tests hold it
    /// against R.
    const CONSTANT_MASS: bool = false;

    /// Number of coordinates of this instance.
    fn dofs(&self) -> usize {
        Self::DOFS
    }
    /// True if R is linear in (a, v, q) with coefficients that do not depend on time (a load may): its derivatives are then evaluated
    /// once for a run instead of for every matrix.
    fn is_linear(&self) -> bool {
        false
    }
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Kinetic energy T(v, q, p) [J].
    fn kinetic<S: Scalar>(&self, _v: &[S], _q: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Potential energy V(q, p) [J].
    fn potential<S: Scalar>(&self, _q: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Adds the generalized non-conservative force Q(v, q, p, t) to `force`.
    fn add_force<S: Scalar>(&self, _v: &[S], _q: &[S], _p: &[S], _t: S, _force: &mut [S]) {}
    /// Adds the residual R(a, v, q, p, t) to `r`.
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        lagrangian_residual(self, s, p, t, r);
    }
    /// Adds (dP/dq) v with the momentum P = dT/dv to `r`: what the momentum changes by along the motion without acceleration.
    ///
    /// Not needed: it follows from the kinetic energy. Variational integrators ask for it unless the mass is constant.
    fn momentum_rate<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], r: &mut [S]) {
        lagrangian_momentum_rate(self, v, q, p, r);
    }
    /// Mass [kg].
    fn mass<S: Scalar>(&self, _p: &[S]) -> S {
        S::zero()
    }
    /// Times at which a load jumps: steps end there and the acceleration is solved anew.
    fn kinks(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }
    /// Its derivatives through points, for an element made of a [`Field`](super::Field), or written out.
    fn by_points(&self) -> Option<&dyn ByPoints> {
        None
    }
}
