//! Records as plain bytes, the same in memory, in files and of checkpoints: numbers in order, little-endian, lists after their length.

use crate::assembly::{Equations, Level, StageCoefficients, Target, Unknowns, Variational, VectorsAvq};
use crate::integrators::{
    AxisRecord, Checkpoint, Contraction, Contractions, Counters, FactoredAt, Floor, ImpactRecord, KeptFactorization,
    OtherHit, Pause, Prediction, Renewal, Scheme, SetNumber, SideChange, SlipBefore, SolveRecord, Stability,
    StabilityCourse, StartRecord, StepError, StepErrors, StepSizeState, StepState, Track,
};

/// Something that is written as bytes and read back bit by bit.
pub(super) trait Flat: Sized {
    /// Appends it.
    fn put(&self, bytes: &mut Vec<u8>);
    /// Reads it off the front; `None` if the bytes are none of its kind.
    fn take(bytes: &mut &[u8]) -> Option<Self>;

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.put(&mut bytes);
        bytes
    }

    fn refill(list: &mut Vec<Self>, count: usize, bytes: &mut &[u8]) -> Option<()> {
        list.clear();
        for _ in 0..count {
            list.push(Self::take(bytes)?);
        }
        Some(())
    }
    fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        Self::take(&mut bytes).filter(|_| bytes.is_empty())
    }
}

fn split<'b>(bytes: &mut &'b [u8], count: usize) -> Option<&'b [u8]> {
    let (front, rest) = bytes.split_at_checked(count)?;
    *bytes = rest;
    Some(front)
}

/// Bytes as numbers with the same bits, as ranks send them; zeros fill the last one.
pub(super) fn numbers_of(bytes: &[u8]) -> Vec<f64> {
    let word = |own: &[u8]| {
        let mut word = [0; 8];
        word[..own.len()].copy_from_slice(own);
        f64::from_le_bytes(word)
    };
    bytes.chunks(8).map(word).collect()
}

/// Sets a list to the bytes of numbers.
pub(super) fn set_bytes(list: &mut Vec<u8>, numbers: &[f64]) {
    list.clear();
    list.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
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
    fn refill(list: &mut Vec<Self>, count: usize, bytes: &mut &[u8]) -> Option<()> {
        list.clear();
        let (numbers, _) = split(bytes, count.checked_mul(8)?)?.as_chunks();
        list.extend(numbers.iter().map(|&number| f64::from_le_bytes(number)));
        Some(())
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
        let mut list = Vec::new();
        retake(&mut list, bytes)?;
        Some(list)
    }
}

/// Reads a list into the memory of another one.
pub(super) fn retake<T: Flat>(list: &mut Vec<T>, bytes: &mut &[u8]) -> Option<()> {
    let count = usize::take(bytes)?;
    // every item has bytes: a damaged length asks for no memory
    (count <= bytes.len()).then(|| T::refill(list, count, bytes))?
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

/// A variant by its place among all.
macro_rules! listed {
    ($($kind:ident { $($variant:ident),* })*) => {$(
        impl Flat for $kind {
            fn put(&self, bytes: &mut Vec<u8>) {
                [$($kind::$variant),*].iter().position(|own| own == self).expect("all are listed").put(bytes);
            }
            fn take(bytes: &mut &[u8]) -> Option<Self> {
                [$($kind::$variant),*].get(usize::take(bytes)?).copied()
            }
        }
    )*};
}
listed! {
    Level { Position, Velocity, Acceleration }
    Scheme { Main, Starter, Euler }
}

impl Flat for Target {
    fn put(&self, bytes: &mut Vec<u8>) {
        let (is_rate, dof) = match *self {
            Target::Coordinate(dof) => (false, dof),
            Target::Rate(dof) => (true, dof),
        };
        (is_rate, dof).put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let (is_rate, dof) = Flat::take(bytes)?;
        Some(if is_rate { Target::Rate(dof) } else { Target::Coordinate(dof) })
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
    Equations { residual, constraint, level, metric, friction, variational }
    VectorsAvq<f64> { a, v, q }
    Unknowns<f64> { x, mu, local_mu }
    SolveRecord<f64> { t, equations, base, unknowns }
    Track<f64> { times, differences, used }
    Prediction<f64> { tracks }
    SideChange { switch, sides }
    SetNumber<f64> { event, target, value }
    ImpactRecord<f64> { event, solve, dropped, restitution, others, impulses, set, kept, axes }
    OtherHit { row, restitution }
    AxisRecord<f64> { friction, impacts }
    SlipBefore<f64> { friction, slip }
    StepState<f64> { step, scheme, dropped, chosen_anew, sides, switched, waiting, carried, last, forces, prediction, allowed }
    FactoredAt<f64> { t, base, unknowns }
    Contraction { rate, unseen }
    Contractions { known, age }
    Renewal { renews, trying, left, kept_for, cost, steps, other, step }
    Floor { corrections, unknowns }
    KeptFactorization<f64> { factored, at, floors, measured, measured_for, contractions, renewal }
    Checkpoint<f64> { between, kept }
    StepSizeState { h, last_error, rejected, halvings, left }
    StepError { share, step, t, dof, in_velocity }
    StepErrors { worst, sizes, accelerations, orientation, leap, stability }
    Stability { negative, neutral, determinant, turns }
    StabilityCourse { end, lost }
    Counters { systems, iterations, projecting, residuals, factorizations, solves, products, blocks, choices, nanoseconds }
    Pause<f64> { checkpoint, t, step_size, errors, counters }
}

impl Flat for StartRecord<f64> {
    fn put(&self, bytes: &mut Vec<u8>) {
        let StartRecord {
            dropped,
            sides,
            clock: _,
            equilibrium,
            position_projection,
            velocity_projection,
            acceleration,
            axes,
        } = self;
        dropped.put(bytes);
        sides.put(bytes);
        [equilibrium, position_projection, velocity_projection].into_iter().for_each(|own| own.put(bytes));
        acceleration.put(bytes);
        axes.put(bytes);
    }
    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let (dropped, sides) = Flat::take(bytes)?;
        let [equilibrium, position_projection, velocity_projection] = Flat::take(bytes)?;
        let (acceleration, axes) = Flat::take(bytes)?;
        Some(StartRecord {
            dropped,
            sides,
            clock: None,
            equilibrium,
            position_projection,
            velocity_projection,
            acceleration,
            axes,
        })
    }
}
