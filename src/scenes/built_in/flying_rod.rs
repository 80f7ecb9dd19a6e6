use crate::design::DesignVariable;
use crate::elements::flexible::Section;
use crate::elements::forces::LoadFrame;
use crate::functionals::Over;
use crate::functionals::quantities::SectionMeasure;
use crate::scalar::{Interpolant, Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, Force, MechanismBuilder, Scene, Settings, Signal, Torque};

/// The flying flexible rod of Simo & Vu-Quoc (1988): a free rod of 10 m, pushed and turned at its lower end in space.
///
/// Force along x and moments about y and z rise to 20 N, -100 and -200 N m within 2.5 s and are gone after 5 s; from there on
/// momentum, angular momentum and energy stay. The momentum is the integral of the force, 50 N s.
pub struct FlyingRod;

impl Scene for FlyingRod {
    fn name(&self) -> String {
        "flying-rod".into()
    }
    fn summary(&self) -> String {
        "free flexible rod in space, pushed and turned at one end for 5 s".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("EA", 1e4, (1e3, 1e6), "N"),
            DesignVariable::new("EI", 500.0, (50.0, 5000.0), "N m2"),
            DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg/m"),
            DesignVariable::new("inertia", 10.0, (1.0, 100.0), "kg m"),
            DesignVariable::new("force", 20.0, (0.0, 50.0), "N"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(10.0, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [axial, bending, mass, inertia, force] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let section =
            Section::new([*axial, *axial, *axial, *bending, *bending, *bending]).with_inertia(*mass, [*inertia; 2]);
        let point = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let (lower, upper) = (point(6.0, 0.0, 0.0), point(0.0, 8.0, 0.0));
        let rod = m.beam("rod", BeamLine::straight([lower, upper], 10, point(0.0, 0.0, 1.0)), &section);
        let pulse = |size: S| Signal::Table {
            times: vec![0.0, 2.5, 5.0],
            values: vec![S::zero(), size, S::zero()],
            interpolant: Interpolant::Lines,
        };
        let (on, place, frame) = (rod.start(), m.position(rod.start()), LoadFrame::World);
        let direction = point(1.0, 0.0, 0.0);
        m.force("push", Force { on, point: place, direction, frame, size: pulse(*force) });
        for (name, axis, size) in [("moment about y", [0.0, 1.0, 0.0], -100.0), ("moment about z", [0.0, 0.0, 1.0], -200.0)]
        {
            m.torque(name, Torque { on, axis: Vector3::from_f64(axis), frame, size: pulse(S::from(size)) });
        }
        m.position_functional("x of the upper end", Over::Terminal, rod.end(), upper, point(1.0, 0.0, 0.0));
        m.section_functional("moment 2 in the middle", Over::Terminal, &rod, 0.5, SectionMeasure::Force(4));
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}
