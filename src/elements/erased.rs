use super::{ByPoints, Constraint, Element, Parameter, State};
use crate::scalar::{
    Complex, Curved, Direction, Job, LANES, Lanes, Recordable, Rev, Reverse, Scalar, Taylor, add_gradient, curvature, widest,
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
impl RunScalar for Complex {
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
pub trait AnyElement: ElementIn<f64> + ElementIn<Complex> + ElementIn<Lanes> + ElementIn<Rev> + Send + Sync {
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
struct Reaction<'j, C, S>(&'j C, [&'j [S]; 3], S, &'j mut [S]);

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

/// A reaction in real numbers from g, eight coordinates at a time: (q, mu, p, t).
struct ReactionOfLanes<'j, C>(&'j C, [&'j [f64]; 3], f64, &'j mut [f64]);

impl<C: Constraint> Job for ReactionOfLanes<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let ReactionOfLanes(constraint, [q, mu, p], t, r) = self;
        let (mut lanes_q, mut lanes_p) = (SmallVec::<[Lanes; 16]>::new(), SmallVec::<[Lanes; 16]>::new());
        lanes_q.extend(q.iter().map(|&q| Lanes::constant(q)));
        lanes_p.extend(p.iter().map(|&p| Lanes::constant(p)));
        let mut g: SmallVec<[Lanes; 6]> = SmallVec::from_elem(Lanes::default(), mu.len());
        for first in (0..q.len()).step_by(LANES) {
            let lanes = LANES.min(q.len() - first);
            (0..lanes).for_each(|lane| lanes_q[first + lane].eps[lane] = 1.0);
            constraint.g(&lanes_q, &lanes_p, Lanes::from(t), &mut g);
            for (g, mu) in g.iter().zip(mu) {
                r[first..first + lanes].iter_mut().zip(g.eps).for_each(|(r, g)| *r += g * mu);
            }
            (0..lanes).for_each(|lane| lanes_q[first + lane].eps[lane] = 0.0);
        }
    }
}

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
    ReactingConstraintIn<f64> + ReactingConstraintIn<Complex> + ReactingConstraintIn<Lanes> + Send + Sync
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
    /// Writes A (equations by coordinates) and, for groups of eight directions of q, the derivative of A^T mu along them.
    fn linearize_reaction(
        &self,
        at: (&[f64], &[f64], f64),
        mu: &[f64],
        directions: &[Direction],
        gradients: &mut [f64],
        products: &mut [Direction],
    );
    /// Writes, for groups of eight lambdas, the gradient of lambda . A^T mu with respect to q; A goes to `gradients`.
    fn pull_back(
        &self,
        at: (&[f64], &[f64], f64),
        mu: &[f64],
        lambdas: &[Direction],
        gradients: &mut [f64],
        products: &mut [Direction],
    ) {
        // the curvature of mu . g is symmetric
        self.linearize_reaction(at, mu, lambdas, gradients, products);
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
            return widest(ReactionOfLanes(self, [q, mu, p], t.value(), r));
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
        let n = s.q.len();
        if !C::REACTION {
            return rows_of_lanes(self, s, p, t, rows);
        }
        let (q, constants) = (motion(s), along_motion(p));
        let mut unit: SmallVec<[Taylor<f64>; 6]> = SmallVec::from_elem(Taylor::default(), self.equations());
        rows.fill(Taylor::default());
        for (equation, row) in rows.chunks_exact_mut(n).enumerate() {
            unit[equation] = Taylor::from(1.0);
            self.reaction(&q, &unit, &constants, Taylor::new(t, 1.0, 0.0), row);
            unit[equation] = Taylor::default();
        }
    }
    fn linearize_reaction(
        &self,
        (q, p, t): (&[f64], &[f64], f64),
        mu: &[f64],
        directions: &[Direction],
        gradients: &mut [f64],
        products: &mut [Direction],
    ) {
        if C::REACTION {
            return linearize_written_reaction(self, (q, p, t), mu, directions, gradients, products);
        }
        let p: SmallVec<[Curved; 16]> = p.iter().map(|&p| Curved::from(p)).collect();
        let function = |q: &[Curved], g: &mut [Curved]| self.g(q, &p, Curved::from(t), g);
        curvature(q, function, mu, directions, gradients, products);
    }
    fn kink_times(&self, p: &[f64]) -> Vec<f64> {
        self.kinks(p)
    }
}

