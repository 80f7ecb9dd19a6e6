//! Mechanisms as systems of equations: constraints, steps, equilibria, vibrations, gradients, optimization.

mod aggregates;
mod breakpoints;
mod dead_points;
mod elimination;
mod events;
mod foreign_parts;
mod frequencies;
mod friction;
mod located;
mod massless;
mod natural;
mod nonholonomic;
mod optimize;
mod over_time;
mod programs;
mod redundancy;
mod round_off;
mod scalar_laws;
mod soft_contacts;
mod solvers;
mod stability;
mod statics;
mod steps;
#[path = "../support/mod.rs"]
mod support;
mod switches;
mod threads;
mod variational;

use costate::scenes::FileScene;

/// A text as a scene.
fn parsed(text: &str) -> FileScene {
    FileScene::parse("scene.toml", text).unwrap_or_else(|why| panic!("{why}"))
}
