use crate::design::DesignVariable;
use crate::elements::flexible::Shape;
use crate::elements::flexible::{CableSection, Material};
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{CableLine, Limit, MechanismBuilder, OptimizationProblem, Scene, Settings};

/// A rigid bar A B in natural coordinates and a beam C D of one element, both on spherical joints to the ground at A and D, with a spring
/// from B to C.
///
/// Bar of 1.6 kg and 10 mm diameter; beam of 70 GPa, 3700 kg/m3 and 10 mm square; spring of 100 N/m, at rest at the start; weight along
/// -y. The beam turns about D with -5 rad/s about z. The source draws its points without numbers: here A (0, 0), B (0.5, 0), C (0.8, 0.2),
/// D (1.4, 0.2) m. Variables are the place of D, as there, stiffness and mass; the problem is to find the place of D in the plane.
///
/// Source: Ebrahimi et al., sections 5.5 and 6.2.
pub struct RigidSpringBeam;

const OBJECTIVE: &str = "displacement of B, squared, integral";
const LENGTH: &str = "length of the beam";

/// Diameter of the bar and width of the beam \[m\].
const WIDTH: f64 = 0.01;

impl Scene for RigidSpringBeam {
    fn name(&self) -> String {
        "rigid-spring-beam".into()
    }
    fn summary(&self) -> String {
        "rigid bar in natural coordinates, spring, and turning cable-beam".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("x of D", 1.4, (-10.0, 10.0), "m"),
            DesignVariable::new("y of D", 0.2, (-10.0, 10.0), "m"),
            DesignVariable::new("z of D", 0.0, (-10.0, 10.0), "m"),
            DesignVariable::new("stiffness", 100.0, (1.0, 1e4), "N/m"),
            DesignVariable::new("mass of the bar", 1.6, (0.1, 10.0), "kg"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 1000).with_method("variational")
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        let problem = OptimizationProblem::minimize(OBJECTIVE).subject_to(LENGTH, Limit::AtLeast(1e-3));
        Some(problem.varying(&["x of D", "y of D"]))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [x_d, y_d, z_d, stiffness, mass] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let point = |x: f64, y: f64| Vector3::<S>::from_f64([x, y, 0.0]);
        let (a, b, c, d) = (point(0.0, 0.0), point(0.5, 0.0), point(0.8, 0.2), Vector3::new(*x_d, *y_d, *z_d));
        let ground = m.ground();
        let bar = m.natural_body("bar", (a + b) * S::from(0.5), Quaternion::identity());
        let (radius, length) = (0.5 * WIDTH, (b - a).length());
        let (axial, across) = (*mass * (0.5 * radius * radius), *mass * (length * length + 3.0 * radius * radius) / 12.0);
        m.rigid_body("bar", bar, *mass, Vector3::zeros(), [axial, across, across, S::zero(), S::zero(), S::zero()]);
        let material = Material { young: S::from(7e10), poisson: S::from(0.3), density: S::from(3700.0) };
        let section = CableSection::of(material, Shape::rectangle(S::from(WIDTH), S::from(WIDTH), material.poisson));
        let beam = m.cable("beam", CableLine::straight([c, d], 1), &section.small_strains());
        m.set_rigid_motion(&beam.nodes, d, Vector3::zeros(), Vector3::from_f64([0.0, 0.0, -5.0]));
        m.spherical("A", [ground, bar], a);
        m.spherical("D", [ground, beam.end()], d);
        m.line_spring("spring", [bar, beam.start()], [b, c], *stiffness, (c - b).length());
        m.gravity(point(0.0, -9.81));
        m.draw(bar, &[a, b]);
        m.target_functional(OBJECTIVE, Over::Integral, bar, b, b);
        m.distance_functional(LENGTH, Over::Initial, [beam.start(), beam.end()], [c, d]);
        m.position_functional("height of C at the end", Over::Terminal, beam.start(), c, point(0.0, 1.0));
        Ok(())
    }
}
