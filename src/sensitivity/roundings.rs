//! What roundings of the states of a run do to functionals.

use super::{Analysis, Forward};
use crate::assembly::{Residual, StageSystem, last_bit};
use crate::functionals::Values;
use crate::history::{Direction, Rerun};
use crate::integrators::{ConstraintLevel, HeldRoundings, Method, RunError, SolveRecord, StepRecord, coordinate_scales};

/// Patterns of signs that are tried: in one alone, changes may cancel.
const PATTERNS: usize = 4;

/// Sizes of the numbers of a run so far, by which they are rounded: coordinates \[m\], velocities, accelerations, and multipliers.
#[derive(Clone, Default)]
struct Rounding {
    /// Scales of coordinates, which count those that turn by a length of the model.
    scales: Vec<f64>,
    sizes: [f64; 4],
    /// How many times the rounding of a coordinate the others are off by, as constraints are kept on coordinates [1, 1/s, 1/s2].
    held: [f64; 3],
    pattern: usize,
    /// Rate at which steps follow each other \[1/s\].
    rate: f64,
}

impl Rounding {
    /// Moves each number of a list by the last bit of the largest of the run.
    fn apply(&mut self, which: usize, list: &mut [f64]) {
        let scale = |place: usize| if which == MULTIPLIERS { 1.0 } else { self.scales[place] };
        let largest = list.iter().enumerate().fold(0.0, |most: f64, (place, own)| most.max(own.abs() * scale(place)));
        self.sizes[which] = self.sizes[which].max(largest);
        // a velocity by which no coordinate moves by its last bit within a step is none
        let unseen = if which == VELOCITIES { self.sizes[COORDINATES] * self.rate } else { 0.0 };
        let held = self.held.get(which).map_or(0.0, |factor| factor * self.sizes[COORDINATES]);
        let size = self.sizes[which].max(unseen).max(held);
        for (place, own) in list.iter_mut().enumerate() {
            *own += last_bit(4 * (PATTERNS * place + self.pattern) + which) * size / scale(place);
        }
    }

    fn apply_to(&mut self, SolveRecord { base, unknowns, .. }: &mut SolveRecord<f64>) {
        self.apply(COORDINATES, &mut base.q);
        self.apply(VELOCITIES, &mut base.v);
        self.apply(ACCELERATIONS, &mut unknowns.x);
        self.apply(MULTIPLIERS, &mut unknowns.mu);
    }
}

const COORDINATES: usize = 0;
const VELOCITIES: usize = 1;
const ACCELERATIONS: usize = 2;
const MULTIPLIERS: usize = 3;

