//! The time loop of a run, whatever selects the step sizes.

use super::location::{SHORTEST, locate};
use super::march::{Method, Problem, Run};
use super::record::{Observer, StepRecord};
use super::run_interval::RunInterval;
use super::step::Stepper;
use super::{Checkpoint, Clocks, RunError, Scheme, SideChange, StartPlan, StartRecord, StepSizeState};
use crate::assembly::Clock;
use crate::elements::RunScalar;

/// How often a step is halved whose formulas are not defined up to its end.
const MOST_HALVINGS: usize = 50;

pub(super) struct TrialStep<'g> {
    /// About its size \[s\]; it is fitted to the stretch.
    pub h: f64,
    pub scheme: Scheme,
    pub guided: Option<&'g StepRecord<f64>>,
}

pub(super) struct TrialOutcome {
    /// Start and end as elements saw them \[s\].
    pub span: (f64, f64),
    pub reached: f64,
    pub made: Result<(), RunError>,
}

/// How a run selects its step sizes. What goes from one step to the next stands in the state of the interval, which resumed runs keep.
pub(super) trait StepSelection<S> {
    /// Whether a step may be tried anew: only then is kept what it takes to go back.
    fn goes_back(&self) -> bool {
        true
    }

    /// Looks for the first size, where the run is not taken up; the stepper is then as it was.
    fn begin(
        &mut self,
        _interval: &mut RunInterval,
        _stepper: &mut Stepper<S>,
        _before: &Checkpoint<S>,
    ) -> Result<(), RunError> {
        Ok(())
    }

    fn next(&mut self, interval: &mut RunInterval, stepper: &Stepper<S>) -> Result<TrialStep<'_>, RunError>;

    /// Whether a trial step is accepted; otherwise another one is tried from its start.
    fn accepts(
        &mut self,
        trial: TrialOutcome,
        interval: &mut RunInterval,
        stepper: &mut Stepper<S>,
        before: &Checkpoint<S>,
    ) -> Result<bool, RunError>;
}

pub(super) struct RunStart<'r, S> {
    pub plan: &'r StartPlan,
    pub clocks: Option<&'r Clocks<S>>,
    pub guided: Option<&'r StartRecord<f64>>,
}

