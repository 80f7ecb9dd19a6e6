use super::lagrangian::{Formulas, from_energies, paired};
use super::{Element, NodeKind, Parameter, State};
use crate::program::{Recorded, Stages, along_motion, gradient_of, is_from_energies};
use crate::scalar::{Moving, Scalar};
use smallvec::SmallVec;
use std::borrow::Cow;
use std::hash::Hash;
use std::ops::Range;

/// One interpolated number of a point: sum over the nodes of a constant weight times one of their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolation {
    /// Which number of each node: of its coordinates or, with a node map, of what that makes of them.
    pub component: usize,
    /// One weight for each node: values or derivatives of shape functions.
    pub weights: &'static [f64],
}

/// A flexible element, written as formulas at points of interpolated fields: the finer contract of an [`Element`].
///
/// With h = W q, hdot = W v, hddot = W a, where W is constant and all nodes have the same coordinates, the element is a sum over points
/// of energies T(hdot, h, p), V(h, p), strains e(h, p) with the energy stored in them and their damping, and forces Q(hdot, h, p, t); or of
/// residuals that are written out. Methods are those of [`Element`], at a point; every list that one writes to holds zeros before.
///
/// With a node map y = m(q, p) of each node by itself (a director from a rotation, say), y takes the place of q everywhere: h = W y, and the
/// residual of the coordinates is (dy/dq)^T times that of y, which follows from energies and forces: none is written out then. What the points share is then differentiated towards y, and the map of each
/// node by itself.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait Field: Hash + Send + Sync + 'static {
    /// Number of nodes.
    const NODES: usize;
    /// Kind of all its nodes.
    const NODE: NodeKind;
    /// Interpolated numbers of each point.
    const POINTS: &'static [&'static [Interpolation]];
    /// How many numbers the node map makes of one node; without a map the coordinates are interpolated themselves.
    const MAPPED: Option<usize> = None;

    /// Parameters of the element; points may share them.
    fn parameters(&self) -> Vec<Parameter>;
    /// Which of them a point sees.
    fn parameters_of(&self, point: usize) -> Range<usize>;
    /// The node map: numbers y of a node from its coordinates and the parameters of the element, into `y`.
    fn node_map<S: Scalar>(&self, _node: usize, _q: &[S], _p: &[S], _y: &mut [S]) {}
    /// Kinetic energy of a point \[J\].
    fn kinetic<S: Scalar>(&self, _point: usize, _v: &[S], _h: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Potential energy of a point \[J\] that no strain stores.
    fn potential<S: Scalar>(&self, _point: usize, _h: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// Strain energy of a point \[J\], where it is not [`stored`](Field::stored) in strains that are given.
    fn strain_energy<S: Scalar>(&self, _point: usize, _h: &[S], _p: &[S]) -> S {
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
    /// Energy that is stored in the strains of all points \[J\]: those of single points together, unless a law at other points takes its
    /// strains from several of them (tying).
    fn stored_together<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let (mut total, mut first) = (S::zero(), 0);
        for point in 0..Self::POINTS.len() {
            let next = first + self.strain_count(point);
            total += self.stored(point, &e[first..next], &p[self.parameters_of(point)]);
            first = next;
        }
        total
    }
    /// Damping stresses of a point, conjugate to its strains, into `s`.
    fn damping<S: Scalar>(&self, _point: usize, _e: &[S], _rate: &[S], _p: &[S], _s: &mut [S]) {}
    /// Rayleigh's dissipation function of the strain rates of all points \[W\], for laws that take their strains from several of them.
    fn dissipation_together<S: Scalar>(&self, _e: &[S], _rate: &[S], _p: &[S]) -> S {
        S::zero()
    }
    /// The residual of a point, conjugate to h, into `r`; left out where the other methods give it.
    fn residual<S: Scalar>(&self, _point: usize, _s: State<S>, _p: &[S], _t: S, _r: &mut [S]) {
        S::from_energies();
    }
    /// Mass \[kg\].
    fn mass<S: Scalar>(&self, _p: &[S]) -> S {
        S::zero()
    }
}

/// Interpolated numbers of a point by runs of components that have the same weights: the first of them, and how many they are.
pub(super) const fn rows<const N: usize>(runs: &[(usize, usize, &'static [f64])]) -> [Interpolation; N] {
    let mut rows = [Interpolation { component: 0, weights: &[] }; N];
    let (mut run, mut row) = (0, 0);
    while run < runs.len() {
        let (first, count, weights) = runs[run];
        let end = row + count;
        while row < end {
            rows[row] = Interpolation { component: first + count + row - end, weights };
            row += 1;
        }
        run += 1;
    }
    assert!(row == N);
    rows
}

/// The element that a [`Field`] makes.
#[derive(Hash)]
pub struct Flexible<F>(pub F);

/// Numbers of one point: on the stack.
type PointNumbers<S> = SmallVec<[S; 12]>;

/// Numbers of one node that are interpolated.
const fn numbers<F: Field>() -> usize {
    match F::MAPPED {
        Some(count) => count,
        None => F::NODE.dofs(),
    }
}

/// W x.
pub fn interpolate<F: Field, S: Scalar>(rows: &[Interpolation], x: &[S]) -> PointNumbers<S> {
    let number = |row: &Interpolation| {
        let mut sum = x[row.component] * row.weights[0];
        for node in 1..F::NODES {
            sum += x[node * numbers::<F>() + row.component] * row.weights[node];
        }
        sum
    };
    rows.iter().map(number).collect()
}

/// x += W^T h.
fn distribute<F: Field, S: Scalar>(rows: &[Interpolation], h: &[S], x: &mut [S]) {
    for (row, &h) in rows.iter().zip(h) {
        for node in 0..F::NODES {
            x[node * numbers::<F>() + row.component] += h * row.weights[node];
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

impl<F: Field> Flexible<F> {
    /// Numbers of all nodes from their coordinates, moving or still: these themselves without a map.
    fn node_numbers<'q, S: Scalar>(&self, q: &'q [S], p: &[S]) -> Cow<'q, [S]> {
        let Some(count) = F::MAPPED else { return Cow::Borrowed(q) };
        let mut y = vec![S::zero(); F::NODES * count];
        for (node, (q, y)) in q.chunks_exact(F::NODE.dofs()).zip(y.chunks_exact_mut(count)).enumerate() {
            self.0.node_map(node, q, p, y);
        }
        Cow::Owned(y)
    }
    /// Rates of the nodes' numbers, and the numbers.
    fn moving_numbers<'q, S: Scalar>(&self, v: &'q [S], q: &'q [S], p: &[S]) -> [Cow<'q, [S]>; 2] {
        if F::MAPPED.is_none() {
            return [v, q].map(Cow::Borrowed);
        }
        let moving: Vec<Moving<S>> = q.iter().zip(v).map(|(&q, &v)| Moving::new(q, v)).collect();
        let still: Vec<Moving<S>> = p.iter().map(|&p| Moving::new(p, S::zero())).collect();
        let y = self.node_numbers(&moving, &still);
        [y.iter().map(|y| y.rate).collect(), y.iter().map(|y| y.value).collect()]
    }
    /// The sum over all points.
    fn sum<S: Scalar>(&self, of_point: impl Fn(usize, &'static [Interpolation]) -> S) -> S {
        let mut total = S::zero();
        self.for_each_point(|point, rows, _| total += of_point(point, rows));
        total
    }
    fn kinetic_of<S: Scalar>(&self, v: &[S], y: &[S], p: &[S]) -> S {
        self.sum(|point, rows| {
            let (rates, h) = (interpolate::<F, S>(rows, v), interpolate::<F, S>(rows, y));
            self.0.kinetic(point, &rates, &h, &p[self.0.parameters_of(point)])
        })
    }
    fn potential_of<S: Scalar>(&self, y: &[S], p: &[S]) -> S {
        self.sum(|point, rows| self.0.potential(point, &interpolate::<F, S>(rows, y), &p[self.0.parameters_of(point)]))
    }
    fn strain_energy_of<S: Scalar>(&self, y: &[S], p: &[S]) -> S {
        self.sum(|point, rows| self.0.strain_energy(point, &interpolate::<F, S>(rows, y), &p[self.0.parameters_of(point)]))
    }
    fn add_force_of<S: Scalar>(&self, v: &[S], y: &[S], p: &[S], t: S, force: &mut [S]) {
        self.for_each_point(|point, rows, _| {
            let (rates, h) = (interpolate::<F, S>(rows, v), interpolate::<F, S>(rows, y));
            let mut own: PointNumbers<S> = SmallVec::from_elem(S::zero(), rows.len());
            self.0.add_force(point, &rates, &h, &p[self.0.parameters_of(point)], t, &mut own);
            distribute::<F, S>(rows, &own, force);
        });
    }
    fn strains_of<S: Scalar>(&self, y: &[S], p: &[S], e: &mut [S]) {
        self.for_each_point(|point, rows, own| {
            if !own.is_empty() {
                self.0.strains(point, &interpolate::<F, S>(rows, y), &p[self.0.parameters_of(point)], &mut e[own]);
            }
        });
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
        let [v, y] = self.moving_numbers(v, q, p);
        self.kinetic_of(&v, &y, p)
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        self.potential_of(&self.node_numbers(q, p), p)
    }
    fn strain_energy<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        self.strain_energy_of(&self.node_numbers(q, p), p)
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        if F::MAPPED.is_none() {
            return self.add_force_of(v, q, p, t, force);
        }
        let [rates, y] = self.moving_numbers(v, q, p);
        let mut of_numbers = vec![S::zero(); y.len()];
        self.add_force_of(&rates, &y, p, t, &mut of_numbers);
        // its power along each coordinate by itself
        let mut along = vec![S::zero(); q.len()];
        for (dof, force) in force.iter_mut().enumerate() {
            along[dof] = S::one();
            let [rates, _] = self.moving_numbers(&along, q, p);
            *force += rates.iter().zip(&of_numbers).fold(S::zero(), |sum, (&rate, &force)| sum + rate * force);
            along[dof] = S::zero();
        }
    }
    fn strain_count(&self) -> usize {
        (0..F::POINTS.len()).map(|point| self.0.strain_count(point)).sum()
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        self.strains_of(&self.node_numbers(q, p), p, e);
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        self.0.stored_together(e, p)
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        self.for_each_point(|point, _, own| {
            self.0.damping(point, &e[own.clone()], &rate[own.clone()], &p[self.0.parameters_of(point)], &mut s[own]);
        });
    }
    fn dissipation<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S]) -> S {
        self.0.dissipation_together(e, rate, p)
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        if F::MAPPED.is_some() {
            // says that it follows from energies; one that is written out is refused, as it gives no numbers
            let none = vec![S::zero(); F::POINTS[0].len()];
            self.0.residual(0, State { a: &none, v: &none, q: &none }, p, t, &mut none.clone());
            return r.fill(S::from(f64::NAN));
        }
        self.for_each_point(|point, rows, _| {
            let [a, v, q] = [s.a, s.v, s.q].map(|x| interpolate::<F, S>(rows, x));
            let mut own: PointNumbers<S> = SmallVec::from_elem(S::zero(), rows.len());
            self.0.residual(point, State { a: &a, v: &v, q: &q }, &p[self.0.parameters_of(point)], t, &mut own);
            distribute::<F, S>(rows, &own, r);
        });
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        self.0.mass(p)
    }
    fn in_stages(&self, s: State<Recorded>, p: &[Recorded], t: Recorded) -> Option<(Vec<Recorded>, Stages<Recorded>)> {
        F::MAPPED?;
        let none = vec![Recorded::from(0.0); F::POINTS[0].len()];
        self.0.residual(0, State { a: &none, v: &none, q: &none }, p, t, &mut none.clone());
        if !is_from_energies() {
            return None;
        }
        let y = self.node_numbers(s.q, p);
        let v = along_motion(&y, &paired(s.q, s.v));
        let a = along_motion(&v, &[paired(s.q, s.v), paired(s.v, s.a)].concat());
        let forces = from_energies(&OfNodeNumbers(self), State { a: &a, v: &v, q: &y }, p, t);
        let residual = gradient_of(&y, &forces, s.q);
        Some((residual, Stages { numbers: [a, v, y.into_owned()], forces }))
    }
}

/// A field with a node map as formulas of its nodes' numbers.
struct OfNodeNumbers<'f, F>(&'f Flexible<F>);

