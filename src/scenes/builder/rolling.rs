//! Rolling contacts.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::Nonholonomic;
use crate::elements::joints::{DiscOnPlane, RollingDisc, RollingSphere};
use crate::scalar::{Scalar, SpatialVector, Vector3};

impl<S: Scalar> MechanismBuilder<S> {
    /// A sphere rolls without sliding on a plane of another body: nodes (plane, sphere), world centre \[m\], world normal of the plane
    /// towards the sphere, radius \[m\]. Names and joints: the contact, then the rolling.
    pub fn rolling_sphere(
        &mut self,
        [contact, rolling]: [&str; 2],
        nodes: [NodeId; 2],
        centre: Vector3<S>,
        normal: Vector3<S>,
        radius: S,
    ) -> [ConstraintId; 2] {
        let [a, b] = nodes.map(|node| self.kind_of_body(rolling, node));
        let normal = normal.unit();
        let touching = self.point_in_plane(contact, nodes, centre, normal);
        let [u, w] = normal.perpendiculars();
        let mut p = self.local_point(nodes[1], centre).components().to_vec();
        p.extend([u, w, normal].into_iter().flat_map(|vector| self.local_direction(nodes[0], vector).components()));
        p.push(radius);
        [touching, self.add_constraint(rolling, &nodes, Nonholonomic(RollingSphere { a, b }).into(), &p)]
    }

    /// A thin disc rolls on its edge without sliding on a plane of another body: nodes (plane, disc), world centre \[m\] and axis of the
    /// disc, world point \[m\] and normal of the plane, radius \[m\]. Names and joints: the contact, then the rolling.
    pub fn rolling_disc(
        &mut self,
        [contact, rolling]: [&str; 2],
        nodes: [NodeId; 2],
        (centre, axis): (Vector3<S>, Vector3<S>),
        (point, normal): (Vector3<S>, Vector3<S>),
        radius: S,
    ) -> [ConstraintId; 2] {
        let [plane, disc] = nodes;
        let [a, b] = nodes.map(|node| self.kind_of_body(rolling, node));
        let normal = normal.unit();
        let [u, w] = normal.perpendiculars();
        let mut p = self.local_point(disc, centre).components().to_vec();
        p.extend(self.local_direction(disc, axis.unit()).components());
        p.extend(self.local_direction(plane, normal).components());
        p.push(radius);
        let touching = [&p[..], &self.local_point(plane, point).components()].concat();
        p.extend([u, w].into_iter().flat_map(|vector| self.local_direction(plane, vector).components()));
        [
            self.add_constraint(contact, &nodes, DiscOnPlane { a, b }.into(), &touching),
            self.add_constraint(rolling, &nodes, Nonholonomic(RollingDisc { a, b }).into(), &p),
        ]
    }
}
