use super::{Parameter, RecordedFunction, Table};
use crate::program::{ArgumentKind, Digest, Recorded};
use crate::scalar::{Curve, Interpolant, Scalar};
use std::hash::Hash;
use std::sync::Arc;

/// What a spring or damper of one's own answers with: a force or moment f(s, ds/dt, t, p), or an energy f(s, p). It is recorded once, so that
/// all derivatives are exact.
///
/// ```
/// use costate::prelude::*;
/// use costate::elements::entries::{GivenValue, SpringPart};
/// use costate::elements::forces::LineLaw;
/// use costate::elements::{Characteristic, ForceLaw};
///
/// /// Dry friction, smoothed: F = F0 tanh(v / v0)
/// #[derive(Hash)]
/// struct Friction;
/// impl ForceLaw for Friction {
///     fn parameters(&self) -> Vec<Parameter> {
///         vec![Parameter::new("F0", "N"), Parameter::positive("v0", "m/s")]
///     }
///     fn value<S: Scalar>(&self, [_, rate, _]: [S; 3], p: &[S]) -> S {
///         p[0] * (rate / p[1]).tanh()
///     }
/// }
///
/// let mut m = MechanismBuilder::<f64>::default();
/// let (ground, block) = (m.ground(), m.point("block", Vector3::new(1.0, 0.0, 0.0)));
/// m.point_mass("block", block, 2.0);
/// let law = Characteristic::of(Friction)?;
/// m.spring(&SpringPart::of::<LineLaw>(), "pad", &[ground, block], [("force", GivenValue::Law(law, vec![3.0, 1e-2]))]);
/// assert!(m.finish().is_ok());
/// # Ok::<(), String>(())
/// ```
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait ForceLaw: Hash + Send + Sync + 'static {
    /// Its parameters; an empty unit is that of the law.
    fn parameters(&self) -> Vec<Parameter>;
    /// The value for s, its rate and the time \[s\]. It chooses by [`Scalar::select`] and its kin: one that looks at a value is refused.
    fn value<S: Scalar>(&self, arguments: [S; 3], p: &[S]) -> S;
}

/// A [`ForceLaw`] that was recorded.
#[derive(Clone, Debug, Hash)]
pub struct Characteristic(RecordedFunction);

impl ForceLaw for Table {
    fn parameters(&self) -> Vec<Parameter> {
        self.parameters("")
    }
    fn value<S: Scalar>(&self, [s, ..]: [S; 3], p: &[S]) -> S {
        self.value(s, p)
    }
}

impl ForceLaw for Arc<Curve> {
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    fn value<S: Scalar>(&self, [s, ..]: [S; 3], _p: &[S]) -> S {
        s.on_curve(self, 0)
    }
}

impl Characteristic {
    /// Records a law.
    ///
    /// # Errors
    /// If it branches on a value.
    pub fn of<L: ForceLaw>(law: L) -> Result<Self, String> {
        let value = |x: &[Recorded], p: &[Recorded]| law.value([x[0], x[1], x[2]], p);
        RecordedFunction::record(
            "a characteristic",
            &Digest::of_typed(&law),
            (ArgumentKind::Number, 3),
            law.parameters(),
            value,
        )
        .map(Characteristic)
    }

    /// A law by values at points of s that may depend on the design, and its parameters.
    ///
    /// # Errors
    /// Fewer than two points, points that are not finite or do not increase, or another number of values.
    pub fn table<S: Scalar>(points: &[f64], values: &[S], way: Interpolant) -> Result<(Self, Vec<S>), String> {
        let table = Table::new(points, way)?;
        if points.len() != values.len() {
            return Err(format!("there are {} points, but {} values; give one for each", points.len(), values.len()));
        }
        let numbers = table.numbers(values);
        Ok((Self::of(table)?, numbers))
    }

    /// A law by values at points of s that are always the same: it has no parameters.
    ///
    /// # Errors
    /// As for [`Characteristic::table`].
    pub fn curve(points: &[f64], values: &[f64], way: Interpolant) -> Result<Self, String> {
        Self::of(Curve::new(points, values, way)?)
    }

    /// Its parameters.
    pub fn parameters(&self) -> &[Parameter] {
        self.0.parameters()
    }

    /// The value for s, its rate and the time.
    pub fn value<S: Scalar>(&self, arguments: [S; 3], p: &[S]) -> S {
        self.0.value(&arguments, p)
    }
}
