//! What commands have in common to say on a page.

use super::{Clip, Page};
use crate::console::{brief, json_number, long_number, relative_effect};
use crate::energy_balance::EnergyBalance;
use crate::io::{Chart, number};
use crate::measured_moments::EnergyCourse;
use crate::motions::view;
use crate::projected_start::ProjectedStart;
use crate::snapshot::Snapshot;
use crate::stability::{Statement, statement};
use costate::design::DesignVariable;
use costate::functionals::{Extreme, Extremes, Functional};
use costate::integrators::{NewtonTolerance, StepError};
use costate::scenes::Prepared;
use costate::sensitivity::Forward;
use serde_json::{Value, json};

/// A gradient with what it was compared with beside it, if that was asked for: of each functional by each variable.
pub struct GradientRows<'g> {
    /// Values of the functionals.
    pub values: &'g [f64],
    /// By the adjoint.
    pub adjoint: &'g [Vec<f64>],
    /// In which other way, by that, and relative differences.
    pub check: Option<(&'g str, [&'g [Vec<f64>]; 2])>,
    /// The verdict in words.
    pub verdict: String,
}

/// What a page shows of a simulation.
pub struct Shown<'s> {
    /// Its steps and functionals.
    pub forward: &'s Forward,
    /// What a projection of the start changed.
    pub start: Option<&'s ProjectedStart>,
    /// How the energy changed, where it should be constant.
    pub energy: Option<EnergyCourse>,
    /// Its balance, where it should not.
    pub balance: Option<EnergyBalance>,
    /// The moments that are shown.
    pub moments: &'s [Snapshot],
    /// Histories.
    pub charts: &'s [Chart],
    /// What speaks against it.
    pub warnings: Vec<String>,
    /// Why it stopped before its end.
    pub stopped: Option<&'s str>,
}

impl Page {
    /// All that a simulation gave, before what others add to it.
    #[must_use]
    pub fn with_simulation(mut self, prepared: &Prepared, simulation: &Shown) -> Self {
        self.simulation(prepared, simulation);
        self.functionals(prepared, simulation);
        self.motion(prepared, simulation.moments);
        self.charts("Histories", simulation.charts);
        if let Some(rows) = simulation.start.map(ProjectedStart::rows).filter(|rows| !rows.is_empty()) {
            self.table("What the projection of the start changed", &["part", "", "given", "used", "unit"], rows);
        }
        self
    }

    /// The motion in space.
    pub fn motion(&mut self, prepared: &Prepared, moments: &[Snapshot]) {
        let Some(view) = view(prepared, moments) else { return };
        let moments = moments.iter().map(|moment| (moment.t, &moment.q[..])).collect();
        let clip = Clip { name: "motion".into(), swings: false, moments };
        self.space(&prepared.mechanism.solids(), view, &[clip]);
    }

    /// How a scene was integrated, and how well.
    fn simulation(&mut self, prepared: &Prepared, simulation: &Shown) {
        let end = prepared.grid.times[prepared.grid.steps()];
        let is_static = prepared.method.table.is_static();
        self.fact("method", prepared.method.table.name.to_string());
        if !is_static {
            self.fact("constraints", format!("{} level", prepared.method.constraint_level().name()));
        }
        if prepared.method.tolerance != NewtonTolerance::RoundOff {
            self.fact("Newton's method", format!("by the rule \"{}\"", prepared.method.tolerance.name()));
        }
        let steps = simulation.forward.history.steps();
        match prepared.control {
            Some(control) if !is_static => {
                self.fact("steps", format!("{steps}, chosen for a tolerance of {:e}", control.coordinates.relative));
            }
            _ => self.fact("steps", steps.to_string()),
        }
        self.fact(
            if is_static { "load factor" } else { "duration" },
            if is_static { number(end) } else { format!("{} s", number(end)) },
        );
        if let Some(StepError { share, t, in_velocity, .. }) = simulation.forward.error {
            let of = if in_velocity { "largest velocity" } else { "model's length" };
            self.fact("estimated error of a step", format!("at most {share:.1e} of the {of}, at t = {} s", number(t)));
        }
        if let Some([(growth, _), (loss, _)]) = simulation.energy.map(|energy| energy.shares()) {
            let changes = [("grows", growth), ("falls", loss)].into_iter().filter(|(_, share)| *share > 0.0);
            let changes: Vec<_> = changes.map(|(word, share)| format!("{word} by up to {share:.1e}")).collect();
            let words = match changes.is_empty() {
                true => "is constant".into(),
                false => format!("{} of the largest kinetic energy", changes.join(", ")),
            };
            self.fact("energy", words);
        }
        if let Some(balance) = &simulation.balance {
            self.fact("balance", balance.in_words());
        }
        if let Some(Statement::Stable(words)) = statement(prepared, simulation.forward) {
            self.fact("stability", words);
        }
        simulation.warnings.iter().for_each(|warning| self.warning(warning));
        if let Some(why) = simulation.stopped {
            self.warning(format!("{why}; what is shown are the finished steps"));
        }
    }

