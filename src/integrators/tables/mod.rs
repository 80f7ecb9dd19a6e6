//! The listed integrators. A new one is a function in one of these files and a line in [`tables`].

mod bdf;
mod dirk;
mod esdirk;
mod newmark;
mod statics;
mod variational;

use super::{Butcher, Table};

/// Name of the table used when none is given: full order under constraints and with stiff members.
pub const DEFAULT_TABLE: &str = "esdirk4";

/// Name of the table of equilibria, which is not among those of motions.
pub const STATIC_TABLE: &str = "static";

/// All integrators of motions that solve the equations of motion at their stages.
pub fn tables() -> Vec<Table> {
    use {bdf::bdf, dirk::*, esdirk::*, newmark::*};
    let tableaus = [midpoint(), dirk2(), dirk3(), sdirk2(), sdirk3(), sdirk4(), esdirk3(), esdirk4(), esdirk5()];
    let others = [newmark(), generalized_alpha("generalized-alpha", DEFAULT_RADIUS), bdf(1), bdf(2), bdf(3)];
    tableaus.into_iter().map(Butcher::into_table).chain(others).collect()
}

/// Names of all that [`table_named`] knows without a number behind them.
pub fn table_names() -> Vec<String> {
    let others = [variational::NAME, STATIC_TABLE].map(String::from);
    tables().into_iter().map(|table| table.name).chain(others).collect()
}

/// The integrator with a given name, `static` included; `generalized-alpha:0.6` is generalized-alpha with that spectral radius,
/// `variational:0.6` the variational integrator with its quadrature point there.
///
/// # Errors
/// In words: a spectral radius that is no number from 0 to 1. An unknown name is `None`.
pub fn table_named(name: &str) -> Result<Option<Table>, String> {
    let (kind, make): (_, fn(&str, f64) -> Table) = match name.split_once(':') {
        Some(("generalized-alpha", _)) => ("spectral radius", newmark::generalized_alpha),
        Some(("variational", _)) => ("quadrature point", variational::variational),
        _ => {
            let others = [statics::statics(), variational::variational(variational::NAME, variational::DEFAULT_ALPHA)];
            return Ok(tables().into_iter().chain(others).find(|table| table.name == name));
        }
    };
    let number = name.split_once(':').and_then(|(_, number)| number.parse::<f64>().ok());
    match number {
        Some(value) if (0.0..=1.0).contains(&value) => Ok(Some(make(name, value))),
        _ => {
            let family = name.split(':').next().unwrap_or_default();
            Err(format!("the {kind} of \"{name}\" must be a number from 0 to 1, as in {family}:0.6"))
        }
    }
}

/// The integrator with a given name, if there is one: see [`table_named`].
pub fn table_by_name(name: &str) -> Option<Table> {
    table_named(name).ok().flatten()
}
