use super::lists::{MOST_LISTS, add_lists, exchange, largest_scaled};
use crate::assembly::{Unknowns, clone_fields};
use crate::elements::RunScalar;
use smallvec::SmallVec;

/// Most earlier steps from which a solution is extrapolated: each further one adds a digit or so where the fastest modes turn by a tenth of a
/// radian in a step, and doubles what round-off does to the guess.
pub(crate) const MOST: usize = MOST_LISTS;
/// How many times as large as at the latest step a term of the polynomial may become: behind steps that an event has cut short, those of a high degree are
/// round-off over so much longer a step.
const FAR: f64 = 1e3;

/// First guesses for the systems of a step: the increments of the unknowns from system to system, extrapolated over time.
///
/// Increments by the size of the step are polynomials in time through those of the latest steps; of the degrees, one for each
/// system, that one is taken which would have foretold the latest solution best.
#[derive(Debug, PartialEq)]
pub struct Prediction<S> {
    pub tracks: Vec<Track<S>>,
}

/// The increments of one system, as Newton's polynomial through them: with the divided differences f\[t_1 .. t_i\] of increments by the size
/// of the step, t_1 latest, the term of degree i - 1 is (t - t_1) .. (t - t_(i-1)) f\[t_1 .. t_i\].
#[derive(Debug, PartialEq)]
pub struct Track<S> {
    /// Starts t_1, t_2, .. of the latest steps \[s\].
    pub times: Vec<f64>,
    /// (t_1 - t_2) .. (t_1 - t_i) f\[t_1 .. t_i\]: backward differences where steps are equal.
    pub differences: Vec<Unknowns<S>>,
    /// Number of steps that are used: 0 for no increment, 1 for the latest one, and so on.
    pub used: usize,
}

clone_fields!(Prediction { tracks });
clone_fields!(Track { times, differences, used });

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
        let factors = self.factors(t);
        let mut terms: SmallVec<[(f64, &[S]); MOST]> = SmallVec::new();
        for (list, values) in unknowns.extrapolated_mut().into_iter().enumerate() {
            let used = self.differences.iter().zip(factors).take(self.used).take_while(|own| own.1.abs() <= FAR);
            terms.clear();
            terms.extend(used.map(|(difference, factor)| (h * factor, difference.extrapolated()[list])));
            add_lists(values, &terms);
        }
    }

    /// What the terms of the polynomial at `t` are to those kept: the products of (t - t_j) / (t_1 - t_(j+1)).
    fn factors(&self, t: f64) -> [f64; MOST] {
        let mut factors = [1.0; MOST];
        for (i, pair) in self.times.windows(2).enumerate() {
            factors[i + 1] = factors[i] * ((t - pair[0]) / (self.times[0] - pair[1]));
        }
        factors
    }

    /// Takes note of the solution of a step: the increment from `before` (from zero without it). Each coordinate counts by its scale.
    pub fn learn(
        &mut self,
        (t, h): (f64, f64),
        before: Option<&Unknowns<S>>,
        solution: &Unknowns<S>,
        coordinate_scales: &[f64],
    ) {
        let (known, factors) = (self.times.len(), self.factors(t));
        if self.differences.len() <= known {
            self.differences.push(Unknowns::default());
        }
        // the one behind all others is overwritten: what the polynomial through all of them would have left of the increment
        let (earlier, left) = self.differences.split_at_mut(known);
        let left = &mut left[0];
        left.set_increment(before, solution, 1.0 / h);
        // what is left by polynomials through none, one, two, .. of the latest increments
        let mut errors = [0.0_f64; MOST + 1];
        errors[0] = largest_scaled(&left.x, coordinate_scales, |x, scale| x.value().abs() * scale);
        for (list, left) in left.extrapolated_mut().into_iter().enumerate() {
            let own = earlier
                .iter_mut()
                .zip(factors)
                .filter_map(|(difference, factor)| Some((factor, difference.extrapolated_mut().into_iter().nth(list)?)));
            let mut differences: SmallVec<[(f64, &mut [S]); MOST]> = own.collect();
            // coordinates are the first list
            let measured = (list == 0).then_some((coordinate_scales, &mut errors[1..]));
            exchange(&mut differences, left, measured);
        }
        let best = (0..=known).fold(0, |best, used| if errors[used] < errors[best] { used } else { best });
        self.times.insert(0, t);
        self.times.truncate(MOST);
        // one more point is worth a try only where all of them served
        self.used = if best == known { (known + 1).min(MOST) } else { best };
    }
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
        assert!(track.used >= 4);
    }

    #[test]
    fn short_steps_foretell_little_of_a_long_one() {
        let mut track = Track::default();
        for step in 0..6 {
            let t = 1e-10 * f64::from(step);
            // a constant with the round-off of its sum
            track.learn((t, 1e-10), None, &at(1e-10 * (1.0 + 1e-16 * f64::from(step % 3))), &[1.0; 2]);
        }
        track.used = 6;
        let mut guess = at(0.0);
        track.add_expected(6e-10, 1e-2, &mut guess);
        assert!((guess.x[0] - 1e-2).abs() < 1e-9, "{guess:?}");
        let mut later = at(0.0);
        track.add_expected(1e-2, 1e-2, &mut later);
        assert!((later.x[0] - 1e-2).abs() < 1e-9, "{later:?}");
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
