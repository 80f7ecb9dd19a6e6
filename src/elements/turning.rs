//! Elements in a frame that turns steadily with some of their nodes.
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

use super::dyn_layer::{AnyElement, ElementPhysics, Recording, StressFormulas};
use super::{NodeKind, Parameter};
use crate::program::ArgumentKind::{Coordinate, Parameter as OfPart};
use crate::program::{Codes, Formula, ProgramKind, ProgramWork, Recorded};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::any::Any;
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
    let program = formula.dense_program((ProgramKind::Reaction, Codes::new()), n, |graph, x, outputs| {
        graph.reverse(outputs, &x[count..], &x[..count])
    });
    let mut gradient = vec![0.0; count];
    program.run(&[q, spin, lambda].concat(), &mut gradient, &mut ProgramWork::default());
    gradient
}

/// An element of whose nodes some turn with the frame; the numbers of the spin are parameters behind its own.
pub(crate) struct InTurningFrame {
    own: ElementPhysics,
    turns: Vec<bool>,
}

impl InTurningFrame {
    /// An element, of whose nodes those turn that are marked.
    pub fn physics(own: &ElementPhysics, turns: &[bool]) -> ElementPhysics {
        ElementPhysics::new(Box::new(InTurningFrame { own: own.clone(), turns: turns.to_vec() }))
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
        let mut first = 0;
        for (kind, &turns) in self.own.node_kinds().into_iter().zip(&self.turns) {
            let places = first..first + kind.dofs();
            first = places.end;
            let carried = |q: &[Recorded], about: Vector3<Recorded>| {
                let mut v = vec![Recorded::from(0.0); q.len()];
                kind.turn(q, about, omega, &mut v);
                v
            };
            if !turns {
                continue;
            }
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

/// With parameters that are not read.
fn as_it_is(formula: &Formula) -> Recording {
    formula.with_parameters(SPIN_PARAMETERS, |x, _| x.to_vec())
}

impl AnyElement for InTurningFrame {
    fn as_any(&self) -> &dyn Any {
        self
    }
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.own.node_kinds()
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        [self.own.parameter_list(), spin_parameters()].concat()
    }
    fn record_residual(&self) -> Recording {
        self.own.residual().with_parameters(SPIN_PARAMETERS, |x, spin| self.in_world(x, spin))
    }
    fn record_impulse(&self) -> Recording {
        as_it_is(self.own.impulse())
    }
    fn record_energies(&self) -> Recording {
        as_it_is(self.own.energies())
    }
    fn record_power(&self) -> Recording {
        as_it_is(self.own.power())
    }
    fn record_inertia_moment(&self) -> Recording {
        as_it_is(self.own.inertia_moment())
    }
    fn has_energies(&self) -> bool {
        false
    }
    fn is_conservative(&self) -> bool {
        self.own.is_conservative()
    }
    fn has_strains(&self) -> bool {
        self.own.has_strains()
    }
    fn record_stresses(&self) -> Option<Result<StressFormulas, String>> {
        let StressFormulas { count, course, deviation, force } = self.own.stresses()?;
        let all = [course, deviation, force].map(|formula: &Arc<Formula>| as_it_is(formula));
        let [course, deviation, force] = all;
        let together = || Ok(StressFormulas { count: *count, course: course?, deviation: deviation?, force: force? });
        Some(together())
    }
}
