//! The built-in five-bar mechanism: psi = integral of |P2(t) - P2(0)|^2 over 5 s, and its gradient with respect to springs.
//!
//! Compared with numbers computed independently by complex step: psi = 58.6382104668, d psi / d (L01, k1, c) = 32.7579734,
//! 0.0882896650, 1.01503782. Run: `cargo run --release --example 04_five_bar`

use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};

fn main() -> Result<(), RunError> {
    let reference = [("L01", 32.757_973_4), ("k1", 0.088_289_665_0), ("c", 1.015_037_82)];
    let five_bar = built_in::named("five-bar")?;
    let settings = Settings { steps: 1000, ..five_bar.settings() };
    let x: Vec<f64> = five_bar.variables().iter().map(|variable| variable.initial).collect();
    let scene = Prepared::with(five_bar, &x, Prepared::method_of(&settings)?, settings)?;
    let analysis = scene.analysis();
    let forward = analysis.forward(&x)?;
    let gradient = analysis.adjoint(&x, &forward)?;
    println!("psi = {:.7}", forward.values[0]);
    assert!((forward.values[0] - 58.638_210_466_8).abs() < 1e-5);
    for (name, expected) in reference {
        let index = scene.variables.iter().position(|variable| variable.name == name).unwrap_or_default();
        let derivative = gradient.rows[0][index];
        println!("d psi / d {name:<3} = {derivative:.7} (independently: {expected})");
        assert!((derivative - expected).abs() < 1e-6 * expected);
    }
    Ok(())
}
