//! Times of programs, and of the whole way through the assembly.

use super::items::{Item, Physics};
use crate::Clock;
use costate::elements::NodeKind;
use costate::internals::{
    Codes, ConstraintPhysics, ElementPhysics, Equations, Formula, Graph, Jacobian, Level, Model, Node, PartPrograms,
    Program, ProgramWork, Residual, RunScalar, StageCoefficients, StageSystem, System, SystemOptions, VectorsAvq, lanes,
    making_time, motion_derivatives,
};
use costate::scalar::{TANGENTS, Tangents};
use num_dual::Derivative;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Measurements of which the least counts.
const MEASUREMENTS: usize = 25;
/// Length of one measurement [s].
const LENGTH: f64 = 1e-4;

/// Numbers of the size of Euler parameters, none of them alike.
pub fn number(i: usize) -> f64 {
    0.6 + 0.35 * (1.7 * i as f64 + 0.3).sin()
}

/// Something that is repeated to be measured.
pub struct Measured<'m> {
    run: Box<dyn FnMut() + 'm>,
    repetitions: usize,
    /// Least time of one repetition so far [s].
    pub best: f64,
}

impl<'m> Measured<'m> {
    pub fn new(mut run: impl FnMut() + 'm) -> Self {
        run();
        let mut repetitions = 1;
        loop {
            let clock = Clock::start();
            (0..repetitions).for_each(|_| run());
            if clock.seconds() >= LENGTH || repetitions > 1 << 20 {
                return Measured { run: Box::new(run), repetitions, best: f64::INFINITY };
            }
            repetitions *= 2;
        }
    }

    /// Measures once more.
    pub fn again(&mut self) {
        let clock = Clock::start();
        (0..self.repetitions).for_each(|_| (self.run)());
        self.best = self.best.min(clock.seconds() / self.repetitions as f64);
    }
}

/// Least times [s] of several things that are measured in turn, so that what disturbs one disturbs all.
pub fn least<const N: usize>(mut all: [Measured; N], rounds: usize) -> [f64; N] {
    for _ in 0..rounds {
        all.iter_mut().for_each(Measured::again);
    }
    all.map(|one| one.best)
}

/// Numbers that start at a line of the cache.
struct Aligned(Vec<f64>, usize);

impl Aligned {
    fn new(count: usize) -> Self {
        // each at another place of a page: where stores and loads meet at the same place of two pages, loads wait
        static PLACES: AtomicUsize = AtomicUsize::new(0);
        let shift = 40 * (PLACES.fetch_add(1, Ordering::Relaxed) % 13);
        let values = vec![0.0_f64; count + shift + 8];
        let start = values.as_ptr().align_offset(64).min(8) + shift;
        Aligned(values, start)
    }
    fn all(&mut self, count: usize) -> &mut [f64] {
        &mut self.0[self.1..self.1 + count]
    }
}

/// A program that is run for one element, or for as many as there are lanes.
pub fn repeated(program: &Program, wide: bool) -> Measured<'_> {
    let width = if wide { lanes() } else { 1 };
    let counts = [program.inputs() * width, program.outputs() * width];
    let [mut inputs, mut outputs] = counts.map(Aligned::new);
    inputs.all(counts[0]).iter_mut().enumerate().for_each(|(i, x)| *x = number(i / width) + 1e-3 * (i % width) as f64);
    let mut work = ProgramWork::default();
    Measured::new(move || {
        let (inputs, outputs) = (inputs.all(counts[0]), outputs.all(counts[1]));
        if wide {
            (0..program.sections()).for_each(|section| program.run_section(section, inputs, outputs, &mut work));
        } else {
            program.run(inputs, outputs, &mut work);
        }
    })
}

/// What a program costs.
#[derive(Clone, Copy, Default)]
pub struct ProgramCost {
    pub operations: usize,
    /// For one element [us]: one lane, all lanes.
    pub times: [f64; 2],
    /// For making its machine code in both widths [ms].
    pub compiling: f64,
}

impl ProgramCost {
    pub fn of(program: &Program) -> Self {
        let before = making_time();
        let all = [repeated(program, false), repeated(program, true)];
        let compiling = 1e3 * (making_time() - before);
        let [one, wide] = least(all, MEASUREMENTS);
        let times = [1e6 * one, 1e6 * wide / lanes() as f64];
        ProgramCost { operations: program.instructions(), times, compiling }
    }
}

/// Copies of an item with nodes of their own, or these nodes alone.
fn model(item: &Item, copies: usize, alone: bool) -> Model {
    let mut model = Model::default();
    for copy in 0..copies {
        let add = |(i, kind): (usize, &NodeKind)| model.add_node(&format!("node {copy}, {i}"), *kind, false);
        let nodes: Vec<_> = item.nodes.iter().enumerate().map(add).collect();
        match (item.physics)() {
            _ if alone => {}
            Physics::Element(own) => drop(model.add_element(&format!("part {copy}"), &nodes, own.into())),
            Physics::Constraint(own) => drop(model.add_constraint(&format!("part {copy}"), &nodes, own.into())),
        }
    }
    model
}

