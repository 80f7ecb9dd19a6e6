use super::CommandLine;
use super::console::{count, print, print_error, print_json, seconds};
use super::failure::Failure;
use super::interrupt::Guard;
use super::study::{Figure, Form, Report, Study};
use crate::io::{Cell, Table, cells, write_charts, write_file};
use clap::Args;
use costate::scenes::unknown;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Options of `costate verify`.
#[derive(Args)]
pub struct VerifyOptions {
    /// Name of a study, or "all"; without it the studies are listed
    pub(super) name: Option<String>,
    /// Write the result to verification/NAME/result.md of the source tree, with its pictures
    #[arg(long, requires = "name")]
    record: bool,
    /// Carry out the long form of a study that has one: of "random-scenes" with 22,000 motions, of "robustness" with 20 minutes of mutations
    #[arg(long, requires = "name")]
    long: bool,
    /// Carry out the short form of a study that has one: seconds, and no figure that depends on the clock
    #[arg(long, requires = "name", conflicts_with_all = ["long", "record"])]
    short: bool,
    /// Where the numbers begin from which "random-scenes" draws: the first scene is that of N + 1
    #[arg(long, requires = "name", value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Print one JSON object with all figures on the last line of stdout
    #[arg(long)]
    json: bool,
}

/// A study that was carried out, or why it could not be.
struct Outcome<'p> {
    study: &'p dyn Study,
    report: Report,
    error: Option<String>,
    seconds: f64,
}

/// The program with the studies of the source tree, which stands beside that without studies.
const STUDIES: &str = "costate-verify";

/// Lets the program with the studies do what this one was asked for, and ends as it does.
pub fn hand_over() -> ExitCode {
    let beside = std::env::current_exe().map(|own| own.with_file_name(format!("{STUDIES}{}", std::env::consts::EXE_SUFFIX)));
    let missing = || {
        let build = "cargo build --release -p costate-verification";
        Failure::input(format!(
            "the studies are the program {STUDIES}, which is not beside this one: {build}, in the source tree"
        ))
    };
    let ended = beside.ok().filter(|path| path.is_file()).ok_or_else(missing).and_then(|path| {
        let status = Command::new(&path).args(std::env::args_os().skip(1)).status();
        status.map_err(|error| Failure::run(format!("{}: {error}", path.display())))
    });
    match ended {
        Ok(status) => ExitCode::from(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1)),
        Err(failure) => {
            print_error(&failure.message);
            ExitCode::from(failure.code)
        }
    }
}

/// `costate verify`: lists the studies, or measures one or all.
pub fn run(options: &VerifyOptions, program: &CommandLine) -> Result<(), Failure> {
    let Some(name) = &options.name else { return list(options.json, program) };
    let all = &program.studies;
    let known: Vec<String> = all.iter().map(|study| study.name().to_string()).collect();
    let studies: Vec<_> = all.iter().copied().filter(|study| name == "all" || study.name() == name).collect();
    if studies.is_empty() {
        return Err(Failure::input(unknown("study", name, &known)));
    }
    let form = match (options.short, options.long) {
        (true, _) => Form::Short,
        (_, true) => Form::Long,
        _ => Form::Whole,
    };
    if name != "all" && form != Form::Whole && !studies.iter().any(|study| study.forms().contains(&form)) {
        let which = if form == Form::Short { "short" } else { "long" };
        let own: Vec<_> = all.iter().filter(|study| study.forms().contains(&form)).map(|study| study.name()).collect();
        let own = own.join(", ");
        return Err(Failure::input(format!("\"{name}\" has no {which} form; these have one: {own}")));
    }
    let folder = if options.record { Some(source_folder()?) } else { None };
    let mut outcomes = Vec::new();
    for study in studies {
        let outcome = Outcome::measure(study, form, options.seed);
        outcome.print();
        if let Some(folder) = &folder {
            print(format_args!("wrote {}\n", outcome.record(folder)?.display()));
        }
        outcomes.push(outcome);
    }
    let failed: Vec<&str> = outcomes.iter().filter(|outcome| !outcome.pass()).map(|outcome| outcome.study.name()).collect();
    let objects: Vec<Value> = outcomes.iter().map(Outcome::json).collect();
    match (&objects[..], name.as_str()) {
        ([only], name) if name != "all" => print_json(options.json, only),
        _ => print_json(options.json, &json!({"pass": failed.is_empty(), "studies": objects})),
    }
    if failed.is_empty() {
        return Ok(());
    }
    Err(Failure::run(format!("out of tolerance or not carried out: {}", failed.join(", "))))
}

fn list(json: bool, program: &CommandLine) -> Result<(), Failure> {
    let mut table = Table::new(&["study", "what it shows"]).keyed(&["study", "summary"]);
    for study in &program.studies {
        table.row(cells![study.name(), study.summary()]);
    }
    if table.is_empty() {
        print("this program has no studies");
    } else {
        let name = &program.name;
        print(format_args!("{table}\n\nmeasure one with: {name} verify STUDY, or all with: {name} verify all"));
    }
    print_json(json, &json!({ "studies": table.json() }));
    Ok(())
}

