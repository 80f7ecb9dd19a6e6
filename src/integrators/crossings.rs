//! Which formulas pass from one piece to another during a run.

use super::record::{StartRecord, StepRecord};
use crate::assembly::{Model, NodeId, VectorsAvq};
use crate::program::{Formula, ProgramWork, SwitchKind, Switches};
use std::collections::HashMap;
use std::ops::Range;

/// A part whose formula passes from one piece to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Name of the element or joint.
    pub part: String,
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

/// A part with switches, and where it was at the start of the step.
struct Watched {
    name: String,
    switches: Switches,
    /// Whether accelerations are among the arguments.
    of_element: bool,
    dofs: Vec<Range<usize>>,
    parameters: Range<usize>,
    inputs: Vec<f64>,
    numbers: Vec<f64>,
}

/// Sees the steps of a run, and notes which switches change sides; without switches it does nothing.
pub struct SwitchWatch {
    parts: Vec<Watched>,
    at: VectorsAvq<f64>,
    inputs: Vec<f64>,
    numbers: Vec<f64>,
    work: ProgramWork<f64>,
    step: usize,
    crossings: Vec<Crossing>,
}

impl SwitchWatch {
    /// Over the parts of a model.
    pub fn new(model: &Model) -> Self {
        let mut known: HashMap<*const Formula, Option<Switches>> = HashMap::new();
        let mut of = |formula: &std::sync::Arc<Formula>, state: usize| -> Option<Switches> {
            known.entry(std::sync::Arc::as_ptr(formula)).or_insert_with(|| formula.switches(state)).clone()
        };
        let dofs = |nodes: &[NodeId]| nodes.iter().map(|node| model.nodes[node.0].dofs.clone()).collect();
        let mut parts = Vec::new();
        let mut add = |name: &str, switches, of_element, nodes: &[NodeId], parameters: &Range<usize>| {
            let (name, dofs, parameters) = (name.into(), dofs(nodes), parameters.clone());
            let (inputs, numbers) = (Vec::new(), Vec::new());
            parts.push(Watched { name, switches, of_element, dofs, parameters, inputs, numbers });
        };
        for own in model.elements.iter().filter(|own| own.physics.residual_refused().is_none()) {
            if let Some(switches) = of(own.physics.residual(), 3 * own.physics.dof_count()) {
                add(&own.name, switches, true, &own.nodes, &own.parameters);
            }
        }
        for own in model.constraints.iter().filter(|own| own.physics.refused().is_none()) {
            if let Some(switches) = of(own.physics.formula(), 2 * own.physics.dof_count()) {
                add(&own.name, switches, false, &own.nodes, &own.parameters);
            }
        }
        let (at, work) = (VectorsAvq::default(), ProgramWork::default());
        SwitchWatch { parts, at, inputs: Vec::new(), numbers: Vec::new(), work, step: 0, crossings: Vec::new() }
    }

    /// The start of the run.
    pub fn start(&mut self, start: &StartRecord<f64>, p: &[f64]) {
        if !self.parts.is_empty() {
            self.at = start.acceleration.point();
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
            let solve = &stage.solve;
            self.at.a.resize(solve.base.a.len(), 0.0);
            self.at.v.resize(solve.base.v.len(), 0.0);
            self.at.q.resize(solve.base.q.len(), 0.0);
            self.at.set_shifted(&solve.base, solve.equations.residual, &solve.unknowns);
            self.compare(p, solve.t);
        }
        self.at.v.clone_from(&step.v);
        self.at.q.clone_from(&step.q);
        let end = step.t + step.h;
        self.compare(p, end);
        self.begin(p, end);
    }

    /// What was noted, jumps first.
    pub fn finish(self) -> Vec<Crossing> {
        let mut crossings = self.crossings;
        crossings.sort_by_key(|own| (own.kind != SwitchKind::Jump, own.step));
        crossings
    }

    fn begin(&mut self, p: &[f64], t: f64) {
        for part in &mut self.parts {
            write(&self.at, p, t, (part.of_element, &part.dofs, &part.parameters), &mut part.inputs);
            part.switches.evaluate(&part.inputs, &mut part.numbers, &mut self.work);
        }
    }

    fn compare(&mut self, p: &[f64], t: f64) {
        let SwitchWatch { parts, at, inputs, numbers, work, step, crossings } = self;
        for part in parts {
            write(at, p, t, (part.of_element, &part.dofs, &part.parameters), inputs);
            part.switches.evaluate(inputs, numbers, work);
            if !part.switches.change(&part.numbers, numbers) {
                continue;
            }
            // along the way an element's inertia would cancel its forces: the accelerations stay, unless a switch reads them
            let mut to = inputs.clone();
            let count: usize = part.dofs.iter().map(Range::len).sum();
            if part.of_element {
                to[..count].copy_from_slice(&part.inputs[..count]);
            }
            part.switches.evaluate(&to, numbers, work);
            let to = if part.switches.change(&part.numbers, numbers) { &to } else { &*inputs };
            let Some(kind) = part.switches.kind(&part.inputs, to) else { continue };
            match crossings.iter_mut().find(|own| own.part == part.name && own.kind == kind) {
                Some(own) => own.count += usize::from(std::mem::replace(&mut own.last, *step) != *step),
                None => crossings.push(Crossing { part: part.name.clone(), kind, step: *step, t, count: 1, last: *step }),
            }
        }
    }
}

fn write(
    at: &VectorsAvq<f64>,
    p: &[f64],
    t: f64,
    (of_element, dofs, parameters): (bool, &[Range<usize>], &Range<usize>),
    inputs: &mut Vec<f64>,
) {
    inputs.clear();
    let lists = [&at.a, &at.v, &at.q];
    for list in if of_element { &lists[..] } else { &lists[1..] } {
        dofs.iter().for_each(|own| inputs.extend_from_slice(&list[own.clone()]));
    }
    inputs.extend_from_slice(&p[parameters.clone()]);
    inputs.push(t);
}
