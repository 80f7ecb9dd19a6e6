//! Slender cantilevers under a load across the tip: equilibria, and the motion after the load was let on.

use super::cantilever::{Line, SlenderCantilever};
use super::dense_count::{Told, compare};
use super::elastica;
use crate::Report;
use costate::integrators::{StepControl, Verdict};
use costate::prelude::*;
use costate::scenes::Prepared;
use costate::sensitivity::Forward;

/// EA L2/EI.
const AXIAL_STIFFNESSES: [f64; 4] = [1e7, 1e8, 1e9, 1e10];
/// P L2/EI of the loads of motions: the first quarter of a period, and far beyond a right angle.
const LOADS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// Integrators.
const METHODS: [&str; 3] = ["esdirk4", "bdf2", "generalized-alpha"];
/// Distance of the tip that steps of 10 ms may leave, of a method of second order under the largest load [m].
const MOTION: f64 = 1e-2;

/// How a run ends.
#[derive(Default)]
struct Outcomes {
    right: usize,
    wrong: usize,
    errors: usize,
    largest: f64,
}

impl Outcomes {
    /// A run that ended with the tip at a place, or with an error.
    fn judge(&mut self, tip: Result<[f64; 2], String>, reference: [f64; 2], tolerance: f64) {
        match tip {
            Err(_) => self.errors += 1,
            Ok([x, y]) => {
                let off = (x - reference[0]).hypot(y - reference[1]);
                self.largest = self.largest.max(off);
                // written so that a NaN is wrong
                if off <= tolerance { self.right += 1 } else { self.wrong += 1 }
            }
        }
    }
    fn add(&mut self, other: &Outcomes) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.errors += other.errors;
    }
    fn report(&self, report: &mut Report, name: &str) {
        report.at_most(format!("{name}/wrong"), self.wrong as f64, 0.0);
        report.inform(format!("{name}/errors"), self.errors as f64);
        report.inform(format!("{name}/largest distance of the tip [m]"), self.largest);
    }
    fn report_all(&self, report: &mut Report, name: &str) {
        let all = (self.right + self.wrong + self.errors) as f64;
        report.inform(format!("{name}/runs"), all);
        report.compare(format!("{name}/right, share"), self.right as f64 / all, 1.0, 0.05);
        report.inform(format!("{name}/errors"), self.errors as f64);
        report.at_most(format!("{name}/wrong"), self.wrong as f64, 0.0);
    }
}

/// Runs to the end, and where the tip is then.
fn tip_of(scene: &SlenderCantilever) -> Result<[f64; 2], String> {
    end_of(scene).map(|(_, forward)| [forward.values[0], forward.values[1]])
}

fn end_of(scene: &SlenderCantilever) -> Result<(Prepared<'_>, Forward), String> {
    let prepared = Prepared::new(scene).map_err(|error| error.to_string())?;
    let forward = prepared.analysis().forward(&[scene.load]).map_err(|error| error.to_string())?;
    Ok((prepared, forward))
}

/// Runs with given load steps, with steps that are divided, and with steps that the solver chooses.
fn ways() -> Vec<(String, Settings)> {
    let mut list = Vec::new();
    for steps in [5, 20, 100] {
        list.push((format!("{steps} steps"), Settings::statics(steps)));
        list.push((format!("{steps} steps, divided"), Settings::statics(steps).dividing_steps()));
    }
    list.push(("chosen steps".into(), Settings::statics(10).choosing_steps(StepControl::new(1e-6))));
    list
}

/// Equilibria.
pub fn statics(report: &mut Report) -> Result<(), String> {
    let mut total = Outcomes::default();
    for axial in AXIAL_STIFFNESSES {
        for (elements, tolerance) in [(8, 3e-4), (32, 2e-6)] {
            for (way, settings) in ways() {
                let mut own = Outcomes::default();
                for load in 1..=10 {
                    let load = f64::from(load);
                    let (line, settings, sudden) = (Line::Beam, settings.clone(), false);
                    let scene = SlenderCantilever { line, axial, load, elements, settings, sudden };
                    own.judge(tip_of(&scene), elastica::tip(load), tolerance);
                }
                own.report(report, &format!("statics/EA {axial:.0e}, {elements} elements/{way}"));
                total.add(&own);
            }
        }
    }
    total.report_all(report, "statics");
    Ok(())
}

