//! What is right, what is an error, and that nothing is wrong without a word.

mod cantilever;
mod elastica;
mod slender;

use crate::verification::{Report, Study};

/// The study.
pub struct Robustness;

impl Study for Robustness {
    fn name(&self) -> &'static str {
        "robustness"
    }
    fn summary(&self) -> &'static str {
        "slender beams: every result is right, or an error"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        slender::statics(report)?;
        slender::dynamics(report)
    }
}
