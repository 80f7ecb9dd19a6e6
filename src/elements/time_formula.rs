use super::Parameter;
use crate::program::{ArgumentKind, Formula, ProgramWork};
use crate::scalar::Scalar;
use std::fmt;
use std::sync::Arc;

/// A function of time of one's own, f(t, p), for loads and drivers: recorded once, so that all derivatives by t and p are exact.
///
/// ```
/// use costate::prelude::*;
///
/// /// A sine whose frequency grows: f = A sin(w t + r t^2 / 2)
/// struct Chirp;
/// impl TimeFormula for Chirp {
///     const PARAMETERS: &'static [Parameter] =
///         &[Parameter::new("amplitude", "N"), Parameter::new("w", "rad/s"), Parameter::new("r", "rad/s2")];
///     fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
///         p[0] * ((p[1] + p[2] * t * 0.5) * t).sin()
///     }
/// }
///
/// let mut m = MechanismBuilder::<f64>::default();
/// let mass = m.point("mass", Vector3::zeros());
/// m.point_mass("mass", mass, 2.0);
/// let (direction, frame) = (Vector3::new(1.0, 0.0, 0.0), LoadFrame::World);
/// let size = Signal::own(Chirp, &[3.0, 1.0, 0.5])?;
/// m.force("shaker", Force { on: mass, point: Vector3::zeros(), direction, frame, size });
/// assert!(m.finish().is_ok());
/// # Ok::<(), String>(())
/// ```
pub trait TimeFormula: Send + Sync + 'static {
    /// Its parameters.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Its parameters, where their number is an option of the function.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// f at a time \[s\]. It chooses by [`Scalar::select`], [`Scalar::min`] and the like: one that looks at a value is refused. Steps end
    /// where the side of a choice changes, which is found from the recording. The value and the rate of a driven motion must not jump there.
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S;
}

/// A [`TimeFormula`] that was recorded.
#[derive(Clone)]
pub struct RecordedFunction {
    /// f of (t, p).
    formula: Arc<Formula>,
    parameters: Vec<Parameter>,
}

impl fmt::Debug for RecordedFunction {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("RecordedFunction").field("parameters", &self.parameters).finish_non_exhaustive()
    }
}

impl RecordedFunction {
    /// Records a function.
    ///
    /// # Errors
    /// If it branches on a value.
    pub fn of<F: TimeFormula>(function: F) -> Result<Self, String> {
        let parameters = function.parameters();
        let formula = Formula::record([(ArgumentKind::Time, 1), (ArgumentKind::Parameter, parameters.len())], |x| {
            vec![function.value(x[0], &x[1..])]
        });
        let formula = formula.map_err(|why| format!("a function of time: {why}"))?;
        Ok(RecordedFunction { formula, parameters })
    }

    /// Its parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// f(t).
    pub fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        let (inputs, mut result) = ([&[t], p].concat(), [S::zero()]);
        self.formula.values().run_in(&inputs, &mut result, &mut ProgramWork::default());
        result[0]
    }
}
