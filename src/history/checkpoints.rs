use super::flat::Flat;
use super::packed::PackedSteps;
use super::schedule::split;
use super::sliced::{Sliced, most_kept};
use super::{Direction, History, Rerun, Usage};
use crate::design::shortest;
use crate::integrators::{Checkpoint, Observer, Pause, RunError, StartRecord, StepRecord, Stepper, Steps, Stop, TimeGrid};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

/// A run as checkpoints within a given memory: the steps between them are computed again on the way back.
///
/// For a known number of steps the checkpoints are placed so that the fewest steps are computed again; for an unknown one they keep even
/// distances, which double whenever the memory is full. A run whose steps all fit into the memory is kept as it is. Going back gives the
/// memory of checkpoints that are passed to new ones, so a second gradient of the same run begins with computing it once more.
#[derive(Debug)]
pub struct Checkpoints {
    budget: usize,
    /// Steps of the run, if they are known before.
    planned: Option<usize>,
    start: Option<StartRecord<f64>>,
    steps: usize,
    /// All steps, where these fit into the memory.
    all: Option<PackedSteps>,
    /// Number of checkpoints that fit into the memory beside one step; known after the first step.
    slots: usize,
    /// The step behind which the next checkpoint is kept.
    wanted: usize,
    /// Distance of checkpoints when the number of steps is unknown.
    distance: usize,
    kept: Mutex<Kept>,
}

/// What changes on the way back.
#[derive(Debug, Default)]
struct Kept {
    checkpoints: Vec<Packed>,
    /// The last step, until the first way back.
    last: Option<StepRecord<f64>>,
    /// Bytes of one step, as far as this rank keeps it.
    step_bytes: usize,
    usage: Usage,
}

#[derive(Debug)]
struct Packed {
    step: usize,
    bytes: Sliced,
}

impl Kept {
    fn push(&mut self, checkpoint: &Checkpoint<f64>) {
        self.checkpoints.push(Packed { step: checkpoint.between.step, bytes: Sliced::new(checkpoint.bytes()) });
        self.usage.checkpoints = self.usage.checkpoints.max(self.checkpoints.len());
        let bytes = self.checkpoints.iter().map(|packed| packed.bytes.kept()).sum::<usize>() + self.step_bytes;
        self.usage.bytes = self.usage.bytes.max(bytes);
    }
}

impl Checkpoints {
    /// Checkpoints and one step within `budget` bytes, for a run of so many steps if that is known.
    pub fn new(budget: usize, planned: Option<usize>) -> Self {
        Checkpoints {
            budget,
            planned,
            start: None,
            steps: 0,
            all: None,
            slots: 1,
            wanted: 0,
            distance: 1,
            kept: Mutex::default(),
        }
    }

    /// All steps of a run of any number, which ends with an error where they would take more than `budget` bytes.
    pub fn of_all_steps(budget: usize) -> Self {
        Checkpoints { all: Some(PackedSteps::default()), ..Self::new(budget, None) }
    }

    fn kept(&mut self) -> &mut Kept {
        self.kept.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    fn divide(&mut self, step: &StepRecord<f64>) -> Result<(), RunError> {
        let (step_bytes, budget, t) = (step.bytes().len(), self.budget, step.t);
        let kept = most_kept(step_bytes);
        if self.planned.is_some_and(|planned| planned.saturating_mul(kept) <= budget) {
            self.all = Some(PackedSteps::default());
        }
        if self.all.is_some() {
            *self.kept() = Kept { step_bytes: kept, ..Kept::default() };
            return Ok(());
        }
        self.kept().step_bytes = step_bytes;
        // later checkpoints also hold increments of earlier steps, and where each matrix was factored
        let first: usize = self.kept().checkpoints.iter().map(|own| own.bytes.length()).sum();
        let solved = step.stages.iter().map(|stage| &stage.solve);
        let solved = solved.chain(&step.position_projection).chain(&step.velocity_projection);
        let later: usize =
            solved.map(|solve| crate::integrators::MOST_TRACKED * (solve.unknowns.bytes().len() + 8) + 64).sum();
        let factored = step.stages.last().map_or(0, |stage| 4 * stage.solve.bytes().len());
        let checkpoint_bytes = most_kept(first + later + factored);
        self.slots = budget.saturating_sub(step_bytes) / checkpoint_bytes;
        if self.slots == 0 {
            return Err(RunError::stopped(
                Stop::History,
                format!("step 1 (t = {} s), checkpoints", shortest(t)),
                format!("one step and one checkpoint take {} bytes, {budget} are allowed", step_bytes + checkpoint_bytes),
                "allow more memory or keep the run in a file",
            ));
        }
        self.wanted = self.planned.map_or(1, |planned| split(planned, self.slots));
        Ok(())
    }

    fn plan(&mut self, step: usize) {
        let slots = self.slots;
        let Some(planned) = self.planned else {
            if self.kept().checkpoints.len() == slots {
                self.distance *= 2;
                let distance = self.distance;
                self.kept().checkpoints.retain(|own| own.step % distance == 0);
            }
            self.wanted = (step / self.distance + 1) * self.distance;
            return;
        };
        let free = slots.saturating_sub(self.kept().checkpoints.len());
        self.wanted = if free == 0 { usize::MAX } else { step + split(planned.saturating_sub(step), free + 1) };
    }

    fn locked(&self) -> Result<MutexGuard<'_, Kept>, RunError> {
        match self.kept.try_lock() {
            Ok(kept) => Ok(kept),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(RunError::Input("two gradients share the checkpoints of one run: compute one after the other".into()))
            }
        }
    }
}

