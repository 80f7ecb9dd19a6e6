//! Elements as an equilibrium and small motions about it see them: in a frame that turns steadily with some of their nodes, and with states of
//! first order as unknowns like coordinates.
//!
//! With the coordinates x of such a node in the frame, those in the world are q = x at the time looked at, and change with the turn W(x) of the
//! node ([`NodeKind::turn`]), whose linear part is W':
//!
//! ```text
//! v = x' + W(x)        a = x'' + W' (x' + v)
//! ```
//!
//! Residuals in x are those in the world with these rates: centrifugal and Coriolis forces follow. An element that turns as a whole does not
//! change with time in the frame, but for its weight, of which the mean over a turn counts: the part along the axis.
//!
//! A state z is a coordinate there: R = z' - f(z, ..) with z in q is -f in an equilibrium. Small motions have z' in v, so that (lambda^2 M + lambda C + K)
//! has one value for each state, with C = 1 and no inertia. A search for the equilibrium has it in a instead: what follows the energy downhill with
//! mass instead of time lets states follow their rates. A state that stays keeps the equation z - z_0 = 0 in the search (z_0 in v), and z'' = 0 in
//! small motions.

use super::dyn_layer::{ElementFormula, ElementPhysics, Recording, dofs_of_each};
use super::{NodeKind, Parameter};
use crate::program::ArgumentKind::{Coordinate, Parameter as OfPart};
use crate::program::{Codes, Formula, ProgramWork, Recorded, continued};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::sync::Arc;

/// Numbers of a spin: a point of the axis, its direction, and the rate of the turn.
pub(crate) const SPIN_PARAMETERS: usize = 7;

fn spin_parameters() -> Vec<Parameter> {
    let (point, axis) = (Parameter::vectors(&["point of the axis,"], "m"), Parameter::vectors(&["axis,"], "-"));
    [point, axis, vec![Parameter::new("rate", "rad/s")]].concat()
}

/// What the names of three parameters end with that are the acceleration by weight.
const GRAVITY: [&str; 3] = ["gravity x", "gravity y", "gravity z"];

/// The velocities of a node that turns with the frame, into `v`: [`NodeKind::turn`] with the numbers of a spin.
pub(crate) fn turn<S: Scalar>(kind: NodeKind, q: &[S], spin: &[S], v: &mut [S]) {
    kind.turn(q, Vector3::first_three(spin), Vector3::first_three(&spin[3..]) * spin[6], v);
}

/// Gradient of lambda . v of these velocities towards q, then towards the numbers of the spin.
pub(crate) fn turn_gradient(kind: NodeKind, q: &[f64], spin: &[f64], lambda: &[f64]) -> Vec<f64> {
    let n = kind.dofs();
    let recorded = Formula::record([(Coordinate, n), (OfPart, spin.len())], |x| {
        let mut v = vec![Recorded::from(0.0); n];
        turn(kind, &x[..n], &x[n..], &mut v);
        v
    });
    let formula = recorded.unwrap_or_else(|why| unreachable!("a turn does not branch: {why}"));
    let count = n + spin.len();
    let program = formula
        .dense_program(("reaction", Codes::new()), n, |graph, x, outputs| graph.reverse(outputs, &x[count..], &x[..count]));
    let mut gradient = vec![0.0; count];
    program.run(&[q, spin, lambda].concat(), &mut gradient, &mut ProgramWork::default());
    gradient
}

/// Where the rate of a state stands whose value stands in q.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum OfStates {
    /// In a, in a search for an equilibrium.
    InAcceleration,
    /// In v, in small motions about one.
    InVelocity,
}

/// An element at rest; the numbers of a spin are parameters behind its own where one of its nodes turns.
#[derive(Clone, Hash)]
pub(crate) struct AtRest {
    pub(super) own: ElementPhysics,
    /// Nodes that turn.
    turns: Vec<bool>,
    /// Where rates of states stand; `None` where states are what they are in motion.
    states: Option<OfStates>,
    /// Its coordinates that are states which stay as they are.
    stays: Vec<bool>,
}

impl AtRest {
    /// An element, of whose nodes some turn, and of whose states some stay.
    pub fn new(own: &ElementPhysics, turns: Vec<bool>, states: Option<OfStates>, stays: Vec<bool>) -> Self {
        let states = states.filter(|_| own.node_kinds().iter().any(|kind| kind.is_of_states()));
        AtRest { own: own.clone(), turns, states, stays }
    }

    /// Whether anything is other than in motion.
    pub fn differs(&self) -> bool {
        self.states.is_some() || self.turns()
    }

    /// Whether it has the numbers of a spin.
    pub fn turns(&self) -> bool {
        self.turns.contains(&true)
    }

