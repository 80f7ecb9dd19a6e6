use crate::elements::RunScalar;
use crate::scalar::{Scalar, Tangents};

/// How many values y with weights w, of points and times, become one number near the largest.
///
/// Weights are those of the integrator over time, and 1 for each point or its area. With the sums
///
/// N = sum of w y^n k,   D = sum of w k,   M = sum of w
///
/// it is c + ln(D) / rho for the smooth and the upper maximum, and N / D for the induced ones. The upper maximum has weights of 1 for all points
/// and samples in time: of n values it is at least the largest, and at most ln(n) / rho above it. The offset c is the largest value of the run, so that no
/// k overflows; neither the aggregate nor its gradient depends on it.
///
/// | kind | k | n | tends to, as rho grows |
/// |---|---|---|---|
/// | [`SmoothMaximum`](AggregateKind::SmoothMaximum) | exp(rho (y - c)) | | the maximum: with D / M for D from below, with D itself from above where all weights are 1 |
/// | [`UpperMaximum`](AggregateKind::UpperMaximum) | exp(rho (y - c)) | | the maximum, from above |
/// | [`Exponential`](AggregateKind::Exponential) | exp(rho (y - c)) | 1 | the maximum, from below |
/// | [`SquaredExponential`](AggregateKind::SquaredExponential) | exp(rho (y - c)) | 2 | its square, from below |
/// | [`Power`](AggregateKind::Power) | (\|y\| / c)^rho | 1 | the maximum of values that are not negative, from below |
/// | [`SquaredPower`](AggregateKind::SquaredPower) | (\|y\| / c)^rho | 2 | the square of the largest \|y\|, from below |
///
/// Sources: Kreisselmeier & Steinhauser (1979); Kennedy & Hicken (2015) for the induced ones; Boopathy & Kennedy, eq. (4) and Table 6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aggregate {
    /// Which one.
    pub kind: AggregateKind,
    /// rho: of exponentials in units of 1 / y, of powers a number of at least 2. See [`Aggregate::relative_to`].
    pub sharpness: f64,
    /// How points count.
    pub(crate) points: PointWeights,
}

/// Kinds of [aggregates](Aggregate).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AggregateKind {
    /// c + ln(D) / rho, or c + ln(D / M) / rho.
    SmoothMaximum {
        /// Divide by M, which makes the value independent of the units of time and area and at most the maximum; without, it is the form
        /// of Boopathy & Kennedy.
        normalized: bool,
    },
    /// c + ln(D) / rho where each point of each sample in time counts 1: a bound of all of them from above, whatever the steps are.
    UpperMaximum,
    /// Mean of y with weights that grow exponentially.
    Exponential,
    /// Mean of y^2 with the same weights.
    SquaredExponential,
    /// Mean of y with weights that are powers.
    Power,
    /// Mean of y^2 with the same weights.
    SquaredPower,
}

/// How the points of a group count in a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointWeights {
    /// 1 for each: the discrete form.
    Equal,
    /// The area, length or mass for which each point stands, as its quantity says: the continuous form.
    Own,
}

/// N, D and M.
pub(super) const SUMS: usize = 3;

/// The sums of an aggregate, relative to an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals<S> {
    /// c.
    pub offset: f64,
    /// N, D, M.
    pub sums: [S; SUMS],
}

impl Aggregate {
    /// All [kinds](AggregateKind), the smooth maximum normalized.
    pub const KINDS: [AggregateKind; 6] = [
        AggregateKind::SmoothMaximum { normalized: true },
        AggregateKind::UpperMaximum,
        AggregateKind::Exponential,
        AggregateKind::SquaredExponential,
        AggregateKind::Power,
        AggregateKind::SquaredPower,
    ];

    /// An aggregate in which all points count the same.
    pub const fn new(kind: AggregateKind, sharpness: f64) -> Self {
        Aggregate { kind, sharpness, points: PointWeights::Equal }
    }

    /// The smooth maximum of Kreisselmeier and Steinhauser, divided by the measure of points and times.
    pub const fn smooth_maximum(sharpness: f64) -> Self {
        Self::new(AggregateKind::SmoothMaximum { normalized: true }, sharpness)
    }

    /// The upper maximum: a smooth bound from above.
    pub const fn upper_maximum(sharpness: f64) -> Self {
        Self::new(AggregateKind::UpperMaximum, sharpness)
    }

