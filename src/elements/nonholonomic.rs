use super::erased::{ReactingConstraintIn, along_motion, motion};
use super::{AnyConstraint, ConstraintIn, Parameter, State};
use crate::scalar::{Direction, LANES, Lanes, Recordable, Reverse, Scalar, Taylor, add_gradient};
use num_traits::{One, Zero};
use smallvec::SmallVec;

/// A constraint on velocities, h(v, q, p, t) = B(q, p, t) v + b(q, p, t) = 0, that is no derivative of any g: rolling, blades, wheels.
///
/// Nothing but h is written. The reaction B^T mu, the acceleration level dh/dt = 0, projections of velocities and all their
/// derivatives follow by differentiation. Coordinates are not restricted by it: their projection leaves it alone.
pub trait NonholonomicConstraint: Send + Sync + 'static {
    /// Number of coordinates of all its nodes together; the largest if [`dofs`](NonholonomicConstraint::dofs) chooses.
    const DOFS: usize;
    /// Number of equations.
    const EQUATIONS: usize;
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Number of coordinates of this instance.
    fn dofs(&self) -> usize {
        Self::DOFS
    }
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Writes h(v, q, p, t), linear in v, to `h`; scale the rows so that they are velocities or angular velocities.
    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, h: &mut [S]);
    /// Times at which the motion it prescribes is not smooth: steps end there.
    fn kinks(&self, _p: &[f64]) -> Vec<f64> {
        Vec::new()
    }
}

/// A [`NonholonomicConstraint`] among the constraints of a model: its derivatives along the motion are (0, h, dh/dt), because there
/// is no g.
pub struct Nonholonomic<C>(pub C);

type Few<S> = SmallVec<[S; 16]>;
type Rows<S> = SmallVec<[S; 6]>;

fn constants<S: Recordable>(values: &[S]) -> Few<Reverse<S>> {
    values.iter().map(|&value| Reverse::constant(value)).collect()
}

/// mu . h, recorded.
fn power<C: NonholonomicConstraint, S: Recordable>(
    constraint: &C,
    [v, q, p]: [&[Reverse<S>]; 3],
    mu: &[S],
    t: S,
) -> Reverse<S> {
    let mut h: Rows<Reverse<S>> = SmallVec::from_elem(Reverse::default(), mu.len());
    constraint.h(v, q, p, Reverse::constant(t), &mut h);
    h.iter().zip(mu).map(|(&h, &mu)| h * Reverse::constant(mu)).sum()
}

impl<C: NonholonomicConstraint, S: Scalar> ConstraintIn<S> for Nonholonomic<C> {
    fn value(&self, _q: &[S], _p: &[S], _t: S, g: &mut [S]) {
        g.fill(S::zero());
    }

    fn derivatives(&self, s: State<S>, p: &[S], t: S, t_rate: f64, g: &mut [Taylor<S>]) {
        let (q, p) = (motion(s), along_motion(p));
        let v: Few<Taylor<S>> = s.v.iter().zip(s.a).map(|(&v, &a)| Taylor::new(v, a, S::zero())).collect();
        self.0.h(&v, &q, &p, Taylor::new(t, S::from(t_rate), S::zero()), g);
        g.iter_mut().for_each(|g| *g = Taylor::new(S::zero(), g.value, g.first));
    }
}

impl<C: NonholonomicConstraint, S: Recordable> ReactingConstraintIn<S> for Nonholonomic<C> {
    /// B^T mu: the gradient of mu . h with respect to v, the same at every v.
    fn add_reaction(&self, q: &[S], mu: &[S], p: &[S], t: S, r: &mut [S]) {
        let (q, p) = (constants(q), constants(p));
        let rest = q.iter().map(|_| S::zero());
        add_gradient(rest, |v| power(&self.0, [v, &q, &p], mu, t), r);
    }
}

impl<C: NonholonomicConstraint> AnyConstraint for Nonholonomic<C> {
    fn dof_count(&self) -> usize {
        self.0.dofs()
    }
    fn equation_count(&self) -> usize {
        C::EQUATIONS
    }
    fn is_separable(&self) -> bool {
        false
    }
    fn is_nonholonomic(&self) -> bool {
        true
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.0.parameters()
    }

