//! Scenes drawn by lot, run as a user runs them: right, said to be wrong, or refused; none is wrong in silence.

mod checking;
mod drawing;

use crate::program::Place;
use crate::{Form, Report, Study};
use checking::{Case, Deviation, Judged, Outcome};
use costate::integrators::StepError;
use drawing::Kind;
use std::collections::BTreeMap;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The study.
pub struct RandomScenes;

/// Kinds of scenes, how many are drawn in the short, the usual and the long form, and the share that may end without a result: of motions with events
/// also those that bounce ever faster, or that come to lie between two stops.
const COUNTS: [(Kind, &str, [u64; 3], f64); 5] = [
    (Kind::Motion, "motions", [40, 800, 8000], 0.1),
    (Kind::Events, "motions with events", [30, 1000, 10000], 0.15),
    (Kind::Friction, "motions with friction", [20, 400, 4000], 0.15),
    (Kind::Equilibrium, "equilibria", [5, 100, 1000], 0.1),
    (Kind::Vibration, "modes", [5, 100, 1000], 0.1),
];
/// Share of motions with events in which none may happen, as what is measured of them is not what they are drawn for; of those with friction, whose
/// surfaces may also slip all the time.
const IDLE: [f64; 2] = [0.2, 0.5];
/// Share of its size by which a value is far off.
const FAR: f64 = 0.1;
/// Share of runs whose steps are not told to be coarse that may be off by more than that.
const UNTOLD: f64 = 0.01;
/// Cases of one kind of outcome that are printed.
const PRINTED: usize = 10;

impl Study for RandomScenes {
    fn name(&self) -> &'static str {
        "random-scenes"
    }
    fn summary(&self) -> &'static str {
        "scenes drawn by lot against runs of other methods and steps, and quotients: right, said to be wrong, or refused"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short, Form::Long]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let folder = std::env::temp_dir().join("costate-random-scenes");
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        for (kind, name, [short, usual, long], refused) in COUNTS {
            let count = if report.is_short() {
                short
            } else if report.is_long() {
                long
            } else {
                usual
            };
            let outcomes = outcomes(kind, report.seed() + 1..=report.seed() + count)?;
            tell(report, name, &outcomes, (refused, IDLE[usize::from(kind == Kind::Friction)]));
            for (seed, Judged { outcome, .. }) in &outcomes {
                if !matches!(outcome, Outcome::Right) {
                    let path = folder.join(format!("{name}-{seed}.toml"));
                    let text = Case { seed: *seed, kind }.drawn().text;
                    fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
                }
            }
        }
        report.note(format!("scenes that are not right are in {}: costate gradient FILE --check", folder.display()));
        Ok(())
    }
}

/// What becomes of the scenes of some seeds, on all cores.
fn outcomes(kind: Kind, seeds: std::ops::RangeInclusive<u64>) -> Result<BTreeMap<u64, Judged>, String> {
    let seeds: Vec<u64> = seeds.collect();
    let (next, outcomes) = (AtomicUsize::new(0), Mutex::new(Ok(BTreeMap::new())));
    let work = || {
        let mut place = Place::new(&format!("random-scenes-{:?}", std::thread::current().id()).replace(['(', ')'], ""));
        while let Some(&seed) = seeds.get(next.fetch_add(1, Ordering::Relaxed)) {
            let run = AssertUnwindSafe(|| {
                place.as_mut().map_err(|error| error.clone()).and_then(|place| Case { seed, kind }.outcome(place))
            });
            let outcome = catch_unwind(run).unwrap_or_else(|_| Ok(Outcome::Broken("a panic in a reference".into()).into()));
            let mut all = outcomes.lock().unwrap_or_else(PoisonError::into_inner);
            match (&mut *all, outcome) {
                (Ok(all), Ok(outcome)) => drop(all.insert(seed, outcome)),
                (all, Err(why)) => *all = Err(why),
                _ => {}
            }
        }
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, |threads| threads.get());
        (0..threads).for_each(|_| _ = scope.spawn(work));
    });
    outcomes.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// A message without the names and numbers of one scene.
fn kind_of(message: &str) -> String {
    let mut kind = String::new();
    for (place, part) in message.trim_start_matches("error: ").split('"').enumerate() {
        kind += if place % 2 == 1 { ".." } else { part };
    }
    let is_number = |word: &str| {
        word.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '(') && word.contains(|c: char| c.is_ascii_digit())
    };
    let words = kind.split_whitespace().filter(|word| !is_number(word) && !word.contains('/'));
    words.take(14).collect::<Vec<_>>().join(" ")
}

