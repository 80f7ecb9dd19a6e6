//! Steps by the numbers from which all others follow: what was carried into them, and their solutions.

use super::flat::{Flat, retake};
use super::sliced::Sliced;
use super::{Direction, Rerun};
use crate::assembly::Unknowns;
use crate::integrators::{RunError, SolveRecord, StageRecord, StepRecord, StepRule, Steps};

impl Flat for StepRecord<f64> {
    fn put(&self, bytes: &mut Vec<u8>) {
        [self.t, self.h, self.end].put(bytes);
        self.scheme.put(bytes);
        self.dropped.put(bytes);
        self.switched.put(bytes);
        self.set.put(bytes);
        self.impacts.put(bytes);
        self.axes.put(bytes);
        self.restart.put(bytes);
        self.forces.put(bytes);
        self.carried.put(bytes);
        self.stages.len().put(bytes);
        for StageRecord { solve, known } in &self.stages {
            known.put(bytes);
            if known.is_some() {
                solve.unknowns.mu.put(bytes);
            } else {
                put_solution(&solve.unknowns, bytes);
            }
        }
        for projection in [&self.position_projection, &self.velocity_projection] {
            projection.is_some().put(bytes);
            projection.iter().for_each(|solve| put_solution(&solve.unknowns, bytes));
        }
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let mut step = StepRecord::default();
        take_given(&mut step, bytes).map(|()| step)
    }
}

/// Without the multipliers inside nodes: who goes through the system again has them from the rest.
fn put_solution(Unknowns { x, mu, local_mu }: &Unknowns<f64>, bytes: &mut Vec<u8>) {
    x.put(bytes);
    mu.put(bytes);
    local_mu.len().put(bytes);
}

fn take_solution(Unknowns { x, mu, local_mu }: &mut Unknowns<f64>, bytes: &mut &[u8]) -> Option<()> {
    retake(x, bytes)?;
    retake(mu, bytes)?;
    let count = usize::take(bytes)?;
    local_mu.clear();
    local_mu.resize(count, 0.0);
    Some(())
}

/// Reads a step into the memory of another one, as it was when it was made; `None` if the bytes are none of it.
pub(super) fn unpack(step: &mut StepRecord<f64>, mut bytes: &[u8], rule: StepRule) -> Option<()> {
    take_given(step, &mut bytes)?;
    (bytes.is_empty() && fits(step, rule)).then(|| step.follow(rule))
}

/// Whether the vectors are those of a step of the method.
fn fits(step: &StepRecord<f64>, rule: StepRule) -> bool {
    let (table, StepRecord { carried, stages, position_projection, velocity_projection, .. }) = (rule.table(step), step);
    let Some(dofs) = carried.first().map(Vec::len) else { return false };
    let kinds = stages.iter().zip(&table.stages).all(|(own, stage)| own.known == stage.known);
    let solved = stages.iter().filter(|stage| stage.known.is_none()).map(|stage| &stage.solve);
    let mut solved = solved.chain(position_projection).chain(velocity_projection);
    [(carried.len(), table.carried.len()), (stages.len(), table.stages.len())].iter().all(|(own, asked)| own == asked)
        && kinds
        && carried.iter().all(|own| own.len() == dofs)
        && solved.all(|own| own.unknowns.x.len() == dofs)
}

fn take_given(step: &mut StepRecord<f64>, bytes: &mut &[u8]) -> Option<()> {
    for time in [&mut step.t, &mut step.h, &mut step.end] {
        *time = Flat::take(bytes)?;
    }
    step.scheme = Flat::take(bytes)?;
    retake(&mut step.dropped, bytes)?;
    retake(&mut step.switched, bytes)?;
    retake(&mut step.set, bytes)?;
    retake(&mut step.impacts, bytes)?;
    retake(&mut step.axes, bytes)?;
    step.restart = Flat::take(bytes)?;
    step.forces = Flat::take(bytes)?;
    step.carried.resize_with(usize::take(bytes)?, Vec::new);
    step.carried.iter_mut().try_for_each(|own| retake(own, bytes))?;
    step.stages.resize_with(usize::take(bytes)?, StageRecord::default);
    for StageRecord { solve, known } in &mut step.stages {
        *known = Flat::take(bytes)?;
        if known.is_some() {
            retake(&mut solve.unknowns.mu, bytes)?;
        } else {
            take_solution(&mut solve.unknowns, bytes)?;
        }
    }
    for projection in [&mut step.position_projection, &mut step.velocity_projection] {
        if bool::take(bytes)? {
            take_solution(&mut projection.get_or_insert_with(SolveRecord::default).unknowns, bytes)?;
        } else {
            *projection = None;
        }
    }
    Some(())
}

/// Steps in memory, one after the other; of large ones each rank keeps a slice.
#[derive(Debug, Default)]
pub(super) struct PackedSteps(Vec<Sliced>);

impl PackedSteps {
    pub fn push(&mut self, step: &StepRecord<f64>) {
        // all steps are about as long
        let mut bytes = Vec::with_capacity(self.0.last().map_or(0, Sliced::length));
        step.put(&mut bytes);
        self.0.push(Sliced::new(bytes));
    }

    pub fn read<'h>(&'h self, rerun: &'h Rerun<'_>, direction: Direction) -> Box<dyn Steps + 'h> {
        let (steps, rule, step, list) = (self.0.iter(), rerun.rule(), StepRecord::default(), Vec::new());
        Box::new(Unpacking { steps, direction, rule, step, list })
    }
}

struct Unpacking<'h> {
    steps: std::slice::Iter<'h, Sliced>,
    direction: Direction,
    rule: StepRule<'h>,
    step: StepRecord<f64>,
    list: Vec<u8>,
}

impl Steps for Unpacking<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        let Some(bytes) = self.direction.next_of(&mut self.steps) else { return Ok(None) };
        unpack(&mut self.step, bytes.all(&mut self.list), self.rule).expect("these are the bytes of a step");
        Ok(Some(&self.step))
    }
}
