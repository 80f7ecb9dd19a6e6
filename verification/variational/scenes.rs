//! Mechanisms whose moment of momentum about the vertical is a constant of motion.

use costate::elements::flexible::{CableSection, Material, Shape};
use costate::internals::Model;
use costate::prelude::*;
use costate::scenes::CableLine;

/// What swings about the vertical.
pub enum Swinging {
    /// A point mass on a massless rod: a spherical pendulum.
    Mass,
    /// A cable on a spherical joint.
    Cable {
        /// Number of elements.
        elements: usize,
    },
}

impl Scene for Swinging {
    fn name(&self) -> String {
        match self {
            Swinging::Mass => "spherical-pendulum".into(),
            Swinging::Cable { .. } => "swinging-cable".into(),
        }
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 1000)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let vector = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let ground = m.ground();
        match *self {
            Swinging::Mass => {
                let place = vector([0.8, -0.6, 0.0]);
                let mass = m.point("mass", place);
                m.point_mass("mass", mass, S::one());
                m.set_velocity(mass, vector([0.0, 0.0, 1.5]), Vector3::zeros());
                m.distance("rod", [ground, mass], [Vector3::zeros(), place]);
            }
            Swinging::Cable { elements } => {
                let s = |x: f64| S::from(x);
                let material = Material { young: s(1e6), poisson: s(0.3), density: s(1000.0) };
                let section = CableSection::of(material, Shape::rectangle(s(0.05), s(0.05), s(0.3)));
                let ends = [Vector3::zeros(), vector([0.28, -0.96, 0.0])];
                let cable = m.cable("cable", CableLine::straight(ends, elements), &section);
                m.spherical("hinge", [ground, cable.start()], Vector3::zeros());
                m.set_rigid_motion(&cable.nodes, Vector3::zeros(), Vector3::zeros(), vector([0.0, 1.0, 0.0]));
            }
        }
        m.gravity(vector([0.0, -9.81, 0.0]));
        Ok(())
    }
}

/// Moment of momentum about the origin in world components: turning the mechanism about u changes each vector r of it by u x r.
pub fn moment_of_momentum(model: &Model, q: &[f64], p: &[f64]) -> [f64; 3] {
    let mut moment = Vector3::zeros();
    for node in model.nodes.iter().filter(|node| !node.fixed) {
        let (q, p) = (&q[node.dofs.clone()], &p[node.dofs.clone()]);
        let vectors = if node.kind == NodeKind::Body { 3 } else { q.len() };
        for (r, p) in q[..vectors].chunks_exact(3).zip(p.chunks_exact(3)) {
            moment += Vector3::first_three(r).cross(&Vector3::first_three(p));
        }
        if node.kind == NodeKind::Body {
            let e = Quaternion::from_slice(&q[3..]);
            for axis in 0..3 {
                let mut turn = Quaternion([0.0; 4]);
                turn.0[1 + axis] = 0.5;
                moment[axis] += turn.times(e).0.iter().zip(&p[3..]).map(|(e, p)| e * p).sum::<f64>();
            }
        }
    }
    moment.components()
}
