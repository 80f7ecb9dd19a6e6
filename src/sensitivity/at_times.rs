//! What functionals measure at given times of a run, also between the ends of its steps, with derivatives by design variables.

use super::analysis::seeded_designs;
use super::{Analysis, Forward};
use crate::assembly::Model;
use crate::design::shortest;
use crate::elements::RunScalar;
use crate::functionals::{Functional, RunParameters, Sample, StepEnds};
use crate::integrators::{Counters, Observer, RunError, StartRecord, StepRecord, Table, unit_part};
use crate::tolerances::SAME_TIME;

/// Ends of steps through which the polynomial of a value between two of them goes: with fourth-order methods its error is of an order that counts less
/// than theirs.
const POINTS: usize = 6;
/// Those of a polynomial of lower degree; how far the two are apart is how exact the values between steps are.
const FEWER_POINTS: usize = 4;
/// A step shorter than this share of the one before is cut by an event: its two ends are one point of a polynomial.
const SAME_POINT: f64 = 1e-6;

/// A functional that is wanted at some times, which increase \[s\].
pub(crate) struct Samples {
    /// Its place among all functionals.
    pub functional: usize,
    pub times: Vec<f64>,
    /// The design variable by which the times are too late: what is measured at t is what the motion has at t - delay.
    pub delay: Option<usize>,
}

/// What functionals measure at the wanted times.
pub(crate) struct Sampled {
    pub forward: Forward,
    pub values: Vec<f64>,
    /// How far a value between the ends of steps may be from that of the motion, estimated; 0 at the ends of steps.
    pub between_steps: Vec<f64>,
}

impl Analysis<'_> {
    /// Runs a design, and reads what functionals measure; `goes_on` is asked at each step.
    ///
    /// # Errors
    /// Those of the map and of the run; times that do not lie in it.
    pub(crate) fn sampled(&self, x: &[f64], wanted: &[Samples], goes_on: &dyn Fn() -> bool) -> Result<Sampled, RunError> {
        let numbers = self.map.real(x).map_err(RunError::Input)?;
        let mut courses = Courses::new(self.functionals, self.model, &self.method.table, &numbers.p, goes_on);
        let (forward, stopped) = self.observed(x, &mut courses)?;
        stopped.map_or(Ok(()), Err)?;
        courses.finish();
        let values = courses.values(wanted, x, POINTS)?;
        let coarser = courses.values(wanted, x, FEWER_POINTS)?;
        let between_steps = values.iter().zip(coarser).map(|(value, coarser)| (value - coarser).abs()).collect();
        Ok(Sampled { forward, values, between_steps })
    }

    /// Derivatives of the same by some design variables, `rows[sample][variable]`, along the steps of that run, as many variables at a time as a
    /// number has derivative parts.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub(crate) fn sampled_by_design<S: RunScalar>(
        &self,
        x: &[f64],
        variables: &[usize],
        forward: &Forward,
        wanted: &[Samples],
    ) -> Result<(Vec<Vec<f64>>, Counters), RunError> {
        self.check_forward(x, forward)?;
        let count = wanted.iter().map(|own| own.times.len()).sum();
        let (mut rows, mut counters) = (vec![Vec::new(); count], Counters::default());
        for (seeded, lanes) in seeded_designs::<S>(x, variables) {
            let numbers = self.numbers_with_parts(&seeded)?;
            let clocks = self.clocks(&numbers.p, forward)?;
            let mut courses = Courses::new(self.functionals, self.model, &self.method.table, &numbers.p, &|| true);
            counters += self.perturbed_run(&numbers, &clocks, forward, &mut courses)?;
            courses.finish();
            for (row, value) in rows.iter_mut().zip(courses.values(wanted, &seeded, POINTS)?) {
                row.extend((0..lanes).map(|lane| value.part(lane) / unit_part::<S>()));
            }
        }
        Ok((rows, counters))
    }
}

/// What functionals measure at the start and at the ends of steps, in stretches within which it is smooth.
struct Courses<'f, S> {
    functionals: &'f [Functional],
    model: &'f Model,
    table: &'f Table,
    parameters: RunParameters<S>,
    ends: StepEnds<'f, S>,
    /// Times of points, with the derivative parts that breakpoints and events have.
    times: Vec<S>,
    /// `measured[functional][point]`.
    measured: Vec<Vec<S>>,
    /// First points of stretches: those behind breakpoints and events, whose own values are those before them.
    stretches: Vec<usize>,
    goes_on: &'f dyn Fn() -> bool,
}

