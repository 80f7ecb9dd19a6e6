//! Derivatives of the values lambda of small vibrations about an equilibrium.
//!
//! The equilibrium is E(q, mu, p) = 0, and a mode B z = 0 with
//!
//! ```text
//! E = [ R(0, 0, q, p) + A^T mu ]     B = [ lambda^2 M + lambda C + K   A^T ]     z = (x, nu)
//!     [ g(q, p)                ]         [ A                            0  ]
//! ```
//!
//! where K = d(R + A^T mu)/dq. With w^T B = 0 the derivative of the value is d lambda = -(w^T dB z) / (w^T dB/dlambda z), and w^T B z is the
//! derivative of L = w . (R + A^T mu, g) along d = (lambda^2 x, lambda x, x; nu) in (a, v, q; mu). So the gradient of w^T B z is the imaginary part of that
//! of L at a point that is moved by i h d: products with adjoint variables, in complex numbers, exact to round-off. What it is towards q and mu
//! goes back through the equilibrium.
//!
//! Where K is singular, as a body moves freely, (K + s M) goes back instead, again and again: what is left of the gradient in the end are rigid
//! motions, and states without a rest of their own, which follow the start that the design gives.
//!
//! Source: Nelson, AIAA Journal 14 (1976); of modes of one value: Ojalvo, AIAA Journal 26 (1988), and Dailey, AIAA Journal 27 (1989).

use super::transposed::{Backward, SolutionSeed, TransposedSolver};
use crate::assembly::{
    Adjoints, ConstraintPart, Equations, Force, Level, ProductPoint, ProductSeeds, Products, Residual, StageCoefficients,
    StageSystem, System, Unknowns, VectorsAvq,
};
use crate::integrators::{Amplitude, Counters, Method, ModeGroup, ModeVectors, RESTING_SHIFT, RunError, SolveRecord};
use crate::linalg::complex_eigenvalues;
use crate::scalar::{COMPLEX_STEP, Complex64};
use nalgebra::DMatrix;
use std::sync::Arc;

/// How often what moves freely goes back at most ...
const MOST_PASSES: usize = 100;
/// ... until a pass changes this share of the gradient, ...
const SETTLED: f64 = 1e-15;
/// ... or at least this one.
const UNSETTLED: f64 = 1e-10;

pub(crate) struct Still<'a> {
    pub vectors: &'a ModeVectors,
    /// The equations of the equilibrium: states of first order are among its unknowns, whether modes move them or not.
    pub system: Arc<System<'a>>,
    pub p: &'a [f64],
    pub active: &'a [bool],
    pub method: &'a Method,
    pub t: f64,
    /// With whatever depends on velocities.
    pub is_damped: bool,
    /// Whether something moves freely, or a state has no rest of its own.
    pub is_free: bool,
}

/// A complex gradient, towards p and the coordinates of the start.
#[derive(Clone, Debug)]
pub(crate) struct ValueSeeds {
    pub p: [Vec<f64>; 2],
    pub q: [Vec<f64>; 2],
}

struct AdjointSeeds {
    q: Vec<Complex64>,
    mu: Vec<Complex64>,
    p: Vec<Complex64>,
}

