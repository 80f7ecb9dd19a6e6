use super::flat::Flat;
use super::frames::{ANY_KIND, Damage, HEADER, KIND, PAUSE, Reader, check_place, write_frame};
use super::packed::unpack;
use super::{Direction, History, Rerun, Usage};
use crate::design::shortest;
use crate::integrators::{Observer, Pause, Replay, RunError, StartRecord, StepRecord, StepRule, Steps, Stop, TimeGrid};
use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Bytes of steps between two pauses, in those of a pause.
const SPARSE: u64 = 10;
/// Longest time without a pause, of steps that take long.
const LONGEST: Duration = Duration::from_secs(10);

/// A run in a file.
///
/// Behind the header with a number that no other run has, and one that tells what is simulated, stand the start and the steps, each with a
/// checksum. While the run goes on the file is called `NAME.part` and is locked; it gets its name when the run is complete, and what is in it
/// before stays readable: see [`FileHistory::open`]. Between steps, where they take a tenth of the room or no more than ten seconds lie between
/// them, stands all that it takes to go on from there: see [`FileHistory::resume`]. A part that an earlier run left with finished steps is kept
/// as `NAME.unfinished` by a run that does not go on with it.
pub struct FileHistory {
    path: PathBuf,
    /// Of the run.
    identity: u64,
    /// What it simulates.
    run: u64,
    /// Under its own name, not that of a part.
    complete: bool,
    out: Option<Box<dyn Write + Send + Sync>>,
    start: Option<StartRecord<f64>>,
    steps: usize,
    /// Bytes of complete frames, header included.
    bytes: u64,
    /// Where the first step begins, and where the last one ends.
    ends: [u64; 2],
    frame: Vec<u8>,
    /// What an earlier run left, until this one is as far.
    earlier: Option<EarlierRun>,
    taken_over: usize,
    /// Where the last pause ends, how long it is, and when it was written.
    paused: (u64, u64, Instant),
}

struct EarlierRun {
    steps: usize,
    /// Where the last pause begins, and how many steps there are before.
    pause: Option<(u64, usize)>,
    reader: Reader,
    /// Where the next step begins that is made once more.
    position: u64,
}

impl fmt::Debug for FileHistory {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} steps in {}", self.steps, self.place().display())
    }
}

