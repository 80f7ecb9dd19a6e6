//! Command lines and files that went through many hands.

use crate::program::{Ended, Place, words};
use crate::{Noise, Report};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Command lines to begin with: all commands, and every option once.
const LINES: [&str; 12] = [
    "list --json",
    "run pendulum --end 0.1 --steps 5 --out out --json",
    "run five-bar --end 0.05 --tolerance 1e-4 --velocity-tolerance 1e-3 --longest-step 0.01 --output-step 0.01 --out out",
    "run andrews --end 0.001 --steps 20 --method bdf2 --constraint-level position --newton residual --solver dense",
    "run slider-crank --end 0.1 --steps 40 --set rod=0.6 --project-start --history file:run.history --resume",
    "run von-mises-truss --steps 3 --out out",
    "gradient double-pendulum --end 0.05 --steps 10 --check --history checkpoints:1 --out out --json",
    "gradient pendulum --end 0.1 --steps 20 --history file:run.history --resume --out out --json",
    "gradient pendulum --end 0.1 --steps 9 --history memory --set mass=2 --set length=0.5",
    "optimize slider-crank --end 0.1 --steps 20 --out out",
    "modes pendulum --out out --json",
    "verify --json",
];
/// What takes the place of a word.
const WORDS: [&str; 40] = [
    "",
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "1e-320",
    "1e-300",
    "1e300",
    "1e999",
    "-1e9",
    "nan",
    "inf",
    "-inf",
    "0x10",
    "1_000",
    "1,5",
    "1.5.2",
    "18446744073709551616",
    "--",
    "-",
    "--help",
    "--version",
    "-h",
    "--no-such",
    "--steps",
    "--end",
    "--set",
    "--history",
    "--resume",
    "--json",
    "--check",
    "=",
    "mass=",
    "=1",
    "file:",
    "file:run.history",
    "checkpoints:0",
    "checkpoints:1e-9",
    "esdirk5",
];
/// Letters that are put into words: none that leaves the folder.
const LETTERS: [char; 16] =
    ['a', 'Z', '0', '9', '-', '=', ':', '.', ',', 'e', '+', ' ', '\u{e4}', '\u{221e}', '\u{1f980}', '\t'];
/// Those of them that take the place of a number.
const NUMBERS: std::ops::Range<usize> = 1..19;
/// Seconds for a command line; one that simulates for longer is told to stop, and must.
const LONGEST: Duration = Duration::from_secs(3);
/// Seconds for runs that are known to be short.
const SHORT: Duration = Duration::from_secs(60);
/// A run whose file is damaged.
const IN_FILE: &str = "gradient pendulum --end 0.1 --steps 60 --history file:run.history --resume --out out --json";
/// Places at which a damaged file may stand.
const FILES: [&str; 3] = ["run.history", "run.history.part", "run.history.unfinished"];

/// Draws numbers and choices.
struct Lot(Noise);

impl Lot {
    fn below(&mut self, count: usize) -> usize {
        ((0.5 * (self.0.next() + 1.0) * count as f64) as usize).min(count.saturating_sub(1))
    }
    fn of<T: Clone>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())].clone()
    }
}

