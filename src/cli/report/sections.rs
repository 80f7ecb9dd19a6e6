//! What commands have in common to say on a page.

use super::{Clip, Page};
use crate::energy_balance::EnergyBalance;
use crate::io::{Table, cells, number};
use crate::measured_moments::MeasuredRun;
use crate::motions::view;
use crate::projected_start::ProjectedStart;
use crate::simulation::{error_in_words, events, functionals};
use crate::snapshot::Snapshot;
use crate::stability::{Statement, statement};
use crate::summary::Summary;
use costate::design::DesignVariable;
use costate::integrators::NewtonTolerance;
use costate::scenes::Prepared;
use costate::sensitivity::{EventTime, Forward};
use serde_json::json;

/// Most events that charts and the film show.
const MOST_EVENTS: usize = 500;

/// What a page shows of a simulation.
pub struct Shown<'s> {
    pub forward: &'s Forward,
    pub measured: &'s MeasuredRun,
    /// What a projection of the start changed.
    pub start: Option<&'s ProjectedStart>,
    /// The balance of its energy, where that is not constant.
    pub balance: Option<EnergyBalance>,
    /// What speaks against it.
    pub warnings: Vec<String>,
    /// Why it stopped before its end.
    pub stopped: Option<&'s str>,
}

impl Shown<'_> {
    /// Values of the functionals, if the run came to its end, how well the steps resolve the motion, and what speaks against it.
    pub fn summary(&self, prepared: &Prepared) -> Summary {
        let mut summary = Summary::default();
        if self.stopped.is_none() {
            summary.table("Functionals", functionals(prepared, self.forward));
            if prepared.functionals().is_empty() {
                summary.words("the scene has no functional\n");
            }
        }
        if let Some(table) = events(prepared, self.forward) {
            summary.table("Events", table);
        }
        if let Some((error, _)) = error_in_words(prepared, self.forward) {
            summary.fact("largest estimated error of a step", error);
        }
        if let Some([(growth, _), (loss, _)]) = self.measured.energy.map(|energy| energy.shares()) {
            let changes = [("grows", growth), ("falls", loss)].into_iter().filter(|(_, share)| *share > 0.0);
            let changes: Vec<_> = changes.map(|(word, share)| format!("{word} by up to {share:.1e}")).collect();
            let words = match changes.is_empty() {
                true => "is constant".into(),
                false => format!("{} of the largest kinetic energy", changes.join(", ")),
            };
            summary.fact("energy", words);
        }
        if let Some(balance) = &self.balance {
            summary.fact("balance", balance.in_words());
        }
        if let Some(Statement::Stable(words)) = statement(prepared, self.forward) {
            summary.fact("stability", words);
        }
        summary.warnings(self.warnings.iter().cloned());
        summary
    }
}

impl Page {
    /// All that a simulation gave, before what others add to it.
    #[must_use]
    pub fn with_simulation(mut self, prepared: &Prepared, simulation: &Shown) -> Self {
        let grid = if simulation.stopped.is_some() { &prepared.grid } else { &simulation.forward.grid };
        let (method, end) = (&prepared.method, grid.times[grid.steps()]);
        let is_static = method.table.is_static();
        self.fact("method", method.table.name.to_string());
        if !is_static {
            self.fact("constraints", format!("{} level", method.constraint_level().name()));
        }
        if method.tolerance != NewtonTolerance::RoundOff {
            self.fact("Newton's method", format!("by the rule \"{}\"", method.tolerance.name()));
        }
        let steps = simulation.forward.history.steps();
        match prepared.control {
            Some(control) if !is_static => {
                self.fact("steps", format!("{steps}, chosen for a tolerance of {:e}", control.coordinates.relative));
            }
            _ => self.fact("steps", steps.to_string()),
        }
        match is_static {
            true => self.fact("load factor", number(end)),
            false => self.fact("duration", format!("{} s", number(end))),
        }
        simulation.summary(prepared).show(&mut self);
        if let Some(why) = simulation.stopped {
            self.warning(format!("{why}; what is shown are the finished steps"));
        }
        for EventTime { name, t } in prepared.analysis().events(simulation.forward).into_iter().take(MOST_EVENTS) {
            self.push("events", json!({"name": name, "t": t}));
        }
        self.motion(prepared, &simulation.measured.moments);
        self.charts("Histories", &simulation.measured.charts);
        simulation.start.into_iter().for_each(|start| start.summary().show(&mut self));
        self
    }

    pub fn motion(&mut self, prepared: &Prepared, moments: &[Snapshot]) {
        let Some(view) = view(prepared, moments) else { return };
        let moments = moments.iter().map(|moment| (moment.t, &moment.q[..])).collect();
        let clip = Clip { name: "motion".into(), swings: false, moments };
        self.space(&prepared.mechanism.solids(), view, &[clip]);
    }

    /// Design variables, where there is no gradient that shows them.
    pub fn design(&mut self, variables: &[DesignVariable], x: &[f64]) {
        let mut table = Table::new(&["variable", "value", "from", "to", "unit"]);
        for (DesignVariable { name, lower, upper, unit, .. }, &x) in variables.iter().zip(x) {
            table.row(cells![name, x, *lower, *upper, *unit]);
        }
        if !variables.is_empty() {
            self.table("Design variables", &table);
        }
    }
}
