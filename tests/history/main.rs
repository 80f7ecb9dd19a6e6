//! Wherever steps are kept, the gradient is the same bit by bit; what is kept stays within its memory; damage is named.

mod resumed;

use costate::history::{Direction, History, Keep};
use costate::integrators::{ConstraintLevel, Method, RunError, StepControl, Stop, table_by_name, tables};
use costate::internals::{Checkpoints, FileHistory, Rerun, march};
use costate::scenes::{AnyScene, Prepared, Settings, built_in};
use costate::sensitivity::{Analysis, Forward};
use std::fs;
use std::path::{Path, PathBuf};

/// An empty folder of its own for one test, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("costate-history-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("a folder for the test");
        Folder(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn scene(name: &str) -> &'static dyn AnyScene {
    built_in::named(name).expect("a built-in scene")
}

fn prepared<'s>(scene: &'s dyn AnyScene, method: Method, end: f64, steps: usize) -> Prepared<'s> {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let mut settings = Settings { end, steps, ..scene.settings().without_method() };
    settings.policy.project_start = true;
    Prepared::with(scene, &x, method, settings).expect("a sound scene")
}

fn bits(rows: &[Vec<f64>]) -> Vec<Vec<u64>> {
    rows.iter().map(|row| row.iter().map(|value| value.to_bits()).collect()).collect()
}

/// Bytes that so many checkpoints of a run need.
fn budget_for(prepared: &Prepared, checkpoints: usize) -> usize {
    let run = |keep: &Keep| Analysis { keep, ..prepared.analysis() }.forward(&prepared.x);
    let whole = run(&Keep::Memory).expect("runs").history;
    let step = whole.usage().bytes / whole.steps();
    let message = run(&Keep::Checkpoints(1)).expect_err("no room").to_string();
    let both = message.split("one checkpoint take ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<usize>().ok());
    step + checkpoints * (both.expect("bytes of a step and a checkpoint") - step)
}

#[test]
fn the_gradient_is_the_same_bit_by_bit_in_memory_in_a_file_and_from_checkpoints() {
    let folder = Folder::new("bits");
    // with Euler parameters, closed loops, drivers, redundant joints, springs
    let scenes = [("pendulum", 0.4), ("five-bar", 0.15), ("double-pendulum", 0.15), ("slider-crank", 0.1)];
    for (name, end) in scenes {
        let scene = scene(name);
        for table in tables() {
            for level in ConstraintLevel::ALL {
                let place = format!("{name}, {}, {} level", table.name, level.name());
                let mut prepared = prepared(scene, Method::new(table.clone(), level), end, 12);
                same_wherever_kept(&mut prepared, &folder, &place);
            }
        }
    }
}

/// Values, gradients by both ways, and the adjoint once more, bit by bit as in memory: in a file, with 1 and with 3 checkpoints.
fn same_wherever_kept(prepared: &mut Prepared, folder: &Folder, place: &str) {
    let mut results = Vec::new();
    for keep in [
        Keep::Memory,
        Keep::File(folder.0.join("run.bin")),
        Keep::Checkpoints(budget_for(prepared, 1)),
        Keep::Checkpoints(budget_for(prepared, 3)),
    ] {
        prepared.keep = keep;
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).expect(place);
        let adjoint = analysis.adjoint(&prepared.x, &forward).expect(place);
        let tangent = analysis.tangent(&prepared.x, &forward).expect(place);
        let again = analysis.adjoint(&prepared.x, &forward).expect(place);
        assert!(adjoint.rows.iter().flatten().any(|&entry| entry != 0.0), "{place}: nothing is compared");
        let times = vec![forward.grid.times.clone()];
        results.push([times, vec![forward.values], adjoint.rows, tangent.rows, again.rows].map(|rows| bits(&rows)));
    }
    for (other, what) in results[1..].iter().zip(["file", "1 checkpoint", "3 checkpoints"]) {
        assert_eq!(results[0], *other, "{place}: {what} differs from memory");
    }
}