/// Counts them, each kind by itself, and prints the first cases of each.
fn tell(report: &mut Report, name: &str, outcomes: &BTreeMap<u64, Judged>, (most_refused, most_idle): (f64, f64)) {
    let mut counts = [0.0; 9];
    let mut kinds: BTreeMap<(usize, String), Vec<(u64, &str)>> = BTreeMap::new();
    for (seed, Judged { outcome, .. }) in outcomes {
        let (place, why) = match outcome {
            Outcome::Right => (0, ""),
            Outcome::Told(why) => (1, &why[..]),
            Outcome::Refused(why) => (2, &why[..]),
            Outcome::Unchecked(why) => (3, &why[..]),
            Outcome::Wrong(why) => (4, &why[..]),
            Outcome::EnergyAlarm(why) => (5, &why[..]),
            Outcome::CheckFails(why) => (6, &why[..]),
            Outcome::Broken(why) => (7, &why[..]),
            Outcome::Sensitive(why) => (8, &why[..]),
        };
        counts[place] += 1.0;
        if place > 0 {
            kinds.entry((place, kind_of(why))).or_default().push((*seed, why));
        }
    }
    let [right, told, refused, unchecked, wrong, alarms, checks, broken, sensitive] = counts;
    let happened: Vec<usize> = outcomes.values().filter_map(|own| own.happened).collect();
    let between = match happened.is_empty() {
        true => String::new(),
        false => format!("{sensitive} lie at a limit between two motions, "),
    };
    // for the pages
    report.note(format!(
        "Of {} {name} drawn by lot {right} are right, {told} are off and say so, {refused} are refused or end with an error, {between}of \
         {unchecked} the references are too rough to tell, and {wrong} are wrong in silence.",
        outcomes.len(),
        right = right + alarms + checks,
    ));
    report.inform(format!("{name}/drawn"), outcomes.len() as f64);
    report.inform(format!("{name}/right, with a right gradient"), right + alarms + checks);
    report.inform(format!("{name}/off, and said to be"), told);
    report.inform(format!("{name}/refused or ended by an error"), refused);
    report.inform(format!("{name}/references too rough to tell"), unchecked);
    if !happened.is_empty() {
        let idle = happened.iter().filter(|count| **count == 0).count();
        report.inform(format!("{name}/at a limit between two motions"), sensitive);
        report.inform(format!("{name}/instants at which something happened"), happened.iter().sum::<usize>() as f64);
        report.at_most(format!("{name}/nothing happened, share"), idle as f64 / happened.len() as f64, most_idle);
    }
    report.at_most(format!("{name}/refused or ended by an error, share"), refused / outcomes.len() as f64, most_refused);
    report.at_most(format!("{name}/wrong in silence"), wrong, 0.0);
    report.at_most(format!("{name}/right, and the energy balance warns"), alarms, 0.0);
    report.at_most(format!("{name}/right, and --check fails"), checks, 0.0);
    report.at_most(format!("{name}/panics, signals, silence, hangs"), broken, 0.0);
    // what the limit is worth beyond which steps are called coarse
    if outcomes.values().any(|own| own.deviation.is_some()) {
        for (words, is_coarse) in [("told to be coarse", true), ("not told to be coarse", false)] {
            let of = outcomes.iter().filter_map(|(seed, own)| own.deviation.as_ref().map(|own| (seed, own)));
            let of: Vec<_> = of.filter(|(_, own)| (own.estimate > StepError::COARSE) == is_coarse).collect();
            let beyond = |most: f64| of.iter().filter(move |(_, own)| own.off > most);
            let share = |most: f64| beyond(most).count() as f64 / of.len().max(1) as f64;
            for (seed, Deviation { estimate, off, of }) in beyond(FAR).filter(|_| !is_coarse) {
                report.note(format!("{name} {seed}, {words}: {of}: {off:.1e} of its size off; a step {estimate:.1e}"));
            }
            let name = format!("{name}/steps {words}");
            report.inform(format!("{name}/runs"), of.len() as f64);
            report.inform(format!("{name}/a value off by more than 1 % of its size, share"), share(1e-2));
            let (figure, most) = (format!("{name}/by more than 10 %, share"), share(FAR));
            if is_coarse { report.inform(figure, most) } else { report.at_most(figure, most, UNTOLD) }
        }
    }
    const WORDS: [&str; 9] =
        ["", "said", "refused", "unchecked", "WRONG", "energy alarm", "check fails", "broken", "sensitive"];
    for ((place, kind), cases) in kinds {
        report.inform(format!("{name}/{}: {kind}", WORDS[place]), cases.len() as f64);
        for (seed, why) in cases.iter().take(PRINTED) {
            report.note(format!("{name} {seed}, {}: {why}", WORDS[place]));
        }
    }
}
