//! Points to go on from, after the end at a least violation that is not zero.

use super::evaluations::violation;
use super::program::unless_failed;
use super::quadratic::QuadraticProgram;
use super::{Evaluations, Gradients, NoValue, Values};

/// Points that are tried: so many for each variable and two more, ...
const TRIED: usize = 4;
/// ... at most.
const MOST_TRIED: usize = 60;
/// Share of the violation at the end that another point may have: less of a decrease is none.
const LESS: f64 = 0.9;
/// How often a search goes on elsewhere.
const MOST_ESCAPES: usize = 8;

/// A sequence of points that fill a box evenly, the same in every run.
///
/// Source: Roberts (2018), "The unreasonable effectiveness of quasirandom sequences": multiples of powers of the generalized golden ratio.
pub(super) struct Escape {
    points: usize,
    /// How often a point was looked for.
    escapes: usize,
    /// Share of the range of each variable by which the next point goes on.
    shares: Vec<f64>,
}

impl Escape {
    /// Of points of `n` numbers.
    pub fn new(n: usize) -> Self {
        // g^(n + 1) = g + 1
        let mut golden = 2.0_f64;
        for _ in 0..60 {
            golden = (1.0 + golden).powf(1.0 / (n as f64 + 1.0));
        }
        let shares = (1..=n).map(|i| golden.powi(-(i as i32))).collect();
        Escape { points: 0, escapes: 0, shares }
    }

    /// The next point, in ranges around `x` where a variable has no bounds.
    fn next(&mut self, bounds: &[(f64, f64)], x: &[f64], ranges: &[f64]) -> Vec<f64> {
        let place = |i: usize| {
            let ((lower, upper), share) = (bounds[i], (0.5 + self.points as f64 * self.shares[i]).fract());
            let (low, high) = (lower.max(x[i] - ranges[i]), upper.min(x[i] + ranges[i]));
            low + share * (high - low)
        };
        let point = (0..x.len()).map(place).collect();
        self.points += 1;
        point
    }

    /// A point that violates the constraints less than `x`, with its values and gradients: the first that keeps all of them, or the best of
    /// a number of points; `None` if there is none among them.
    ///
    /// # Errors
    /// [`NoValue::Stop`].
    pub fn from(
        &mut self,
        evaluations: &mut Evaluations,
        (x, values, gradients): (&[f64], &Values, &Gradients),
        ranges: &[f64],
    ) -> Result<Option<(Vec<f64>, Values, Gradients)>, NoValue> {
        self.escapes += 1;
        if self.escapes > MOST_ESCAPES {
            return Ok(None);
        }
        let mut best = None;
        let mut least = LESS * evaluations.violation(values);
        for _ in 0..(TRIED * (x.len() + 2)).min(MOST_TRIED) {
            let point = self.next(evaluations.bounds(), x, ranges);
            let Some(point) = on_linear(evaluations, x, (values, gradients), &point) else { continue };
            let Some(there) = unless_failed(evaluations.values(&point))? else { continue };
            let own = evaluations.violation(&there);
            if own < least {
                (least, best) = (own, Some(point));
            }
            if own <= evaluations.stopping().violation {
                break;
            }
        }
        let Some(x) = best else { return Ok(None) };
        let found = evaluations.values(&x).and_then(|values| Ok((values, evaluations.gradients(&x)?)));
        Ok(unless_failed(found)?.map(|(values, gradients)| (x, values, gradients)))
    }
}

/// The nearest point to `wanted` that keeps the linear constraints, known by their values and gradients at `x`.
fn on_linear(
    evaluations: &Evaluations,
    x: &[f64],
    (values, gradients): (&Values, &Gradients),
    wanted: &[f64],
) -> Option<Vec<f64>> {
    let first = evaluations.linear_from();
    let (rows, kinds) = (&gradients.constraints[first..], &evaluations.constraints()[first..]);
    let moved: Vec<f64> = wanted.iter().zip(x).map(|(wanted, x)| wanted - x).collect();
    let at = |(row, c): (&Vec<f64>, &f64)| c + row.iter().zip(&moved).map(|(slope, d)| slope * d).sum::<f64>();
    let offsets: Vec<f64> = rows.iter().zip(&values.constraints[first..]).map(at).collect();
    if violation(kinds, &offsets) <= evaluations.stopping().violation {
        return Some(wanted.to_vec());
    }
    let step = QuadraticProgram::shortest(wanted, evaluations.bounds(), kinds, (offsets, rows)).ok()?;
    let place = |((x, d), (lower, upper)): ((&f64, &f64), &(f64, f64))| (x + d).clamp(*lower, *upper);
    Some(wanted.iter().zip(&step).zip(evaluations.bounds()).map(place).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_a_box_evenly() {
        for n in [1, 2, 3] {
            let mut escape = Escape::new(n);
            let (bounds, x, ranges) = (vec![(1.0, 3.0); n], vec![1.5; n], vec![2.0; n]);
            let points: Vec<Vec<f64>> = (0..600).map(|_| escape.next(&bounds, &x, &ranges)).collect();
            for i in 0..n {
                let places = points.iter().map(|point| ((point[i] - 1.0) * 3.0) as usize);
                let mut counts = [0; 6];
                places.for_each(|place| counts[place] += 1);
                assert!(counts.iter().all(|count| (94..=106).contains(count)), "{n}: {counts:?}");
            }
        }
    }
}
