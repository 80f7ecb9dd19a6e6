//! The page of a run that a program made.

use super::{Page, Shown};
use crate::influences::gradients;
use crate::measured_modes::MeasuredModes;
use crate::measured_moments::MeasuredMoments;
use crate::part_sensitivities::PartSensitivities;
use crate::simulation::energy_in_words;
use costate::integrators::RunError;
use costate::scenes::Run;

/// The page that `costate run` and `costate gradient` write, of a run that a program made, without the balance of energies, which they add up
/// while it goes on; it is whole in itself and needs no network.
pub struct RunReport<'r> {
    /// What is shown.
    pub run: &'r Run<'r>,
    /// Whether derivatives of its functionals are shown, too: tables, bars, colours of the parts.
    pub with_gradient: bool,
    /// Sentences that a reader must not miss.
    pub warnings: Vec<String>,
    /// Why the run stopped before its end, if it did: what is shown are its finished steps.
    pub stopped: Option<String>,
}

impl RunReport<'_> {
    /// The page as HTML.
    ///
    /// # Errors
    /// A run that kept no steps; for derivatives one that stopped before its end, and those of
    /// [`Analysis::adjoint`](costate::sensitivity::Analysis::adjoint).
    pub fn html(&self) -> Result<String, RunError> {
        let Run { prepared, forward } = self.run;
        if self.with_gradient && self.stopped.is_some() {
            return Err(RunError::Input("a run that stopped before its end has no derivatives".into()));
        }
        let mut measured = MeasuredMoments::new(prepared);
        prepared.analysis().for_each_sample(forward, |sample| measured.add(sample))?;
        let measured = measured.finish();
        let warnings = [&self.warnings[..], &energy_in_words(measured.energy)].concat();
        let stopped = self.stopped.as_deref();
        let shown = Shown { forward, measured: &measured, start: None, balance: None, warnings, stopped };
        let what = if self.with_gradient { "simulation and gradient" } else { "simulation" };
        let mut page = Page::new(prepared.scene, what).with_simulation(prepared, &shown);
        let mut modes = MeasuredModes::of(prepared)?;
        if self.with_gradient {
            modes.differentiate(prepared)?;
        }
        modes.summary(prepared).show(&mut page);
        if self.with_gradient {
            self.add_gradient(&mut page)?;
        } else {
            page.design(&prepared.variables, &prepared.x);
        }
        Ok(page.html())
    }

    fn add_gradient(&self, page: &mut Page) -> Result<(), RunError> {
        let Run { prepared, forward } = self.run;
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let parts = PartSensitivities::of(prepared, true, false);
        let (gradient, by_parameters) = match parts.asked.is_empty() {
            true => (analysis.adjoint(x, forward)?, Vec::new()),
            false => analysis.adjoint_by_parameters(x, forward, &parts.asked)?,
        };
        parts.colour(prepared, &by_parameters, page);
        gradients(prepared, &forward.values, &gradient.rows, None).show(page);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::scenes::{Prepared, built_in};

    #[test]
    fn a_run_has_the_page_of_the_command_line_without_its_command() {
        let prepared = Prepared::new(built_in::named("pendulum").unwrap()).unwrap();
        let run = prepared.run().unwrap();
        let of = |with_gradient, stopped: Option<&str>| {
            let (warnings, stopped) = (vec!["a doubt".to_string()], stopped.map(String::from));
            RunReport { run: &run, with_gradient, warnings, stopped }.html()
        };
        let page = of(true, None).unwrap();
        for part in ["a doubt", "Gradient of ", "\"space\":", "\"Histories\""] {
            assert!(page.contains(part), "{part}");
        }
        assert!(!page.contains("\"command\":"));
        assert!(of(false, Some("enough")).unwrap().contains("enough; what is shown are the finished steps"));
        assert!(of(true, Some("enough")).unwrap_err().to_string().contains("no derivatives"));
    }
}
