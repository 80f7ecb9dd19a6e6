//! What is right, what is an error, and that nothing is wrong without a word.

mod cantilever;
mod elastica;
mod mechanisms;
mod random_mechanism;
mod slender;

use crate::verification::{Report, Study};

/// The study.
pub struct Robustness;

impl Study for Robustness {
    fn name(&self) -> &'static str {
        "robustness"
    }
    fn summary(&self) -> &'static str {
        "slender beams and mechanisms drawn by lot: every result is right, or an error"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        slender::statics(report)?;
        slender::dynamics(report)?;
        mechanisms::count(report, if report.is_long() { 10_000 } else { 500 });
        Ok(())
    }
}
