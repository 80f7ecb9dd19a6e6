use super::Parameter;
use crate::program::{ArgumentKind, Digest, Formula, ProgramWork, Recorded};
use crate::scalar::Scalar;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// A function of time of one's own, f(t, p), for loads and drivers: recorded once, so that all derivatives by t and p are exact.
///
/// ```
/// use costate::prelude::*;
///
/// /// A sine whose frequency grows: f = A sin(w t + r t^2 / 2)
/// #[derive(Hash)]
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
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait TimeFormula: Hash + Send + Sync + 'static {
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

/// A formula of one's own that was recorded: of some arguments, and of parameters.
#[derive(Clone)]
pub struct RecordedFunction {
    formula: Arc<Formula>,
    parameters: Vec<Parameter>,
}

impl fmt::Debug for RecordedFunction {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("RecordedFunction").field("parameters", &self.parameters).finish_non_exhaustive()
    }
}

impl Hash for RecordedFunction {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let names: Vec<&str> = self.parameters.iter().map(|own| &*own.name).collect();
        (self.formula.digest(), names).hash(state);
    }
}

impl RecordedFunction {
    /// Records a function of time.
    ///
    /// # Errors
    /// If it branches on a value.
    pub fn of<F: TimeFormula>(function: F) -> Result<Self, String> {
        let value = |t: &[Recorded], p: &[Recorded]| function.value(t[0], p);
        Self::record(
            "a function of time",
            &Digest::of_typed(&function),
            (ArgumentKind::Time, 1),
            function.parameters(),
            value,
        )
    }

    /// Records what messages call `what`, of so many arguments of a kind.
    pub(super) fn record(
        what: &str,
        origin: &Digest,
        arguments: (ArgumentKind, usize),
        parameters: Vec<Parameter>,
        value: impl Fn(&[Recorded], &[Recorded]) -> Recorded,
    ) -> Result<Self, String> {
        let formula = Formula::once(&(origin, arguments), || {
            Formula::record([arguments, (ArgumentKind::Parameter, parameters.len())], |x| {
                let (arguments, p) = x.split_at(arguments.1);
                vec![value(arguments, p)]
            })
        });
        Ok(RecordedFunction { formula: formula.map_err(|why| format!("{what}: {why}"))?, parameters })
    }

    /// Its parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The value for its arguments.
    pub fn value<S: Scalar>(&self, arguments: &[S], p: &[S]) -> S {
        let (inputs, mut result) = ([arguments, p].concat(), [S::zero()]);
        self.formula.values().run_in(&inputs, &mut result, &mut ProgramWork::default());
        result[0]
    }
}
