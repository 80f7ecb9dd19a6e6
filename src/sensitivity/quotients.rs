//! Difference quotients whose step is chosen from the noise of the functional, without a look at the gradient.

use super::Analysis;
use crate::integrators::RunError;

/// Largest step, relative to the variables, and the factor from one to the next.
const LARGEST: f64 = 8e-3;
const FACTOR: f64 = 4.0;
/// Number of steps, and the most where they are too long.
const COUNT: usize = 5;
const MOST: usize = 7;

/// The derivative of a functional along a direction, from separate real runs.
#[derive(Clone, Copy, Debug)]
pub struct Quotient {
    /// The derivative.
    pub value: f64,
    /// The shorter step of the two that it was extrapolated from, relative to the direction.
    pub step: f64,
    /// What roundings leave of it.
    pub floor: f64,
    /// Whether its error falls with the step as that of a smooth function does: otherwise the functional is one of pieces, as that of a run of
    /// fixed steps is beside a jump, and this is the slope of one of them.
    pub is_smooth: bool,
}

/// Share of a quotient from which on its change from one step to the next tells something.
const LARGE: f64 = 1e-2;
/// By how much more than the leading error of a smooth functional, whose changes fall by [`FACTOR`] squared, the next two fall beside a jump.
const SUDDENLY: f64 = 16.0;
/// Expected errors within which two quotients are the same.
const SAME: f64 = 8.0;

/// Distance of the designs at which noise is measured, relative to the direction: too little for anything smooth to show in fourth
/// differences, and roundings of every number of the run all the same.
const APART: f64 = 1e-7;
/// Fourth differences: their coefficients, and the size they make of independent errors of size 1, the root of the sum of squares.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
const OF_ROUNDINGS: f64 = 8.366_600_265_340_756;

impl Analysis<'_> {
    /// Derivatives of all functionals along a direction by difference quotients of whole real runs, each built, started and solved by itself
    /// from its own design on: they share neither derivatives nor states with the adjoint, and see a jump that a complex step passes.
    ///
    /// Central differences with several steps, two neighbours extrapolated each; of these that is taken which is expected to be nearest, judged
    /// by how far its neighbour is away and by the noise over its step. Steps become shorter for as long as a functional would take the
    /// shortest, and not for its noise: 18 to 22 runs.
    ///
    /// # Errors
    /// As for [`Analysis::values_nearby`].
    pub fn quotients(&self, x: &[f64], direction: &[f64]) -> Result<Vec<Quotient>, RunError> {
        let noise = self.noise(x, direction)?;
        let (mut steps, mut differences) = (Vec::new(), Vec::new());
        let mut step = LARGEST;
        loop {
            steps.push(step);
            differences.push(self.central(x, direction, step)?);
            if steps.len() >= COUNT {
                let all = (0..noise.len()).map(|functional| best(&steps, &differences, functional, noise[functional]));
                let (all, too_long): (Vec<Quotient>, Vec<bool>) = all.unzip();
                if steps.len() == MOST || !too_long.contains(&true) {
                    return Ok(all);
                }
            }
            step /= FACTOR;
        }
    }

    /// What roundings of all numbers do to each functional: the largest of four fourth differences of runs at neighbouring designs, after
    /// Hamming; twice that, as four are few.
    ///
    /// # Errors
    /// As for [`Analysis::values_nearby`].
    pub fn noise(&self, x: &[f64], direction: &[f64]) -> Result<Vec<f64>, RunError> {
        let at = |k: usize| -> Vec<f64> { x.iter().zip(direction).map(|(x, d)| x + k as f64 * APART * d).collect() };
        let runs: Vec<Vec<f64>> = (0..8).map(|k| self.values_nearby(&at(k))).collect::<Result<_, _>>()?;
        let of = |functional: usize| {
            let fourth = |five: &[Vec<f64>]| five.iter().zip(FOURTH).map(|(run, c)| c * run[functional]).sum::<f64>().abs();
            2.0 * runs.windows(5).map(fourth).fold(0.0, f64::max) / OF_ROUNDINGS
        };
        Ok((0..runs[0].len()).map(of).collect())
    }

    /// Central differences (f(x + h d) - f(x - h d)) / (2 h) of separate real runs.
    ///
    /// # Errors
    /// As for [`Analysis::values_nearby`].
    pub fn central(&self, x: &[f64], direction: &[f64], step: f64) -> Result<Vec<f64>, RunError> {
        let at = |sign: f64| -> Vec<f64> { x.iter().zip(direction).map(|(x, d)| x + sign * step * d).collect() };
        let (plus, minus) = (self.values_nearby(&at(1.0))?, self.values_nearby(&at(-1.0))?);
        Ok(plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step)).collect())
    }
}

/// The best quotient of one functional, and whether a shorter step would make it better.
fn best(steps: &[f64], differences: &[Vec<f64>], functional: usize, noise: f64) -> (Quotient, bool) {
    let square = FACTOR * FACTOR;
    let changes: Vec<f64> = differences.windows(2).map(|pair| (pair[1][functional] - pair[0][functional]).abs()).collect();
    let size = differences.iter().fold(0.0, |size: f64, own| size.max(own[functional].abs()));
    let is_sudden = |(three, &step): (&[f64], &f64)| {
        let [first, second] = [1, 2].map(|k| (three[k] + 2.0 * noise / step) * square.powi(k as i32) * SUDDENLY);
        three[0] > LARGE * size && first < three[0] && second < three[0]
    };
    let is_smooth = !changes.windows(3).zip(&steps[3..]).any(is_sudden);
    let extrapolated: Vec<Quotient> = differences
        .windows(2)
        .zip(&steps[1..])
        .map(|(pair, &step)| Quotient {
            value: (square * pair[1][functional] - pair[0][functional]) / (square - 1.0),
            step,
            floor: (square / step + 1.0 / (FACTOR * step)) / (square - 1.0) * noise,
            is_smooth,
        })
        .collect();
    // the error falls with the fourth power of the step: that of the shorter one is a small share of the difference
    let away = |pair: &[Quotient]| ((pair[0].value - pair[1].value) / square).abs();
    let expected = |pair: &[Quotient]| away(pair).max(pair[1].floor);
    let mut pairs: Vec<&[Quotient]> = extrapolated.windows(2).collect();
    // two neighbours may agree by chance: those of shorter steps must not say otherwise
    let agrees = |pair: &[Quotient], other: &[Quotient]| {
        (pair[1].value - other[1].value).abs() <= SAME * (expected(pair) + expected(other))
    };
    let shorter = pairs.clone();
    pairs.retain(|pair| shorter.iter().filter(|other| other[1].step < pair[1].step).all(|other| agrees(pair, other)));
    let best = pairs.into_iter().min_by(|a, b| expected(a).total_cmp(&expected(b)));
    let Some(pair) = best else { return (extrapolated[0], true) };
    (pair[1], pair[1].step == steps[steps.len() - 1] && away(pair) > pair[1].floor)
}