#[test]
fn steps_that_were_given_up_leave_no_trace() {
    use ConstraintLevel::{Acceleration, Position};
    let folder = Folder::new("chosen");
    let scene = scene("five-bar");
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let mut rejected = 0;
    // each with fewer than 100 steps: one checkpoint means computing them again n^2 / 2 times
    let members = [("sdirk4", Acceleration), ("esdirk3", Position), ("esdirk4", Acceleration), ("esdirk5", Acceleration)];
    for (table, level) in members {
        let place = format!("{table}, {} level", level.name());
        let method = Method::new(table_by_name(table).expect("listed"), level);
        let settings = Settings { end: 2.5, ..scene.settings().without_method() }.choosing_steps(StepControl::new(1e-3));
        let mut prepared = Prepared::with(scene, &x, method, settings).expect("a sound scene");
        let forward = prepared.analysis().forward(&x).expect(&place);
        rejected += forward.rejected;
        // the same steps without those that were tried in vain
        let again = prepared.analysis().on_steps_of(&forward).forward(&x).expect(&place);
        assert_eq!(bits(&[again.values]), bits(&[forward.values]), "{place}");
        same_wherever_kept(&mut prepared, &folder, &place);
    }
    assert!(rejected > 10, "{rejected} steps were given up: too few to tell");
}

#[test]
fn a_multistep_method_starts_again_at_a_breakpoint_bit_by_bit() {
    let folder = Folder::new("restarted");
    let scene = scene("five-bar");
    for table in ["bdf2", "bdf3", "generalized-alpha", "newmark"] {
        let method = Method::new(table_by_name(table).expect("listed"), ConstraintLevel::Acceleration);
        let mut prepared = prepared(scene, method, 0.4, 20);
        prepared.grid.breakpoints.insert(7, Vec::new());
        same_wherever_kept(&mut prepared, &folder, table);
    }
}

#[test]
fn a_run_along_a_breakpoint_is_computed_again_bit_by_bit() {
    let scene = scene("five-bar");
    let mut prepared = prepared(scene, Prepared::default_method(), 0.4, 20);
    // a breakpoint where none of the scene's is: the acceleration is solved anew there
    prepared.grid.breakpoints.insert(7, Vec::new());
    let mut results = Vec::new();
    for keep in [Keep::Memory, Keep::Checkpoints(budget_for(&prepared, 2))] {
        prepared.keep = keep;
        let forward = prepared.analysis().forward(&prepared.x).expect("runs");
        results.push(bits(&prepared.analysis().adjoint(&prepared.x, &forward).expect("has a gradient").rows));
    }
    assert_eq!(results[0], results[1]);
}

#[test]
fn as_few_steps_are_computed_again_as_can_be_within_the_memory() {
    let scene = scene("pendulum");
    // with s checkpoints and r repetitions at most: r n - (s + r)! / ((s + 1)! (r - 1)!)
    let all = [(40, 1, 780), (40, 2, 200), (40, 3, 130), (57, 5, 144), (100, 4, 374), (100, 9, 234)];
    for (steps, checkpoints, recomputed) in all {
        let mut prepared = prepared(scene, Prepared::default_method(), 1.0, steps);
        let budget = budget_for(&prepared, checkpoints);
        prepared.keep = Keep::Checkpoints(budget);
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).expect("runs");
        assert_eq!(forward.history.usage().recomputed, 0);
        analysis.adjoint(&prepared.x, &forward).expect("has a gradient");
        let usage = forward.history.usage();
        assert_eq!(usage.recomputed, recomputed, "{steps} steps, {checkpoints} checkpoints");
        assert_eq!((usage.steps, usage.checkpoints), (1, checkpoints));
        // the checkpoint of the start is small: no increments yet
        let least = if checkpoints > 1 { budget / 4 } else { 0 };
        assert!(usage.bytes <= budget && usage.bytes > least, "{usage:?} within {budget}");
    }
}

#[test]
fn a_run_that_fits_into_the_memory_is_not_computed_again() {
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 1.0, 40);
    prepared.keep = Keep::Checkpoints(10_000_000);
    let forward = prepared.analysis().forward(&prepared.x).expect("runs");
    prepared.analysis().adjoint(&prepared.x, &forward).expect("has a gradient");
    let usage = forward.history.usage();
    assert_eq!((usage.steps, usage.checkpoints, usage.recomputed), (40, 0, 0));
}

#[test]
fn a_run_within_a_memory_is_kept_there_or_as_checkpoints_or_ends_with_both_sizes() {
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 1.0, 400);
    let budget = budget_for(&prepared, 20);
    let mut results = Vec::new();
    for (keep, checkpoints) in [(Keep::Auto, 0), (Keep::Within(budget), 20)] {
        prepared.keep = keep;
        let forward = prepared.analysis().forward(&prepared.x).expect("runs");
        results.push(bits(&prepared.analysis().adjoint(&prepared.x, &forward).expect("has a gradient").rows));
        let usage = forward.history.usage();
        assert_eq!(usage.checkpoints, checkpoints);
        assert!(checkpoints == 0 || usage.bytes <= budget, "{usage:?} within {budget}");
    }
    assert_eq!(results[0], results[1]);
    // how many steps there will be is not known
    let given = Settings { end: 1.0, steps: 400, ..scene.settings() };
    for settings in [given.clone().choosing_steps(StepControl::new(1e-10)), given.dividing_steps()] {
        let mut prepared = Prepared::with(scene, &prepared.x, Prepared::default_method(), settings).expect("a scene");
        prepared.keep = Keep::Within(budget);
        let message = prepared.analysis().forward(&prepared.x).expect_err("no room").to_string();
        assert_says(&message, &["memory", "take more than the", &format!("{budget} bytes allowed"), "in a file"]);
    }
}

