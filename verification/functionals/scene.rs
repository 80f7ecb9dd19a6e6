//! The plate pendulum with any list of functionals.

use costate::elements::flexible::Material;
use costate::functionals::{Aggregate, AggregateKind, Over, Times};
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, Edge, MechanismBuilder, Scene, Settings, ShellMesh};

/// What is measured of the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    Mass,
    StrainEnergy,
    VonMises,
}

/// A functional with its name.
#[derive(Clone, Debug)]
pub struct Entry {
    pub name: String,
    pub measure: Measure,
    pub over: Over,
}

/// A plate of aluminium, 25 x 5 x 1 cm, that falls from a hinge along its short edge from rest.
pub struct ShellPendulum {
    /// Elements along and across.
    pub elements: [usize; 2],
    /// Number of strips of one thickness each.
    pub strips: usize,
    /// Steps of 1 ms.
    pub steps: usize,
    /// Young's modulus [N/m2].
    pub young: f64,
    /// Its functionals.
    pub list: Vec<Entry>,
}

/// Length and width [m].
const SIZE: [f64; 2] = [0.25, 0.05];
/// [m]
const THICKNESS: f64 = 0.01;
/// Yield stress [N/m2].
const YIELD: f64 = 276e6;
/// Young's modulus [N/m2].
pub const YOUNG: f64 = 70e9;

/// A size of the largest failure ratio, to which exponents are related.
pub const RATIO: f64 = 2e-4;

/// The names of Table 6 with their functionals, in its order, for a sharpness by the [largest ratio](RATIO).
pub fn of_the_table(sharpness: f64) -> Vec<Entry> {
    let exponential = |kind| Aggregate::new(kind, sharpness / RATIO);
    let power = |kind| Aggregate::new(kind, sharpness);
    let smooth = exponential(AggregateKind::SmoothMaximum { normalized: false });
    let (once, squared) = (exponential(AggregateKind::Exponential), exponential(AggregateKind::SquaredExponential));
    let (power_once, power_squared) = (power(AggregateKind::Power), power(AggregateKind::SquaredPower));
    let stress = |name: &str, aggregate: Aggregate| Entry {
        name: name.into(),
        measure: Measure::VonMises,
        over: aggregate.at(Times::Run),
    };
    vec![
        Entry { name: "structural mass".into(), measure: Measure::Mass, over: Over::Initial },
        Entry { name: "compliance".into(), measure: Measure::StrainEnergy, over: Over::Integral },
        stress("KS (discrete)", smooth),
        stress("KS (continuous)", smooth.continuous()),
        stress("induced (exponential)", once.continuous()),
        stress("induced (discrete exponential)", once),
        stress("induced (discrete exponential squared)", squared),
        stress("induced (exponential squared)", squared.continuous()),
        stress("induced (power)", power_once.continuous()),
        stress("induced (discrete power)", power_once),
        stress("induced (power squared)", power_squared.continuous()),
        stress("induced (discrete power squared)", power_squared),
    ]
}

impl Scene for ShellPendulum {
    fn name(&self) -> String {
        "shell-pendulum".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let strips = (1..=self.strips).map(|strip| (format!("thickness {strip}"), THICKNESS, "m"));
        let others = [("length", SIZE[0], "m"), ("young", self.young, "N/m2"), ("yield stress", YIELD, "N/m2")];
        let others = others.map(|(name, value, unit)| (name.to_string(), value, unit));
        let variable = |(name, value, unit)| DesignVariable::new(name, value, (0.5 * value, 2.0 * value), unit);
        strips.chain(others).map(variable).collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(1e-3 * self.steps as f64, self.steps)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (thicknesses, &[length, young, yield_stress]) = x.split_at(self.strips) else {
            return Err(format!("{} variables for {} strips", x.len(), self.strips));
        };
        let along = self.elements[0];
        let vector = |x: f64, y: f64, z: f64| Vector3::<S>::from_f64([x, y, z]);
        let material = Material { young, poisson: S::from(0.3), density: S::from(2500.0) };
        let edges = [vector(1.0, 0.0, 0.0) * length, vector(0.0, SIZE[1], 0.0)];
        let mesh = ShellMesh::plate(Vector3::zeros(), edges, self.elements);
        let thickness = |element: usize, _: [f64; 2]| thicknesses[(element % along) * self.strips / along];
        let plate = m.tapered_shell("plate", mesh, &material, thickness);
        let ground = m.ground();
        for (place, node) in plate.edge(Edge::FirstStart).into_iter().enumerate() {
            let at = m.position(node);
            m.revolute(&format!("hinge {place}"), [ground, node], at, vector(0.0, 1.0, 0.0));
        }
        m.gravity(vector(0.0, 0.0, -9.81));
        let group = plate.group();
        for Entry { name, measure, over } in &self.list {
            match measure {
                Measure::Mass => m.group_mass_functional(name, *over, &group),
                Measure::StrainEnergy => m.strain_energy_functional(name, *over, &group),
                Measure::VonMises => m.von_mises_functional(name, *over, &group, yield_stress),
            }
        }
        Ok(())
    }
}
