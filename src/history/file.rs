use super::flat::{Flat, checksum};
use super::{History, Rerun, Usage};
use crate::integrators::{Recorder, RunError, StartRecord, StepRecord, Steps, TimeGrid};
use std::fmt;
use std::fs::{self, File, TryLockError};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// First bytes of every file, before the identity of the run.
const KIND: &[u8; 16] = b"costate run 03\r\n";
/// The part of them that files of other versions have, too.
const ANY_KIND: &[u8] = b"costate run ";
/// Bytes before the first frame.
const HEADER: u64 = KIND.len() as u64 + 8;
/// Bytes of a frame beside its number and record: length, checksum, length.
const FRAME: u64 = 24;

/// A run in a file.
///
/// Behind the header with a number that no other run has, each record stands in a frame: the length of what follows, a number (0 for the
/// start, then the step), the record, a checksum of both and of the run's number, and the length again for the way back. While the run goes on
/// the file is called `NAME.part` and is locked; it gets its name when the run is complete, and what is in it before stays readable: see
/// [`FileHistory::open`]. A part that an earlier run left with finished steps is kept as `NAME.unfinished`.
pub struct FileHistory {
    path: PathBuf,
    /// Of the run.
    identity: u64,
    /// Under its own name, not that of a part.
    complete: bool,
    out: Option<Box<dyn Write + Send + Sync>>,
    start: Option<StartRecord<f64>>,
    steps: usize,
    /// Bytes of complete frames, header included.
    bytes: u64,
    frame: Vec<u8>,
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

/// Whether a file holds a finished step: its frames behind the first step are not read.
fn has_steps(path: &Path) -> bool {
    let Ok(mut reader) = Reader::open(path) else { return false };
    reader.identity().is_ok() && reader.frame_at(HEADER, 0).is_ok() && reader.frame_at(HEADER + reader.length, 1).is_ok()
}

/// Refuses what is there and is no file of a run.
fn refuse_others(path: &Path) -> io::Result<()> {
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
    RunError::History {
        place: format!("{place}, history file {}", path.display()),
        cause: cause.to_string(),
        hint: hint.into(),
    }
}

/// What to do about a file that can't be written.
const ELSEWHERE: &str = "name a file on a disk with room, or keep the run in memory or as checkpoints";

impl FileHistory {
    /// A new file; folders above it are created, the file of an older run of this name stays until the run is complete.
    ///
    /// # Errors
    /// A file or folder that cannot be created, another run that is writing this file, and a file of this name that is none of a run.
    pub fn create(path: &Path) -> Result<Self, RunError> {
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
        let open = || File::options().write(true).create(true).truncate(false).open(&part).map_err(|cause| refuse(&cause));
        let mut file = open()?;
        file.try_lock().map_err(|cause| match cause {
            TryLockError::WouldBlock => refuse(&"another run is writing it"),
            TryLockError::Error(cause) => refuse(&cause),
        })?;
        if has_steps(&part) {
            fs::rename(&part, beside(path, ".unfinished")).map_err(|cause| refuse(&cause))?;
            file = open()?;
            file.try_lock().map_err(|cause| refuse(&cause))?;
        }
        // of a device there is nothing to be cut off
        let _ = file.set_len(0);
        Self::writing(path, Box::new(file))
    }

    /// The same with what takes the bytes of the part.
    fn writing(path: &Path, out: Box<dyn Write + Send + Sync>) -> Result<Self, RunError> {
        let (path, frame) = (path.to_path_buf(), Vec::new());
        let identity = RandomState::new().hash_one(std::time::SystemTime::now());
        let mut own =
            FileHistory { path, identity, complete: false, out: Some(out), start: None, steps: 0, bytes: 0, frame };
        let header = [&KIND[..], &identity.to_le_bytes()].concat();
        own.append(&header).map_err(|cause| own.unwritten("start".into(), &cause))?;
        Ok(own)
    }

    /// The file under the name that it has now.
    pub fn place(&self) -> PathBuf {
        if self.complete { self.path.clone() } else { part_of(&self.path) }
    }

