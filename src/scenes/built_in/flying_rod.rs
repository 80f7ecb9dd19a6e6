use crate::design::DesignVariable;
use crate::elements::NodeKind;
use crate::elements::TimeFunction;
use crate::elements::flexible::Section;
use crate::elements::forces::{AppliedForce, AppliedTorque, LoadFrame};
use crate::functionals::Over;
use crate::functionals::quantities::SectionMeasure;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, MechanismBuilder, Scene, Settings};

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
        let pulse = TimeFunction::lines(vec![0.0, 2.5, 5.0])?;
        let zero = S::zero();
        let end = rod.start();
        let push = AppliedForce { on: NodeKind::Body, frame: LoadFrame::World, size: pulse.clone() };
        let p = [[S::one(), zero, zero], [zero; 3], [zero, *force, zero]].concat();
        m.element("push", &[end], push, &p);
        for (name, axis, size) in [("moment about y", [0.0, 1.0, 0.0], -100.0), ("moment about z", [0.0, 0.0, 1.0], -200.0)]
        {
            let torque = AppliedTorque { on: NodeKind::Body, frame: LoadFrame::World, size: pulse.clone() };
            m.element(name, &[end], torque, &[axis.map(S::from), [zero, S::from(size), zero]].concat());
        }
        m.position_functional("x of the upper end", Over::Terminal, rod.end(), upper, point(1.0, 0.0, 0.0));
        m.section_functional("moment 2 in the middle", Over::Terminal, &rod, 0.5, SectionMeasure::Force(4));
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}
