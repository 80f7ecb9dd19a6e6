//! The flexible pendulum of Ebrahimi et al.: the way of its tip, its energy, sensitivities over time, and what a step costs.

mod cost;
mod path;
mod scenes;
mod sensitivities;

use crate::{Clock, Report, Study, on_one_thread};
use costate::integrators::{DEFAULT_TABLE, RunError};
use costate_cli::{Chart, Series, Style};
use path::{MOMENTS, Path, path, pendulum};
use scenes::{Formulation, Pushed, Stiffened};

/// Duration [s].
const END: f64 = 4.0;
/// What the weight of the pendulum does on half of its length [J]: to compare changes of energy with.
const WORK: f64 = 12.0 * 9.81 * 0.6;

/// Measures some of it.
type Part = fn(&mut Report) -> Result<(), RunError>;

/// The study.
pub struct PendulumOfCable;

impl Study for PendulumOfCable {
    fn name(&self) -> &'static str {
        "flexible-pendulum"
    }
    fn summary(&self) -> &'static str {
        "soft pendulum of Ebrahimi et al.: path of the tip, energy, sensitivities of the deflection over time, cost of a step"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        if !Clock::counts_computing() {
            report.note("This system does not count the time of a thread: other work on the machine is in these figures.");
        }
        on_one_thread(|| {
            let parts: [Part; 5] = [meshes, steps, formulations, sensitivities::over_time, cost::costs];
            for (index, part) in parts.into_iter().enumerate() {
                eprintln!("[{}/{}]", index + 1, parts.len());
                part(report).map_err(|error| error.to_string())?;
            }
            Ok(())
        })
    }
}

fn line(name: impl Into<String>, points: impl Iterator<Item = (f64, f64)>) -> Series {
    Series { name: name.into(), points: points.collect(), style: Style::Line }
}

/// Paths with more and more elements against the finest, the default method with 1 ms.
fn meshes(report: &mut Report) -> Result<(), RunError> {
    let of = |elements: usize, steps: usize| path(&pendulum(elements)?, DEFAULT_TABLE, END, steps);
    let finest = of(40, 8000)?;
    let counts = [2, 5, 10, 20];
    let paths = counts.into_iter().map(|elements| of(elements, 4000)).collect::<Result<Vec<Path>, _>>()?;
    let figure = |elements: usize, what: &str| format!("path/{elements} elements, 1 ms, against 40, 0.5 ms/{what}");
    for (elements, own) in counts.into_iter().zip(&paths) {
        report.inform(figure(elements, "largest distance of the tips [m]"), own.distance(&finest));
        report.inform(figure(elements, "at the end [m]"), own.distance_at_end(&finest));
    }
    let [x, y] = finest.tip[MOMENTS];
    report.inform("path/40 elements, 0.5 ms/tip at 4 s, x [m]", x);
    report.inform("path/40 elements, 0.5 ms/tip at 4 s, y [m]", y);
    report.at_most(figure(20, "largest distance of the tips by the length"), paths[3].distance(&finest) / 1.2, 1e-4);
    // less than the 4 of smooth motions: let go from rest the line begins with a breakpoint of its accelerations at the hinge
    for (k, name) in [(1, "5 to 10"), (2, "10 to 20")] {
        let order = (paths[k].distance(&finest) / paths[k + 1].distance(&finest)).log2();
        report.inform(format!("path/order in the length of elements, {name}"), order);
    }
    pushed(report)?;
    let time = |k: usize| END * k as f64 / MOMENTS as f64;
    let named: Vec<(String, &Path)> =
        counts.iter().zip(&paths).map(|(count, own)| (format!("{count} elements"), own)).collect();
    let shown = [0, 1, 3].map(|k| line(&named[k].0, named[k].1.tip.iter().map(|tip| (tip[0], tip[1]))));
    let (x_label, y_label) = ("x [m]".into(), "y [m]".into());
    let way = Chart { title: "Tip, 0 to 4 s".into(), x_label, y_label, series: shown.into(), ..Chart::default() };
    report.picture("tip-path", vec![way]);
    let over_time = |y_label: &str, series: Vec<Series>| Chart {
        x_label: "time [s]".into(),
        y_label: y_label.into(),
        series,
        ..Chart::default()
    };
    let deflections = [0, 1, 3].map(|k| {
        let points = named[k].1.quantity.iter().enumerate().map(|(moment, &value)| (time(moment), value));
        line(&named[k].0, points)
    });
    let apart = |own: &Path| -> Vec<(f64, f64)> {
        let tips = own.tip.iter().zip(&finest.tip).enumerate().skip(1);
        tips.map(|(k, (a, b))| (time(k), (a[0] - b[0]).hypot(a[1] - b[1]))).collect()
    };
    let errors = named.iter().map(|(name, own)| line(name, apart(own).into_iter())).collect();
    let distances = Chart { log_y: true, ..over_time("tip from 40 elements [m]", errors) };
    report.picture("deflection", vec![over_time("deflection of the tip [m]", deflections.into()), distances]);
    Ok(())
}