    /// Reads a file back: the steps before the first one that is damaged or cut off, and what is wrong with that one.
    ///
    /// # Errors
    /// A file that can't be read, is none of a run, or whose start is damaged.
    pub fn open(path: &Path) -> Result<(Self, Option<RunError>), RunError> {
        let unread = |cause: &dyn fmt::Display| failure("start".into(), path, cause, "give the file of an earlier run");
        let mut reader = Reader::open(path).map_err(|cause| unread(&format!("cannot be read: {cause}")))?;
        let identity = reader.identity().map_err(|cause| unread(&cause))?;
        let frame = reader.frame_at(HEADER, 0).map_err(|cause| unread(&cause))?;
        let start = StartRecord::from_bytes(frame).ok_or_else(|| unread(&Damage::Unreadable))?;
        let mut own = FileHistory {
            path: path.to_path_buf(),
            identity,
            complete: true,
            out: None,
            start: Some(start),
            steps: 0,
            bytes: HEADER + reader.length,
            frame: Vec::new(),
        };
        loop {
            if own.bytes == reader.size {
                return Ok((own, None));
            }
            if let Err(cause) = reader.frame_at(own.bytes, own.steps + 1) {
                let hint = format!("the {} steps before it are intact", own.steps);
                let damage = failure(format!("step {}", own.steps + 1), path, cause, hint);
                return Ok((own, Some(damage)));
            }
            own.steps += 1;
            own.bytes += reader.length;
        }
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

    fn append_frame(&mut self, number: usize, record: &impl Flat) -> io::Result<()> {
        let mut frame = std::mem::take(&mut self.frame);
        frame.clear();
        0_u64.put(&mut frame);
        number.put(&mut frame);
        record.put(&mut frame);
        let length = frame.len() as u64 - 8;
        frame[..8].copy_from_slice(&length.to_le_bytes());
        (checksum(&frame[8..]) ^ self.identity).put(&mut frame);
        length.put(&mut frame);
        let written = self.append(&frame);
        self.frame = frame;
        written
    }

    fn unwritten(&self, place: String, cause: &io::Error) -> RunError {
        let kept = match self.steps {
            0 => String::new(),
            steps => format!("the {steps} steps before it stay readable in {}; ", self.place().display()),
        };
        failure(place, &self.path, format!("cannot be written: {cause}"), kept + ELSEWHERE)
    }

    fn open_for<'h>(&'h self, grid: &'h TimeGrid, position: u64, next: Option<usize>) -> Result<FromFile<'h>, RunError> {
        let path = self.place();
        let refuse = |cause: String| {
            let hint = "the gradient needs it: run again and leave the file in place until the gradient is there";
            failure(grid.place(self.steps.saturating_sub(1)), &path, cause, hint)
        };
        let mut reader = Reader::open(&path).map_err(|cause| refuse(format!("cannot be read: {cause}")))?;
        if reader.identity().map_err(|cause| refuse(cause.to_string()))? != self.identity {
            return Err(refuse("holds another run now".into()));
        }
        Ok(FromFile { history: self, grid, reader, position, next, record: None })
    }
}

impl Recorder<f64> for FileHistory {
    fn start(&mut self, start: StartRecord<f64>) -> Result<(), RunError> {
        self.append_frame(0, &start).map_err(|cause| self.unwritten("start".into(), &cause))?;
        self.start = Some(start);
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        let number = self.steps + 1;
        let place = |t: f64| format!("step {number} (t = {t} s)");
        self.append_frame(number, step).map_err(|cause| self.unwritten(place(step.t), &cause))?;
        self.steps = number;
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
    fn finish(&mut self) -> Result<(), RunError> {
        let part = self.place();
        // some disks tell only now that they were full
        let stored = File::open(&part).and_then(|file| file.sync_all()).and_then(|()| fs::rename(&part, &self.path));
        // locked until it has its name
        self.out = None;
        stored.map_err(|cause| self.unwritten(format!("end, after step {}", self.steps), &cause))?;
        self.complete = true;
        Ok(())
    }
    fn forward<'h>(&'h self, rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        let mut steps = self.open_for(rerun.grid, HEADER, Some(0))?;
        steps.skip_start()?;
        Ok(Box::new(steps))
    }
    fn backward<'h>(&'h self, rerun: &'h Rerun<'_>) -> Result<Box<dyn Steps + 'h>, RunError> {
        Ok(Box::new(FromFileBackward(self.open_for(rerun.grid, self.bytes, self.steps.checked_sub(1))?)))
    }
    fn usage(&self) -> Usage {
        Usage { written: self.bytes, ..Usage::default() }
    }
}

