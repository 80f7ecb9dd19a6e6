//! Derivatives of an element through its points: few arguments each, in whole vectors.

use super::field::{Few, add_point_residual, distribute};
use super::{Element, Field, Flexible, Interpolation, PointGradient, State};
use crate::scalar::{Job, LANES, Lanes, widest};

/// Eight numbers in one line of the cache, for whole vectors; those that are not used are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct Wide(pub [f64; 8]);

/// Number of wide vectors for some numbers.
pub const fn wide(count: usize) -> usize {
    count.div_ceil(8)
}

impl Wide {
    /// Adds factor x.
    #[inline(always)]
    pub fn add(&mut self, factor: f64, x: &Wide) {
        let mut sum = *self;
        for i in 0..8 {
            sum.0[i] += factor * x.0[i];
        }
        *self = sum;
    }
    /// factor x.
    #[inline(always)]
    pub fn times(mut self, factor: f64) -> Self {
        for i in 0..8 {
            self.0[i] *= factor;
        }
        self
    }
}

/// Points of a field at most.
const POINTS: usize = 32;
/// Numbers of a point at most.
const NUMBERS: usize = 32;
/// Wide vectors at most: of a point's numbers by weights, and of all nodes.
const VECTORS: usize = 16;

/// Numbers of a point by weights: those with the same ones stand together, each at its component, in whole vectors.
#[derive(Clone, Copy)]
struct Groups {
    count: usize,
    weights: [&'static [f64]; VECTORS],
    /// Where each number stands: vector and place in it.
    places: [(usize, usize); NUMBERS],
}

impl Groups {
    const NONE: Groups = Groups { count: 0, weights: [&[]; VECTORS], places: [(0, 0); NUMBERS] };

    /// For nodes with some number of vectors.
    const fn of(rows: &[Interpolation], own: usize) -> Self {
        let mut groups = Self::NONE;
        let mut number = 0;
        while number < rows.len() {
            let Interpolation { component, weights } = rows[number];
            let mut group = 0;
            while group < groups.count {
                let (mut fits, mut other) = (same(groups.weights[group], weights), 0);
                while other < number {
                    let (vector, place) = groups.places[other];
                    fits = fits && (vector != group * own + component / 8 || place != component % 8);
                    other += 1;
                }
                if fits {
                    break;
                }
                group += 1;
            }
            groups.weights[group] = weights;
            groups.places[number] = (group * own + component / 8, component % 8);
            if group == groups.count {
                groups.count += 1;
            }
            number += 1;
        }
        assert!(groups.count * own <= VECTORS, "a point has numbers of too many different weights: raise VECTORS");
        groups
    }
}

/// a = b, number by number.
const fn same(a: &[f64], b: &[f64]) -> bool {
    let (mut all, mut i) = (a.len() == b.len(), 0);
    while all && i < a.len() {
        all = a[i] == b[i];
        i += 1;
    }
    all
}

impl<F: Field> Flexible<F> {
    /// Vectors of a node, and of a column of the matrix.
    const OWN: usize = wide(F::COMPONENTS);
    const COLUMN: usize = F::NODES * Self::OWN;
    /// Numbers of each point by weights.
    const GROUPS: &'static [Groups; POINTS] = &{
        assert!(
            Self::COLUMN <= VECTORS && F::POINTS.len() <= POINTS,
            "too many coordinates or points: raise VECTORS or POINTS"
        );
        let mut groups = [Groups::NONE; POINTS];
        let mut point = 0;
        while point < F::POINTS.len() {
            groups[point] = Groups::of(F::POINTS[point], Self::OWN);
            point += 1;
        }
        groups
    };
}

/// Derivatives of an element through its points, or written out.
pub trait ByPoints: Send + Sync {
    /// gamma dR/da + beta dR/dv + alpha dR/dq for `shift` = [gamma, beta, alpha], column after column, in each [`wide`] vectors for
    /// every node; behind its coordinates are zeros.
    fn matrix<'w>(&self, s: State<f64>, shift: [f64; 3], p: &[f64], t: f64, work: &'w mut PointWork) -> &'w [Wide];
    /// Adds the gradients of lambda . R with respect to (a, v, q) and, if there is room for them, p, one row of `gradients` for each row
    /// of `lambdas`.
    fn pull_back(&self, s: State<f64>, p: &[f64], t: f64, lambdas: &[f64], work: &mut PointWork, gradients: &mut [f64]);
}

