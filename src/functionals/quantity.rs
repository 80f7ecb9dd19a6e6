use crate::elements::entries::{Entry, Erase, Part};
use crate::elements::{OfStates, Parameter, State, paired, split_arguments};
use crate::program::ArgumentKind::{Acceleration, Coordinate, MeasureParameter, Multiplier, Time, Velocity};
use crate::program::{Digest, Formula, Recorded, along_motion};
use crate::scalar::Scalar;
use std::hash::Hash;
use std::sync::{Arc, OnceLock};

/// A number at one time, from the states of some nodes and the multipliers of some constraints: one formula, and nothing else.
///
/// Give [`value`](Quantity::value), or numbers e(q, p, t) whose rates along the motion it needs, and the value as a function of these.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait Quantity: Hash + Send + Sync + 'static {
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Number of coordinates of its nodes together.
    fn dofs(&self) -> usize;
    /// Its unit, "-" if it has none.
    fn unit(&self) -> &'static str;
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// The value for states `s` of its nodes and multipliers `mu` of its constraints, one after the other.
    fn value<S: Scalar>(&self, _s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        S::from(f64::NAN)
    }
    /// How many numbers e there are; 0 where [`value`](Quantity::value) is given.
    fn rated_count(&self) -> usize {
        0
    }
    /// Numbers e(q, p, t) whose rates are needed, into `e`, which holds zeros before.
    fn rated<S: Scalar>(&self, _q: &[S], _p: &[S], _t: S, _e: &mut [S]) {}
    /// The value for these numbers and their rates.
    fn value_with_rates<S: Scalar>(&self, _e: &[S], _rate: &[S], _p: &[S]) -> S {
        S::from(f64::NAN)
    }
}

/// A quantity with its type erased; every [`Quantity`] is one.
pub trait AnyQuantity: Send + Sync {
    /// What its formula is recorded of.
    fn origin(&self) -> Digest;
    /// Number of coordinates.
    fn dof_count(&self) -> usize;
    /// Its unit.
    fn unit(&self) -> &'static str;
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Records the value as a function of (a, v, q, mu, p, t) for a number of multipliers.
    fn record(&self, multipliers: usize) -> Result<Arc<Formula>, String>;
}

impl<Q: Quantity> AnyQuantity for Q {
    fn origin(&self) -> Digest {
        Digest::of_typed(self)
    }
    fn dof_count(&self) -> usize {
        self.dofs()
    }
    fn unit(&self) -> &'static str {
        Quantity::unit(self)
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn record(&self, multipliers: usize) -> Result<Arc<Formula>, String> {
        let (n, m) = (self.dofs(), self.parameters().len());
        let state = [Acceleration, Velocity, Coordinate].map(|kind| (kind, n));
        let rest = [(Multiplier, multipliers), (MeasureParameter, m), (Time, 1)];
        Formula::record([state, rest].concat(), |x| {
            let [a, v, q, mu, p, t] = split_arguments(x, [n, n, n, multipliers, m, 1]);
            let rated = self.rated_count();
            if rated == 0 {
                return vec![self.value(State { a, v, q }, mu, p, t[0])];
            }
            let mut e = vec![Recorded::from(0.0); rated];
            self.rated(q, p, t[0], &mut e);
            let moving = [paired(q, v), vec![(t[0], Recorded::from(1.0))]].concat();
            vec![self.value_with_rates(&e, &along_motion(&e, &moving), p)]
        })
    }
}

/// A quantity of a list.
pub type QuantityPart = Part<dyn AnyQuantity>;

impl<Q: Quantity> Erase<dyn AnyQuantity> for Q {
    fn erased(self) -> Box<dyn AnyQuantity> {
        Box::new(self)
    }
}

/// What is done with every quantity of the library that has an entry, each with its own type.
pub trait QuantityVisitor {
    /// Does it with one.
    fn visit<Q: Entry<Law: Quantity>>(&mut self);
}

/// A quantity of a model with its recording, made when it is first asked for.
pub struct MeasuredQuantity {
    own: Box<dyn AnyQuantity>,
    multipliers: usize,
    /// Which of its coordinates are states of first order that are unknowns like coordinates.
    states: Vec<usize>,
    /// Whether its formula has the sides of its switches among its arguments.
    has_sides: bool,
    formula: OnceLock<Result<Arc<Formula>, String>>,
}

impl MeasuredQuantity {
    /// A quantity that sees some number of multipliers.
    pub fn new(own: Box<dyn AnyQuantity>, multipliers: usize) -> Self {
        MeasuredQuantity { own, multipliers, states: Vec::new(), has_sides: false, formula: OnceLock::new() }
    }
    /// The same with the sides of its switches as numbers behind its parameters.
    pub(crate) fn with_sides(self) -> Self {
        MeasuredQuantity { has_sides: true, formula: OnceLock::new(), ..self }
    }
    /// How many they are.
    pub(crate) fn sides(&self) -> usize {
        if self.has_sides { self.recorded().as_ref().map_or(0, |formula| formula.sides()) } else { 0 }
    }
    /// The same where some of its coordinates are states that are unknowns like coordinates.
    pub(crate) fn at_rest(self, states: Vec<usize>) -> Self {
        MeasuredQuantity { states, formula: OnceLock::new(), ..self }
    }
    fn recorded(&self) -> &Result<Arc<Formula>, String> {
        let record = || {
            let formula = self.own.record(self.multipliers)?;
            let formula = if self.has_sides { formula.with_sides()? } else { formula };
            if self.states.is_empty() {
                return Ok(formula);
            }
            formula.with_arguments(|x| {
                let mut all = x.to_vec();
                self.states.iter().for_each(|&dof| OfStates::InVelocity.in_motion(&mut all, self.dof_count(), dof));
                all
            })
        };
        let origin = || (self.own.origin(), self.multipliers, self.has_sides, &self.states);
        self.formula.get_or_init(|| Formula::once(&origin(), record))
    }
    /// Its parameters.
    pub fn parameter_list(&self) -> Vec<Parameter> {
        self.own.parameter_list()
    }
    pub(super) fn dof_count(&self) -> usize {
        self.own.dof_count()
    }
    pub(super) fn multiplier_count(&self) -> usize {
        self.multipliers
    }
    /// Why its formula cannot be used, if so.
    pub fn refused(&self) -> Option<&str> {
        self.recorded().as_ref().err().map(String::as_str)
    }
    /// The value of (a, v, q, mu, p, t).
    pub fn formula(&self) -> &Arc<Formula> {
        self.recorded().as_ref().unwrap_or_else(|why| panic!("a quantity that was not checked before a run: {why}"))
    }
}
