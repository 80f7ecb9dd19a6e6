use super::{Constraint, Element, Parameter, State};
use crate::scalar::{
    Complex, Curved, Direction, Dual, LANES, Lanes, Recordable, Rev, Reverse, Scalar, Taylor, add_gradient, curvature,
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

/// What the framework asks of an element in one scalar.
pub trait ElementIn<S> {
    /// Adds the residual to `r`.
    fn add_residual(&self, s: State<S>, p: &[S], t: S, r: &mut [S]);
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
    /// Times at which a load jumps.
    fn kink_times(&self, p: &[f64]) -> Vec<f64>;
}

impl<E: Element, S: Scalar> ElementIn<S> for E {
    fn add_residual(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        self.residual(s, p, t, r);
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
    fn kink_times(&self, p: &[f64]) -> Vec<f64> {
        self.kinks(p)
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
    ReactingConstraintIn<f64> + ReactingConstraintIn<Complex> + ReactingConstraintIn<Lanes> + ConstraintIn<Rev> + Send + Sync
{
    /// Number of coordinates.
    fn dof_count(&self) -> usize;
    /// Number of equations.
    fn equation_count(&self) -> usize;
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Writes g with its derivative along q(s) = q + s direction, recorded.
    fn along(&self, q: &[Rev], direction: &[f64], p: &[Rev], t: f64, g: &mut [Dual<Rev, 1>]);
    /// Writes A (equations by coordinates) and, for groups of eight directions of q, the derivative of A^T mu along them.
    fn linearize_reaction(
        &self,
        at: (&[f64], &[f64], f64),
        mu: &[f64],
        directions: &[Direction],
        gradients: &mut [f64],
        products: &mut [Direction],
    );
    /// Times at which the prescribed motion is not smooth.
    fn kink_times(&self, p: &[f64]) -> Vec<f64>;
}

impl<C: Constraint, S: Scalar> ConstraintIn<S> for C {
    fn value(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        self.g(q, p, t, g);
    }

    fn derivatives(&self, s: State<S>, p: &[S], t: S, t_rate: f64, g: &mut [Taylor<S>]) {
        let q: SmallVec<[Taylor<S>; 16]> =
            s.q.iter().zip(s.v.iter().zip(s.a)).map(|(&q, (&v, &a))| Taylor::new(q, v, a)).collect();
        let p: SmallVec<[Taylor<S>; 16]> = p.iter().map(|&p| Taylor::new(p, S::zero(), S::zero())).collect();
        self.g(&q, &p, Taylor::new(t, S::from(t_rate), S::zero()), g);
    }
}

impl<C: Constraint, S: Recordable> ReactingConstraintIn<S> for C {
    fn add_reaction(&self, q: &[S], mu: &[S], p: &[S], t: S, r: &mut [S]) {
        let p: SmallVec<[Reverse<S>; 16]> = p.iter().map(|&p| Reverse::constant(p)).collect();
        let work = |q: &[Reverse<S>]| {
            let mut g: SmallVec<[Reverse<S>; 6]> = SmallVec::from_elem(Reverse::default(), C::EQUATIONS);
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
        C::EQUATIONS
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn along(&self, q: &[Rev], direction: &[f64], p: &[Rev], t: f64, g: &mut [Dual<Rev, 1>]) {
        let q: SmallVec<[Dual<Rev, 1>; 16]> =
            q.iter().zip(direction).map(|(&re, &rate)| Dual { re, eps: [Rev::from(rate)] }).collect();
        let p: SmallVec<[Dual<Rev, 1>; 16]> = p.iter().map(|&p| Dual::constant(p)).collect();
        self.g(&q, &p, Dual::from(t), g);
    }
    fn linearize_reaction(
        &self,
        (q, p, t): (&[f64], &[f64], f64),
        mu: &[f64],
        directions: &[Direction],
        gradients: &mut [f64],
        products: &mut [Direction],
    ) {
        let p: SmallVec<[Curved; 16]> = p.iter().map(|&p| Curved::from(p)).collect();
        let function = |q: &[Curved], g: &mut [Curved]| self.g(q, &p, Curved::from(t), g);
        curvature(q, function, mu, directions, gradients, products);
    }
    fn kink_times(&self, p: &[f64]) -> Vec<f64> {
        self.kinks(p)
    }
}
