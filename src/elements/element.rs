use super::{NodeKind, Parameter};
use crate::program::{Recorded, Stages};
use crate::scalar::Scalar;
use std::borrow::Cow;
use std::hash::Hash;

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

/// A number that histories tell of an element beside the motion of its nodes.
#[derive(Clone, Debug, PartialEq, Hash)]
pub struct Output {
    /// What it is, as `force`.
    pub name: Cow<'static, str>,
    /// Its unit; empty where that is not known.
    pub unit: &'static str,
}

impl Output {
    /// Of a name and a unit.
    pub fn new(name: impl Into<Cow<'static, str>>, unit: &'static str) -> Self {
        Output { name: name.into(), unit }
    }

    /// A strain, its rate and its stress, by what they are called and their units: `[("length", "m"), ("rate", "m/s"), ("force", "N")]`.
    pub fn of_strain(named: [(&'static str, &'static str); 3]) -> Vec<Self> {
        named.map(|(name, unit)| Output::new(name, unit)).into()
    }
}

/// A part of the system with inertia, stiffness or load: one formula, written once for every number type, and nothing else.
///
/// Give either [`residual`](Element::residual), or any of
///
/// * the kinetic energy T(v, q, p), the potential energy V(q, p) and the strain energy U(q, p),
/// * strains e(q, p, t) with the energy W(e, p) stored in them, the damping stresses s(e, de/dt, p, t) and the dissipation D(e, de/dt, p),
/// * the non-conservative force Q(v, q, p, t),
///
/// from which R = d/dt (dT/dv) - dT/dq + d(V + U)/dq + (de/dq)^T (dW/de + s + dD/d(de/dt)) - Q is made. The formula is recorded, and all derivatives are made
/// of the recording: there is no method by which one could be supplied. What is linear, constant, sparse or not read is seen there, too.
///
/// Every list that a method writes to holds zeros before. Every physical number is a parameter in `p`; the element itself holds topology
/// and options only. Choices that depend on numbers go through [`Scalar::select`] and its kin.
///
/// Its hash tells it from all of its type of which other formulas would be recorded: what is recorded of one counts for all that have its hash.
/// `#[derive(Hash)]` takes in all fields; by hand, leave out nothing that a formula, a parameter or a node depends on.
pub trait Element: Hash + Send + Sync + 'static {
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Kinds of its nodes, in the order in which their coordinates stand: a model is checked against them.
    fn nodes(&self) -> Vec<NodeKind>;
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// The residual R(a, v, q, p, t), inertia + internal - applied, into `r`; left out where the other methods give it.
    fn residual<S: Scalar>(&self, _s: State<S>, _p: &[S], _t: S, _r: &mut [S]) {
        S::from_energies();
    }
    /// Kinetic energy T(v, q, p) \[J\].
    fn kinetic<S: Scalar>(&self, _v: &[S], _q: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Potential energy V(q, p) \[J\] that no strain stores: that of weight and other loads.
    fn potential<S: Scalar>(&self, _q: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Strain energy U(q, p) \[J\], where it is not [`stored`](Element::stored) in strains that are given.
    fn strain_energy<S: Scalar>(&self, _q: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// The generalized non-conservative force Q(v, q, p, t), into `force`.
    fn add_force<S: Scalar>(&self, _v: &[S], _q: &[S], _p: &[S], _t: S, _force: &mut [S]) {}
    /// Number of strains.
    fn strain_count(&self) -> usize {
        0
    }
    /// Strains e(q, p, t), into `e`.
    fn strains<S: Scalar>(&self, _q: &[S], _p: &[S], _t: S, _e: &mut [S]) {}
    /// Energy W(e, p) that is stored in the strains \[J\]; if these depend on time, the element does work of its own.
    fn stored<S: Scalar>(&self, _e: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Damping stresses s(e, de/dt, p, t), conjugate to the strains, into `s`.
    fn damping<S: Scalar>(&self, _e: &[S], _rate: &[S], _p: &[S], _t: S, _s: &mut [S]) {}
    /// Rayleigh's dissipation function D(e, de/dt, p) \[W\], whose derivative towards the strain rates is a damping stress: half the lost
    /// power where it is of second degree in them.
    fn dissipation<S: Scalar>(&self, _e: &[S], _rate: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// What histories tell of it: of each strain the strain, its rate and its stress, all that is stored and lost together, then what
    /// [`write_outputs`](Element::write_outputs) gives. They are computed where histories are written, and nowhere else.
    fn outputs(&self) -> Vec<Output> {
        Vec::new()
    }
    /// The outputs behind those of strains, into `outputs`.
    fn write_outputs<S: Scalar>(&self, _v: &[S], _q: &[S], _p: &[S], _t: S, _outputs: &mut [S]) {}
    /// Mass \[kg\].
    fn mass<S: Scalar>(&self, _p: &[S]) -> S {
        S::zero()
    }
    /// The residual of an element with a node map, in stages; of [`Flexible`](super::Flexible) alone.
    #[doc(hidden)]
    fn in_stages(&self, _s: State<Recorded>, _p: &[Recorded], _t: Recorded) -> Option<(Vec<Recorded>, Stages<Recorded>)> {
        None
    }
}
