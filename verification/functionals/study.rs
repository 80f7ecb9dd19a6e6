//! Aggregates over elements and time: exact gradients, the cost of a second one, and how they tend to the largest value.

mod scene;

use crate::falling::tube;
use crate::rounding::{NearbyAdjoints, SCATTER, worse};
use crate::{Clock, Form, Report, Study, median, on_one_thread, with_phases};
use costate::functionals::{Aggregate, AggregateKind, Times};
use costate::integrators::{ConstraintLevel, Counters, DEFAULT_TABLE, Method, RunError, table_by_name};
use costate::scenes::{AnyScene, Prepared};
use costate::sensitivity::{Gradient, largest_difference};
use costate_cli::{Chart, Series, Style};
use scene::{Entry, Measure, RATIO, ShellPendulum, YOUNG, of_the_table};

/// Methods with their orders in the source, and the default.
const METHODS: [(&str, &str); 4] = [
    ("midpoint", "midpoint, order 2"),
    ("dirk2", "two stages, order 3"),
    ("dirk3", "three stages, order 4"),
    (DEFAULT_TABLE, "the default"),
];
/// Sharpness by the size of the largest ratio in the table.
const SHARPNESS: f64 = 20.0;
/// Largest difference of adjoint and complex step, by the largest derivative, where a rounding of the variables does not change more.
const EXACT: f64 = 1e-11;
/// How many times as soft the plate is whose strains keep more digits.
const SOFT: f64 = 100.0;
/// Runs of each adjoint; the fastest counts.
const REPEATS: usize = 12;
/// Elements along the box tube on which the source measures a second functional, and across each of its four walls: 192,640 unknowns as it
/// counts them, eight a node.
const TUBE: [usize; 2] = [150, 10];
/// Adjoints of one functional and of two there.
const PAIRS: usize = 15;
/// Sharpnesses by the size of the largest ratio.
const GROWING: [f64; 7] = [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

pub struct Functionals;

impl Study for Functionals {
    fn name(&self) -> &'static str {
        "functionals"
    }
    fn summary(&self) -> &'static str {
        "twelve functionals of a shell pendulum, two of a box tube: adjoint against complex step, cost of a second one, limits of aggregates"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let words = |error: RunError| error.to_string();
        gradients(report).map_err(words)?;
        limits(report).map_err(words)?;
        on_one_thread(|| second_functional(report).map_err(words))?;
        if report.is_short() { Ok(()) } else { on_one_thread(|| second_on_the_tube(report).map_err(words)) }
    }
}

fn prepare<'s>(scene: &'s dyn AnyScene, method: &str) -> Result<Prepared<'s>, RunError> {
    let table = table_by_name(method).ok_or_else(|| RunError::Input(format!("there is no method {method}")))?;
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    Prepared::with(scene, &x, Method::new(table, ConstraintLevel::default()), scene.settings())
}

/// Derivatives by each thickness, the length, Young's modulus and the yield stress; each in the unit of a relative change.
fn relative(row: &[f64], x: &[f64]) -> Vec<f64> {
    row.iter().zip(x).map(|(derivative, x)| derivative * x).collect()
}

/// The pendulum of the gradients.
fn pendulum(young: f64) -> ShellPendulum {
    ShellPendulum { elements: [5, 1], strips: 5, steps: 20, young, list: of_the_table(SHARPNESS) }
}

/// Values, adjoint and complex step of all functionals, and their largest differences by the largest derivative.
struct Compared {
    values: Vec<f64>,
    adjoint: Gradient,
    complex: Gradient,
    differences: Vec<f64>,
    /// What a rounding of the variables does to the adjoint.
    scatters: Vec<f64>,
}

impl Compared {
    fn of(scene: &ShellPendulum, method: &str) -> Result<Self, RunError> {
        let prepared = prepare(scene, method)?;
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x)?;
        let adjoint = analysis.adjoint(x, &forward)?;
        let complex = analysis.complex_step(x, &forward)?;
        let difference = |(own, exact): (&Vec<f64>, &Vec<f64>)| largest_difference(&relative(exact, x), &relative(own, x));
        let differences = adjoint.rows.iter().zip(&complex.rows).map(difference).collect();
        let nearby = NearbyAdjoints::of(&analysis, x)?;
        let rows = adjoint.rows.iter().enumerate();
        let scatters = rows.map(|(k, row)| nearby.scatter(k, row, |row| relative(row, x))).collect();
        Ok(Compared { values: forward.values, adjoint, complex, differences, scatters })
    }
}

