use super::Parameter;
use crate::program::{ArgumentKind, Formula, ProgramWork};
use crate::scalar::{COMPLEX_STEP, Complex64, Scalar};
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
    /// f at a time \[s\]. It chooses by [`Scalar::select`], [`Scalar::min`] and the like: one that looks at a value is refused.
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S;
    /// Times \[s\] at which f or one of its first two derivatives jumps: steps end there. A driver may have jumps of the second alone.
    fn breakpoints<S: Scalar>(&self, _p: &[S]) -> Vec<S> {
        Vec::new()
    }
}

/// A [`TimeFormula`] that was recorded.
#[derive(Clone)]
pub struct RecordedFunction {
    /// f of (t, p).
    formula: Arc<Formula>,
    parameters: Vec<Parameter>,
    /// Times of breakpoints as functions of p.
    breakpoints: Arc<Formula>,
}

impl fmt::Debug for RecordedFunction {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("RecordedFunction").field("parameters", &self.parameters).finish_non_exhaustive()
    }
}

/// Distance from a breakpoint at which both sides are compared, as a share of the time (or of 1 s, if that is more).
const BESIDE: f64 = 1e-5;

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
        let breakpoints = Formula::record(parameters.len(), |p| function.breakpoints(p));
        let breakpoints = breakpoints.map_err(|why| format!("the breakpoints of a function of time: {why}"))?;
        Ok(RecordedFunction { formula, parameters, breakpoints })
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

    /// Times at which f or one of its first two derivatives jumps.
    pub fn breakpoints<S: Scalar>(&self, p: &[S]) -> Vec<S> {
        let mut times = vec![S::zero(); self.breakpoints.outputs.len()];
        if !times.is_empty() {
            self.breakpoints.values().run_in(p, &mut times, &mut ProgramWork::default());
        }
        times
    }

    /// The first breakpoint at which f or df/dt jumps: there their differences across the breakpoint do not shrink with the distance.
    pub fn rate_jump(&self, p: &[f64]) -> Option<f64> {
        let p: Vec<Complex64> = p.iter().map(|&p| Complex64::from(p)).collect();
        let at = |t: f64| {
            let value = self.value(Complex64::new(t, COMPLEX_STEP), &p);
            [value.re, value.im / COMPLEX_STEP]
        };
        let across = |t: f64, distance: f64| {
            let (before, after) = (at(t - distance), at(t + distance));
            [0, 1].map(|k| ((after[k] - before[k]).abs(), before[k].abs() + after[k].abs()))
        };
        let jumps = |t: &f64| {
            let distance = BESIDE * t.abs().max(1.0);
            let (far, near) = (across(*t, distance), across(*t, 0.1 * distance));
            (0..2).any(|k| near[k].0 > 1e-9 * near[k].1 && near[k].0 > 0.5 * far[k].0)
        };
        self.breakpoints::<f64>(&p.iter().map(|p| p.re).collect::<Vec<f64>>()).into_iter().find(jumps)
    }
}