/// Rows A from unit multipliers, and the derivative of A^T mu along directions from eight dual lanes at a time.
fn linearize_written_reaction<C: Constraint>(
    constraint: &C,
    (q, p, t): (&[f64], &[f64], f64),
    mu: &[f64],
    directions: &[Direction],
    gradients: &mut [f64],
    products: &mut [Direction],
) {
    let n = q.len();
    gradients.fill(0.0);
    let mut unit: SmallVec<[f64; 6]> = SmallVec::from_elem(0.0, mu.len());
    for (row, gradient) in gradients.chunks_exact_mut(n).enumerate() {
        unit[row] = 1.0;
        constraint.reaction(q, &unit, p, t, gradient);
        unit[row] = 0.0;
    }
    if mu.iter().all(|&mu| mu == 0.0) {
        return products.fill([0.0; LANES]);
    }
    let (mut lanes_p, mut lanes_mu) = (SmallVec::<[Lanes; 16]>::new(), SmallVec::<[Lanes; 6]>::new());
    lanes_p.extend(p.iter().map(|&p| Lanes::constant(p)));
    lanes_mu.extend(mu.iter().map(|&mu| Lanes::constant(mu)));
    let (mut lanes_q, mut r) = (SmallVec::<[Lanes; 16]>::new(), SmallVec::<[Lanes; 16]>::new());
    for (directions, products) in directions.chunks_exact(n).zip(products.chunks_exact_mut(n)) {
        lanes_q.clear();
        lanes_q.extend(q.iter().zip(directions).map(|(&re, &eps)| Lanes { re, eps }));
        r.clear();
        r.resize(n, Lanes::default());
        Lanes::run(Reaction(constraint, [&lanes_q, &lanes_mu, &lanes_p], Lanes::from(t), &mut r));
        products.iter_mut().zip(&r).for_each(|(product, r)| *product = r.eps);
    }
}

/// Rows A along the motion, eight coordinates at a time.
fn rows_of_lanes<C: Constraint>(constraint: &C, s: State<f64>, p: &[f64], t: f64, rows: &mut [Taylor<f64>]) {
    let n = s.q.len();
    let (mut q, mut constants) = (SmallVec::<[Taylor<Lanes>; 16]>::new(), SmallVec::<[Taylor<Lanes>; 16]>::new());
    let [value, rate, second] = [s.q, s.v, s.a].map(|x| x.iter().map(|&x| Lanes::constant(x)));
    q.extend(value.zip(rate.zip(second)).map(|(q, (v, a))| Taylor::new(q, v, a)));
    constants.extend(p.iter().map(|&p| Taylor::from(p)));
    let mut g: SmallVec<[Taylor<Lanes>; 6]> = SmallVec::from_elem(Taylor::default(), constraint.equations());
    let time = Taylor::new(Lanes::from(t), Lanes::one(), Lanes::zero());
    for first in (0..n).step_by(LANES) {
        let lanes = first..n.min(first + LANES);
        for dof in lanes.clone() {
            q[dof].value.eps[dof - first] = 1.0;
        }
        constraint.g(&q, &constants, time, &mut g);
        for (row, g) in rows.chunks_exact_mut(n).zip(&g) {
            for dof in lanes.clone() {
                let lane = dof - first;
                row[dof] = Taylor::new(g.value.eps[lane], g.first.eps[lane], g.second.eps[lane]);
            }
        }
        for dof in lanes {
            q[dof].value.eps[dof - first] = 0.0;
        }
    }
}

/// q(s) = q + v s + a s^2 / 2, filled in place: moving or pushing costs as much as the evaluation.
#[inline(always)]
pub(super) fn motion<S: Scalar>(s: State<S>) -> SmallVec<[Taylor<S>; 16]> {
    let mut q: SmallVec<[Taylor<S>; 16]> = SmallVec::from_elem(Taylor::default(), s.q.len());
    for (i, q) in q.iter_mut().enumerate() {
        *q = Taylor::new(s.q[i], s.v[i], s.a[i]);
    }
    q
}

/// Numbers that don't move.
#[inline(always)]
pub(super) fn along_motion<S: Scalar>(p: &[S]) -> SmallVec<[Taylor<S>; 16]> {
    let mut constants: SmallVec<[Taylor<S>; 16]> = SmallVec::from_elem(Taylor::default(), p.len());
    for (constant, &p) in constants.iter_mut().zip(p) {
        constant.value = p;
    }
    constants
}
