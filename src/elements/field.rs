use super::{Element, Parameter, State, lagrangian_residual};
use crate::scalar::{Job, LANES, Lanes, Scalar, widest};
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

/// The element that a [`Field`] makes.
pub struct Flexible<F>(pub F);

/// Numbers of one point: on the stack.
type Few<S> = SmallVec<[S; 12]>;

/// W x.
#[inline(always)]
fn interpolate<S: Scalar>(rows: &[Interpolation], components: usize, x: &[S], h: &mut Few<S>) {
    h.clear();
    for row in rows {
        let mut sum = x[row.component] * row.weights[0];
        for (node, &weight) in row.weights.iter().enumerate().skip(1) {
            sum += x[node * components + row.component] * weight;
        }
        h.push(sum);
    }
}

/// x += W^T h.
#[inline(always)]
fn distribute<S: Scalar>(rows: &[Interpolation], components: usize, h: &[S], x: &mut [S]) {
    for (row, &h) in rows.iter().zip(h) {
        for (node, &weight) in row.weights.iter().enumerate() {
            x[node * components + row.component] += h * weight;
        }
    }
}

impl<F: Field> Element for Flexible<F> {
    const DOFS: usize = F::NODES * F::COMPONENTS;
    const ENERGIES: bool = F::ENERGIES;

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
            interpolate(rows, F::COMPONENTS, v, &mut rates);
            interpolate(rows, F::COMPONENTS, q, &mut h);
            total += self.0.kinetic(point, &rates, &h, &p[self.0.parameters_of(point)]);
        }
        total
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let mut h = Few::new();
        let mut total = S::zero();
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate(rows, F::COMPONENTS, q, &mut h);
            total += self.0.potential(point, &h, &p[self.0.parameters_of(point)]);
        }
        total
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let (mut rates, mut h) = (Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate(rows, F::COMPONENTS, v, &mut rates);
            interpolate(rows, F::COMPONENTS, q, &mut h);
            let mut own: Few<S> = SmallVec::from_elem(S::zero(), rows.len());
            self.0.add_force(point, &rates, &h, &p[self.0.parameters_of(point)], t, &mut own);
            distribute(rows, F::COMPONENTS, &own, force);
        }
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let (mut a, mut v, mut q, mut own) = (Few::new(), Few::new(), Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            let reads = (0..rows.len()).map(|number| self.0.reads(point, number));
            let [in_a, in_v, in_q] = reads.fold([false; 3], |all, own| std::array::from_fn(|i| all[i] || own[i]));
            for (read, given, numbers) in [(in_a, s.a, &mut a), (in_v, s.v, &mut v), (in_q, s.q, &mut q)] {
                if read {
                    interpolate(rows, F::COMPONENTS, given, numbers);
                } else {
                    numbers.clear();
                    numbers.resize(rows.len(), S::zero());
                }
            }
            own.clear();
            own.resize(rows.len(), S::zero());
            self.0.residual(point, State { a: &a, v: &v, q: &q }, &p[self.0.parameters_of(point)], t, &mut own);
            distribute(rows, F::COMPONENTS, &own, r);
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

/// Derivatives of an element through its points.
pub trait ByPoints: Send + Sync {
    /// Adds gamma dR/da + beta dR/dv + alpha dR/dq, row-major, for `shift` = [gamma, beta, alpha].
    fn add_matrix(&self, s: State<f64>, shift: [f64; 3], p: &[f64], t: f64, work: &mut PointWork, matrix: &mut [f64]);
    /// Adds the gradients of lambda . R with respect to (a, v, q) and, if there is room for them, p, one row of `gradients` for each row
    /// of `lambdas`.
    fn pull_back(&self, s: State<f64>, p: &[f64], t: f64, lambdas: &[f64], work: &mut PointWork, gradients: &mut [f64]);
}

/// Numbers of one point after the other.
#[derive(Clone, Debug, Default)]
pub struct PointWork {
    real: [Few<f64>; 3],
    state: [Few<Lanes>; 3],
    p: Vec<Lanes>,
    r: Few<Lanes>,
    half: Vec<f64>,
    /// Places of the arguments that are read: which of (hddot, hdot, h, p), and its number there.
    read: Vec<(usize, usize)>,
    lambdas: Vec<f64>,
    gradients: Vec<f64>,
}

/// r of a point in lanes.
struct PointResidual<'j, F>(&'j F, usize, State<'j, Lanes>, &'j [Lanes], Lanes, &'j mut [Lanes]);

impl<F: Field> Job for PointResidual<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let PointResidual(field, point, s, p, t, r) = self;
        field.residual(point, s, p, t, r);
    }
}

impl PointWork {
    /// Loads the numbers of a point without derivatives.
    fn load<F: Field>(&mut self, rows: &[Interpolation], s: State<f64>, p: &[f64]) {
        for (given, (real, lanes)) in [s.a, s.v, s.q].into_iter().zip(self.real.iter_mut().zip(&mut self.state)) {
            interpolate(rows, F::COMPONENTS, given, real);
            lanes.clear();
            lanes.extend(real.iter().map(|&x| Lanes::constant(x)));
        }
        self.p.clear();
        self.p.extend(p.iter().map(|&p| Lanes::constant(p)));
    }

