//! Ranks that `mpirun` started.

use super::{Exchange, MESSAGE, NUMBER, Traffic, new_thread};
use ::mpi::ffi;
use costate_program::panic_is_caught;
use std::cell::Cell;
use std::io::Write;
use std::os::raw::{c_int, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
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
const FAREWELL: Duration = Duration::from_secs(5);
/// Looks without a pause: a message of a few numbers takes a microsecond.
const BUSY_LOOKS: usize = 2000;

thread_local! {
    /// What the processor had spent on this thread when it last came back from MPI \[s\].
    static LEFT: Cell<Option<f64>> = const { Cell::new(None) };
}

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
    /// What Fortran knows some of the ranks by.
    #[cfg(feature = "mumps")]
    of_some: Vec<(std::ops::Range<usize>, c_int)>,
    /// Messages that may not have left yet.
    sent: Vec<(ffi::MPI_Request, Vec<f64>)>,
    /// See [`Traffic::path`]; each message says in its last number when it left.
    path: f64,
}

impl Calls {
    /// A thread calls MPI.
    fn enter(&mut self) {
        self.path += LEFT.get().map_or(0.0, |left| processor_seconds() - left);
    }

    /// It goes on with its own work, some numbers after so many others have come that left at a time.
    fn leave(&mut self, sent: f64, messages: f64, numbers: usize) {
        self.path = self.path.max(sent + 1e-9 * (MESSAGE * messages + NUMBER * numbers as f64));
        LEFT.set(Some(processor_seconds()));
    }
}

/// What the processor has spent on this thread \[s\].
fn processor_seconds() -> f64 {
    // SAFETY: a structure of two numbers, which the call fills.
    let time = unsafe {
        let mut time: libc::timespec = std::mem::zeroed();
        libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time);
        time
    };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
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
    let own = within(longest_wait, "start of MPI", || Mpi::new(longest_wait))??;
    RANKS.get_or_init(|| own).end_with_panics();
    Ok(())
}

/// Calls functions of MPI that wait for other ranks without a limit; after one, the process ends.
///
/// # Errors
/// A thread that the system does not start, which has the clock.
fn within<R>(limit: Duration, what: &str, call: impl FnOnce() -> R) -> Result<R, String> {
    let (done, until_done) = channel::<()>();
    std::thread::scope(|scope| {
        let watch = move || {
            if until_done.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
                tell(&in_vain(what, limit));
                std::process::exit(OUT_OF_STEP);
            }
        };
        let started = new_thread().spawn_scoped(scope, watch);
        started.map_err(|refused| format!("the system starts no thread: {refused}"))?;
        let result = call();
        drop(done);
        Ok(result)
    })
}

/// Writes an error to stderr at once: lines of other ranks do not get into it.
fn tell(error: &str) {
    let _ = std::io::stderr().write_all(format!("error: {error}\n").as_bytes());
}

/// What came to an end without what a rank waited for.
fn in_vain(what: &str, limit: Duration) -> String {
    format!("no {what} within {} s ({LONGEST_WAIT} sets this limit)", limit.as_secs_f64())
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
            Calls {
                world: copies[0],
                at_end: copies[1],
                #[cfg(feature = "mumps")]
                of_some: Vec::new(),
                sent: Vec::new(),
                path: 0.0,
            }
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

    /// Ends all ranks where any thread of this one panics: the thread that it came from may wait for others, and these for other ranks.
    fn end_with_panics(&'static self) {
        let print = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            print(panic);
            if !panic_is_caught() {
                self.end_with(PANICKED, "a panic, which is a mistake in this program");
            }
        }));
    }

    /// Ends all ranks, for a reason.
    fn end_with(&self, code: c_int, reason: &str) -> ! {
        tell(&format!("rank {} of {}: {reason}", self.rank, self.ranks));
        self.abort(code)
    }

    /// See [`super::Started::finish`].
    pub fn finish(&self, code: u8, message: &str) {
        let calls = self.calls();
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
        let ended = within(self.longest_wait, "end of MPI", || unsafe { ffi::MPI_Finalize() });
        ended.unwrap_or_else(|refused| self.end(&refused));
    }
}

impl Mpi {
    /// Ends all ranks where this one does not end as the others; the first one has said why.
    fn end_alone(&self, code: c_int, message: &str) -> ! {
        if self.rank > 0 {
            self.end_with(code, message);
        }
        self.abort(code)
    }

