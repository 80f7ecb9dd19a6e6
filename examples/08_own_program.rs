//! A program of one's own: two scenes with the whole command line, in one line of `main`.
//!
//! A point mass on a spring, released level with the pivot, as one pendulum or with a second one below it. The stiffness that brings the
//! lowest mass to a target is found by `optimize`. Other commands: `list two-springs`, `run one-spring`, `optimize one-spring`, `--help`.
//! Run: `cargo run --release --example 08_own_program -- gradient two-springs --check --out target/two-springs`

use costate::prelude::*;
use std::process::ExitCode;

/// Springs in a row, from the pivot to the last mass.
struct Springs {
    name: &'static str,
    count: usize,
}

impl Scene for Springs {
    fn name(&self) -> String {
        self.name.into()
    }
    fn summary(&self) -> String {
        format!("{} kg on springs, released level with the pivot", self.count)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("stiffness", 400.0, (50.0, 5000.0), "N/m"),
            DesignVariable::new("rest length", 0.5, (0.1, 2.0), "m"),
            DesignVariable::new("mass", 1.0, (0.1, 10.0), "kg"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(2.0, 400)
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        Some(OptimizationProblem::minimize("distance from the target").varying(&["stiffness", "rest length"]))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [stiffness, rest_length, mass] = x else { return Err(format!("3 variables expected, {} given", x.len())) };
        let (mut node, mut place) = (m.ground(), Vector3::zeros());
        for number in 1..=self.count {
            let next = place + Vector3::new(*rest_length, S::zero(), S::zero());
            let below = m.point(&format!("mass {number}"), next);
            m.point_mass(&format!("mass {number}"), below, *mass);
            m.line_spring(&format!("spring {number}"), [node, below], [place, next], *stiffness, *rest_length);
            (node, place) = (below, next);
        }
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        let target = Vector3::from_f64([-0.3, -0.8, 0.0]);
        m.target_functional("distance from the target", Over::Terminal, node, place, target);
        Ok(())
    }
}

fn main() -> ExitCode {
    costate_cli::main(&[&Springs { name: "one-spring", count: 1 }, &Springs { name: "two-springs", count: 2 }])
}