impl<'f, S: RunScalar> Courses<'f, S> {
    fn new(
        functionals: &'f [Functional],
        model: &'f Model,
        table: &'f Table,
        p: &[S],
        goes_on: &'f dyn Fn() -> bool,
    ) -> Self {
        Courses {
            functionals,
            model,
            table,
            parameters: RunParameters::new(model, p),
            ends: StepEnds::new(table),
            times: Vec::new(),
            measured: vec![Vec::new(); functionals.len()],
            stretches: vec![0],
            goes_on,
        }
    }

    fn read(&mut self, mut sample: Sample<S>) {
        if let [.., before, last] = self.times[..] {
            let (step, length) = (sample.t.value() - last.value(), last.value() - before.value());
            if step < SAME_POINT * length {
                return;
            }
        }
        let p = self.parameters.p();
        if self.functionals.iter().any(Functional::reads_multipliers) {
            sample.share(self.model, p);
        }
        self.times.push(sample.t);
        for (functional, measured) in self.functionals.iter().zip(&mut self.measured) {
            measured.push(functional.measured_at(self.model, &sample, p));
        }
    }

    /// The end of the last step, where the method tells it only then.
    fn finish(&mut self) {
        if let Some(last) = self.ends.end() {
            self.read(last);
        }
    }

    /// Values at the wanted times, by polynomials through so many points.
    fn values(&self, wanted: &[Samples], x: &[S], points: usize) -> Result<Vec<S>, RunError> {
        let mut values = Vec::new();
        for Samples { functional, times, delay } in wanted {
            let delay = delay.map_or(S::zero(), |variable| x[variable]);
            for &t in times {
                values.push(self.value(*functional, -delay + t, points)?);
            }
        }
        Ok(values)
    }

    /// The value at a time, which has derivative parts where a delay has: that of Lagrange's polynomial through the points around it, whose places
    /// may have such parts, too.
    fn value(&self, functional: usize, t: S, points: usize) -> Result<S, RunError> {
        let count = self.times.len();
        let end = self.times.last().map_or(0.0, |own| own.value());
        let rounding = SAME_TIME * end / count as f64;
        if !(-rounding..=end + rounding).contains(&t.value()) {
            let (t, end, name) = (shortest(t.value()), shortest(end), &self.functionals[functional].name);
            return Err(RunError::Input(format!("\"{name}\" is wanted at {t} s, but the run is one from 0 to {end} s")));
        }
        let place = self.times.partition_point(|own| own.value() < t.value()).min(count - 1);
        let stretch = self.stretches.partition_point(|&first| first <= place);
        let (first, end) = (self.stretches[stretch - 1], self.stretches.get(stretch).copied().unwrap_or(count));
        // of a stretch with a single point the end of the one before tells more than nothing
        let first = if end - first == 1 { first.saturating_sub(1) } else { first };
        let from = place.saturating_sub(points / 2).min(end.saturating_sub(points)).max(first);
        let range = from..end.min(from + points);
        let (times, values) = (&self.times[range.clone()], &self.measured[functional][range]);
        let share = |own: usize| {
            let others = (0..times.len()).filter(|&other| other != own);
            others.fold(S::one(), |share, other| share * (t - times[other]) / (times[own] - times[other]))
        };
        Ok((0..times.len()).map(|own| values[own] * share(own)).sum())
    }
}

impl<S: RunScalar> Observer<S> for Courses<'_, S> {
    fn start(&mut self, start: &StartRecord<S>) -> Result<(), RunError> {
        self.parameters.start(start);
        let mut sample = Sample::initial(start);
        sample.follow(start.clock);
        self.read(sample);
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError> {
        let mut end = self.ends.add(step);
        if !self.table.stiffly_accurate {
            // that of the step before
            end.take().into_iter().for_each(|end| self.read(end));
        }
        let goes_on_smoothly = step.restart.is_none() && step.switched.is_empty();
        if !goes_on_smoothly && !self.stretches.contains(&self.times.len()) {
            self.stretches.push(self.times.len());
        }
        self.parameters.step(step);
        end.into_iter().for_each(|end| self.read(end));
        Ok((self.goes_on)())
    }
}