    /// (B, dh/dq, -), or with `accelerations` (B, (dB/dt + dh/dq) / 2, d(dh/dq)/dt): in both cases what a holonomic constraint has as
    /// (A, dA/dt, d2A/dt2).
    fn rows(&self, s: State<f64>, p: &[f64], t: f64, accelerations: bool, rows: &mut [Taylor<f64>]) {
        let n = s.q.len();
        let lanes = |x: &[f64], rate: &[f64]| -> Few<Taylor<Lanes>> {
            let [x, rate] = [x, rate].map(|x| x.iter().map(|&x| Lanes::constant(x)));
            x.zip(rate).map(|(x, rate)| Taylor::new(x, rate, Lanes::zero())).collect()
        };
        let (mut q, mut v) = (lanes(s.q, s.v), lanes(s.v, s.a));
        let p: Few<Taylor<Lanes>> = p.iter().map(|&p| Taylor::from(p)).collect();
        let time = Taylor::new(Lanes::from(t), Lanes::one(), Lanes::zero());
        let mut h: Rows<Taylor<Lanes>> = SmallVec::from_elem(Taylor::default(), C::EQUATIONS);
        for first in (0..n).step_by(LANES) {
            for towards_v in [true, false] {
                let dofs = first..n.min(first + LANES);
                let moved = if towards_v { &mut v } else { &mut q };
                dofs.clone().for_each(|dof| moved[dof].value.eps[dof - first] = 1.0);
                self.0.h(&v, &q, &p, time, &mut h);
                for (row, h) in rows.chunks_exact_mut(n).zip(&h) {
                    for dof in dofs.clone() {
                        let (now, rate) = (h.value.eps[dof - first], h.first.eps[dof - first]);
                        row[dof] = match (towards_v, accelerations) {
                            (true, true) => Taylor::new(now, 0.5 * rate, 0.0),
                            (true, false) => Taylor::new(now, 0.0, 0.0),
                            (false, true) => Taylor::new(row[dof].value, row[dof].first + 0.5 * now, rate),
                            (false, false) => Taylor::new(row[dof].value, now, 0.0),
                        };
                    }
                }
                let moved = if towards_v { &mut v } else { &mut q };
                dofs.for_each(|dof| moved[dof].value.eps[dof - first] = 0.0);
            }
        }
    }

    fn gradients(&self, (q, p, t): (&[f64], &[f64], f64), rows: &mut [f64]) {
        rows.fill(0.0);
        let mut unit: Rows<f64> = SmallVec::from_elem(0.0, C::EQUATIONS);
        for (equation, row) in rows.chunks_exact_mut(q.len()).enumerate() {
            unit[equation] = 1.0;
            self.add_reaction(q, &unit, p, t, row);
            unit[equation] = 0.0;
        }
    }

    fn curvature(&self, (q, p, t): (&[f64], &[f64], f64), mu: &[f64], directions: &[Direction], products: &mut [Direction]) {
        let n = q.len();
        if mu.iter().all(|&mu| mu == 0.0) {
            return products.fill([0.0; LANES]);
        }
        let lift = |values: &[f64]| -> Few<Lanes> { values.iter().map(|&value| Lanes::constant(value)).collect() };
        let (p, mu) = (lift(p), lift(mu));
        for (directions, products) in directions.chunks_exact(n).zip(products.chunks_exact_mut(n)) {
            let q: Few<Lanes> = q.iter().zip(directions).map(|(&re, &eps)| Lanes { re, eps }).collect();
            let mut r: Few<Lanes> = SmallVec::from_elem(Lanes::default(), n);
            self.add_reaction(&q, &mu, &p, Lanes::from(t), &mut r);
            products.iter_mut().zip(&r).for_each(|(product, r)| *product = r.eps);
        }
    }

    /// The gradient of mu . B(q) lambda with respect to q for eight lambdas at a time; B^T mu has no potential, so that this is not the
    /// derivative of the reaction along lambda.
    fn pull_back(&self, (q, p, t): (&[f64], &[f64], f64), mu: &[f64], lambdas: &[Direction], products: &mut [Direction]) {
        let n = q.len();
        let lift = |values: &[f64]| -> Few<Lanes> { values.iter().map(|&value| Lanes::constant(value)).collect() };
        let (p, mu) = (constants(&lift(p)), lift(mu));
        for (lambdas, products) in lambdas.chunks_exact(n).zip(products.chunks_exact_mut(n)) {
            let v: Few<Lanes> = lambdas.iter().map(|&eps| Lanes { re: 0.0, eps }).collect();
            let v = constants(&v);
            let mut gradient: Few<Lanes> = SmallVec::from_elem(Lanes::default(), n);
            let at = q.iter().map(|&q| Lanes::constant(q));
            add_gradient(at, |q| power(&self.0, [&v, q, &p], &mu, Lanes::from(t)), &mut gradient);
            products.iter_mut().zip(&gradient).for_each(|(product, g)| *product = g.eps);
        }
    }

    fn kink_times(&self, p: &[f64]) -> Vec<f64> {
        self.0.kinks(p)
    }
}