fn part_of(path: &Path) -> PathBuf {
    beside(path, ".part")
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

fn opened_alone(options: &OpenOptions, path: &Path) -> io::Result<File> {
    let file = options.open(path)?;
    file.try_lock().map_err(|cause| match cause {
        TryLockError::WouldBlock => io::Error::other("another run is writing it"),
        TryLockError::Error(cause) => cause,
    })?;
    Ok(file)
}

fn has_steps(path: &Path) -> bool {
    let Ok(mut reader) = Reader::open(path) else { return false };
    reader.identity().is_ok() && reader.frame_at(HEADER, 0).is_ok() && reader.frame_at(HEADER + reader.length, 1).is_ok()
}

fn refuse_others(path: &Path) -> io::Result<()> {
    check_place(path)?;
    let mut file = match File::open(path) {
        Err(cause) if cause.kind() == io::ErrorKind::NotFound => return Ok(()),
        other => other?,
    };
    let mut first = [0; ANY_KIND.len()];
    if file.metadata()?.len() == 0 || file.read_exact(&mut first).is_ok() && first == *ANY_KIND {
        return Ok(());
    }
    Err(io::Error::other(format!("{} is there and is no file of a run", path.display())))
}

fn failure(place: String, path: &Path, cause: impl fmt::Display, hint: impl Into<String>) -> RunError {
    let place = format!("{place}, history file {}", path.display());
    RunError::stopped(Stop::History, place, cause.to_string(), hint)
}

const ELSEWHERE: &str = "name a file on a disk with room, or keep the run in memory or as checkpoints";

impl FileHistory {
    /// A new file for a run, of which a number tells what is simulated; folders above it are created, the file of an older run of this name stays until the run is complete.
    pub fn create(path: &Path, run: u64) -> Result<Self, RunError> {
        let refuse = |cause: &dyn fmt::Display| {
            RunError::Input(format!("history file {} cannot be created: {cause}; {ELSEWHERE}", path.display()))
        };
        if path.file_name().is_none() || path.is_dir() {
            return Err(refuse(&"it must be the name of a file, not of a folder"));
        }
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|cause| refuse(&cause))?;
        }
        let part = part_of(path);
        for there in [path, &part] {
            refuse_others(there).map_err(|cause| refuse(&cause))?;
        }
        let open = || opened_alone(File::options().write(true).create(true).truncate(false), &part);
        let file = || {
            let mut file = open()?;
            if has_steps(&part) {
                fs::rename(&part, beside(path, ".unfinished"))?;
                file = open()?;
            }
            file.set_len(0)?;
            Ok(file)
        };
        let file = file().map_err(|cause: io::Error| refuse(&cause))?;
        Self::writing(path, run, Box::new(file))
    }

    fn empty(path: &Path, identity: u64, run: u64) -> Self {
        FileHistory {
            path: path.to_path_buf(),
            identity,
            run,
            complete: false,
            out: None,
            start: None,
            steps: 0,
            bytes: 0,
            ends: [0; 2],
            frame: Vec::new(),
            earlier: None,
            taken_over: 0,
            paused: (HEADER, 0, Instant::now()),
        }
    }

    /// The same with what takes the bytes of the part.
    fn writing(path: &Path, run: u64, out: Box<dyn Write + Send + Sync>) -> Result<Self, RunError> {
        let identity = RandomState::new().hash_one(std::time::SystemTime::now());
        let mut own = FileHistory { out: Some(out), ..Self::empty(path, identity, run) };
        let header = [&KIND[..], &identity.to_le_bytes(), &run.to_le_bytes()].concat();
        own.append(&header).map_err(|cause| own.unwritten("start".into(), &cause))?;
        Ok(own)
    }

    /// The file of a run that stopped, to go on where it did: with the steps behind its last pause, which are made again and must be the same, and
    /// with new ones. That of a run that reached its end is not written again; without a file, or steps in it, this is a new one.
    pub fn resume(path: &Path, run: u64) -> Result<Self, RunError> {
        let part = part_of(path);
        for there in [path, &part] {
            let refuse = |cause| RunError::Input(format!("history file {}: cannot go on with it: {cause}", path.display()));
            check_place(there).map_err(refuse)?;
        }
        let (place, complete) = if has_steps(&part) { (&*part, false) } else { (path, true) };
        if !place.exists() {
            return Self::create(path, run);
        }
        let unusable = |cause: &dyn fmt::Display| {
            RunError::Input(format!("history file {}: cannot go on with it: {cause}", place.display()))
        };
        let mut file = None;
        if !complete {
            file = Some(opened_alone(File::options().read(true).write(true), place).map_err(|cause| unusable(&cause))?);
        }
        let (mut own, damage) = Self::open(place)?;
        if own.run != run {
            return Err(unusable(
                &"it holds a run of another scene, design, method, grid of steps, law of a part or version of this program; name another file, or leave out what asks to go on",
            ));
        }
        own.path = path.to_path_buf();
        own.complete = complete;
        if let Some(mut file) = file {
            // a record cut off, or damaged ones with all behind them
            let ready = file.set_len(own.bytes).and_then(|()| file.seek(SeekFrom::End(0)));
            ready.map_err(|cause| unusable(&cause))?;
            own.out = Some(Box::new(file));
        } else if let Some(damage) = damage {
            return Err(damage);
        }
        Ok(own)
    }

    pub fn place(&self) -> PathBuf {
        if self.complete { self.path.clone() } else { part_of(&self.path) }
    }

    /// Reads a file back: the steps before the first one that is damaged or cut off, and what is wrong with that one.
    pub fn open(path: &Path) -> Result<(Self, Option<RunError>), RunError> {
        let unread = |cause: &dyn fmt::Display| failure("start".into(), path, cause, "give the file of an earlier run");
        let mut reader = Reader::open(path).map_err(|cause| unread(&format!("cannot be read: {cause}")))?;
        let identity = reader.identity().map_err(|cause| unread(&cause))?;
        let frame = reader.frame_at(HEADER, 0).map_err(|cause| unread(&cause))?;
        let start = StartRecord::from_bytes(frame).ok_or_else(|| unread(&Damage::Unreadable))?;
        let (mut own, position) = (Self::empty(path, identity, reader.run), HEADER + reader.length);
        (own.complete, own.start, own.bytes, own.ends) = (true, Some(start), position, [position; 2]);
        let (mut pause, mut damage) = (None, None);
        while own.bytes < reader.size && damage.is_none() {
            let steps = own.steps as u64;
            match reader.load_frame(own.bytes) {
                Ok(number) if number == steps + 1 => {
                    (own.steps, own.ends[1]) = (own.steps + 1, own.bytes + reader.length);
                }
                Ok(number) if number == PAUSE + steps => {
                    pause = Some((own.bytes, own.steps));
                    own.paused = (own.bytes + reader.length, reader.length, Instant::now());
                }
                other => {
                    let cause = other.err().unwrap_or(Damage::Checksum);
                    let hint = format!("the {steps} steps before it are intact");
                    damage = Some(failure(format!("step {}", steps + 1), path, cause, hint));
                    continue;
                }
            }
            own.bytes += reader.length;
        }
        own.earlier = Some(EarlierRun { steps: own.steps, pause, reader, position });
        Ok((own, damage))
    }

    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let Some(out) = &mut self.out else { return Err(io::Error::other("the run is complete")) };
        if let Err(cause) = out.write_all(bytes).and_then(|()| out.flush()) {
            self.out = None;
            // half a record would only be in the way of a reader, who copes with it where it can't be cut off
            let _ = File::options().write(true).open(self.place()).and_then(|file| file.set_len(self.bytes));
            return Err(cause);
        }
        self.bytes += bytes.len() as u64;
        Ok(())
    }

    fn append_frame(&mut self, number: u64, record: &impl Flat) -> io::Result<()> {
        let mut frame = std::mem::take(&mut self.frame);
        write_frame(&mut frame, self.identity, number, record);
        let written = self.append(&frame);
        self.frame = frame;
        written
    }

    fn append_pause(&mut self, pause: &Pause<f64>) -> Result<(), RunError> {
        let begin = self.bytes;
        let written = self.append_frame(PAUSE + self.steps as u64, pause);
        written.map_err(|cause| self.unwritten(format!("behind step {}", self.steps), &cause))?;
        self.paused = (self.bytes, self.bytes - begin, Instant::now());
        Ok(())
    }

    fn is_behind(&self) -> bool {
        self.earlier.as_ref().is_some_and(|earlier| earlier.steps > self.steps)
    }

    /// A record made again must be the one that is there.
    fn check_same(&self, found: &[u8], again: &impl Flat, place: &str) -> Result<(), RunError> {
        if *found == again.bytes() {
            return Ok(());
        }
        let hint = "the scene, its laws or the program have changed since: begin a new file";
        Err(failure(place.into(), &self.place(), "differs from the one in the file when it is made once more", hint))
    }

    fn unwritten(&self, place: String, cause: &io::Error) -> RunError {
        let kept = match self.steps {
            0 => String::new(),
            steps => format!("the {steps} steps before it stay readable in {}; ", self.place().display()),
        };
        failure(place, &self.path, format!("cannot be written: {cause}"), kept + ELSEWHERE)
    }

    fn opened<'h>(&'h self, rerun: &'h Rerun<'_>, direction: Direction) -> Result<FromFile<'h>, RunError> {
        let (path, position) = (self.place(), self.ends[direction as usize]);
        let refuse = |cause: String| {
            let hint = "the gradient needs it: run again and leave the file in place until the gradient is there";
            failure(rerun.grid.place(self.steps.saturating_sub(1)), &path, cause, hint)
        };
        let mut reader = Reader::open(&path).map_err(|cause| refuse(format!("cannot be read: {cause}")))?;
        if reader.identity().map_err(|cause| refuse(cause.to_string()))? != self.identity {
            return Err(refuse("holds another run now".into()));
        }
        let (grid, rule, left, step) = (rerun.grid, rerun.rule(), 0..self.steps, StepRecord::default());
        Ok(FromFile { history: self, direction, grid, rule, reader, position, left, step })
    }
}

