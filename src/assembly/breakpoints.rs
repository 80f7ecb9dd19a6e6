use super::Model;
use crate::elements::RunScalar;
use crate::program::{Graph, Node, Recorded, Recording, record};

impl Model {
    /// Times at which loads jump or drivers are not smooth, for given parameters \[s\].
    pub fn breakpoints(&self, p: &[f64]) -> Vec<f64> {
        let elements = self.elements.iter().flat_map(|e| e.physics.breakpoint_times(&p[e.parameters.clone()]));
        let joints = self.constraints.iter().flat_map(|c| c.physics.breakpoint_times(&p[c.parameters.clone()]));
        elements.chain(joints).collect()
    }

    fn recorded_breakpoints(&self, p: &[Recorded]) -> Vec<Recorded> {
        let elements = self.elements.iter().flat_map(|e| e.physics.recorded_breakpoints(&p[e.parameters.clone()]));
        let joints = self.constraints.iter().flat_map(|c| c.physics.recorded_breakpoints(&p[c.parameters.clone()]));
        elements.chain(joints).collect()
    }
}

/// The breakpoints of a model as functions of its parameters, recorded at some of these.
pub struct BreakpointMap {
    graph: Graph,
    times: Vec<Node>,
    p: Vec<f64>,
}

impl BreakpointMap {
    /// At parameters.
    pub fn record(model: &Model, p: &[f64]) -> Self {
        let (times, Recording { mut graph, .. }) = record(p, |p| model.recorded_breakpoints(p));
        let times = times.into_iter().map(|time| time.node(&mut graph)).collect();
        BreakpointMap { graph, times, p: p.to_vec() }
    }

    /// Derivative parts of all breakpoints, without their values, for parameters with parts.
    pub fn parts<S: RunScalar>(&self, p: &[S]) -> Vec<S> {
        let mut values = Vec::new();
        self.graph.evaluate(p, &mut values);
        let of = |time: &Node| values[time.0 as usize];
        self.times.iter().map(|time| of(time) - of(time).value()).collect()
    }

    /// Whether one of some breakpoints depends on one of the `active` parameters.
    pub fn reads(&self, numbers: &[usize], active: &[bool]) -> bool {
        let times: Vec<Node> = numbers.iter().map(|&number| self.times[number]).collect();
        self.graph.reads(&times, self.p.len()).iter().zip(active).any(|(&reads, &active)| reads && active)
    }

    /// Number of breakpoints.
    pub fn count(&self) -> usize {
        self.times.len()
    }

    /// Adds the gradient of the sum of all breakpoints times their weights to that of the parameters.
    pub fn add_transposed(&self, weights: &[f64], p_bar: &mut [f64]) {
        let mut graph = self.graph.clone();
        let towards: Vec<Node> = (0..self.p.len()).map(|place| graph.input(place)).collect();
        let weights: Vec<Node> = weights.iter().map(|&weight| graph.constant(weight)).collect();
        let gradient = graph.reverse(&self.times, &weights, &towards);
        let mut values = Vec::new();
        graph.evaluate(&self.p, &mut values);
        p_bar.iter_mut().zip(gradient).for_each(|(bar, own)| *bar += values[own.0 as usize]);
    }
}