    /// Takes the sharpness of an exponential for one by a size of its quantity: rho = sharpness / size, which no unit changes. The upper
    /// maximum of n values is then within ln(n) / sharpness of that size. Powers have no unit: one of these has no value then.
    #[must_use]
    pub const fn relative_to(self, size: f64) -> Self {
        let has_size = size > 0.0 && !self.kind.is_power();
        let sharpness = if has_size { self.sharpness / size } else { f64::NAN };
        Aggregate { sharpness, ..self }
    }

    /// Points count by the areas for which they stand.
    #[must_use]
    pub const fn continuous(self) -> Self {
        Aggregate { points: PointWeights::Own, ..self }
    }

    /// Why it has no value, if so.
    pub(crate) fn mistake(&self) -> Option<String> {
        let Aggregate { kind, sharpness, points } = *self;
        if kind == AggregateKind::UpperMaximum && points == PointWeights::Own {
            return Some("an upper maximum whose points count by their areas, which bounds nothing".into());
        }
        let least = if kind.is_power() { 2.0 } else { f64::MIN_POSITIVE };
        let wanted = if kind.is_power() { "at least 2" } else { "greater than 0" };
        (!(least..f64::INFINITY).contains(&sharpness)).then(|| format!("a sharpness of {sharpness}; it must be {wanted}"))
    }

    /// Offset before any value.
    pub(super) fn first_offset(&self) -> f64 {
        if self.kind.is_power() { f64::MIN_POSITIVE } else { f64::NEG_INFINITY }
    }

    /// The offset that a value asks for.
    fn offset_of(&self, y: f64) -> f64 {
        if self.kind.is_power() { y.abs() } else { y }
    }

    /// The offset after some values that are beyond it, or not.
    pub(super) fn following<S: Scalar>(&self, offset: f64, values: &[[S; 2]]) -> f64 {
        values.iter().fold(offset, |largest, [y, _]| largest.max(self.offset_of(y.value())))
    }

    /// k: 1 where y is c.
    pub(super) fn kernel<S: Scalar>(&self, y: S, c: S) -> S {
        if self.kind.is_power() { (y.abs() / c).powf(self.sharpness) } else { ((y - c) * self.sharpness).exp() }
    }

    /// What a value with a weight adds to N, D and M.
    pub(super) fn terms<S: Scalar>(&self, y: S, weight: S, c: S) -> [S; SUMS] {
        let share = weight * self.kernel(y, c);
        let numerator = match self.kind {
            AggregateKind::SmoothMaximum { .. } | AggregateKind::UpperMaximum => S::zero(),
            AggregateKind::Exponential | AggregateKind::Power => share * y,
            AggregateKind::SquaredExponential | AggregateKind::SquaredPower => share * (y * y),
        };
        [numerator, share, weight]
    }

    /// The aggregate of these sums.
    pub(super) fn value<S: Scalar>(&self, Totals { offset, sums: [numerator, denominator, measure] }: Totals<S>) -> S {
        match self.kind {
            AggregateKind::SmoothMaximum { normalized } => {
                let mean = if normalized { denominator / measure } else { denominator };
                mean.ln() / self.sharpness + offset
            }
            AggregateKind::UpperMaximum => denominator.ln() / self.sharpness + offset,
            // powers of values that are all zero: nothing was there
            _ => denominator.select(numerator / denominator, S::zero()),
        }
    }
}

impl AggregateKind {
    /// With powers for weights.
    pub const fn is_power(self) -> bool {
        matches!(self, AggregateKind::Power | AggregateKind::SquaredPower)
    }

    /// What the largest value of all would give: that of y, of |y|, or of the squares.
    #[doc(hidden)]
    pub fn limit_value(self, smallest: f64, largest: f64) -> f64 {
        let either = if self.is_power() { largest.abs().max(smallest.abs()) } else { largest };
        match self {
            AggregateKind::SquaredExponential => largest * largest,
            AggregateKind::SquaredPower => either * either,
            _ => either,
        }
    }

    /// In the unit of y^2.
    pub fn is_squared(self) -> bool {
        matches!(self, AggregateKind::SquaredExponential | AggregateKind::SquaredPower)
    }
}

/// A number with a unit derivative of its own.
fn with_derivative(value: f64, place: usize) -> Tangents {
    let mut own = Tangents::from(value);
    own.add_to_part(place, 1.0);
    own
}

