//! What is right, what is an error, and that nothing is wrong without a word.

mod at_rest;
mod bifurcations;
mod cantilever;
mod dense_count;
mod elastica;
mod equilibria;
mod joins;
mod kills;
mod laws;
mod massless;
mod mutations;
mod optima;
mod slender;
mod tied;

use crate::{Form, Report, Study};
use std::time::Duration;

/// The study.
pub struct Robustness;

impl Study for Robustness {
    fn name(&self) -> &'static str {
        "robustness"
    }
    fn summary(&self) -> &'static str {
        "slender beams, bodies without mass, bifurcations, killed runs, full disks, mutated command lines and files: all right, or an error"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Long]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        slender::statics(report)?;
        slender::cables(report)?;
        slender::dynamics(report)?;
        massless::count(report);
        equilibria::count(report)?;
        bifurcations::count(report)?;
        joins::count(report);
        tied::count(report);
        laws::count(report, if report.is_long() { 2000 } else { 200 })?;
        optima::count(report)?;
        at_rest::count(report);
        kills::count(report)?;
        mutations::count(report, Duration::from_secs(if report.is_long() { 600 } else { 10 }))?;
        Ok(())
    }
}
