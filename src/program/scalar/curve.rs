use super::Scalar;
use super::slopes::{monotone_slopes, natural_slopes};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Knots of a monotone table of time that steps still end at: its second derivative jumps there, which costs methods above third order their
/// order; ends of steps at each of many knots would cost more. With a few more knots than this `esdirk4` is of order 3.3 (study `signals`).
pub const MOST_BREAKPOINTS: usize = 100;

/// How values are joined between knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolant {
    /// Cubic pieces that stay between the values of their two knots: the slope goes on at a knot, the second derivative jumps. Of constant
    /// slope beyond the ends.
    Monotone,
    /// A natural cubic spline: two derivatives go on, but it may leave the range of its values between knots. Of constant slope beyond the
    /// ends.
    Smooth,
    /// Straight lines, constant beyond the ends.
    Lines,
    /// Straight lines, which go on beyond the ends.
    LinesOn,
    /// The value of the last knot that was passed, before the first one its value.
    Steps,
}

impl Interpolant {
    /// Slopes at the knots, of which pieces are made beside the values; none where the values alone do.
    pub fn slopes<S: Scalar>(self, knots: &[f64], values: &[S]) -> Vec<S> {
        match self {
            Interpolant::Monotone => monotone_slopes(knots, values),
            Interpolant::Smooth => natural_slopes(knots, values),
            Interpolant::Lines | Interpolant::LinesOn | Interpolant::Steps => Vec::new(),
        }
    }

    /// Whether the value or the slope jumps at the knots.
    pub fn has_kinks(self) -> bool {
        matches!(self, Interpolant::Lines | Interpolant::LinesOn | Interpolant::Steps)
    }
}

/// A function of one number in cubic pieces, one before the first knot, one between each two, one behind the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    knots: Vec<f64>,
    /// Coefficients of each piece: c0 + c1 u + c2 u^2 + c3 u^3, u = t less the knot on its left, that of the first piece less the first knot.
    pieces: Vec<[f64; 4]>,
    /// The last knot belongs to the piece on its left.
    is_closed: bool,
    has_kinks: bool,
    has_breakpoints: bool,
}

impl Hash for Curve {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.knots.len().hash(state);
        let numbers = self.knots.iter().chain(self.pieces.as_flattened());
        numbers.for_each(|number| number.to_bits().hash(state));
        (self.is_closed, self.has_kinks, self.has_breakpoints).hash(state);
    }
}

/// That knots are at least two, finite, and increase.
///
/// # Errors
/// Otherwise; the message shows which knot.
pub fn check_knots(knots: &[f64]) -> Result<(), String> {
    if knots.len() < 2 {
        return Err(format!("a table needs at least 2 knots, not {}", knots.len()));
    }
    if let Some(i) = knots.iter().position(|t| !t.is_finite()) {
        return Err(format!("the knots of a table must be finite: knot {i} is {}", knots[i]));
    }
    match (1..knots.len()).find(|&i| knots[i] <= knots[i - 1]) {
        Some(i) => Err(format!("the knots of a table must increase: knot {i} is {} after {}", knots[i], knots[i - 1])),
        None => Ok(()),
    }
}

