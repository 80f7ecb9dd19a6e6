//! How a falling plate of shells scales over ranks and threads: each phase, steps, gradients, messages and memory.

use crate::verification::phases::{Effort, Phases, USUAL, adjoint_of_two};
use crate::verification::{Form, Report, Study};
use costate::internals::{of_all_ranks, traffic};
use costate::scenes::built_in::{PlatePendulum, Thicknesses};
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// The study.
pub struct Scaling;

/// Elements along the plate and across it: a short one, and two of 192,000 and 2,000,000 unknowns as Boopathy & Kennedy count them, eight a
/// node.
const SHORT: [usize; 2] = [60, 12];
const USUAL_MESH: [usize; 2] = [150, 39];
const LARGE: [usize; 2] = [560, 112];
/// Elements along the plate of one thread, where each has as many, and what their figures begin with.
const OF_EACH: usize = 75;
const FOR_EACH: &str = "as many for each, ";

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
        if of_all_ranks(&[]).len() > 1 || std::env::var_os(ONE_OF_MANY).is_some() {
            return measure(report);
        }
        let all = layouts(report.is_short());
        let mut base: Option<Measured> = None;
        for layout in all {
            eprintln!("{layout}");
            let Some(own) = layout.measured(report)? else {
                report.note(format!("{layout}: not measured; this needs the feature mpi, and mpirun"));
                continue;
            };
            own.tell(report, &layout, base.as_ref());
            base.get_or_insert(own);
        }
        Ok(())
    }
}

/// Says to a process that it is to measure alone what others do, too.
const ONE_OF_MANY: &str = "COSTATE_SCALING";

/// How many processes, and threads of each.
struct Layout {
    ranks: usize,
    threads: usize,
}

impl std::fmt::Display for Layout {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let Layout { ranks, threads } = self;
        write!(f, "{ranks} rank{}, {threads} thread{}", plural(*ranks), plural(*threads))
    }
}

/// Layouts that the cores of this machine have room for: powers of two of either, and all cores in between.
fn layouts(is_short: bool) -> Vec<Layout> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cores = if is_short { cores.min(2) } else { cores };
    let powers = || (0..).map(|power| 1 << power).take_while(|&count| count <= cores);
    let all = powers().flat_map(|ranks| powers().map(move |threads| Layout { ranks, threads }));
    let counts = |Layout { ranks, threads }: &Layout| *ranks == 1 || *threads == 1 || ranks * threads * 2 > cores;
    all.filter(|layout| layout.ranks * layout.threads <= cores && counts(layout)).collect()
}

/// Figures of a layout by their names.
struct Measured(BTreeMap<String, f64>);

impl Layout {
    /// What processes of this layout measure; nothing where they cannot be started.
    fn measured(&self, report: &Report) -> Result<Option<Measured>, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let mut command = match self.ranks {
            1 => Command::new(program),
            _ if !cfg!(feature = "mpi") => return Ok(None),
            ranks => {
                let mut command = Command::new("mpirun");
                command.args(["-n", &ranks.to_string(), "--bind-to", "none"]).arg(program);
                command
            }
        };
        command.args(["verify", "scaling", "--json"]);
        match (report.is_short(), report.is_long()) {
            (true, _) => command.arg("--short"),
            (_, true) => command.arg("--long"),
            _ => &mut command,
        };
        // containers have no other user
        command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        let output = command.env(ONE_OF_MANY, "1").env("RAYON_NUM_THREADS", self.threads.to_string()).output();
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
    /// Reports the figures of a layout, with how many times faster than the first one it is, and whether it has the same results.
    fn tell(&self, report: &mut Report, layout: &Layout, base: Option<&Measured>) {
        for (name, &value) in &self.0 {
            let full = format!("{layout}/{name}");
            let of_base = base.and_then(|base| base.0.get(name)).copied();
            let is_of_each = name.starts_with(FOR_EACH);
            if name.contains("result ") {
                if is_of_each {
                    continue;
                }
                // without one there is nothing to differ from
                report.compare(full, value, of_base.unwrap_or(value), 0.0);
                continue;
            }
            report.inform(full, value);
            let is_time = name.ends_with("[s]") && !name.contains(", all ranks");
            if let (Some(of_base), true) = (of_base, is_time) {
                let what = if is_of_each { "share of its speed alone" } else { "times as fast" };
                report.inform(format!("{layout}/{name}, {what}"), of_base / value);
            }
        }
    }
}

