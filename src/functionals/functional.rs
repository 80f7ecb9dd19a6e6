use super::load::JointLoad;
use super::reactions::{Bars, add_least_multipliers_transposed, least_multipliers};
use super::{AnyQuantity, FunctionalScalar};
use crate::assembly::{ConstraintId, Model, NodeId, VectorsAvq};
use crate::elements::{RunScalar as _, State};
use crate::integrators::{StartRecord, StepRecord};
use crate::scalar::{LANES, Lanes};
use smallvec::SmallVec;
use std::ops::Range;

/// What is measured at one time.
pub enum Measured {
    /// A quantity of some nodes and constraints.
    Local {
        /// Nodes, in the order in which it sees their coordinates.
        nodes: Vec<NodeId>,
        /// Constraints whose multipliers it sees.
        constraints: Vec<ConstraintId>,
        /// Place of its parameters in p.
        parameters: Range<usize>,
        /// The formula.
        quantity: Box<dyn AnyQuantity>,
    },
    /// A force or moment with which a joint acts on one of its nodes.
    Load {
        /// The joint.
        joint: ConstraintId,
        /// Place of the load's parameters in p.
        parameters: Range<usize>,
        /// Which one.
        load: JointLoad,
    },
    /// Kinetic and potential energy of all elements [J].
    Energy,
    /// Mass of all elements [kg].
    Mass,
}

/// What is made of it over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Over {
    /// Value at the start.
    Initial,
    /// Value at the end.
    Terminal,
    /// Integral over time, with the integrator's own weights.
    Integral,
    /// Smooth maximum (Kreisselmeier & Steinhauser): c + ln(I) / rho, I = integral of exp(rho (y - c)), c the largest y seen.
    ///
    /// With `normalized` I is divided by the duration, which makes the value independent of the unit of time and at most the
    /// maximum; without, it is the form of Boopathy & Kennedy.
    SmoothMaximum {
        /// rho, in units of 1 / y.
        sharpness: f64,
        /// Divide by the duration.
        normalized: bool,
    },
}

/// A functional f: a measured quantity and what is made of it over time.
pub struct Functional {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// What is measured.
    pub measured: Measured,
    /// What is made of it.
    pub over: Over,
}

/// States at which a functional reads: a stage, the start, or the end.
#[derive(Clone, Debug)]
pub struct Sample<S> {
    /// Time [s].
    pub t: f64,
    /// Weight in an integral [s]; h b_i for a one-step table.
    pub weight: f64,
    /// Accelerations, velocities, coordinates.
    pub at: VectorsAvq<S>,
    /// Multipliers: of least norm where constraints are redundant.
    pub mu: Vec<S>,
    /// Multipliers as solved, where constraints are redundant; empty otherwise.
    pub solved_mu: Vec<S>,
    /// Redundant constraint equations that were left out.
    pub dropped: Vec<usize>,
}

impl<S: FunctionalScalar> Sample<S> {
    /// At the start: projected state, first acceleration.
    pub fn initial(start: &StartRecord<S>) -> Self {
        let (dropped, start) = (start.dropped.clone(), &start.acceleration);
        let mu = start.unknowns.mu.clone();
        Sample { t: start.t, weight: 0.0, at: start.point(), mu, solved_mu: Vec::new(), dropped }
    }

    /// Room for a sample.
    pub fn empty() -> Self {
        Sample { t: 0.0, weight: 0.0, at: VectorsAvq::default(), mu: Vec::new(), solved_mu: Vec::new(), dropped: Vec::new() }
    }

    /// Moves to the end of a step: its state, with acceleration and multipliers of the last stage (none without stages).
    pub fn set_terminal(&mut self, step: &StepRecord<S>) {
        (self.t, self.weight) = (step.t + step.h, 0.0);
        self.at.v.clone_from(&step.v);
        self.at.q.clone_from(&step.q);
        self.solved_mu.clear();
        self.dropped.clone_from(&step.dropped);
        if let Some(last) = step.stages.last() {
            last.solve.write_acceleration(&mut self.at.a);
            self.mu.clone_from(&last.solve.unknowns.mu);
        }
    }

    /// Moves to a stage, with its weight in an integral.
    pub fn set_stage(&mut self, step: &StepRecord<S>, stage: usize, weight: f64) {
        let solve = &step.stages[stage].solve;
        (self.t, self.weight) = (solve.t, weight);
        self.at.a.resize(solve.base.a.len(), S::zero());
        self.at.v.resize(solve.base.v.len(), S::zero());
        self.at.q.resize(solve.base.q.len(), S::zero());
        self.at.set_shifted(&solve.base, solve.equations.residual, &solve.unknowns);
        self.mu.clone_from(&solve.unknowns.mu);
        self.solved_mu.clear();
        self.dropped.clone_from(&step.dropped);
    }

