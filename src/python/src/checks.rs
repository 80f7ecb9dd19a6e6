//! The checks that parts of the library pass, for parts of one's own.

use crate::errors::{error, guarded};
use crate::parts::{Kind, part};
use costate::testing::{Sample, check_constraint, check_element, check_quantity};
use pyo3::prelude::*;
use std::sync::Arc;

/// Holds what is derived from the formulas of a part against other numbers, at random states with some parameters.
#[pyfunction]
pub fn check_part(py: Python<'_>, description: &str, parameters: Vec<f64>, count: usize) -> PyResult<()> {
    let check = || {
        let own = part(description)?;
        let samples = Sample::random(own.kinds(), &parameters, count);
        let agrees = match own.kind() {
            Kind::Element => check_element(&Arc::new(own.clone()), &samples),
            Kind::Constraint => check_constraint(&Arc::new(own.clone()), &samples),
            Kind::Quantity => check_quantity(own, 0, &samples),
        };
        agrees.map_err(|why| error("CheckError", why))
    };
    py.detach(|| guarded(check))
}
