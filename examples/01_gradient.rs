//! A user-written element and the gradient of its motion: Duffing's oscillator m a + k q + k3 q^3 = 0, released at q0.
//!
//! The functional is the integral of q over 10 s. Run: `cargo run --release --example 01_gradient`

use costate::prelude::*;

#[derive(Hash)]
struct Duffing;
impl Element for Duffing {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::positive("mass", "kg"), Parameter::new("stiffness", "N/m"), Parameter::new("cubic stiffness", "N/m3")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[0] = p[0] * s.a[0] + p[1] * s.q[0] + p[2] * s.q[0] * s.q[0] * s.q[0];
    }
}

struct Oscillator;
impl Scene for Oscillator {
    fn name(&self) -> String {
        "duffing".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let variables = [("m", 1.0, "kg"), ("k", 2.0, "N/m"), ("k3", 0.5, "N/m3"), ("q0", 1.5, "m")];
        variables.map(|(name, value, unit)| DesignVariable::new(name, value, (0.0, 10.0), unit)).to_vec()
    }
    fn settings(&self) -> Settings {
        Settings::new(10.0, 400)
    }
    fn build<S: Scalar>(&self, x: &[S], mechanism: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = mechanism.coordinates("oscillator", &x[3..], &[S::zero()]);
        mechanism.element("spring", &[node], Duffing, &x[..3]);
        mechanism.coordinate_functional("integral of q", Over::Integral, node, 0);
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&Oscillator)?;
    let run = scene.run()?;
    let gradient = run.gradient()?;
    println!("integral of q = {:.12} m s", run.value("integral of q")?);
    for (variable, derivative) in scene.variables.iter().zip(&gradient.rows[0]) {
        println!("d / d {:<3} {derivative:>20.12}", variable.name);
    }
    let check = scene.analysis().complex_step(&scene.x, &run.forward)?;
    assert!(largest_difference(&check.rows[0], &gradient.rows[0]) < 1e-12);
    Ok(())
}
