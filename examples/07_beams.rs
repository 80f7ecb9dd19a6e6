//! A flexible arm with a tip mass, swung by a hinge: the gradient of the largest stress at its root.
//!
//! A geometrically exact beam of four elements, its section a rectangle of width b (across the plane) and height h of one material,
//! on a hinge that turns by 60 degrees in 0.8 s along a smooth ramp. Stress of the outer fibre at the root, with strains of the section,
//!
//! sigma = E (gamma1 - 1 + x3 kappa2 - x2 kappa3),   x2 = h / 2,   f = smooth maximum over time of sigma.
//!
//! Checked: adjoint against complex step, and similarity: with E, rho and the tip mass m all times s the motion is the same and every stress
//! s times as large, so that E dsigma/dE + rho dsigma/drho + m dsigma/dm = sigma.
//! Run: `cargo run --release --example 07_beams`

use costate::elements::flexible::{Material, Section, Shape};
use costate::prelude::*;
use costate::scenes::BeamLine;

const ELEMENTS: usize = 4;
const POISSON: f64 = 0.3;
/// Differences of stress that the smooth maximum tells apart [N/m2].
const RESOLVED: f64 = 1e6;

struct Arm;
impl Scene for Arm {
    fn name(&self) -> String {
        "flexible arm".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("width", 0.03, (0.01, 0.1), "m"),
            DesignVariable::new("height", 0.012, (0.005, 0.05), "m"),
            DesignVariable::new("Young's modulus", 7e10, (1e10, 3e11), "N/m2"),
            DesignVariable::new("density", 2700.0, (1000.0, 9000.0), "kg/m3"),
            DesignVariable::new("tip mass", 0.4, (0.0, 2.0), "kg"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 200)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [width, height, young, density, tip_mass] = x else { return Err("5 variables".into()) };
        let [along, lateral, hinge] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector3::<S>::from_f64);
        let material = Material { young: *young, poisson: S::from(POISSON), density: *density };
        // section axis 2 lies in the plane of the motion: the shape's first side is along it
        let shape = Shape::rectangle(*height, *width, S::from(POISSON));
        let section = Section::of(material, shape).damped(S::from(2e-4));
        let ground = m.ground();
        let arm = m.beam("arm", BeamLine::straight([Vector3::zeros(), along], ELEMENTS, lateral), &section);
        m.revolute("hinge", [ground, arm.start()], Vector3::zeros(), hinge);
        let [from, to, start, duration] = [0.0, std::f64::consts::FRAC_PI_3, 0.0, 0.8].map(S::from);
        m.prescribed_rotation("drive", [ground, arm.start()], hinge, Signal::SmoothRamp { from, to, start, duration });
        // the last node of a beam is a body like any other
        let radius = *tip_mass * (0.02 * 0.02 * 0.4);
        let zero = S::zero();
        m.rigid_body("tip mass", arm.end(), *tip_mass, Vector3::zeros(), [radius, radius, radius, zero, zero, zero]);
        let largest = Over::smooth_maximum(1.0 / RESOLVED);
        let fibre = [*height * 0.5, zero];
        m.fibre_stress_functional("largest root stress", largest, (&arm, 0.0), *young, fibre);
        m.fibre_stress_functional("root stress at the end", Over::Terminal, (&arm, 0.0), *young, fibre);
        m.mass_functional("mass", Over::Terminal);
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&Arm)?;
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x)?;
    let adjoint = analysis.adjoint(&scene.x, &forward)?;
    let complex = analysis.complex_step(&scene.x, &forward)?;
    for (k, functional) in scene.functionals().iter().enumerate() {
        println!("{}: {:.9e} {}", functional.name, forward.values[k], functional.unit);
        for (i, variable) in scene.variables.iter().enumerate() {
            let [adjoint, complex] = [&adjoint, &complex].map(|gradient| gradient.rows[k][i]);
            println!("  d / d {:<16} {adjoint:>20.12e}  complex step {complex:>20.12e}", variable.name);
        }
        // relative to the largest entry of the gradient times its variable, since the variables have many units
        let scaled = |row: &[f64]| -> Vec<f64> { row.iter().zip(&scene.x).map(|(g, x)| g * x).collect() };
        let [adjoint, complex] = [&adjoint, &complex].map(|gradient| scaled(&gradient.rows[k]));
        let difference = largest_difference(&adjoint, &complex);
        println!("  largest difference {difference:.1e}");
        // strains of 1e-4 are differences from 1, which have lost four of sixteen digits
        assert!(difference < 1e-11);
    }
    let stress = forward.values[1];
    let grown: f64 = (2..5).map(|i| adjoint.rows[1][i] * scene.x[i]).sum();
    println!("E dsigma/dE + rho dsigma/drho + m dsigma/dm = {grown:.9e} N/m2, sigma = {stress:.9e} N/m2");
    assert!((grown - stress).abs() < 1e-8 * forward.values[0]);
    Ok(())
}