/// Steps read one after the other.
struct FromFile<'h> {
    history: &'h FileHistory,
    grid: &'h TimeGrid,
    reader: Reader,
    /// Where the next frame begins, or ends on the way back.
    position: u64,
    next: Option<usize>,
    record: Option<StepRecord<f64>>,
}

/// The same from the last to the first.
struct FromFileBackward<'h>(FromFile<'h>);

impl FromFile<'_> {
    fn damaged(&self, index: usize, damage: Damage) -> RunError {
        let path = self.history.place();
        let intact = FileHistory::open(&path).map_or(0, |(intact, _)| intact.steps);
        let hint = format!("the first {intact} steps of the file are intact, the gradient needs all: run again");
        failure(self.grid.place(index), &path, damage, hint)
    }

    fn skip_start(&mut self) -> Result<(), RunError> {
        match self.reader.frame_at(self.position, 0) {
            Ok(_) => self.position += self.reader.length,
            Err(damage) => return Err(self.damaged(0, damage)),
        }
        Ok(())
    }

    fn read(&mut self, index: usize, begin: Result<u64, Damage>) -> Result<(), RunError> {
        let record = begin.and_then(|begin| {
            let bytes = self.reader.frame_at(begin, index + 1)?;
            StepRecord::from_bytes(bytes).ok_or(Damage::Unreadable)
        });
        self.record = Some(record.map_err(|damage| self.damaged(index, damage))?);
        Ok(())
    }
}

impl Steps for FromFile<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        let Some(index) = self.next.filter(|&index| index < self.history.steps) else { return Ok(None) };
        self.read(index, Ok(self.position))?;
        self.position += self.reader.length;
        self.next = Some(index + 1);
        Ok(self.record.as_ref())
    }
}

impl Steps for FromFileBackward<'_> {
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError> {
        let own = &mut self.0;
        let Some(index) = own.next else { return Ok(None) };
        let begin = own.reader.begin_before(own.position);
        own.read(index, begin)?;
        own.position -= own.reader.length;
        own.next = index.checked_sub(1);
        Ok(own.record.as_ref())
    }
}

/// What is wrong with a frame.
enum Damage {
    CutOff { size: u64, needed: u64 },
    OtherKind,
    Checksum,
    Unreadable,
    Io(io::Error),
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Damage::CutOff { size, needed } => write!(f, "ends after {size} bytes, but at least {needed} are needed"),
            Damage::OtherKind => f.write_str("is no file of a run, or of another version's"),
            Damage::Checksum => f.write_str("its record is damaged: the checksum differs"),
            Damage::Unreadable => f.write_str("its record is damaged: it is not that of a run of this program"),
            Damage::Io(cause) => write!(f, "cannot be read: {cause}"),
        }
    }
}

/// Reads frames.
struct Reader {
    file: File,
    size: u64,
    /// Of the run.
    identity: u64,
    /// Length of the frame read last.
    length: u64,
    bytes: Vec<u8>,
}

