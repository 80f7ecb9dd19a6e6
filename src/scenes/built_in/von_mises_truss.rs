use crate::design::DesignVariable;
use crate::elements::forces::LoadFrame;
use crate::functionals::Over;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{Force, MechanismBuilder, Scene, Settings, Signal};

/// Two springs that lean against each other under a load that grows until they snap through.
///
/// At a height z the load is F = 2 k z (l / L - 1) with L^2 = b^2 + z^2 and the length l at rest; its limit lies at L^3 = l b^2.
///
/// Source: R. von Mises, ZAMM 3 (1923).
pub struct VonMisesTruss;

impl Scene for VonMisesTruss {
    fn name(&self) -> String {
        "von-mises-truss".into()
    }
    fn summary(&self) -> String {
        "shallow truss of two springs, equilibria under a growing load".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("half span", 1.0, (0.1, 10.0), "m"),
            DesignVariable::new("rise", 0.2, (0.01, 10.0), "m"),
            DesignVariable::new("stiffness", 1000.0, (1.0, 1e6), "N/m"),
            DesignVariable::new("mass", 0.1, (1e-3, 100.0), "kg"),
            DesignVariable::new("load", 2.5, (-1e3, 1e3), "N"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::statics(10)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [half_span, rise, stiffness, mass, load] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let ground = m.ground();
        let (place, up) = (Vector3::new(S::zero(), S::zero(), *rise), Vector3::from_f64([0.0, 0.0, 1.0]));
        let apex = m.point("apex", place);
        m.point_mass("apex", apex, *mass);
        for (name, side) in [("left", -1.0), ("right", 1.0)] {
            let foot = Vector3::new(*half_span * side, S::zero(), S::zero());
            m.line_spring(name, [ground, apex], [foot, place], *stiffness, (place - foot).length());
        }
        let guide = m.point_on_line("guide", [ground, apex], place, up);
        let (frame, size) = (LoadFrame::World, Signal::ConstantRate { offset: S::zero(), rate: *load });
        m.force("load", Force { on: apex, point: place, direction: -up, frame, size });
        m.draw(ground, &[Vector3::new(-*half_span, S::zero(), S::zero()), Vector3::new(*half_span, S::zero(), S::zero())]);
        m.position_functional("height", Over::Terminal, apex, place, up);
        m.position_functional("height, integral", Over::Integral, apex, place, up);
        m.energy_functional("energy", Over::Terminal);
        m.reaction_norm_functional("guide", Over::Integral, guide);
        Ok(())
    }
}
