//! Contact and friction: values and gradients against closed forms and runs of another program; what has no solution is refused by name.

mod cases;

use crate::compared::{References, compare, told};
use crate::{Form, Report, Study};
use cases::CASES;
use costate::integrators::StepControl;
use costate::scenes::{AnyScene, FileScene, Prepared, Settings};

/// Numbers of equal steps, and tolerances of chosen ones, with which a rod comes to where it has no solution.
const STEPS: [usize; 4] = [20, 50, 200, 2000];
const TOLERANCES: [f64; 3] = [1e-5, 1e-8, 1e-11];
/// Angular velocities with which it does [rad/s].
const RATES: [f64; 4] = [0.0, 2.0, 3.0, 5.0];

/// The study.
pub struct Contact;

impl Study for Contact {
    fn name(&self) -> &'static str {
        "contact"
    }
    fn summary(&self) -> &'static str {
        "contact and friction: slip, stick, rolling and hits against closed forms; Painleve's rod is refused"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let references = References::read(include_str!("references.csv"))?;
        eprintln!("[1/2] cases");
        for case in &CASES {
            told(report, case.name, |report| compare(report, case, &references));
        }
        eprintln!("[2/2] what has no solution");
        let at_start = std::iter::once(why_not(include_str!("painleve.toml"), |settings| settings)?);
        let at_start = at_start.filter(|why| is_by_name(why)).count();
        report.compare("painleve/starts refused by name, of 1", at_start as f64, 1.0, 0.0);
        let mut refused = 0;
        for rate in RATES {
            let text =
                include_str!("painleve-reached.toml").replace("w = { initial = 2,", &format!("w = {{ initial = {rate},"));
            for steps in STEPS {
                refused += usize::from(is_by_name(&why_not(&text, |settings| Settings { steps, ..settings })?));
            }
            for tolerance in TOLERANCES {
                let chosen = |settings: Settings| settings.choosing_steps(StepControl::new(tolerance));
                refused += usize::from(is_by_name(&why_not(&text, chosen)?));
            }
        }
        let all = RATES.len() * (STEPS.len() + TOLERANCES.len());
        report.compare(format!("painleve-reached/runs refused by name, of {all}"), refused as f64, all as f64, 0.0);
        Ok(())
    }
}

/// Why a scene is not simulated; nothing where it is.
fn why_not(text: &str, settings: impl FnOnce(Settings) -> Settings) -> Result<String, String> {
    let scene = FileScene::parse("rod.toml", text)?;
    let x: Vec<f64> = AnyScene::variables(&scene).iter().map(|variable| variable.initial).collect();
    let settings = settings(AnyScene::settings(&scene));
    let method = Prepared::method_of(&settings).map_err(|why| why.to_string())?;
    let run = Prepared::with(&scene, &x, method, settings).and_then(|prepared| prepared.analysis().forward(&x).map(|_| ()));
    Ok(run.err().map_or_else(String::new, |why| why.to_string()))
}

fn is_by_name(why: &str) -> bool {
    why.contains("the contact \"tip\"") && why.contains("solution by Coulomb's law")
}
