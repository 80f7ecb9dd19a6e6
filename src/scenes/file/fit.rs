//! What a scene is fitted to, by its measurements and what [fit] says.

use super::fields::{Columns, Fields, Item, Value};
use super::keys::one_form;
use super::scene::RunEntries;
use crate::design::{DesignVariable, shortest};
use crate::elements::entries::{Forms, Range, Type, at_least, may, need};
use crate::scenes::{FitProblem, Loss, Measurement, Prior};
use Range::{Any, Positive};

const PRIOR: Forms = one_form![
    need("variable", Type::Text, "name of the design variable"),
    need("mean", Type::Fixed("unit", Any), "what it is expected to be"),
    need("deviation", Type::Fixed("unit", Positive), "standard deviation of that"),
];

/// The keys of [fit].
pub(super) const FIT: Forms = one_form![
    may("varying", at_least(1, &Type::Text), "names of the design variables that may change, as they are listed; all"),
    may(
        "loss",
        Type::Choice(&[Loss::Linear.name(), Loss::Huber.name(), Loss::SoftL1.name(), Loss::Cauchy.name()]),
        "what residuals cost, by their squares in units of deviations, as SciPy names and defines it: the last three keep outliers from pulling as \
         far as their squares would; linear"
    ),
    may("prior", at_least(0, &Type::Table(&PRIOR)), "what is known of design variables beside the measurements"),
];

impl RunEntries<'_> {
    /// Measurements of these functionals.
    pub(super) fn fit(&mut self, variables: &[DesignVariable], functionals: &[String]) -> Option<FitProblem> {
        let contents = self.contents;
        let names: Vec<String> = variables.iter().map(|variable| variable.name.clone()).collect();
        let items = contents.items.iter().filter(|item| item.section.name == "measurement");
        let measurements: Vec<Measurement> = items.filter_map(|item| self.measurement(item, &names, functionals)).collect();
        let mut problem = FitProblem { measurements, ..FitProblem::default() };
        if let Some(fields) = self.single("fit") {
            problem.varying = self.varying(fields, &names);
            let loss = Loss::ALL.into_iter().find(|own| fields.text("loss") == Some(own.name()));
            problem.loss = loss.unwrap_or_default();
            for own in fields.tables("prior") {
                let variable = own.text("variable").unwrap_or_default().to_string();
                self.check("design variable", own.place("variable"), &variable, &names);
                let (mean, deviation) = (own.fixed("mean").unwrap_or_default(), own.fixed("deviation").unwrap_or(1.0));
                problem.priors.push(Prior { variable, mean, deviation });
            }
            if problem.measurements.is_empty() && self.mistakes.is_empty() {
                self.wrong(fields.at, "[fit] needs a [[measurement]]: what was measured, to which the scene is fitted");
            }
        }
        (!problem.measurements.is_empty()).then_some(problem)
    }

    fn measurement(&mut self, item: &Item, names: &[String], functionals: &[String]) -> Option<Measurement> {
        let Item { name, fields, .. } = item;
        let functional = fields.text("functional").unwrap_or_default().to_string();
        self.check("functional", fields.place("functional"), &functional, functionals);
        let delay = fields.text("delay").map(String::from);
        delay.iter().for_each(|own| self.check("design variable", fields.place("delay"), own, names));
        fields.has("columns");
        let Some((at, Value::Columns(columns))) = fields.get("file") else { return None };
        let Columns { numbers, units } = &**columns;
        if let Some(unit) = units[0].as_ref().filter(|unit| *unit != "s") {
            self.wrong(at, format!("times of the measurement \"{name}\" are in {unit}: write them in s"));
        }
        let (times, values) = (numbers[0].clone(), numbers[1].clone());
        let deviations = self.deviations(fields, numbers);
        Some(Measurement { name: name.clone(), functional, unit: units[1].clone(), times, values, deviations, delay })
    }

    /// Those of a column, or one for all.
    fn deviations(&mut self, fields: &Fields, numbers: &[Vec<f64>]) -> Option<Vec<f64>> {
        let (given, own) = (fields.fixed("deviation"), numbers.get(2));
        if let (Some(_), Some(_)) = (given, own) {
            self.wrong(fields.place("deviation"), "a measurement has deviation or deviations: leave one of them out");
        }
        if let Some(row) = own.and_then(|own| own.iter().position(|deviation| *deviation <= 0.0)) {
            let [t, deviation] = [&numbers[0], &numbers[2]].map(|column| shortest(column[row]));
            let text = format!("the deviation at t = {t} s is {deviation}; each must be greater than 0");
            self.wrong(fields.place("deviations"), text);
        }
        fields.has("deviations");
        own.cloned().or_else(|| given.map(|one| vec![one; numbers[0].len()]))
    }
}
