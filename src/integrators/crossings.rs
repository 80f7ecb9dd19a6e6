//! Which formulas pass from one piece to another during a run.

use super::Scheme;
use super::record::{StartRecord, StepRecord};
use crate::assembly::{Model, NodeId, VectorsAvq};
use crate::design::shortest;
use crate::program::{Formula, PassBuffers, ProgramWork, Reads, SwitchKind, Switches, between};
use std::collections::HashMap;
use std::fmt;
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
    /// The shortest time that it is on another side within a step at whose ends it is on the same one \[s\]: no stage need have seen it.
    pub passed_over: Option<f64>,
}

impl fmt::Display for Crossing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Crossing { part, is_functional, kind, step, t, count, last, passed_over } = self;
        write!(f, "step {step} (t = {} s)", shortest(*t))?;
        if *count > 1 {
            write!(f, ", and in {} more steps until step {last}", count - 1)?;
        }
        let (whose, what) = (
            if *is_functional { "functional " } else { "" },
            match kind {
                SwitchKind::Jump => "jumps",
                SwitchKind::Kink => "has a kink",
            },
        );
        write!(f, ": the formula of {whose}\"{part}\" {what} within the step: ")?;
        f.write_str(match (is_functional, kind) {
            (false, SwitchKind::Jump) => {
                "the motion is right to first order of the step only, its estimated error is not to be trusted, and gradients of what is measured \
                 after it are wrong, as are their complex steps; keep the motion on one side, or write the formula without the jump"
            }
            (false, SwitchKind::Kink) => {
                "the motion and gradients of what is measured after it are right to first order of the step only, and its estimated error is not \
                 to be trusted; take smaller steps, or let them be chosen to come close to it
                 (--tolerance 1e-12), and compare"
            }
            (true, SwitchKind::Jump) => {
                "its value is right to first order of the step only, its gradient is wrong, and so is its complex step; measure something that does \
                 not jump"
            }
            (true, SwitchKind::Kink) => "its gradient is right to first order of the step only; take smaller steps and compare",
        })?;
        match passed_over {
            Some(duration) => write!(
                f,
                "; it is there for {} s only, which the stages of a step may not see: take no longer steps (--longest-step)",
                shortest((1e6 * duration).round() * 1e-6)
            ),
            None => Ok(()),
        }
    }
}

/// Where an argument of a formula stands in the vectors of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    A(usize),
    V(usize),
    Q(usize),
    Mu(usize),
    P(usize),
    Time,
}

/// A formula with switches, and where it was at the start of the step.
struct Watched {
    name: String,
    switches: Switches,
    /// Of functionals: the mildest change that is told.
    of_functional: Option<SwitchKind>,
    places: Vec<Place>,
    reads: Vec<usize>,
    inputs: Vec<f64>,
    numbers: Vec<f64>,
}

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
    buffers: PassBuffers,
    step: usize,
    /// Where the last step ended, before the breakpoint that may be there \[s\].
    end: f64,
    crossings: Vec<Crossing>,
    /// Switches of formulas, with lengths and without.
    known: HashMap<(*const Formula, bool), Option<Switches>>,
    /// Whether steps end at switches of elements.
    locates: bool,
}

impl SwitchWatch {
    /// For a run whose steps end at switches or not.
    pub fn new(model: &Model, locates: bool) -> Self {
        let mut watch = SwitchWatch { locates, ..SwitchWatch::default() };
        each_formula(model, |name, _, formula, places| watch.add((name, None), formula, true, places));
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
        let reads = if self.locates { Reads::NotLocated } else { Reads::Motion };
        let known = self.known.entry((Arc::as_ptr(formula), lengths));
        if let Some(switches) = known.or_insert_with(|| formula.switches(reads, lengths)).clone() {
            let (name, places, numbers) = (name.into(), places(), Vec::new());
            let reads = (0..).zip(switches.reads()).filter_map(|(input, reads)| reads.then_some(input)).collect();
            let inputs = vec![0.0; places.len()];
            self.parts.push(Watched { name, switches, of_functional, places, reads, inputs, numbers });
        }
    }

    pub fn start(&mut self, start: &StartRecord<f64>, p: &[f64]) {
        if !self.parts.is_empty() {
            self.seen = Seen { at: start.acceleration.point(), mu: start.acceleration.unknowns.mu.clone() };
            self.end = start.acceleration.t;
            self.begin(p, self.end);
        }
    }

