use crate::design::DesignVariable;
use crate::elements::flexible::{STRAINS, Section};
use crate::functionals::Over;
use crate::functionals::quantities::SectionMeasure;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{BeamLine, MechanismBuilder, Scene, Settings, Signal};

/// The flexible four-bar mechanism of Bauchau et al. (2016): three square steel bars, the hinge at C tilted by 5 degrees, the crank
/// driven at constant rate.
///
/// Were its bars rigid and the hinge tilted, it could not move at all: they bend and twist. Gravity acts along -z; bars start with
/// the velocities of the mechanism without tilt.
pub struct FlexibleFourBar {
    /// Elements of AB, BC, CD; even numbers, so that mid-span lies between two.
    pub elements: [usize; 3],
    /// Duration \[s\] and number of steps.
    pub run: (f64, usize),
}

impl Default for FlexibleFourBar {
    fn default() -> Self {
        FlexibleFourBar { elements: [4, 8, 4], run: (12.0, 1200) }
    }
}

/// EA, GA, GA \[N\], GJ, EI, EI [N m2], mass [kg/m] and inertia about an axis across [kg m] of bars of 16 mm and of 8 mm.
const THICK: [f64; 8] = [5.2992e7, 1.68803e7, 1.68803e7, 733.488, 1130.50, 1130.50, 1.9968, 4.25984e-5];
const THIN: [f64; 8] = [1.3248e7, 4.22008e6, 4.22008e6, 45.8430, 70.6560, 70.6560, 0.4992, 2.6624e-6];

/// The section with all sides times `ratio`.
fn scaled<S: Scalar>(numbers: [f64; 8], ratio: S) -> Section<S> {
    let (square, fourth) = (ratio.powi(2), ratio.powi(4));
    let powers = [square, square, square, fourth, fourth, fourth];
    let stiffness: [S; STRAINS] = std::array::from_fn(|i| powers[i] * numbers[i]);
    Section::new(stiffness).with_inertia(square * numbers[6], [fourth * numbers[7]; 2])
}

impl Scene for FlexibleFourBar {
    fn name(&self) -> String {
        "flexible-four-bar".into()
    }
    fn summary(&self) -> String {
        "flexible four-bar mechanism whose hinge at C is tilted by 5 degrees, so that its bars bend and twist".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("side of AB and BC", 0.016, (0.008, 0.032), "m"),
            DesignVariable::new("side of CD", 0.008, (0.004, 0.016), "m"),
            DesignVariable::new("tilt of C", 5.0 * std::f64::consts::PI / 180.0, (0.0, 0.5), "rad"),
            DesignVariable::new("length of AB", 0.12, (0.06, 0.24), "m"),
            DesignVariable::new("length of BC", 0.24, (0.12, 0.48), "m"),
            DesignVariable::new("length of CD", 0.12, (0.06, 0.24), "m"),
        ]
    }
    fn settings(&self) -> Settings {
        // the tilted hinge allows no part of the untilted mechanism's rate at C; the snaps take milliseconds
        Settings::new(self.run.0, self.run.1).projecting_start().dividing_steps()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [thick, thin, tilt, ab, bc, cd] = x else { return Err(format!("6 variables expected, {} given", x.len())) };
        let at = |x: S, y: S| Vector3::new(x, y, S::zero());
        let zero = S::zero();
        let (a, b, c, d) = (at(zero, zero), at(zero, *ab), at(*bc, *ab), at(*bc, *ab - *cd));
        let ground = m.ground();
        let (thick, thin) = (scaled(THICK, *thick / 0.016), scaled(THIN, *thin / 0.008));
        let mut bar = |name: &str, ends: [Vector3<S>; 2], elements: usize, section: &Section<S>| {
            let across = Vector3::from_f64([0.0, 0.0, 1.0]).cross(&(ends[1] - ends[0]));
            m.beam(name, BeamLine::straight(ends, elements, across), section)
        };
        let first = bar("AB", [a, b], self.elements[0], &thick);
        let second = bar("BC", [b, c], self.elements[1], &thick);
        let third = bar("CD", [c, d], self.elements[2], &thin);
        let gravity = Vector3::from_f64([0.0, 0.0, -9.81]);
        m.gravity(gravity);

        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        let tilted = Vector3::new(tilt.sin(), zero, tilt.cos());
        m.revolute("A", [ground, first.start()], a, hinge);
        m.revolute("B", [first.end(), second.start()], b, hinge);
        m.revolute("C", [second.end(), third.start()], c, tilted);
        m.revolute("D", [ground, third.end()], d, hinge);
        let rate = S::from(-0.6);
        m.prescribed_rotation("crank", [ground, first.start()], hinge, Signal::ConstantRate { offset: zero, rate });

        let speed = at(-(rate * *ab), zero);
        m.set_rigid_motion(&first.nodes, a, Vector3::zeros(), hinge * rate);
        m.set_rigid_motion(&second.nodes, b, speed, Vector3::zeros());
        m.set_rigid_motion(&third.nodes, d, Vector3::zeros(), hinge * (rate * *ab / *cd));

        let peak = |sharpness| Over::smooth_maximum(sharpness);
        m.section_functional("largest moment at mid-span of AB", peak(0.2), &first, 0.5, SectionMeasure::Force(4));
        m.section_functional("axial force at mid-span of AB", Over::Terminal, &first, 0.5, SectionMeasure::Force(0));
        m.section_functional("torsion at mid-span of AB", Over::Terminal, &first, 0.5, SectionMeasure::Force(3));
        m.section_functional(
            "moment about the hinges at mid-span of AB",
            Over::Terminal,
            &first,
            0.5,
            SectionMeasure::Force(5),
        );
        m.joint_angle_functional("angle at D", Over::Terminal, [ground, third.end()], hinge);
        m.position_functional("z of C", Over::Terminal, third.start(), c, hinge);
        Ok(())
    }
}
