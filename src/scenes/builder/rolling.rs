//! Rolling contacts.

use super::MechanismBuilder;
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::entries::Values;
use crate::elements::joints::contact_and_rolling;
use crate::scalar::{Scalar, Vector3};

impl<S: Scalar> MechanismBuilder<S> {
    /// What rolls, by its form: the contact, then the rolling.
    pub(in crate::scenes) fn rolls(
        &mut self,
        form: &str,
        names: [&str; 2],
        nodes: [NodeId; 2],
        values: Values<S>,
    ) -> [ConstraintId; 2] {
        let refused = [self.model.refused_constraint(); 2];
        if nodes.iter().any(|&node| self.kind_of(names[1], node).is_none()) {
            return refused;
        }
        let mut given = self.given(names[1], &nodes, values);
        let made = contact_and_rolling(form, &mut given);
        let wrong = given.mistakes();
        if !wrong.is_empty() {
            self.keep_mistakes(names[1], wrong);
            return refused;
        }
        let mut names = names.into_iter();
        let [contact, rolling] = made.map(|(law, p)| self.add_constraint(names.next().unwrap_or_default(), &nodes, law, &p));
        self.companions.insert(rolling, contact);
        [contact, rolling]
    }

    /// A sphere rolls without sliding on a plane of another body: nodes (plane, sphere), world centre \[m\], world normal of the plane
    /// towards the sphere, radius \[m\]. Names and joints: the contact, then the rolling.
    pub fn rolling_sphere(
        &mut self,
        names: [&str; 2],
        nodes: [NodeId; 2],
        centre: Vector3<S>,
        normal: Vector3<S>,
        radius: S,
    ) -> [ConstraintId; 2] {
        let keys = vec![("centre", centre.into()), ("normal", normal.into()), ("radius", radius.into())];
        self.rolls("rolling_sphere", names, nodes, keys)
    }

    /// A thin disc rolls on its edge without sliding on a plane of another body: nodes (plane, disc), world centre \[m\] and axis of the
    /// disc, world point \[m\] and normal of the plane, radius \[m\]. Names and joints: the contact, then the rolling.
    pub fn rolling_disc(
        &mut self,
        names: [&str; 2],
        nodes: [NodeId; 2],
        (centre, axis): (Vector3<S>, Vector3<S>),
        (point, normal): (Vector3<S>, Vector3<S>),
        radius: S,
    ) -> [ConstraintId; 2] {
        let geometry = [("centre", centre), ("axis", axis), ("point", point), ("normal", normal)];
        let keys = geometry.map(|(key, own)| (key, own.into())).into_iter().chain([("radius", radius.into())]).collect();
        self.rolls("rolling_disc", names, nodes, keys)
    }
}
