//! Difference quotients whose step is chosen from the noise of the functional, without a look at the gradient.

use costate::integrators::RunError;
use costate::sensitivity::Analysis;

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
}

/// Distance of the designs at which noise is measured, relative to the direction: too little for anything smooth to show in fourth
/// differences, and roundings of every number of the run all the same.
const APART: f64 = 1e-7;
/// Fourth differences: their coefficients, and the size they make of independent errors of size 1, the root of the sum of squares.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
const OF_ROUNDINGS: f64 = 8.366_600_265_340_756;

/// What roundings of all numbers do to each functional: the largest of four fourth differences of runs at neighbouring designs, after
/// Hamming; twice that, as four are few.
pub fn noise(analysis: &Analysis, x: &[f64], direction: &[f64]) -> Result<Vec<f64>, RunError> {
    let at = |k: usize| -> Vec<f64> { x.iter().zip(direction).map(|(x, d)| x + k as f64 * APART * d).collect() };
    let runs: Vec<Vec<f64>> = (0..8).map(|k| analysis.values_nearby(&at(k))).collect::<Result<_, _>>()?;
    let of = |functional: usize| {
        let fourth = |five: &[Vec<f64>]| five.iter().zip(FOURTH).map(|(run, c)| c * run[functional]).sum::<f64>().abs();
        2.0 * runs.windows(5).map(fourth).fold(0.0, f64::max) / OF_ROUNDINGS
    };
    Ok((0..runs[0].len()).map(of).collect())
}

/// Central differences (f(x + h d) - f(x - h d)) / (2 h).
pub fn central(analysis: &Analysis, x: &[f64], direction: &[f64], step: f64) -> Result<Vec<f64>, RunError> {
    let at = |sign: f64| -> Vec<f64> { x.iter().zip(direction).map(|(x, d)| x + sign * step * d).collect() };
    let (plus, minus) = (analysis.values_nearby(&at(1.0))?, analysis.values_nearby(&at(-1.0))?);
    Ok(plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step)).collect())
}

/// For each functional: central differences with several steps, two neighbours extrapolated each; of these that is taken which is
/// expected to be nearest, judged by how far its neighbour is away and by the noise over its step. Steps become shorter for as long as a
/// functional would take the shortest, and not for its noise.
pub fn quotients(analysis: &Analysis, x: &[f64], direction: &[f64]) -> Result<Vec<Quotient>, RunError> {
    let noise = noise(analysis, x, direction)?;
    let (mut steps, mut differences) = (Vec::new(), Vec::new());
    let mut step = LARGEST;
    loop {
        steps.push(step);
        differences.push(central(analysis, x, direction, step)?);
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

/// The best quotient of one functional, and whether a shorter step would make it better.
fn best(steps: &[f64], differences: &[Vec<f64>], functional: usize, noise: f64) -> (Quotient, bool) {
    let square = FACTOR * FACTOR;
    let extrapolated: Vec<Quotient> = differences
        .windows(2)
        .zip(&steps[1..])
        .map(|(pair, &step)| Quotient {
            value: (square * pair[1][functional] - pair[0][functional]) / (square - 1.0),
            step,
            floor: (square / step + 1.0 / (FACTOR * step)) / (square - 1.0) * noise,
        })
        .collect();
    // the error falls with the fourth power of the step: that of the shorter one is a small share of the difference
    let away = |pair: &[Quotient]| ((pair[0].value - pair[1].value) / square).abs();
    let expected = |pair: &[Quotient]| away(pair).max(pair[1].floor);
    let best = extrapolated.windows(2).min_by(|a, b| expected(a).total_cmp(&expected(b)));
    let Some(pair) = best else { return (extrapolated[0], true) };
    (pair[1], pair[1].step == steps[steps.len() - 1] && away(pair) > pair[1].floor)
}
