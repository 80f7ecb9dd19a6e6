/// Whether a constraint c is an equality or an inequality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintKind {
    /// c(x) = 0.
    Equality,
    /// c(x) <= 0.
    AtMostZero,
}

/// Objective and constraints at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// f.
    pub objective: f64,
    /// c, in the order of [`NonlinearProgram::constraints`].
    pub constraints: Vec<f64>,
}

/// Gradients at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// df/dx.
    pub objective: Vec<f64>,
    /// dc/dx, one row for each constraint.
    pub constraints: Vec<Vec<f64>>,
}

/// Why a point has no values or gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoValue {
    /// The functions do not exist there: to an optimizer the objective is infinite.
    Failed,
    /// Someone wants the optimization to end.
    Stop,
}

/// What a point has, or nothing where it failed.
pub(super) fn unless_failed<T>(found: Result<T, NoValue>) -> Result<Option<T>, NoValue> {
    match found {
        Err(NoValue::Failed) => Ok(None),
        found => found.map(Some),
    }
}

/// What an optimizer sees: minimize f(x) with lower <= x <= upper and c(x) = 0 or c(x) <= 0.
///
/// Variables, objective and constraints should be of the order of 1: optimizers measure all of them with one measure.
pub trait NonlinearProgram {
    /// Least and largest value of each variable; infinite where there is none.
    fn bounds(&self) -> Vec<(f64, f64)>;
    /// What the constraints are.
    fn constraints(&self) -> Vec<ConstraintKind> {
        Vec::new()
    }
    /// Number of the first of the linear constraints, which come last and, once they hold, stay so.
    fn linear_from(&self) -> usize {
        self.constraints().len()
    }
    /// Objective and constraints. Points lie within the bounds.
    ///
    /// # Errors
    /// See [`NoValue`].
    fn values(&mut self, x: &[f64]) -> Result<Values, NoValue>;
    /// Gradients, asked for after the values of the same point, often right after.
    ///
    /// # Errors
    /// See [`NoValue`].
    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, NoValue>;
    /// The optimizer has reached `x` with its iteration of this number, 0 at the start; `false` ends the optimization.
    fn reached(&mut self, _x: &[f64], _iteration: usize) -> bool {
        true
    }
}
