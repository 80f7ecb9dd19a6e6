use crate::design::DesignVariable;
use crate::elements::TimeFormula;
use crate::elements::flexible::Section;
use crate::functionals::Over;
use crate::functionals::quantities::SectionMeasure;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, MechanismBuilder, Scene, Settings, Signal};
use std::f64::consts::PI;

/// The spin-up manoeuvre of Simo & Vu-Quoc (1986): a beam of 10 m on a hinge that is brought to 6 rad/s in 15 s.
///
/// The hinge turns by (6/15) (t^2/2 + (15/2pi)^2 (cos(2 pi t/15) - 1)), afterwards by 6 t - 45. Then the tip lies rho A omega^2 L^3 / (3 EA)
/// further out, to first order, than the beam is long: 5.14e-4 m.
pub struct SpinUpBeam;

/// Duration of the spin-up \[s\].
const SPIN_UP: f64 = 15.0;
/// Its end rate [rad/s].
const RATE: f64 = 6.0;

/// Angle of the hinge \[rad\].
struct SpinUp;

impl TimeFormula for SpinUp {
    fn value<S: Scalar>(&self, t: S, _: &[S]) -> S {
        let wave = S::from(SPIN_UP / (2.0 * PI));
        let turning = S::from(RATE / SPIN_UP) * (S::from(0.5) * t * t + wave * wave * ((t / wave).cos() - S::one()));
        t.less(S::from(SPIN_UP)).select(turning, S::from(RATE) * (t - S::from(0.5 * SPIN_UP)))
    }
}

impl Scene for SpinUpBeam {
    fn name(&self) -> String {
        "spin-up-beam".into()
    }
    fn summary(&self) -> String {
        "flexible beam on a hinge that is brought to 6 rad/s in 15 s".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("EA", 2.8e7, (1e6, 1e9), "N"),
            DesignVariable::new("EI", 1.4e4, (1e2, 1e6), "N m2"),
            DesignVariable::new("mass", 1.2, (0.1, 10.0), "kg/m"),
            DesignVariable::new("length", 10.0, (5.0, 12.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(20.0, 2000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [axial, bending, mass, length] = x else { return Err(format!("4 variables expected, {} given", x.len())) };
        let shear = S::from(1e7);
        let section =
            Section::new([*axial, shear, shear, *bending, *bending, *bending]).with_inertia(*mass, [S::from(6e-4); 2]);
        let (x_axis, y_axis) = (Vector3::from_f64([1.0, 0.0, 0.0]), Vector3::from_f64([0.0, 1.0, 0.0]));
        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        let tip = x_axis * *length;
        let ground = m.ground();
        let beam = m.beam("beam", BeamLine::straight([Vector3::zeros(), tip], 8, y_axis), &section);
        m.revolute("hinge", [ground, beam.start()], Vector3::zeros(), hinge);
        m.prescribed_rotation("spin-up", [ground, beam.start()], hinge, Signal::own(SpinUp, &[])?);
        m.target_functional("squared distance of the tip from the hinge", Over::Terminal, beam.end(), tip, Vector3::zeros());
        m.section_functional("axial force at the hinge", Over::Terminal, &beam, 0.0, SectionMeasure::Force(0));
        let peak = Over::smooth_maximum(1e-3);
        m.section_functional("largest moment at the hinge", peak, &beam, 0.0, SectionMeasure::Force(5));
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}
