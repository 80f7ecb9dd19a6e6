//! Adjoint and tangent gradients against complex step and difference quotients, over the lists of everything.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod beam;
mod cable;
mod coverage;
mod measures;
mod mechanism;
mod reaches;
mod scenes;
mod shell;
mod stiff_beams;

use crate::rounding::{NearbyAdjoints, SCATTER, worse};
use crate::{Report, Study};
use costate::integrators::{
    ConstraintLevel, DEFAULT_TABLE, Method, RunError, STATIC_TABLE, StepControl, Table, TimeGrid, table_by_name, tables,
};
use costate::internals::table_named;
use costate::scenes::{AnyScene, Prepared, Settings};
use costate::sensitivity::{Quotient, largest_difference};
use measures::{Reach, Reads};
use rayon::prelude::*;
use scenes::{Case, Subject};
use shell::ShellSubject;

/// Largest difference of the exact gradients, relative to the largest entry of each row.
const EXACT: f64 = 1e-12;
/// What is left of terms that cancel, relative to the functional and its derivatives.
const CANCELLED: f64 = 1e-14;
/// Roundings of a constraint, in units in the last place, where a multiplier follows from it through 1 / (h a_ii)^2 or 1 / (h a_ii).
const ROUNDINGS: f64 = 8.0;
/// Largest difference from a difference quotient, relative to the largest term of the directional derivative.
const QUOTIENT: f64 = 1e-7;
/// Noise over the step beyond which a quotient shows nothing, relative to the largest term.
const BLIND: f64 = 1e-3;

/// Method of the runs that choose their steps.
const CHOOSING: &str = "esdirk4";
/// Integrators that scenes of further joints and forces go with.
const OF_FORMULAS: [&str; 5] = ["midpoint", "esdirk4", "generalized-alpha", "bdf2", "esdirk4-choosing-steps"];
/// Of the others, every which one a basic scene goes with.
const SHARE: usize = 5;
/// Those with which all parameters of beams are varied: with others a share.
const ALL_OF_BEAMS: [&str; 2] = ["bdf2", DEFAULT_TABLE];
/// That which only scenes with elastic energy go with, and bodies: momenta are carried.
const VARIATIONAL: &str = "variational";
/// Their tolerances at the position and the acceleration level, where errors and so steps differ.
const TOLERANCES: [f64; 2] = [1e-4, 1e-7];
/// Their longest step [s]: never less than 50 of them.
const LONGEST: f64 = 0.02;

/// An integrator with equal steps, or with chosen ones.
#[derive(Clone)]
struct Member {
    name: String,
    table: Table,
    chooses_steps: bool,
}

impl Member {
    fn control(&self, level: ConstraintLevel) -> Option<StepControl> {
        let place = ConstraintLevel::ALL.iter().position(|own| *own == level)?;
        self.chooses_steps.then(|| StepControl { longest: LONGEST, ..StepControl::new(TOLERANCES[place]) })
    }
}

/// Every integrator, and one that chooses its steps.
fn members() -> Vec<Member> {
    let equal = |table: Table| Member { name: table.name.clone(), table, chooses_steps: false };
    let choosing = table_by_name(CHOOSING).map(|table| Member {
        name: format!("{CHOOSING}-choosing-steps"),
        table,
        chooses_steps: true,
    });
    let variational = table_by_name(VARIATIONAL).map(equal);
    tables().into_iter().map(equal).chain(choosing).chain(variational).collect()
}

/// A scene of equilibria: there are no velocities, and levels are all the same.
fn of_equilibria(case: &Case) -> Option<(Case, Member, ConstraintLevel)> {
    let table = table_named(STATIC_TABLE).ok().flatten()?;
    let member = Member { name: table.name.clone(), table, chooses_steps: false };
    Some((case.clone(), member, ConstraintLevel::default()))
}

