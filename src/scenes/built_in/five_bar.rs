use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, OptimizationProblem, Scene, Settings};

/// A planar five-bar mechanism of four rigid bodies with two spring-dampers at its tip.
///
/// Ground points A and B, joints P1, P2, P3; uniform bars A-P1, P1-P2, P2-P3, P3-B; springs and line dampers A-P2 and B-P2;
/// psi = integral of |P2(t) - P2(0)|^2. Built of spatial bodies with parallel hinges, so three constraint equations are redundant.
pub struct FiveBar;

impl Scene for FiveBar {
    fn name(&self) -> String {
        "five-bar".into()
    }
    fn summary(&self) -> String {
        "planar five-bar mechanism with two spring-dampers; psi is how far its tip strays".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("L01", f64::sqrt(5.0), (0.5, 4.0), "m"),
            DesignVariable::new("L02", f64::sqrt(4.25), (0.5, 4.0), "m"),
            DesignVariable::new("k1", 100.0, (1.0, 1000.0), "N/m"),
            DesignVariable::new("k2", 100.0, (1.0, 1000.0), "N/m"),
            DesignVariable::new("c", 5.0, (0.0, 100.0), "N s/m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(5.0, 500).dropping_redundant()
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        // without dampers the motion is chaotic: psi would be no smooth function of the design
        Some(OptimizationProblem::minimize("psi").varying(&["L01", "L02", "k1", "k2"]))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [l01, l02, k1, k2, c] = x else { return Err(format!("5 variables expected, {} given", x.len())) };
        let at = |x: f64, y: f64| Vector3::from_f64([x, y, 0.0]);
        let points = [at(-0.5, 0.0), at(-1.0, 1.0), at(0.0, 2.0), at(1.0, 1.0), at(0.5, 0.0)];
        let ground = m.ground();
        let mut bars = Vec::new();
        for (i, mass) in [1.0, 1.5, 1.5, 1.0].into_iter().enumerate() {
            let (from, to) = (points[i], points[i + 1]);
            let along = to - from;
            let (mass, length) = (S::from(mass), along.length());
            let name = format!("bar {}", i + 1);
            let bar = m.body(&name, (from + to) * S::from(0.5), Quaternion::x_axis_to(along.unit()));
            let lateral = mass * length * length / 12.0;
            // a slender bar: next to no inertia about its own axis, which never turns in the plane
            let axial = lateral * 1e-3;
            m.rigid_body(&name, bar, mass, Vector3::zeros(), [axial, lateral, lateral, S::zero(), S::zero(), S::zero()]);
            m.draw(bar, &[from, to]);
            bars.push(bar);
        }
        m.gravity(at(0.0, -9.81));
        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        for (name, nodes, point) in [
            ("A", [ground, bars[0]], points[0]),
            ("P1", [bars[0], bars[1]], points[1]),
            ("P2", [bars[1], bars[2]], points[2]),
            ("P3", [bars[2], bars[3]], points[3]),
            ("B", [bars[3], ground], points[4]),
        ] {
            m.revolute(name, nodes, point, hinge);
        }
        for (name, end, stiffness, rest) in [("spring A", points[0], *k1, *l01), ("spring B", points[4], *k2, *l02)] {
            m.line_spring(name, [ground, bars[1]], [end, points[2]], stiffness, rest);
            m.line_damper(&format!("damper of {name}"), [ground, bars[1]], [end, points[2]], *c);
        }
        m.target_functional("psi", Over::Integral, bars[1], points[2], points[2]);
        Ok(())
    }
}