    fn calls(&self) -> MutexGuard<'_, Calls> {
        self.calls.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next message of another rank, if there is one.
    fn found(&self, from: usize) -> Option<(ffi::MPI_Message, ffi::MPI_Status)> {
        let calls = self.calls();
        let mut is_there = 0;
        // SAFETY: both are numbers and pointers of C, of which all bits may be zero.
        let (mut message, mut status): (ffi::MPI_Message, ffi::MPI_Status) = unsafe { std::mem::zeroed() };
        // SAFETY: all pointers are to variables here.
        unsafe { ffi::MPI_Improbe(from as c_int, 0, calls.world, &mut is_there, &mut message, &mut status) };
        (is_there != 0).then_some((message, status))
    }

    /// The numbers of a message that was found.
    fn fetched(&self, (mut message, status): (ffi::MPI_Message, ffi::MPI_Status), from: usize) -> Vec<f64> {
        let (mut count, mut request) = (0, request());
        let mut values = {
            let _calls = self.calls();
            // SAFETY: pointers to variables here; the list is as long as the message, and lives until the request is done or the process ends.
            unsafe {
                ffi::MPI_Get_count(&status, ffi::RSMPI_DOUBLE, &mut count);
                let mut values = vec![0.0_f64; count as usize];
                ffi::MPI_Imrecv(values.as_mut_ptr().cast(), count, ffi::RSMPI_DOUBLE, &mut message, &mut request);
                values
            }
        };
        self.wait_for(|| format!("message of rank {from}"), || self.is_done(&mut request));
        let sent = values.pop().unwrap_or_default();
        self.calls().leave(sent, 1.0, values.len());
        values
    }

    fn is_done(&self, request: &mut ffi::MPI_Request) -> bool {
        let _calls = self.calls();
        is_done(request)
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

    fn send(&self, to: usize, mut message: Vec<f64>) {
        self.hurry();
        self.note_sent(message.len());
        let mut calls = self.calls();
        calls.enter();
        message.push(calls.path);
        let mut request = request();
        // SAFETY: the list keeps the numbers, which do not move with their owner, until the request is done.
        unsafe {
            let (values, count) = (message.as_ptr().cast::<c_void>(), self.count(message.len()));
            ffi::MPI_Isend(values, count, ffi::RSMPI_DOUBLE, to as c_int, 0, calls.world, &mut request);
        }
        calls.sent.push((request, message));
        calls.leave(0.0, 0.0, 0);
    }

    fn hurry(&self) {
        self.calls().sent.retain_mut(|(request, _)| !is_done(request));
    }

    fn receive(&self, from: usize) -> Vec<f64> {
        self.calls().enter();
        let mut found = None;
        self.wait_for(
            || format!("message of rank {from}"),
            || {
                found = self.found(from);
                found.is_some()
            },
        );
        found.map_or_else(Vec::new, |found| self.fetched(found, from))
    }

    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>> {
        self.found(from).map(|found| {
            self.calls().enter();
            self.fetched(found, from)
        })
    }

    fn longest_wait(&self) -> Duration {
        self.longest_wait
    }

    #[cfg(feature = "mumps")]
    fn communicator(&self, ranks: std::ops::Range<usize>) -> Option<c_int> {
        let mut calls = self.calls();
        let known = calls.of_some.iter().find(|(own, _)| *own == ranks);
        let communicator = known.map(|(_, communicator)| *communicator).unwrap_or_else(|| {
            let mut range = [[ranks.start as c_int, ranks.end as c_int - 1, 1]];
            // SAFETY: pointers to variables here, and ranks of the world, all of which do this.
            let own = unsafe {
                let (mut all, mut some, mut own) = (std::mem::zeroed(), std::mem::zeroed(), std::mem::zeroed());
                ffi::MPI_Comm_group(calls.world, &mut all);
                ffi::MPI_Group_range_incl(all, 1, range.as_mut_ptr(), &mut some);
                ffi::MPI_Comm_create_group(calls.world, some, 0, &mut own);
                ffi::MPI_Comm_c2f(own)
            };
            calls.of_some.push((ranks, own));
            own
        });
        Some(communicator)
    }

    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        assert_eq!(own.len(), counts[self.rank], "numbers of rank {}", self.rank);
        self.note_sent(own.len() * (self.ranks - 1));
        let (mut with_path, mut request) = (own.to_vec(), request());
        let counts: Vec<c_int> = counts.iter().map(|&count| self.count(count + 1)).collect();
        let starts: Vec<c_int> = counts.iter().scan(0, |end, count| Some(std::mem::replace(end, *end + count))).collect();
        let mut all = vec![0.0; counts.iter().map(|&count| count as usize).sum()];
        self.count(all.len());
        {
            let mut calls = self.calls();
            calls.enter();
            with_path.push(calls.path);
            // SAFETY: lists of all ranks, and room for the numbers of each, which live until the request is done or the process ends.
            unsafe {
                let (from, to, kind) = (with_path.as_ptr().cast(), all.as_mut_ptr().cast(), ffi::RSMPI_DOUBLE);
                let (lengths, places) = (counts.as_ptr(), starts.as_ptr());
                ffi::MPI_Iallgatherv(from, counts[self.rank], kind, to, lengths, places, kind, calls.world, &mut request);
            }
        }
        self.wait_for(|| "numbers of all ranks".into(), || self.is_done(&mut request));
        let (mut numbers, mut path) = (Vec::with_capacity(all.len()), 0.0_f64);
        for (start, count) in starts.into_iter().zip(counts) {
            let (of_rank, sent) = all[start as usize..].split_at(count as usize - 1);
            numbers.extend_from_slice(of_rank);
            path = path.max(sent[0]);
        }
        // of a collective call, messages double the numbers that ranks have
        self.calls().leave(path, (self.ranks as f64).log2().ceil(), numbers.len());
        numbers
    }

