//! Ranks that `mpirun` started.

use super::{Exchange, Traffic};
use ::mpi::ffi;
use std::io::Write;
use std::os::raw::{c_int, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Exit code of all ranks where one waited in vain, or where they did not do the same.
const OUT_OF_STEP: c_int = 70;
/// Exit code of all ranks where one panicked.
const PANICKED: c_int = 71;
/// What the environment calls the number of processes that `mpirun` started, that of Open MPI first.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];
/// What the environment calls the longest wait for another rank \[s\].
const LONGEST_WAIT: &str = "COSTATE_LONGEST_WAIT";
/// The longest wait where the environment does not say \[s\].
const USUAL_WAIT: f64 = 120.0;
/// The longest wait of a rank that failed for others that failed alike \[s\].
const FAREWELL: Duration = Duration::from_secs(3);
/// Looks without a pause: a message of a few numbers takes a microsecond.
const BUSY_LOOKS: usize = 2000;

static RANKS: OnceLock<Mpi> = OnceLock::new();

/// The ranks, if [`start`] found some.
pub(super) fn started() -> Option<&'static Mpi> {
    RANKS.get()
}

/// One process of all.
pub(super) struct Mpi {
    rank: usize,
    ranks: usize,
    longest_wait: Duration,
    calls: Mutex<Calls>,
    /// Waited so far \[ns\], and sent \[bytes\].
    traffic: [AtomicU64; 2],
}

/// What is needed to call MPI, by one thread at a time.
struct Calls {
    /// For messages while the program runs, and for its end.
    world: ffi::MPI_Comm,
    at_end: ffi::MPI_Comm,
    /// Messages that may not have left yet.
    sent: Vec<(ffi::MPI_Request, Vec<f64>)>,
}

// SAFETY: handles of MPI are those of the process, whichever thread uses them; the lock lets one thread at a time do so, which is what
// MPI_THREAD_SERIALIZED asks for.
unsafe impl Send for Calls {}

/// See [`super::start`].
///
/// # Errors
/// As there.
pub(super) fn start() -> Result<(), String> {
    let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
    // without mpirun, or for one process: a start takes a quarter of a second
    if SIZES.iter().find_map(|name| number(name)).is_none_or(|ranks| ranks < 2) {
        return Ok(());
    }
    let longest_wait = match std::env::var(LONGEST_WAIT) {
        Ok(text) => match text.parse::<f64>().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()) {
            Some(limit) => limit,
            None => return Err(format!("{LONGEST_WAIT} is \"{text}\": a number of seconds is needed")),
        },
        Err(_) => Duration::from_secs_f64(USUAL_WAIT),
    };
    let own = Mpi::new(longest_wait)?;
    RANKS.get_or_init(|| own);
    Ok(())
}

impl Mpi {
    /// # Errors
    /// An MPI that lets no thread but the first call it.
    fn new(longest_wait: Duration) -> Result<Self, String> {
        let (mut given, mut rank, mut ranks) = (0, 0, 0);
        // SAFETY: the first call of MPI, once in a process; null stands for the arguments of a program, and all other pointers are to
        // variables here. An error of any call ends all ranks, as MPI does unless it is told otherwise.
        let calls = unsafe {
            ffi::MPI_Init_thread(null_mut(), null_mut(), ffi::RSMPI_THREAD_SERIALIZED, &mut given);
            let world = ffi::RSMPI_COMM_WORLD;
            let mut copies = [world; 2];
            copies.iter_mut().for_each(|copy| {
                ffi::MPI_Comm_dup(world, copy);
            });
            ffi::MPI_Comm_rank(world, &mut rank);
            ffi::MPI_Comm_size(world, &mut ranks);
            Calls { world: copies[0], at_end: copies[1], sent: Vec::new() }
        };
        // SAFETY: a constant of MPI.
        if given < unsafe { ffi::RSMPI_THREAD_SERIALIZED } {
            return Err("this MPI lets only the first thread of a process call it".into());
        }
        Ok(Mpi {
            rank: rank as usize,
            ranks: ranks as usize,
            longest_wait,
            calls: Mutex::new(calls),
            traffic: Default::default(),
        })
    }