impl Reader {
    fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let size = file.metadata()?.len();
        Ok(Reader { file, size, identity: 0, length: 0, bytes: Vec::new() })
    }

    /// Reads the header: the identity of the run.
    fn identity(&mut self) -> Result<u64, Damage> {
        self.load(0, HEADER).map_err(|_| Damage::OtherKind)?;
        let (kind, mut identity) = self.bytes.split_at(KIND.len());
        if kind != KIND {
            return Err(Damage::OtherKind);
        }
        self.identity = u64::take(&mut identity).ok_or(Damage::OtherKind)?;
        Ok(self.identity)
    }

    fn load(&mut self, begin: u64, count: u64) -> Result<(), Damage> {
        let needed = begin.saturating_add(count);
        if needed > self.size {
            return Err(Damage::CutOff { size: self.size, needed });
        }
        self.bytes.resize(count as usize, 0);
        let read = self.file.seek(SeekFrom::Start(begin)).and_then(|_| self.file.read_exact(&mut self.bytes));
        read.map_err(Damage::Io)
    }

    /// The record in the frame that begins at a place, if it has the expected number.
    fn frame_at(&mut self, begin: u64, number: usize) -> Result<&[u8], Damage> {
        self.load(begin, 8)?;
        let length = u64::take(&mut &self.bytes[..]).ok_or(Damage::Checksum)?;
        // a damaged length may ask for more than there is: that is no file cut off
        if length > self.size {
            return Err(Damage::Checksum);
        }
        self.load(begin, length + FRAME)?;
        let (body, mut tail) = self.bytes[8..].split_at(length as usize);
        let own = (u64::take(&mut tail), u64::take(&mut tail));
        if own != (Some(checksum(body) ^ self.identity), Some(length)) || !body.starts_with(&(number as u64).to_le_bytes()) {
            return Err(Damage::Checksum);
        }
        self.length = length + FRAME;
        Ok(&self.bytes[16..8 + length as usize])
    }

    /// Where the frame begins that ends at a place.
    fn begin_before(&mut self, end: u64) -> Result<u64, Damage> {
        self.load(end.saturating_sub(8), 8)?;
        let length = u64::take(&mut &self.bytes[..]).ok_or(Damage::Checksum)?;
        end.checked_sub(length.saturating_add(FRAME)).ok_or(Damage::Checksum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{Equations, Unknowns, VectorsAvq};
    use crate::integrators::{Scheme, SolveRecord};

    fn start() -> StartRecord<f64> {
        let base = VectorsAvq { a: vec![0.0], v: vec![1.0], q: vec![2.0] };
        let unknowns = Unknowns { x: vec![-9.81], ..Unknowns::default() };
        let acceleration = SolveRecord { t: 0.0, equations: Equations::acceleration(), base, unknowns };
        StartRecord { dropped: Vec::new(), position_projection: None, velocity_projection: None, acceleration }
    }

    fn step(index: usize) -> StepRecord<f64> {
        let (t, h) = (index as f64 * 0.1, 0.1);
        let (q, v) = (vec![t, -0.0, f64::NAN], vec![1.0 / 3.0, f64::MIN_POSITIVE]);
        let (scheme, stages) = (Scheme::Main, Vec::new());
        StepRecord {
            t,
            h,
            scheme,
            dropped: vec![3],
            restart: None,
            stages,
            position_projection: None,
            velocity_projection: None,
            q,
            v,
        }
    }

    /// A disk with room for some bytes.
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
            let mut history = FileHistory::writing(&path, Box::new(Disk { file, room })).unwrap();
            history.start(start()).unwrap();
            let error = (0..10).find_map(|index| history.step(&step(index)).err()).unwrap().to_string();
            let place = format!("step {} (t = {} s), history file {}", steps + 1, step(steps).t, path.display());
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
        let whole = step(3).bytes();
        let again = StepRecord::from_bytes(&whole).unwrap().bytes();
        assert_eq!(whole, again);
        for length in 0..whole.len() {
            assert!(StepRecord::from_bytes(&whole[..length]).is_none(), "{length} of {} bytes", whole.len());
        }
        let mut long = whole.clone();
        long.push(0);
        assert!(StepRecord::from_bytes(&long).is_none());
        // a length beyond all memory
        let q = whole.len() - 8 * 7;
        assert_eq!(whole[q..q + 8], 3_u64.to_le_bytes());
        let mut huge = whole;
        huge[q..q + 8].fill(0xff);
        assert!(StepRecord::from_bytes(&huge).is_none());
    }
}
