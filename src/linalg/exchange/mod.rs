//! Ranks: processes that run the same program on the same numbers, and share the work of it.
//!
//! Every rank has all vectors, and decides what it does next by the same bits as the others. Between them go results of elements, pieces of factors and of
//! solutions, which come back to all of them, and what comes of work that is dealt, of which each rank, or each group of some, does other parts for
//! itself: what uses a solver does not know of ranks. One process is all there is unless the program was built with the feature `mpi`, started by `mpirun`, and
//! asked for ranks with [`start`].

mod dealt;
mod group;
#[cfg(feature = "mpi")]
mod mpi;
mod sent;
mod threads;

pub use crate::{sent_by_fields, sent_by_variants};
pub use dealt::{gather_work, of_first_at_work, see_work};
pub use sent::Sent;
/// Threads as ranks, for tests.
pub use threads::{STARTED_AT_MOST, on_ranks, on_ranks_within};
pub use threads::{new_thread, on_threads};

use std::time::Duration;

/// What a rank has spent on others so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Waiting for messages \[s\].
    pub waited: f64,
    /// Sent to other ranks \[bytes\].
    pub sent: f64,
    /// Time on processors along the longest path of work and messages that leads here \[s\]: what it would take if each rank had a core of its
    /// own, and a network of 2 microseconds and 10 GB/s between them. It knows of one thread of each rank.
    pub path: f64,
}

/// Time of a message on the way, and for each number in it \[ns\]: a network of 2 microseconds and 10 GB/s.
pub const MESSAGE: f64 = 2000.0;
pub const NUMBER: f64 = 0.8;

/// Messages among ranks, each of which calls the same functions in the same order as far as they concern another one.
///
/// No call returns an error: a rank that is gone, or that others wait for in vain, is the end of the program.
pub trait Exchange: Sync {
    /// Number of this rank, from zero on.
    fn rank(&self) -> usize;
    /// Number of all.
    fn ranks(&self) -> usize;
    /// Sends numbers on their way to another rank.
    fn send(&self, to: usize, message: Vec<f64>);
    /// Lets messages leave that have not yet, where a rank computes for long.
    fn hurry(&self) {}
    /// The next message of another rank, as soon as it is there.
    fn receive(&self, from: usize) -> Vec<f64>;
    /// The next message of another rank, if it is there already.
    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>>;
    /// The longest wait for a message.
    fn longest_wait(&self) -> Duration;
    /// Numbers of all ranks, one after the other; each gives so many.
    fn gather(&self, own: &[f64], counts: &[usize]) -> Vec<f64> {
        let own_rank = self.rank();
        assert_eq!(own.len(), counts[own_rank], "numbers of rank {own_rank}");
        (0..self.ranks()).filter(|&rank| rank != own_rank).for_each(|rank| self.send(rank, own.to_vec()));
        let of_rank = |rank: usize| {
            let numbers = if rank == own_rank { own.to_vec() } else { self.receive(rank) };
            match numbers.len() == counts[rank] {
                true => numbers,
                false => self.end(&format!("rank {rank} did something else at the same time")),
            }
        };
        (0..self.ranks()).flat_map(of_rank).collect()
    }
    /// What this rank has spent on the others so far.
    fn traffic(&self) -> Traffic {
        Traffic::default()
    }
    /// The number by which Fortran knows some of these ranks, this one among them, which all ask for it; none where they are no processes of MPI.
    #[cfg(feature = "mumps")]
    fn communicator(&self, _: std::ops::Range<usize>) -> Option<std::ffi::c_int> {
        None
    }
    /// Ends the programs of all ranks, for a reason.
    fn end(&self, reason: &str) -> !;
    /// Ends the programs of all ranks where one waited for another for too long.
    fn waited_in_vain(&self, what: &str) -> ! {
        self.end(&format!("no {what} within {} s", self.longest_wait().as_secs_f64()))
    }

    /// Lists of all ranks, of any lengths.
    fn gather_lists(&self, own: &[f64]) -> Vec<Vec<f64>> {
        let lengths = self.gather(&[own.len() as f64], &vec![1; self.ranks()]);
        let counts: Vec<usize> = lengths.iter().map(|&length| length as usize).collect();
        if counts.iter().all(|&count| count == 0) {
            return vec![Vec::new(); self.ranks()];
        }
        let mut rest = &self.gather(own, &counts)[..];
        let mut next = |count: usize| rest.split_off(..count).expect("as many numbers as counted").to_vec();
        counts.iter().map(|&count| next(count)).collect()
    }
}