impl Observer for Checkpoints {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        self.start = Some(start.clone());
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        if self.steps == 0 {
            self.divide(step)?;
        }
        let (steps, budget, step_bytes) = (self.steps + 1, self.budget, self.kept().step_bytes);
        if let Some(all) = &mut self.all {
            if steps.saturating_mul(step_bytes) > budget {
                return Err(RunError::stopped(
                    Stop::History,
                    format!("step {steps} (t = {} s), memory", shortest(step.t)),
                    format!("{steps} steps of {step_bytes} bytes take more than the {budget} bytes allowed"),
                    "keep the run in a file, or as checkpoints",
                ));
            }
            all.push(step);
            self.kept().usage = Usage { steps, bytes: steps * step_bytes, ..Usage::default() };
        } else {
            let kept = self.kept();
            match &mut kept.last {
                Some(last) => last.clone_from(step),
                None => kept.last = Some(step.clone()),
            }
            kept.usage.steps = 1;
        }
        self.steps = steps;
        Ok(true)
    }
    fn checkpoint(&mut self, index: usize, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        if self.all.is_none() && index == self.wanted {
            self.kept().push(&pause().checkpoint);
            if index > 0 {
                self.plan(index);
            }
        }
        Ok(())
    }
}

fn resume(stepper: &mut Stepper<f64>, packed: Option<&Packed>, place: impl Fn() -> String) -> Result<(), RunError> {
    let checkpoint = packed.and_then(|packed| Checkpoint::from_bytes(packed.bytes.all(&mut Vec::new())));
    let missing = || RunError::stopped(Stop::History, place(), "the run left no checkpoint", "run it again");
    stepper.resume(&checkpoint.ok_or_else(missing)?)
}

impl History for Checkpoints {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        self.start.as_ref()
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn read<'h>(&'h self, rerun: &'h Rerun<'_>, direction: Direction) -> Result<Box<dyn Steps + 'h>, RunError> {
        if let Some(all) = &self.all {
            return Ok(all.read(rerun, direction));
        }
        let (kept, mut stepper) = (self.locked()?, rerun.stepper()?);
        if direction == Direction::Forward {
            resume(&mut stepper, kept.checkpoints.first(), || rerun.grid.place(0))?;
        }
        let (grid, slots, end) = (rerun.grid, self.slots, self.steps);
        Ok(Box::new(RecomputedSteps { grid, direction, stepper, kept, slots, end, last: None }))
    }
    fn usage(&self) -> Usage {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).usage
    }
}

struct RecomputedSteps<'h> {
    grid: &'h TimeGrid,
    direction: Direction,
    stepper: Stepper<'h, f64>,
    kept: MutexGuard<'h, Kept>,
    slots: usize,
    /// Steps that are still to be handed out lie before this one.
    end: usize,
    /// The last one, where it was kept.
    last: Option<StepRecord<f64>>,
}

impl RecomputedSteps<'_> {
    fn advance(&mut self) -> Result<&StepRecord<f64>, RunError> {
        self.kept.usage.recomputed += 1;
        self.stepper.step(self.grid, None)
    }

    fn backward(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        let Some(index) = self.end.checked_sub(1) else { return Ok(None) };
        self.end = index;
        // checkpoints behind this step have served; that of the start stays for another way back
        self.kept.checkpoints.retain(|packed| packed.step <= index);
        self.last = self.kept.last.take();
        if self.last.is_some() {
            return Ok(self.last.as_ref());
        }
        let grid = self.grid;
        resume(&mut self.stepper, self.kept.checkpoints.last(), || grid.place(index))?;
        loop {
            let position = self.stepper.next_step();
            let free = self.slots.saturating_sub(self.kept.checkpoints.len());
            for _ in 0..split(index + 1 - position, free + 1) {
                self.advance()?;
            }
            if self.stepper.next_step() > index {
                return Ok(Some(self.stepper.record()));
            }
            let checkpoint = self.stepper.checkpoint();
            self.kept.push(&checkpoint);
        }
    }
}

impl Steps for RecomputedSteps<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        match self.direction {
            Direction::Backward => self.backward(),
            Direction::Forward if self.stepper.next_step() < self.end => self.advance().map(Some),
            Direction::Forward => Ok(None),
        }
    }
}