impl Still<'_> {
    /// For each group of modes the gradients of w_i^T B z_j, row by row, through the equilibrium.
    pub fn gradients(&self) -> Result<Vec<Vec<ValueSeeds>>, RunError> {
        let groups = &self.vectors.groups;
        let mut products = Products::<Complex64>::new(self.active);
        let mut all: Vec<AdjointSeeds> = Vec::new();
        for group in groups {
            for left in &group.left {
                all.extend(group.right.iter().map(|right| self.seeds(&mut products, (left, right), group.lambda)));
            }
        }
        let parts = |own: &[Complex64]| [own.iter().map(|own| own.re).collect(), own.iter().map(|own| own.im).collect()];
        let mut seeds: Vec<SolutionSeed> = Vec::new();
        let mut back: Vec<Backward> = Vec::new();
        for own in &all {
            let all: [[Vec<f64>; 2]; 3] = [&own.q, &own.mu, &own.p].map(|own| parts(own));
            let [q, mu, p] = all;
            seeds.extend(q.into_iter().zip(mu).map(|(x, mu)| SolutionSeed { x, mu }));
            back.extend(p.map(|p| Backward { p, ..Backward::of_parameters(0) }));
        }
        self.through_equilibrium(&mut seeds, &mut back)?;
        let mut ends = back.into_iter().zip(seeds).map(|(back, bar)| (back.p, bar.x));
        let mut next = || {
            let [(p, q), (other_p, other_q)] = [(); 2].map(|()| ends.next().unwrap_or_default());
            ValueSeeds { p: [p, other_p], q: [q, other_q] }
        };
        Ok(groups.iter().map(|group| (0..group.right.len().pow(2)).map(|_| next()).collect()).collect())
    }

    /// Takes gradients towards the solution of E = 0 to those towards parameters, and to what the coordinates of the start still are.
    fn through_equilibrium(&self, seeds: &mut [SolutionSeed], back: &mut [Backward]) -> Result<(), RunError> {
        let (model, groups) = (self.system.model, &self.vectors.groups);
        // what fades without a vibration may be free of stiffness, and much slower than all that has some
        let lowest_of = |are_vibrating: bool| {
            let own = groups.iter().filter(|group| !are_vibrating || group.lambda.im != 0.0);
            own.map(|group| group.lambda.norm_sqr()).fold(f64::INFINITY, f64::min)
        };
        let lowest = if lowest_of(true).is_finite() { lowest_of(true) } else { lowest_of(false) };
        let shift = if self.is_free { RESTING_SHIFT * lowest } else { 0.0 };
        // states that integrate what moves have a place in C alone; half the lowest value is none of a mode, where the matrix would be singular
        let rate = if model.state_dofs().next().is_some() { 2.0 * shift / lowest.sqrt() } else { 0.0 };
        let record = SolveRecord {
            t: self.t,
            equations: Equations::stage(StageCoefficients::new(shift, rate, 1.0), Level::Position),
            base: VectorsAvq { q: self.vectors.q.clone(), ..VectorsAvq::zeros(model.dofs) },
            unknowns: self.vectors.reactions.clone(),
        };
        let mut solver = TransposedSolver::new(self.system.clone(), self.method, self.active)?;
        let largest = |list: &[f64]| list.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        let mut sizes: Vec<f64> = seeds.iter().map(|bar| largest(&bar.x)).collect();
        let mut before = f64::INFINITY;
        for _ in 0..MOST_PASSES {
            let bases = solver.through(&record, self.p, seeds, back, &mut Counters::default())?;
            let mut change = 0.0_f64;
            for ((bar, base), size) in seeds.iter_mut().zip(bases).zip(&mut sizes) {
                bar.x.iter_mut().zip(&base.q).for_each(|(bar, base)| *bar += base);
                bar.mu.fill(0.0);
                let own = largest(&base.q);
                *size = size.max(own);
                change = change.max(if own == 0.0 { 0.0 } else { own / *size });
            }
            if !self.is_free {
                // but for what is fixed where the design puts it, the place does not depend on the one from which it was looked for: what is left is round-off
                let moving = || model.nodes.iter().filter(|node| !node.fixed).map(|node| node.dofs.clone());
                seeds.iter_mut().for_each(|bar| moving().for_each(|dofs| bar.x[dofs].fill(0.0)));
                return Ok(());
            }
            if change <= SETTLED || (change <= UNSETTLED && change > 0.5 * before) {
                return Ok(());
            }
            before = change;
        }
        Err(RunError::Input(
            "derivatives of modes: what the equilibrium does to them does not settle: something moves freely or has no rest of its own beside what is \
             much softer or slower than the modes that are asked for; ask for more modes"
                .into(),
        ))
    }

    /// The gradient of w^T B z towards (q, mu, p).
    fn seeds(
        &self,
        products: &mut Products<Complex64>,
        (left, right): (&Amplitude, &Amplitude),
        lambda: Complex64,
    ) -> AdjointSeeds {
        let system = &*self.system;
        let dofs = system.model.dofs;
        let equations = Equations::EQUILIBRIUM;
        let lift = |list: &[f64]| list.iter().map(|&own| Complex64::from(own)).collect::<Vec<_>>();
        let p = lift(self.p);
        let adjoints = [(|own| own.re) as fn(&Complex64) -> f64, |own| own.im].map(|part| Adjoints {
            f: left.x.iter().map(|own| part(own).into()).collect(),
            g: left.mu.iter().map(|own| part(own).into()).collect(),
        });
        let zeros = |count: usize| vec![Complex64::ZERO; count];
        let mut sum = AdjointSeeds { q: zeros(dofs), mu: zeros(right.mu.len()), p: zeros(p.len()) };
        for (of_right, part) in [(Complex64::ONE, (|own| own.re) as fn(&Complex64) -> f64), (Complex64::I, |own| own.im)] {
            let moved = |factor: Complex64| -> Vec<Complex64> {
                right.x.iter().map(|x| Complex64::new(0.0, COMPLEX_STEP * part(&(x * factor)))).collect()
            };
            let v = if self.is_damped { moved(lambda) } else { zeros(dofs) };
            let mut at = VectorsAvq { a: moved(lambda * lambda), v, q: moved(Complex64::ONE) };
            at.q.iter_mut().zip(&self.vectors.q).for_each(|(q, &own)| *q += own);
            let mu = self.vectors.reactions.mu.iter().zip(&right.mu);
            let mu = mu.map(|(&own, nu)| Complex64::new(own, COMPLEX_STEP * part(nu))).collect();
            let unknowns = Unknowns { mu, ..Residual::<Complex64>::unknowns(system) };
            let mut own = [(); 2].map(|()| (zeros(3 * dofs), zeros(p.len())));
            let mut into = own.each_mut().map(|(avq, p)| ProductSeeds { avq, p });
            let there = ProductPoint { at: &at, p: &p, t: self.t };
            products.add_elements(system, &adjoints, (Force::of(&equations), 1.0), there, &mut into);
            products.add_constraints(system, (&equations, ConstraintPart::Both), &adjoints, &unknowns, there, &mut into);
            let still = self.rates(&at.q, None, &p);
            for ((adjoint, (avq, own_p)), of_left) in adjoints.iter().zip(&own).zip([Complex64::ONE, Complex64::I]) {
                let rates = self.rates(&at.q, Some(&adjoint.f), &p);
                let factor = of_left * of_right / COMPLEX_STEP;
                let add = |sum: &mut [Complex64], own: &mut dyn Iterator<Item = Complex64>| {
                    sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * own.im);
                };
                add(&mut sum.q, &mut avq[2 * dofs..].iter().copied());
                add(&mut sum.p, &mut own_p.iter().copied());
                add(&mut sum.mu, &mut rates.iter().zip(&still).map(|(moving, still)| moving - still));
            }
        }
        sum
    }

    /// dg/dt of all constraints for velocities, or for none.
    fn rates(&self, q: &[Complex64], v: Option<&[Complex64]>, p: &[Complex64]) -> Vec<Complex64> {
        let system = &*self.system;
        let equations = Equations::stage(StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity);
        let zeros = || vec![Complex64::ZERO; q.len()];
        let base = VectorsAvq { a: zeros(), v: v.map_or_else(zeros, <[_]>::to_vec), q: q.to_vec() };
        let stage = StageSystem { equations: &equations, base: &base, p, t: self.t };
        let mut residual = Residual::<Complex64>::default();
        residual.start(system, stage);
        residual.evaluate(system, stage, &mut Residual::unknowns(system));
        residual.g
    }
}

/// Derivatives of the values of a group by one variable, from those of w_i^T B z_j, the lowest frequency first: one for each mode.
pub(crate) fn value_rates(group: &ModeGroup, by_variable: &DMatrix<Complex64>) -> Option<Vec<Complex64>> {
    let inverse = group.slope.clone().try_inverse()?;
    let mut rates: Vec<Complex64> = match group.right.len() {
        1 => vec![-(by_variable[(0, 0)] * inverse[(0, 0)])],
        _ => complex_eigenvalues(-(inverse * by_variable))?,
    };
    rates.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
    rates.iter().all(|own| own.is_finite()).then_some(rates)
}