/// The only process.
struct Alone;

impl Exchange for Alone {
    fn rank(&self) -> usize {
        0
    }
    fn ranks(&self) -> usize {
        1
    }
    fn send(&self, to: usize, _: Vec<f64>) {
        unreachable!("rank {to} of one")
    }
    fn receive(&self, from: usize) -> Vec<f64> {
        unreachable!("rank {from} of one")
    }
    fn receive_if_there(&self, from: usize) -> Option<Vec<f64>> {
        unreachable!("rank {from} of one")
    }
    fn longest_wait(&self) -> Duration {
        Duration::MAX
    }
    fn end(&self, reason: &str) -> ! {
        panic!("{reason}")
    }
}

/// All processes that `mpirun` started, if it did.
fn started() -> Option<&'static dyn Exchange> {
    #[cfg(feature = "mpi")]
    return mpi::started().map(|ranks| ranks as _);
    #[cfg(not(feature = "mpi"))]
    None
}

/// All ranks of this program that share the work of now.
pub fn world() -> &'static dyn Exchange {
    started().map_or(&Alone, |ranks| group::now().unwrap_or(ranks))
}

/// Runs what several threads do at once, so that no order of messages is the same on all ranks: each rank does all of it for itself.
pub fn apart<R>(work: impl FnOnce() -> R) -> R {
    let world = world();
    group::in_group(world, world.rank()..world.rank() + 1, |_| work())
}

/// How many processes `mpirun` started, whatever they do now.
pub fn processes() -> usize {
    started().map_or(1, |ranks| ranks.ranks())
}

/// Whether this process prints, and writes files: the first of all ranks.
pub fn is_first() -> bool {
    started().is_none_or(|ranks| ranks.rank() == 0)
}

/// Whether this process is one of several ranks.
pub fn is_shared() -> bool {
    started().is_some()
}

/// Numbers of all ranks that share the work of now, by ranks: one list where there is one process.
pub fn of_all_ranks(own: &[f64]) -> Vec<Vec<f64>> {
    world().gather_lists(own)
}

/// What this process has spent on other ranks so far.
pub fn traffic() -> Traffic {
    world().traffic()
}

/// The number that the first rank gives, where ranks share the work: each may have another one of its own, and all are to do the same.
pub fn of_first(own: f64) -> f64 {
    let world = world();
    if world.ranks() == 1 { own } else { world.gather(&[own], &vec![1; world.ranks()])[0] }
}

/// A number by which ranks tell whether they have the same ones: 52 bits that depend on all bits of all numbers.
pub fn digest(values: &[f64]) -> f64 {
    const PRIME: u64 = 0x9e37_79b9_7f4a_7c15;
    let mix = |state: u64, value: f64| (state ^ value.to_bits()).wrapping_mul(PRIME).rotate_left(29);
    // four that do not wait for each other
    let mut states = [1, 2, 3, 4];
    let (blocks, rest) = values.as_chunks::<4>();
    for block in blocks {
        (0..4).for_each(|lane| states[lane] = mix(states[lane], block[lane]));
    }
    let last = rest.iter().fold(values.len() as u64, |state, &value| mix(state, value));
    let all = states.into_iter().fold(last, |all, state| (all ^ state).wrapping_mul(PRIME).rotate_left(29));
    (all >> 12) as f64
}

/// Makes one of the processes that `mpirun` started, if it did; to be called once, before anything is printed.
///
/// # Errors
/// What the environment says of ranks and is no number.
pub fn start() -> Result<Started, String> {
    #[cfg(feature = "mpi")]
    mpi::start()?;
    Ok(Started(()))
}

/// Ranks at work.
pub struct Started(());

impl Started {
    /// Waits for the other ranks at the end of the program, with its exit code and the message of an error that the first rank has printed. One
    /// that failed alone says so, and ends them all.
    pub fn finish(self, code: u8, message: &str) {
        #[cfg(feature = "mpi")]
        if let Some(ranks) = mpi::started() {
            ranks.finish(code, message);
        }
        #[cfg(not(feature = "mpi"))]
        let _ = (code, message);
    }
}
