//! What a program reads of a run: values, histories of functionals, nodes and joints, and derivatives, all by name.
//!
//! A slider of mass m on a horizontal rail hangs on a spring k and is pushed by a force of its own kind, a bump
//! f(t) = A (1 - cos(2 pi t / T)) / 2 while t < T: m d2x/dt2 + k x = f(t), with the rail's force m g.
//! Run: `cargo run --release --example 09_results`

use costate::prelude::*;
use std::f64::consts::TAU;

/// A bump, smooth but for its curvature, which jumps at both ends.
#[derive(Hash)]
struct Bump;

impl TimeFormula for Bump {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("size", "N"), Parameter::positive("duration", "s")];
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        let share = (t / p[1]).max(S::zero()).min(S::one());
        p[0] * (-(share * TAU).cos() + 1.0) * 0.5
    }
}

struct Slider;

impl Scene for Slider {
    fn name(&self) -> String {
        "slider".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass", 2.0, (0.1, 10.0), "kg"),
            DesignVariable::new("stiffness", 50.0, (1.0, 500.0), "N/m"),
            DesignVariable::new("push", 10.0, (0.0, 100.0), "N"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(2.0, 400)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, stiffness, push] = x else { return Err(format!("3 variables expected, {} given", x.len())) };
        let (start, along) = (Vector3::zeros(), Vector3::from_f64([1.0, 0.0, 0.0]));
        let (ground, slider) = (m.ground(), m.point("slider", start));
        m.point_mass("slider", slider, *mass);
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        m.point_on_line("rail", [ground, slider], start, along);
        let wall = Vector3::from_f64([-1.0, 0.0, 0.0]);
        m.line_spring("spring", [ground, slider], [wall, start], *stiffness, S::one());
        let size = Signal::own(Bump, &[*push, S::from(0.5)])?;
        m.force("push", Force { on: slider, point: start, direction: along, frame: LoadFrame::World, size });
        m.position_functional("place at the end", Over::Terminal, slider, start, along);
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&Slider)?;
    let run = scene.run()?;
    let (slider, rail) = (run.node("slider")?, run.joint("rail")?);

    println!("{:>8} {:>10} {:>10} {:>10}", "t [s]", "x [m]", "v [m/s]", "rail [N]");
    for k in (0..slider.times.len()).step_by(40) {
        let ([x, ..], [v, ..], [_, force, _]) = (slider.positions[k], slider.velocities[k], rail.forces[k]);
        println!("{:>8.2} {x:>10.6} {v:>10.6} {force:>10.6}", slider.times[k]);
    }
    let largest = slider.positions.iter().map(|place| place[0].abs()).fold(0.0, f64::max);
    println!("largest displacement: {largest:.6} m");

    let gradient = run.gradient()?;
    let row = &gradient.rows[scene.functional("place at the end")?];
    println!("place at the end: {:.6} m", run.value("place at the end")?);
    println!("by the stiffness: {:.9}, by the push: {:.9}", row[scene.variable("stiffness")?], row[scene.variable("push")?]);

    // the rail carries the weight, and the motion is linear in the push
    assert!(rail.forces.iter().all(|force| (force[1] - 2.0 * 9.81).abs() < 1e-9));
    let ratio = row[scene.variable("push")?] * 10.0 / run.value("place at the end")?;
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    // behind the bump x'' = -k / m x: its phase at the end is that of the exact solution
    let (rate, end) = (25.0_f64.sqrt(), 0.5);
    let free = |t: f64| {
        5.0 * ((1.0 - (rate * t).cos()) / 25.0 - ((TAU / end * t).cos() - (rate * t).cos()) / (25.0 - (TAU / end).powi(2)))
            / 2.0
    };
    let speed = |t: f64| (free(t + 1e-6) - free(t - 1e-6)) / 2e-6;
    let exact = free(end) * (rate * 1.5).cos() + speed(end) / rate * (rate * 1.5).sin();
    assert!((run.value("place at the end")? - exact).abs() < 1e-6, "{exact}");
    Ok(())
}