/// Numbers of one point after the other.
#[derive(Clone, Debug, Default)]
pub struct PointWork {
    /// (a, v, q), each node in whole vectors.
    given: [Vec<Wide>; 3],
    /// (hddot, hdot, h) of the point.
    real: [[f64; NUMBERS]; 3],
    /// dr/dh as [`Field::add_matrix`] adds it.
    own: Vec<Wide>,
    state: [Few<Lanes>; 3],
    p: Vec<Lanes>,
    r: Few<Lanes>,
    /// W^T dr/dh W of all points.
    matrix: Vec<Wide>,
    /// Places of the arguments that are read: which of (hddot, hdot, h, p), and its number there.
    read: Vec<(usize, usize)>,
    lambdas: Vec<f64>,
    gradients: Vec<f64>,
}

impl PointWork {
    /// Room for a matrix of some vectors, all zero.
    pub(crate) fn zeros(&mut self, count: usize) -> &mut [Wide] {
        clear(&mut self.matrix, count);
        &mut self.matrix
    }

    /// Takes over (a, v, q) as far as they are read.
    #[inline(always)]
    fn take_over<F: Field>(&mut self, element: &Flexible<F>, given: [&[f64]; 3]) {
        let mut read = [false; 3];
        for point in 0..F::POINTS.len() {
            let here = element.read_at(point);
            (0..3).for_each(|kind| read[kind] |= here[kind]);
        }
        for kind in 0..3 {
            if read[kind] {
                spread(F::COMPONENTS, given[kind], &mut self.given[kind]);
            }
        }
    }

    /// Interpolates what a point reads.
    #[inline(always)]
    fn interpolate<F: Field>(&mut self, groups: &Groups, size: usize, read: [bool; 3]) {
        for kind in 0..3 {
            if read[kind] {
                gather::<F>(groups, &self.given[kind], &mut self.real[kind][..size]);
            }
        }
    }