    fn traffic(&self) -> Traffic {
        let [waited, sent] = self.traffic.each_ref().map(|number| number.load(Ordering::Relaxed) as f64);
        let mut calls = self.calls();
        calls.enter();
        calls.leave(0.0, 0.0, 0);
        Traffic { waited: 1e-9 * waited, sent, path: calls.path }
    }

    fn end(&self, reason: &str) -> ! {
        self.end_with(OUT_OF_STEP, reason)
    }

    fn waited_in_vain(&self, what: &str) -> ! {
        self.end(&in_vain(what, self.longest_wait))
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

#[cfg(test)]
mod tests {
    use super::*;
    use costate_program::Formula;
    use std::process::Command;

    /// What a rank does, in its environment.
    const DOES: &str = "COSTATE_TEST_RANK";
    const THIS: &str = "exchange::mpi::tests::a_panic_of_any_thread_ends_all_ranks";

    /// The first rank waits for the second one, of which some thread panics.
    fn be_a_rank(does: &str) {
        start().expect("numbers in the environment");
        let ranks = started().expect("several ranks");
        let wait = || drop(ranks.receive(1 - ranks.rank()));
        let panic = || panic!("{does}");
        match does {
            _ if ranks.rank() == 0 => wait(),
            "waits for nobody" => panic(),
            "waits for a thread of the pool" => drop(rayon::join(wait, panic)),
            "waits for a thread" => std::thread::scope(|scope| {
                scope.spawn(panic);
                wait();
            }),
            _ => {
                let recorded = Formula::record(1, |_| panic!("of a formula"));
                assert!(recorded.is_err_and(|error| error.contains("of a formula")));
                ranks.send(0, vec![1.0]);
            }
        }
        ranks.finish(0, "");
    }

    /// As often as `COSTATE_FAULTS` says.
    #[test]
    fn a_panic_of_any_thread_ends_all_ranks() {
        if let Ok(does) = std::env::var(DOES) {
            return be_a_rank(&does);
        }
        let times = std::env::var("COSTATE_FAULTS").map_or(1, |times| times.parse().expect("a number"));
        let run = |does: &str| {
            let begun = Instant::now();
            let mut ranks = Command::new("mpirun");
            ranks.args(["--oversubscribe", "-n", "2"]).arg(std::env::current_exe().expect("this program"));
            ranks.args(["--exact", THIS, "--nocapture"]);
            ranks.env(DOES, does).env(LONGEST_WAIT, "100").env("RAYON_NUM_THREADS", "2");
            ranks.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
            let output = ranks.output().expect("mpirun is installed where the feature mpi is tested");
            (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned(), begun.elapsed())
        };
        for does in ["waits for nobody", "waits for a thread of the pool", "waits for a thread"] {
            let mut slowest = Duration::ZERO;
            for _ in 0..times {
                let (code, said, took) = run(does);
                assert!(code == Some(PANICKED) && took < Duration::from_secs(10), "{code:?} after {took:?}: {said}");
                assert!(said.contains(does) && said.contains("error: rank 1 of 2: a panic"), "{said}");
                slowest = slowest.max(took);
            }
            println!("a panic of a rank that {does}: {times} times, at most {slowest:.1?} with the start");
        }
        let (code, said, _) = run("has a formula that panics");
        assert_eq!(code, Some(0), "{said}");
    }
}