/// A command line with a few changes.
fn mutated(lot: &mut Lot) -> Vec<String> {
    let mut line = words(lot.of::<&str>(&LINES));
    let is_number = |word: &String| word.rsplit('=').next().is_some_and(|value| value.parse::<f64>().is_ok());
    let numbers: Vec<usize> = (0..line.len()).filter(|&place| is_number(&line[place])).collect();
    // half of them remain well formed
    if !numbers.is_empty() && lot.below(2) == 0 {
        for _ in 0..1 + lot.below(2) {
            let word = &mut line[lot.of(&numbers)];
            let name = word.rsplit_once('=').map_or(String::new(), |(name, _)| format!("{name}="));
            *word = name + lot.of::<&str>(&WORDS[NUMBERS]);
        }
        return line;
    }
    for _ in 0..1 + lot.below(3) {
        let place = lot.below(line.len() + 1);
        let other = words(lot.of::<&str>(&LINES));
        match (lot.below(7), line.get_mut(place)) {
            (0, Some(_)) => drop(line.remove(place)),
            (1, Some(word)) => *word = lot.of::<&str>(&WORDS).into(),
            (2, Some(word)) => *word = lot.of(&other),
            (3, _) => line.insert(place, lot.of::<&str>(&WORDS).into()),
            (4, _) => line.insert(place, lot.of(&other)),
            (5, Some(word)) => {
                let mut letters: Vec<char> = word.chars().collect();
                letters.insert(lot.below(letters.len() + 1), lot.of(&LETTERS));
                *word = letters.into_iter().collect();
            }
            (6, Some(word)) => {
                let mut letters: Vec<char> = word.chars().collect();
                if !letters.is_empty() {
                    letters.remove(lot.below(letters.len()));
                }
                *word = letters.into_iter().collect();
            }
            _ => {}
        }
    }
    line
}

/// Bytes with a few changes.
fn damaged(lot: &mut Lot, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..1 + lot.below(3) {
        let place = lot.below(bytes.len().max(1));
        match (lot.below(5), bytes.get_mut(place)) {
            (0, _) => bytes.truncate(place),
            (1, Some(byte)) => *byte ^= 1 << lot.below(8),
            (2, _) => bytes.extend_from_slice(&whole[place.min(whole.len())..]),
            (3, Some(_)) => {
                let end = (place + 1 + lot.below(64)).min(bytes.len());
                bytes[place..end].fill(lot.of(&[0, 0xff, 0x20]));
            }
            (4, Some(_)) => {
                let end = (place + 1 + lot.below(512)).min(bytes.len());
                drop(bytes.drain(place..end));
            }
            _ => {}
        }
    }
    bytes
}

/// How processes ended.
#[derive(Default)]
struct Outcomes {
    count: usize,
    codes: BTreeMap<String, usize>,
    wrong: Vec<String>,
}

impl Outcomes {
    fn take(&mut self, what: &str, ended: &Ended) {
        self.count += 1;
        let code = match ended {
            Ended { told: true, .. } => "told to stop".into(),
            Ended { code: Some(code), .. } => format!("exit status {code}"),
            _ => "ended by a signal".into(),
        };
        *self.codes.entry(code).or_default() += 1;
        if ended.is_wrong() {
            self.wrong.push(format!("{what}: {:?}, {}", ended.code, ended.err));
        }
    }
    fn report(&self, report: &mut Report, name: &str) {
        report.inform(format!("{name}/drawn"), self.count as f64);
        for (code, &count) in &self.codes {
            report.inform(format!("{name}/{code}"), count as f64);
        }
        report.at_most(format!("{name}/panics, signals, silence, hangs"), self.wrong.len() as f64, 0.0);
        self.wrong.iter().take(10).for_each(|wrong| report.note(wrong.clone()));
    }
}

