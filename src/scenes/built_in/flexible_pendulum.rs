use crate::design::DesignVariable;
use crate::elements::flexible::Shape;
use crate::elements::flexible::{CableSection, Material};
use crate::functionals::Over;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{CableLine, MechanismBuilder, Scene, Settings};

/// A soft pendulum of square section in absolute nodal coordinates, released from rest along x.
///
/// Length 1.2 m, weight 9.81 m/s2 along -y, 4 s. The deflection of the tip is measured across the tangent at the hinge.
///
/// Source: Ebrahimi et al., section 6.1.
pub struct FlexiblePendulum {
    /// Number of elements; five in the source.
    pub elements: usize,
}

impl Default for FlexiblePendulum {
    fn default() -> Self {
        FlexiblePendulum { elements: 5 }
    }
}

impl Scene for FlexiblePendulum {
    fn name(&self) -> String {
        "flexible-pendulum".into()
    }
    fn summary(&self) -> String {
        "soft cable-beam that falls from a hinge, from rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("h", 0.05, (0.01, 0.2), "m"),
            DesignVariable::new("rho", 4000.0, (1000.0, 1e4), "kg/m3"),
            DesignVariable::new("E", 1e7, (1e6, 1e9), "N/m2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(4.0, 1600)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [height, density, young] = x else {
            return Err(format!("3 variables expected, {} given", x.len()));
        };
        let point = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let poisson = S::from(0.3);
        let material = Material { young: *young, poisson, density: *density };
        let section = CableSection::of(material, Shape::rectangle(*height, *height, poisson));
        let ground = m.ground();
        let line = CableLine::straight([Vector3::zeros(), point(1.2, 0.0, 0.0)], self.elements);
        let pendulum = m.cable("pendulum", line, &section);
        m.spherical("hinge", [ground, pendulum.start()], Vector3::zeros());
        m.gravity(point(0.0, -9.81, 0.0));
        let (normal, ends) = (point(0.0, 0.0, 1.0), [pendulum.start(), pendulum.end()]);
        m.cable_deflection_functional("deflection of the tip at the end", Over::Terminal, ends, normal);
        m.cable_deflection_functional("deflection of the tip, integral", Over::Integral, ends, normal);
        m.position_functional(
            "height of the tip at the end",
            Over::Terminal,
            ends[1],
            m.position(ends[1]),
            point(0.0, 1.0, 0.0),
        );
        m.cable_stress_functional(
            "stress at the edge in the middle",
            Over::Terminal,
            (&pendulum, 0.5),
            *young,
            *height * 0.5,
        );
        Ok(())
    }
}