impl<F: Field> Formulas for OfNodeNumbers<'_, F> {
    fn kinetic(&self, v: &[Recorded], q: &[Recorded], p: &[Recorded]) -> Recorded {
        self.0.kinetic_of(v, q, p)
    }
    fn potential(&self, q: &[Recorded], p: &[Recorded]) -> Recorded {
        self.0.potential_of(q, p)
    }
    fn strain_energy(&self, q: &[Recorded], p: &[Recorded]) -> Recorded {
        self.0.strain_energy_of(q, p)
    }
    fn add_force(&self, v: &[Recorded], q: &[Recorded], p: &[Recorded], t: Recorded, force: &mut [Recorded]) {
        self.0.add_force_of(v, q, p, t, force);
    }
    fn strain_count(&self) -> usize {
        Element::strain_count(self.0)
    }
    fn strains(&self, q: &[Recorded], p: &[Recorded], _t: Recorded, e: &mut [Recorded]) {
        self.0.strains_of(q, p, e);
    }
    fn stored(&self, e: &[Recorded], p: &[Recorded]) -> Recorded {
        Element::stored(self.0, e, p)
    }
    fn damping(&self, e: &[Recorded], rate: &[Recorded], p: &[Recorded], t: Recorded, s: &mut [Recorded]) {
        Element::damping(self.0, e, rate, p, t, s);
    }
    fn dissipation(&self, e: &[Recorded], rate: &[Recorded], p: &[Recorded]) -> Recorded {
        Element::dissipation(self.0, e, rate, p)
    }
}
