//! How a falling plate of shells scales over ranks and threads: each phase, steps, gradients, messages and memory.

use crate::falling::plate;
use crate::phases::{Effort, OfMumps, Phases, Times, USUAL};
use crate::{Form, Report, Study};
use costate::internals::{of_all_ranks, traffic};
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// The study.
pub struct Scaling;

/// A plate, by its name in figures.
struct Subject {
    name: &'static str,
    /// Elements along the plate, for each thread of all processes where `is_for_each`, and across it.
    elements: [usize; 2],
    is_for_each: bool,
    effort: Effort,
}

const ONCE: Effort = Effort { repeats: 1, steps: 0, with_mumps: false };
const WITH_MUMPS: Effort = Effort { with_mumps: true, ..USUAL };
/// Those of the short form; of the whole one, with 192,000 unknowns as Boopathy & Kennedy count them, eight a node; and of the long one, with
/// 2,000,000.
const SUBJECTS: [Subject; 4] = [
    Subject { name: "60 x 12", elements: [60, 12], is_for_each: false, effort: ONCE },
    Subject { name: "150 x 39", elements: [150, 39], is_for_each: false, effort: WITH_MUMPS },
    Subject { name: "75 x 39 for each", elements: [75, 39], is_for_each: true, effort: USUAL },
    Subject { name: "560 x 112", elements: [560, 112], is_for_each: false, effort: ONCE },
];

impl Study for Scaling {
    fn name(&self) -> &'static str {
        "scaling"
    }
    fn summary(&self) -> &'static str {
        "falling plate of up to 62,720 shell elements on ranks and threads: time of each phase, messages, memory, same bits"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short, Form::Long]
    }
    fn is_for_ranks(&self) -> bool {
        true
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        if let Ok(name) = std::env::var(ONE_OF_MANY) {
            let subject = SUBJECTS.iter().find(|subject| subject.name == name).ok_or_else(|| format!("no plate {name}"))?;
            return subject.measure(report);
        }
        if of_all_ranks(&[]).len() > 1 {
            return Err("it starts its ranks itself: without mpirun".into());
        }
        let subjects = match (report.is_short(), report.is_long()) {
            (true, _) => &SUBJECTS[..1],
            (_, true) => &SUBJECTS[3..],
            _ => &SUBJECTS[1..3],
        };
        for subject in subjects {
            let mut all: Vec<(Layout, Option<Measured>)> =
                layouts(report, subject).into_iter().map(|layout| (layout, None)).collect();
            let rounds = if report.is_short() || report.is_long() { 1 } else { ROUNDS };
            for round in 0..rounds {
                for (layout, known) in all.iter_mut().filter(|own| round == 0 || !own.0.is_crowded) {
                    eprintln!("{}: {layout}", subject.name);
                    let own = layout.measured(subject)?;
                    *known = match (known.take(), own) {
                        (Some(known), Some(own)) => {
                            Some(known.least(own).map_err(|name| format!("{layout}: {name} is another one"))?)
                        }
                        (known, own) => known.or(own),
                    };
                }
            }
            let mut base = None;
            for (layout, own) in &all {
                let Some(own) = own else {
                    report.note(format!("{layout}: not measured; this needs the feature mpi, and mpirun"));
                    continue;
                };
                own.tell(report, subject, layout, base);
                base.get_or_insert((layout, own));
            }
        }
        Ok(())
    }
}

/// Names the plate to a process that measures it alone, or with others.
const ONE_OF_MANY: &str = "COSTATE_SCALING";
/// Tells processes that they have no core each: they disturb each other, so that the least of more repetitions counts.
const CROWDED_RANKS: &str = "COSTATE_SCALING_CROWDED";
const CROWDED_REPEATS: usize = 30;
/// Rounds in which all layouts with a core for each thread are measured, of which the faster one counts: what disturbs some minutes disturbs one.
const ROUNDS: usize = 2;

/// How many processes, and threads of each.
struct Layout {
    ranks: usize,
    threads: usize,
    /// They have no core each.
    is_crowded: bool,
}

impl std::fmt::Display for Layout {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let Layout { ranks, threads, .. } = self;
        write!(f, "{ranks} rank{}, {threads} thread{}", plural(*ranks), plural(*threads))
    }
}

/// Numbers of ranks whose longest path is measured on however few cores.
const CROWDED: [usize; 2] = [4, 8];

