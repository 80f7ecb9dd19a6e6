mod direct;
mod items;
mod timing;
mod user;

use crate::{Clock, Figure, Form, Report, Study, median, on_one_thread};
use costate::internals::{Program, System, SystemOptions, lanes};
use items::Item;
use std::sync::Arc;
use timing::{COPIES, ItemCost, Measured, assembled, assembly, least, programs, repeated};

/// Operations and times of everything that is assembled, whoever wrote it.
pub struct ElementCost;

impl Study for ElementCost {
    fn name(&self) -> &'static str {
        "element-cost"
    }
    fn summary(&self) -> &'static str {
        "operations and microseconds of every element and joint and of a user's own, on one thread"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        if !Clock::counts_computing() {
            report.note("This system does not count the time of a thread: other work on the machine is in these figures.");
        }
        on_one_thread(|| measure(report))
    }
}

/// Figures of derivatives that were written by hand; the file says where they come from.
const REFERENCE: &str = include_str!("reference.csv");
/// Passes over all items: what disturbs one measurement is over in the next pass.
const PASSES: usize = 4;
/// Rounds in which a user's element and its model in the library are measured in turn.
const ROUNDS: usize = 60;
/// Measurements of the same, of which the median counts.
const TRIES: usize = 10;

/// Aims for residual and matrix together [us]: one element, and for each of many.
const AIMS: [(&str, [f64; 2]); 6] = [
    ("rigid body", [0.16, 0.04]),
    ("beam", [1.6, 0.4]),
    ("beam damped", [2.0, 0.5]),
    ("shell", [60.0, 15.0]),
    ("revolute", [0.5, 0.12]),
    ("bushing", [0.8, 0.2]),
];

/// What is known of derivatives written by hand.
fn references() -> impl Iterator<Item = std::str::Split<'static, char>> {
    REFERENCE.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(','))
}

/// Residual and matrix together [us] by derivatives written by hand.
fn reference(name: &str) -> Result<Option<f64>, String> {
    for mut fields in references() {
        if fields.next() == Some(name) {
            let numbers: Result<Vec<f64>, _> = fields.map(str::parse).collect();
            return numbers.map(|own| Some(own.iter().sum())).map_err(|error| format!("reference.csv, {name}: {error}"));
        }
    }
    Ok(None)
}

fn measure(report: &mut Report) -> Result<(), String> {
    let items = items::all();
    // a reference whose item has another name would be left out without a word
    for name in references().filter_map(|mut fields| fields.next()) {
        find(&items, name)?;
    }
    if report.is_short() {
        return compare_operations(report, &items);
    }
    let mut costs: Vec<ItemCost> = items.iter().map(ItemCost::of).collect();
    for _ in 1..PASSES {
        items.iter().zip(&mut costs).for_each(|(item, cost)| cost.improve(&ItemCost::of(item)));
    }
    compare_operations(report, &items)?;
    for (user, model) in items::of_users() {
        compare_times(report, &user, find(&items, model)?);
    }
    for (item, cost) in items.iter().zip(&costs) {
        let Some(reference) = reference(&item.name)? else { continue };
        let own = cost.many.times().iter().sum::<f64>();
        inform(
            report,
            format!("{}/residual and matrix by those of derivatives written by hand", item.name),
            own / reference,
            1.0,
        );
    }
    for (name, aims) in AIMS {
        let found = items.iter().zip(&costs).find(|(item, _)| item.name == name);
        let (_, cost) = found.ok_or_else(|| format!("no item is named {name}"))?;
        let [residual, matrix] = [cost.programs[0].times, cost.programs[1].times];
        for (way, aim, programs, assembly) in [
            ("one", aims[0], residual[0] + matrix[0], cost.one.times().iter().sum::<f64>()),
            ("each of many", aims[1], residual[1] + matrix[1], cost.many.times().iter().sum()),
        ] {
            inform(report, format!("{name}/{way}: programs of residual and matrix [us], aim"), programs, aim);
            report.inform(format!("{name}/{way}: programs by aim"), programs / aim);
            inform(report, format!("{name}/{way}: through the assembly [us], aim"), assembly, aim);
        }
    }
    for (name, [program, dual]) in direct::compare() {
        report.inform(format!("{name}/first derivatives of the formula as it is written: program [us]"), program);
        report.inform(format!("{name}/first derivatives of the formula as it is written: dual numbers [us]"), dual);
    }
    notes(report, &items, &costs);
    Ok(())
}

/// A figure beside an aim that nothing has to reach.
fn inform(report: &mut Report, name: String, value: f64, aim: f64) {
    report.figures.push(Figure { name, value, reference: Some(aim), tolerance: None, pass: true });
}

fn find<'i>(items: &'i [Item], name: &str) -> Result<&'i Item, String> {
    items.iter().find(|item| item.name == name).ok_or_else(|| format!("no item is named {name}"))
}

