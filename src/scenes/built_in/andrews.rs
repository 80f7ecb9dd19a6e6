use crate::design::DesignVariable;
use crate::elements::forces::LoadFrame;
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings, Signal, Torque};

/// Andrews' squeezing mechanism of rigid bodies: a crank driven by a torque, three loops that meet in one pin, and a spring.
///
/// Seven bodies K1 to K7 between ground points O, A, B and pins; the lengths that are no design variables follow from the start. Spatial
/// bodies with parallel hinges, so nine constraint equations are redundant.
///
/// Source: Test Set for IVP Solvers (Bari), problem "Andrews' squeezing mechanism"; Schiehlen (1990).
pub struct Andrews;

impl Andrews {
    /// Directions from the first to the second pin of K1 to K7 at the start, from the published angles \[rad\].
    pub(crate) const DIRECTIONS: [f64; 7] = {
        use std::f64::consts::{FRAC_PI_2, PI};
        let [beta, theta, gamma, phi, delta, omega, epsilon] = [
            -0.061_713_890_014_276_45,
            0.0,
            0.455_279_819_163_070_4,
            0.222_668_390_165_885_9,
            0.487_364_979_543_842_5,
            -0.222_668_390_165_885_9,
            1.230_547_444_549_821_2,
        ];
        let (two, four, six) = (beta + theta + PI, delta + phi - FRAC_PI_2, epsilon + omega);
        [beta, two, gamma - FRAC_PI_2, four, delta, six, epsilon - FRAC_PI_2]
    };
}

impl Scene for Andrews {
    fn name(&self) -> String {
        "andrews".into()
    }
    fn summary(&self) -> String {
        "Andrews' squeezing mechanism of seven rigid bodies (Test Set for IVP Solvers)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("torque", 0.033, (0.0, 0.1), "N m"),
            DesignVariable::new("stiffness", 4530.0, (0.0, 1e4), "N/m"),
            DesignVariable::new("rest length", 0.07785, (0.01, 0.2), "m"),
            DesignVariable::new("length of K1", 0.007, (0.006, 0.008), "m"),
            DesignVariable::new("length of K2", 0.028, (0.027, 0.029), "m"),
            DesignVariable::new("length of K5", 0.04, (0.03, 0.05), "m"),
            DesignVariable::new("length of K7", 0.04, (0.03, 0.05), "m"),
            DesignVariable::new("mass of K3", 0.02373, (0.001, 0.1), "kg"),
            DesignVariable::new("inertia of K1", 2.194e-6, (1e-7, 1e-4), "kg m2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.03, 600).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [torque, stiffness, rest_length, one, two, five, seven, mass_of_3, inertia_of_1] = x else {
            return Err(format!("9 variables expected, {} given", x.len()));
        };
        let at = |x: f64, y: f64| Vector3::from_f64([x, y, 0.0]);
        let direction = |body: usize| at(Self::DIRECTIONS[body].cos(), Self::DIRECTIONS[body].sin());
        let (o, a, b) = (at(0.0, 0.0), at(-0.06934, -0.00227), at(-0.03635, 0.03273));
        let crank = direction(0) * *one;
        let pin = crank + direction(1) * *two;
        let (left, right) = (a + direction(4) * *five, a + direction(6) * *seven);
        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        let ground = m.ground();
        // ends of each body, its mass centre along and across from the first end (K4, K6: from the second), mass and inertia about it
        let mut link = |name: &str, [from, to]: [Vector3<S>; 2], [along, across]: [f64; 2], mass: S, inertia: S| {
            let direction = (to - from).unit();
            let start = if along < 0.0 { to } else { from };
            let centre = start + direction * S::from(along) + hinge.cross(&direction) * S::from(across);
            let node = m.body(name, centre, Quaternion::x_axis_to(direction));
            // only the last moment of inertia matters in the plane
            m.rigid_body(name, node, mass, Vector3::zeros(), [inertia, inertia, inertia, S::zero(), S::zero(), S::zero()]);
            m.draw(node, &[from, to]);
            node
        };
        let of = S::from;
        let k1 = link("K1", [o, crank], [0.00092, 0.0], of(0.04325), *inertia_of_1);
        let k2 = link("K2", [crank, pin], [0.0115, 0.0], of(0.00365), of(4.41e-7));
        let k3 = link("K3", [b, pin], [0.01874, 0.01043], *mass_of_3, of(5.255e-6));
        let k4 = link("K4", [left, pin], [-0.01421, 0.0], of(0.00706), of(5.667e-7));
        let k5 = link("K5", [a, left], [0.02308, 0.00916], of(0.0705), of(1.169e-5));
        let k6 = link("K6", [right, pin], [-0.01421, 0.0], of(0.00706), of(5.667e-7));
        let k7 = link("K7", [a, right], [0.01228, -0.00449], of(0.05498), of(1.912e-5));
        for (name, nodes, point) in [
            ("O", [ground, k1], o),
            ("crank pin", [k1, k2], crank),
            ("B", [ground, k3], b),
            ("pin of K3", [k2, k3], pin),
            ("A of K5", [ground, k5], a),
            ("left pin", [k5, k4], left),
            ("pin of K4", [k2, k4], pin),
            ("A of K7", [ground, k7], a),
            ("right pin", [k7, k6], right),
            ("pin of K6", [k2, k6], pin),
        ] {
            m.revolute(name, nodes, point, hinge);
        }
        let along = (pin - b).unit();
        let eye = b + along * of(0.018) + hinge.cross(&along) * of(0.02);
        let post = at(0.014, 0.072);
        m.line_spring("spring", [ground, k3], [post, eye], *stiffness, *rest_length);
        m.draw(k3, &[pin, eye, b]);
        let (frame, size) = (LoadFrame::Body, Signal::Constant(*torque));
        m.torque("drive", Torque { on: k1, axis: hinge, frame, size });

        let [x, y] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from_f64);
        m.position_functional("x of the pin at the end", Over::Terminal, k2, pin, x);
        m.position_functional("y of the crank pin at the end", Over::Terminal, k1, crank, y);
        m.target_functional("distance of the pin from its start, integral", Over::Integral, k2, pin, pin);
        m.energy_functional("energy at the end", Over::Terminal);
        Ok(())
    }
}