/// Layouts that the cores of this machine have room for: powers of two of either, and all cores in between; of a large plate those with all
/// cores alone. Of ranks without a core of their own the longest path is measured.
fn layouts(report: &Report, subject: &Subject) -> Vec<Layout> {
    let available = std::thread::available_parallelism().map_or(1, usize::from);
    let cores = if report.is_short() { available.min(2) } else { available };
    let powers = || (0..).map(|power| 1 << power).take_while(|&count| count <= cores);
    let all = powers().flat_map(|ranks| powers().map(move |threads| Layout { ranks, threads, is_crowded: false }));
    let has_all = |layout: &Layout| layout.ranks * layout.threads * 2 > cores;
    let counts = |layout: &Layout| has_all(layout) || !report.is_long() && (layout.ranks == 1 || layout.threads == 1);
    // a plate that grows with eight of them takes too long
    let crowded = if subject.is_for_each { &CROWDED[..1] } else { &CROWDED[..] };
    let crowded = crowded.iter().copied().filter(|&ranks| ranks > cores && !report.is_short() && !report.is_long());
    let crowded = crowded.map(|ranks| Layout { ranks, threads: 1, is_crowded: true });
    all.filter(|layout| layout.ranks * layout.threads <= cores && counts(layout)).chain(crowded).collect()
}

/// Figures of a layout by their names.
struct Measured(BTreeMap<String, f64>);

impl Layout {
    /// What processes of this layout measure; nothing where they cannot be started.
    fn measured(&self, subject: &Subject) -> Result<Option<Measured>, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let mut command = match self.ranks {
            1 => Command::new(program),
            _ if !cfg!(feature = "mpi") => return Ok(None),
            ranks => {
                let mut command = Command::new("mpirun");
                command.args(["-n", &ranks.to_string(), "--bind-to", "none", "--oversubscribe"]).arg(program);
                command
            }
        };
        command.args(["verify", "scaling", "--json"]);
        // containers have no other user
        command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        if self.is_crowded {
            command.env(CROWDED_RANKS, "1");
        }
        command.env(ONE_OF_MANY, subject.name);
        // those of the products of MUMPS, too
        for of in ["RAYON_NUM_THREADS", "OPENBLAS_NUM_THREADS"] {
            command.env(of, self.threads.to_string());
        }
        let output = command.output();
        let output = match output {
            Err(error) if self.ranks > 1 && error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            output => output.map_err(|error| error.to_string())?,
        };
        let text = String::from_utf8_lossy(&output.stdout);
        let last = text.lines().rfind(|line| line.starts_with('{')).unwrap_or_default();
        let object: Value = serde_json::from_str(last)
            .map_err(|_| format!("{self}: {} {}", text.trim(), String::from_utf8_lossy(&output.stderr).trim()))?;
        let number = |figure: &Value| Some((figure["name"].as_str()?.to_string(), figure["value"].as_f64()?));
        if object["pass"] != true {
            return Err(format!("{self}: {last}"));
        }
        Ok(Some(Measured(object["figures"].as_array().into_iter().flatten().filter_map(number).collect())))
    }
}

impl Measured {
    /// The least of each time of two rounds, which have the same results; otherwise the name of one that differs.
    fn least(mut self, other: Self) -> Result<Self, String> {
        for (name, value) in other.0 {
            let own = self.0.entry(name.clone()).or_insert(value);
            if name.starts_with(RESULT) && own.to_bits() != value.to_bits() {
                return Err(name);
            }
            *own = if name.ends_with("[s]") { own.min(value) } else { *own };
        }
        Ok(self)
    }

    /// Reports the figures of a layout, with how many times faster than the first one it is, and whether it has the same results.
    fn tell(&self, report: &mut Report, subject: &Subject, layout: &Layout, base: Option<(&Layout, &Measured)>) {
        for (name, &value) in &self.0 {
            let full = format!("{}/{layout}/{name}", subject.name);
            let is_path = name.ends_with(ON_PATH);
            // a path knows of one thread, and what ranks take by the clock without a core each says nothing
            if is_path && layout.threads > 1 || !is_path && layout.is_crowded && is_timed(name) {
                continue;
            }
            let base = base.filter(|(base, _)| !is_path || base.threads == 1);
            let of_base = base.and_then(|(_, base)| base.0.get(name)).copied();
            if name.starts_with(RESULT) {
                if !subject.is_for_each {
                    // the first one has none to differ from
                    report.compare(full, value, of_base.unwrap_or(value), 0.0);
                }
                continue;
            }
            report.inform(&full, value);
            if let (Some(of_base), true) = (of_base, name.ends_with("[s]") && ![ON_PROCESSORS, WAITING].contains(&&name[..]))
            {
                let what = if subject.is_for_each { "share of its speed alone" } else { "times as fast" };
                report.inform(format!("{full}, {what}"), of_base / value);
            }
        }
    }
}

