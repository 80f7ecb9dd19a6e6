//! Two rigid bodies on spherical joints, swinging in space: the gradient of where the tip ends with respect to masses and lengths.
//!
//! Checked by a Taylor test: with a right gradient the remainder f(x + s d) - f(x) - s df . d falls with the square of s.
//! Run: `cargo run --release --example 02_double_pendulum`

use costate::prelude::*;
use costate::sensitivity::TaylorTest;

struct DoublePendulum;
impl Scene for DoublePendulum {
    fn name(&self) -> String {
        "double pendulum in space".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("mass 1", 1.0, "kg"), ("length 1", 0.8, "m"), ("mass 2", 0.5, "kg"), ("length 2", 0.6, "m")]
            .map(|(name, value, unit)| DesignVariable::new(name, value, (0.1, 10.0), unit))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 200)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let directions = [[1.0, 0.0, 0.0], [0.0, 0.8, -0.6]].map(Vector3::from_f64);
        let mut from = (m.ground(), Vector3::zeros());
        for (i, direction) in directions.into_iter().enumerate() {
            let (mass, length) = (x[2 * i], x[2 * i + 1]);
            let name = format!("rod {}", i + 1);
            let rod = m.body(&name, from.1 + direction * (length * 0.5), Quaternion::x_axis_to(direction));
            // a rod of square section, a tenth as thick as long
            let (axial, lateral) = (mass * length * length / 600.0, mass * length * length * (1.01 / 12.0));
            m.rigid_body(&name, rod, mass, Vector3::zeros(), [axial, lateral, lateral, S::zero(), S::zero(), S::zero()]);
            m.spherical(&format!("joint {}", i + 1), [from.0, rod], from.1);
            from = (rod, from.1 + direction * length);
        }
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        m.position_functional("height of the tip", Over::Terminal, from.0, from.1, Vector3::from_f64([0.0, 0.0, 1.0]));
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&DoublePendulum)?;
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x)?;
    let gradient = analysis.adjoint(&scene.x, &forward)?.rows.remove(0);
    println!("height of the tip after 1 s: {:.9} m", forward.values[0]);
    for (variable, derivative) in scene.variables.iter().zip(&gradient) {
        println!("d / d {:<9} {derivative:>14.9} m/{}", variable.name, variable.unit);
    }
    let direction = [0.3, -0.2, 0.5, 0.4];
    let test = TaylorTest::run(&analysis, &forward, &scene.x, &gradient, &direction, 0, 2e-3, 5)?;
    for (step, remainder) in test.steps.iter().zip(&test.second) {
        println!("step {step:.2e}: remainder {remainder:.3e}");
    }
    let orders = test.orders();
    println!("orders of the remainder: {orders:.3?}");
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1));
    Ok(())
}