    /// Shares the forces of redundant constraints among all of them, if equations were dropped.
    pub fn share(&mut self, model: &Model, p: &[S]) {
        if !self.dropped.is_empty() && !self.mu.is_empty() {
            let shared = least_multipliers(model, &self.dropped, p, &self.at.q, &self.mu, self.t);
            self.solved_mu = std::mem::replace(&mut self.mu, shared);
        }
    }
}

impl Sample<f64> {
    /// Goes back through [`Sample::share`]: from the adjoints of shared multipliers to those of solved ones, of coordinates and of
    /// parameters.
    pub fn share_transposed(&self, model: &Model, p: &[f64], mu_bar: &mut [f64], q_bar: &mut [f64], p_bar: &mut [f64]) {
        if !self.solved_mu.is_empty() && mu_bar.iter().any(|&bar| bar != 0.0) {
            let shared = mu_bar.to_vec();
            mu_bar.fill(0.0);
            let bars = Bars { q: q_bar, mu: mu_bar, p: p_bar };
            add_least_multipliers_transposed(model, &self.dropped, (p, &self.at.q, &self.solved_mu), self.t, &shared, bars);
        }
    }
}

impl Functional {
    /// Unit of its value: an integral has the second of the integration in it.
    pub fn value_unit(&self) -> String {
        match (self.over, self.unit) {
            (Over::Integral, "-") => "s".into(),
            (Over::Integral, unit) => format!("{unit} s"),
            (_, unit) => unit.into(),
        }
    }

    /// Whether it reads multipliers.
    pub fn reads_multipliers(&self) -> bool {
        match &self.measured {
            Measured::Local { constraints, .. } => !constraints.is_empty(),
            Measured::Load { .. } => true,
            Measured::Energy | Measured::Mass => false,
        }
    }

    /// Factor with which the gradient of the measured quantity at a stage enters df.
    pub fn stage_factor(&self, model: &Model, sample: &Sample<f64>, p: &[f64], value: f64, duration: f64) -> f64 {
        match self.over {
            Over::Initial | Over::Terminal => 0.0,
            Over::Integral => sample.weight,
            Over::SmoothMaximum { sharpness, normalized } => {
                // d f = sum w exp(rho (y - c)) dy / integral, and the integral is exp(rho (f - c)) times the measure: c cancels
                let measure = if normalized { duration } else { 1.0 };
                let y = self.measured.value(model, sample, p);
                sample.weight * (sharpness * (y - value)).exp() / measure
            }
        }
    }
}

/// Numbers of one element: on the stack for up to two bodies.
type Few<S> = SmallVec<[S; 16]>;

fn gather<S: Copy>(model: &Model, nodes: &[NodeId], values: &[S]) -> Few<S> {
    nodes.iter().flat_map(|node| values[model.nodes[node.0].dofs.clone()].iter().copied()).collect()
}

impl Measured {
    /// The value at a sample.
    pub fn value<S: FunctionalScalar>(&self, model: &Model, sample: &Sample<S>, p: &[S]) -> S {
        match self {
            Measured::Local { nodes, constraints, parameters, quantity } => {
                let [a, v, q] = [&sample.at.a, &sample.at.v, &sample.at.q].map(|x| gather(model, nodes, x));
                let rows = constraints.iter().flat_map(|id| model.constraints[id.0].equations.clone());
                let mu: Few<S> = rows.map(|row| sample.mu[row]).collect();
                let state = State { a: &a, v: &v, q: &q };
                S::quantity(&**quantity).value_in(state, &mu, &p[parameters.clone()], S::from(sample.t))
            }
            Measured::Load { joint, parameters, load } => {
                let joint = &model.constraints[joint.0];
                let q = gather(model, &joint.nodes, &sample.at.q);
                let (mu, own) = (&sample.mu[joint.equations.clone()], &p[joint.parameters.clone()]);
                load.value(&*joint.physics, &q, mu, own, &p[parameters.clone()], S::from(sample.t))
            }
            Measured::Energy => {
                let own = |element: &crate::assembly::Attached<dyn crate::elements::AnyElement>| {
                    let [v, q] = [&sample.at.v, &sample.at.q].map(|x| gather(model, &element.nodes, x));
                    let [t, v] = S::element(&*element.physics).energy(&v, &q, &p[element.parameters.clone()]);
                    t + v
                };
                model.elements.iter().map(own).sum()
            }
            Measured::Mass => {
                let own = |element: &crate::assembly::Attached<dyn crate::elements::AnyElement>| {
                    S::element(&*element.physics).mass_in(&p[element.parameters.clone()])
                };
                model.elements.iter().map(own).sum()
            }
        }
    }

