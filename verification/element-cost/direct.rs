//! What a user's formula costs when dual numbers go through it as it is written, beside the program of the same derivatives.

use super::timing::{Measured, least, number, repeated};
use super::user::{UserBeam, UserRevolute};
use costate::elements::{Constraint, Element, Flexible};
use costate::internals::{Formula, Node, Recorded};
use costate::prelude::Scalar;
use costate::scalar::{TANGENTS, Tangents};
use num_dual::Derivative;

/// Strains of all points.
const STRAINS: usize = 12;
const BEAM: usize = 21;
const JOINT: usize = 14;

/// T and V of (v, q, p).
fn energies<S: Scalar>(x: &[S], out: &mut [S]) {
    let (beam, (v, rest)) = (Flexible(UserBeam), x.split_at(BEAM));
    let (q, p) = rest.split_at(BEAM);
    let mut strains = [S::zero(); STRAINS];
    beam.strains(q, p, S::zero(), &mut strains);
    out.copy_from_slice(&[beam.kinetic(v, q, p), beam.stored(&strains, p)]);
}

/// g of (q, p).
fn gaps<S: Scalar>(x: &[S], out: &mut [S]) {
    let (q, p) = x.split_at(JOINT);
    UserRevolute.g(q, p, S::zero(), out);
}

/// Times of all derivatives of `outputs` results towards the first `moving` of `inputs` numbers [us]: by a program, by dual numbers.
fn times(
    [inputs, moving, outputs]: [usize; 3],
    recorded: fn(&[Recorded], &mut [Recorded]),
    written: fn(&[Tangents], &mut [Tangents]),
) -> [f64; 2] {
    let formula = Formula::record(inputs, |x| {
        let mut out = vec![Recorded::from(0.0); outputs];
        recorded(x, &mut out);
        out
    });
    let formula = formula.unwrap_or_else(|why| panic!("a formula without branches: {why}"));
    let program = formula.dense_program(("own 1", Default::default()), 0, |graph, x, outputs| {
        let one = graph.constant(1.0);
        let rows = outputs.iter().map(|&output| graph.reverse(&[output], &[one], &x[..moving]));
        rows.collect::<Vec<Vec<Node>>>().concat()
    });
    let mut x: Vec<Tangents> = (0..inputs).map(|i| Tangents::from(number(i))).collect();
    let mut out = vec![Tangents::from(0.0); outputs];
    let dual = Measured::new(move || {
        for first in (0..moving).step_by(TANGENTS) {
            for (i, x) in x.iter_mut().enumerate().take(moving) {
                let on = (first..first + TANGENTS).contains(&i);
                x.eps = if on {
                    Derivative::some(nalgebra::SVector::from_fn(|part, _| f64::from(u8::from(first + part == i))))
                } else {
                    Derivative::none()
                };
            }
            written(&x, &mut out);
            std::hint::black_box(&out);
        }
    });
    least([repeated(&program, false), dual], 25).map(|seconds| 1e6 * seconds)
}

/// Names and times.
pub fn compare() -> [(&'static str, [f64; 2]); 2] {
    let beam = times([2 * BEAM + 56, 2 * BEAM, 2], energies, energies);
    let joint = times([JOINT + 15, JOINT, 5], gaps, gaps);
    [("a user's beam, energies", beam), ("a user's revolute, g", joint)]
}
