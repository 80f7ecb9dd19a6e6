//! Springs, dampers and loads.

use super::MechanismBuilder;
use crate::assembly::{ElementId, NodeId};
use crate::elements::forces::{Gravity, LineDamper, LineSpring, TorsionSpringDamper, VectorDamper};
use crate::scalar::{Scalar, Vec3};

impl<S: Scalar> MechanismBuilder<S> {
    /// Weight for every mass added so far: g [m/s2].
    pub fn gravity(&mut self, gravity: Vec3<S>) {
        for (node, mass, centre) in std::mem::take(&mut self.masses) {
            let name = format!("weight of {}", self.model.nodes[node.0].name);
            let on = self.anchor(&name, node);
            let p: Vec<S> = [mass].into_iter().chain(gravity.0).chain(centre.0).collect();
            self.add_element(&name, &[node], Gravity { on }.into(), &p);
        }
    }

    /// A spring along the line between world points of two nodes: stiffness [N/m], rest length [m].
    pub fn line_spring(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        ends: [Vec3<S>; 2],
        stiffness: S,
        rest_length: S,
    ) -> ElementId {
        let [a, b] = nodes.map(|node| self.anchor(name, node));
        let p = [vec![stiffness, rest_length], self.points_between(nodes, ends)].concat();
        self.add_element(name, &nodes, LineSpring { a, b }.into(), &p)
    }

    /// A damper along the line between world points of two nodes [N s/m].
    pub fn line_damper(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vec3<S>; 2], damping: S) -> ElementId {
        let [a, b] = nodes.map(|node| self.anchor(name, node));
        let p = [vec![damping], self.points_between(nodes, ends)].concat();
        self.add_element(name, &nodes, LineDamper { a, b }.into(), &p)
    }

    /// A damper on the whole relative velocity of world points of two nodes [N s/m].
    pub fn vector_damper(&mut self, name: &str, nodes: [NodeId; 2], ends: [Vec3<S>; 2], damping: S) -> ElementId {
        let [a, b] = nodes.map(|node| self.anchor(name, node));
        let p = [vec![damping], self.points_between(nodes, ends)].concat();
        self.add_element(name, &nodes, VectorDamper { a, b }.into(), &p)
    }

    /// Axis and reference directions of an angle between two bodies that is zero at the start.
    pub(super) fn angle_frame(&mut self, name: &str, [a, b]: [NodeId; 2], axis: Vec3<S>) -> Vec<S> {
        let axis = self.unit(name, axis);
        let [reference, _] = axis.perpendiculars();
        [self.local_direction(a, axis), self.local_direction(a, reference), self.local_direction(b, reference)]
            .into_iter()
            .flat_map(|vector| vector.0)
            .collect()
    }

    /// A torsion spring and damper about a world axis [N m/rad], [N m s/rad]; the angle is zero at the start.
    pub fn torsion_spring_damper(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        axis: Vec3<S>,
        [stiffness, damping, rest_angle]: [S; 3],
    ) -> ElementId {
        self.check_bodies(name, &nodes);
        let p = [vec![stiffness, damping, rest_angle], self.angle_frame(name, nodes, axis)].concat();
        self.add_element(name, &nodes, TorsionSpringDamper.into(), &p)
    }
}
