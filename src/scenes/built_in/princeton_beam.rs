use crate::design::DesignVariable;
use crate::elements::flexible::Section;
use crate::elements::forces::LoadFrame;
use crate::functionals::Over;
use crate::functionals::quantities::SectionMeasure;
use crate::scalar::{Scalar, Vector3};
use crate::scenes::{BeamLine, Force, MechanismBuilder, Scene, Settings, Signal};

/// The Princeton beam experiment (Dowell & Traybar 1975; Bauchau et al. 2016), middle load: a flat cantilever of aluminium with a weight at
/// its tip, its section turned against the weight, so that it bends both ways and twists.
///
/// Axis 3 of the section is its stiff direction; at a load angle of zero the weight pulls along it.
pub struct PrincetonBeam {
    /// Number of elements.
    pub elements: usize,
}

impl Default for PrincetonBeam {
    fn default() -> Self {
        PrincetonBeam { elements: 8 }
    }
}

impl Scene for PrincetonBeam {
    fn name(&self) -> String {
        "princeton-beam".into()
    }
    fn summary(&self) -> String {
        "flat cantilever that a weight at its tip bends both ways and twists; equilibria under a growing load".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("load angle", 45.0 * std::f64::consts::PI / 180.0, (0.0, 1.6), "rad"),
            DesignVariable::new("load", 8.896, (0.0, 20.0), "N"),
            DesignVariable::new("EI of the stiff plane", 36.2794, (1.0, 100.0), "N m2"),
            DesignVariable::new("EI of the soft plane", 2.42873, (0.1, 100.0), "N m2"),
            DesignVariable::new("GJ", 3.10338, (0.1, 100.0), "N m2"),
            DesignVariable::new("length", 0.508, (0.1, 1.0), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::statics(20).dividing_steps()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [angle, load, stiff, soft, torsion, length] = x else {
            return Err(format!("6 variables expected, {} given", x.len()));
        };
        let number = |value: f64| S::from(value);
        let section = Section::new([number(2.84191e6), number(6.40131e5), number(9.03881e5), *torsion, *stiff, *soft]);
        let axis = |i: usize| Vector3::<S>::from(std::array::from_fn(|k| S::from(f64::from(u8::from(k == i)))));
        let tip = axis(0) * *length;
        let beam =
            m.beam("beam", BeamLine::straight([Vector3::zeros(), tip], self.elements, axis(1)).clamped_start(), &section);
        let (sine, cosine) = angle.sin_cos();
        let direction = axis(1) * sine + axis(2) * cosine;
        let (on, point, frame) = (beam.end(), m.position(beam.end()), LoadFrame::World);
        let size = Signal::ConstantRate { offset: S::zero(), rate: *load };
        m.force("weight", Force { on, point, direction, frame, size });
        m.position_functional("soft displacement of the tip", Over::Terminal, beam.end(), tip, axis(1));
        m.position_functional("stiff displacement of the tip", Over::Terminal, beam.end(), tip, axis(2));
        for (name, component) in [("torsion", 3), ("moment of the stiff plane", 4), ("moment of the soft plane", 5)] {
            let name = format!("{name} at the clamp");
            m.section_functional(&name, Over::Terminal, &beam, 0.0, SectionMeasure::Force(component));
        }
        Ok(())
    }
}
