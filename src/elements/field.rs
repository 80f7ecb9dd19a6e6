use super::{Element, Parameter, State, lagrangian_momentum_rate, lagrangian_residual};
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
    /// Adds gamma dr/da + beta dr/dv + alpha dr/dq of a point for `shift` = [gamma, beta, alpha], row-major, and says true; or says false, and r is
    /// differentiated.
    ///
    /// Not needed: an element of which scenes have hundreds may write it out; the contract tests then hold it against r.
    fn add_matrix(&self, _point: usize, _s: State<f64>, _shift: [f64; 3], _p: &[f64], _matrix: &mut [f64]) -> bool {
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
type Few<S> = SmallVec<[S; 12]>;

/// Room for some numbers; those that are there are left.
#[inline(always)]
fn fit<S: Scalar>(numbers: &mut Few<S>, count: usize) {
    if numbers.len() != count {
        numbers.resize(count, S::zero());
    }
}

/// W x.
#[inline(always)]
fn interpolate<S: Scalar>(rows: &[Interpolation], components: usize, x: &[S], h: &mut Few<S>) {
    fit(h, rows.len());
    for (h, row) in h.iter_mut().zip(rows) {
        let mut sum = x[row.component] * row.weights[0];
        for (node, &weight) in row.weights.iter().enumerate().skip(1) {
            sum += x[node * components + row.component] * weight;
        }
        *h = sum;
    }
}

/// W x where it is read; numbers of any value otherwise.
#[inline(always)]
fn interpolate_if<S: Scalar>(read: bool, rows: &[Interpolation], components: usize, x: &[S], h: &mut Few<S>) {
    if read {
        interpolate(rows, components, x, h);
    } else {
        fit(h, rows.len());
    }
}

impl<F: Field> Flexible<F> {
    /// Which of (hddot, hdot, h) a point reads at all.
    #[inline(always)]
    fn read_at(&self, point: usize) -> [bool; 3] {
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
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let (mut a, mut v, mut q, mut own) = (Few::new(), Few::new(), Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            let [in_a, in_v, in_q] = self.read_at(point);
            interpolate_if(in_a, rows, F::COMPONENTS, s.a, &mut a);
            interpolate_if(in_v, rows, F::COMPONENTS, s.v, &mut v);
            interpolate_if(in_q, rows, F::COMPONENTS, s.q, &mut q);
            fit(&mut own, rows.len());
            own.fill(S::zero());
            let here = State { a: &a, v: &v, q: &q };
            add_point_residual(&self.0, point, here, &p[self.0.parameters_of(point)], t, &mut own);
            distribute(rows, F::COMPONENTS, &own, r);
        }
    }
    fn momentum_rate<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], r: &mut [S]) {
        let (mut rates, mut h, mut own) = (Few::new(), Few::new(), Few::new());
        for (point, rows) in F::POINTS.iter().enumerate() {
            interpolate(rows, F::COMPONENTS, v, &mut rates);
            interpolate(rows, F::COMPONENTS, q, &mut h);
            fit(&mut own, rows.len());
            own.fill(S::zero());
            self.0.momentum_rate(point, &rates, &h, &p[self.0.parameters_of(point)], &mut own);
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

/// Derivatives of an element through its points, or written out.
pub trait ByPoints: Send + Sync {
    /// gamma dR/da + beta dR/dv + alpha dR/dq for `shift` = [gamma, beta, alpha], column after column, each with room for
    /// [`padded`] numbers of which the last ones are zero.
    fn matrix<'w>(&self, s: State<f64>, shift: [f64; 3], p: &[f64], t: f64, work: &'w mut PointWork) -> &'w [f64];
    /// Adds the gradients of lambda . R with respect to (a, v, q) and, if there is room for them, p, one row of `gradients` for each row
    /// of `lambdas`.
    fn pull_back(&self, s: State<f64>, p: &[f64], t: f64, lambdas: &[f64], work: &mut PointWork, gradients: &mut [f64]);
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
fn add_point_residual<F: Field, S: Scalar>(field: &F, point: usize, s: State<S>, p: &[S], t: S, r: &mut [S]) {
    S::run(PointResidual(field, point, s, p, t, r));
}

/// Numbers of one point after the other.
#[derive(Clone, Debug, Default)]
pub struct PointWork {
    real: [Few<f64>; 3],
    /// dr/dh, row-major.
    own: Vec<f64>,
    state: [Few<Lanes>; 3],
    p: Vec<Lanes>,
    r: Few<Lanes>,
    /// dr/dh with padded rows; W^T dr/dh, row-major, and column after column; W^T dr/dh W, column after column.
    even: Vec<f64>,
    half: Vec<f64>,
    turned: Vec<f64>,
    matrix: Vec<f64>,
    /// Places of the arguments that are read: which of (hddot, hdot, h, p), and its number there.
    read: Vec<(usize, usize)>,
    lambdas: Vec<f64>,
    gradients: Vec<f64>,
}

impl PointWork {
    /// Room for a matrix of some numbers, all zero.
    pub(crate) fn zeros(&mut self, count: usize) -> &mut [f64] {
        self.matrix.clear();
        self.matrix.resize(count, 0.0);
        &mut self.matrix
    }

    /// Interpolates what a point reads.
    #[inline(always)]
    fn interpolate(&mut self, rows: &[Interpolation], components: usize, given: [&[f64]; 3], read: [bool; 3]) {
        for kind in 0..3 {
            interpolate_if(read[kind], rows, components, given[kind], &mut self.real[kind]);
        }
    }

    /// Takes over what was interpolated, without derivatives.
    #[inline(always)]
    fn load(&mut self, read: [bool; 3], p: &[f64]) {
        for kind in 0..3 {
            let (lanes, real) = (&mut self.state[kind], &self.real[kind]);
            if read[kind] || lanes.len() != real.len() {
                lanes.clear();
                for &x in real {
                    lanes.push(Lanes::constant(x));
                }
            }
        }
        self.p.clear();
        for &p in p {
            self.p.push(Lanes::constant(p));
        }
    }

    /// r of a point, with derivatives along what is seeded.
    #[inline(always)]
    fn evaluate<F: Field>(&mut self, field: &F, point: usize, t: f64) {
        let [a, v, q] = &self.state;
        self.r.clear();
        self.r.resize(q.len(), Lanes::default());
        add_point_residual(field, point, State { a, v, q }, &self.p, Lanes::from(t), &mut self.r);
    }

    /// dr/dh along a shift, if the element writes it out.
    #[inline(always)]
    fn written<F: Field>(&mut self, field: &F, point: usize, shift: [f64; 3], p: &[f64]) -> bool {
        let [a, v, q] = &self.real;
        self.own.clear();
        self.own.resize(q.len() * q.len(), 0.0);
        field.add_matrix(point, State { a, v, q }, shift, p, &mut self.own)
    }

    /// Sets or takes back the derivative of an argument along a lane.
    #[inline(always)]
    fn seed(&mut self, (kind, number): (usize, usize), lane: usize, value: f64) {
        let argument = if kind < 3 { &mut self.state[kind][number] } else { &mut self.p[number] };
        argument.eps[lane] = value;
    }
}

/// The matrix of an element to be computed.
struct Matrix<'j, F>(&'j Flexible<F>, State<'j, f64>, [f64; 3], &'j [f64], f64, &'j mut PointWork);

impl<F: Field> Job for Matrix<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Matrix(element, s, shift, p, t, work) = self;
        let n = Flexible::<F>::DOFS;
        let column = padded(n);
        work.matrix.clear();
        work.matrix.resize(n * column, 0.0);
        for (point, rows) in F::POINTS.iter().enumerate() {
            let size = rows.len();
            let read = element.read_at(point);
            work.interpolate(rows, F::COMPONENTS, [s.a, s.v, s.q], read);
            let p = &p[element.0.parameters_of(point)];
            let mut next = if work.written(&element.0, point, shift, p) { size } else { 0 };
            if next < size {
                work.load(read, p);
            }
            while next < size {
                let mut columns = [0; LANES];
                let mut count = 0;
                while next < size && count < LANES {
                    let own = element.0.reads(point, next);
                    if (own[0] && shift[0] != 0.0) || (own[1] && shift[1] != 0.0) || (own[2] && shift[2] != 0.0) {
                        columns[count] = next;
                        count += 1;
                    }
                    next += 1;
                }
                if count == 0 {
                    continue;
                }
                for (lane, &column) in columns[..count].iter().enumerate() {
                    for kind in 0..3 {
                        work.seed((kind, column), lane, shift[kind]);
                    }
                }
                work.evaluate(&element.0, point, t);
                for (lane, &column) in columns[..count].iter().enumerate() {
                    for (row, r) in work.own.chunks_exact_mut(size).zip(&work.r) {
                        row[column] = r.eps[lane];
                    }
                    for kind in 0..3 {
                        work.seed((kind, column), lane, 0.0);
                    }
                }
            }
            let PointWork { own, even, half, turned, matrix, .. } = &mut *work;
            let row = padded(size);
            even.clear();
            even.resize(size * row, 0.0);
            for (even, own) in even.chunks_exact_mut(row).zip(own.chunks_exact(size)) {
                even[..size].copy_from_slice(own);
            }
            half.clear();
            half.resize(n * row, 0.0);
            add_scaled_rows(rows, F::COMPONENTS, even, row, half);
            turned.clear();
            turned.resize(size * column, 0.0);
            for (place, half) in half.chunks_exact(row).enumerate() {
                for (turned, value) in turned.chunks_exact_mut(column).zip(half) {
                    turned[place] = *value;
                }
            }
            add_scaled_rows(rows, F::COMPONENTS, turned, column, matrix);
        }
    }
}

