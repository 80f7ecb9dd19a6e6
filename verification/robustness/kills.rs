//! Runs that are killed, or whose disk is full, and go on.

use crate::program::{Place, words};
use crate::{Noise, Report};
use std::fs;
use std::time::{Duration, Instant};

/// Runs whose parts take a few tenths of a second each: equal steps, chosen ones, redundant joints, beams, the variational integrator.
const SCENES: [&str; 5] = [
    "andrews",
    "slider-crank --tolerance 1e-9",
    "flexible-pendulum --steps 400 --end 1",
    "chain-common --steps 150 --end 0.15",
    "rigid-spring-beam",
];
/// Kills of each.
const KILLS: usize = 4;
/// Full disks of each.
const DISKS: usize = 4;
/// How the system calls it: "file too large", of a file that may not become larger.
const FULL: &str = "os error 27";
/// Seconds for any of them.
const LONGEST: Duration = Duration::from_secs(120);

/// What becomes of the runs.
#[derive(Default)]
struct Outcomes {
    same: usize,
    different: usize,
    /// Kills that came before the end.
    killed: usize,
    /// Full disks that were said.
    said: usize,
    /// Runs with room enough.
    enough: usize,
    wrong: usize,
}

/// Kills runs at random moments, some of them twice, and goes on; then gives others too little room, and goes on with more.
pub fn count(report: &mut Report) -> Result<(), String> {
    let place = Place::new("kills")?;
    let mut noise = Noise::new(18);
    let mut uniform = |below: f64| 0.5 * (noise.next() + 1.0) * below;
    let (mut kills, mut disks) = (Outcomes::default(), Outcomes::default());
    let histories = place.path("out/histories.csv");
    for scene in SCENES {
        let line = words(&format!("gradient {scene} --json --out out --history file:run.history --resume"));
        place.clear()?;
        let begun = Instant::now();
        let whole = place.run(&line, None, LONGEST)?;
        let time = begun.elapsed().as_secs_f64();
        let reference = whole.results(&histories).ok_or_else(|| format!("{scene}: {}", whole.err))?;
        let size = ["run.history", "out/histories.csv"]
            .iter()
            .map(|name| fs::metadata(place.path(name)).map_or(0, |file| file.len()));
        let size = size.max().unwrap_or(0);
        let goes_on = |outcomes: &mut Outcomes| -> Result<(), String> {
            let ended = place.run(&line, None, LONGEST)?;
            let same = ended.results(&histories).is_some_and(|results| results == reference);
            *(if same { &mut outcomes.same } else { &mut outcomes.different }) += 1;
            Ok(())
        };
        for index in 0..KILLS {
            place.clear()?;
            for _ in 0..1 + index % 2 {
                let after = Duration::from_secs_f64(uniform(time));
                kills.killed += usize::from(place.start(&line, None)?.kill_after(after)?);
            }
            goes_on(&mut kills)?;
        }
        for _ in 0..DISKS {
            place.clear()?;
            let ended = place.run(&line, Some(1 + uniform(size as f64 / 512.0) as u64), LONGEST)?;
            match ended.code {
                _ if ended.is_wrong() => disks.wrong += 1,
                Some(0) => disks.enough += 1,
                // the history, a table of results, or what it prints: whichever is the first without room
                _ => disks.said += usize::from(ended.err.contains("cannot ") && ended.err.contains(FULL)),
            }
            goes_on(&mut disks)?;
        }
    }
    let runs = (SCENES.len() * KILLS) as f64;
    report.inform("kills/runs", runs);
    report.inform("kills/kills before the end", kills.killed as f64);
    report.compare(
        "kills/taken up with the same states, functionals and gradients, bit for bit",
        kills.same as f64,
        runs,
        0.0,
    );
    let runs = (SCENES.len() * DISKS) as f64;
    report.inform("full disks/runs", runs);
    report.compare("full disks/said, or with room enough", (disks.said + disks.enough) as f64, runs, 0.0);
    report.at_most("full disks/panics, signals, silence", disks.wrong as f64, 0.0);
    report.compare("full disks/taken up with the same, bit for bit", disks.same as f64, runs, 0.0);
    Ok(())
}