    /// Whether it is another one.
    pub fn is_same(&self, other: &Self) -> bool {
        let alike = (&self.turns, self.states, &self.stays) == (&other.turns, other.states, &other.stays);
        alike && self.own.is_same(&other.own)
    }

    /// As an element.
    pub fn physics(self) -> ElementPhysics {
        let further = if self.turns() { spin_parameters() } else { Vec::new() };
        ElementPhysics::at_rest(self, further)
    }

    fn added(&self) -> usize {
        if self.turns() { SPIN_PARAMETERS } else { 0 }
    }

    /// A formula with parameters of a spin that are not read.
    fn as_it_is(&self, formula: &Formula) -> Recording {
        formula.with_parameters(self.added(), |x, _| x.to_vec())
    }

    /// A formula of (a, v, q) and others as it is in motion, of the arguments at rest.
    fn in_motion(&self, formula: &Formula) -> Recording {
        formula.with_parameters(self.added(), |x, spin| {
            let mut all = if spin.is_empty() { x.to_vec() } else { self.in_world(x, spin) };
            if let Some(states) = self.states {
                let kinds = self.own.node_kinds();
                for dof in dofs_of_each(&kinds).filter(|(kind, _)| kind.is_of_states()).flat_map(|(_, dofs)| dofs) {
                    states.in_motion(&mut all, self.own.dof_count(), dof);
                }
            }
            all
        })
    }

    /// Accelerations and velocities in the world, in place of those in the frame, which stand with the coordinates before parameters and other
    /// arguments.
    fn in_world(&self, arguments: &[Recorded], spin: &[Recorded]) -> Vec<Recorded> {
        let (mut all, n) = (arguments.to_vec(), self.own.dof_count());
        let [about, axis] = [&spin[..3], &spin[3..]].map(Vector3::first_three);
        let omega = axis * spin[6];
        let list = self.own.parameter_list();
        let is_gravity = |own: &[Parameter]| own.iter().zip(GRAVITY).all(|(own, name)| own.name.ends_with(name));
        for (first, _) in list.windows(GRAVITY.len()).enumerate().filter(|(_, own)| is_gravity(own)) {
            let gravity = &mut all[3 * n + first..][..3];
            let along = axis * axis.dot(&Vector3::first_three(gravity));
            gravity.copy_from_slice(&along.components());
        }
        for ((kind, places), _) in dofs_of_each(&self.own.node_kinds()).zip(&self.turns).filter(|(_, turns)| **turns) {
            let carried = |q: &[Recorded], about: Vector3<Recorded>| {
                let mut v = vec![Recorded::from(0.0); q.len()];
                kind.turn(q, about, omega, &mut v);
                v
            };
            let of_places = carried(&arguments[2 * n..][places.clone()], about);
            let mut both = arguments[n..][places.clone()].to_vec();
            for ((v, both), of_place) in all[n..][places.clone()].iter_mut().zip(&mut both).zip(of_places) {
                *v += of_place;
                *both += *v;
            }
            let of_rates = carried(&both, Vector3::zeros());
            all[places].iter_mut().zip(of_rates).for_each(|(a, of_rate)| *a += of_rate);
        }
        all
    }
}

impl OfStates {
    /// Puts the number of a state where it stands in motion, among `n` accelerations, velocities and coordinates.
    pub fn in_motion(self, all: &mut [Recorded], n: usize, dof: usize) {
        let [a, v, q] = [dof, n + dof, 2 * n + dof];
        if self == OfStates::InVelocity {
            all[a] = all[v];
        }
        all[v] = all[q];
        all[q] = Recorded::from(0.0);
    }
}

impl AtRest {
    /// A formula as it is there; it has no outputs.
    pub(super) fn record(&self, what: ElementFormula) -> Recording {
        let in_motion = || self.own.recorded(what).as_ref().map_err(String::clone);
        match what {
            ElementFormula::Residual => self.staying(self.in_motion(in_motion()?)?),
            ElementFormula::Power => self.in_motion(in_motion()?),
            ElementFormula::Outputs | ElementFormula::Stresses => Err("it tells nothing".into()),
            _ => self.as_it_is(in_motion()?),
        }
    }

    /// A residual with the equations of states that stay.
    fn staying(&self, residual: Arc<Formula>) -> Recording {
        if !self.stays.contains(&true) {
            return Ok(residual);
        }
        let n = self.own.dof_count();
        Ok(residual.derived(|graph, x, outputs| {
            let mut all = outputs.to_vec();
            for (dof, row) in all.iter_mut().enumerate().filter(|(dof, _)| self.stays[*dof]) {
                *row = match self.states {
                    Some(OfStates::InVelocity) => x[dof],
                    _ => continued(graph, &[x[2 * n + dof], x[n + dof]], |z| vec![z[0] - z[1]])[0],
                };
            }
            all
        }))
    }
}
