use super::Parameter;
use crate::scalar::{Curve, Interpolant, Scalar, check_knots};
use std::sync::Arc;

/// A function of one number through values at knots that are parameters: they may depend on the design, the knots do not.
///
/// A piece is found by one look-up and its numbers are gathered from the parameters, so that the effort does not grow with the number of
/// knots. Parameters: the values y; for cubic pieces the slopes at the knots follow, as [`Table::numbers`] makes them of the values. A table
/// whose values are always the same is a [`Curve`], which has no parameters.
#[derive(Clone, Debug, PartialEq, Hash)]
pub struct Table {
    interpolant: Interpolant,
    /// Number k of the piece from x_k to x_{k+1}, the first and the last one beyond the ends; of steps that of the value.
    piece: Arc<Curve>,
    /// s = (t - x_k) / h_k, from 0 to 1.
    share: Arc<Curve>,
    /// h_k.
    width: Arc<Curve>,
    /// How far t is before the first knot, and behind the last: less than 0, more than 0, otherwise 0.
    beyond: [Arc<Curve>; 2],
}

impl Table {
    /// A table over knots.
    ///
    /// # Errors
    /// Fewer than two knots, or knots that are not finite or do not increase; the message shows which.
    pub fn new(knots: &[f64], interpolant: Interpolant) -> Result<Self, String> {
        check_knots(knots)?;
        let last = knots.len() - 1;
        let pieces = |first: [f64; 4], inner: &dyn Fn(usize) -> [f64; 4], end: [f64; 4]| {
            let all = std::iter::once(first).chain((0..last).map(inner)).chain([end]).collect();
            Curve::of_pieces(knots, all, !interpolant.has_kinks())
        };
        let (number, h) = (|k: f64| [k, 0.0, 0.0, 0.0], |k: usize| knots[k + 1] - knots[k]);
        let share = |from: f64, k: usize| [from, 1.0 / h(k), 0.0, 0.0];
        let (nothing, identity) = (number(0.0), [0.0, 1.0, 0.0, 0.0]);
        let end = if interpolant == Interpolant::Steps { last } else { last - 1 };
        let piece = pieces(nothing, &|k| number(k as f64), number(end as f64));
        let share = match interpolant {
            Interpolant::LinesOn => pieces(share(0.0, 0), &|k| share(0.0, k), share(1.0, last - 1)),
            _ => pieces(nothing, &|k| share(0.0, k), number(1.0)),
        };
        Ok(Table {
            interpolant,
            piece: Arc::new(piece.joined_by(interpolant)),
            share: Arc::new(if interpolant.has_kinks() { share.joined_by(interpolant) } else { share }),
            width: Arc::new(pieces(number(h(0)), &|k| number(h(k)), number(h(last - 1)))),
            beyond: [(identity, nothing), (nothing, identity)]
                .map(|(before, behind)| Arc::new(pieces(before, &|_| nothing, behind))),
        })
    }

    /// The knots.
    pub fn knots(&self) -> &[f64] {
        self.piece.knots()
    }

    /// The way between them.
    pub fn interpolant(&self) -> Interpolant {
        self.interpolant
    }

    /// Its parameters for values at the knots.
    pub fn numbers<S: Scalar>(&self, values: &[S]) -> Vec<S> {
        [values, &self.interpolant.slopes(self.knots(), values)].concat()
    }

    /// The parameters, those of values in `unit`.
    pub fn parameters(&self, unit: &'static str) -> Vec<Parameter> {
        let named = |name: &'static str, unit| {
            (1..=self.knots().len()).map(move |knot| Parameter::named(format!("{name} {knot}"), unit))
        };
        let slopes = named("slope", "of values per knots").take(if self.interpolant.has_kinks() { 0 } else { usize::MAX });
        named("value", unit).chain(slopes).collect()
    }

    /// The value at `t` for parameters `p`: in a piece with ends y and slopes m at its ends the Hermite cubic
    /// y_k + s^2 (3 - 2 s) (y_{k+1} - y_k) + h s (1 - s) ((1 - s) m_k - s m_{k+1}).
    pub fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        let (k, (y, m)) = (t.on_curve(&self.piece, 0), p.split_at(self.knots().len()));
        if self.interpolant == Interpolant::Steps {
            return k.gather(y);
        }
        let ends = |list: &[S]| [k.gather(&list[..list.len() - 1]), k.gather(&list[1..])];
        let ([left, right], s) = (ends(y), t.on_curve(&self.share, 0));
        let (Some(first), Some(last)) = (m.first(), m.last()) else { return left + (right - left) * s };
        let [rise_left, rise_right] = ends(m);
        let rest = -s + 1.0;
        let bend = t.on_curve(&self.width, 0) * s * rest * (rest * rise_left - s * rise_right);
        let [before, behind] = [0, 1].map(|end| t.on_curve(&self.beyond[end], 0));
        left + (right - left) * (s * s * (s * -2.0 + 3.0)) + bend + before * *first + behind * *last
    }
}
