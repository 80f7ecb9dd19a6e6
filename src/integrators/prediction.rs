use crate::assembly::{Unknowns, clone_fields};
use crate::elements::RunScalar;

/// Most earlier steps from which a solution is extrapolated.
pub(crate) const MOST: usize = 4;

/// First guesses for the systems of a step: the increments of the unknowns from system to system, extrapolated over time.
///
/// Increments by the size of the step are polynomials in time through those of the latest steps; of the degrees, one for each
/// system, that one is taken which would have foretold the latest solution best.
#[derive(Debug, PartialEq)]
pub struct Prediction<S> {
    /// One for each system of a step, in order.
    pub tracks: Vec<Track<S>>,
}

/// The increments of one system.
#[derive(Debug, PartialEq)]
pub struct Track<S> {
    /// Starts of the latest steps \[s\], latest first.
    pub times: Vec<f64>,
    /// Increments by the step's size, latest first.
    pub rates: Vec<Unknowns<S>>,
    /// Number of steps that are used: 0 for no increment, 1 for the latest one, and so on.
    pub used: usize,
}

clone_fields!(Prediction { tracks });
clone_fields!(Track { times, rates, used });

impl<S: RunScalar> Prediction<S> {
    /// Forgets all steps; `systems` is their number in those to come.
    pub fn clear(&mut self, systems: usize) {
        self.tracks.resize_with(systems, Track::default);
        for track in &mut self.tracks {
            track.used = 0;
            track.times.clear();
        }
    }
}

impl<S: RunScalar> Track<S> {
    /// Adds the increment that is expected in the step of size `h` from `t`.
    pub fn add_expected(&self, t: f64, h: f64, unknowns: &mut Unknowns<S>) {
        let weights = lagrange(&self.times[..self.used], t);
        for (rate, weight) in self.rates.iter().zip(&weights[..self.used]) {
            unknowns.add_scaled(rate, h * weight);
        }
    }

    /// Takes note of the solution of a step: the increment from `before` (from zero without it). Each coordinate counts by its scale.
    pub fn learn(
        &mut self,
        (t, h): (f64, f64),
        before: Option<&Unknowns<S>>,
        solution: &Unknowns<S>,
        coordinate_scales: &[f64],
    ) {
        let known = self.times.len();
        // the oldest one makes room
        if self.rates.len() <= known.min(MOST - 1) {
            self.rates.push(Unknowns::default());
        }
        let place = known.min(MOST - 1);
        let mut latest = std::mem::take(&mut self.rates[place]);
        // the degree that would have been best; the oldest increment is no longer there to be judged
        latest.set(solution);
        if let Some(before) = before {
            latest.add_scaled(before, -1.0);
        }
        latest.scale(1.0 / h);
        let mut errors = [0.0_f64; MOST + 1];
        let mut weights = [[0.0; MOST]; MOST + 1];
        for (used, weights) in weights.iter_mut().enumerate().take(place + 1) {
            *weights = lagrange(&self.times[..used], t);
        }
        let mut earlier: [&[S]; MOST] = [&[]; MOST];
        earlier.iter_mut().zip(&self.rates[..place]).for_each(|(own, rate)| *own = &rate.x[..latest.x.len()]);
        for (used, (error, weights)) in errors.iter_mut().zip(&weights).enumerate().take(place + 1) {
            for (i, (own, scale)) in latest.x.iter().zip(coordinate_scales).enumerate() {
                let mut expected = 0.0;
                for (rate, weight) in earlier[..used].iter().zip(weights) {
                    expected += weight * rate[i].value();
                }
                *error = error.max((own.value() - expected).abs() * scale);
            }
        }
        let best = (0..=place).fold(0, |best, used| if errors[used] < errors[best] { used } else { best });
        self.rates[place] = latest;
        self.rates[..=place].rotate_right(1);
        self.times.truncate(place);
        self.times.insert(0, t);
        // one more point is worth a try only where all of them served
        self.used = if best == place { place + 1 } else { best };
    }
}

/// Weights with which values at the given times (at most [`MOST`], all different) give that of their polynomial at `t`.
fn lagrange(times: &[f64], t: f64) -> [f64; MOST] {
    let mut weights = [0.0; MOST];
    for (k, weight) in weights.iter_mut().enumerate().take(times.len()) {
        let others = times.iter().enumerate().filter(|(other, _)| *other != k);
        *weight = others.map(|(_, other)| (t - other) / (times[k] - other)).product();
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::{Track, Unknowns};

    fn at(x: f64) -> Unknowns<f64> {
        Unknowns { x: vec![x, 0.0], ..Unknowns::default() }
    }

    #[test]
    fn polynomials_are_foretold_over_unequal_steps() {
        let mut track = Track::default();
        let solution = |t: f64, h: f64| at(h * (1.0 - 2.0 * t + 3.0 * t * t - t * t * t));
        let mut t = 0.0;
        for h in [0.1, 0.2, 0.15, 0.1, 0.12, 0.2, 0.1] {
            let mut guess = at(0.0);
            track.add_expected(t, h, &mut guess);
            if t > 0.5 {
                assert!((guess.x[0] - solution(t, h).x[0]).abs() < 1e-14, "{guess:?} at {t}");
            }
            track.learn((t, h), None, &solution(t, h), &[1.0; 2]);
            t += h;
        }
        assert_eq!(track.used, 4);
    }

    #[test]
    fn what_jumps_about_is_not_extrapolated() {
        let mut track = Track::default();
        for step in 0..20 {
            let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
            track.learn((f64::from(step), 1.0), None, &at(sign), &[1.0; 2]);
        }
        assert_eq!(track.used, 0);
    }
}