    /// Takes over what was interpolated, without derivatives.
    #[inline(always)]
    fn load(&mut self, size: usize, read: [bool; 3], p: &[f64]) {
        for kind in 0..3 {
            let (lanes, real) = (&mut self.state[kind], &self.real[kind][..size]);
            if read[kind] || lanes.len() != size {
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
        let size = F::POINTS[point].len();
        let [a, v, q] = &self.real;
        clear(&mut self.own, size * Flexible::<F>::GROUPS[point].count * Flexible::<F>::OWN);
        field.add_matrix(point, State { a: &a[..size], v: &v[..size], q: &q[..size] }, shift, p, &mut self.own)
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
        let column = Flexible::<F>::COLUMN;
        clear(&mut work.matrix, Flexible::<F>::DOFS * column);
        work.take_over(element, [s.a, s.v, s.q]);
        for (point, rows) in F::POINTS.iter().enumerate() {
            let size = rows.len();
            let read = element.read_at(point);
            let groups = &Flexible::<F>::GROUPS[point];
            work.interpolate::<F>(groups, size, read);
            let p = &p[element.0.parameters_of(point)];
            let mut next = if work.written(&element.0, point, shift, p) { size } else { 0 };
            if next < size {
                work.load(size, read, p);
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
                    let own = &mut work.own[column * groups.count * Flexible::<F>::OWN..];
                    for (&(vector, place), r) in groups.places.iter().zip(&work.r) {
                        own[vector].0[place] = r.eps[lane];
                    }
                    for kind in 0..3 {
                        work.seed((kind, column), lane, 0.0);
                    }
                }
            }
            let PointWork { own, matrix, .. } = &mut *work;
            match groups.count {
                1 => distribute_columns::<F, 1>(rows, groups, own, matrix),
                2 => distribute_columns::<F, 2>(rows, groups, own, matrix),
                _ => distribute_columns::<F, VECTORS>(rows, groups, own, matrix),
            }
        }
    }
}

/// target += W^T own W of a point with at most COUNT lists of weights.
#[inline(always)]
fn distribute_columns<F: Field, const COUNT: usize>(
    rows: &[Interpolation],
    groups: &Groups,
    own: &[Wide],
    target: &mut [Wide],
) {
    let (vectors, column) = (Flexible::<F>::OWN, Flexible::<F>::COLUMN);
    for (row, own) in rows.iter().zip(own.chunks_exact(groups.count * vectors)) {
        // W^T times a column
        let mut half = [Wide::default(); VECTORS];
        for (group, weights) in groups.weights.iter().enumerate().take(COUNT.min(groups.count)) {
            for node in 0..F::NODES {
                for i in 0..vectors {
                    half[node * vectors + i].add(weights[node], &own[group * vectors + i]);
                }
            }
        }
        for node in 0..F::NODES {
            let target = &mut target[(node * F::COMPONENTS + row.component) * column..][..column];
            for (target, half) in target.iter_mut().zip(&half) {
                target.add(row.weights[node], half);
            }
        }
    }
}

/// Each node's coordinates in whole vectors.
#[inline(always)]
fn spread(components: usize, x: &[f64], vectors: &mut Vec<Wide>) {
    let own = wide(components);
    clear(vectors, x.len() / components * own);
    for (target, x) in vectors.chunks_exact_mut(own).zip(x.chunks_exact(components)) {
        for (i, &x) in x.iter().enumerate() {
            target[i / 8].0[i % 8] = x;
        }
    }
}

/// W x, x being spread.
#[inline(always)]
fn gather<F: Field>(groups: &Groups, x: &[Wide], h: &mut [f64]) {
    let own = Flexible::<F>::OWN;
    let mut sums = [Wide::default(); VECTORS];
    for (group, weights) in groups.weights.iter().enumerate().take(groups.count) {
        for node in 0..F::NODES {
            for i in 0..own {
                sums[group * own + i].add(weights[node], &x[node * own + i]);
            }
        }
    }
    for (h, &(vector, place)) in h.iter_mut().zip(&groups.places) {
        *h = sums[vector].0[place];
    }
}

/// Some vectors, all zero.
#[inline(always)]
fn clear(vectors: &mut Vec<Wide>, count: usize) {
    vectors.resize(count, Wide::default());
    vectors.fill(Wide::default());
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
        work.take_over(element, [s.a, s.v, s.q]);
        for (point, rows) in F::POINTS.iter().enumerate() {
            let size = rows.len();
            let groups = &Flexible::<F>::GROUPS[point];
            let own = element.0.parameters_of(point);
            let first = own.start;
            let read_here = element.read_at(point);
            work.lambdas.resize(size * count, 0.0);
            for (lambda, at_point) in lambdas.chunks_exact(n).zip(work.lambdas.chunks_exact_mut(size)) {
                spread(F::COMPONENTS, lambda, &mut work.own);
                gather::<F>(groups, &work.own, at_point);
            }
            work.interpolate::<F>(groups, size, read_here);
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
                let here = State { a: &real_a[..size], v: &real_v[..size], q: &real_q[..size] };
                let lambda = &work.lambdas[k * size..(k + 1) * size];
                element.0.add_products(point, here, &p[own.clone()], lambda, &mut into)
            });
            for kind in if written { 0..0 } else { 0..3 } {
                let mut unit = [0.0; 3];
                unit[kind] = 1.0;
                if read_here[kind] && work.written(&element.0, point, unit, &p[own.clone()]) {
                    for k in 0..count {
                        let target = &mut work.gradients[(3 * k + kind) * size..][..size];
                        for (target, column) in
                            target.iter_mut().zip(work.own.chunks_exact(groups.count * Flexible::<F>::OWN))
                        {
                            let entries = groups.places.iter().map(|&(vector, place)| column[vector].0[place]);
                            *target += entries.zip(&work.lambdas[k * size..(k + 1) * size]).map(|(e, l)| e * l).sum::<f64>();
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
                work.load(size, read_here, &p[own]);
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
                    distribute::<F, f64>(rows, at_point, &mut gradient[kind * n..(kind + 1) * n]);
                }
            }
        }
    }
}

impl<F: Field> ByPoints for Flexible<F> {
    fn matrix<'w>(&self, s: State<f64>, shift: [f64; 3], p: &[f64], t: f64, work: &'w mut PointWork) -> &'w [Wide] {
        widest(Matrix(self, s, shift, p, t, work));
        &work.matrix
    }
    fn pull_back(&self, s: State<f64>, p: &[f64], t: f64, lambdas: &[f64], work: &mut PointWork, gradients: &mut [f64]) {
        widest(PullBack(self, s, p, t, lambdas, work, gradients));
    }
}