/// Derivatives of a formula of a few numbers towards each of them.
pub(super) fn derivatives<const N: usize>(values: [f64; N], formula: impl FnOnce([Tangents; N]) -> Tangents) -> [f64; N] {
    let result = formula(std::array::from_fn(|place| with_derivative(values[place], place)));
    std::array::from_fn(|place| result.part(place))
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [(f64, f64); 5] = [(0.3, 0.5), (1.7, 0.2), (1.1, 1.0), (1.6, 0.4), (0.0, 2.0)];

    /// The aggregate of [`VALUES`] with an offset, and its derivative towards each value and weight.
    fn aggregate(of: Aggregate, offset: f64) -> (f64, Vec<[f64; 2]>) {
        let sum = |terms: &mut dyn Iterator<Item = [f64; SUMS]>| {
            terms.fold([0.0; SUMS], |sums, own| std::array::from_fn(|i| sums[i] + own[i]))
        };
        let sums = sum(&mut VALUES.iter().map(|&(y, w)| of.terms(y, w, offset)));
        let seeds = derivatives(sums, |sums| of.value(Totals { offset, sums }));
        let gradient = VALUES.iter().map(|&(y, w)| {
            derivatives([y, w], |[y, w]| {
                let terms = of.terms(y, w, Tangents::from(offset));
                terms.into_iter().zip(seeds).map(|(term, bar)| term * bar).sum()
            })
        });
        (of.value(Totals { offset, sums }), gradient.collect())
    }

    #[test]
    fn neither_value_nor_gradient_depends_on_the_offset() {
        for kind in Aggregate::KINDS.into_iter().chain([AggregateKind::SmoothMaximum { normalized: false }]) {
            let of = Aggregate::new(kind, 7.0);
            let (value, gradient) = aggregate(of, 1.7);
            for offset in [0.9, 3.0] {
                let (other, of_other) = aggregate(of, offset);
                assert!((value - other).abs() < 1e-14 * value.abs().max(1.0), "{kind:?}: {value} {other}");
                for (own, other) in gradient.iter().flatten().zip(of_other.iter().flatten()) {
                    assert!((own - other).abs() < 1e-13, "{kind:?}: {own} {other}");
                }
            }
        }
    }

    #[test]
    fn powers_of_values_that_are_all_zero_are_zero() {
        for kind in [AggregateKind::Power, AggregateKind::SquaredPower] {
            let of = Aggregate::new(kind, 8.0);
            let sums = of.terms(0.0, 0.5, of.first_offset());
            assert_eq!(of.value(Totals { offset: of.first_offset(), sums }), 0.0, "{kind:?}");
            let seeds = derivatives(sums, |sums| of.value(Totals { offset: of.first_offset(), sums }));
            assert_eq!(seeds, [0.0; SUMS], "{kind:?}");
        }
    }

    #[test]
    fn each_kind_tends_to_the_largest_value_from_its_side() {
        for kind in Aggregate::KINDS.into_iter().filter(|kind| *kind != AggregateKind::UpperMaximum) {
            let largest: f64 = if kind.is_squared() { 1.7 * 1.7 } else { 1.7 };
            let gap = |sharpness: f64| largest - aggregate(Aggregate::new(kind, sharpness), 1.7).0;
            let gaps = [10.0, 100.0, 1000.0].map(gap);
            assert!(gaps[0] > gaps[1] && gaps[1] > gaps[2] && gaps[2] >= 0.0 && gaps[2] < 0.01, "{kind:?}: {gaps:?}");
        }
        // weights of 1: above, by the logarithm of the number of values at most
        let plain = AggregateKind::SmoothMaximum { normalized: false };
        let sums = |of: Aggregate| VALUES.iter().fold(0.0, |sum, &(y, _)| sum + of.terms(y, 1.0, 1.7)[1]);
        for (kind, sharpness) in
            [plain, AggregateKind::UpperMaximum].into_iter().flat_map(|kind| [(kind, 10.0), (kind, 100.0)])
        {
            let of = Aggregate::new(kind, sharpness);
            let value = of.value(Totals { offset: 1.7, sums: [0.0, sums(of), 5.0] });
            assert!(value > 1.7 && value <= 1.7 + 5.0_f64.ln() / sharpness, "{kind:?}: {value}");
        }
    }
}
