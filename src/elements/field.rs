use super::{ByPoints, Element, Parameter, State, Wide, lagrangian_momentum_rate, lagrangian_residual};
use crate::scalar::{Job, Scalar};
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
/// With h = W q, hdot = W v, hddot = W a, where W is constant and all nodes have the same coordinates, the element is a sum over points,
///
/// R(a, v, q, p, t) = sum W^T r(hddot, hdot, h, p, t),
///
/// where r follows from energies T(hdot, h, p), V(h, p) and forces of the point, or is written out. The framework differentiates
/// r along its few arguments only, and brings the result to the nodes by W: the matrix is sum W^T (dr/dh) W.
pub trait Field: Send + Sync + 'static {
    /// Number of nodes.
    const NODES: usize;
    /// Number of coordinates of each node.
    const COMPONENTS: usize;
    /// Interpolated numbers of each point.
    const POINTS: &'static [&'static [Interpolation]];
    /// True if the energies of all points hold all its energy.
    const ENERGIES: bool = false;
    /// True if the mass matrix depends on parameters alone, or there is none.
    const CONSTANT_MASS: bool = false;

    /// Parameters of the element; points may share them.
    fn parameters(&self) -> Vec<Parameter>;
    /// Which of them a point sees.
    fn parameters_of(&self, point: usize) -> Range<usize>;
    /// Whether r of a point depends on (hddot, hdot, h) of an interpolated number; what is not read is not differentiated.
    fn reads(&self, _point: usize, _number: usize) -> [bool; 3] {
        [true; 3]
    }
    /// Kinetic energy of a point [J].
    fn kinetic<S: Scalar>(&self, _point: usize, _v: &[S], _h: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Potential energy of a point [J].
    fn potential<S: Scalar>(&self, _point: usize, _h: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Adds the non-conservative force of a point, conjugate to h.
    fn add_force<S: Scalar>(&self, _point: usize, _v: &[S], _h: &[S], _p: &[S], _t: S, _force: &mut [S]) {}
    /// Adds r of a point.
    fn residual<S: Scalar>(&self, point: usize, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        lagrangian_residual(&AtPoint { field: self, point }, s, p, t, r);
    }
    /// Adds (dP/dh) hdot of a point with P = dT/dhdot, as [`Element::momentum_rate`].
    fn momentum_rate<S: Scalar>(&self, point: usize, v: &[S], h: &[S], p: &[S], r: &mut [S]) {
        point_momentum_rate(self, point, v, h, p, r);
    }
    /// Adds gamma dr/da + beta dr/dv + alpha dr/dq of a point for `shift` = [gamma, beta, alpha], column after column, and says true; or says
    /// false, and r is differentiated.
    ///
    /// A column has [`wide`] vectors for each list of weights that the point's numbers have, in the order in which the lists first come; there
    /// each row is at its component, so that whole vectors go to the nodes. What is between stays zero.
    ///
    /// Not needed: an element of which scenes have hundreds may write it out; the contract tests then hold it against r.
    fn add_matrix(&self, _point: usize, _s: State<f64>, _shift: [f64; 3], _p: &[f64], _matrix: &mut [Wide]) -> bool {
        false
    }
    /// Adds the gradient of lambda . r of a point, and says true; or says false, and r is differentiated.
    ///
    /// Not needed, as [`add_matrix`](Field::add_matrix).
    fn add_products(&self, _point: usize, _s: State<f64>, _p: &[f64], _lambda: &[f64], _into: &mut PointGradient) -> bool {
        false
    }
    /// True if r of every point is linear in (hddot, hdot, h) with constant coefficients.
    fn is_linear(&self) -> bool {
        false
    }
    /// Mass [kg].
    fn mass<S: Scalar>(&self, _p: &[S]) -> S {
        S::zero()
    }
    /// Times at which a load jumps.
    fn kinks(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }
}

/// Where the gradient of lambda . r of a point goes.
pub struct PointGradient<'g> {
    /// Towards (hddot, hdot, h).
    pub state: [&'g mut [f64]; 3],
    /// Towards the parameters that the point sees; empty where they are not asked for.
    pub p: &'g mut [f64],
}

/// One point as an element whose coordinates are the interpolated numbers.
struct AtPoint<'f, F: ?Sized> {
    field: &'f F,
    point: usize,
}

impl<F: Field + ?Sized> super::Energies for AtPoint<'_, F> {
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        self.field.kinetic(self.point, v, q, p)
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        self.field.potential(self.point, q, p)
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        self.field.add_force(self.point, v, q, p, t, force);
    }
}

/// (dP/dh) hdot of a point, from its kinetic energy.
pub(crate) fn point_momentum_rate<F: Field + ?Sized, S: Scalar>(
    field: &F,
    point: usize,
    v: &[S],
    h: &[S],
    p: &[S],
    r: &mut [S],
) {
    lagrangian_momentum_rate(&AtPoint { field, point }, v, h, p, r);
}

/// The element that a [`Field`] makes.
pub struct Flexible<F>(pub F);

/// Numbers of one point: on the stack.
pub(super) type Few<S> = SmallVec<[S; 12]>;