    /// Values of the functionals, if the run came to its end.
    fn functionals(&mut self, prepared: &Prepared, simulation: &Shown) {
        if simulation.stopped.is_some() || prepared.functionals().is_empty() {
            return;
        }
        let row = |((functional, &value), extremes): ((&Functional, &f64), &Option<Extremes>)| {
            let mut row = vec![json!(functional.name), json!(long_number(value).trim()), json!(functional.value_unit())];
            if let Some(Extremes { smallest, largest }) = extremes {
                for Extreme { value, t, element } in [largest, smallest] {
                    row.extend([json_number(*value), json_number(*t), json!(element)]);
                }
                row.push(json!(functional.unit));
            }
            row
        };
        let Forward { values, extremes, .. } = simulation.forward;
        let rows = prepared.functionals().iter().zip(values).zip(extremes).map(row).collect();
        let names = ["functional", "value", "unit", "true largest", "at [s]", "in", "true smallest", "at [s]", "in", "unit"];
        let has_aggregates = extremes.iter().any(Option::is_some);
        self.table("Functionals", if has_aggregates { &names } else { &names[..3] }, rows);
    }

    /// Design variables, where there is no gradient that shows them.
    pub fn design(&mut self, variables: &[DesignVariable], x: &[f64]) {
        let row = |(variable, &x): (&DesignVariable, &f64)| {
            let [lower, upper] = [variable.lower, variable.upper].map(json_number);
            vec![json!(variable.name), json_number(x), lower, upper, json!(variable.unit)]
        };
        if !variables.is_empty() {
            let rows = variables.iter().zip(x).map(row).collect();
            self.table("Design variables", &["variable", "value", "from", "to", "unit"], rows);
        }
    }

    /// What changes something with a name, a unit and a value: its derivatives.
    pub fn influences(
        &mut self,
        (name, unit, value): (&str, &str, f64),
        prepared: &Prepared,
        derivatives: &[f64],
        check: Option<(&str, [&[f64]; 2])>,
    ) {
        let mut columns = vec!["variable", "value", "unit", "adjoint"];
        columns.extend(check.iter().flat_map(|(way, _)| [*way, "difference"]));
        let row = |(i, (variable, &x)): (usize, (&DesignVariable, &f64))| -> Vec<Value> {
            let mut row = vec![json!(variable.name), json_number(x), json!(variable.unit)];
            row.push(json!(long_number(derivatives[i]).trim()));
            if let Some((_, [other, differences])) = check {
                row.push(json!(long_number(other[i]).trim()));
                row.push(json!(brief(differences[i])));
            }
            row
        };
        let rows = prepared.variables.iter().zip(&prepared.x).enumerate().map(row).collect();
        self.table(&format!("Gradient of {name} [{unit} / unit of the variable]"), &columns, rows);
        let bar = |((variable, &x), &derivative): ((&DesignVariable, &f64), &f64)| {
            (variable.name.clone(), relative_effect(x, derivative, value).unwrap_or(f64::NAN))
        };
        let bars: Vec<_> = prepared.variables.iter().zip(&prepared.x).zip(derivatives).map(bar).collect();
        let label = "relative change by a relative change of a variable, x / f df/dx; none of a variable that is 0";
        self.bars(&format!("What changes {name}"), label, &bars);
    }

    /// Derivatives of the functionals by the variables.
    pub fn gradient(&mut self, prepared: &Prepared, gradient: &GradientRows) {
        for (k, functional) in prepared.functionals().iter().enumerate() {
            let check = gradient.check.map(|(way, [other, differences])| (way, [&other[k][..], &differences[k][..]]));
            let of = (functional.name.as_str(), functional.value_unit(), gradient.values[k]);
            self.influences((of.0, &of.1, of.2), prepared, &gradient.adjoint[k], check);
        }
        if !gradient.verdict.is_empty() {
            self.fact("gradient", gradient.verdict.clone());
        }
    }
}