/// Equilibria of cables: nine loads of 1 to 9, with the error that a mesh of cubics makes of their bending; what is said of their stability,
/// against a dense eigensolver.
pub fn cables(report: &mut Report) -> Result<(), String> {
    let mut total = Outcomes::default();
    let (mut told, mut unstable) = ([0.0; 4], [0.0; 2]);
    for line in [Line::Cable, Line::SmallStrainCable] {
        for axial in [1e6, 1e8, 1e10] {
            for (elements, tolerance) in [(8, 1e-2), (32, 5e-4)] {
                let mut own = Outcomes::default();
                let ways = ways();
                for (place, load) in (1..10).map(f64::from).enumerate() {
                    let (_, settings) = &ways[place % ways.len()];
                    let (settings, sudden) = (settings.clone(), false);
                    let scene = SlenderCantilever { line, axial, load, elements, settings, sudden };
                    let end = end_of(&scene);
                    if let Ok((prepared, forward)) = &end {
                        let says = compare(prepared, forward)?;
                        let place = match says {
                            Told::Right => 0,
                            Told::Open => 1,
                            Told::Unknown => 2,
                            Told::Wrong(_) => 3,
                        };
                        told[place] += 1.0;
                        if let Told::Wrong(numbers) = says {
                            report.note(format!("a cable under {load}: {numbers:?} told, not known, counted"));
                        }
                        let stands = forward.stability.is_some_and(|course| course.end.verdict() == Verdict::Stable);
                        unstable[usize::from(elements == 8 && line == Line::Cable)] += f64::from(!stands);
                    }
                    let tip = end.map(|(_, forward)| [forward.values[0], forward.values[1]]);
                    own.judge(tip, elastica::tip(load), tolerance);
                }
                own.report(report, &format!("cables/{line:?}, EA {axial:.0e}, {elements} elements"));
                total.add(&own);
            }
        }
    }
    let [right, open, unknown, wrong] = told;
    report.inform("cables/stability told as the dense count has it", right);
    report.inform("cables/stability open in both", open);
    report.inform("cables/stability said to be not known", unknown);
    report.at_most("cables/stability told wrongly", wrong, 0.0);
    // the mesh of few elements with exact strains is unstable itself where it hardly stretches
    report.inform("cables/unstable, of those with exact strains and 8 elements", unstable[1]);
    report.at_most("cables/unstable, of all others", unstable[0], 0.0);
    total.report_all(report, "cables");
    Ok(())
}

/// Motion for a second in steps of 10 ms, as far as the load throws the beam, whatever its axial stiffness: against steps of 1 ms
/// of a beam a thousand times as soft along its axis, which bends in the same way.
pub fn dynamics(report: &mut Report) -> Result<(), String> {
    let mut total = Outcomes::default();
    let elements = 8;
    for method in METHODS {
        let settings = |steps: usize| Settings::new(1.0, steps).with_method(method);
        let mut references = Vec::new();
        for load in LOADS {
            let scene =
                SlenderCantilever { line: Line::Beam, axial: 1e6, load, elements, settings: settings(2000), sudden: true };
            references.push(tip_of(&scene)?);
        }
        for axial in AXIAL_STIFFNESSES {
            let mut own = Outcomes::default();
            for (load, reference) in LOADS.into_iter().zip(&references) {
                let scene =
                    SlenderCantilever { line: Line::Beam, axial, load, elements, settings: settings(100), sudden: true };
                own.judge(tip_of(&scene), *reference, MOTION);
            }
            own.report(report, &format!("dynamics/EA {axial:.0e}/{method}"));
            total.add(&own);
        }
    }
    total.report_all(report, "dynamics");
    Ok(())
}