/// Elements of beams have up to ninety parameters, each a complex-step run: all go with two integrators, every sixth with any other, from
/// another one on for each.
///
/// The longest formulas are those of shells: all their parameters go with the default integrator, every thirtieth with any other; of damped
/// ones, which add one parameter, every tenth with this one among them.
fn share_of(case: &Case, index: usize, member: &Member) -> Case {
    if case.is_of_shells() {
        let every = if member.name != DEFAULT_TABLE {
            [30, index % 30]
        } else if matches!(case.subject, Subject::Shell(ShellSubject::Damped)) {
            [10, (case.nominal().0.len() - 1) % 10]
        } else {
            [1, 0]
        };
        return Case { every, ..case.clone() };
    }
    let all = !case.is_of_beams() || case.nominal().0.len() <= 24 || ALL_OF_BEAMS.contains(&member.name.as_str());
    Case { every: if all { [1, 0] } else { [6, index] }, ..case.clone() }
}

/// Whether a scene goes with an integrator at a constraint level: some with all; those of further formulas with five, basic ones with these
/// and every fifth of the others, from another one on for each; flexible ones at the acceleration level alone.
fn belongs((index, case): (usize, &Case), (place, member): (usize, &Member), level: ConstraintLevel) -> bool {
    let of_formulas = OF_FORMULAS.contains(&member.name.as_str());
    let has_turn = case.is_basic() && (index + place).is_multiple_of(SHARE);
    let default = level == ConstraintLevel::default();
    if case.is_flexible() {
        // steps are given: cables that ring ask for thousands
        return default && !member.chooses_steps && (of_formulas || case.is_basic_beam());
    }
    member.name != VARIATIONAL && (of_formulas || has_turn || case.goes_with_all())
}

/// The study.
pub struct ComplexStep;