impl Observer for FileHistory {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        if let Some(found) = &self.start {
            return self.check_same(&found.bytes(), start, "start");
        }
        self.append_frame(0, start).map_err(|cause| self.unwritten("start".into(), &cause))?;
        (self.start, self.ends) = (Some(start.clone()), [self.bytes; 2]);
        Ok(())
    }
    fn take_up(&mut self, rule: StepRule, steps: Replay<f64>) -> Result<Option<Pause<f64>>, RunError> {
        // all that is found is made once more
        let all = std::mem::take(&mut self.steps);
        let Some(earlier) = &mut self.earlier else { return Ok(None) };
        earlier.steps = all;
        let Some((begin, count)) = earlier.pause else { return Ok(None) };
        let path = if self.complete { self.path.clone() } else { part_of(&self.path) };
        let damaged = |step: usize, damage| failure(format!("step {step}"), &path, damage, "begin a new file");
        let mut step = StepRecord::default();
        for number in 1..=count {
            let bytes = earlier.reader.step_from(&mut earlier.position, number);
            let read = bytes.and_then(|bytes| read_step(&mut step, bytes, rule));
            read.map_err(|damage| damaged(number, damage))?;
            earlier.position += earlier.reader.length;
            if !steps(&step)? {
                return Err(RunError::Interrupted { steps: number });
            }
        }
        let read = earlier
            .reader
            .load_frame(begin)
            .and_then(|_| Pause::from_bytes(earlier.reader.record()).ok_or(Damage::Unreadable));
        let pause = read.map_err(|damage| damaged(count, damage))?;
        earlier.position = begin + earlier.reader.length;
        (self.steps, self.taken_over) = (count, count);
        Ok(Some(pause))
    }
    fn checkpoint(&mut self, _index: usize, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        let (end, length, written) = self.paused;
        let due = self.bytes - end >= SPARSE * length || written.elapsed() >= LONGEST;
        let wanted = due && self.steps > 0 && self.bytes > end && self.out.is_some() && !self.is_behind();
        if wanted { self.append_pause(&pause()) } else { Ok(()) }
    }
    fn end(&mut self, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        if self.complete {
            return Ok(());
        }
        if self.bytes != self.paused.0 {
            self.append_pause(&pause())?;
        }
        let part = self.place();
        // some disks tell only now that they were full
        let stored = File::open(&part).and_then(|file| file.sync_all()).and_then(|()| fs::rename(&part, &self.path));
        // locked until it has its name
        self.out = None;
        stored.map_err(|cause| self.unwritten(format!("end, after step {}", self.steps), &cause))?;
        self.complete = true;
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        let number = self.steps + 1;
        if self.is_behind()
            && let Some(mut earlier) = self.earlier.take()
        {
            let place = format!("step {number}");
            let there = earlier.reader.step_from(&mut earlier.position, number);
            let there = there.map_err(|damage| failure(place.clone(), &self.place(), damage, "begin a new file"))?;
            self.check_same(there, step, &place)?;
            earlier.position += earlier.reader.length;
            (self.steps, self.earlier) = (number, Some(earlier));
            return Ok(true);
        }
        let place = |t: f64| format!("step {number} (t = {} s)", shortest(t));
        self.append_frame(number as u64, step).map_err(|cause| self.unwritten(place(step.t), &cause))?;
        (self.steps, self.ends[1]) = (number, self.bytes);
        Ok(true)
    }
}

