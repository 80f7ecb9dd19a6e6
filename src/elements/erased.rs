use super::{ByPoints, Constraint, Element, Parameter, State};
use crate::scalar::{
    Complex64, Curved, Direction, Job, LANES, Lanes, Recordable, Rev, Reverse, Scalar, Taylor, add_gradient, curvature,
};
use smallvec::SmallVec;

/// A scalar in which whole simulations run: the closed list over which elements and constraints are compiled.
pub trait RunScalar: Recordable {
    /// Number of derivative parts.
    const PARTS: usize;
    /// Derivative part `index`.
    fn part(&self, index: usize) -> f64;
    /// Adds to derivative part `index`.
    fn add_to_part(&mut self, index: usize, increment: f64);
    /// Adds to the value.
    fn add_to_value(&mut self, increment: f64);
    /// The element, in this scalar.
    fn element(element: &dyn AnyElement) -> &dyn ElementIn<Self>;
    /// The constraint, in this scalar.
    fn constraint(constraint: &dyn AnyConstraint) -> &dyn ReactingConstraintIn<Self>;
}

/// The two erasing methods, the same for every listed scalar.
macro_rules! view_erased {
    () => {
        fn element(element: &dyn AnyElement) -> &dyn ElementIn<Self> {
            element
        }
        fn constraint(constraint: &dyn AnyConstraint) -> &dyn ReactingConstraintIn<Self> {
            constraint
        }
    };
}

impl RunScalar for f64 {
    const PARTS: usize = 0;
    fn part(&self, _index: usize) -> f64 {
        0.0
    }
    fn add_to_part(&mut self, _index: usize, _increment: f64) {}
    fn add_to_value(&mut self, increment: f64) {
        *self += increment;
    }
    view_erased!();
}
impl RunScalar for Complex64 {
    const PARTS: usize = 1;
    fn part(&self, _index: usize) -> f64 {
        self.im
    }
    fn add_to_part(&mut self, _index: usize, increment: f64) {
        self.im += increment;
    }
    fn add_to_value(&mut self, increment: f64) {
        self.re += increment;
    }
    view_erased!();
}
impl RunScalar for Lanes {
    const PARTS: usize = LANES;
    fn part(&self, index: usize) -> f64 {
        self.eps[index]
    }
    fn add_to_part(&mut self, index: usize, increment: f64) {
        self.eps[index] += increment;
    }
    fn add_to_value(&mut self, increment: f64) {
        self.re += increment;
    }
    view_erased!();
}

/// Erases types of this crate by functions that are compiled in it: scenes of other crates, generic over the scalar, then compile none
/// of their formulas again.
macro_rules! compiled_here {
    (dyn $erased:path: $($type:ty),* $(,)?) => {$(
        impl From<$type> for Box<dyn $erased> {
            #[inline(never)]
            fn from(own: $type) -> Self {
                Box::new(own)
            }
        }
    )*};
}
pub(crate) use compiled_here;

/// What the framework asks of an element in one scalar.
pub trait ElementIn<S> {
    /// Adds the residual to `r`.
    fn add_residual(&self, s: State<S>, p: &[S], t: S, r: &mut [S]);
    /// Adds (dP/dq) v.
    fn add_momentum_rate(&self, v: &[S], q: &[S], p: &[S], r: &mut [S]);
    /// Kinetic and potential energy.
    fn energy(&self, v: &[S], q: &[S], p: &[S]) -> [S; 2];
    /// Mass.
    fn mass_in(&self, p: &[S]) -> S;
}

/// An element with its type erased; every [`Element`] is one.
pub trait AnyElement: ElementIn<f64> + ElementIn<Complex64> + ElementIn<Lanes> + ElementIn<Rev> + Send + Sync {
    /// Number of coordinates.
    fn dof_count(&self) -> usize;
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Whether the energies are complete.
    fn has_energies(&self) -> bool;
    /// Whether the residual is linear with constant coefficients.
    fn has_constant_matrices(&self) -> bool;
    /// Whether the mass matrix is constant.
    fn has_constant_mass(&self) -> bool;
    /// Times at which a load jumps.
    fn kink_times(&self, p: &[f64]) -> Vec<f64>;
    /// Its derivatives through points, if it has any.
    fn points(&self) -> Option<&dyn ByPoints>;
}

/// A residual to be evaluated.
struct Residual<'j, E, S>(&'j E, State<'j, S>, &'j [S], S, &'j mut [S]);

impl<E: Element, S: Scalar> Job for Residual<'_, E, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Residual(element, s, p, t, r) = self;
        element.residual(s, p, t, r);
    }
}

/// A reaction to be evaluated: (q, mu, p, t).
pub(super) struct Reaction<'j, C, S>(pub &'j C, pub [&'j [S]; 3], pub S, pub &'j mut [S]);

