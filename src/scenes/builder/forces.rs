//! Springs, dampers and loads.

use super::MechanismBuilder;
use crate::assembly::{ElementId, NodeId};
use crate::elements::TimeFunction;
use crate::elements::forces::{
    AppliedForce, AppliedTorque, Bushing, CoordinateSpringDamper, Gravity, LineDamper, LineSpring, LoadFrame,
    SlideSpringDamper, TorsionSpringDamper, VectorDamper,
};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
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
    /// Weight of every mass, beam, cable and shell, whether added before or after: g [m/s2]. Several calls add up.
    pub fn gravity(&mut self, gravity: Vector3<S>) {
        self.add_weights(gravity, [0; 4]);
        let weighed = [self.masses.len(), self.heavy_beams.len(), self.heavy_cables.len(), self.heavy_shells.len()];
        self.gravities.push((gravity, weighed));
    }

    /// Weight of all masses and elements of beams, cables and shells but the first ones.
    pub(super) fn add_weights(&mut self, gravity: Vector3<S>, [masses, beams, cables, shells]: [usize; 4]) {
        for place in masses..self.masses.len() {
            let (node, mass, centre) = self.masses[place];
            let name = format!("weight of {}", self.model.nodes[node.0].name);
            let on = self.kind_in_space(&name, node);
            let p: Vec<S> = [mass].into_iter().chain(gravity.components()).chain(centre.components()).collect();
            self.add_element(&name, &[node], Gravity { on }.into(), &p);
        }
        self.beam_gravity(gravity, beams);
        self.cable_gravity(gravity, cables);
        self.shell_gravity(gravity, shells);
    }

    /// A spring along the line between world points of two nodes: stiffness [N/m], rest length \[m\].
    pub fn line_spring(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        ends: [Vector3<S>; 2],
        stiffness: S,
        rest_length: S,
    ) -> ElementId {
        let [a, b] = nodes.map(|node| self.kind_in_space(name, node));
        let p = [vec![stiffness, rest_length], self.points_between(nodes, ends)].concat();
        self.add_element(name, &nodes, LineSpring { a, b }.into(), &p)
    }

    /// A damper along the line between world points of two nodes [N s/m].
    pub fn line_damper(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vector3<S>; 2], damping: S) -> ElementId {
        let [a, b] = nodes.map(|node| self.kind_in_space(name, node));
        let p = [vec![damping], self.points_between(nodes, ends)].concat();
        self.add_element(name, &nodes, LineDamper { a, b }.into(), &p)
    }

    /// A damper on the whole relative velocity of world points of two nodes [N s/m].
    pub fn vector_damper(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vector3<S>; 2], damping: S) -> ElementId {
        let [a, b] = nodes.map(|node| self.kind_in_space(name, node));
        let p = [vec![damping], self.points_between(nodes, ends)].concat();
        self.add_element(name, &nodes, VectorDamper { a, b }.into(), &p)
    }

    /// Axis and reference directions of an angle between two bodies that is zero at the start.
    pub(super) fn angle_frame(&mut self, name: &str, [a, b]: [NodeId; 2], axis: Vector3<S>) -> Vec<S> {
        let axis = self.unit(name, axis);
        let [reference, _] = axis.perpendiculars();
        [self.local_direction(a, axis), self.local_direction(a, reference), self.local_direction(b, reference)]
            .into_iter()
            .flat_map(|vector| vector.components())
            .collect()
    }

    /// The function and the numbers of a signal; what is wrong with it is told with the other mistakes.
    pub(in crate::scenes) fn function_of(&mut self, owner: &str, signal: Signal<S>) -> (TimeFunction, Vec<S>) {
        signal.parts().unwrap_or_else(|why| {
            self.mistakes.push(format!("\"{owner}\": {why}"));
            (TimeFunction::Constant, vec![S::zero()])
        })
    }

    /// A direction of the world at the start in the frame of a load.
    fn in_frame(&self, node: NodeId, frame: LoadFrame, direction: Vector3<S>) -> Vector3<S> {
        if frame == LoadFrame::Body { self.local_direction(node, direction) } else { direction }
    }

    /// A force on a body or a point.
    pub fn force(&mut self, name: &str, Force { on: node, point, direction, frame, size }: Force<S>) -> ElementId {
        let on = self.kind_in_space(name, node);
        let (size, values) = self.function_of(name, size);
        let [direction, point] = [self.in_frame(node, frame, direction), self.local_point(node, point)];
        let p = [&direction.components()[..], &point.components(), &values].concat();
        self.add_element(name, &[node], AppliedForce { on, frame, size }.into(), &p)
    }

    /// A torque on a body.
    pub fn torque(&mut self, name: &str, Torque { on: node, axis, frame, size }: Torque<S>) -> ElementId {
        let on = self.kind_of_body(name, node);
        let (size, values) = self.function_of(name, size);
        let p = [&self.in_frame(node, frame, axis).components()[..], &values].concat();
        self.add_element(name, &[node], AppliedTorque { on, frame, size }.into(), &p)
    }

    /// A torsion spring and damper about a world axis; the angle is zero at the start.
    pub fn torsion_spring_damper(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        axis: Vector3<S>,
        SpringDamper { stiffness, damping, rest }: SpringDamper<S>,
    ) -> ElementId {
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let p = [vec![stiffness, damping, rest], self.angle_frame(name, nodes, axis)].concat();
        self.add_element(name, &nodes, TorsionSpringDamper { a, b }.into(), &p)
    }

    /// A spring and damper along a world axis fixed in a, on the displacement of the world point of b from `origin`.
    pub fn slide_spring_damper(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        [origin, point]: [Vector3<S>; 2],
        axis: Vector3<S>,
        SpringDamper { stiffness, damping, rest }: SpringDamper<S>,
    ) -> ElementId {
        let [a, b] = [self.kind_of_body(name, nodes[0]), self.kind_in_space(name, nodes[1])];
        let axis = self.unit(name, axis);
        let axis = self.local_direction(nodes[0], axis).components();
        let p = [&[stiffness, damping, rest][..], &self.points_between(nodes, [origin, point]), &axis].concat();
        self.add_element(name, &nodes, SlideSpringDamper { a, b }.into(), &p)
    }

    /// A spring and damper on one coordinate of a node, such as a joint angle.
    pub fn coordinate_spring_damper(
        &mut self,
        name: &str,
        node: NodeId,
        index: usize,
        SpringDamper { stiffness, damping, rest }: SpringDamper<S>,
    ) -> ElementId {
        let Some(of) = self.kind_of(name, node) else { return self.model.refused_element() };
        let count = of.dofs();
        if index >= count {
            let own = &self.model.nodes[node.0].name;
            self.mistakes
                .push(format!("\"{name}\" asks for coordinate {index} of \"{own}\", which has {count}: count from 0"));
            return self.model.refused_element();
        }
        self.add_element(name, &[node], CoordinateSpringDamper { of, index }.into(), &[stiffness, damping, rest])
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
        let [a, b] = nodes.map(|node| self.kind_of_body(name, node));
        let [on_a, on_b] = nodes.map(|node| self.rotation(node).conjugate().times(axes).0);
        let BushingRates { stiffness_along, stiffness_about, damping_along, damping_about } = rates;
        let rates = [stiffness_along, stiffness_about, damping_along, damping_about].concat();
        let p = [&rates[..], &self.points_between(nodes, [point; 2]), &on_a, &on_b].concat();
        self.add_element(name, &nodes, Bushing { a, b }.into(), &p)
    }
}
