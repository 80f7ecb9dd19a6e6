//! Machines for which no code is made.

use crate::listing::Listing;

/// Machine code of a listing: none exists here.
#[derive(Debug)]
pub enum NativeCode {}

impl NativeCode {
    /// None on this machine.
    pub fn compile(_listing: &Listing, _lanes: usize) -> Option<Self> {
        None
    }

    /// Number of sections.
    pub fn sections(&self) -> usize {
        match *self {}
    }

    /// Executes one section.
    pub fn run_section(&self, _section: usize, _inputs: &[f64], _outputs: &mut [f64], _scratch: &mut Vec<f64>) {
        match *self {}
    }
}