    /// Ends all ranks at once.
    fn abort(&self, code: c_int) -> ! {
        let _ = std::io::stdout().flush();
        // no lock: the thread that has it may be the one that panicked, or waits
        // SAFETY: MPI was started, and ends the process; the thread that calls it besides will not go on.
        unsafe { ffi::MPI_Abort(ffi::RSMPI_COMM_WORLD, code) };
        std::process::exit(code)
    }

    /// Looks until something is there; false after the limit.
    fn wait(&self, limit: Duration, mut is_there: impl FnMut() -> bool) -> bool {
        for _ in 0..BUSY_LOOKS {
            if is_there() {
                return true;
            }
        }
        let begun = Instant::now();
        loop {
            if is_there() {
                return true;
            }
            let waited = begun.elapsed();
            if waited > limit {
                return false;
            }
            // another rank may have the same core
            match waited.as_millis() {
                0..10 => std::thread::yield_now(),
                _ => std::thread::sleep(Duration::from_micros(100)),
            }
        }
    }

    fn wait_for(&self, what: impl Fn() -> String, is_there: impl FnMut() -> bool) {
        let begun = Instant::now();
        if !self.wait(self.longest_wait, is_there) {
            self.waited_in_vain(&what());
        }
        self.traffic[0].fetch_add(begun.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    fn note_sent(&self, numbers: usize) {
        self.traffic[1].fetch_add((numbers * size_of::<f64>()) as u64, Ordering::Relaxed);
    }

    /// Ends all ranks after a panic, which has been told.
    pub fn panicked(&self) -> ! {
        self.abort(PANICKED)
    }

    /// See [`super::Started::finish`].
    pub fn finish(&self, code: u8, message: &str) {
        let calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        let limit = if code == 0 { self.longest_wait } else { FAREWELL.min(self.longest_wait) };
        let codes = {
            let mut request = request();
            let (own, mut all) = (c_int::from(code), vec![0; self.ranks]);
            // SAFETY: as many numbers as ranks, which live until the request is done, or until the process ends.
            unsafe {
                let (from, to) = ((&raw const own).cast(), all.as_mut_ptr().cast());
                let kind = ffi::RSMPI_INT32_T;
                ffi::MPI_Iallgather(from, 1, kind, to, 1, kind, calls.at_end, &mut request);
            }
            if !self.wait(limit, || is_done(&mut request)) {
                match code {
                    0 => self.end("others did not come to the end of the program"),
                    _ => self.end_alone(code.into(), message),
                }
            }
            all
        };
        if codes.iter().any(|&other| other != c_int::from(code)) {
            let worst = codes.iter().copied().max().unwrap_or(OUT_OF_STEP);
            self.end_alone(worst, if code == 0 { "others failed" } else { message });
        }
        // SAFETY: all ranks are here, and no thread calls MPI afterwards.
        unsafe { ffi::MPI_Finalize() };
    }
}

impl Mpi {
    /// Ends all ranks where this one does not end as the others; the first one has said why.
    fn end_alone(&self, code: c_int, message: &str) -> ! {
        if self.rank > 0 {
            let _ = writeln!(std::io::stderr(), "error: rank {} of {}: {message}", self.rank, self.ranks);
        }
        self.abort(code)
    }

    /// The next message of another rank, if there is one.
    fn found(&self, calls: &Calls, from: usize) -> Option<(ffi::MPI_Message, ffi::MPI_Status)> {
        let mut is_there = 0;
        // SAFETY: both are numbers and pointers of C, of which all bits may be zero.
        let (mut message, mut status): (ffi::MPI_Message, ffi::MPI_Status) = unsafe { std::mem::zeroed() };
        // SAFETY: all pointers are to variables here.
        unsafe { ffi::MPI_Improbe(from as c_int, 0, calls.world, &mut is_there, &mut message, &mut status) };
        (is_there != 0).then_some((message, status))
    }

    /// The numbers of a message that was found, while the caller has the lock.
    fn fetched(&self, (mut message, status): (ffi::MPI_Message, ffi::MPI_Status), from: usize) -> Vec<f64> {
        let (mut count, mut request) = (0, request());
        // SAFETY: pointers to variables here; the list is as long as the message, and lives until the request is done or the process ends.
        let values = unsafe {
            ffi::MPI_Get_count(&status, ffi::RSMPI_DOUBLE, &mut count);
            let mut values = vec![0.0_f64; count as usize];
            ffi::MPI_Imrecv(values.as_mut_ptr().cast(), count, ffi::RSMPI_DOUBLE, &mut message, &mut request);
            values
        };
        self.wait_for(|| format!("message of rank {from}"), || is_done(&mut request));
        values
    }

    /// A number of numbers as MPI counts it.
    fn count(&self, numbers: usize) -> c_int {
        let most = || self.end(&format!("{numbers} numbers are more than one message of MPI takes"));
        c_int::try_from(numbers).unwrap_or_else(|_| most())
    }
}

impl Exchange for Mpi {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.ranks
    }

    fn send(&self, to: usize, message: Vec<f64>) {
        self.hurry();
        self.note_sent(message.len());
        let mut calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        let mut request = request();
        // SAFETY: the list keeps the numbers, which do not move with their owner, until the request is done.
        unsafe {
            let (values, count) = (message.as_ptr().cast::<c_void>(), self.count(message.len()));
            ffi::MPI_Isend(values, count, ffi::RSMPI_DOUBLE, to as c_int, 0, calls.world, &mut request);
        }
        calls.sent.push((request, message));
    }

    fn hurry(&self) {
        let mut calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        calls.sent.retain_mut(|(request, _)| !is_done(request));
    }

    fn receive(&self, from: usize) -> Vec<f64> {
        let calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        let mut found = None;
        self.wait_for(
            || format!("message of rank {from}"),
            || {
                found = self.found(&calls, from);
                found.is_some()
            },
        );
        found.map_or_else(Vec::new, |found| self.fetched(found, from))
    }

    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>> {
        let calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        self.found(&calls, from).map(|found| self.fetched(found, from))
    }

    fn longest_wait(&self) -> Duration {
        self.longest_wait
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        assert_eq!(own.len(), counts[self.rank], "numbers of rank {}", self.rank);
        self.note_sent(own.len() * (self.ranks - 1));
        let calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all = vec![0.0; counts.iter().sum()];
        self.count(all.len());
        let counts: Vec<c_int> = counts.iter().map(|&count| self.count(count)).collect();
        let starts: Vec<c_int> = counts.iter().scan(0, |end, count| Some(std::mem::replace(end, *end + count))).collect();
        let mut request = request();
        // SAFETY: lists of all ranks, and room for the numbers of each, which live until the request is done or the process ends.
        unsafe {
            let (from, to, kind) = (own.as_ptr().cast(), all.as_mut_ptr().cast(), ffi::RSMPI_DOUBLE);
            let (lengths, places) = (counts.as_ptr(), starts.as_ptr());
            ffi::MPI_Iallgatherv(from, counts[self.rank], kind, to, lengths, places, kind, calls.world, &mut request);
        }
        self.wait_for(|| "numbers of all ranks".into(), || is_done(&mut request));
        all
    }

    fn traffic(&self) -> Traffic {
        let [waited, sent] = self.traffic.each_ref().map(|number| number.load(Ordering::Relaxed) as f64);
        Traffic { waited: 1e-9 * waited, sent }
    }

    fn end(&self, reason: &str) -> ! {
        let _ = writeln!(std::io::stderr(), "error: rank {} of {}: {reason}", self.rank, self.ranks);
        self.abort(OUT_OF_STEP)
    }

    fn waited_in_vain(&self, what: &str) -> ! {
        let limit = self.longest_wait.as_secs_f64();
        self.end(&format!("no {what} within {limit} s ({LONGEST_WAIT} sets this limit)"))
    }
}

/// No request.
fn request() -> ffi::MPI_Request {
    // SAFETY: a constant of MPI.
    unsafe { ffi::RSMPI_REQUEST_NULL }
}

fn is_done(request: &mut ffi::MPI_Request) -> bool {
    let mut is_done = 0;
    // SAFETY: a request of this process, or none, which is done.
    unsafe { ffi::MPI_Test(request, &mut is_done, ffi::RSMPI_STATUS_IGNORE) };
    is_done != 0
}
