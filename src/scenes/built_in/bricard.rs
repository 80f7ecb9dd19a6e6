use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// Bricard's mechanism (IFToMM benchmark A04): five uniform rods along the edges of a cube, six hinges, let go from rest.
///
/// A loop of six hinges would not move at all were their axes not placed as they are: of 30 equations one is redundant.
///
/// Source: IFToMM library of computational benchmark problems, A04; rods of 1 m with a square section of 0.1 m.
pub struct Bricard;

impl Scene for Bricard {
    fn name(&self) -> String {
        "bricard".into()
    }
    fn summary(&self) -> String {
        "Bricard's mechanism: a loop of six hinges that moves although it should not (IFToMM A04)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("length", 1.0, (0.2, 5.0), "m"),
            DesignVariable::new("section", 0.1, (0.01, 0.3), "m"),
            DesignVariable::new("mass", 1.0, (0.1, 20.0), "kg"),
            DesignVariable::new("gravity", 9.81, (0.1, 20.0), "m/s2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(10.0, 2000).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [length, section, mass, gravity] = x else {
            return Err(format!("4 variables expected, {} given", x.len()));
        };
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let [x, y, z] = axes;
        let corners =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0], [1.0, -1.0, 1.0], [0.0, -1.0, 1.0], [0.0, 0.0, 1.0]]
                .map(|corner| Vector3::<S>::from_f64(corner) * *length);
        let ground = m.ground();
        let mut before = ground;
        for (rod, axis) in [y, z, x, y, z].into_iter().enumerate() {
            let (from, to) = (corners[rod], corners[rod + 1]);
            let name = format!("rod {}", rod + 1);
            let node = m.body(&name, (from + to) * S::from(0.5), Quaternion::x_axis_to((to - from).unit()));
            let (axial, lateral) = (*section * *section / 6.0, (*length * *length + *section * *section) / 12.0);
            let zero = S::zero();
            m.rigid_body(
                &name,
                node,
                *mass,
                Vector3::zeros(),
                [*mass * axial, *mass * lateral, *mass * lateral, zero, zero, zero],
            );
            m.revolute(&format!("hinge {}", rod + 1), [before, node], from, axis);
            m.draw(node, &[from, to]);
            before = node;
        }
        m.revolute("hinge 6", [before, ground], corners[5], x);
        m.gravity(y * -*gravity);
        m.draw(ground, &[corners[0], corners[5]]);

        m.position_functional("z of the corner of rods 4 and 5 at the end", Over::Terminal, before, corners[4], z);
        m.position_functional("height of the corner of rods 4 and 5, integral", Over::Integral, before, corners[4], y);
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}
