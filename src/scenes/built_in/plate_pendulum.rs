use crate::design::DesignVariable;
use crate::elements::flexible::Material;
use crate::functionals::{Aggregate, AggregateKind, Over, Times};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{Edge, MechanismBuilder, Scene, Settings, ShellMesh};

/// A plate of aluminium that falls from a hinge along its short edge, from rest in the horizontal plane.
///
/// 25 cm x 5 cm x 1 cm, E = 70 GPa, nu = 0.3, rho = 2500 kg/m3, weight 9.81 m/s2 along -z. Design variables are the thicknesses of equal strips
/// across its length, of whole elements. The hinge holds every node of the edge.
///
/// Source: Boopathy & Kennedy, section on the performance of the shell pendulum.
pub struct PlatePendulum {
    /// Elements along the length and across; 100 x 20 is the finest in the source.
    pub elements: [usize; 2],
    /// Number of strips.
    pub strips: usize,
    /// Duration \[s\], in steps of 1 ms.
    pub milliseconds: usize,
}

impl Default for PlatePendulum {
    fn default() -> Self {
        PlatePendulum { elements: [5, 1], strips: 5, milliseconds: 20 }
    }
}

/// Length and width \[m\].
const SIZE: [f64; 2] = [0.25, 0.05];
/// Yield stress [N/m2].
const YIELD: f64 = 276e6;

impl Scene for PlatePendulum {
    fn name(&self) -> String {
        "plate-pendulum".into()
    }
    fn summary(&self) -> String {
        "plate of shell elements that falls from a hinge, from rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        (1..=self.strips).map(|strip| DesignVariable::new(format!("thickness {strip}"), 0.01, (0.002, 0.03), "m")).collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(1e-3 * self.milliseconds as f64, self.milliseconds)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [along, across] = self.elements;
        if self.strips == 0 || self.strips > along || x.len() != self.strips {
            let (strips, given) = (self.strips, x.len());
            return Err(format!(
                "{strips} strips of {along} elements, and {given} variables; give one for each strip, and whole elements to each"
            ));
        }
        let vector = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let material = Material { young: S::from(70e9), poisson: S::from(0.3), density: S::from(2500.0) };
        let edges = [vector(SIZE[0], 0.0, 0.0), vector(0.0, SIZE[1], 0.0)];
        let mesh = ShellMesh::plate(Vector3::zeros(), edges, [along, across]);
        let thickness = |element: usize, _: [f64; 2]| x[(element % along) * self.strips / along];
        let plate = m.tapered_shell("plate", mesh, &material, thickness);
        let ground = m.ground();
        for (place, node) in plate.edge(Edge::FirstStart).into_iter().enumerate() {
            let at = m.position(node);
            m.revolute(&format!("hinge {place}"), [ground, node], at, vector(0.0, 1.0, 0.0));
        }
        m.gravity(vector(0.0, 0.0, -9.81));
        let tip = plate.node(2 * along, across);
        let failure = Aggregate::new(AggregateKind::SmoothMaximum { normalized: false }, 100.0);
        m.von_mises_functional("failure ratio, smooth maximum", failure.at(Times::Run), &plate.group(), S::from(YIELD));
        m.position_functional("height of the tip at the end", Over::Terminal, tip, m.position(tip), vector(0.0, 0.0, 1.0));
        m.mass_functional("mass", Over::Initial);
        let mean = Aggregate::new(AggregateKind::Exponential, 1e4).continuous();
        m.von_mises_functional("failure ratio, induced", mean.at(Times::Run), &plate.group(), S::from(YIELD));
        m.strain_energy_functional("strain energy, integral", Over::Integral, &plate.group());
        Ok(())
    }
}
