use crate::design::DesignVariable;
use crate::elements::flexible::Section;
use crate::elements::forces::LoadFrame;
use crate::functionals::Over;
use crate::functionals::quantities::SectionMeasure;
use crate::scalar::{Interpolant, Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, Force, MechanismBuilder, Scene, Settings, Signal};

/// The right-angle cantilever of Simo & Vu-Quoc (1988): two arms of 10 m, clamped at one end, pushed out of their plane at the elbow.
///
/// The force rises to 50 N at 1 s and is gone at 2 s; bending and torsion swing with amplitudes as large as the arms are long.
pub struct RightAngleCantilever {
    /// Elements of each arm.
    pub elements: usize,
}

impl Default for RightAngleCantilever {
    fn default() -> Self {
        RightAngleCantilever { elements: 5 }
    }
}

impl Scene for RightAngleCantilever {
    fn name(&self) -> String {
        "right-angle-cantilever".into()
    }
    fn summary(&self) -> String {
        "two flexible arms at a right angle, clamped at one end and pushed out of their plane at the elbow".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("EI", 1e3, (1e2, 1e4), "N m2"),
            DesignVariable::new("GJ", 1e3, (1e2, 1e4), "N m2"),
            DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg/m"),
            DesignVariable::new("force", 50.0, (0.0, 100.0), "N"),
            DesignVariable::new("length of the second arm", 10.0, (5.0, 15.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(30.0, 3000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [bending, torsion, mass, force, length] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let axial = S::from(1e6);
        let section =
            Section::new([axial, axial, axial, *torsion, *bending, *bending]).with_inertia(*mass, [S::from(10.0); 2]);
        let point = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let (elbow, out) = (point(10.0, 0.0, 0.0), point(0.0, 0.0, 1.0));
        let tip = elbow + point(0.0, 1.0, 0.0) * *length;
        let line = BeamLine::straight([Vector3::zeros(), elbow], self.elements, out).clamped_start();
        let first = m.beam("first arm", line, &section);
        let line = BeamLine::straight([elbow, tip], self.elements, out).from_node(first.end());
        let second = m.beam("second arm", line, &section);
        let size = Signal::Table {
            times: vec![0.0, 1.0, 2.0],
            values: vec![S::zero(), *force, S::zero()],
            interpolant: Interpolant::Lines,
        };
        let (on, point, frame) = (first.end(), m.position(first.end()), LoadFrame::World);
        m.force("push", Force { on, point, direction: out, frame, size });
        m.position_functional("z of the tip", Over::Terminal, second.end(), tip, out);
        let peak = Over::smooth_maximum(5.0);
        m.position_functional("largest z of the elbow", peak, first.end(), elbow, out);
        m.section_functional("torsion at the clamp", Over::Terminal, &first, 0.0, SectionMeasure::Force(3));
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}
