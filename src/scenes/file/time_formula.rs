//! Functions of time that a file gives as formulas.

use super::expression::{Expression, Quantity};
use crate::elements::{Parameter, TimeFormula};
use crate::scalar::{Scalar, Vector3};

/// A formula of the time, which is recorded like one of a program: exact at all times, with all derivatives. The names that it uses are its
/// parameters.
pub(super) struct FormulaOfTime {
    /// Of the names that it uses, in their order, and the time behind them.
    formula: Expression,
    /// Which of these are vectors.
    is_vector: Vec<bool>,
    /// Times at which steps end \[s\].
    breakpoints: Vec<f64>,
}

impl FormulaOfTime {
    /// The function of a formula whose last name is the time, and its parameters.
    pub fn of<S: Scalar>(formula: &Expression, names: &[Quantity<S>], breakpoints: Vec<f64>) -> (Self, Vec<S>) {
        let used: Vec<usize> = (0..names.len()).filter(|name| formula.uses(*name)).collect();
        let place = |name: usize| used.binary_search(&name).unwrap_or(used.len());
        let is_vector = used.iter().map(|&name| matches!(names[name], Quantity::Vector(_))).collect();
        let parameters = used.iter().flat_map(|&name| names[name].components()).collect();
        (FormulaOfTime { formula: formula.renamed(place), is_vector, breakpoints }, parameters)
    }
}

impl TimeFormula for FormulaOfTime {
    fn parameters(&self) -> Vec<Parameter> {
        let count: usize = self.is_vector.iter().map(|&is_vector| if is_vector { 3 } else { 1 }).sum();
        (0..count).map(|i| Parameter::named(format!("number {i} of the formula"), "")).collect()
    }

    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
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
        names.push(Quantity::Number(t));
        match self.formula.value(&names) {
            Quantity::Number(own) => own,
            Quantity::Vector(_) => S::from(f64::NAN),
        }
    }

    fn breakpoints<S: Scalar>(&self, _p: &[S]) -> Vec<S> {
        self.breakpoints.iter().map(|&time| S::from(time)).collect()
    }
}