impl Study for ComplexStep {
    fn name(&self) -> &'static str {
        "complex-step"
    }
    fn summary(&self) -> &'static str {
        "every element, functional, integrator and constraint level: adjoint, tangent, complex step and differences agree"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let cases = scenes::list();
        let moving = cases.iter().enumerate().filter(|(_, case)| !case.statics);
        let members = members();
        let pairs = moving.flat_map(|case| members.iter().enumerate().map(move |member| (case, member)));
        let combinations: Vec<(Case, Member, ConstraintLevel)> = pairs
            .flat_map(|(case, member)| ConstraintLevel::ALL.map(|level| (case, member, level)))
            .filter(|(case, member, level)| belongs(*case, *member, *level))
            .map(|((_, case), (place, member), level)| (share_of(case, place, member), member.clone(), level))
            .chain(cases.iter().filter(|case| case.statics).filter_map(of_equilibria))
            .collect();
        let outcomes: Vec<Result<Outcome, RunError>> =
            combinations.par_iter().map(|(case, member, level)| compare(case, member, *level)).collect();

        let mut total = Outcome::default();
        let mut chosen_by_level = ConstraintLevel::ALL.map(|_| Vec::new());
        let mut by_level = ConstraintLevel::ALL.map(|_| Outcome::default());
        for ((case, member, level), outcome) in combinations.iter().zip(outcomes) {
            let name = format!("{}/{}/{}", case.name, member.name, level.name());
            let outcome = outcome.unwrap_or_else(|error| {
                report.note(format!("{name}: {error}"));
                Outcome { adjoint: f64::NAN, tangent: f64::NAN, quotient: f64::NAN, ..Outcome::default() }
            });
            report.at_most(format!("{name}/adjoint"), outcome.adjoint, EXACT);
            report.at_most(format!("{name}/tangent"), outcome.tangent, EXACT);
            let limits = outcome.limits;
            for (kind, limit, differences) in limits.each(&outcome) {
                if limit > EXACT {
                    report.at_most(format!("{name}/adjoint-of-{kind}"), differences[0], limit);
                    report.at_most(format!("{name}/tangent-of-{kind}"), differences[1], limit);
                }
            }
            if let Some([difference, limit]) = outcome.rounded {
                report.at_most(format!("{name}/beside-a-rounding-of-the-variables"), difference, limit);
            }
            report.at_most(format!("{name}/difference-quotient"), outcome.quotient, QUOTIENT);
            if let Some([miss, limit]) = outcome.noisy {
                report.at_most(format!("{name}/difference-quotient-at-its-noise"), miss, limit);
                report.at_most(format!("{name}/noise-of-difference-quotient"), outcome.noise, BLIND);
            }
            for line in &outcome.lines {
                report.note(format!("{name}: {line}"));
            }
            let level = ConstraintLevel::ALL.iter().position(|own| own == level).unwrap_or(0);
            by_level[level].add(&outcome);
            total.add(&outcome);
            if let Some([least, most]) = outcome.chosen {
                chosen_by_level[level].push([least, most, outcome.steps as f64]);
            }
        }
        for (level, worst) in ConstraintLevel::ALL.iter().zip(&by_level) {
            report.inform(format!("worst/{}/adjoint", level.name()), worst.adjoint);
            report.inform(format!("worst/{}/tangent", level.name()), worst.tangent);
            report.inform(format!("worst/{}/difference-quotient", level.name()), worst.quotient);
            report.inform(format!("worst/{}/noise-of-difference-quotient", level.name()), worst.noise);
            for (kind, _, differences) in Limits::default().each(worst) {
                report.inform(format!("worst/{}/adjoint-of-{kind}", level.name()), differences[0]);
                report.inform(format!("worst/{}/tangent-of-{kind}", level.name()), differences[1]);
            }
            report.inform(format!("combinations-above-1e-12/{}", level.name()), worst.above as f64);
            report.inform(format!("combinations-beside-a-rounding/{}", level.name()), worst.beside as f64);
        }
        for (level, chosen) in ConstraintLevel::ALL.iter().zip(&chosen_by_level) {
            let most_steps = chosen.iter().fold(0.0, |most: f64, own| most.max(own[2]));
            let largest_ratio = chosen.iter().fold(0.0, |most: f64, own| most.max(own[1] / own[0]));
            report.inform(format!("chosen-steps/{}/most", level.name()), most_steps);
            report.inform(format!("chosen-steps/{}/longest-by-shortest", level.name()), largest_ratio);
        }
        stiff_beams::run(report).map_err(|error| format!("stiff beams: {error}"))?;
        let (types, missing) = coverage::missing(&cases);
        report.inform("types-of-elements-and-constraints", types as f64);
        report.at_most("types-in-no-scene", missing.len() as f64, 0.0);
        missing.iter().for_each(|name| report.note(format!("{name} is the subject of no scene")));
        report.inform("combinations", combinations.len() as f64);
        report.inform("entries", total.entries as f64);
        report.inform("entries-declared-zero", total.zeros as f64);
        report.at_most("entries-declared-zero-but-not", total.not_zero as f64, 0.0);
        report.at_most("entries-zero-but-not-declared", total.not_declared as f64, 0.0);
        Ok(())
    }
}

/// What one combination showed.
#[derive(Default)]
struct Outcome {
    adjoint: f64,
    tangent: f64,
    quotient: f64,
    /// Difference and limit of the functional nearest to its limit, or beyond it, of those whose noise asks for more than [`QUOTIENT`].
    noisy: Option<[f64; 2]>,
    /// Difference and limit of the functional nearest to its limit, or beyond it, of those that a rounding of the variables moves by more
    /// than [`EXACT`].
    rounded: Option<[f64; 2]>,
    /// Largest noise of a quotient.
    noise: f64,
    /// Adjoint and tangent of functionals of coordinates, of velocities and of multipliers, where these carry more round-off
    /// than [`EXACT`].
    of_coordinates: [f64; 2],
    of_velocities: [f64; 2],
    of_forces: [f64; 2],
    /// 1 if any exact gradients differ by more than [`EXACT`].
    above: usize,
    /// Combinations with functionals beside a rounding of the variables.
    beside: usize,
    entries: usize,
    zeros: usize,
    not_zero: usize,
    not_declared: usize,
    lines: Vec<String>,
    /// Of velocities and forces.
    limits: Limits,
    /// Steps of the run.
    steps: usize,
    /// Shortest and longest step [s], where they were chosen.
    chosen: Option<[f64; 2]>,
}