/// Names of figures that are told apart.
const RESULT: &str = "result";
const ON_PROCESSORS: &str = "time on processors, all ranks [s]";
const ON_PATH: &str = ", longest path [s]";
const WAITING: &str = "waiting, of the rank that waits most [s]";
const SECOND: &str = "second functional by the first";
/// Whether a figure depends on what the clock says.
fn is_timed(name: &str) -> bool {
    name.ends_with("[s]") || name == SECOND
}

impl Subject {
    /// What this process measures, together with those that were started with it.
    fn measure(&self, report: &mut Report) -> Result<(), String> {
        let [along, across] = self.elements;
        let threads = of_all_ranks(&[]).len() * rayon::current_num_threads();
        let elements = [if self.is_for_each { along * threads } else { along }, across];
        let plate = plate(elements)?;
        let (before, on_processor) = (traffic(), processor_seconds());
        let effort = match std::env::var_os(CROWDED_RANKS) {
            // what MUMPS sends is on no path here
            Some(_) => Effort { repeats: CROWDED_REPEATS.max(self.effort.repeats), with_mumps: false, ..self.effort },
            None => self.effort,
        };
        let own = Phases::measure(&plate, effort).map_err(|error| error.to_string())?;
        let (after, on_processor) = (traffic(), processor_seconds() - on_processor);
        report.inform("unknowns", own.system.unknowns);
        let mut tell = |what: &str, [seconds, path]: Times| {
            report.inform(format!("{what} [s]"), seconds);
            report.inform(format!("{what}{ON_PATH}"), path);
        };
        own.system.parts.iter().for_each(|&(what, times)| tell(what, times));
        tell("residual and matrix", [0, 1].map(|time| own.system.parts[0].1[time] + own.system.parts[1].1[time]));
        tell("forward step", own.step);
        tell("adjoint of a step", own.adjoint[0]);
        if let Some(OfMumps { ordering, parts }) = &own.system.of_mumps {
            for (what, [seconds, _]) in parts {
                report.inform(format!("MUMPS, ordered by {ordering}: {what} [s]"), *seconds);
            }
        }
        report.inform(SECOND, own.adjoint[1][0] / own.adjoint[0][0] - 1.0);
        for (place, &value) in own.results.iter().enumerate() {
            report.inform(format!("{RESULT} {place}"), value);
        }
        let memory = own.memory.unwrap_or(f64::NAN);
        let of_rank = [on_processor, after.waited - before.waited, after.sent - before.sent, memory];
        let shared = own.system.own_elements.unwrap_or(0) as f64;
        let all = of_all_ranks(&[&of_rank[..], &[shared], &own.results].concat());
        let is_other = |rank: &&Vec<f64>| rank[5..].iter().zip(&own.results).any(|(a, b)| a.to_bits() != b.to_bits());
        report.at_most("ranks with other results", all.iter().filter(is_other).count() as f64, 0.0);
        let of = |column: usize| all.iter().map(move |rank| rank[column]);
        report.inform(ON_PROCESSORS, of(0).sum());
        report.inform("memory of the fullest rank [MB]", 1e-6 * of(3).fold(0.0, f64::max));
        if all.len() > 1 {
            report.inform(WAITING, of(1).fold(0.0, f64::max));
            report.inform("sent by all [MB]", 1e-6 * of(2).sum::<f64>());
            let again = of(4).sum::<f64>() / elements.iter().product::<usize>() as f64 - 1.0;
            report.inform("elements of a matrix that are evaluated again [%]", 100.0 * again.max(0.0));
        }
        Ok(())
    }
}

/// Time that all threads of this process have been on a processor \[s\], in ticks of a hundredth: Linux, `/proc/self/stat`.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // behind the name, which may have blanks: fields 14 and 15 of all
    let fields = text.rsplit_once(')').map_or("", |(_, fields)| fields).split_whitespace();
    let ticks: Vec<f64> = fields.skip(11).take(2).filter_map(|field| field.parse().ok()).collect();
    if ticks.is_empty() { f64::NAN } else { 0.01 * ticks.iter().sum::<f64>() }
}