/// What this process measures, together with those that were started with it.
fn measure(report: &mut Report) -> Result<(), String> {
    let processes = of_all_ranks(&[]).len() * rayon::current_num_threads();
    let plate = |elements: [usize; 2]| PlatePendulum { elements, thicknesses: Thicknesses::Strips(1), milliseconds: 1 };
    let of_each = [OF_EACH * processes, USUAL_MESH[1]];
    let short = Effort { repeats: 1, steps: 0 };
    let subjects = match (report.is_short(), report.is_long()) {
        (true, _) => vec![(SHORT, "", short)],
        (_, true) => vec![(LARGE, "", short)],
        _ => vec![(USUAL_MESH, "", USUAL), (of_each, FOR_EACH, USUAL)],
    };
    for (elements, which, effort) in subjects {
        let name = match which {
            "" => format!("{} x {}", elements[0], elements[1]),
            which => format!("{which}{} x {}", OF_EACH, elements[1]),
        };
        phases(report, &name, &plate(elements), effort)?;
    }
    Ok(())
}

/// The figures of a mesh.
fn phases(report: &mut Report, name: &str, plate: &PlatePendulum, effort: Effort) -> Result<(), String> {
    let words = |error: costate::integrators::RunError| error.to_string();
    let begun = (traffic(), processor_seconds());
    let own = Phases::measure(plate, effort).map_err(words)?;
    let (after, of_processor) = (traffic(), processor_seconds());
    let of_two = adjoint_of_two(plate, effort).map_err(words)?;
    let name = |what: &str| format!("{name}/{what}");
    report.inform(name("unknowns"), own.unknowns);
    for (what, seconds) in own.of_a_system {
        report.inform(name(&format!("{what} [s]")), seconds);
    }
    report.inform(name("forward step [s]"), own.step);
    report.inform(name("adjoint of a step [s]"), own.adjoint);
    report.inform(name("second functional of a step"), of_two / own.adjoint - 1.0);
    for (place, &value) in own.results.iter().enumerate() {
        report.inform(name(&format!("result {place}")), value);
    }
    let (waited, sent) = (after.waited - begun.0.waited, after.sent - begun.0.sent);
    let (memory, elements) = (own.memory.unwrap_or(f64::NAN), own.own_elements.unwrap_or(0) as f64);
    let of_rank = [of_processor - begun.1, waited, sent, memory, elements];
    let all = of_all_ranks(&[&of_rank[..], &own.results].concat());
    let results = of_rank.len()..;
    let is_other = |rank: &&Vec<f64>| rank[results.clone()].iter().zip(&own.results).any(|(a, b)| a != b);
    let differing = all.iter().filter(is_other).count();
    report.at_most(name("ranks with other results"), differing as f64, 0.0);
    let of = |column: usize| all.iter().map(move |rank| rank[column]);
    // looks for messages are in it
    report.inform(name("time on processors, all ranks [s]"), of(0).sum());
    report.inform(name("memory of the fullest rank [MB]"), 1e-6 * of(3).fold(0.0, f64::max));
    if all.len() > 1 {
        report.inform(name("waiting, idlest rank [s]"), of(1).fold(0.0, f64::max));
        report.inform(name("sent, by all [MB]"), 1e-6 * of(2).sum::<f64>());
        let elements: f64 = plate.elements.iter().product::<usize>() as f64;
        report.inform(
            name("elements of a matrix evaluated again [%]"),
            100.0 * (of(4).sum::<f64>() / elements - 1.0).max(0.0),
        );
    }
    Ok(())
}

/// Time that all threads of this process have been on a processor \[s\], in ticks of a hundredth: Linux, `/proc/self/stat`.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // behind the name, which may have blanks: fields 14 and 15 of all
    let fields = text.rsplit_once(')').map_or("", |(_, fields)| fields).split_whitespace();
    let ticks: Vec<f64> = fields.skip(11).take(2).filter_map(|field| field.parse().ok()).collect();
    if ticks.is_empty() { f64::NAN } else { 0.01 * ticks.iter().sum::<f64>() }
}