impl Analysis<'_> {
    /// By how much functionals change where every number of the states of a run that they read, coordinates, velocities, accelerations and
    /// multipliers, is moved up or down by the last bit of the largest of its kind, or by what the level of the constraints makes of that of
    /// coordinates; those that turn count by a length of the model. The largest change of four patterns of signs: no functional of these
    /// states is known better.
    ///
    /// # Errors
    /// Steps that were not kept, or cannot be found again.
    #[doc(hidden)]
    pub fn roundings(&self, forward: &Forward) -> Result<Vec<f64>, RunError> {
        let real = self.problem(&forward.numbers);
        let rerun = Rerun::new(&real, self.method, &forward.grid, self.plan);
        let scales = coordinate_scales(rerun.system(), &forward.numbers.q, &forward.numbers.p);
        let begin = |pattern: usize| {
            let values = Values::new(self.functionals, self.model, &self.method.table, &forward.numbers.p);
            (values, Rounding { scales: scales.clone(), pattern, ..Rounding::default() })
        };
        let mut all: Vec<_> = (0..PATTERNS).map(begin).collect();
        let mut steps = forward.history.read(&rerun, Direction::Forward)?;
        let mut residual = Residual::default();
        let (mut held, mut steps_before) = (HeldRoundings::default(), 0);
        for (values, rounding) in &mut all {
            let Some(mut start) = forward.history.start_record().cloned() else { continue };
            // what is projected away has been rounded as it was given
            let projections = [&mut start.position_projection, &mut start.velocity_projection];
            for SolveRecord { base, .. } in projections.into_iter().flatten() {
                rounding.apply(COORDINATES, &mut base.q);
                rounding.apply(VELOCITIES, &mut base.v);
            }
            rounding.apply_to(&mut start.acceleration);
            values.start(&start);
        }
        while let Some(step) = steps.next()? {
            let begins_anew = steps_before == 0 || step.restart.is_some();
            let factors = self.of_held_coordinates(&mut held, step, begins_anew);
            steps_before += 1;
            let acceleration = factors[2] * all[0].1.sizes[COORDINATES];
            let forces = self.forces(&rerun, (step, &forward.numbers.p), (&scales, acceleration), &mut residual);
            for (values, rounding) in &mut all {
                let mut step = step.clone();
                rounding.sizes[MULTIPLIERS] = rounding.sizes[MULTIPLIERS].max(forces);
                (rounding.rate, rounding.held) = (1.0 / step.h, factors);
                step.stages.iter_mut().for_each(|stage| rounding.apply_to(&mut stage.solve));
                rounding.apply(COORDINATES, &mut step.q);
                rounding.apply(VELOCITIES, &mut step.v);
                values.step(&step);
            }
        }
        let mut changes = vec![0.0; self.functionals.len()];
        for (values, _) in all {
            let moved = values.finish().0;
            let apart = moved.iter().zip(&forward.values).map(|(moved, own)| (moved - own).abs());
            changes.iter_mut().zip(apart).for_each(|(change, apart)| *change = apart.max(*change));
        }
        Ok(changes)
    }

    /// Sizes by which multipliers are rounded: they carry what the forces of the other parts are rounded by, and those that accelerations of
    /// this size make whose roundings they are.
    fn forces(
        &self,
        rerun: &Rerun,
        (step, p): (&StepRecord<f64>, &[f64]),
        (scales, acceleration): (&[f64], f64),
        residual: &mut Residual<f64>,
    ) -> f64 {
        let (system, mut forces) = (rerun.system(), 0.0_f64);
        let solved = step.stages.iter().filter(|stage| stage.known.is_none());
        for SolveRecord { t, equations, base, unknowns } in solved.map(|stage| &stage.solve) {
            let stage = StageSystem { equations, base, p, t: *t };
            let mut unknowns = unknowns.clone();
            Residual::shape(system, &mut unknowns, false);
            residual.start(system, stage);
            residual.evaluate(system, stage, &mut unknowns);
            forces = forces.max(residual.force_floor(system, stage, &unknowns) / f64::EPSILON);
            if !self.method.table.is_static() {
                let there = residual.f.clone();
                let rounding = |place: usize| last_bit(place) * acceleration / scales[place];
                unknowns.x.iter_mut().enumerate().for_each(|(place, x)| *x += rounding(place));
                residual.evaluate(system, stage, &mut unknowns);
                let apart = residual.f.iter().zip(&there).map(|(moved, own)| (moved - own).abs());
                forces = apart.fold(forces, |most, apart| most.max(apart / f64::EPSILON));
            }
        }
        forces
    }

    /// How many times the rounding of a coordinate all of them, velocities and accelerations are off by behind a step, as constraints are kept
    /// on coordinates: velocities and accelerations are differences of these, and a method that does not damp hands roundings on.
    fn of_held_coordinates(&self, held: &mut HeldRoundings, step: &StepRecord<f64>, begins_anew: bool) -> [f64; 3] {
        let Method { table, .. } = self.method;
        match self.method.constraint_level() {
            ConstraintLevel::Acceleration => [0.0; 3],
            // each step takes coordinates as they are
            _ if table.is_static() || table.variational.is_some() => [1.0, 1.0 / step.h, 1.0 / (step.h * step.h)],
            _ => held.step(table.scheme(step.scheme), step.h, begins_anew),
        }
    }
}