    fn evaluate<F: Field>(&mut self, field: &F, point: usize, t: f64) {
        let [a, v, q] = &self.state;
        self.r.clear();
        self.r.resize(q.len(), Lanes::default());
        widest(PointResidual(field, point, State { a, v, q }, &self.p, Lanes::from(t), &mut self.r));
    }
}

impl<F: Field> ByPoints for Flexible<F> {
    fn add_matrix(&self, s: State<f64>, shift: [f64; 3], p: &[f64], t: f64, work: &mut PointWork, matrix: &mut [f64]) {
        let n = Self::DOFS;
        for (point, rows) in F::POINTS.iter().enumerate() {
            let size = rows.len();
            let moved = |number: usize| {
                let read = self.0.reads(point, number);
                (0..3).any(|i| read[i] && shift[i] != 0.0)
            };
            work.load::<F>(rows, s, &p[self.0.parameters_of(point)]);
            // (dr/dh) W, row-major
            work.half.clear();
            work.half.resize(size * n, 0.0);
            let mut next = 0;
            while next < size {
                let mut columns: SmallVec<[usize; LANES]> = SmallVec::new();
                while next < size && columns.len() < LANES {
                    if moved(next) {
                        columns.push(next);
                    }
                    next += 1;
                }
                if columns.is_empty() {
                    continue;
                }
                for (numbers, factor) in work.state.iter_mut().zip(shift) {
                    columns.iter().enumerate().for_each(|(lane, &column)| numbers[column].eps[lane] = factor);
                }
                work.evaluate(&self.0, point, t);
                for (lane, &column) in columns.iter().enumerate() {
                    let Interpolation { component, weights } = rows[column];
                    for (row, r) in work.half.chunks_exact_mut(n).zip(&work.r) {
                        for (node, weight) in weights.iter().enumerate() {
                            row[node * F::COMPONENTS + component] += weight * r.eps[lane];
                        }
                    }
                    work.state.iter_mut().for_each(|numbers| numbers[column].eps[lane] = 0.0);
                }
            }
            for (row, half) in rows.iter().zip(work.half.chunks_exact(n)) {
                for (node, &weight) in row.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                    let place = node * F::COMPONENTS + row.component;
                    matrix[place * n..(place + 1) * n].iter_mut().zip(half).for_each(|(sum, half)| *sum += weight * half);
                }
            }
        }
    }

    fn pull_back(&self, s: State<f64>, p: &[f64], t: f64, lambdas: &[f64], work: &mut PointWork, gradients: &mut [f64]) {
        let n = Self::DOFS;
        let count = lambdas.len() / n;
        let variables = gradients.len() / count;
        for (point, rows) in F::POINTS.iter().enumerate() {
            let size = rows.len();
            let own = self.0.parameters_of(point);
            work.load::<F>(rows, s, &p[own.clone()]);
            work.lambdas.clear();
            let mut h = Few::new();
            for lambda in lambdas.chunks_exact(n) {
                interpolate(rows, F::COMPONENTS, lambda, &mut h);
                work.lambdas.extend_from_slice(&h);
            }
            work.read.clear();
            for kind in 0..3 {
                work.read.extend((0..size).filter(|&number| self.0.reads(point, number)[kind]).map(|number| (kind, number)));
            }
            if variables > 3 * n {
                work.read.extend((0..own.len()).map(|number| (3, number)));
            }
            let read = std::mem::take(&mut work.read);
            work.gradients.clear();
            work.gradients.resize(3 * size * count, 0.0);
            for group in read.chunks(LANES) {
                for (lane, &(kind, number)) in group.iter().enumerate() {
                    let argument = if kind < 3 { &mut work.state[kind][number] } else { &mut work.p[number] };
                    argument.eps[lane] = 1.0;
                }
                work.evaluate(&self.0, point, t);
                for (k, lambda) in work.lambdas.chunks_exact(size).enumerate() {
                    let mut sums = [0.0; LANES];
                    for (r, weight) in work.r.iter().zip(lambda) {
                        sums.iter_mut().zip(r.eps).for_each(|(sum, r)| *sum += weight * r);
                    }
                    for (&(kind, number), sum) in group.iter().zip(sums) {
                        if kind < 3 {
                            work.gradients[(3 * k + kind) * size + number] += sum;
                        } else {
                            gradients[k * variables + 3 * n + own.start + number] += sum;
                        }
                    }
                }
                for (lane, &(kind, number)) in group.iter().enumerate() {
                    let argument = if kind < 3 { &mut work.state[kind][number] } else { &mut work.p[number] };
                    argument.eps[lane] = 0.0;
                }
            }
            work.read = read;
            for (k, gradient) in gradients.chunks_exact_mut(variables).enumerate() {
                for kind in 0..3 {
                    let at_point = &work.gradients[(3 * k + kind) * size..][..size];
                    distribute(rows, F::COMPONENTS, at_point, &mut gradient[kind * n..(kind + 1) * n]);
                }
            }
        }
    }
}
