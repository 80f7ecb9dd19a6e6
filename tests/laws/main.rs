//! A model is its laws: what belongs together is told apart by formulas, arguments and options, not by names and numbers.

mod forward;
mod programs;
mod recorded;