fn gradients(report: &mut Report) -> Result<(), RunError> {
    let scene = pendulum(YOUNG);
    let mut series = Vec::new();
    for (name, words) in METHODS {
        let Compared { values, adjoint, complex, differences, scatters } = Compared::of(&scene, name)?;
        let mut points = Vec::new();
        for (index, (entry, &difference)) in scene.list.iter().zip(&differences).enumerate() {
            let figure = format!("{words}/{}/adjoint - complex step", entry.name);
            if difference <= EXACT {
                report.at_most(figure, difference, EXACT);
            } else {
                report.at_most(
                    format!("{figure}, beside a rounding of the variables"),
                    difference,
                    SCATTER * scatters[index],
                );
            }
            points.push(((index + 1) as f64, difference.max(f64::EPSILON * f64::EPSILON)));
        }
        if name == "dirk3" {
            report.note(format!(
                "Derivatives by the thickness of the strip at the hinge with {words}, as in Table 6 of the source:"
            ));
            let mut table = String::from("| functional | value | complex step | adjoint |\n|---|---:|---:|---:|");
            for (index, entry) in scene.list.iter().enumerate() {
                let [own, exact] = [&adjoint, &complex].map(|gradient| gradient.rows[index][0]);
                table += &format!("\n| {} | {:.9e} | {exact:.15e} | {own:.15e} |", entry.name, values[index]);
            }
            report.note(table);
        }
        series.push(Series { name: words.into(), points, style: Style::Markers });
    }
    // derivatives of strains are differences of those of a rigid swing: strains a hundred times as large keep two more digits
    let soft = Compared::of(&pendulum(YOUNG / SOFT), DEFAULT_TABLE)?;
    let by_limit = |(difference, scatter): (&f64, &f64)| difference / (EXACT / SOFT).max(SCATTER * scatter);
    let worst = soft.differences.iter().zip(&soft.scatters).map(by_limit).fold(0.0, worse);
    report.at_most(
        "the default, a plate a hundred times as soft/largest of all/adjoint - complex step, by 1e-13 or a rounding of the variables",
        worst,
        1.0,
    );
    let chart = Chart {
        title: "Largest difference of adjoint and complex step, by the largest derivative".into(),
        x_label: "functional, in the order of the table".into(),
        y_label: "relative difference [-]".into(),
        series,
        log_x: false,
        log_y: true,
    };
    report.picture("differences", vec![chart]);
    Ok(())
}

/// Kinds with their names, and the side from which they come where all points count the same.
const LIMITS: [(&str, AggregateKind); 6] = [
    ("smooth maximum, sum", AggregateKind::SmoothMaximum { normalized: false }),
    ("smooth maximum, mean", AggregateKind::SmoothMaximum { normalized: true }),
    ("exponential", AggregateKind::Exponential),
    ("exponential squared", AggregateKind::SquaredExponential),
    ("power", AggregateKind::Power),
    ("power squared", AggregateKind::SquaredPower),
];

fn limits(report: &mut Report) -> Result<(), RunError> {
    let mut list = Vec::new();
    for (name, kind) in LIMITS {
        for (times, when) in [(Times::End, "at the end"), (Times::Run, "over the run")] {
            // over time a sum has the unit of time in it, and comes from any side
            if times == Times::Run && name == LIMITS[0].0 {
                continue;
            }
            for sharpness in GROWING {
                let own = if kind.is_power() { sharpness } else { sharpness / RATIO };
                let over = Aggregate::new(kind, own).at(times);
                list.push(Entry { name: format!("{name}/{when}/sharpness {sharpness}"), measure: Measure::VonMises, over });
            }
        }
    }
    let scene = ShellPendulum { elements: [5, 1], strips: 1, steps: 20, young: YOUNG, list };
    let prepared = prepare(&scene, "dirk2")?;
    let forward = prepared.analysis().forward(&prepared.x)?;
    let (mut of_run, mut at_end) = (Vec::new(), Vec::new());
    let all = scene.list.iter().zip(&forward.values).zip(&forward.totals).collect::<Vec<_>>();
    for part in all.chunks(GROWING.len()) {
        let ((first, _), totals) = part[0];
        let Some(aggregate) = first.over.aggregate() else { continue };
        // all kinds have seen the same values: the offset is the largest of them
        let largest = totals.offset;
        let by_largest = |value: f64| if aggregate.kind.is_squared() { value.sqrt() / largest } else { value / largest };
        let ratios: Vec<f64> = part.iter().map(|((_, value), _)| by_largest(**value)).collect();
        for (ratio, ((entry, _), _)) in ratios.iter().zip(part) {
            report.inform(format!("limits/{}/by the largest value", entry.name), *ratio);
        }
        let name = first.name.rsplit_once('/').map_or("", |(name, _)| name);
        let above = matches!(aggregate.kind, AggregateKind::SmoothMaximum { normalized: false });
        let side = |ratio: f64| if above { ratio - 1.0 } else { 1.0 - ratio };
        let wrong = ratios.windows(2).filter(|pair| side(pair[1]) > side(pair[0])).count();
        let outside = ratios.iter().filter(|&&ratio| side(ratio).is_nan() || side(ratio) < 0.0).count();
        let where_from = if above { "above" } else { "below" };
        report.compare(format!("limits/{name}/values that are not {where_from} the largest"), outside as f64, 0.0, 0.0);
        report.compare(format!("limits/{name}/steps away from it"), wrong as f64, 0.0, 0.0);
        let last = GROWING[GROWING.len() - 1];
        // 90 points, and as many times: ln(measure) / sharpness at most
        report.compare(format!("limits/{name}/at sharpness {last}"), ratios[GROWING.len() - 1], 1.0, 0.03);
        let points = GROWING.into_iter().zip(ratios).collect();
        let curves = if first.over.times() == Times::End { &mut at_end } else { &mut of_run };
        let name = name.split('/').next().unwrap_or(name).into();
        curves.push(Series { name, points, style: Style::Both });
    }
    let chart = |title: &str, series| Chart {
        title: title.into(),
        x_label: "sharpness by the size of the largest value [-]".into(),
        y_label: "by the largest value [-]".into(),
        series,
        log_x: true,
        log_y: false,
    };
    report.picture("limits", vec![chart("At the end", at_end), chart("Over the run", of_run)]);
    Ok(())
}