/// Runs a problem to the end of a interval and hands every step that is taken to the recorder.
pub(super) fn time_loop<S: RunScalar, C: StepSelection<S>>(
    problem: &Problem<S>,
    method: &Method,
    RunStart { plan, clocks, guided }: RunStart<S>,
    (mut selection, mut interval): (C, RunInterval),
    recorder: &mut dyn Observer<S>,
) -> Result<Run<S>, RunError> {
    let system = method.system(problem.model, &plan.dropped);
    let mut stepper = Stepper::new(problem, method, &system, plan)?;
    if let Some(clocks) = clocks {
        stepper.clocks.clone_from(clocks);
    }
    stepper.stretch = interval.stretch_behind(interval.t());
    recorder.start(&stepper.start(interval.t(), plan, guided)?)?;
    let mut before = Checkpoint::default();
    let mut begins = Vec::new();
    let pause = recorder.take_up(stepper.rule(), &mut |step| {
        begins.push((step.t, step.switched.clone(), step.scheme));
        Ok(true)
    })?;
    let (is_made_again, has_parts) = (guided.is_some(), S::PARTS > 0);
    let goes_back = selection.goes_back() || stepper.events.is_some();
    if let Some(pause) = pause {
        stepper.take_up(&pause)?;
        let schemes: Vec<Scheme> = begins.iter().map(|own| own.2).collect();
        begins.push((pause.t, pause.checkpoint.between.switched.clone(), Scheme::Main));
        for ((end, changes, _), scheme) in begins.into_iter().skip(1).zip(schemes) {
            interval.note(scheme);
            let is_given = interval.is_breakpoint(end) || interval.is_at_once(scheme, end);
            match stepper.is_jump(&changes) && is_given {
                true => interval.advance_to_jump(end, changes),
                false => interval.advance_over(end, changes),
            }
        }
        interval.step_size = pause.step_size;
        before = pause.checkpoint;
    } else if goes_back {
        stepper.checkpoint_in(&mut before);
        selection.begin(&mut interval, &mut stepper, &before)?;
    }
    // behind an event up to the end of its stretch: derivative parts of its time, and of where the interval is
    let mut behind: Option<[S; 2]> = None;
    while !interval.at_end() {
        let index = stepper.next_step();
        recorder.checkpoint(index, &|| stepper.pause(interval.t(), interval.step_size))?;
        let waiting = std::mem::take(&mut stepper.between.waiting);
        let (reached, changes) = loop {
            if !waiting.is_empty() {
                let (t, end) = (interval.t(), interval.t().next_up());
                stepper.step_over(Scheme::Euler, (t, end), interval.at_breakpoint(), None)?;
                break (end, Some(waiting));
            }
            let TrialStep { h, scheme, guided } = selection.next(&mut interval, &stepper)?;
            let ((t, end), reached) = interval.span(h);
            let changes = interval.changes_next().filter(|_| is_made_again).map(<[SideChange]>::to_vec);
            let is_shortest =
                !is_made_again && h.is_finite() && interval.grid.is_behind_event(index) && end - t <= SHORTEST * h;
            let scheme = if is_shortest { Scheme::Euler } else { scheme };
            if has_parts && is_made_again && (behind.is_some() || changes.is_some()) {
                let [of_event, start] = behind.take().unwrap_or_else(|| [S::zero(), stepper.moved(t)]);
                let make = |stepper: &mut Stepper<S>, part: S| {
                    let is_euler = scheme == Scheme::Euler;
                    stepper.own_clock =
                        Some(if is_euler { Clock::shifted(start) } else { Clock::new([t, end], [start, part]) });
                    stepper.lengthened = Some(part - start);
                    stepper.step_over(scheme, (t, end), interval.at_breakpoint(), guided)
                };
                match &changes {
                    Some(changes) => {
                        let part = stepper.move_event(changes[0].switch, &before, make)?;
                        behind = Some([part, part]);
                    }
                    None => {
                        let (by_event, by_breakpoints) = interval.moves_next();
                        let of_ends = by_breakpoints.into_iter().filter(|(_, share)| *share != 0.0);
                        let of_ends = of_ends.fold(S::zero(), |sum, (t, share)| sum + stepper.moved(t) * share);
                        let part = of_event * by_event + of_ends;
                        make(&mut stepper, part)?;
                        behind = (by_event > 0.0).then_some([of_event, part]);
                    }
                }
                stepper.own_clock = None;
                break (reached, changes);
            }
            let mut made = stepper.step_over(scheme, (t, end), interval.at_breakpoint(), guided);
            let (mut end, mut reached, mut event) = (end, reached, None);
            // up to where no step is defined
            let mut undefined = None;
            if !is_made_again && stepper.events.is_some() && !selection.goes_back() {
                // a formula need not be defined beyond the end of the side that it has in this step
                for _ in 0..MOST_HALVINGS {
                    if !made.as_ref().is_err_and(RunError::is_of_step) {
                        break;
                    }
                    undefined = Some(end);
                    end = t + 0.5 * (end - t);
                    reached = end;
                    stepper.resume(&before)?;
                    let scheme = interval.scheme_to(&stepper.method.table, end);
                    made = stepper.step_over(scheme, (t, end), interval.at_breakpoint(), None);
                }
            }
            if made.is_ok() && !is_made_again && stepper.events.is_some() {
                match locate(&mut stepper, &before, &mut interval, (t, end), undefined) {
                    Ok(Some((end, changes))) => (reached, event) = (end, Some(changes)),
                    Ok(None) => {}
                    // what is not found may not be there
                    Err(failure) => made = stepper.check_slip().and(Err(failure)),
                }
            }
            let span = (t, if event.is_some() { reached } else { end });
            let step_size = interval.step_size;
            let accepted = match made.is_ok() && stepper.record().scheme == Scheme::Euler {
                true => Ok(true),
                false => selection.accepts(TrialOutcome { span, reached, made }, &mut interval, &mut stepper, &before),
            };
            if accepted.is_err() && !is_made_again && stepper.events.is_some() {
                stepper.resume(&before)?;
                stepper.check_jamming(t)?;
            }
            if accepted? {
                if !is_made_again {
                    stepper.check_slip()?;
                }
                if event.is_some() {
                    // that an event cuts a step says nothing of the next one
                    interval.step_size = StepSizeState { h: step_size.h, ..interval.step_size };
                }
                break (reached, event.or(changes));
            }
            stepper.resume(&before)?;
        };
        stepper.stretch = interval.stretch_behind(reached);
        interval.note(stepper.record().scheme);
        match changes {
            Some(mut changes) => {
                if !is_made_again && reached.next_up() < interval.next_breakpoint() {
                    let waiting = stepper.independent(&changes)?;
                    changes.retain(|own| !waiting.contains(own));
                    stepper.between.waiting = waiting;
                }
                // what is torn off at once has no time of its own
                let is_at_once = stepper.is_jump(&changes) && interval.is_at_once(stepper.record().scheme, reached);
                let (changes, ends_run) = stepper.pass(changes, is_made_again)?;
                match is_at_once && !is_made_again {
                    true => interval.advance_to_jump(reached, changes),
                    false => interval.advance_over(reached, changes),
                }
                if ends_run {
                    interval.stop();
                }
            }
            None => {
                stepper.forget_forces();
                let jumps = interval.jumps_next().map(<[SideChange]>::to_vec);
                let may_jump = !is_made_again && interval.is_breakpoint(reached) && stepper.may_release();
                let jumps = match may_jump {
                    true => Some(stepper.pass_at(reached, Vec::new(), false)?).filter(|jumps| !jumps.is_empty()),
                    false => jumps.map(|jumps| stepper.pass_at(reached, jumps, true)).transpose()?,
                };
                match jumps {
                    Some(jumps) => interval.advance_to_jump(reached, jumps),
                    None => interval.advance(reached),
                }
            }
        }
        if goes_back {
            stepper.checkpoint_in(&mut before);
        }
        if !recorder.step(stepper.record())? {
            return Err(RunError::Interrupted { steps: index + 1 });
        }
    }
    interval.grid.finish();
    recorder.end(&|| stepper.pause(interval.t(), interval.step_size))?;
    Ok(stepper.end(interval.step_size.rejected))
}
