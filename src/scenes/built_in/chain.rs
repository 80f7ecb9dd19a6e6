use crate::design::DesignVariable;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// A chain of bars with spherical joints, held at one end, turning about the vertical while it falls.
pub struct Chain {
    /// Number of bars.
    pub bodies: usize,
    /// What may be designed.
    pub variables: ChainVariables,
}

/// Design variables of a [`Chain`]: few or many, each set touching every body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainVariables {
    /// One: the radius of every bar, at constant mass per volume.
    Common,
    /// Ten for each bar: mass, place of the mass centre, inertia tensor about it.
    Separate,
}

impl Chain {
    /// One hundred bars with one common variable.
    pub fn common() -> Self {
        Chain { bodies: 100, variables: ChainVariables::Common }
    }

    /// One hundred bars with ten variables each.
    pub(crate) fn separate() -> Self {
        Chain { bodies: 100, variables: ChainVariables::Separate }
    }
}

/// Length of a bar \[m\].
const LENGTH: f64 = 0.1;
/// Speed of the tip at the start, whatever the number of bars [m/s].
const TIP_SPEED: f64 = 2.0;
/// Radius of a round bar in the initial design \[m\].
const RADIUS: f64 = 0.01;
/// Mass of a bar of that radius per length [kg/m].
const DENSITY: f64 = 2.0;

/// Mass, mass centre and inertia (xx, yy, zz, xy, xz, yz) of a round bar along x with its frame at the middle.
fn bar_inertia<S: Scalar>(radius: S) -> [S; 10] {
    let share = radius / RADIUS;
    let mass = share * share * (DENSITY * LENGTH);
    let axial = mass * radius * radius * 0.5;
    let lateral = mass * (LENGTH * LENGTH / 12.0) + axial * 0.5;
    let zero = S::zero();
    [mass, zero, zero, zero, axial, lateral, lateral, zero, zero, zero]
}

impl Scene for Chain {
    fn name(&self) -> String {
        match self.variables {
            ChainVariables::Common => "chain-common".into(),
            ChainVariables::Separate => "chain-separate".into(),
        }
    }
    fn summary(&self) -> String {
        let variables = match self.variables {
            ChainVariables::Common => "one design variable for all".to_string(),
            ChainVariables::Separate => format!("{} design variables", 10 * self.bodies),
        };
        format!("chain of {} bars with spherical joints, {variables}", self.bodies)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        if self.variables == ChainVariables::Common {
            return vec![DesignVariable::new("radius", RADIUS, (0.002, 0.05), "m")];
        }
        let names = [
            ("mass", "kg"),
            ("centre x", "m"),
            ("centre y", "m"),
            ("centre z", "m"),
            ("inertia xx", "kg m2"),
            ("inertia yy", "kg m2"),
            ("inertia zz", "kg m2"),
            ("inertia xy", "kg m2"),
            ("inertia xz", "kg m2"),
            ("inertia yz", "kg m2"),
        ];
        let initial = bar_inertia(RADIUS);
        let lateral = initial[5];
        let bounds = |i: usize| match i {
            1..=3 => (-0.5 * LENGTH, 0.5 * LENGTH),
            7..=9 => (-0.2 * initial[4], 0.2 * initial[4]),
            4 => (0.5 * initial[4], 2.0 * lateral),
            _ => (0.1 * initial[i], 10.0 * initial[i]),
        };
        (0..self.bodies)
            .flat_map(|body| {
                names.iter().enumerate().map(move |(i, &(name, unit))| {
                    DesignVariable::new(format!("bar {}: {name}", body + 1), initial[i], bounds(i), unit)
                })
            })
            .collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.5, 500)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let expected = if self.variables == ChainVariables::Common { 1 } else { 10 * self.bodies };
        if x.len() != expected || self.bodies == 0 {
            return Err(format!("{expected} variables expected for {} bars, {} given", self.bodies, x.len()));
        }
        let along = |bars: f64| Vector3::new(S::from(LENGTH * bars), S::zero(), S::zero());
        let about_vertical = Vector3::from_f64([0.0, 0.0, TIP_SPEED / (LENGTH * self.bodies as f64)]);
        let ground = m.ground();
        let mut before = ground;
        for i in 0..self.bodies {
            let name = format!("bar {}", i + 1);
            let position = along(i as f64 + 0.5);
            let bar = m.body(&name, position, Quaternion::identity());
            // the joints lie on the bars' own axes, about which each may turn as it likes
            let own = Vector3::from_f64([if i % 2 == 0 { 3.0 } else { -3.0 }, 0.0, 0.0]);
            m.set_velocity(bar, about_vertical.cross(&position), about_vertical + own);
            let [mass, cx, cy, cz, inertia @ ..] = match self.variables {
                ChainVariables::Common => bar_inertia(x[0]),
                ChainVariables::Separate => std::array::from_fn(|k| x[10 * i + k]),
            };
            m.rigid_body(&name, bar, mass, Vector3::new(cx, cy, cz), inertia);
            m.spherical(&format!("joint {}", i + 1), [before, bar], along(i as f64));
            m.draw(bar, &[along(i as f64), along(i as f64 + 1.0)]);
            before = bar;
        }
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        let tip = along(self.bodies as f64);
        m.target_functional("distance of the tip from its start, integral", Over::Integral, before, tip, tip);
        m.energy_functional("energy, integral", Over::Integral);
        Ok(())
    }
}