impl<C: Constraint, S: Scalar> Job for Reaction<'_, C, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Reaction(constraint, [q, mu, p], t, r) = self;
        constraint.reaction(q, mu, p, t, r);
    }
}

/// Coordinates up to which differentiating g along all of them is faster than recording it.
const FEW: usize = 4 * LANES;

impl<E: Element, S: Scalar> ElementIn<S> for E {
    fn add_residual(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        S::run(Residual(self, s, p, t, r));
    }
    fn add_momentum_rate(&self, v: &[S], q: &[S], p: &[S], r: &mut [S]) {
        if !E::CONSTANT_MASS {
            self.momentum_rate(v, q, p, r);
        }
    }
    fn energy(&self, v: &[S], q: &[S], p: &[S]) -> [S; 2] {
        [self.kinetic(v, q, p), self.potential(q, p)]
    }
    fn mass_in(&self, p: &[S]) -> S {
        self.mass(p)
    }
}

impl<E: Element> AnyElement for E {
    fn dof_count(&self) -> usize {
        self.dofs()
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn has_energies(&self) -> bool {
        E::ENERGIES
    }
    fn has_constant_matrices(&self) -> bool {
        self.is_linear()
    }
    fn has_constant_mass(&self) -> bool {
        E::CONSTANT_MASS
    }
    fn kink_times(&self, p: &[f64]) -> Vec<f64> {
        self.kinks(p)
    }
    fn points(&self) -> Option<&dyn ByPoints> {
        self.by_points()
    }
}

/// What the framework asks of a constraint in one scalar.
pub trait ConstraintIn<S> {
    /// Writes g.
    fn value(&self, q: &[S], p: &[S], t: S, g: &mut [S]);
    /// Writes g with its first and second derivative along q(s) = (q, v, a), t(s) = (t, t_rate, 0).
    fn derivatives(&self, s: State<S>, p: &[S], t: S, t_rate: f64, g: &mut [Taylor<S>]);
}

/// A constraint with its reaction, in a scalar of runs.
pub trait ReactingConstraintIn<S>: ConstraintIn<S> {
    /// Adds A^T mu to `r`, as the gradient of mu . g.
    fn add_reaction(&self, q: &[S], mu: &[S], p: &[S], t: S, r: &mut [S]);
}

/// A constraint with its type erased; every [`Constraint`] is one.
pub trait AnyConstraint:
    ReactingConstraintIn<f64> + ReactingConstraintIn<Complex64> + ReactingConstraintIn<Lanes> + Send + Sync
{
    /// Number of coordinates.
    fn dof_count(&self) -> usize;
    /// Number of equations.
    fn equation_count(&self) -> usize;
    /// Whether the reaction on one node depends on no other.
    fn is_separable(&self) -> bool;
    /// Whether it restricts velocities only.
    fn is_nonholonomic(&self) -> bool {
        false
    }
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Writes A (equations by coordinates) with its first and second derivative along q(s) = (q, v, a), t(s) = (t, 1, 0).
    ///
    /// These are all rows that any constraint level needs: d(dg/dt)/dq = dA/dt, d(d2g/dt2)/dv = 2 dA/dt, d(d2g/dt2)/dq = d2A/dt2.
    /// Those of a nonholonomic constraint differ for velocities and `accelerations`.
    fn rows(&self, s: State<f64>, p: &[f64], t: f64, accelerations: bool, rows: &mut [Taylor<f64>]);
    /// Writes A (equations by coordinates) at (q, p, t).
    fn gradients(&self, at: (&[f64], &[f64], f64), rows: &mut [f64]);
    /// Writes, for groups of eight directions of q, the derivative of A^T mu along them.
    fn curvature(&self, at: (&[f64], &[f64], f64), mu: &[f64], directions: &[Direction], products: &mut [Direction]);
    /// Writes, for groups of eight lambdas, the gradient of lambda . A^T mu with respect to q.
    fn pull_back(&self, at: (&[f64], &[f64], f64), mu: &[f64], lambdas: &[Direction], products: &mut [Direction]) {
        // the curvature of mu . g is symmetric
        self.curvature(at, mu, lambdas, products);
    }
    /// Times at which the prescribed motion is not smooth.
    fn kink_times(&self, p: &[f64]) -> Vec<f64>;
}

impl<C: Constraint, S: Scalar> ConstraintIn<S> for C {
    fn value(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        self.g(q, p, t, g);
    }