/// Room for some numbers; those that are there are left.
#[inline(always)]
fn fit<S: Scalar>(numbers: &mut Few<S>, count: usize) {
    if numbers.len() != count {
        numbers.resize(count, S::zero());
    }
}

/// W x.
#[inline(always)]
fn interpolate<F: Field, S: Scalar>(rows: &[Interpolation], x: &[S], h: &mut Few<S>) {
    fit(h, rows.len());
    for (h, row) in h.iter_mut().zip(rows) {
        let weights = &row.weights[..F::NODES];
        let mut sum = x[row.component] * weights[0];
        for node in 1..F::NODES {
            sum += x[node * F::COMPONENTS + row.component] * weights[node];
        }
        *h = sum;
    }
}

/// W x where it is read; numbers of any value otherwise.
#[inline(always)]
fn interpolate_if<F: Field, S: Scalar>(read: bool, rows: &[Interpolation], x: &[S], h: &mut Few<S>) {
    if read {
        interpolate::<F, S>(rows, x, h);
    } else {
        fit(h, rows.len());
    }
}

impl<F: Field> Flexible<F> {
    /// Which of (hddot, hdot, h) a point reads at all.
    #[inline(always)]
    pub(super) fn read_at(&self, point: usize) -> [bool; 3] {
        let mut any = [false; 3];
        for number in 0..F::POINTS[point].len() {
            let own = self.0.reads(point, number);
            for kind in 0..3 {
                any[kind] |= own[kind];
            }
        }
        any
    }
}

/// x += W^T h.
#[inline(always)]
pub(super) fn distribute<F: Field, S: Scalar>(rows: &[Interpolation], h: &[S], x: &mut [S]) {
    for (row, &h) in rows.iter().zip(h) {
        let weights = &row.weights[..F::NODES];
        for node in 0..F::NODES {
            x[node * F::COMPONENTS + row.component] += h * weights[node];
        }
    }
}

impl<F: Field> Element for Flexible<F> {
    const DOFS: usize = F::NODES * F::COMPONENTS;
    const ENERGIES: bool = F::ENERGIES;
    const CONSTANT_MASS: bool = F::CONSTANT_MASS;

    fn is_linear(&self) -> bool {
        self.0.is_linear()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let (mut rates, mut h) = (Few::new(), Few::new());
        let mut total = S::zero();
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate::<F, S>(rows, v, &mut rates);
            interpolate::<F, S>(rows, q, &mut h);
            total += self.0.kinetic(point, &rates, &h, &p[self.0.parameters_of(point)]);
        }
        total
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let mut h = Few::new();
        let mut total = S::zero();
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate::<F, S>(rows, q, &mut h);
            total += self.0.potential(point, &h, &p[self.0.parameters_of(point)]);
        }
        total
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let (mut rates, mut h) = (Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate::<F, S>(rows, v, &mut rates);
            interpolate::<F, S>(rows, q, &mut h);
            let mut own: Few<S> = SmallVec::from_elem(S::zero(), rows.len());
            self.0.add_force(point, &rates, &h, &p[self.0.parameters_of(point)], t, &mut own);
            distribute::<F, S>(rows, &own, force);
        }
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let (mut a, mut v, mut q, mut own) = (Few::new(), Few::new(), Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            let [in_a, in_v, in_q] = self.read_at(point);
            interpolate_if::<F, S>(in_a, rows, s.a, &mut a);
            interpolate_if::<F, S>(in_v, rows, s.v, &mut v);
            interpolate_if::<F, S>(in_q, rows, s.q, &mut q);
            fit(&mut own, rows.len());
            own.fill(S::zero());
            let here = State { a: &a, v: &v, q: &q };
            add_point_residual(&self.0, point, here, &p[self.0.parameters_of(point)], t, &mut own);
            distribute::<F, S>(rows, &own, r);
        }
    }
    fn momentum_rate<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], r: &mut [S]) {
        let (mut rates, mut h, mut own) = (Few::new(), Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate::<F, S>(rows, v, &mut rates);
            interpolate::<F, S>(rows, q, &mut h);
            fit(&mut own, rows.len());
            own.fill(S::zero());
            self.0.momentum_rate(point, &rates, &h, &p[self.0.parameters_of(point)], &mut own);
            distribute::<F, S>(rows, &own, r);
        }
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        self.0.mass(p)
    }
    fn kinks(&self, p: &[f64]) -> Vec<f64> {
        self.0.kinks(p)
    }
    fn by_points(&self) -> Option<&dyn ByPoints> {
        Some(self)
    }
}

/// r of a point to be evaluated.
struct PointResidual<'j, F, S>(&'j F, usize, State<'j, S>, &'j [S], S, &'j mut [S]);

impl<F: Field, S: Scalar> Job for PointResidual<'_, F, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let PointResidual(field, point, s, p, t, r) = self;
        field.residual(point, s, p, t, r);
    }
}

/// Adds r of a point: the one place where its formulas are compiled for a number type, as a hundred numbers with lanes between
/// them take the compiler minutes.
#[inline(never)]
pub(super) fn add_point_residual<F: Field, S: Scalar>(field: &F, point: usize, s: State<S>, p: &[S], t: S, r: &mut [S]) {
    S::run(PointResidual(field, point, s, p, t, r));
}
