// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::{Ended, Evaluations, NonlinearProgram, Reason, Sqp, Stopping};

/// A method that minimizes a [`NonlinearProgram`] by its gradients. A new one is a file here and a line in [`optimizers`].
pub trait Optimizer: Sync {
    /// Name on the command line.
    fn name(&self) -> &'static str;
    /// Why it cannot treat a program, in words.
    ///
    /// # Errors
    /// A kind of constraint that it does not know.
    fn check(&self, _evaluations: &Evaluations) -> Result<(), String> {
        Ok(())
    }
    /// Goes from `start` until the evaluations end it; calls [`Evaluations::accept`] after each iteration.
    fn go(&self, evaluations: &mut Evaluations, start: &[f64]) -> Reason;
}

/// Minimizes a program from a start.
///
/// # Errors
/// A start of the wrong size or not finite; a program that the optimizer does not treat.
pub fn minimize(
    optimizer: &dyn Optimizer,
    program: &mut dyn NonlinearProgram,
    start: &[f64],
    stopping: Stopping,
) -> Result<Ended, String> {
    let mut evaluations = Evaluations::new(program, stopping);
    let n = evaluations.bounds().len();
    if start.len() != n {
        return Err(format!("the program has {n} variables, but the start has {} values", start.len()));
    }
    if let Some(i) = start.iter().position(|x| !x.is_finite()) {
        return Err(format!("variable {i} starts at {}; it must be finite", start[i]));
    }
    if let Some(i) = evaluations.bounds().iter().position(|(lower, upper)| !(lower <= upper)) {
        let (lower, upper) = evaluations.bounds()[i];
        return Err(format!("variable {i} must lie between {lower} and {upper}, where nothing lies"));
    }
    optimizer.check(&evaluations)?;
    let inside: Vec<f64> =
        start.iter().zip(evaluations.bounds()).map(|(x, (lower, upper))| x.clamp(*lower, *upper)).collect();
    let reason = optimizer.go(&mut evaluations, &inside);
    Ok(evaluations.end(reason))
}

/// All optimizers, the default one first.
pub fn optimizers() -> Vec<Box<dyn Optimizer>> {
    vec![Box::new(Sqp)]
}
