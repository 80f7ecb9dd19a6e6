//! The listed integrators. A new one is a function in one of these files and a line in [`tables`].

mod bdf;
mod dirk;
mod esdirk;
mod newmark;
mod statics;

use super::{Butcher, Table};

/// Name of the table used when none is given: full order under constraints and with stiff members.
pub const DEFAULT_TABLE: &str = "esdirk4";

/// Name of the table of equilibria, which is not among those of motions.
pub const STATIC_TABLE: &str = "static";

/// All integrators of motions.
pub fn tables() -> Vec<Table> {
    use {bdf::bdf, dirk::*, esdirk::*, newmark::*};
    let tableaus = [midpoint(), dirk2(), dirk3(), sdirk2(), sdirk3(), sdirk4(), esdirk3(), esdirk4(), esdirk5()];
    let others = [newmark(), generalized_alpha("generalized-alpha", DEFAULT_RADIUS), bdf(1), bdf(2), bdf(3)];
    tableaus.into_iter().map(Butcher::into_table).chain(others).collect()
}

/// The integrator with a given name, `static` included; `generalized-alpha:0.6` is generalized-alpha with that spectral radius.
///
/// # Errors
/// In words: a spectral radius that is no number from 0 to 1. An unknown name is `None`.
pub fn table_named(name: &str) -> Result<Option<Table>, String> {
    let Some(("generalized-alpha", radius)) = name.split_once(':') else {
        return Ok(tables().into_iter().chain([statics::statics()]).find(|table| table.name == name));
    };
    match radius.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(Some(newmark::generalized_alpha(name, value))),
        _ => Err(format!("the spectral radius of \"{name}\" must be a number from 0 to 1, as in generalized-alpha:0.6")),
    }
}

/// The integrator with a given name, if there is one: see [`table_named`].
pub fn table_by_name(name: &str) -> Option<Table> {
    table_named(name).ok().flatten()
}
