use crate::design::DesignVariable;
use crate::elements::flexible::Material;
use crate::functionals::{Aggregate, AggregateKind, ElementGroup, Over, Times};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{Extrusion, MechanismBuilder, Profile, Scene, Settings, ThinWalls};

/// A square tube of aluminium that falls from a hinge at one end, from rest in the horizontal plane.
///
/// 25 cm long, middle lines of 5 cm x 5 cm, walls of 1 cm, E = 70 GPa, nu = 0.3, rho = 2500 kg/m3, weight 9.81 m/s2 along -z. A rigid interface
/// joins the end of all walls to the hinge on the axis of the tube. Design variables are the thicknesses of the four walls.
///
/// Source: Boopathy & Kennedy, section on parallel scalability, whose hinge and time step are not given.
pub struct BoxTubePendulum {
    /// Elements along the tube, and across each wall.
    pub elements: [usize; 2],
    /// Duration \[s\], in steps of 1 ms.
    pub milliseconds: usize,
}

impl Default for BoxTubePendulum {
    fn default() -> Self {
        BoxTubePendulum { elements: [5, 1], milliseconds: 10 }
    }
}

/// Length and width of the middle lines \[m\].
const SIZE: [f64; 2] = [0.25, 0.05];
/// Yield stress [N/m2].
const YIELD: f64 = 276e6;
/// Names of the walls, in the order of the profile.
const WALLS: [&str; 4] = ["lower wall", "right wall", "upper wall", "left wall"];

impl Scene for BoxTubePendulum {
    fn name(&self) -> String {
        "box-tube-pendulum".into()
    }
    fn summary(&self) -> String {
        "square tube of four walls of shells that falls from a hinge, from rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        WALLS.map(|wall| DesignVariable::new(format!("thickness of the {wall}"), 0.01, (0.002, 0.03), "m")).into()
    }
    fn settings(&self) -> Settings {
        Settings::new(1e-3 * self.milliseconds as f64, self.milliseconds)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [along, across] = self.elements;
        let vector = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let material = Material { young: S::from(70e9), poisson: S::from(0.3), density: S::from(2500.0) };
        let profile = Profile::box_tube([S::from(SIZE[1]); 2], [across; 2]);
        let extrusion = Extrusion {
            start: Vector3::zeros(),
            along: vector(SIZE[0], 0.0, 0.0),
            first_axis: vector(0.0, 1.0, 0.0),
            twist: S::zero(),
            elements: along,
        };
        let tube: ThinWalls = m.thin_walls("tube", &profile, &extrusion, &material, |wall, _| x[wall]);
        let held = tube.start();
        let (Some(&root), Some(&tip)) = (held.first(), tube.end().first()) else {
            return Err(format!("a tube of {along} x {across} elements a wall; give it one at least"));
        };
        m.rigid_interface("flange", root, &held);
        let ground = m.ground();
        m.revolute("hinge", [ground, root], Vector3::zeros(), vector(0.0, 1.0, 0.0));
        m.gravity(vector(0.0, 0.0, -9.81));
        let walls: Vec<ElementGroup> = tube.walls.iter().map(|wall| wall.group()).collect();
        let all = ElementGroup::of_groups("tube", &walls);
        let failure = Aggregate::new(AggregateKind::SmoothMaximum { normalized: false }, 100.0);
        m.von_mises_functional("failure ratio, smooth maximum", failure.at(Times::Run), &all, S::from(YIELD));
        m.position_functional("height of the tip at the end", Over::Terminal, tip, m.position(tip), vector(0.0, 0.0, 1.0));
        m.mass_functional("mass", Over::Initial);
        let mean = Aggregate::new(AggregateKind::Exponential, 1e4).continuous();
        m.von_mises_functional("failure ratio, induced", mean.at(Times::Run), &all, S::from(YIELD));
        Ok(())
    }
}