/// Time of all programs and ways of one item.
pub struct ItemCost {
    /// Residual, matrix, products, second derivatives of what adjoint variables weigh times a vector.
    pub programs: [ProgramCost; 4],
    /// For deriving the programs and making their machine code [ms].
    pub making: f64,
    /// Residual and matrix of one copy through the assembly.
    pub one: ThroughAssembly,
    /// The same for each of many copies.
    pub many: ThroughAssembly,
    /// The matrix by dual numbers of eight parts instead [us].
    pub dual: f64,
}

/// Copies in one model.
pub const COPIES: usize = 40;

/// Equations of an implicit step at acceleration level.
fn equations() -> Equations {
    let h = 0.01;
    Equations::stage(StageCoefficients::new(1.0, 0.25 * h, 0.0625 * h * h), Level::Acceleration)
}

/// Coordinates near those of nodes at rest.
fn start(model: &Model) -> Vec<f64> {
    let mut q = Vec::new();
    for (place, node) in model.nodes.iter().enumerate() {
        let near = |at: &[f64]| at.iter().map(|x| x + 1e-3 * number(place)).collect::<Vec<f64>>();
        let x = 0.5 * (place % 3) as f64;
        q.extend(match node.kind {
            NodeKind::Point => near(&[x, 0.0, 0.0]),
            NodeKind::Body => near(&[x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
            NodeKind::Natural => near(&[x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]),
            NodeKind::Slope => near(&[x, 0.0, 0.0, 1.0, 0.0, 0.0]),
            NodeKind::Coordinates(count) | NodeKind::States(count) => (0..count).map(number).collect(),
        });
    }
    q
}

/// Residual and matrix of a model through the assembly.
pub fn assembled<'s>(system: &'s System<'s>) -> [Measured<'s>; 2] {
    let (n, equations) = (system.model.dofs, equations());
    let numbers = |scale: f64, n: usize| -> Vec<f64> { (0..n).map(|i| scale * (1.3 * i as f64).sin()).collect() };
    let base = VectorsAvq { a: numbers(1.0, n), v: numbers(0.5, n), q: start(system.model) };
    let p: Vec<f64> = (0..system.model.parameters).map(number).collect();
    let mut residual = Residual::<f64>::default();
    let mut unknowns = Residual::unknowns(system);
    unknowns.mu.iter_mut().enumerate().for_each(|(i, mu)| *mu = (0.7 * i as f64).cos());
    let (mut other, mut at) = (Residual::<f64>::default(), unknowns.clone());
    other.evaluate(system, StageSystem { equations: &equations, base: &base, p: &p, t: 0.3 }, &mut at);
    let mut jacobian = Jacobian::default();
    let parameters = p.clone();
    [
        Measured::new(move || {
            let stage = StageSystem { equations: &equations, base: &base, p: &parameters, t: 0.3 };
            residual.evaluate(system, stage, &mut unknowns)
        }),
        Measured::new(move || jacobian.assemble(system, &equations, &other, &at, &p, 0.3)),
    ]
}

/// A model of an item: its copies, or their nodes alone.
pub fn assembly(item: &Item, copies: usize, alone: bool) -> Model {
    model(item, copies, alone)
}

/// Residual and matrix of an item in a model of copies [us for each copy], then those of the same model with the nodes alone.
#[derive(Clone, Copy)]
pub struct ThroughAssembly([f64; 4]);

impl ThroughAssembly {
    /// Residual and matrix less those of the nodes [us]. The least times are found before the difference: the least difference would be
    /// that of the slowest measurement of the nodes.
    pub fn times(self) -> [f64; 2] {
        let ThroughAssembly([residual, matrix, residual_alone, matrix_alone]) = self;
        [residual - residual_alone, matrix - matrix_alone]
    }

    /// The least of two measurements.
    pub fn least(self, other: Self) -> Self {
        ThroughAssembly(smaller(self.0, other.0))
    }
}

/// One measurement of an item through the assembly.
pub fn through_assembly(item: &Item, copies: usize) -> ThroughAssembly {
    let models = [false, true].map(|alone| assembly(item, copies, alone));
    let [with, alone] = models.each_ref().map(|model| System::new(model, SystemOptions::default()));
    let [[of_residual, of_matrix], [residual, matrix]] = [assembled(&with), assembled(&alone)];
    let best = least([of_residual, of_matrix, residual, matrix], MEASUREMENTS);
    ThroughAssembly(best.map(|seconds| 1e6 * seconds / copies as f64))
}

/// Programs of an item: those that the assembly executes, and second derivatives.
pub fn programs(item: &Item) -> [Arc<Program>; 4] {
    let model = assembly(item, 1, false);
    let system = System::new(&model, SystemOptions::default());
    let mut all = system.part_programs(&equations());
    let PartPrograms { residual, matrix, products: [products, _] } = all.pop().expect("a model of one part");
    let second = match (item.physics)() {
        Physics::Element(own) => second_of_element(&ElementPhysics::new(own.into())),
        Physics::Constraint(own) => second_of_constraint(&ConstraintPhysics::new(own.into())),
    };
    [residual, matrix, products, second]
}

/// H z with the second derivatives H of a weighted sum towards some arguments.
fn second(graph: &mut Graph, (outputs, weights): (&[Node], &[Node]), towards: &[Node], z: &[Node]) -> Vec<Node> {
    let gradient = graph.reverse(outputs, weights, towards);
    let seeds: Vec<(Node, Node)> = towards.iter().copied().zip(z.iter().copied()).collect();
    graph.forward(&gradient, &seeds)
}

/// Of lambda . R towards (a, v, q).
fn second_of_element(physics: &ElementPhysics) -> Arc<Program> {
    let n = physics.dof_count();
    let formula: &Formula = physics.residual();
    formula.dense_program(("own 1", Codes::new()), 4 * n, |graph, inputs, outputs| {
        let (lambda, z) = inputs[formula.inputs..].split_at(n);
        second(graph, (outputs, lambda), &inputs[..3 * n], z)
    })
}

/// Of lambda_F . A^T mu + lambda_G . d2g/dt2 towards (v, q, a, mu).
fn second_of_constraint(physics: &ConstraintPhysics) -> Arc<Program> {
    let (n, count, is_nonholonomic) = (physics.dof_count(), physics.equation_count(), physics.is_nonholonomic());
    let formula: &Formula = physics.formula();
    formula.dense_program(("own 1", Codes::new()), 5 * n + 3 * count, |graph, inputs, outputs| {
        let (v, q, time) = (&inputs[..n], &inputs[n..2 * n], inputs[formula.inputs - 1]);
        let (own, rest) = inputs[formula.inputs..].split_at(n + count);
        let (a, mu) = own.split_at(n);
        let (lambda, z) = rest.split_at(n + count);
        let [_, first, last] = motion_derivatives(graph, outputs, [a, v, q], time);
        let mut all = graph.reverse(outputs, mu, if is_nonholonomic { v } else { q });
        all.extend(if is_nonholonomic { first } else { last });
        let towards: Vec<Node> = [v, q, a, mu].concat();
        second(graph, (&all, lambda), &towards, z)
    })
}

/// The matrix of a program of residuals by dual numbers of eight parts, operation by operation: one run for every eight columns.
fn by_dual_numbers<'p>(program: &'p Program, columns: usize) -> Measured<'p> {
    let numbers = |count: usize| -> Vec<Tangents> {
        let parts = |i: usize| nalgebra::SVector::from_fn(|part, _| number(i + part));
        (0..count).map(|i| Tangents::new(number(i), Derivative::some(parts(i)))).collect()
    };
    let (inputs, mut outputs) = (numbers(program.inputs()), numbers(program.outputs()));
    let mut work = ProgramWork::default();
    Measured::new(move || {
        (0..columns.div_ceil(TANGENTS)).for_each(|_| Tangents::run(program, &inputs, &mut outputs, &mut work));
    })
}

/// The smaller of each two.
fn smaller<const N: usize>(one: [f64; N], other: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| one[i].min(other[i]))
}

impl ItemCost {
    /// Keeps the least times of another measurement of the same item.
    pub fn improve(&mut self, other: &ItemCost) {
        for (own, other) in self.programs.iter_mut().zip(&other.programs) {
            own.times = smaller(own.times, other.times);
        }
        (self.one, self.many) = (self.one.least(other.one), self.many.least(other.many));
        self.dual = self.dual.min(other.dual);
    }

    pub fn of(item: &Item) -> Self {
        let begun = Clock::start();
        let all = programs(item);
        let deriving = 1e3 * begun.seconds();
        let costs = all.each_ref().map(|program| ProgramCost::of(program));
        let model = assembly(item, 1, false);
        let [dual] = least([by_dual_numbers(&all[0], model.dofs + model.equations)], MEASUREMENTS);
        ItemCost {
            programs: costs,
            making: deriving + costs.iter().map(|cost| cost.compiling).sum::<f64>(),
            one: through_assembly(item, 1),
            many: through_assembly(item, COPIES),
            dual: 1e6 * dual,
        }
    }
}