fn second_functional(report: &mut Report) -> Result<(), RunError> {
    let all = of_the_table(SHARPNESS);
    let list = vec![all[2].clone(), all[4].clone()];
    let scene = ShellPendulum { elements: [55, 11], strips: 55, steps: 2, young: YOUNG, list };
    let prepared = prepare(&scene, "dirk2")?;
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x)?;
    let mut fastest = [f64::INFINITY; 2];
    let mut counters = Vec::new();
    // alternating, so that both see the same machine
    for _ in 0..REPEATS {
        for (place, wanted) in [[true, false], [true, true]].into_iter().enumerate() {
            let clock = Clock::start();
            let gradient = analysis.adjoint_of(x, &forward, &wanted)?;
            fastest[place] = fastest[place].min(clock.seconds());
            counters.push(gradient.counters);
        }
    }
    let [one, two] = [counters[0], counters[1]];
    report.compare(
        "second functional/factorizations, two by one",
        two.factorizations as f64,
        one.factorizations as f64,
        0.0,
    );
    report.compare("second functional/solutions, two by one", two.solves as f64 / one.solves as f64, 2.0, 0.0);
    report.compare("second functional/products, two by one", two.products as f64 / one.products as f64, 2.0, 0.0);
    report.inform("second functional/adjoint of one [s]", fastest[0]);
    // a solution and products for each system, against a matrix and its factors
    report.inform("second functional/added to the time of one", fastest[1] / fastest[0] - 1.0);
    Ok(())
}

/// What a second functional adds on the model on which the source measures it.
fn second_on_the_tube(report: &mut Report) -> Result<(), RunError> {
    let scene = tube(TUBE)?;
    let prepared = prepare(&scene, "dirk2")?;
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let both: Vec<bool> =
        prepared.functionals().iter().map(|functional| functional.name.starts_with("failure ratio")).collect();
    let one: Vec<bool> = both.iter().enumerate().map(|(k, &own)| own && !both[..k].contains(&true)).collect();
    if both.iter().filter(|own| **own).count() != 2 {
        return Err(RunError::Input("the tube has not two failure ratios".into()));
    }
    let forward = analysis.forward(x)?;
    // in turn, so that both see the same machine
    let (mut times, mut without, mut counters) = ([const { Vec::new() }; 2], [const { Vec::new() }; 2], Vec::new());
    for _ in 0..PAIRS {
        for (place, wanted) in [&one, &both].into_iter().enumerate() {
            let clock = Clock::start();
            let gradient = with_phases(analysis, |analysis| analysis.adjoint_of(x, &forward, wanted))?;
            let all = clock.seconds();
            let [_, matrices, factorizations, _] = gradient.counters.nanoseconds.unwrap_or_default();
            times[place].push(all);
            without[place].push(all - 1e-9 * (matrices + factorizations) as f64);
            counters.push(gradient.counters);
        }
    }
    let figure = |what: &str| format!("second functional, box tube {} x 4 x {}/{what}", TUBE[0], TUBE[1]);
    let of_one = median(times[0].clone());
    let [of_all, of_others] =
        [&times, &without].map(|[one, two]| median(two.iter().zip(one).map(|(two, one)| two - one).collect()));
    report.inform(figure("adjoint of one [s]"), of_one);
    report.inform(figure("matrices and factorizations, share of that"), 1.0 - median(without[0].clone()) / of_one);
    report.inform(figure("added, by the whole times, share of that"), of_all / of_one);
    let different = |own: fn(&Counters) -> usize| {
        let differ = counters.windows(2).filter(|pair| own(&pair[0]) != own(&pair[1]));
        differ.count() as f64
    };
    report.compare(figure("runs with other numbers of factorizations"), different(|own| own.factorizations), 0.0, 0.0);
    report.compare(figure("runs with other numbers of blocks in matrices"), different(|own| own.blocks), 0.0, 0.0);
    let [of_one_counted, of_two] = [counters[0], counters[1]];
    let by_one = |own: fn(&Counters) -> usize| own(&of_two) as f64 / own(&of_one_counted) as f64;
    report.compare(figure("solutions, two by one"), by_one(|own| own.solves), 2.0, 0.0);
    report.compare(figure("products, two by one"), by_one(|own| own.products), 2.0, 0.0);
    // the same in both runs, and so large that its scatter hides what is added
    report.inform(figure("added beside matrices and factorizations, share of the whole"), of_others / of_one);
    Ok(())
}