    fn derivatives(&self, s: State<S>, p: &[S], t: S, t_rate: f64, g: &mut [Taylor<S>]) {
        let (q, p) = (motion(s), along_motion(p));
        self.g(&q, &p, Taylor::new(t, S::from(t_rate), S::zero()), g);
    }
}

impl<C: Constraint, S: Recordable> ReactingConstraintIn<S> for C {
    fn add_reaction(&self, q: &[S], mu: &[S], p: &[S], t: S, r: &mut [S]) {
        if C::REACTION {
            return S::run(Reaction(self, [q, mu, p], t, r));
        }
        if q.len() <= FEW
            && let (Some(q), Some(mu), Some(p)) = (S::reals(q), S::reals(mu), S::reals(p))
            && let Some(r) = S::reals_mut(r)
        {
            return add_reaction_of_lanes(self, [q, mu, p], t.value(), r);
        }
        let p: SmallVec<[Reverse<S>; 16]> = p.iter().map(|&p| Reverse::constant(p)).collect();
        let work = |q: &[Reverse<S>]| {
            let mut g: SmallVec<[Reverse<S>; 6]> = SmallVec::from_elem(Reverse::default(), self.equations());
            self.g(q, &p, Reverse::constant(t), &mut g);
            g.iter().zip(mu).map(|(&g, &mu)| g * Reverse::constant(mu)).sum()
        };
        add_gradient(q.iter().copied(), work, r);
    }
}

impl<C: Constraint> AnyConstraint for C {
    fn dof_count(&self) -> usize {
        self.dofs()
    }
    fn equation_count(&self) -> usize {
        self.equations()
    }
    fn is_separable(&self) -> bool {
        C::SEPARABLE
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn rows(&self, s: State<f64>, p: &[f64], t: f64, _accelerations: bool, rows: &mut [Taylor<f64>]) {
        if !C::REACTION {
            return rows_of_lanes(self, s, p, t, rows);
        }
        let (q, constants) = (motion(s), along_motion(p));
        rows.fill(Taylor::default());
        for_units(rows, s.q.len(), |unit, row| self.reaction(&q, unit, &constants, Taylor::new(t, 1.0, 0.0), row));
    }
    fn gradients(&self, (q, p, t): (&[f64], &[f64], f64), rows: &mut [f64]) {
        if !C::REACTION {
            return gradients_of_lanes(self, [q, p], t, rows);
        }
        rows.fill(0.0);
        for_units(rows, q.len(), |unit, row| self.reaction(q, unit, p, t, row));
    }
    fn curvature(&self, (q, p, t): (&[f64], &[f64], f64), mu: &[f64], directions: &[Direction], products: &mut [Direction]) {
        if mu.iter().all(|&mu| mu == 0.0) {
            return products.fill([0.0; LANES]);
        }
        if C::REACTION {
            return curvature_of_lanes(self, [q, mu, p], t, directions, products);
        }
        let p: SmallVec<[Curved; 16]> = p.iter().map(|&p| Curved::from(p)).collect();
        let function = |q: &[Curved], g: &mut [Curved]| self.g(q, &p, Curved::from(t), g);
        curvature(q, function, mu, directions, products);
    }
    fn kink_times(&self, p: &[f64]) -> Vec<f64> {
        self.kinks(p)
    }
}

/// Numbers of a joint between two bodies: on the stack.
type Few<S> = SmallVec<[S; 24]>;

/// Numbers that don't move, filled in place: moving them costs as much as the evaluation.
#[inline(always)]
fn lift(values: &[f64], lifted: &mut Few<Lanes>) {
    for &value in values {
        lifted.push(Lanes::constant(value));
    }
}

/// Calls `add(unit, row)` for each row of n numbers, with the unit vector of its place among them.
fn for_units<S: Scalar>(rows: &mut [S], n: usize, mut add: impl FnMut(&[S], &mut [S])) {
    let mut unit: SmallVec<[S; 6]> = SmallVec::from_elem(S::zero(), rows.len() / n);
    for (place, row) in rows.chunks_exact_mut(n).enumerate() {
        unit[place] = S::one();
        add(&unit, row);
        unit[place] = S::zero();
    }
}

/// A at (q, p), eight coordinates at a time.
fn gradients_of_lanes(constraint: &dyn ConstraintIn<Lanes>, [q, p]: [&[f64]; 2], t: f64, rows: &mut [f64]) {
    let n = q.len();
    let (mut lanes_q, mut lanes_p) = (Few::new(), Few::new());
    lift(q, &mut lanes_q);
    lift(p, &mut lanes_p);
    let mut g: SmallVec<[Lanes; 6]> = SmallVec::from_elem(Lanes::default(), rows.len() / n);
    for first in (0..n).step_by(LANES) {
        let width = LANES.min(n - first);
        (0..width).for_each(|lane| lanes_q[first + lane].eps[lane] = 1.0);
        constraint.value(&lanes_q, &lanes_p, Lanes::from(t), &mut g);
        for (row, g) in rows.chunks_exact_mut(n).zip(&g) {
            row[first..first + width].copy_from_slice(&g.eps[..width]);
        }
        (0..width).for_each(|lane| lanes_q[first + lane].eps[lane] = 0.0);
    }
}

/// A^T mu at (q, mu, p) from g, eight coordinates at a time.
fn add_reaction_of_lanes(constraint: &dyn ConstraintIn<Lanes>, [q, mu, p]: [&[f64]; 3], t: f64, r: &mut [f64]) {
    let n = q.len();
    let (mut lanes_q, mut lanes_p) = (Few::new(), Few::new());
    lift(q, &mut lanes_q);
    lift(p, &mut lanes_p);
    let mut g: SmallVec<[Lanes; 6]> = SmallVec::from_elem(Lanes::default(), mu.len());
    for first in (0..n).step_by(LANES) {
        let width = LANES.min(n - first);
        (0..width).for_each(|lane| lanes_q[first + lane].eps[lane] = 1.0);
        constraint.value(&lanes_q, &lanes_p, Lanes::from(t), &mut g);
        for (g, mu) in g.iter().zip(mu) {
            r[first..first + width].iter_mut().zip(g.eps).for_each(|(r, g)| *r += g * mu);
        }
        (0..width).for_each(|lane| lanes_q[first + lane].eps[lane] = 0.0);
    }
}

/// The derivative of a written reaction at (q, mu, p) along groups of eight directions.
fn curvature_of_lanes(
    constraint: &dyn ReactingConstraintIn<Lanes>,
    [q, mu, p]: [&[f64]; 3],
    t: f64,
    directions: &[Direction],
    products: &mut [Direction],
) {
    let n = q.len();
    let (mut lanes_q, mut lanes_mu, mut lanes_p) = (Few::new(), Few::new(), Few::new());
    lift(q, &mut lanes_q);
    lift(mu, &mut lanes_mu);
    lift(p, &mut lanes_p);
    let mut r = Few::<Lanes>::new();
    for (directions, products) in directions.chunks_exact(n).zip(products.chunks_exact_mut(n)) {
        lanes_q.iter_mut().zip(directions).for_each(|(q, &eps)| q.eps = eps);
        r.clear();
        r.resize(n, Lanes::default());
        constraint.add_reaction(&lanes_q, &lanes_mu, &lanes_p, Lanes::from(t), &mut r);
        products.iter_mut().zip(&r).for_each(|(product, r)| *product = r.eps);
    }
}

/// Rows A along the motion, eight coordinates at a time.
fn rows_of_lanes(constraint: &dyn ConstraintIn<Lanes>, s: State<f64>, p: &[f64], t: f64, rows: &mut [Taylor<f64>]) {
    let n = s.q.len();
    let (mut a, mut v, mut lanes_q, mut lanes_p) = (Few::new(), Few::new(), Few::new(), Few::new());
    lift(s.a, &mut a);
    lift(s.v, &mut v);
    lift(s.q, &mut lanes_q);
    lift(p, &mut lanes_p);
    let mut g: SmallVec<[Taylor<Lanes>; 6]> = SmallVec::from_elem(Taylor::default(), rows.len() / n);
    for first in (0..n).step_by(LANES) {
        let width = LANES.min(n - first);
        (0..width).for_each(|lane| lanes_q[first + lane].eps[lane] = 1.0);
        constraint.derivatives(State { a: &a, v: &v, q: &lanes_q }, &lanes_p, Lanes::from(t), 1.0, &mut g);
        for (row, g) in rows.chunks_exact_mut(n).zip(&g) {
            for (lane, row) in row[first..first + width].iter_mut().enumerate() {
                *row = Taylor::new(g.value.eps[lane], g.first.eps[lane], g.second.eps[lane]);
            }
        }
        (0..width).for_each(|lane| lanes_q[first + lane].eps[lane] = 0.0);
    }
}

/// q(s) = q + v s + a s^2 / 2, filled in place: moving or pushing costs as much as the evaluation.
#[inline(always)]
pub(super) fn motion<S: Scalar>(s: State<S>) -> SmallVec<[Taylor<S>; 24]> {
    let mut q: SmallVec<[Taylor<S>; 24]> = SmallVec::from_elem(Taylor::default(), s.q.len());
    for (i, q) in q.iter_mut().enumerate() {
        *q = Taylor::new(s.q[i], s.v[i], s.a[i]);
    }
    q
}

/// Numbers that don't move.
#[inline(always)]
pub(super) fn along_motion<S: Scalar>(p: &[S]) -> SmallVec<[Taylor<S>; 24]> {
    let mut constants: SmallVec<[Taylor<S>; 24]> = SmallVec::from_elem(Taylor::default(), p.len());
    for (constant, &p) in constants.iter_mut().zip(p) {
        constant.value = p;
    }
    constants
}
