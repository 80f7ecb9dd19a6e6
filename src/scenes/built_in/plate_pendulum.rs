use crate::design::DesignVariable;
use crate::elements::flexible::Material;
use crate::functionals::{Aggregate, AggregateKind, Over, Times};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{Edge, MechanismBuilder, Scene, Settings, ShellMesh};

/// A plate of aluminium that falls from a hinge along its short edge, from rest in the horizontal plane.
///
/// 25 cm x 5 cm x 1 cm, E = 70 GPa, nu = 0.3, rho = 2500 kg/m3, weight 9.81 m/s2 along -z. Design variables are the thicknesses of equal strips
/// across its length, of whole elements, or of the nodes. The hinge holds every node of the edge.
///
/// Source: Boopathy & Kennedy, section on the performance of the shell pendulum.
pub struct PlatePendulum {
    /// Elements along the length and across; 100 x 20 is the finest in the source.
    pub elements: [usize; 2],
    /// Which thicknesses are design variables.
    pub thicknesses: Thicknesses,
    /// Duration \[s\], in steps of 1 ms.
    pub milliseconds: usize,
}

/// What has a thickness of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thicknesses {
    /// As many strips across the length.
    Strips(usize),
    /// Every node.
    Nodes,
}

impl Default for PlatePendulum {
    fn default() -> Self {
        PlatePendulum { elements: [5, 1], thicknesses: Thicknesses::Strips(5), milliseconds: 20 }
    }
}

/// Length and width \[m\].
const SIZE: [f64; 2] = [0.25, 0.05];
/// Yield stress [N/m2].
const YIELD: f64 = 276e6;

impl PlatePendulum {
    /// Number of thicknesses.
    fn count(&self) -> usize {
        match self.thicknesses {
            Thicknesses::Strips(strips) => strips,
            Thicknesses::Nodes => self.elements.iter().map(|count| 2 * count + 1).product(),
        }
    }
}

impl Scene for PlatePendulum {
    fn name(&self) -> String {
        "plate-pendulum".into()
    }
    fn summary(&self) -> String {
        "plate of shell elements that falls from a hinge, from rest".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        (1..=self.count()).map(|place| DesignVariable::new(format!("thickness {place}"), 0.01, (0.002, 0.03), "m")).collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(1e-3 * self.milliseconds as f64, self.milliseconds)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [along, across] = self.elements;
        let (count, given) = (self.count(), x.len());
        if given != count || count == 0 || matches!(self.thicknesses, Thicknesses::Strips(strips) if strips > along) {
            return Err(format!(
                "{count} thicknesses with {along} elements along the plate, and {given} variables; give one for each, and whole elements to a strip"
            ));
        }
        let vector = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let material = Material { young: S::from(70e9), poisson: S::from(0.3), density: S::from(2500.0) };
        let edges = [vector(SIZE[0], 0.0, 0.0), vector(0.0, SIZE[1], 0.0)];
        let mesh = ShellMesh::plate(Vector3::zeros(), edges, [along, across]);
        let thickness = |element: usize, place: [f64; 2]| match self.thicknesses {
            Thicknesses::Strips(strips) => x[(element % along) * strips / along],
            Thicknesses::Nodes => {
                let [i, j] = [(place[0], along), (place[1], across)]
                    .map(|(share, elements)| (share * (2 * elements) as f64).round() as usize);
                x[i + j * (2 * along + 1)]
            }
        };
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
