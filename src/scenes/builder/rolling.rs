//! Rolling contacts.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::Nonholonomic;
use crate::elements::joints::{DiscOnPlane, RollingDisc, RollingSphere};
use crate::scalar::{Scalar, Vec3};

impl<S: Scalar> MechanismBuilder<S> {
    /// A sphere rolls without sliding on a plane of another body: nodes (plane, sphere), world centre [m], world normal of the plane
    /// towards the sphere, radius [m]. Names and joints: the contact, then the rolling.
    pub fn rolling_sphere(
        &mut self,
        [contact, rolling]: [&str; 2],
        nodes: [NodeId; 2],
        centre: Vec3<S>,
        normal: Vec3<S>,
        radius: S,
    ) -> [ConstraintId; 2] {
        let [a, b] = nodes.map(|node| self.body_anchor(rolling, node));
        let normal = normal.normalized();
        let touching = self.point_in_plane(contact, nodes, centre, normal);
        let [u, w] = normal.perpendiculars();
        let mut p = self.local_point(nodes[1], centre).0.to_vec();
        p.extend([u, w, normal].into_iter().flat_map(|vector| self.local_direction(nodes[0], vector).0));
        p.push(radius);
        [touching, self.add_constraint(rolling, &nodes, Nonholonomic(RollingSphere { a, b }).into(), &p)]
    }

    /// A thin disc rolls on its edge without sliding on a plane of another body: nodes (plane, disc), world centre [m] and axis of the
    /// disc, world point [m] and normal of the plane, radius [m]. Names and joints: the contact, then the rolling.
    pub fn rolling_disc(
        &mut self,
        [contact, rolling]: [&str; 2],
        nodes: [NodeId; 2],
        (centre, axis): (Vec3<S>, Vec3<S>),
        (point, normal): (Vec3<S>, Vec3<S>),
        radius: S,
    ) -> [ConstraintId; 2] {
        let [plane, disc] = nodes;
        let [a, b] = nodes.map(|node| self.body_anchor(rolling, node));
        let normal = normal.normalized();
        let [u, w] = normal.perpendiculars();
        let mut p = self.local_point(disc, centre).0.to_vec();
        p.extend(self.local_direction(disc, axis.normalized()).0);
        p.extend(self.local_direction(plane, normal).0);
        p.push(radius);
        let touching = [&p[..], &self.local_point(plane, point).0].concat();
        p.extend([u, w].into_iter().flat_map(|vector| self.local_direction(plane, vector).0));
        [
            self.add_constraint(contact, &nodes, DiscOnPlane { a, b }.into(), &touching),
            self.add_constraint(rolling, &nodes, Nonholonomic(RollingDisc { a, b }).into(), &p),
        ]
    }
}