/// Room for a row of some numbers: a multiple of eight, so that whole vectors are read and written.
pub const fn padded(count: usize) -> usize {
    count.next_multiple_of(8)
}

/// target += factor source for rows of [`padded`] numbers.
#[inline(always)]
pub fn add_scaled(factor: f64, source: &[f64], target: &mut [f64]) {
    /// Rows of W numbers.
    #[inline(always)]
    fn of<const W: usize>(factor: f64, source: &[f64], target: &mut [f64]) {
        if let (Some(source), Some(target)) = (source.first_chunk::<W>(), target.first_chunk_mut::<W>()) {
            for i in 0..W {
                target[i] += factor * source[i];
            }
        }
    }
    match source.len() {
        8 => of::<8>(factor, source, target),
        16 => of::<16>(factor, source, target),
        24 => of::<24>(factor, source, target),
        _ => target.iter_mut().zip(source).for_each(|(target, source)| *target += factor * source),
    }
}

/// target += W^T source for matrices with rows of some length: rows of numbers, and rows of coordinates.
#[inline(always)]
fn add_scaled_rows(rows: &[Interpolation], components: usize, source: &[f64], length: usize, target: &mut [f64]) {
    for (row, source) in rows.iter().zip(source.chunks_exact(length)) {
        for (node, &weight) in row.weights.iter().enumerate() {
            let place = (node * components + row.component) * length;
            add_scaled(weight, source, &mut target[place..place + length]);
        }
    }
}