impl History for FileHistory {
    fn start_record(&self) -> Option<&StartRecord<f64>> {
        self.start.as_ref()
    }
    fn steps(&self) -> usize {
        self.steps
    }
    fn read<'h>(&'h self, rerun: &'h Rerun<'_>, direction: Direction) -> Result<Box<dyn Steps + 'h>, RunError> {
        Ok(Box::new(self.opened(rerun, direction)?))
    }
    fn usage(&self) -> Usage {
        Usage { written: self.bytes, taken_over: self.taken_over, ..Usage::default() }
    }
}

fn read_step(step: &mut StepRecord<f64>, bytes: &[u8], rule: StepRule) -> Result<(), Damage> {
    unpack(step, bytes, rule).ok_or(Damage::Unreadable)
}

struct FromFile<'h> {
    history: &'h FileHistory,
    direction: Direction,
    grid: &'h TimeGrid,
    rule: StepRule<'h>,
    reader: Reader,
    /// Where the next frame begins, or ends on the way back.
    position: u64,
    left: Range<usize>,
    step: StepRecord<f64>,
}

impl FromFile<'_> {
    fn damaged(&self, index: usize, damage: Damage) -> RunError {
        let path = self.history.place();
        let intact = FileHistory::open(&path).map_or(0, |(intact, _)| intact.steps);
        let hint = format!("the first {intact} steps of the file are intact, the gradient needs all: run again");
        failure(self.grid.place(index), &path, damage, hint)
    }
}

impl Steps for FromFile<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        let Some(index) = self.direction.next_of(&mut self.left) else { return Ok(None) };
        let bytes = match self.direction {
            Direction::Forward => self.reader.step_from(&mut self.position, index + 1),
            Direction::Backward => self.reader.step_before(&mut self.position, index + 1),
        };
        let read = bytes.and_then(|bytes| read_step(&mut self.step, bytes, self.rule));
        read.map_err(|damage| self.damaged(index, damage))?;
        if self.direction == Direction::Forward {
            self.position += self.reader.length;
        }
        Ok(Some(&self.step))
    }
}