impl Curve {
    /// The curve through values at knots.
    ///
    /// # Errors
    /// Fewer than two knots, knots that do not increase, another number of values, or numbers that are not finite; the message shows which.
    pub fn new(knots: &[f64], values: &[f64], interpolant: Interpolant) -> Result<Arc<Self>, String> {
        check_knots(knots)?;
        if knots.len() != values.len() {
            return Err(format!("there are {} knots, but {} values; give one for each", knots.len(), values.len()));
        }
        if let Some(i) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!("the values of a table must be finite: value {i} is {}", values[i]));
        }
        let (slopes, last) = (interpolant.slopes(knots, values), knots.len() - 1);
        let slope = |k: usize| slopes.get(k).copied().unwrap_or(0.0);
        let inner = (0..last).map(|k| {
            let (y, h) = (values[k], knots[k + 1] - knots[k]);
            let secant = (values[k + 1] - y) / h;
            match interpolant {
                Interpolant::Steps => [y, 0.0, 0.0, 0.0],
                Interpolant::Lines | Interpolant::LinesOn => [y, secant, 0.0, 0.0],
                Interpolant::Monotone | Interpolant::Smooth => {
                    let [left, right] = [slope(k) - secant, slope(k + 1) - secant];
                    [y, slope(k), -(left + left + right) / h, (left + right) / (h * h)]
                }
            }
        });
        let slope_beyond = |k: usize| match interpolant {
            Interpolant::LinesOn => {
                let first = k.min(last - 1);
                (values[first + 1] - values[first]) / (knots[first + 1] - knots[first])
            }
            _ => slope(k),
        };
        let end = |k: usize| [values[k], slope_beyond(k), 0.0, 0.0];
        let pieces = std::iter::once(end(0)).chain(inner).chain([end(last)]).collect();
        let has_kinks = interpolant.has_kinks();
        Ok(Arc::new(Self::of_pieces(knots, pieces, !has_kinks).joined_by(interpolant)))
    }

    /// Of its pieces, one more than knots.
    pub fn of_pieces(knots: &[f64], pieces: Vec<[f64; 4]>, is_closed: bool) -> Self {
        Curve { knots: knots.to_vec(), pieces, is_closed, has_kinks: false, has_breakpoints: false }
    }

    /// Says how smooth what is made of it is at its knots.
    pub fn joined_by(self, interpolant: Interpolant) -> Self {
        let has_kinks = interpolant.has_kinks();
        let curvature_jumps = interpolant == Interpolant::Monotone && self.knots.len() <= MOST_BREAKPOINTS;
        Curve { has_kinks, has_breakpoints: has_kinks || curvature_jumps, ..self }
    }

    /// The knots.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Slopes before the first knot and behind the last.
    pub fn slopes_beyond(&self) -> [f64; 2] {
        [self.pieces[0][1], self.pieces[self.pieces.len() - 1][1]]
    }

    /// The highest power that a piece has.
    pub fn degree(&self) -> u32 {
        (1..4).rev().find(|&power| self.pieces.iter().any(|piece| piece[power as usize] != 0.0)).unwrap_or(0)
    }

    /// Whether value or slope jump at the knots.
    pub fn has_kinks(&self) -> bool {
        self.has_kinks
    }

    /// Whether steps end at its knots where it is a function of time.
    pub fn has_breakpoints(&self) -> bool {
        self.has_breakpoints
    }

    /// Number of the piece at `t`, from 0 before the first knot on.
    pub fn piece(&self, t: f64) -> usize {
        let last = self.knots.len() - 1;
        if self.is_closed && t == self.knots[last] { last } else { self.knots.partition_point(|&own| own <= t) }
    }

    /// A place within a piece, not 0: the piece itself as a number.
    pub fn within(&self, piece: usize) -> f64 {
        let last = self.knots.len() - 1;
        let [left, right] = [piece.clamp(1, last) - 1, piece.clamp(1, last)].map(|knot| self.knots[knot]);
        let at = |share: f64| match piece {
            0 => left - share * (right - left),
            _ if piece > last => right + share * (right - left),
            _ => left + share * (right - left),
        };
        if at(0.5) == 0.0 { at(0.25) } else { at(0.5) }
    }

    /// The derivative of order `order` at `t`, the value itself for 0.
    ///
    /// At a knot the piece to the right counts, at the last one that to the left if it is closed.
    pub fn value(&self, order: usize, t: f64) -> f64 {
        let piece = self.piece(t);
        let ([c0, c1, c2, c3], u) = (self.pieces[piece], t - self.knots[piece.saturating_sub(1)]);
        match order {
            0 => ((c3 * u + c2) * u + c1) * u + c0,
            1 => (3.0 * c3 * u + 2.0 * c2) * u + c1,
            2 => 6.0 * c3 * u + 2.0 * c2,
            3 => 6.0 * c3,
            _ => 0.0,
        }
    }
}
