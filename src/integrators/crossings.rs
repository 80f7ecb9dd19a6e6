//! Which formulas pass from one piece to another during a run.

use super::record::{StartRecord, StepRecord};
use crate::assembly::{Model, NodeId, VectorsAvq};
use crate::program::{Formula, ProgramWork, SwitchKind, Switches};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// A formula that passes from one piece to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Name of the element, joint or functional.
    pub part: String,
    /// Whether it is a functional: the motion does not depend on it.
    pub is_functional: bool,
    /// What it does there.
    pub kind: SwitchKind,
    /// Number of the first step in which that happens.
    pub step: usize,
    /// Time of the first stage behind it, or of the end of the step \[s\].
    pub t: f64,
    /// Number of steps in which it happens.
    pub count: usize,
    /// The last of them.
    pub last: usize,
}

/// Where an argument of a formula stands in the vectors of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// An acceleration.
    A(usize),
    /// A velocity.
    V(usize),
    /// A coordinate.
    Q(usize),
    /// A multiplier.
    Mu(usize),
    /// A parameter.
    P(usize),
    /// The time.
    Time,
}

/// A formula with switches, and where it was at the start of the step.
struct Watched {
    name: String,
    switches: Switches,
    /// Of functionals: the mildest change that is told.
    of_functional: Option<SwitchKind>,
    places: Vec<Place>,
    /// Arguments that the sides depend on.
    reads: Vec<usize>,
    inputs: Vec<f64>,
    numbers: Vec<f64>,
}

/// The latest state of a run.
#[derive(Default)]
struct Seen {
    at: VectorsAvq<f64>,
    mu: Vec<f64>,
}

/// Sees the steps of a run, and notes which switches change sides; without switches it does nothing.
#[derive(Default)]
pub struct SwitchWatch {
    parts: Vec<Watched>,
    seen: Seen,
    inputs: Vec<f64>,
    numbers: Vec<f64>,
    work: ProgramWork<f64>,
    step: usize,
    crossings: Vec<Crossing>,
    /// Switches of formulas, with lengths and without.
    known: HashMap<(*const Formula, bool), Option<Switches>>,
}

impl SwitchWatch {
    /// Over the parts of a model.
    pub fn new(model: &Model) -> Self {
        let mut watch = SwitchWatch::default();
        for own in model.elements.iter().filter(|own| own.physics.residual_refused().is_none()) {
            let lists: &[fn(usize) -> Place] = &[Place::A, Place::V, Place::Q];
            watch.add((&own.name, None), own.physics.residual(), true, || places(model, lists, &own.nodes, &own.parameters));
        }
        for own in model.constraints.iter().filter(|own| own.physics.refused().is_none()) {
            let lists: &[fn(usize) -> Place] = &[Place::V, Place::Q];
            watch.add((&own.name, None), own.physics.formula(), true, || places(model, lists, &own.nodes, &own.parameters));
        }
        watch
    }

    /// Watches a formula if it has switches, lengths of vectors among them if these are asked for: that of a part by its name, or that of
    /// a functional, of which changes of a kind and worse are told.
    pub fn add(
        &mut self,
        (name, of_functional): (&str, Option<SwitchKind>),
        formula: &Arc<Formula>,
        lengths: bool,
        places: impl FnOnce() -> Vec<Place>,
    ) {
        let known = self.known.entry((Arc::as_ptr(formula), lengths));
        if let Some(switches) = known.or_insert_with(|| formula.switches(lengths)).clone() {
            let (name, places, numbers) = (name.into(), places(), Vec::new());
            let reads = (0..).zip(switches.reads()).filter_map(|(input, reads)| reads.then_some(input)).collect();
            let inputs = vec![0.0; places.len()];
            self.parts.push(Watched { name, switches, of_functional, places, reads, inputs, numbers });
        }
    }

    /// The start of the run.
    pub fn start(&mut self, start: &StartRecord<f64>, p: &[f64]) {
        if !self.parts.is_empty() {
            self.seen = Seen { at: start.acceleration.point(), mu: start.acceleration.unknowns.mu.clone() };
            self.begin(p, start.acceleration.t);
        }
    }

