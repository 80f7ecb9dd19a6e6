#[path = "06_andrews.rs"]
#[allow(dead_code)]
mod andrews;
use costate::history::Keep;
use costate::integrators::StepControl;
use costate::prelude::*;
use std::time::Instant;
fn main() {
    let x: Vec<f64> = andrews::NUMBERS.iter().map(|n| n.1).collect();
    let run = |table: &str, settings: Settings| {
        let method = Method::new(table_by_name(table).unwrap(), ConstraintLevel::Acceleration);
        let mut prepared = Prepared::with(&andrews::Andrews, &x, method, settings).unwrap();
        prepared.keep = Keep::Nothing;
        let analysis = prepared.analysis();
        let mut best = f64::INFINITY;
        let mut last = None;
        for _ in 0..3 {
            let start = Instant::now();
            last = Some(analysis.forward(&x).unwrap());
            best = best.min(start.elapsed().as_secs_f64());
        }
        let f = last.unwrap();
        let error = (f.values[0] - 15.810771192).abs() / 15.81;
        println!("{table} {} error {error:.1e} {:.2} ms {:?}", f.grid.times.len() - 1, best * 1e3, f.counters);
        f.values[0]
    };
    let _ = std::env::args().nth(1);
    run("esdirk5", Settings::new(0.03, 200).projecting_start());
}
