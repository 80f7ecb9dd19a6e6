//! A simulated scene in a program: its values, their courses in time, its nodes and joints, by name.

use super::prepared::Prepared;
use super::unknown;
use crate::assembly::{ConstraintId, NodeId};
use crate::functionals::Sample;
use crate::integrators::RunError;
use crate::scalar::SpatialVector;
use crate::sensitivity::{Forward, Gradient, SwitchError};

/// A run of a prepared scene at its design.
pub struct Run<'p> {
    /// What was run.
    pub prepared: &'p Prepared<'p>,
    /// Its values, its steps as they were kept, and the work that they took.
    pub forward: Forward,
}

/// What a functional measures, at the start and at the end of each step.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeSeries {
    /// Times \[s\].
    pub times: Vec<f64>,
    /// A value for each time.
    pub values: Vec<f64>,
    /// Unit of the values.
    pub unit: &'static str,
}

/// The motion of a node, at the start and at the end of each step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeHistory {
    /// Times \[s\].
    pub times: Vec<f64>,
    /// Coordinates q: place and Euler parameters of a body, the values of a node of coordinates.
    pub coordinates: Vec<Vec<f64>>,
    /// dq/dt.
    pub rates: Vec<Vec<f64>>,
    /// Place of the node's frame \[m\]; empty for a node without a place in space, as are the next two.
    pub positions: Vec<[f64; 3]>,
    /// Its velocity [m/s].
    pub velocities: Vec<[f64; 3]>,
    /// Its acceleration [m/s2], as solved for in the last stage of each step.
    pub accelerations: Vec<[f64; 3]>,
    /// Axes x, y, z of the node's frame in the world; empty for a node that cannot turn, as is the next.
    pub axes: Vec<[[f64; 3]; 3]>,
    /// Angular velocity in the world [rad/s].
    pub angular_velocities: Vec<[f64; 3]>,
}

/// What a joint or driver does to the last of its nodes that moves, at the start and at the end of each step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointHistory {
    /// Times \[s\].
    pub times: Vec<f64>,
    /// Force in the world \[N\]; empty where the joint holds nothing in space.
    pub forces: Vec<[f64; 3]>,
    /// Moment about the point of the joint [N m], in the world; empty where the node cannot turn.
    pub moments: Vec<[f64; 3]>,
    /// Multipliers of its equations.
    pub multipliers: Vec<Vec<f64>>,
}

fn named<T>(kind: &str, name: &str, found: Option<T>, known: impl Iterator<Item = String>) -> Result<T, RunError> {
    found.ok_or_else(|| RunError::Input(unknown(kind, name, &known.collect::<Vec<_>>())))
}

/// What a scene made, by the names that it gave.
impl Prepared<'_> {
    /// The node of a name; `BEAM.start` and `BEAM.end` are the ends of a beam or cable.
    ///
    /// # Errors
    /// [`RunError::Input`] for a name that the scene has not, with the nearest one; likewise those below.
    pub fn node(&self, name: &str) -> Result<NodeId, RunError> {
        let known = self.model().nodes.iter().map(|own| own.name.clone());
        let found = self.model().node_named(name).or_else(|| self.mechanism.node_at_end(name));
        named("node", name, found, known)
    }

    /// The joint, driver or other constraint of a name.
    ///
    /// # Errors
    /// See [`Prepared::node`].
    pub fn joint(&self, name: &str) -> Result<ConstraintId, RunError> {
        let known = self.model().constraints.iter().map(|own| own.name.clone());
        named("joint", name, self.model().constraint_named(name), known)
    }

    /// Place of a functional among [`Prepared::functionals`], in [`Forward::values`] and the rows of gradients.
    ///
    /// # Errors
    /// See [`Prepared::node`].
    pub fn functional(&self, name: &str) -> Result<usize, RunError> {
        let place = self.functionals().iter().position(|own| own.name == name);
        named("functional", name, place, self.functionals().iter().map(|own| own.name.clone()))
    }

    /// Place of a design variable in `x`, and in each row of a gradient.
    ///
    /// # Errors
    /// See [`Prepared::node`].
    pub fn variable(&self, name: &str) -> Result<usize, RunError> {
        let place = self.variables.iter().position(|own| own.name == name);
        named("design variable", name, place, self.variables.iter().map(|own| own.name.clone()))
    }

    /// Simulates the scene at its design.
    ///
    /// # Errors
    /// Those of [`Analysis::forward`](crate::sensitivity::Analysis::forward).
    pub fn run(&self) -> Result<Run<'_>, RunError> {
        Ok(Run { prepared: self, forward: self.analysis().forward(&self.x)? })
    }
}