    /// Adds `factor` times the gradient at a sample.
    pub fn add_gradient(
        &self,
        model: &Model,
        sample: &Sample<f64>,
        p: &[f64],
        factor: f64,
        at_bar: &mut VectorsAvq<f64>,
        mu_bar: &mut [f64],
        p_bar: &mut [f64],
    ) {
        let t = Lanes::from(sample.t);
        match self {
            Measured::Local { nodes, constraints, parameters, quantity } => {
                let dofs: Vec<usize> = nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()).collect();
                let rows: Vec<usize> = constraints.iter().flat_map(|id| model.constraints[id.0].equations.clone()).collect();
                let n = dofs.len();
                let places: Vec<f64> = [&sample.at.a, &sample.at.v, &sample.at.q]
                    .into_iter()
                    .flat_map(|x| dofs.iter().map(|&dof| x[dof]))
                    .chain(rows.iter().map(|&row| sample.mu[row]))
                    .chain(p[parameters.clone()].iter().copied())
                    .collect();
                let reads = quantity.reads_states();
                let varied = (0..places.len()).filter(|&place| place >= 3 * n || reads[place / n]);
                let gradient = lanes_gradient(&places, varied, |x| {
                    let state = State { a: &x[..n], v: &x[n..2 * n], q: &x[2 * n..3 * n] };
                    let (mu, p) = x[3 * n..].split_at(rows.len());
                    Lanes::quantity(&**quantity).value_in(state, mu, p, t)
                });
                for (i, &dof) in dofs.iter().enumerate() {
                    at_bar.a[dof] += factor * gradient[i];
                    at_bar.v[dof] += factor * gradient[n + i];
                    at_bar.q[dof] += factor * gradient[2 * n + i];
                }
                for (i, &row) in rows.iter().enumerate() {
                    mu_bar[row] += factor * gradient[3 * n + i];
                }
                for (i, place) in parameters.clone().enumerate() {
                    p_bar[place] += factor * gradient[3 * n + rows.len() + i];
                }
            }
            Measured::Load { joint, parameters, load } => {
                let joint = &model.constraints[joint.0];
                let dofs: Vec<usize> = joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()).collect();
                let places: Vec<f64> = (dofs.iter().map(|&dof| sample.at.q[dof]))
                    .chain(joint.equations.clone().map(|row| sample.mu[row]))
                    .chain(p[joint.parameters.clone()].iter().copied())
                    .chain(p[parameters.clone()].iter().copied())
                    .collect();
                let (n, m) = (dofs.len(), joint.equations.len());
                let own = n + m + joint.parameters.len();
                let gradient = lanes_gradient(&places, 0..places.len(), |x| {
                    load.value(&*joint.physics, &x[..n], &x[n..n + m], &x[n + m..own], &x[own..], t)
                });
                for (&dof, g) in dofs.iter().zip(&gradient) {
                    at_bar.q[dof] += factor * g;
                }
                for (row, g) in joint.equations.clone().zip(&gradient[n..]) {
                    mu_bar[row] += factor * g;
                }
                for (place, g) in joint.parameters.clone().chain(parameters.clone()).zip(&gradient[n + m..]) {
                    p_bar[place] += factor * g;
                }
            }
            Measured::Energy => {
                for element in &model.elements {
                    let dofs: Vec<usize> = element.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()).collect();
                    let n = dofs.len();
                    let places: Vec<f64> = [&sample.at.v, &sample.at.q]
                        .into_iter()
                        .flat_map(|x| dofs.iter().map(|&dof| x[dof]))
                        .chain(p[element.parameters.clone()].iter().copied())
                        .collect();
                    let gradient = lanes_gradient(&places, 0..places.len(), |x| {
                        let [t, v] = Lanes::element(&*element.physics).energy(&x[..n], &x[n..2 * n], &x[2 * n..]);
                        t + v
                    });
                    for (i, &dof) in dofs.iter().enumerate() {
                        at_bar.v[dof] += factor * gradient[i];
                        at_bar.q[dof] += factor * gradient[n + i];
                    }
                    for (i, place) in element.parameters.clone().enumerate() {
                        p_bar[place] += factor * gradient[2 * n + i];
                    }
                }
            }
            Measured::Mass => {
                for element in &model.elements {
                    let own = &p[element.parameters.clone()];
                    let mass = |p: &[Lanes]| Lanes::element(&*element.physics).mass_in(p);
                    let gradient = lanes_gradient(own, 0..own.len(), mass);
                    for (place, g) in element.parameters.clone().zip(gradient) {
                        p_bar[place] += factor * g;
                    }
                }
            }
        }
    }
}

/// Gradient of a function of several numbers towards the `varied` ones, eight at a time; 0 towards the others.
fn lanes_gradient(at: &[f64], varied: impl Iterator<Item = usize>, function: impl Fn(&[Lanes]) -> Lanes) -> Vec<f64> {
    let mut x: Vec<Lanes> = at.iter().map(|&x| Lanes::constant(x)).collect();
    let mut gradient = vec![0.0; x.len()];
    let mut varied = varied.peekable();
    while varied.peek().is_some() {
        let group: SmallVec<[usize; LANES]> = varied.by_ref().take(LANES).collect();
        for (lane, &place) in group.iter().enumerate() {
            x[place].eps[lane] = 1.0;
        }
        let value = function(&x);
        for (lane, &place) in group.iter().enumerate() {
            gradient[place] = value.eps[lane];
            x[place].eps[lane] = 0.0;
        }
    }
    gradient
}