impl Outcome {
    fn add(&mut self, other: &Outcome) {
        self.adjoint = worse(self.adjoint, other.adjoint);
        self.tangent = worse(self.tangent, other.tangent);
        self.quotient = worse(self.quotient, other.quotient);
        self.noise = worse(self.noise, other.noise);
        for way in 0..2 {
            self.of_coordinates[way] = worse(self.of_coordinates[way], other.of_coordinates[way]);
            self.of_velocities[way] = worse(self.of_velocities[way], other.of_velocities[way]);
            self.of_forces[way] = worse(self.of_forces[way], other.of_forces[way]);
        }
        self.above += other.above;
        self.beside += usize::from(other.rounded.is_some());
        self.entries += other.entries;
        self.zeros += other.zeros;
        self.not_zero += other.not_zero;
        self.not_declared += other.not_declared;
    }
}

/// All functionals of one scene with one method, four ways.
fn compare(case: &Case, member: &Member, level: ConstraintLevel) -> Result<Outcome, RunError> {
    let method = Method::new(member.table.clone(), level);
    let scene: &dyn AnyScene = case;
    let variables = scene.variables();
    let x: Vec<f64> = variables.iter().map(|variable| variable.initial).collect();
    let control = member.control(level);
    let settings = Settings { control, ..scene.settings() };
    let prepared = Prepared::with(scene, &x, method, settings)?;
    let forward = prepared.analysis().forward(&x)?;
    // gradients are those of the steps taken
    let analysis = prepared.analysis().on_steps_of(&forward);
    let limits = Limits::of(&member.table, level, &forward.grid);
    let adjoint = analysis.adjoint(&x, &forward)?;
    let tangent = analysis.tangent(&x, &forward)?;
    let complex = analysis.complex_step(&x, &forward)?;
    // one generic direction through all variables at which the motion is differentiable
    let direction: Vec<f64> = variables
        .iter()
        .zip(1..)
        .map(|(variable, i)| {
            let left_out = case.one_sided.contains(&variable.name.as_str());
            if left_out { 0.0 } else { f64::from(3 * i).cos() * variable.initial.abs().max(0.1) }
        })
        .collect();
    let quotients = analysis.quotients(&x, &direction)?;

    let reaches = case.reaches();
    let sizes = forward.grid.times.windows(2).map(|ends| ends[1] - ends[0]);
    let chosen = control.map(|_| [sizes.clone().fold(f64::INFINITY, f64::min), sizes.fold(0.0, f64::max)]);
    let mut nearby = None;
    let mut outcome = Outcome { steps: forward.grid.steps(), chosen, limits, ..Outcome::default() };
    for (index, entry) in case.measures().into_iter().enumerate() {
        let mut rows = [&complex, &adjoint, &tangent].map(|gradient| gradient.rows[index].clone());
        let largest = rows.iter().flatten().fold(forward.values[index].abs(), |most: f64, entry| most.max(entry.abs()));
        for row in &mut rows {
            for (derivative, &reach) in row.iter_mut().zip(&reaches) {
                let cancels = reach == Reach::LaterAndSteps && measures::is_zero(entry, reach);
                if cancels && derivative.abs() <= CANCELLED * largest {
                    *derivative = 0.0;
                }
            }
        }
        let [complex_row, adjoint_row, tangent_row] = &rows;
        let rows = [complex_row, adjoint_row, tangent_row];
        let mut differences = [largest_difference(rows[0], rows[1]), largest_difference(rows[0], rows[2])];
        let exact = match measures::reads(entry) {
            Reads::Multipliers => limits.force,
            Reads::Coordinates => limits.coordinate,
            Reads::Velocities => limits.velocity,
            Reads::Start => EXACT,
        };
        if exact <= EXACT && worse(differences[0], differences[1]) > EXACT {
            let nearby: &NearbyAdjoints = match &nearby {
                Some(nearby) => nearby,
                None => nearby.insert(NearbyAdjoints::of(&analysis, &x)?),
            };
            let scatter = nearby.scatter(index, rows[1], <[f64]>::to_vec);
            let limit = EXACT.max(SCATTER * scatter);
            let difference = worse(differences[0], differences[1]);
            if outcome.rounded.is_none_or(|[other, of_other]| !(difference / limit <= other / of_other)) {
                outcome.rounded = Some([difference, limit]);
            }
            outcome.lines.push(format!("{}: {difference:.1e} where a rounding allows {limit:.1e}", measures::name(entry)));
            if limit > EXACT && difference <= limit {
                differences = [0.0; 2];
            }
        }
        let [adjoint, tangent] = match measures::reads(entry) {
            Reads::Multipliers if limits.force > EXACT => outcome.of_forces.each_mut(),
            Reads::Coordinates if limits.coordinate > EXACT => outcome.of_coordinates.each_mut(),
            Reads::Velocities if limits.velocity > EXACT => outcome.of_velocities.each_mut(),
            _ => [&mut outcome.adjoint, &mut outcome.tangent],
        };
        *adjoint = worse(*adjoint, differences[0]);
        *tangent = worse(*tangent, differences[1]);
        let terms: Vec<f64> = rows[1].iter().zip(&direction).map(|(g, d)| g * d).collect();
        let largest = terms.iter().fold(0.0, |s: f64, term| s.max(term.abs()));
        let slope: f64 = terms.iter().sum();
        let Quotient { value, floor, .. } = quotients[index];
        // where every term is zero there is nothing to be relative to: noise alone may be left
        let share = |size: f64| if largest == 0.0 { size } else { size / largest };
        let (miss, limit) = (share((slope - value).abs()), SCATTER * share(floor));
        outcome.noise = worse(outcome.noise, if largest == 0.0 { 0.0 } else { share(floor) });
        if limit <= QUOTIENT {
            outcome.quotient = worse(outcome.quotient, miss);
        } else if outcome.noisy.is_none_or(|[other, of_other]| !(miss / limit <= other / of_other)) {
            outcome.noisy = Some([miss, limit]);
        }
        assert_eq!(variables.len(), reaches.len(), "a variable has one reach");
        for (place, (variable, &reach)) in variables.iter().zip(&reaches).enumerate() {
            let entries = rows.map(|row| row[place]);
            outcome.entries += 1;
            let declared = measures::is_zero(entry, reach);
            outcome.zeros += usize::from(declared);
            if reach == Reach::Piece {
                continue;
            }
            if declared && entries.iter().any(|&entry| entry != 0.0) {
                outcome.not_zero += 1;
                outcome.lines.push(format!("{} by {} is not zero: {entries:?}", measures::name(entry), variable.name));
            }
            if !declared && entries.contains(&0.0) {
                outcome.not_declared += 1;
                outcome.lines.push(format!("{} by {} is zero: {entries:?}", measures::name(entry), variable.name));
            }
        }
    }
    let exact = [outcome.adjoint, outcome.tangent];
    let all = exact.into_iter().chain(outcome.of_coordinates).chain(outcome.of_velocities).chain(outcome.of_forces);
    outcome.above = usize::from(all.fold(0.0, worse) > EXACT);
    Ok(outcome)
}

/// What round-off of the constraints leaves of velocities and multipliers at a constraint level: [`ROUNDINGS`] through the table.
/// Coordinates follow from velocities: off by as much for as long as the run.
#[derive(Clone, Copy, Default)]
struct Limits {
    coordinate: f64,
    velocity: f64,
    force: f64,
}

impl Limits {
    fn of(table: &Table, level: ConstraintLevel, grid: &TimeGrid) -> Self {
        let round_off = table.round_off(level, grid, ROUNDINGS * f64::EPSILON);
        let duration = grid.times.last().zip(grid.times.first()).map_or(0.0, |(end, start)| end - start);
        let velocity = round_off.velocity;
        Limits { coordinate: velocity * duration, velocity, force: round_off.acceleration }
    }

    /// Name, limit, and the differences of adjoint and tangent of each kind.
    fn each(&self, outcome: &Outcome) -> [(&'static str, f64, [f64; 2]); 3] {
        [
            ("coordinates", self.coordinate, outcome.of_coordinates),
            ("velocities", self.velocity, outcome.of_velocities),
            ("forces", self.force, outcome.of_forces),
        ]
    }
}
