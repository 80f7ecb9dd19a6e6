//! A file that the first of several ranks writes and reads for all.

use super::flat::{Flat, numbers_of, set_bytes};
use super::packed::unpack;
use super::{Direction, FileHistory, History, Rerun, Usage};
use crate::exchange::Exchange;
use crate::integrators::{Observer, Pause, Replay, RunError, StartRecord, StepRecord, StepRule, Steps};
use std::fmt;

/// A run in a file of the first rank, which hands its steps to the others where all ask for them; these keep none.
pub struct FirstRankHistory {
    world: &'static dyn Exchange,
    file: Option<FileHistory>,
    start: Option<StartRecord<f64>>,
    steps: usize,
    taken_over: usize,
}

impl fmt::Debug for FirstRankHistory {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} steps, {:?}", self.steps, self.file)
    }
}

impl FirstRankHistory {
    /// What ranks keep of a run, of which the first one makes the file.
    pub fn new(
        world: &'static dyn Exchange,
        file: impl FnOnce() -> Result<FileHistory, RunError>,
    ) -> Result<Self, RunError> {
        let file = if world.rank() == 0 { Some(file()?) } else { None };
        Ok(FirstRankHistory { world, file, start: None, steps: 0, taken_over: 0 })
    }
}

/// Sends a record to all other ranks, or that there is none.
fn send_to_others<T: Flat>(world: &dyn Exchange, record: Option<&T>, list: &mut Vec<u8>) {
    list.clear();
    record.iter().for_each(|record| record.put(list));
    assert!(list.len().is_multiple_of(8), "records are made of numbers");
    let message = numbers_of(list);
    (1..world.ranks()).for_each(|rank| world.send(rank, message.clone()));
}

/// The record that the first rank sends, if there is one.
fn receive_from_first<'b>(world: &dyn Exchange, list: &'b mut Vec<u8>) -> Option<&'b [u8]> {
    set_bytes(list, &world.receive(0));
    (!list.is_empty()).then_some(list)
}

const READABLE: &str = "the first rank has read it";

impl Observer for FirstRankHistory {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        self.start = Some(start.clone());
        self.file.as_mut().map_or(Ok(()), |file| file.start(start))
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.steps += 1;
        self.file.as_mut().map_or(Ok(true), |file| file.step(step))
    }
    fn checkpoint(&mut self, index: usize, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        self.file.as_mut().map_or(Ok(()), |file| file.checkpoint(index, pause))
    }
    fn end(&mut self, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        self.file.as_mut().map_or(Ok(()), |file| file.end(pause))
    }
    fn take_up(&mut self, rule: StepRule, steps: Replay<f64>) -> Result<Option<Pause<f64>>, RunError> {
        let (world, mut list) = (self.world, Vec::new());
        if let Some(file) = &mut self.file {
            let pause = file.take_up(rule, &mut |step| {
                send_to_others(world, Some(step), &mut list);
                steps(step)
            })?;
            send_to_others(world, None::<&StepRecord<f64>>, &mut list);
            send_to_others(world, pause.as_ref(), &mut list);
            self.steps = file.steps();
            return Ok(pause);
        }
        let mut step = StepRecord::default();
        while let Some(bytes) = receive_from_first(world, &mut list) {
            unpack(&mut step, bytes, rule).expect(READABLE);
            self.steps += 1;
            if !steps(&step)? {
                return Err(RunError::Interrupted { steps: self.steps });
            }
        }
        self.taken_over = self.steps;
        Ok(receive_from_first(world, &mut list).map(|bytes| Pause::from_bytes(bytes).expect(READABLE)))
    }
}

impl History for FirstRankHistory {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        self.start.as_ref()
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn read<'h>(&'h self, rerun: &'h Rerun<'_>, direction: Direction) -> Result<Box<dyn Steps + 'h>, RunError> {
        let file = self.file.as_ref().map(|file| file.read(rerun, direction)).transpose()?;
        let (world, rule, step, list) = (self.world, rerun.rule(), StepRecord::default(), Vec::new());
        Ok(Box::new(FirstRankSteps { world, file, rule, step, list }))
    }
    fn usage(&self) -> Usage {
        let others = Usage { taken_over: self.taken_over, ..Usage::default() };
        self.file.as_ref().map_or(others, FileHistory::usage)
    }
}

struct FirstRankSteps<'h> {
    world: &'static dyn Exchange,
    file: Option<Box<dyn Steps + 'h>>,
    rule: StepRule<'h>,
    step: StepRecord<f64>,
    list: Vec<u8>,
}

impl Steps for FirstRankSteps<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        if let Some(file) = &mut self.file {
            let step = file.next()?;
            send_to_others(self.world, step, &mut self.list);
            return Ok(step);
        }
        let Some(bytes) = receive_from_first(self.world, &mut self.list) else { return Ok(None) };
        unpack(&mut self.step, bytes, self.rule).expect(READABLE);
        Ok(Some(&self.step))
    }
}
