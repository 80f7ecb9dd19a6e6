//! What the row of a design in a table follows from, as one number.

use super::{AnyScene, MechanismBuilder, Settings};
use crate::integrators::Method;
use crate::program::{Digest, Recorded, Recording, record};
use std::hash::{Hash, Hasher};

/// Bits of a whole number that a real one holds.
const BITS: u32 = f64::MANTISSA_DIGITS;

/// A whole number that is the same for the same laws, numbers, method and settings, and with gradients for the same way in
/// which the numbers follow the variables: a table whose row has it can be gone on with. Functionals and modes that are not
/// measured do not count. Not a number for a design that cannot be built.
pub fn fingerprint(
    scene: &dyn AnyScene,
    x: &[f64],
    (method, settings): (&Method, &Settings),
    is_measured: impl Fn(&str) -> bool,
    with_gradients: bool,
) -> f64 {
    let constants: Vec<Recorded> = x.iter().map(|&own| own.into()).collect();
    let (built, Recording { mut graph, .. }) =
        record(x, |variables| scene.build_recorded(if with_gradients { variables } else { &constants }));
    let Ok(MechanismBuilder { model, numbers, functionals, .. }) = built else { return f64::NAN };
    let words = format!("{}{method:?}{settings:?}", env!("CARGO_PKG_VERSION"));
    let mut digest = Digest::of(&(words, model.structural_signature()));
    for own in functionals.iter().filter(|own| is_measured(&own.name)) {
        (&own.name, own.law(&model)).hash(&mut digest);
    }
    for own in scene.modes().iter().filter(|own| is_measured(&own.name)) {
        format!("{own:?}").hash(&mut digest);
    }
    for list in [numbers.p, numbers.q, numbers.v] {
        list.len().hash(&mut digest);
        for number in list {
            (number.number().to_bits(), number.node(&mut graph)).hash(&mut digest);
        }
    }
    graph.hash(&mut digest);
    whole_number(&digest)
}

/// A digest as a whole number that a table of real numbers holds.
pub(crate) fn whole_number(own: &impl Hash) -> f64 {
    (Digest::of(own).finish() >> (u64::BITS - BITS)) as f64
}