#[test]
fn an_unknown_number_of_steps_keeps_to_its_memory_and_gives_the_same_steps() {
    let scene = scene("pendulum");
    let prepared = prepared(scene, Prepared::default_method(), 1.0, 150);
    let budget = budget_for(&prepared, 6);
    let problem = prepared.problem();
    let rerun = Rerun::new(&problem, &prepared.method, &prepared.grid, &prepared.plan);
    let mut online = Checkpoints::new(budget, None);
    march(&problem, &prepared.method, &prepared.grid, &prepared.plan, &mut online).expect("runs");
    let whole = prepared.analysis().forward(&prepared.x).expect("runs");
    let mut expected = whole.history.read(&rerun, Direction::Backward).expect("kept");
    let mut found = online.read(&rerun, Direction::Backward).expect("kept");
    for index in (0..150).rev() {
        let (a, b) = (expected.next().expect("kept"), found.next().expect("kept"));
        assert!(a.is_some() && a == b, "step {index} differs");
    }
    assert_eq!(found.next().expect("the end"), None);
    drop(found);
    let usage = online.usage();
    assert!(usage.checkpoints <= 6 && usage.bytes <= budget, "{usage:?}");
    // distances that double lose little against knowing the end
    assert!(usage.recomputed < 2 * 480, "{usage:?}");
}

#[test]
fn a_memory_without_room_for_one_checkpoint_is_refused_with_both_sizes() {
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 1.0, 40);
    prepared.keep = Keep::Checkpoints(100);
    let message = prepared.analysis().forward(&prepared.x).expect_err("no room").to_string();
    assert_says(&message, &["step 1 (t = 0 s)", "one step and one checkpoint take", "100 are allowed", "more memory"]);
}

#[test]
fn no_step_is_kept_where_no_gradient_is_asked_for() {
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 1.0, 40);
    let kept = prepared.analysis().forward(&prepared.x).expect("runs");
    assert_eq!(kept.history.usage().steps, 40);
    assert_eq!(bits(&[prepared.analysis().values(&prepared.x).expect("runs")]), bits(&[kept.values]));
    prepared.keep = Keep::Nothing;
    let forward = prepared.analysis().forward(&prepared.x).expect("runs");
    assert_eq!(forward.history.usage().steps, 0);
    let message = prepared.analysis().adjoint(&prepared.x, &forward).expect_err("nothing to go back through").to_string();
    assert_says(&message, &["kept no history", "a gradient needs one"]);
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
}

/// A run of 30 steps in a file.
fn in_file<'s>(scene: &'s dyn AnyScene, path: &Path) -> (Prepared<'s>, Forward) {
    let mut prepared = prepared(scene, Prepared::default_method(), 0.5, 30);
    prepared.keep = Keep::File(path.to_path_buf());
    let forward = prepared.analysis().forward(&prepared.x).expect("runs");
    (prepared, forward)
}

/// What the adjoint says after the file was changed.
fn complaint(prepared: &Prepared, forward: &Forward) -> String {
    let error = prepared.analysis().adjoint(&prepared.x, forward).expect_err("the file is not what it was");
    assert!(matches!(error, RunError::Stopped { reason: Stop::History, .. }), "{error:?}");
    error.to_string()
}

#[test]
fn a_finished_file_has_its_name_and_is_read_back() {
    let folder = Folder::new("whole");
    let (path, scene) = (folder.0.join("deep/run.bin"), scene("pendulum"));
    let (_, forward) = in_file(scene, &path);
    assert!(path.is_file() && !path.with_extension("bin.part").exists());
    assert_eq!(forward.history.usage().written, fs::metadata(&path).expect("is there").len());
    let (read, damage) = FileHistory::open(&path).expect("can be read");
    assert_eq!((read.steps(), damage), (30, None));
    assert_eq!(read.start_record(), forward.history.start_record());
}