/// The order of the elements in a motion without breakpoints.
fn pushed(report: &mut Report) -> Result<(), RunError> {
    let of = |elements: usize| path(&Pushed { elements }, DEFAULT_TABLE, 1.0, 2000);
    let finest = of(80)?;
    let errors = [5, 10, 20].map(|elements| of(elements).map(|own| own.distance(&finest)));
    let [five, ten, twenty] = errors;
    let (five, ten, twenty) = (five?, ten?, twenty?);
    report.inform("pushed/20 elements against 80/largest distance of the tips [m]", twenty);
    report.compare("pushed/order in the length of elements, 5 to 10", (five / ten).log2(), 4.0, 0.1);
    report.compare("pushed/order in the length of elements, 10 to 20", (ten / twenty).log2(), 4.0, 0.1);
    Ok(())
}

/// Five elements with shorter and shorter steps, by methods that have nothing in common but the elements.
fn steps(report: &mut Report) -> Result<(), RunError> {
    let scene = pendulum(5)?;
    let exact = path(&scene, "esdirk5", END, 32_000)?;
    for method in ["variational", "generalized-alpha", DEFAULT_TABLE] {
        for steps in [1600, 4000, 16_000] {
            let own = path(&scene, method, END, steps)?;
            let figure = |what: &str| format!("steps/{method}/{} ms/{what}", 1e3 * END / steps as f64);
            report.inform(figure("largest distance of the tips [m]"), own.distance(&exact));
            report.inform(figure("at the end [m]"), own.distance_at_end(&exact));
            report.inform(figure("largest change of energy by the work of the weight"), own.energy / WORK);
            if steps == 16_000 {
                // 0.3 mm of 1.2 m, and what the energy of an integrator of order 2 swings by
                let limit = if method == DEFAULT_TABLE { 1e-7 } else { 1e-4 };
                report.at_most(figure("largest distance of the tips by the length"), own.distance(&exact) / 1.2, limit);
                report.at_most(figure("largest change of energy"), own.energy / WORK, limit);
            }
        }
    }
    // stretching goes with 1000 rad/s and undamped: orders show where steps resolve its phase
    let end = 0.4;
    let exact = path(&scene, "esdirk5", end, 16_000)?;
    for (method, order, coarsest) in
        [("variational", 2.0, 4000), ("generalized-alpha", 2.0, 4000), (DEFAULT_TABLE, 4.0, 800)]
    {
        let errors = [1, 2].map(|factor| path(&scene, method, end, factor * coarsest).map(|own| own.distance(&exact)));
        let [coarse, fine] = errors;
        report.compare(format!("steps/{method}/order"), (coarse? / fine?).log2(), order, 0.1);
    }
    Ok(())
}

/// The cable against a geometrically exact beam, whose stretch, shear and rotary inertia it leaves out or takes otherwise.
fn formulations(report: &mut Report) -> Result<(), RunError> {
    let mut before: Option<f64> = None;
    for stiffening in [1.0, 10.0, 100.0] {
        let of = |formulation| {
            let scene = Stiffened { formulation, elements: 20, stiffening, run: (END, 4000) };
            path(&scene, DEFAULT_TABLE, END, 4000)
        };
        let apart = of(Formulation::Cable)?.distance(&of(Formulation::Beam)?) / 1.2;
        report.inform(format!("cable against beam/stiffened {stiffening} times/distance of the tips by the length"), apart);
        if let Some(before) = before {
            // a tenth, but for what both meshes of 20 elements leave
            let share = apart / before;
            report.compare(
                format!("cable against beam/stiffened {stiffening} times/share of the one before"),
                share,
                0.1,
                0.1,
            );
        }
        before = Some(apart);
    }
    Ok(())
}
