//! Records as plain bytes, the same for files and checkpoints: numbers in order, little-endian, lists after their length.

use crate::assembly::{Equations, Level, StageCoefficients, Unknowns, Variational, VectorsAvq};
use crate::integrators::{
    Checkpoint, Contraction, Contractions, Counters, FactoredAt, Floor, KeptFactorization, Pace, Pause, Prediction, Renewal,
    Scheme, SolveRecord, Stability, StabilityCourse, StageRecord, StartRecord, StepError, StepErrors, StepRecord, StepState,
    Track,
};

/// Something that is written as bytes and read back bit by bit.
pub(super) trait Flat: Sized {
    /// Appends it.
    fn put(&self, bytes: &mut Vec<u8>);
    /// Reads it off the front; `None` if the bytes are none of its kind.
    fn take(bytes: &mut &[u8]) -> Option<Self>;

    /// Its bytes.
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.put(&mut bytes);
        bytes
    }
    /// From all of the bytes.
    fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        Self::take(&mut bytes).filter(|_| bytes.is_empty())
    }
}

fn split<'b>(bytes: &mut &'b [u8], count: usize) -> Option<&'b [u8]> {
    let (front, rest) = bytes.split_at_checked(count)?;
    *bytes = rest;
    Some(front)
}

impl Flat for u64 {
    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        Some(u64::from_le_bytes(split(bytes, 8)?.try_into().ok()?))
    }
}

impl Flat for f64 {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.to_bits().put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        u64::take(bytes).map(f64::from_bits)
    }
}

impl Flat for usize {
    fn put(&self, bytes: &mut Vec<u8>) {
        (*self as u64).put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        usize::try_from(u64::take(bytes)?).ok()
    }
}

impl Flat for bool {
    fn put(&self, bytes: &mut Vec<u8>) {
        u64::from(*self).put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        match u64::take(bytes)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl<T: Flat> Flat for Vec<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.len().put(bytes);
        self.iter().for_each(|item| item.put(bytes));
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let count = usize::take(bytes)?;
        // every item has bytes: a damaged length asks for no memory
        (count <= bytes.len()).then(|| (0..count).map(|_| T::take(bytes)).collect())?
    }
}

impl<T: Flat> Flat for Option<T> {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.is_some().put(bytes);
        self.iter().for_each(|item| item.put(bytes));
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        Some(if bool::take(bytes)? { Some(T::take(bytes)?) } else { None })
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.0.put(bytes);
        self.1.put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        Some((A::take(bytes)?, B::take(bytes)?))
    }
}

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|item| item.put(bytes));
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let items: Option<Vec<T>> = (0..N).map(|_| T::take(bytes)).collect();
        items?.try_into().ok()
    }
}

const LEVELS: [Level; 4] = [Level::Position, Level::Velocity, Level::Acceleration, Level::Stabilized];

impl Flat for Level {
    fn put(&self, bytes: &mut Vec<u8>) {
        LEVELS.iter().position(|level| level == self).expect("all levels are listed").put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        LEVELS.get(usize::take(bytes)?).copied()
    }
}

const SCHEMES: [Scheme; 2] = [Scheme::Main, Scheme::Starter];

impl Flat for Scheme {
    fn put(&self, bytes: &mut Vec<u8>) {
        SCHEMES.iter().position(|scheme| scheme == self).expect("all schemes are listed").put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        SCHEMES.get(usize::take(bytes)?).copied()
    }
}

/// All fields in order; one that is missing here does not compile.
macro_rules! flat {
    ($($record:ident $(<$scalar:ty>)? { $($field:ident),* })*) => {$(
        impl Flat for $record $(<$scalar>)? {
            fn put(&self, bytes: &mut Vec<u8>) {
                let $record { $($field),* } = self;
                $($field.put(bytes);)*
            }
            fn take(bytes: &mut &[u8]) -> Option<Self> {
                Some($record { $($field: Flat::take(bytes)?),* })
            }
        }
    )*};
}
flat! {
    StageCoefficients { gamma, beta, alpha }
    Variational { alpha, h, first }
    Equations { residual, constraint, level, metric, variational }
    VectorsAvq<f64> { a, v, q }
    Unknowns<f64> { x, y, mu, eta, local_mu, local_eta }
    SolveRecord<f64> { t, equations, base, unknowns }
    StageRecord<f64> { solve, known, rate }
    StepRecord<f64> { t, h, scheme, dropped, restart, stages, position_projection, velocity_projection, q, v }
    StartRecord<f64> { dropped, equilibrium, position_projection, velocity_projection, acceleration }
    Track<f64> { times, differences, used }
    Prediction<f64> { tracks }
    StepState<f64> { step, scheme, dropped, chosen_anew, carried, rate, last, prediction, allowed }
    FactoredAt<f64> { t, base, unknowns }
    Contraction { rate, unseen }
    Contractions { known, age }
    Renewal { renews, trying, left, kept_for, cost, steps, other, step }
    Floor { corrections, unknowns }
    KeptFactorization<f64> { factored, at, floors, measured, measured_for, contractions, renewal }
    Checkpoint<f64> { between, kept }
    Pace { h, last_error, rejected, halvings, left }
    StepError { share, step, t, dof, in_velocity }
    StepErrors { worst, sizes, accelerations, orientation, leap, stability }
    Stability { negative, neutral, determinant, turns }
    StabilityCourse { end, lost }
    Counters { systems, iterations, projecting, residuals, factorizations, solves, products, blocks, choices, nanoseconds }
    Pause<f64> { checkpoint, t, pace, errors, counters }
}