#[test]
fn every_flipped_byte_is_noticed_and_the_steps_before_it_stay_readable() {
    let folder = Folder::new("flipped");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    let (prepared, forward) = in_file(scene, &path);
    let whole = fs::read(&path).expect("is there");
    let tenth = prepared.grid.times[9];
    let head = [10_u64.to_le_bytes(), tenth.to_le_bytes()].concat();
    let begin_of_tenth = whole.windows(16).position(|bytes| bytes == head).expect("number and time head a record") - 8;
    // any byte of the frame: lengths, number, record, checksum
    let length = u64::from_le_bytes(whole[begin_of_tenth..begin_of_tenth + 8].try_into().expect("8 bytes")) as usize + 24;
    for place in (begin_of_tenth..begin_of_tenth + 24).chain(begin_of_tenth + length - 40..begin_of_tenth + length) {
        let mut damaged = whole.clone();
        damaged[place] ^= 0x10;
        fs::write(&path, &damaged).expect("can be written");
        let message = complaint(&prepared, &forward);
        assert_says(
            &message,
            &[&format!("step 10 (t = {tenth} s)"), "run.bin", "damaged", "the first 9 steps of the file are intact"],
        );
        let (read, damage) = FileHistory::open(&path).expect("its start is whole");
        assert_eq!(read.steps(), 9);
        assert_says(&damage.expect("damaged").to_string(), &["step 10", "damaged", "the 9 steps before it are intact"]);
    }
}

#[test]
fn a_file_cut_off_says_how_much_of_it_is_left() {
    let folder = Folder::new("cut");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    let (prepared, forward) = in_file(scene, &path);
    let whole = fs::read(&path).expect("is there");
    // what a run goes on from stands at the end; the gradient does without
    let length = u64::from_le_bytes(*whole.last_chunk().expect("8 bytes")) as usize + 24;
    let steps = &whole[..whole.len() - length];
    fs::write(&path, steps).expect("can be written");
    prepared.analysis().adjoint(&prepared.x, &forward).expect("all steps are there");
    fs::write(&path, &steps[..steps.len() - 3]).expect("can be written");
    let message = complaint(&prepared, &forward);
    assert_says(&message, &["step 30 (t = 0.48", "ends after", "are needed", "the first 29 steps of the file are intact"]);
    let (read, damage) = FileHistory::open(&path).expect("its start is whole");
    assert_eq!(read.steps(), 29);
    assert_says(&damage.expect("cut off").to_string(), &["step 30", "ends after"]);
    // a guide needs the file, too
    let error = prepared.analysis().complex_step(&prepared.x, &forward).expect_err("cut off").to_string();
    assert_says(&error, &["step 30", "ends after"]);
}

#[test]
fn a_file_that_is_gone_is_named() {
    let folder = Folder::new("gone");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    let (prepared, forward) = in_file(scene, &path);
    fs::remove_file(&path).expect("was there");
    assert_says(&complaint(&prepared, &forward), &["step 30", "run.bin", "cannot be read", "run again"]);
    let message = FileHistory::open(&path).expect_err("gone").to_string();
    assert_says(&message, &["run.bin", "cannot be read"]);
    fs::write(&path, "something else, and long enough").expect("can be written");
    assert_says(&FileHistory::open(&path).expect_err("no run").to_string(), &["run.bin", "is no file of a run"]);
}

