//! Functions of time: exact with their rates, as cheap with many points as with few, never beyond their data, and started from rest.

use crate::{Clock, Noise, Report, Study, median};
use costate::elements::Table;
use costate::internals::{ArgumentKind, Formula, Recorded};
use costate::scalar::Interpolant;
use costate::scenes::{FileScene, Prepared};
use costate::sensitivity::largest_difference;
use num_dual::Dual2_64;

/// Round-off of forces over a hundred steps, relative to the largest.
const EXACT: f64 = 1e-13;
/// Adjoint against complex step.
const GRADIENT: f64 = 1e-12;

/// The study.
pub struct Signals;

impl Study for Signals {
    fn name(&self) -> &'static str {
        "signals"
    }
    fn summary(&self) -> &'static str {
        "functions of time: exactness with their rates, cost and order of tables, overshoot, drives from rest"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        exactness(report)?;
        overshoot(report)?;
        cost(report)?;
        order_at_knots(report)?;
        drives(report)
    }
}

/// A mass of 2 kg on a driven slide, whose reaction is 2 f''(t), and a mass of 1 kg on a spring under the force f(t).
fn text(driven: bool, function: &str, steps: usize) -> String {
    let part = if driven {
        format!(
            "[[driver]]\nname = \"drive\"\ntype = \"translation\"\nbetween = [\"ground\", \"block\"]\naxis = [1, 0, 0]\ndisplacement = {function}\n"
        )
    } else {
        format!(
            "[[force]]\nname = \"drive\"\non = \"block\"\ndirection = [1, 0, 0]\nsize = {function}\n[[spring]]\nname = \"spring\"\ntype = \"line\"\n\
             between = [\"ground\", \"block\"]\npoints = [[-1, 0, 0], [0, 0, 0]]\nstiffness = 400\nrest_length = 1\n"
        )
    };
    let reaction =
        "[[functional]]\nname = \"reaction\"\ntype = \"reaction\"\njoint = \"drive\"\nweights = [1]\nover = \"terminal\"\n";
    format!(
        "version = 1\nsettings = {{ end = 1, steps = {steps} }}\nvariable.a = {{ initial = 0.3, bounds = [0, 1] }}\n\
         [[point]]\nname = \"block\"\nposition = [0, 0, 0]\nmass = 2\n\
         [[joint]]\nname = \"rail\"\ntype = \"point_on_line\"\nbetween = [\"ground\", \"block\"]\naxis = [1, 0, 0]\n{part}\
         [[functional]]\nname = \"x\"\ntype = \"position\"\non = \"block\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n{}",
        if driven { reaction } else { "" }
    )
}

fn read(text: &str) -> Result<FileScene, String> {
    FileScene::parse("signals.toml", text)
}

/// Values at the end, and how far gradients are from complex step.
fn run(text: &str) -> Result<(Vec<f64>, f64), String> {
    let scene = read(text)?;
    let prepared = Prepared::new(&scene).map_err(|why| why.to_string())?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).map_err(|why| why.to_string())?;
    let gradient = analysis.adjoint(&prepared.x, &forward).map_err(|why| why.to_string())?;
    let reference = analysis.complex_step(&prepared.x, &forward).map_err(|why| why.to_string())?;
    let rows = gradient.rows.iter().zip(&reference.rows);
    Ok((forward.values, rows.fold(0.0, |most: f64, (own, other)| most.max(largest_difference(other, own)))))
}

/// f(1) and the reaction 2 f''(1) of a drive along f.
fn exactness(report: &mut Report) -> Result<(), String> {
    eprintln!("[1/5] exactness");
    let (sine, decay) = (3.0_f64.sin(), (-1.0_f64).exp());
    let cases = [
        ("polynomial", "{ type = \"formula\", value = \"a * t^2 * (2 - t / 3)\" }", 0.5, 0.6),
        // sin(3 t)^2 exp(-t) starts from rest
        (
            "decaying sine",
            "{ type = \"formula\", value = \"a * sin(3 * t)^2 * exp(-t)\" }",
            0.3 * sine * sine * decay,
            0.3 * decay * (sine * sine - 6.0 * (6.0_f64).sin() + 18.0 * 6.0_f64.cos()),
        ),
        ("quotient", "{ type = \"formula\", value = \"a * t^3 / (1 + t)\" }", 0.15, 0.3 * (3.0 - 3.0 / 2.0 + 0.25)),
        ("smooth ramp", "{ type = \"smooth_ramp\", to = \"2 * a\", duration = 2 }", 0.3, 0.0),
    ];
    for (name, function, value, second) in cases {
        let (values, apart) = run(&text(true, function, 100))?;
        report.compare(format!("{name}/place of the drive"), values[0], value, EXACT);
        report.compare(format!("{name}/force of the drive [N]"), values[1].abs(), 2.0 * second.abs(), 10.0 * EXACT);
        report.at_most(format!("{name}/gradient against complex step"), apart, GRADIENT);
    }
    Ok(())
}

