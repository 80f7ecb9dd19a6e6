//! A user-written constraint: a bead on a parabolic wire z = k x^2 / 2, in the plane y = 0, under gravity.
//!
//! Only g(q, p, t) is written; reaction, velocity and acceleration level, projection and gradient follow. The speed at the
//! bottom is checked against the conservation of energy, v = sqrt(2 g z0), and its derivative with respect to k against g x0^2 / (2 v).
//! Run: `cargo run --release --example 05_user_constraint`

use costate::elements::Constraint;
use costate::prelude::*;

#[derive(Hash)]
struct ParabolicWire;
impl Constraint for ParabolicWire {
    const EQUATIONS: usize = 2;
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("curvature", "1/m")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point]
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g[0] = q[2] - p[0] * q[0] * q[0] * 0.5;
        g[1] = q[1];
    }
}

const START: f64 = 0.7;
const GRAVITY: f64 = 9.81;

struct Bead;
impl Scene for Bead {
    fn name(&self) -> String {
        "bead on a wire".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("curvature", 1.2, (0.1, 10.0), "1/m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(2.0, 4000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let start = Vector3::new(S::from(START), S::zero(), x[0] * (START * START / 2.0));
        let bead = m.point("bead", start);
        m.point_mass("bead", bead, S::from(0.3));
        m.gravity(Vector3::from_f64([0.0, 0.0, -GRAVITY]));
        m.constraint("wire", &[bead], ParabolicWire, &x[..1]);
        // released at the right, it is fastest to the left and to the right at the bottom
        let fastest = Over::smooth_maximum(1e5);
        m.velocity_functional("fastest", fastest, bead, start, Vector3::from_f64([1.0, 0.0, 0.0]));
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&Bead)?;
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x)?;
    let gradient = analysis.adjoint(&scene.x, &forward)?;
    let speed = (GRAVITY * scene.x[0]).sqrt() * START;
    let derivative = GRAVITY * START * START / (2.0 * speed);
    println!("largest speed   {:.6} m/s (energy: {speed:.6})", forward.values[0]);
    println!("d / d curvature {:.6} m2/s (energy: {derivative:.6})", gradient.rows[0][0]);
    // a smooth maximum lies below the maximum by about ln(duration / width of the peak) / sharpness
    assert!((forward.values[0] - speed).abs() < 2e-4);
    assert!((gradient.rows[0][0] - derivative).abs() < 1e-3 * derivative);
    Ok(())
}