#[test]
fn a_folder_that_takes_no_file_is_refused_before_the_first_step() {
    let folder = Folder::new("blocked");
    fs::write(folder.0.join("block"), "a file where a folder is needed").expect("can be written");
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 0.5, 30);
    for path in [folder.0.join("block/run.bin"), folder.0.clone()] {
        prepared.keep = Keep::File(path);
        let message = prepared.analysis().forward(&prepared.x).expect_err("no file can be there").to_string();
        assert_says(&message, &["history file", "cannot be created", "checkpoints"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_in_place_of_a_part_is_refused_and_an_older_file_left_alone() {
    let folder = Folder::new("full");
    let path = folder.0.join("run.bin");
    // the header of an earlier version's file
    let earlier = b"costate run 02\r\n of an earlier run";
    fs::write(&path, earlier).expect("can be written");
    std::os::unix::fs::symlink("/dev/full", folder.0.join("run.bin.part")).expect("a link");
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 0.5, 30);
    prepared.keep = Keep::File(path.clone());
    let message = prepared.analysis().forward(&prepared.x).expect_err("a device is no file").to_string();
    assert_says(&message, &["run.bin.part", "a link that does not lead to a regular file", "name a regular file"]);
    assert_eq!(fs::read(&path).expect("untouched"), earlier);
}

#[test]
fn a_file_that_is_no_history_is_not_overwritten() {
    let folder = Folder::new("thesis");
    let path = folder.0.join("thesis.tex");
    let scene = scene("pendulum");
    let mut prepared = prepared(scene, Prepared::default_method(), 0.5, 30);
    prepared.keep = Keep::File(path.clone());
    for name in ["thesis.tex", "thesis.tex.part"] {
        fs::write(folder.0.join(name), "five years of work").expect("can be written");
        let message = prepared.analysis().forward(&prepared.x).expect_err("somebody's file").to_string();
        assert_says(&message, &["history file", name, "is there and is no file of a run"]);
        assert_eq!(fs::read(folder.0.join(name)).expect("untouched"), b"five years of work");
        fs::remove_file(folder.0.join(name)).expect("was there");
    }
    prepared.analysis().forward(&prepared.x).expect("runs");
}

#[test]
fn a_file_of_another_version_is_refused_as_that() {
    let folder = Folder::new("version");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    in_file(scene, &path);
    let own = fs::read(&path).expect("is there");
    assert!(own.starts_with(b"costate run 14"));
    for (header, what) in
        [("costate run 05", "a run of another version of this program"), ("costume run 06", "no file of a run")]
    {
        fs::write(&path, [header.as_bytes(), &own[header.len()..]].concat()).expect("can be written");
        assert_says(&FileHistory::open(&path).expect_err("not this version's").to_string(), &["run.bin", what]);
    }
}

#[test]
fn two_runs_do_not_mix_in_one_file() {
    let folder = Folder::new("two");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    let (prepared, first) = in_file(scene, &path);
    let mut x = prepared.x.clone();
    x[0] *= 1.1;
    let second = prepared.analysis().forward(&x).expect("runs");
    // the second one stands in the file now
    assert_says(&complaint(&prepared, &first), &["run.bin", "holds another run now", "run again"]);
    prepared.analysis().adjoint(&x, &second).expect("has its file");
    // and belongs to its own design
    for result in [
        prepared.analysis().adjoint(&prepared.x, &second),
        prepared.analysis().tangent(&prepared.x, &second),
        prepared.analysis().complex_step(&prepared.x, &second),
    ] {
        let message = result.expect_err("of another design").to_string();
        assert_says(&message, &["belongs to another design", "variable 0", &x[0].to_string(), &prepared.x[0].to_string()]);
    }
    // a run that is going on has its file to itself
    let going_on = FileHistory::create(&path, 7).expect("is free");
    let message = prepared.analysis().forward(&x).expect_err("is being written").to_string();
    assert_says(&message, &["run.bin", "another run is writing it"]);
    drop(going_on);
    prepared.analysis().forward(&x).expect("is free again");
}

#[test]
fn an_unfinished_run_is_kept_under_its_name_when_the_next_one_begins() {
    let folder = Folder::new("unfinished");
    let (path, scene) = (folder.0.join("run.bin"), scene("pendulum"));
    let mut prepared = prepared(scene, Prepared::default_method(), 0.5, 30);
    prepared.keep = Keep::File(path.clone());
    let mut steps = 0;
    let mut watch = costate::history::Watch(|_: &costate::integrators::StepRecord<f64>| {
        steps += 1;
        steps < 7
    });
    let (_, stopped) = prepared.analysis().observed(&prepared.x, &mut watch).expect("begins");
    assert!(stopped.is_some());
    prepared.analysis().forward(&prepared.x).expect("runs");
    let (left, damage) = FileHistory::open(&folder.0.join("run.bin.unfinished")).expect("can be read");
    assert_eq!((left.steps(), damage), (7, None));
    let (whole, _) = FileHistory::open(&path).expect("can be read");
    assert_eq!(whole.steps(), 30);
}

#[test]
fn a_run_that_fails_keeps_its_finished_steps_in_the_part_file() {
    let folder = Folder::new("failed");
    let (path, scene) = (folder.0.join("run.bin"), scene("five-bar"));
    // steps of half a second: the mechanism is thrown too far for Newton's method
    let table = table_by_name("midpoint").expect("listed");
    let mut prepared = prepared(scene, Method::new(table, ConstraintLevel::Acceleration), 5.0, 12);
    prepared.keep = Keep::File(path.clone());
    let mut steps = 0;
    let mut watch = costate::history::Watch(|_: &costate::integrators::StepRecord<f64>| {
        steps += 1;
        steps < 4
    });
    let (forward, stopped) = prepared.analysis().observed(&prepared.x, &mut watch).expect("begins");
    assert!(stopped.is_some() && forward.history.steps() > 0, "{stopped:?}");
    assert!(!path.exists());
    let (read, damage) = FileHistory::open(&folder.0.join("run.bin.part")).expect("can be read");
    assert_eq!((read.steps(), damage), (forward.history.steps(), None));
}
