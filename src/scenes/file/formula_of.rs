//! Functions of time and laws of springs that a file gives as formulas.

use super::expression::{Expression, Quantity};
use crate::elements::{ForceLaw, Parameter, TimeFormula};
use crate::scalar::{Scalar, Vector3};

/// A formula of some arguments, such as the time, which is recorded like one of a program: exact, with all derivatives. The names that it
/// uses beside them are its parameters.
pub(super) struct FormulaOf {
    /// Of the names that it uses, in their order, and the arguments behind them.
    formula: Expression,
    /// Which of the names are vectors.
    is_vector: Vec<bool>,
}

impl FormulaOf {
    /// The function of a formula whose last names are the arguments, and its parameters.
    pub fn of<S: Scalar>(formula: &Expression, names: &[Quantity<S>]) -> (Self, Vec<S>) {
        let used: Vec<usize> = (0..names.len()).filter(|name| formula.uses(*name)).collect();
        let place =
            |name: usize| used.binary_search(&name).unwrap_or_else(|_| used.len() + name.saturating_sub(names.len()));
        let is_vector = used.iter().map(|&name| matches!(names[name], Quantity::Vector(_))).collect();
        let parameters = used.iter().flat_map(|&name| names[name].components()).collect();
        (FormulaOf { formula: formula.renamed(place), is_vector }, parameters)
    }

    /// Number of its parameters.
    pub fn count(&self) -> usize {
        self.is_vector.iter().map(|&is_vector| if is_vector { 3 } else { 1 }).sum()
    }

    /// Its parameters, as part of what is called so.
    pub fn numbers(&self, of: &str) -> Vec<Parameter> {
        (1..=self.count()).map(|i| Parameter::named(format!("number {i} of {of}"), "-")).collect()
    }

    /// Its value for the arguments.
    pub fn at<S: Scalar>(&self, arguments: &[Quantity<S>], p: &[S]) -> Quantity<S> {
        let mut rest = p;
        let mut names = Vec::new();
        for is_vector in &self.is_vector {
            let (own, others) = rest.split_at(if *is_vector { 3 } else { 1 });
            names.push(match own {
                [x, y, z] => Quantity::Vector(Vector3::new(*x, *y, *z)),
                own => Quantity::Number(own[0]),
            });
            rest = others;
        }
        names.extend_from_slice(arguments);
        self.formula.value(&names)
    }

    /// Its value for arguments that are numbers, where it gives one.
    fn number<S: Scalar>(&self, arguments: &[S], p: &[S]) -> S {
        let arguments: Vec<Quantity<S>> = arguments.iter().map(|&own| Quantity::Number(own)).collect();
        match self.at(&arguments, p) {
            Quantity::Number(own) => own,
            Quantity::Vector(_) => S::from(f64::NAN),
        }
    }
}

impl TimeFormula for FormulaOf {
    fn parameters(&self) -> Vec<Parameter> {
        self.numbers("the formula")
    }
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        self.number(&[t], p)
    }
}

impl ForceLaw for FormulaOf {
    fn parameters(&self) -> Vec<Parameter> {
        self.numbers("the formula")
    }
    fn value<S: Scalar>(&self, arguments: [S; 3], p: &[S]) -> S {
        self.number(&arguments, p)
    }
}
