//! Springs, dampers and loads.

use super::MechanismBuilder;
use super::entries::{entry, methods_by_entry};
use crate::assembly::{ElementId, NodeId};
use crate::elements::entries::{GivenValue, SpringPart, Values};
use crate::elements::forces::{DAMPERS, LOADS, LoadFrame, SPRINGS};
use crate::scalar::{Quaternion, Scalar, Vector3};
use crate::scenes::Signal;

/// A force F = d f(t) \[N\] on a point of a node.
#[derive(Clone, Debug)]
pub struct Force<S> {
    /// A body or a point.
    pub on: NodeId,
    /// World point at the start on which it acts \[m\]; a node without axes takes it where it is.
    pub point: Vector3<S>,
    /// World direction d at the start, of any length, by which f is multiplied.
    pub direction: Vector3<S>,
    /// Whether the direction stays in the world or turns with the body.
    pub frame: LoadFrame,
    /// f \[N\] for a direction of unit length.
    pub size: Signal<S>,
}

/// A torque M = d f(t) [N m] on a body.
#[derive(Clone, Debug)]
pub struct Torque<S> {
    /// The body.
    pub on: NodeId,
    /// World axis d at the start, of any length, by which f is multiplied.
    pub axis: Vector3<S>,
    /// Whether the axis stays in the world or turns with the body.
    pub frame: LoadFrame,
    /// f [N m] for an axis of unit length.
    pub size: Signal<S>,
}

/// A spring with a damper beside it: stiffness (x - rest) + damping dx/dt, x being an angle \[rad\] or a displacement \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDamper<S> {
    /// [N m/rad] or [N/m], 0 or greater.
    pub stiffness: S,
    /// [N m s/rad] or [N s/m], 0 or greater.
    pub damping: S,
    /// Where the spring is free \[rad\] or \[m\].
    pub rest: S,
}

/// Springs and dampers of a bushing along and about the axes x, y, z of its frame, 0 or greater.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BushingRates<S> {
    /// [N/m].
    pub stiffness_along: [S; 3],
    /// [N m/rad].
    pub stiffness_about: [S; 3],
    /// [N s/m].
    pub damping_along: [S; 3],
    /// [N m s/rad].
    pub damping_about: [S; 3],
}

impl<S: Scalar> MechanismBuilder<S> {
    /// Adds a load by its entry to nodes, or to those of each element of a member, with names.
    pub(in crate::scenes) fn load(&mut self, part: &SpringPart, on: &[(String, Vec<NodeId>)], values: &Values<S>) {
        for (name, nodes) in on {
            // what is wrong with one is so with all
            if self.spring(part, name, nodes, values.clone()) == self.model.refused_element() {
                break;
            }
        }
    }

    /// Values of the keys that all loads have.
    pub(super) fn load_keys(&mut self, name: &str, frame: LoadFrame, size: Signal<S>) -> [(&'static str, GivenValue<S>); 2] {
        [("frame", GivenValue::Word(frame.word().into())), ("size", self.function_value(name, size))]
    }

    /// A force on a body or a point.
    pub fn force(&mut self, name: &str, Force { on, point, direction, frame, size }: Force<S>) -> ElementId {
        let mut keys = self.load_keys(name, frame, size).to_vec();
        keys.push(("direction", direction.into()));
        keys.extend(self.kind_of(name, on).filter(|kind| kind.has_axes()).map(|_| ("point", point.into())));
        self.spring(entry(LOADS, "force"), name, &[on], keys)
    }

    /// A torque on a body.
    pub fn torque(&mut self, name: &str, Torque { on, axis, frame, size }: Torque<S>) -> ElementId {
        let keys = [&[("axis", axis.into())], &self.load_keys(name, frame, size)[..]].concat();
        self.spring(entry(LOADS, "torque"), name, &[on], keys)
    }

    /// A spring and damper on one coordinate of a node, such as a joint angle.
    pub fn coordinate_spring_damper(&mut self, name: &str, node: NodeId, index: usize, own: SpringDamper<S>) -> ElementId {
        let SpringDamper { stiffness, damping, rest } = own;
        let numbers = [("stiffness", stiffness), ("damping", damping), ("rest_angle", rest)];
        let mut keys = vec![("index", GivenValue::Count(index))];
        keys.extend(numbers.map(|(key, number)| (key, number.into())));
        self.spring(entry(SPRINGS, "angle"), name, &[node], keys)
    }

    /// A bushing at a world point \[m\], at rest as the bodies stand, with the frame `axes` in the world.
    pub fn bushing(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        point: Vector3<S>,
        axes: Quaternion<S>,
        rates: BushingRates<S>,
    ) -> ElementId {
        let BushingRates { stiffness_along, stiffness_about, damping_along, damping_about } = rates;
        let [stiffness, damping] = [[stiffness_along, stiffness_about], [damping_along, damping_about]]
            .map(|own| GivenValue::Numbers(own.concat()));
        let frame = [("point", point.into()), ("orientation", GivenValue::Rotation(axes))];
        let keys = [&frame[..], &[("stiffness", stiffness), ("damping", damping)]].concat();
        self.spring(entry(SPRINGS, "bushing"), name, &nodes, keys)
    }
}

methods_by_entry! { SPRINGS.spring -> ElementId;
    /// A spring along the line between world points of two nodes: stiffness [N/m], rest length \[m\].
    line_spring "line" (nodes: [NodeId; 2], points: [Vector3<S>; 2], stiffness: S, rest_length: S)
        on &nodes => points, stiffness, rest_length;
    /// A torsion spring and damper about a world axis; the angle is zero at the start.
    torsion_spring_damper "torsion"
        (nodes: [NodeId; 2], axis: Vector3<S>, (SpringDamper { stiffness, damping, rest: rest_angle }): SpringDamper<S>)
        on &nodes => axis, stiffness, damping, rest_angle;
    /// A spring and damper along a world axis fixed in a, on the displacement of the world point of b from `origin`.
    slide_spring_damper "slide" (
        nodes: [NodeId; 2],
        [origin, point]: [Vector3<S>; 2],
        axis: Vector3<S>,
        (SpringDamper { stiffness, damping, rest: rest_displacement }): SpringDamper<S>
    ) on &nodes => origin, point, axis, stiffness, damping, rest_displacement;
}

methods_by_entry! { DAMPERS.spring -> ElementId;
    /// A damper along the line between world points of two nodes [N s/m].
    line_damper "line" (nodes: [NodeId; 2], points: [Vector3<S>; 2], damping: S) on &nodes => points, damping;
    /// A damper on the whole relative velocity of world points of two nodes [N s/m].
    vector_damper "vector" (nodes: [NodeId; 2], points: [Vector3<S>; 2], damping: S) on &nodes => points, damping;
}