/// Largest way of tables beyond the values of the two points around, relative to the range of all.
fn overshoot(report: &mut Report) -> Result<(), String> {
    eprintln!("[2/5] overshoot");
    let mut noise = Noise::new(7);
    let mut share = move || 0.5 * (noise.next() + 1.0);
    let mut most = [0.0_f64; 2];
    for _ in 0..2000 {
        let count = 3 + (share() * 12.0) as usize;
        let mut knots = vec![0.0];
        (1..count).for_each(|k| knots.push(knots[k - 1] + 10.0_f64.powf(-3.0 * share())));
        let level = |share: f64| if share < 0.3 { 0.0 } else { share };
        let values: Vec<f64> = (0..count).map(|_| level(share())).collect();
        let range = values.iter().fold(f64::MIN_POSITIVE, |most: f64, own| most.max(*own));
        for (most, way) in most.iter_mut().zip([Interpolant::Monotone, Interpolant::Smooth]) {
            let table = Table::new(&knots, way)?;
            let numbers = table.numbers(&values);
            for (piece, ends) in values.windows(2).enumerate() {
                let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                for part in 0..=40 {
                    let t = knots[piece] + (knots[piece + 1] - knots[piece]) * f64::from(part) / 40.0;
                    let own = table.value(t, &numbers);
                    *most = most.max((low - own).max(own - high) / range);
                }
            }
        }
    }
    report.at_most("2,000 tables/monotone/beyond the values around, of their range", most[0], 1e-15);
    report.inform("2,000 tables/smooth/beyond the values around, of their range", most[1]);
    Ok(())
}

fn wave(count: usize) -> (Vec<f64>, Vec<f64>) {
    (0..count).map(|k| k as f64 / (count - 1) as f64).map(|t| (t, 3.0 * (9.0 * t).sin())).unzip()
}

fn listed(values: &[f64]) -> String {
    values.iter().map(|own| format!("{own:?}")).collect::<Vec<_>>().join(", ")
}

/// Operations of a look-up, and the time of a run, with 10, 1000 and 5000 points.
fn cost(report: &mut Report) -> Result<(), String> {
    eprintln!("[3/5] cost");
    let counts = [10, 1000, 5000];
    let mut operations = Vec::new();
    for count in counts {
        let (times, values) = wave(count);
        let table = Table::new(&times, Interpolant::Monotone)?;
        let arguments = [(ArgumentKind::Time, 1), (ArgumentKind::Parameter, table.numbers(&values).len())];
        let formula = Formula::record(arguments, |x: &[Recorded]| vec![table.value(x[0], &x[1..])])?;
        operations.push(formula.values().instructions() as f64);
    }
    for (count, own) in counts.iter().zip(&operations) {
        report.compare(format!("{count} points/operations of a value"), *own, operations[0], 0.0);
    }
    let scenes: Vec<FileScene> = counts
        .iter()
        .map(|&count| {
            let (times, values) = wave(count);
            let table = format!(
                "{{ type = \"table\", times = [{}], values = [{}], interpolation = \"smooth\" }}",
                listed(&times),
                listed(&values)
            );
            read(&text(false, &table, 20_000))
        })
        .collect::<Result<_, _>>()?;
    let prepared: Vec<Prepared> =
        scenes.iter().map(|scene| Prepared::new(scene).map_err(|why| why.to_string())).collect::<Result<_, _>>()?;
    let mut seconds = vec![Vec::new(); counts.len()];
    for _ in 0..if report.is_short() { 3 } else { 7 } {
        for (prepared, seconds) in prepared.iter().zip(&mut seconds) {
            let clock = Clock::start();
            prepared.analysis().forward(&prepared.x).map_err(|why| why.to_string())?;
            seconds.push(clock.seconds());
        }
    }
    let seconds: Vec<f64> = seconds.into_iter().map(median).collect();
    for (count, own) in counts.iter().zip(&seconds).skip(1) {
        report.inform(format!("{count} points/time of a run by that with 10"), own / seconds[0]);
    }
    Ok(())
}