impl Run<'_> {
    /// The value of a functional.
    ///
    /// # Errors
    /// A name that the scene has not.
    pub fn value(&self, functional: &str) -> Result<f64, RunError> {
        Ok(self.forward.values[self.prepared.functional(functional)?])
    }

    /// Derivatives of all functionals by all design variables, by the discrete adjoint.
    ///
    /// # Errors
    /// Those of [`Analysis::adjoint`](crate::sensitivity::Analysis::adjoint), and a gradient that a switch within a step makes
    /// [wrong](crate::sensitivity::SwitchError).
    pub fn gradient(&self) -> Result<Gradient, RunError> {
        let analysis = self.prepared.analysis();
        let gradient = analysis.adjoint(&self.prepared.x, &self.forward)?;
        let switched = analysis.switch_errors(&self.forward, &gradient)?;
        switched.iter().find_map(SwitchError::refused).map_or(Ok(gradient), |why| Err(RunError::Input(why)))
    }

    fn each(&self, see: impl FnMut(&Sample<f64>)) -> Result<(), RunError> {
        self.prepared.analysis().for_each_sample(&self.forward, see)
    }

    /// What a functional measures over time: of one that is an integral what is integrated, of a largest value what is compared.
    ///
    /// # Errors
    /// A name that the scene has not, and those of [`Analysis::for_each_sample`](crate::sensitivity::Analysis::for_each_sample).
    pub fn history(&self, functional: &str) -> Result<TimeSeries, RunError> {
        let own = &self.prepared.functionals()[self.prepared.functional(functional)?];
        let mut series = TimeSeries { times: Vec::new(), values: Vec::new(), unit: own.unit };
        self.each(|sample| {
            series.times.push(sample.t);
            series.values.push(own.measured_at(self.prepared.model(), sample, &self.forward.numbers.p));
        })?;
        Ok(series)
    }

    /// The motion of a node.
    ///
    /// # Errors
    /// As for [`Run::history`].
    pub fn node(&self, name: &str) -> Result<NodeHistory, RunError> {
        let node = self.prepared.model().node(self.prepared.node(name)?);
        let mut history = NodeHistory::default();
        self.each(|sample| {
            let [a, v, q] = [&sample.at.a, &sample.at.v, &sample.at.q].map(|all| &all[node.dofs.clone()]);
            history.times.push(sample.t);
            history.coordinates.push(q.to_vec());
            history.rates.push(v.to_vec());
            if node.kind.in_space().is_some() {
                history.positions.push([q[0], q[1], q[2]]);
                history.velocities.push([v[0], v[1], v[2]]);
                history.accelerations.push([a[0], a[1], a[2]]);
            }
            if node.kind.has_axes() {
                history.axes.push(node.kind.axes(q).map(|axis| axis.components()));
                history.angular_velocities.push(node.kind.angular_velocity(v, q).components());
            }
        })?;
        Ok(history)
    }

    /// Force, moment and multipliers of a joint or driver.
    ///
    /// # Errors
    /// As for [`Run::history`].
    pub fn joint(&self, name: &str) -> Result<JointHistory, RunError> {
        let mechanism = &self.prepared.mechanism;
        let joint = self.prepared.joint(name)?;
        let rows = mechanism.model.constraints[joint.0].equations.clone();
        let end = mechanism.joint_ends().into_iter().find(|end| end.joint == joint.0);
        let mut history = JointHistory::default();
        self.each(|sample| {
            history.times.push(sample.t);
            history.multipliers.push(sample.mu[rows.clone()].to_vec());
            if let Some(end) = &end {
                let [force, moment] = mechanism.joint_load(end, (&sample.at.q, &sample.mu), sample.t);
                history.forces.push(force);
                if end.turns {
                    history.moments.push(moment);
                }
            }
        })?;
        Ok(history)
    }
}
