//! A heavy symmetric top whose geometry is designed: how far its axis nods, and the derivative with respect to where the mass sits.
//!
//! A disk of given mass and radius on a massless rod of length l, spinning on its tip; the gradient is checked by complex step, and
//! the top, released from rest of its axis, must never rise above its start.
//! Run: `cargo run --release --example 03_heavy_top`

use costate::prelude::*;

struct Top;
impl Scene for Top {
    fn name(&self) -> String {
        "disk on a rod".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("rod length", 0.15, (0.01, 1.0), "m"),
            DesignVariable::new("disk radius", 0.1, (0.01, 1.0), "m"),
            DesignVariable::new("spin", 150.0, (0.0, 500.0), "rad/s"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.5, 1000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [length, radius, spin] = x else { return Err(format!("3 variables expected, {} given", x.len())) };
        let mass = S::from(0.4);
        let axis = Vector3::from_f64([f64::sin(0.5), 0.0, f64::cos(0.5)]);
        let ground = m.ground();
        // the body's x axis is the axis of symmetry; its frame sits at the mass centre
        let centre = axis * *length;
        let disk = m.body("disk", centre, Quaternion::x_axis_to(axis));
        let (axial, lateral) = (mass * *radius * *radius * 0.5, mass * *radius * *radius * 0.25);
        m.rigid_body("disk", disk, mass, Vector3::zeros(), [axial, lateral, lateral, S::zero(), S::zero(), S::zero()]);
        m.spherical("tip", [ground, disk], Vector3::zeros());
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        // the spin axis passes through the tip, so the mass centre is at rest
        m.set_velocity(disk, Vector3::zeros(), axis * *spin);
        let up = Vector3::from_f64([0.0, 0.0, 1.0]);
        m.position_functional("mean height of the disk x time", Over::Integral, disk, centre, up);
        let highest = Over::smooth_maximum(1e4);
        m.position_functional("smooth maximum of height", highest, disk, centre, up);
        m.position_functional("height at the end", Over::Terminal, disk, centre, up);
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&Top)?;
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x)?;
    let (gradient, check) = (analysis.adjoint(&scene.x, &forward)?, analysis.complex_step(&scene.x, &forward)?);
    for (k, functional) in scene.functionals().iter().enumerate() {
        println!("{} = {:.9}", functional.name, forward.values[k]);
        for (variable, derivative) in scene.variables.iter().zip(&gradient.rows[k]) {
            println!("    d / d {:<12} {derivative:>16.9e}", variable.name);
        }
        let difference = largest_difference(&check.rows[k], &gradient.rows[k]);
        println!("    largest difference to complex step: {difference:.1e}");
        assert!(difference < 1e-12);
    }
    let start = 0.15 * f64::cos(0.5);
    assert!(forward.values[1] <= start + 1e-9, "a top released at rest never rises above its start");
    Ok(())
}