    /// A step of it: its stages, and its end.
    pub fn step(&mut self, step: &StepRecord<f64>, p: &[f64]) {
        self.step += 1;
        if self.parts.is_empty() {
            return;
        }
        if step.restart.is_some() {
            self.begin(p, step.t);
        }
        for stage in step.stages.iter().filter(|stage| stage.known.is_none()) {
            let (solve, Seen { at, mu }) = (&stage.solve, &mut self.seen);
            at.a.resize(solve.base.a.len(), 0.0);
            at.v.resize(solve.base.v.len(), 0.0);
            at.q.resize(solve.base.q.len(), 0.0);
            at.set_shifted(&solve.base, solve.equations.residual, &solve.unknowns);
            mu.clone_from(&solve.unknowns.mu);
            self.compare(p, solve.t, false);
        }
        self.seen.at.v.clone_from(&step.v);
        self.seen.at.q.clone_from(&step.q);
        self.compare(p, step.t + step.h, true);
    }

    /// What was noted, jumps first.
    pub fn finish(self) -> Vec<Crossing> {
        let mut crossings = self.crossings;
        crossings.sort_by_key(|own| (own.kind != SwitchKind::Jump, own.step));
        crossings
    }

    fn begin(&mut self, p: &[f64], t: f64) {
        for part in &mut self.parts {
            self.seen.write(&part.places, p, t, &mut part.inputs);
            part.switches.evaluate(&part.inputs, &mut part.numbers, &mut self.work);
        }
    }

    /// Compares the state with that at the start of the step; the end of it is the start of the next one.
    fn compare(&mut self, p: &[f64], t: f64, is_end: bool) {
        let SwitchWatch { parts, seen, inputs, numbers, work, step, crossings, .. } = self;
        for part in parts {
            inputs.resize(part.places.len(), 0.0);
            // within a step only what tells the sides
            match is_end {
                true => seen.write(&part.places, p, t, inputs),
                false => part.reads.iter().for_each(|&input| inputs[input] = seen.value(part.places[input], p, t)),
            }
            part.switches.evaluate(inputs, numbers, work);
            if part.switches.change(&part.numbers, numbers) {
                seen.write(&part.places, p, t, inputs);
                note(part, inputs, (*step, t), crossings);
            }
            if is_end {
                std::mem::swap(&mut part.inputs, inputs);
                std::mem::swap(&mut part.numbers, numbers);
            }
        }
    }
}

/// Notes how a part changes on the way from the start of the step to `inputs`, where a switch of it changes sides.
fn note(part: &Watched, inputs: &[f64], (step, t): (usize, f64), crossings: &mut Vec<Crossing>) {
    // along the way an element's inertia would cancel its forces: the accelerations stay, unless a switch reads them
    let (mut to, mut numbers) = (inputs.to_vec(), Vec::new());
    let count = part.places.iter().take_while(|place| matches!(place, Place::A(_))).count();
    to[..count].copy_from_slice(&part.inputs[..count]);
    part.switches.evaluate(&to, &mut numbers, &mut ProgramWork::default());
    let to = if part.switches.change(&part.numbers, &numbers) { &to } else { inputs };
    let not_told = (part.of_functional == Some(SwitchKind::Jump)).then_some(SwitchKind::Kink);
    let Some(kind) = part.switches.kind(&part.inputs, to, not_told) else { return };
    let is_functional = part.of_functional.is_some();
    let is_own = |own: &&mut Crossing| (&own.part, own.is_functional, own.kind) == (&part.name, is_functional, kind);
    match crossings.iter_mut().find(is_own) {
        Some(own) => own.count += usize::from(std::mem::replace(&mut own.last, step) != step),
        None => {
            let part = part.name.clone();
            crossings.push(Crossing { part, is_functional, kind, step, t, count: 1, last: step });
        }
    }
}

fn places(model: &Model, lists: &[fn(usize) -> Place], nodes: &[NodeId], parameters: &Range<usize>) -> Vec<Place> {
    let dofs = || nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone());
    let state = lists.iter().flat_map(|list| dofs().map(list));
    state.chain(parameters.clone().map(Place::P)).chain([Place::Time]).collect()
}

impl Seen {
    fn value(&self, place: Place, p: &[f64], t: f64) -> f64 {
        match place {
            Place::A(dof) => self.at.a[dof],
            Place::V(dof) => self.at.v[dof],
            Place::Q(dof) => self.at.q[dof],
            Place::Mu(row) => self.mu[row],
            Place::P(index) => p[index],
            Place::Time => t,
        }
    }

    fn write(&self, places: &[Place], p: &[f64], t: f64, inputs: &mut [f64]) {
        inputs.iter_mut().zip(places).for_each(|(input, &place)| *input = self.value(place, p, t));
    }
}
