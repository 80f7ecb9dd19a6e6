use super::{Element, NodeKind, Parameter, State};
use crate::scalar::Scalar;
use smallvec::SmallVec;
use std::ops::Range;

/// One interpolated number of a point: sum over the nodes of a constant weight times one of their coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolation {
    /// Which coordinate of each node.
    pub component: usize,
    /// One weight for each node: values or derivatives of shape functions.
    pub weights: &'static [f64],
}

/// A flexible element, written as formulas at points of interpolated fields: the finer contract of an [`Element`].
///
/// With h = W q, hdot = W v, hddot = W a, where W is constant and all nodes have the same coordinates, the element is a sum over points
/// of energies T(hdot, h, p), V(h, p), strains e(h, p) with the energy stored in them and their damping, and forces Q(hdot, h, p, t); or of
/// residuals that are written out. Methods are those of [`Element`], at a point; every list that one writes to holds zeros before.
pub trait Field: Send + Sync + 'static {
    /// Number of nodes.
    const NODES: usize;
    /// Kind of all its nodes.
    const NODE: NodeKind;
    /// Interpolated numbers of each point.
    const POINTS: &'static [&'static [Interpolation]];

    /// Parameters of the element; points may share them.
    fn parameters(&self) -> Vec<Parameter>;
    /// Which of them a point sees.
    fn parameters_of(&self, point: usize) -> Range<usize>;
    /// Kinetic energy of a point \[J\].
    fn kinetic<S: Scalar>(&self, _point: usize, _v: &[S], _h: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Potential energy of a point \[J\].
    fn potential<S: Scalar>(&self, _point: usize, _h: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// The non-conservative force of a point, conjugate to h, into `force`.
    fn add_force<S: Scalar>(&self, _point: usize, _v: &[S], _h: &[S], _p: &[S], _t: S, _force: &mut [S]) {}
    /// Number of strains of a point.
    fn strain_count(&self, _point: usize) -> usize {
        0
    }
    /// Strains of a point, into `e`.
    fn strains<S: Scalar>(&self, _point: usize, _h: &[S], _p: &[S], _e: &mut [S]) {}
    /// Energy that is stored in the strains of a point \[J\].
    fn stored<S: Scalar>(&self, _point: usize, _e: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Damping stresses of a point, conjugate to its strains, into `s`.
    fn damping<S: Scalar>(&self, _point: usize, _e: &[S], _rate: &[S], _p: &[S], _s: &mut [S]) {}
    /// The residual of a point, conjugate to h, into `r`; left out where the other methods give it.
    fn residual<S: Scalar>(&self, _point: usize, _s: State<S>, _p: &[S], _t: S, _r: &mut [S]) {
        S::from_energies();
    }
    /// Mass \[kg\].
    fn mass<S: Scalar>(&self, _p: &[S]) -> S {
        S::zero()
    }
    /// Times at which a load jumps.
    fn breakpoints(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }
}

/// The element that a [`Field`] makes.
pub struct Flexible<F>(pub F);

/// Numbers of one point: on the stack.
type Few<S> = SmallVec<[S; 12]>;

/// W x.
fn interpolate<F: Field, S: Scalar>(rows: &[Interpolation], x: &[S]) -> Few<S> {
    let number = |row: &Interpolation| {
        let mut sum = x[row.component] * row.weights[0];
        for node in 1..F::NODES {
            sum += x[node * F::NODE.dofs() + row.component] * row.weights[node];
        }
        sum
    };
    rows.iter().map(number).collect()
}

/// x += W^T h.
fn distribute<F: Field, S: Scalar>(rows: &[Interpolation], h: &[S], x: &mut [S]) {
    for (row, &h) in rows.iter().zip(h) {
        for node in 0..F::NODES {
            x[node * F::NODE.dofs() + row.component] += h * row.weights[node];
        }
    }
}

impl<F: Field> Flexible<F> {
    /// Calls `f(point, its rows, its strains among those of all points)`.
    fn for_each_point(&self, mut f: impl FnMut(usize, &'static [Interpolation], Range<usize>)) {
        let mut first = 0;
        for (point, rows) in F::POINTS.iter().enumerate() {
            let next = first + self.0.strain_count(point);
            f(point, rows, first..next);
            first = next;
        }
    }
}

impl<F: Field> Element for Flexible<F> {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![F::NODE; F::NODES]
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let mut total = S::zero();
        self.for_each_point(|point, rows, _| {
            let (rates, h) = (interpolate::<F, S>(rows, v), interpolate::<F, S>(rows, q));
            total += self.0.kinetic(point, &rates, &h, &p[self.0.parameters_of(point)]);
        });
        total
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let mut total = S::zero();
        self.for_each_point(|point, rows, _| {
            total += self.0.potential(point, &interpolate::<F, S>(rows, q), &p[self.0.parameters_of(point)]);
        });
        total
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        self.for_each_point(|point, rows, _| {
            let (rates, h) = (interpolate::<F, S>(rows, v), interpolate::<F, S>(rows, q));
            let mut own: Few<S> = SmallVec::from_elem(S::zero(), rows.len());
            self.0.add_force(point, &rates, &h, &p[self.0.parameters_of(point)], t, &mut own);
            distribute::<F, S>(rows, &own, force);
        });
    }
    fn strain_count(&self) -> usize {
        (0..F::POINTS.len()).map(|point| self.0.strain_count(point)).sum()
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        self.for_each_point(|point, rows, own| {
            if !own.is_empty() {
                self.0.strains(point, &interpolate::<F, S>(rows, q), &p[self.0.parameters_of(point)], &mut e[own]);
            }
        });
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let mut total = S::zero();
        self.for_each_point(|point, _, own| total += self.0.stored(point, &e[own], &p[self.0.parameters_of(point)]));
        total
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        self.for_each_point(|point, _, own| {
            self.0.damping(point, &e[own.clone()], &rate[own.clone()], &p[self.0.parameters_of(point)], &mut s[own]);
        });
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        self.for_each_point(|point, rows, _| {
            let [a, v, q] = [s.a, s.v, s.q].map(|x| interpolate::<F, S>(rows, x));
            let mut own: Few<S> = SmallVec::from_elem(S::zero(), rows.len());
            self.0.residual(point, State { a: &a, v: &v, q: &q }, &p[self.0.parameters_of(point)], t, &mut own);
            distribute::<F, S>(rows, &own, r);
        });
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        self.0.mass(p)
    }
    fn breakpoints(&self, p: &[f64]) -> Vec<f64> {
        self.0.breakpoints(p)
    }
}