#[cfg(test)]
mod tests {
    use super::super::frames::FRAME;
    use super::*;
    use crate::assembly::{Equations, Unknowns, VectorsAvq};
    use crate::integrators::{ConstraintLevel, Method, SolveRecord, StageRecord, table_by_name};

    fn start() -> StartRecord<f64> {
        let base = VectorsAvq { a: vec![0.0], v: vec![1.0], q: vec![2.0] };
        let unknowns = Unknowns { x: vec![-9.81], ..Unknowns::default() };
        let acceleration = SolveRecord { t: 0.0, equations: Equations::acceleration(), base, unknowns };
        let (equilibrium, position_projection, velocity_projection) = (None, None, None);
        StartRecord {
            dropped: Vec::new(),
            sides: Vec::new(),
            clock: None,
            equilibrium,
            position_projection,
            velocity_projection,
            acceleration,
            axes: Vec::new(),
        }
    }

    fn step(index: usize) -> StepRecord<f64> {
        let mut step = StepRecord::default();
        (step.t, step.h, step.end) = (index as f64 * 0.1, 0.1, index as f64 * 0.1 + 0.1);
        step.dropped = vec![3];
        step.carried = vec![vec![step.t, -0.0, f64::NAN], vec![1.0 / 3.0, f64::MIN_POSITIVE, 1.0]];
        let mut stage = StageRecord::default();
        stage.solve.unknowns.x = vec![1.0, 2.0, 3.0];
        step.stages = vec![stage];
        step
    }

    struct Disk {
        file: File,
        room: usize,
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = self.file.write(&bytes[..bytes.len().min(self.room)])?;
            self.room -= count;
            if count == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(count) }
        }
        fn flush(&mut self) -> io::Result<()> {
            self.file.flush()
        }
    }

    #[test]
    fn a_disk_that_fills_up_names_the_step_and_keeps_all_before_it() {
        let folder = std::env::temp_dir().join(format!("costate-history-file-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("run.bin");
        let frame = step(0).bytes().len() + 8 + FRAME as usize;
        let before = HEADER as usize + start().bytes().len() + 8 + FRAME as usize;
        for (room, steps) in [(before + 5 * frame, 5), (before + 6 * frame - 1, 5), (before + 3 * frame + 1, 3), (before, 0)]
        {
            let file = File::create(part_of(&path)).unwrap();
            let mut history = FileHistory::writing(&path, 7, Box::new(Disk { file, room })).unwrap();
            history.start(&start()).unwrap();
            let error = (0..10).find_map(|index| history.step(&step(index)).err()).unwrap().to_string();
            let place = format!("step {} (t = {} s), history file {}", steps + 1, shortest(step(steps).t), path.display());
            assert!(error.starts_with(&place) && error.contains("cannot be written"), "{error}");
            assert_eq!(error.contains(&format!("the {steps} steps before it stay readable in")), steps > 0, "{error}");
            // nothing more is written behind a gap
            assert!(history.step(&step(11)).is_err());
            let (read, damage) = FileHistory::open(&part_of(&path)).unwrap();
            assert_eq!((read.steps, damage), (steps, None), "room for {room} bytes");
            assert!(!path.exists());
        }
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn bytes_that_are_no_record_are_refused() {
        let method = Method::new(table_by_name("midpoint").unwrap(), ConstraintLevel::Acceleration);
        let rule = StepRule { method: &method, constrained: false };
        let read = |bytes: &[u8]| {
            let mut step = StepRecord::default();
            unpack(&mut step, bytes, rule).map(|()| step)
        };
        let whole = step(3).bytes();
        let again = read(&whole).unwrap();
        assert_eq!(whole, again.bytes());
        assert_eq!(again.v[2], 1.0 + 0.1 * 3.0);
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_none(), "{length} of {} bytes", whole.len());
        }
        let mut long = whole.clone();
        long.push(0);
        assert!(read(&long).is_none());
        // a length beyond all memory, and one that is another vector's
        let carried = 8 * (3 + 1 + 2 + 1 + 1 + 1 + 1 + 1 + 1 + 1);
        assert_eq!(whole[carried..carried + 8], 3_u64.to_le_bytes());
        for length in [u64::MAX, 2] {
            let mut other = whole.clone();
            other[carried..carried + 8].copy_from_slice(&length.to_le_bytes());
            assert!(read(&other).is_none());
        }
        let mut other = step(3);
        other.carried[1].pop();
        assert!(read(&other.bytes()).is_none());
    }
}