/// Runs mutated command lines, and runs with damaged files, for some time each.
pub fn count(report: &mut Report, time: Duration) -> Result<(), String> {
    let place = Place::new("mutations")?;
    let mut lot = Lot(Noise::new(2026));
    let (mut lines, begun) = (Outcomes::default(), Instant::now());
    while begun.elapsed() < time {
        let line = mutated(&mut lot);
        lines.take(&line.join(" "), &place.run(&line, None, LONGEST)?);
        if lines.count % 50 == 0 {
            place.clear()?;
        }
    }
    lines.report(report, "command lines");

    let line = words(IN_FILE);
    let histories = place.path("out/histories.csv");
    place.clear()?;
    let reference = place.run(&line, None, SHORT)?.results(&histories).ok_or("the run with a file fails")?;
    let whole = fs::read(place.path("run.history")).map_err(|error| error.to_string())?;
    let (mut files, mut same, mut different, begun) = (Outcomes::default(), 0, 0, Instant::now());
    while begun.elapsed() < time {
        place.clear()?;
        let name = lot.of::<&str>(&FILES);
        fs::write(place.path(name), damaged(&mut lot, &whole)).map_err(|error| error.to_string())?;
        let ended = place.run(&line, None, SHORT)?;
        files.take(name, &ended);
        if ended.code == Some(0) {
            let right = ended.results(&histories).is_some_and(|results| results == reference);
            *(if right { &mut same } else { &mut different }) += 1;
        }
    }
    files.report(report, "damaged files");
    report.inform("damaged files/right all the same, bit for bit", f64::from(same));
    report.at_most("damaged files/other results", f64::from(different), 0.0);
    foreign(report, &place, &line, &reference)
}

/// Files that are none of a run, files of other runs, files that two runs want, and a file that goes away.
fn foreign(report: &mut Report, place: &Place, line: &[String], reference: &str) -> Result<(), String> {
    let histories = place.path("out/histories.csv");
    let write = |path: &Path, bytes: &[u8]| fs::write(path, bytes).map_err(|error| format!("{}: {error}", path.display()));
    let (mut kept, mut lost) = (0, 0);
    for arguments in [line.to_vec(), line.iter().filter(|word| *word != "--resume").cloned().collect()] {
        for bytes in [&b"five years of work"[..], b"\x89PNG\r\n\x1a\n", b"costate", b"\0"] {
            for name in ["run.history", "run.history.part"] {
                place.clear()?;
                write(&place.path(name), bytes)?;
                let ended = place.run(&arguments, None, SHORT)?;
                let is_there = fs::read(place.path(name)).is_ok_and(|there| there == bytes);
                let refused = !ended.is_wrong() && ended.code != Some(0);
                *(if refused && is_there { &mut kept } else { &mut lost }) += 1;
            }
        }
    }
    report.inform("foreign files/refused and untouched", f64::from(kept));
    report.at_most("foreign files/lost", f64::from(lost), 0.0);

    // runs beside each other: each is right, or told that the file is being written
    let (mut right, mut told, mut wrong) = (0, 0, 0);
    for _ in 0..5 {
        place.clear()?;
        let outs = ["out", "out2", "out3"];
        let runs = outs.map(|out| {
            let own: Vec<String> = line.iter().map(|word| if word == "out" { out.into() } else { word.clone() }).collect();
            place.start(&own, None)
        });
        for (run, out) in runs.into_iter().zip(outs) {
            let ended = run?.end(SHORT)?;
            match ended.results(&place.path(out).join("histories.csv")) {
                Some(results) if results == reference => right += 1,
                None if !ended.is_wrong() && ended.err.contains("history file") => told += 1,
                _ => wrong += 1,
            }
        }
    }
    report.inform("shared files/right", f64::from(right));
    report.inform("shared files/told so", f64::from(told));
    report.at_most("shared files/anything else", f64::from(wrong), 0.0);

    let (mut right, mut told, mut wrong) = (0, 0, 0);
    for index in 0..20 {
        place.clear()?;
        let run = place.start(line, None)?;
        std::thread::sleep(Duration::from_millis(2 * index));
        let _ = fs::remove_file(place.path("run.history.part")).or_else(|_| fs::remove_file(place.path("run.history")));
        let ended = run.end(SHORT)?;
        match ended.results(&histories) {
            Some(results) if results == reference => right += 1,
            None if !ended.is_wrong() && ended.err.contains("run.history") => told += 1,
            _ => wrong += 1,
        }
    }
    report.inform("files taken away/right all the same", f64::from(right));
    report.inform("files taken away/told so", f64::from(told));
    report.at_most("files taken away/anything else", f64::from(wrong), 0.0);
    Ok(())
}
