//! The library for Python: scenes, runs and gradients as objects with numpy arrays, and parts whose formulas Python has
//! recorded.

mod checks;
mod doubts;
mod errors;
mod interrupt;
mod parts;
mod run;
mod scene;
mod tape;

use pyo3::prelude::*;

/// The JSON schema of scene files with parts of one's own, of which the builder is made.
#[pyfunction]
#[pyo3(signature = (parts = Vec::new()))]
fn schema(py: Python<'_>, parts: Vec<String>) -> PyResult<String> {
    let made = || Ok(costate::scenes::file::schema(&parts::own_parts(&parts)?).to_string());
    py.detach(|| errors::guarded(made))
}

#[pymodule]
fn _costate(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<run::Run>()?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(checks::check_part, module)?)
}