/// Gradients of products to be added: lambdas, then gradients.
struct PullBack<'j, F>(&'j Flexible<F>, State<'j, f64>, &'j [f64], f64, &'j [f64], &'j mut PointWork, &'j mut [f64]);

impl<F: Field> Job for PullBack<'_, F> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let PullBack(element, s, p, t, lambdas, work, gradients) = self;
        let n = Flexible::<F>::DOFS;
        let count = lambdas.len() / n;
        let variables = gradients.len() / count;
        for (point, rows) in F::POINTS.iter().enumerate() {
            let size = rows.len();
            let own = element.0.parameters_of(point);
            let first = own.start;
            let read_here = element.read_at(point);
            let mut at_point = std::mem::take(&mut work.real[0]);
            work.lambdas.clear();
            for lambda in lambdas.chunks_exact(n) {
                interpolate(rows, F::COMPONENTS, lambda, &mut at_point);
                work.lambdas.extend_from_slice(&at_point);
            }
            work.real[0] = at_point;
            work.interpolate(rows, F::COMPONENTS, [s.a, s.v, s.q], read_here);
            work.gradients.clear();
            work.gradients.resize(3 * size * count, 0.0);
            let mut read = std::mem::take(&mut work.read);
            read.clear();
            let written = (0..count).all(|k| {
                let own_gradient = &mut work.gradients[3 * k * size..][..3 * size];
                let (a, rest) = own_gradient.split_at_mut(size);
                let (v, q) = rest.split_at_mut(size);
                let of_k = &mut gradients[k * variables + 3 * n..(k + 1) * variables];
                let p_bar = if of_k.is_empty() { of_k } else { &mut of_k[own.clone()] };
                let mut into = PointGradient { state: [a, v, q], p: p_bar };
                let [real_a, real_v, real_q] = &work.real;
                let here = State { a: real_a, v: real_v, q: real_q };
                let lambda = &work.lambdas[k * size..(k + 1) * size];
                element.0.add_products(point, here, &p[own.clone()], lambda, &mut into)
            });
            for kind in if written { 0..0 } else { 0..3 } {
                let mut unit = [0.0; 3];
                unit[kind] = 1.0;
                if read_here[kind] && work.written(&element.0, point, unit, &p[own.clone()]) {
                    for k in 0..count {
                        let target = &mut work.gradients[(3 * k + kind) * size..][..size];
                        for (row, weight) in work.own.chunks_exact(size).zip(&work.lambdas[k * size..]) {
                            for (target, entry) in target.iter_mut().zip(row) {
                                *target += weight * entry;
                            }
                        }
                    }
                    continue;
                }
                for number in 0..size {
                    if element.0.reads(point, number)[kind] {
                        read.push((kind, number));
                    }
                }
            }
            if variables > 3 * n && !written {
                for number in 0..own.len() {
                    read.push((3, number));
                }
            }
            if !read.is_empty() {
                work.load(read_here, &p[own]);
            }
            for group in read.chunks(LANES) {
                for (lane, &argument) in group.iter().enumerate() {
                    work.seed(argument, lane, 1.0);
                }
                work.evaluate(&element.0, point, t);
                for k in 0..count {
                    let mut sums = [0.0; LANES];
                    for (r, weight) in work.r.iter().zip(&work.lambdas[k * size..(k + 1) * size]) {
                        for lane in 0..LANES {
                            sums[lane] += weight * r.eps[lane];
                        }
                    }
                    for (&(kind, number), sum) in group.iter().zip(sums) {
                        if kind < 3 {
                            work.gradients[(3 * k + kind) * size + number] += sum;
                        } else {
                            gradients[k * variables + 3 * n + first + number] += sum;
                        }
                    }
                }
                for (lane, &argument) in group.iter().enumerate() {
                    work.seed(argument, lane, 0.0);
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

impl<F: Field> ByPoints for Flexible<F> {
    fn matrix<'w>(&self, s: State<f64>, shift: [f64; 3], p: &[f64], t: f64, work: &'w mut PointWork) -> &'w [f64] {
        widest(Matrix(self, s, shift, p, t, work));
        &work.matrix
    }
    fn pull_back(&self, s: State<f64>, p: &[f64], t: f64, lambdas: &[f64], work: &mut PointWork, gradients: &mut [f64]) {
        widest(PullBack(self, s, p, t, lambdas, work, gradients));
    }
}