/// Operations of users' elements by those of their models in the library.
fn compare_operations(report: &mut Report, items: &[Item]) -> Result<(), String> {
    for (user, model) in items::of_users() {
        let count = |all: &[Arc<Program>; 4]| all.each_ref().map(|program| program.instructions() as f64);
        let [own, other] = [count(&programs(&user)), count(&programs(find(items, model)?))];
        for ((what, own), other) in PROGRAMS.iter().zip(own).zip(other) {
            report.compare(format!("{}/operations, {what}", user.name), own, other, 0.0);
        }
    }
    Ok(())
}

/// Times of a user's element by those of its model in the library.
fn compare_times(report: &mut Report, user: &Item, model: &Item) {
    let [own, other] = [programs(user), programs(model)];
    for wide in [false, true] {
        let ways = if wide { format!("{} lanes", lanes()) } else { "one lane".into() };
        for ((what, own), other) in PROGRAMS.iter().zip(&own).zip(&other) {
            let ratio = ratio(|| [repeated(own, wide), repeated(other, wide)]);
            report.inform(format!("{}/time by that of the library's, {what}, {ways}", user.name), ratio);
        }
    }
    for copies in [1, COPIES] {
        let models = [user, model].map(|item| assembly(item, copies, false));
        let systems = models.each_ref().map(|model| System::new(model, SystemOptions::default()));
        for (place, what) in ["residual", "matrix"].into_iter().enumerate() {
            let ratio = ratio(|| {
                systems.each_ref().map(|system| {
                    let [residual, matrix] = assembled(system);
                    if place == 0 { residual } else { matrix }
                })
            });
            report.inform(format!("{}/time by that of the library's, {what} of {copies} assembled", user.name), ratio);
        }
    }
}

/// Median of the times of the first by those of the second, which are measured in turn.
fn ratio<'m>(make: impl Fn() -> [Measured<'m>; 2]) -> f64 {
    let ratios = (0..TRIES).map(|_| {
        let [own, other] = least(make(), ROUNDS);
        own / other
    });
    median(ratios.collect())
}

/// What the programs compute.
const PROGRAMS: [&str; 4] = ["residual", "matrix", "products", "second derivatives"];

fn notes(report: &mut Report, items: &[Item], costs: &[ItemCost]) {
    let lanes = lanes();
    let mut text = String::from(
        "Operations of the programs; and how long all four take to derive and to compile in both widths [ms]:\n\n",
    );
    text += "| | residual | matrix | products | second derivatives | derived and compiled [ms] |\n|---|---:|---:|---:|---:|---:|\n";
    for (item, cost) in items.iter().zip(costs) {
        text += &format!("| {} |", item.name);
        cost.programs.iter().for_each(|own| text += &format!(" {} |", own.operations));
        text += &format!(" {:.2} |\n", cost.making);
    }
    report.note(text);

    let mut text = format!("Time of the programs for one element [us], with one lane / with {lanes} lanes:\n\n");
    text += "| | residual | matrix | products | second derivatives |\n|---|---:|---:|---:|---:|\n";
    for (item, cost) in items.iter().zip(costs) {
        text += &format!("| {} |", item.name);
        cost.programs.iter().for_each(|own| text += &format!(" {:.3} / {:.3} |", own.times[0], own.times[1]));
        text += "\n";
    }
    report.note(text);

    let mut text = format!(
        "Through the assembly [us for each]: one copy, {COPIES} copies; and the matrix by dual numbers instead:\n\n"
    );
    text +=
        "| | residual, one | matrix, one | residual, many | matrix, many | both, many, by hand | matrix, dual numbers |\n";
    text += "|---|---:|---:|---:|---:|---:|---:|\n";
    for (item, ItemCost { one, many, dual, .. }) in items.iter().zip(costs) {
        let by_hand = reference(&item.name).ok().flatten().map_or_else(String::new, |own| format!("{own:.3}"));
        let times =
            [one.times(), many.times()].as_flattened().iter().map(|own| format!("{own:.3}")).collect::<Vec<_>>().join(" | ");
        text += &format!("| {} | {times} | {by_hand} | {dual:.2} |\n", item.name);
    }
    report.note(text);
    report.note(
        "Programs are timed with all arguments at hand, least of 25 measurements. Through the assembly: evaluation and assembly of a model at \
         acceleration level, less the same with the nodes alone. Residuals of constraints hold reactions and equations, their matrices A, \
         d2g/dt2 and the curvature of reactions, reduced to the unknowns of the nodes. Second derivatives: of what adjoint variables weigh, \
         times a vector. Dual numbers: num-dual's with eight parts, operation by operation of the residual's program, one run for every \
         eight columns.",
    );
}