    pub fn step(&mut self, step: &StepRecord<f64>, p: &[f64]) {
        self.step += 1;
        if self.parts.is_empty() {
            return;
        }
        if step.t != self.end || step.restart.is_some() || step.scheme == Scheme::Euler {
            self.begin(p, step.t);
        }
        self.end = step.end;
        for stage in step.stages.iter().filter(|stage| stage.known.is_none()) {
            let (solve, Seen { at, mu }) = (&stage.solve, &mut self.seen);
            at.a.resize(solve.base.a.len(), 0.0);
            at.v.resize(solve.base.v.len(), 0.0);
            at.q.resize(solve.base.q.len(), 0.0);
            at.set_shifted(&solve.base, solve.equations.residual, &solve.unknowns);
            mu.clone_from(&solve.unknowns.mu);
            self.compare(p, solve.t, None);
        }
        self.seen.at.v.clone_from(&step.v);
        self.seen.at.q.clone_from(&step.q);
        self.compare(p, step.end, Some(step.h));
    }

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

    /// Compares the state with that at the start of the step; the end of one of size `h` is the start of the next one.
    fn compare(&mut self, p: &[f64], t: f64, h: Option<f64>) {
        let SwitchWatch { parts, seen, inputs, numbers, work, buffers, step, crossings, .. } = self;
        for part in parts {
            inputs.resize(part.places.len(), 0.0);
            // within a step only what tells the sides
            match h {
                Some(_) => seen.write(&part.places, p, t, inputs),
                None => part.reads.iter().for_each(|&input| inputs[input] = seen.value(part.places[input], p, t)),
            }
            part.switches.evaluate(inputs, numbers, work);
            if part.switches.change(&part.numbers, numbers) {
                seen.write(&part.places, p, t, inputs);
                note(part, inputs, (*step, t), None, crossings);
            }
            if let Some(h) = h {
                let ends = [[&part.inputs[..], inputs], [&part.numbers, numbers]];
                if let Some([enters, leaves]) = part.switches.passed_over(ends[0], ends[1], buffers) {
                    let middle: Vec<f64> = between(&part.inputs, inputs, 0.5 * (enters + leaves)).collect();
                    note(part, &middle, (*step, t), Some((leaves - enters) * h), crossings);
                }
                std::mem::swap(&mut part.inputs, inputs);
                std::mem::swap(&mut part.numbers, numbers);
            }
        }
    }
}

/// Notes how a part changes on the way from the start of the step to `inputs`, where a switch of it changes sides.
fn note(part: &Watched, inputs: &[f64], (step, t): (usize, f64), passed_over: Option<f64>, crossings: &mut Vec<Crossing>) {
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
        Some(own) => {
            own.count += usize::from(std::mem::replace(&mut own.last, step) != step);
            own.passed_over = [own.passed_over, passed_over].into_iter().flatten().reduce(f64::min);
        }
        None => {
            let part = part.name.clone();
            crossings.push(Crossing { part, is_functional, kind, step, t, count: 1, last: step, passed_over });
        }
    }
}

/// Calls `see` with the name of each element and constraint, whether it is a constraint, its formula, and the places of its arguments.
pub fn each_formula(model: &Model, mut see: impl FnMut(&str, bool, &Arc<Formula>, &dyn Fn() -> Vec<Place>)) {
    for own in model.elements.iter().filter(|own| own.physics.residual_refused().is_none()) {
        let lists: &[fn(usize) -> Place] = &[Place::A, Place::V, Place::Q];
        see(&own.name, false, own.physics.residual(), &|| places(model, lists, &own.nodes, &own.parameters));
    }
    for own in model.constraints.iter().filter(|own| own.physics.refused().is_none()) {
        let lists: &[fn(usize) -> Place] = &[Place::V, Place::Q];
        see(&own.name, true, own.physics.formula(), &|| places(model, lists, &own.nodes, &own.parameters));
    }
    for own in &model.limits_of_friction {
        let lists: &[fn(usize) -> Place] = &[Place::V, Place::Q];
        see(&own.name, false, &own.physics, &|| places(model, lists, &own.nodes, &own.parameters));
    }
}

pub(super) fn places(
    model: &Model,
    lists: &[fn(usize) -> Place],
    nodes: &[NodeId],
    parameters: &Range<usize>,
) -> Vec<Place> {
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
