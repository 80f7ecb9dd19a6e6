//! A flexible arm with a tip mass, swung by a hinge: the gradient of the largest stress at its root.
//!
//! A geometrically exact beam of four elements, its section a rectangle of width b (across the plane) and height h of one material,
//! on a hinge that turns by 60 degrees in 0.8 s along a smooth ramp. Stress of the outer fibre at the root, with strains of the section,
//!
//! sigma = E (gamma1 - 1 + x3 kappa2 - x2 kappa3),   x2 = h / 2,   f = smooth maximum over time of sigma.
//!
//! Checked: adjoint against complex step, and the scale of the model: with E and rho times s both, the motion is the same if the tip mass
//! and the viscosity of the material, eta E, are scaled too, and stresses grow by s: E f_E + rho f_rho + m f_m = f.
//! Run: `cargo run --release --example 07_beams`

use costate::elements::flexible::section::Shape;
use costate::elements::flexible::{Material, Section};
use costate::prelude::*;
use costate::scenes::BeamLine;

const ELEMENTS: usize = 4;
const POISSON: f64 = 0.3;
/// Stress of the sharpest peaks that the smooth maximum resolves [N/m2].
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
        let [along, lateral, hinge] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::<S>::from_f64);
        let material = Material { young: *young, poisson: S::from(POISSON), density: *density };
        // section axis 2 lies in the plane of the motion: the shape's first side is along it
        let shape = Shape::rectangle(*height, *width, S::from(POISSON));
        let section = Section::of(material, shape).damped(S::from(2e-4));
        let ground = m.ground();
        let arm = m.beam("arm", BeamLine::straight([Vec3::zero(), along], ELEMENTS, lateral), &section);
        m.revolute("hinge", [ground, arm.start()], Vec3::zero(), hinge);
        let angle = [0.0, std::f64::consts::FRAC_PI_3, 0.0, 0.8].map(S::from);
        m.prescribed_rotation("drive", [ground, arm.start()], hinge, TimeFunction::SmoothRamp, &angle);
        // the last node of a beam is a body like any other
        let radius = *tip_mass * (0.02 * 0.02 * 0.4);
        let zero = S::zero();
        m.rigid_body("tip mass", arm.end(), *tip_mass, Vec3::zero(), [radius, radius, radius, zero, zero, zero]);
        let largest = Over::SmoothMaximum { sharpness: 1.0 / RESOLVED, normalized: true };
        m.fibre_stress_functional("largest root stress", largest, (&arm, 0.0), *young, [*height * 0.5, zero]);
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
        assert!(difference < 1e-12);
    }
    // a smooth maximum is sigma_max minus a constant of the resolution, so it does not scale: its slope is that of sigma at the peak
    let [_, _, young, density, tip] = &scene.x[..] else { unreachable!() };
    let row = &adjoint.rows[0];
    let grown = row[2] * young + row[3] * density + row[4] * tip;
    println!("E f_E + rho f_rho + m f_m = {grown:.6e}: stress in the mean around the peak");
    assert!(grown > forward.values[0] && grown < forward.values[0] + 10.0 * RESOLVED);
    Ok(())
}
