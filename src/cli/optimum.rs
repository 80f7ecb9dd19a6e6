//! What is said of the end of an optimization: conditions of optimality, and largest values behind smooth ones.

use super::summary::Summary;
use crate::io::{Table, cells};
use costate::design::DesignVariable;
use costate::functionals::{Extreme, Extremes};
use costate::optimize::{Conditions, DesignPoint, Ended, Optimization, Optimized};
use costate::scenes::{FunctionalConstraint, Limit};
use serde_json::{Value, json};

/// Names of the constraints, nonlinear ones first.
fn constraint_names<'o>(optimization: &'o Optimization) -> impl Iterator<Item = &'o str> {
    let problem = &optimization.problem;
    let nonlinear = problem.constraints.iter().map(|constraint| constraint.functional.as_str());
    nonlinear.chain(problem.linear.iter().map(|constraint| constraint.name.as_str()))
}

impl Summary {
    /// Adds whether and how well the conditions of optimality hold, and what is kept in the smooth sense only.
    pub fn conditions(&mut self, optimization: &Optimization, optimized: &Optimized, best: &DesignPoint) {
        if let Some(conditions) = &optimized.ended.conditions {
            let Conditions { stationarity, violation, complementarity, tolerance, allowed, .. } = conditions;
            let mut table = Table::new(&["condition of optimality, scaled", "off by", "allowed"]);
            for (name, off, allowed) in [
                ("slope of the Lagrangian where no bound holds it", *stationarity, *tolerance),
                ("largest violation of a limit", *violation, *allowed),
                ("multiplier times distance from its limit", *complementarity, *tolerance),
            ] {
                table.row(cells![name, off, allowed]);
            }
            self.table("", table);
            self.table("", multipliers(optimization, conditions, best));
        }
        self.warnings(smooth_only(optimization, optimized, best));
        self.warnings(other_events(optimized, best));
    }
}

/// That other events happen at the best design than at the first, in words.
fn other_events(optimized: &Optimized, best: &DesignPoint) -> Option<String> {
    let first = optimized.history.points.first()?.events.as_ref()?;
    let own = best.events.as_ref().filter(|own| *own != first)?;
    let counted = |all: &[String]| {
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for name in all {
            match counts.iter_mut().find(|known| known.0 == name) {
                Some(known) => known.1 += 1,
                None => counts.push((name, 1)),
            }
        }
        let words: Vec<String> = counts.iter().map(|(name, times)| format!("\"{name}\" {times}")).collect();
        if words.is_empty() { "none".to_string() } else { words.join(", ") }
    };
    let how = match [counted(own), counted(first)] {
        [own, first] if own == first => "in another order".to_string(),
        [own, first] => format!("{own} instead of {first}"),
    };
    Some(format!(
        "other events happen at the best design than at the first ({how}): where they change from one design to another, values may jump, and gradients \
         hold to one side"
    ))
}

/// Multipliers of constraints, and slopes of variables at their bounds.
fn multipliers(optimization: &Optimization, conditions: &Conditions, best: &DesignPoint) -> Table {
    let mut table = Table::new(&["", "", "multiplier or slope, scaled"]);
    for (name, multiplier) in constraint_names(optimization).zip(&conditions.multipliers) {
        table.row(cells!["limit", name, *multiplier]);
    }
    for (place, slope) in optimization.varying().into_iter().zip(&conditions.slopes) {
        let DesignVariable { name, lower, upper, .. } = &optimization.variables()[place];
        let kind = match best.design[place] {
            x if x <= *lower => "at its lower bound",
            x if x >= *upper => "at its upper bound",
            _ => continue,
        };
        table.row(cells![kind, name, *slope]);
    }
    table
}

pub fn conditions_json(optimization: &Optimization, ended: &Ended) -> Value {
    let Some(conditions) = &ended.conditions else { return Value::Null };
    let multipliers = constraint_names(optimization).zip(&conditions.multipliers);
    let multipliers: Vec<Value> =
        multipliers.map(|(name, &multiplier)| json!({"name": name, "multiplier": multiplier})).collect();
    json!({
        "hold": conditions.hold(),
        "stationarity": conditions.stationarity,
        "violation": conditions.violation,
        "complementarity": conditions.complementarity,
        "allowed": conditions.tolerance,
        "allowed_violation": conditions.allowed,
        "multipliers": multipliers,
    })
}

/// Largest and smallest values of the aggregates of the best design.
pub fn largest_json(optimized: &Optimized, best: &DesignPoint) -> Value {
    let named = optimized.history.functionals.iter().zip(&best.extremes);
    let extreme = |Extreme { value, t, element }: &Extreme| json!({"value": value, "t": t, "element": element});
    let row = |((name, _), extremes): (&(String, String), &Option<Extremes>)| {
        let Extremes { smallest, largest } = extremes.as_ref()?;
        Some(json!({"name": name, "largest": extreme(largest), "smallest": extreme(smallest)}))
    };
    named.filter_map(row).collect()
}

/// Limits that the best design keeps by a smooth maximum, while the largest value itself lies beyond them, in words.
pub fn smooth_only(optimization: &Optimization, optimized: &Optimized, best: &DesignPoint) -> Vec<String> {
    let functionals = &optimized.history.functionals;
    let over = |name: &str| optimization.aggregate(name);
    let message = |constraint: &FunctionalConstraint| {
        let Limit::AtMost(limit) = constraint.limit else { return None };
        let place = functionals.iter().position(|own| own.0 == constraint.functional)?;
        let Extremes { smallest, largest } = best.extremes.get(place)?.as_ref()?;
        let true_value = over(&constraint.functional)?.limit_value(smallest.value, largest.value);
        let allowed = limit + optimization.stopping.violation * limit.abs();
        let smooth = best.functionals[place];
        (true_value > allowed && smooth <= allowed).then(|| {
            let unit = &functionals[place].1;
            format!(
                "\"{}\" keeps its limit of {limit} {unit} in the smooth sense only ({smooth:.4e}): the largest value is {true_value:.4e} {unit} \
                 at {:.4} s, {:.1} % beyond it; take a sharper aggregate or a lower limit",
                constraint.functional,
                largest.t,
                100.0 * (true_value - limit) / limit.abs()
            )
        })
    };
    optimization.problem.constraints.iter().filter_map(message).collect()
}
