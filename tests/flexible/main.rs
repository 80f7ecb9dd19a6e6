//! Cables, shells and what is measured in them.

mod ancf;
mod beam_stress;
mod free_meshes;
mod functionals;
mod joins;
mod shell_loads;
mod shell_meshes;
mod shells;
mod ties;

/// Asserts |own - expected| <= tolerance |expected|.
#[track_caller]
fn assert_close(what: &str, own: f64, expected: f64, tolerance: f64) {
    assert!((own - expected).abs() <= tolerance * expected.abs(), "{what}: {own:e} instead of {expected:e}");
}
