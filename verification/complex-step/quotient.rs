//! Difference quotients whose step is chosen from the noise of the functional, without a look at the gradient.

use costate::integrators::RunError;
use costate::sensitivity::Analysis;

/// Largest step, relative to the variables, and the factor from one to the next.
const LARGEST: f64 = 8e-3;
const FACTOR: f64 = 4.0;
/// Number of steps.
const COUNT: i32 = 5;

/// The derivative of a functional along a direction, from separate real runs.
#[derive(Clone, Copy, Debug)]
pub struct Quotient {
    /// The derivative.
    pub value: f64,
    /// The shorter step of the two that it was extrapolated from, relative to the direction.
    pub step: f64,
    /// What roundings of the variables leave of it.
    pub floor: f64,
}

/// Largest change of each functional between designs a rounding apart: all numbers up, all down, and by turns.
pub fn noise(analysis: &Analysis, x: &[f64]) -> Result<Vec<f64>, RunError> {
    let up = |place: usize, pattern: usize| match pattern {
        0 => true,
        1 => false,
        _ => place.is_multiple_of(2) == (pattern == 2),
    };
    let rounded = |pattern: usize| -> Vec<f64> {
        let moved = |(place, x): (usize, &f64)| if up(place, pattern) { x.next_up() } else { x.next_down() };
        x.iter().enumerate().map(moved).collect()
    };
    let mut range: Vec<[f64; 2]> = analysis.values(x)?.into_iter().map(|value| [value; 2]).collect();
    for pattern in 0..4 {
        for ([least, most], value) in range.iter_mut().zip(analysis.values(&rounded(pattern))?) {
            (*least, *most) = (least.min(value), most.max(value));
        }
    }
    Ok(range.into_iter().map(|[least, most]| most - least).collect())
}

/// Central differences (f(x + h d) - f(x - h d)) / (2 h).
pub fn central(analysis: &Analysis, x: &[f64], direction: &[f64], step: f64) -> Result<Vec<f64>, RunError> {
    let at = |sign: f64| -> Vec<f64> { x.iter().zip(direction).map(|(x, d)| x + sign * step * d).collect() };
    let (plus, minus) = (analysis.values(&at(1.0))?, analysis.values(&at(-1.0))?);
    Ok(plus.iter().zip(&minus).map(|(plus, minus)| (plus - minus) / (2.0 * step)).collect())
}

/// For each functional: central differences with several steps, two neighbours extrapolated each; of these that is taken which is
/// expected to be nearest, judged by how far its neighbour is away and by the noise over its step.
pub fn quotients(analysis: &Analysis, x: &[f64], direction: &[f64]) -> Result<Vec<Quotient>, RunError> {
    let noise = noise(analysis, x)?;
    let steps: Vec<f64> = (0..COUNT).map(|k| LARGEST * FACTOR.powi(-k)).collect();
    let differences: Vec<Vec<f64>> = steps.iter().map(|&step| central(analysis, x, direction, step)).collect::<Result<_, _>>()?;
    let square = FACTOR * FACTOR;
    let of = |functional: usize| {
        let extrapolated: Vec<Quotient> = differences
            .windows(2)
            .zip(&steps[1..])
            .map(|(pair, &step)| Quotient {
                value: (square * pair[1][functional] - pair[0][functional]) / (square - 1.0),
                step,
                // a rounding of either run, twice what the spread shows of one side
                floor: (square / step + 1.0 / (FACTOR * step)) / (square - 1.0) * noise[functional],
            })
            .collect();
        // the error falls with the fourth power of the step: that of the shorter one is a small share of the difference
        let expected = |pair: &[Quotient]| ((pair[0].value - pair[1].value) / square).abs().max(pair[1].floor);
        let best = extrapolated.windows(2).min_by(|a, b| expected(a).total_cmp(&expected(b)));
        best.map_or(extrapolated[0], |pair| pair[1])
    };
    Ok((0..noise.len()).map(of).collect())
}