/// Errors of a mass on a spring under a table of forces, whose second derivative jumps at its points, with steps that end there and steps that do not:
/// what decides up to how many points steps end at them.
fn order_at_knots(report: &mut Report) -> Result<(), String> {
    eprintln!("[4/5] order at points");
    let longest = costate::scalar::MOST_BREAKPOINTS;
    for (name, count) in [("few points, at which steps end", 41), ("many points, at which none ends", longest + 37)] {
        let (times, values) = wave(count);
        let table = format!("{{ type = \"table\", times = [{}], values = [{}] }}", listed(&times), listed(&values));
        let place = |steps: usize| -> Result<f64, String> {
            let scene = read(&text(false, &table, steps))?;
            let prepared = Prepared::new(&scene).map_err(|why| why.to_string())?;
            Ok(prepared.analysis().forward(&prepared.x).map_err(|why| why.to_string())?.values[0])
        };
        // no multiple of the points: steps fall anywhere between them
        let exact = place(63_001)?;
        let errors = [101, 203, 407].map(|steps| place(steps).map(|own| (own - exact).abs()));
        let [first, _, last] = [0, 1, 2].map(|k| errors[k].clone());
        let (first, last) = (first?, last?);
        report.inform(format!("{name}/error of 101 steps [m]"), first);
        report.inform(format!("{name}/error of 407 steps [m]"), last);
        report.inform(format!("{name}/order"), (first / last).log2() / (407.0_f64 / 101.0).log2());
    }
    Ok(())
}

/// Drives that start from rest are taken, those that jump are refused with the reason.
fn drives(report: &mut Report) -> Result<(), String> {
    eprintln!("[5/5] drives from rest");
    let taken = [
        "{ type = \"formula\", value = \"0.5 * 3 * t^2\" }",
        "{ type = \"formula\", value = \"a * (1 - cos(2 * pi * t))\" }",
        "{ type = \"smooth_ramp\", to = \"a\", duration = 0.5 }",
        "{ type = \"sine\", amplitude = \"a\", angular_frequency = 4, smooth_start = 0.2 }",
        "{ type = \"constant_rate\", rate = \"a\", smooth_start = 0.2 }",
        "{ type = \"table\", times = [0, 0.1, 0.5, 1], values = [0, 0, \"a\", \"a\"] }",
        "{ type = \"formula\", value = \"if_less(t, 0.5, 0, (t - 0.5)^3)\", breakpoints = [0.5] }",
    ];
    let refused = [
        ("{ type = \"constant_rate\", rate = \"a\" }", "start"),
        ("{ type = \"formula\", value = \"sin(t)\" }", "start"),
        ("{ type = \"lines\", times = [0, 1], values = [0, 1] }", "jump"),
        ("{ type = \"formula\", value = \"if_less(t, 0.5, 0, 1)\", breakpoints = [0.5] }", "jump"),
    ];
    let run_of = |function: &str| run(&text(true, function, 100));
    let fine = taken.iter().filter(|function| run_of(function).is_ok_and(|own| own.1 < GRADIENT)).count();
    report.compare("drives from rest that are taken", fine as f64, taken.len() as f64, 0.0);
    let told = refused.iter().filter(|(function, reason)| run_of(function).is_err_and(|why| why.contains(reason))).count();
    report.compare("drives with a jump that are refused with the reason", told as f64, refused.len() as f64, 0.0);
    // f, f' and f'' of a drive at its start
    let at_start = Dual2_64::new(0.0, 1.0, 0.0);
    let table = Table::new(&[0.0, 0.1, 0.5, 1.0], Interpolant::Monotone)?;
    let numbers: Vec<Dual2_64> = table.numbers(&[0.0, 0.0, 0.3, 0.3]).into_iter().map(Dual2_64::from).collect();
    report.compare("monotone table/rate at a level start", table.value(at_start, &numbers).v1, 0.0, 0.0);
    Ok(())
}
