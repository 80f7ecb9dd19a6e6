//! Sentences of the library as the exceptions of `costate.errors`; a panic is one, too.

use costate::integrators::RunError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// An exception of `costate.errors` by its name.
pub fn error(class: &str, message: String) -> PyErr {
    Python::attach(|py| match py.import("costate.errors").and_then(|errors| errors.getattr(class)?.call1((&message,))) {
        Ok(own) => PyErr::from_value(own),
        Err(_) => PyRuntimeError::new_err(message),
    })
}

/// What is wrong with a scene.
pub fn scene_error(message: String) -> PyErr {
    error("SceneError", message)
}

/// What a run says: of its input, or of what happened on the way.
pub fn run_error(cause: RunError) -> PyErr {
    let class = if matches!(cause, RunError::Input(_)) { "InputError" } else { "RunError" };
    error(class, cause.to_string())
}

/// Does something in which a panic is a mistake of the library, and an exception.
pub fn guarded<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(error("InternalError", sentence(&*panic))))
}

fn sentence(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    format!("a mistake of costate, please report it: {}", text.unwrap_or("a panic without words"))
}
