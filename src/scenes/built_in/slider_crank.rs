use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{Limit, MechanismBuilder, OptimizationProblem, Scene, Settings, Signal};
use std::f64::consts::TAU;

/// A crank driven from rest through some turns and stopped again, a rod, and a slider against a spring.
///
/// The drive follows a ramp of two seconds; after that the crank stands still and so does everything else.
pub struct SliderCrank;

impl Scene for SliderCrank {
    fn name(&self) -> String {
        "slider-crank".into()
    }
    fn summary(&self) -> String {
        "slider-crank driven through some turns against a spring, from rest to rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("crank length", 0.2, (0.05, 0.3), "m"),
            DesignVariable::new("rod length", 0.5, (0.4, 2.0), "m"),
            DesignVariable::new("slider mass", 1.0, (0.1, 10.0), "kg"),
            DesignVariable::new("stiffness", 200.0, (0.0, 2000.0), "N/m"),
            DesignVariable::new("rest length", 0.4, (0.05, 1.0), "m"),
            DesignVariable::new("turns", 2.0, (0.1, 5.0), "-"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(2.5, 1000)
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        let problem = OptimizationProblem::minimize("largest driving moment");
        let problem = problem.subject_to("x of the slider, integral", Limit::AtLeast(1.4));
        let wall = [("crank length", 1.0), ("rod length", 1.0), ("rest length", 0.5)];
        let problem = problem.linear("place of the wall", &wall, Limit::AtMost(1.0));
        Some(problem.varying(&["rod length", "stiffness", "rest length"]))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [crank_length, rod_length, slider_mass, stiffness, rest_length, turns] = x else {
            return Err(format!("6 variables expected, {} given", x.len()));
        };
        let at = |x: S, y: S| Vector3::new(x, y, S::zero());
        // the crank starts upright
        let (pin, foot) = (at(S::zero(), *crank_length), Vector3::zeros());
        let reach = (*rod_length * *rod_length - *crank_length * *crank_length).sqrt();
        let end = at(reach, S::zero());
        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        let ground = m.ground();
        let mut bar = |name: &str, from: Vector3<S>, to: Vector3<S>| {
            let along = to - from;
            let length = along.length();
            let mass = length * 2.0;
            let node = m.body(name, (from + to) * S::from(0.5), Quaternion::x_axis_to(along.unit()));
            let lateral = mass * length * length / 12.0;
            let axial = lateral * 1e-2;
            m.rigid_body(name, node, mass, Vector3::zeros(), [axial, lateral, lateral, S::zero(), S::zero(), S::zero()]);
            m.draw(node, &[from, to]);
            node
        };
        let crank = bar("crank", foot, pin);
        let rod = bar("rod", pin, end);
        let slider = m.point("slider", end);
        m.point_mass("slider", slider, *slider_mass);
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));

        m.revolute("bearing", [ground, crank], foot, hinge);
        m.revolute("pin", [crank, rod], pin, hinge);
        m.spherical("wrist", [rod, slider], end);
        // the hinges already keep the slider in the plane
        let up = Vector3::from_f64([0.0, 1.0, 0.0]);
        m.prescribed_translation("guide", [ground, slider], [Vector3::zeros(), end], up, Signal::Constant(S::zero()));
        let angle = Signal::SmoothRamp { from: S::zero(), to: *turns * TAU, start: S::zero(), duration: S::from(2.0) };
        let drive = m.prescribed_rotation("drive", [ground, crank], hinge, angle);
        // out of the slider's reach
        let wall = at(*crank_length + *rod_length + *rest_length * 0.5, S::zero());
        m.line_spring("spring", [ground, slider], [wall, end], *stiffness, *rest_length);

        let along = Vector3::from_f64([1.0, 0.0, 0.0]);
        m.position_functional("x of the slider, integral", Over::Integral, slider, end, along);
        m.reaction_functional("driving moment, integral", Over::Integral, drive, &[S::one()]);
        let largest = Over::smooth_maximum(0.5);
        m.reaction_functional("largest driving moment", largest, drive, &[-S::one()]);
        Ok(())
    }
}