/// The folder `verification` here or in the nearest folder above.
fn source_folder() -> Result<PathBuf, Failure> {
    let here = std::env::current_dir().map_err(|error| Failure::input(format!("--record: no current folder: {error}")))?;
    let found = here.ancestors().map(|folder| folder.join("verification")).find(|folder| folder.is_dir());
    found.ok_or_else(|| {
        let here = here.display();
        Failure::input(format!("--record writes to verification/NAME of the source tree, but {here} is not inside one"))
    })
}

impl<'p> Outcome<'p> {
    fn measure(study: &'p dyn Study, form: Form, seed: u64) -> Self {
        print(format_args!("{}: {}", study.name(), study.summary()));
        let mut report = Report::new(form, seed);
        let begun = Instant::now();
        let error = study.run(&mut report).err();
        Outcome { study, report, error, seconds: begun.elapsed().as_secs_f64() }
    }

    fn pass(&self) -> bool {
        self.error.is_none() && self.report.pass()
    }

    fn verdict(&self) -> String {
        let failed = self.report.figures.iter().filter(|figure| !figure.pass).count();
        let judged = self.report.figures.iter().filter(|figure| figure.tolerance.is_some()).count();
        match &self.error {
            Some(error) => format!("FAIL: {error}"),
            None if judged == 0 => "FAIL: no figure has a tolerance".into(),
            None if failed > 0 => format!("FAIL: {failed} of {} out of tolerance", count(judged, "figure")),
            None => format!("pass: {} within tolerance", count(judged, "figure")),
        }
    }

    fn print(&self) {
        print(format_args!("\n{}\n", self.figures()));
        for note in &self.report.notes {
            print(note);
        }
        print(format_args!("{}: {} ({})\n", self.study.name(), self.verdict(), seconds(self.seconds)));
    }

    fn figures(&self) -> Table {
        let titles = ["figure", "computed", "reference", "tolerance", "verdict"];
        let mut table = Table::new(&titles).keyed(&["name", "value", "reference", "tolerance", "pass"]);
        for Figure { name, value, reference, tolerance, pass } in &self.report.figures {
            let verdict = match (pass, tolerance) {
                (false, _) => "FAIL",
                (true, None) => "",
                (true, Some(_)) => "pass",
            };
            table.row(cells![name, *value, *reference, *tolerance, Cell::of(verdict, *pass)]);
        }
        table
    }

    fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n{}\n\n{}\n", self.study.name(), self.study.summary(), self.figures().markdown());
        for note in &self.report.notes {
            text += &format!("{note}\n\n");
        }
        for (name, _) in &self.report.pictures {
            text += &format!("![{name}]({name}.svg)\n\n");
        }
        text += &format!(
            "{} ({})\n\nWritten by `costate verify {} --record`.\n",
            self.verdict(),
            seconds(self.seconds),
            self.study.name()
        );
        text
    }

    fn record(&self, folder: &Path) -> Result<PathBuf, Failure> {
        let _guard = Guard::new();
        let path = folder.join(self.study.name()).join("result.md");
        write_file(&path, self.markdown().as_bytes())?;
        for (name, charts) in &self.report.pictures {
            write_charts(charts, &path.with_file_name(format!("{name}.svg")))?;
        }
        Ok(path)
    }

    fn json(&self) -> Value {
        let (study, figures) = (self.study.name(), self.figures().json());
        let mut object = json!({"study": study, "pass": self.pass(), "seconds": self.seconds, "figures": figures});
        if !self.report.notes.is_empty() {
            object["notes"] = json!(self.report.notes);
        }
        if let Some(error) = &self.error {
            object["error"] = json!(error);
        }
        object
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Made;
    impl Study for Made {
        fn name(&self) -> &'static str {
            "made"
        }
        fn summary(&self) -> &'static str {
            "made up"
        }
        fn run(&self, report: &mut Report) -> Result<(), String> {
            report.compare("order", 3.98, 4.0, 0.1);
            report.at_most("error", f64::NAN, 1e-12);
            report.inform("time", 1.5);
            report.note("a remark");
            Ok(())
        }
    }

    #[test]
    fn a_number_that_is_not_finite_fails_becomes_null_and_is_recorded() {
        let outcome = Outcome::measure(&Made, Form::Whole, 0);
        assert!(!outcome.pass());
        let object = outcome.json();
        assert_eq!(object["pass"], false);
        let first = json!({"name": "order", "value": 3.98, "reference": 4.0, "tolerance": 0.1, "pass": true});
        assert_eq!(object["figures"][0], first);
        let second = json!({"name": "error", "value": null, "reference": 0.0, "tolerance": 1e-12, "pass": false});
        assert_eq!(object["figures"][1], second);
        assert_eq!(object["figures"][2]["reference"], Value::Null);
        let folder = std::env::temp_dir().join(format!("costate-verify-{}", std::process::id()));
        let path = outcome.record(&folder).unwrap();
        assert_eq!(path, folder.join("made/result.md"));
        let text = std::fs::read_to_string(path).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        assert!(
            text.contains("| order | 3.98 | 4 | 0.1 | pass |\n| error | nan | 0 | 1e-12 | FAIL |\n| time | 1.5 |  |  |  |")
        );
        assert!(text.contains("a remark\n\nFAIL: 1 of 2 figures out of tolerance"), "{text}");
    }
}
