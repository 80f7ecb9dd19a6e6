//! The pitch of a blade from the geometry of rods, swash plate and link: triangles alone, no dynamics.

use costate::scalar::{Quaternion, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Radius on which rods and arm take hold of the lower plate, and how far below the sphere's centre \[m\].
const RODS: [f64; 2] = [0.4004, -0.02];
/// Length of the rods.
const ROD: f64 = 0.38;
/// Height of the sphere's centre, and of the blades.
const HEIGHTS: [f64; 2] = [0.4, 0.9];
/// Foot of a link, seen from the centre of the sphere, with the blade along x.
const FOOT: [f64; 3] = [0.278167, 0.1606, 0.03];
/// Place of a link's head along the blade, and its distance from the blade's axis.
const HEAD: [f64; 2] = [0.278167, 0.187];
/// What the scissors hold in the plane of the shaft.
const SCISSORS: [f64; 3] = [0.28, 0.0, 0.03];
/// Newton's corrections: with quotients for derivatives each leaves a millionth.
const CORRECTIONS: usize = 8;
/// Step of quotients.
const STEP: f64 = 1e-6;

fn up() -> Vector3<f64> {
    Vector3::new(0.0, 0.0, 1.0)
}

/// Zeros of as many equations as unknowns, from a guess.
fn solve<const N: usize>(mut x: [f64; N], equations: impl Fn(&[f64; N]) -> [f64; N]) -> [f64; N] {
    for _ in 0..CORRECTIONS {
        let values = equations(&x);
        let matrix = nalgebra::SMatrix::<f64, N, N>::from_fn(|row, column| {
            let mut moved = x;
            moved[column] += STEP;
            (equations(&moved)[row] - values[row]) / STEP
        });
        let Some(inverse) = matrix.try_inverse() else { return [f64::NAN; N] };
        let step = inverse * nalgebra::SVector::from(values);
        x.iter_mut().zip(step.iter()).for_each(|(x, step)| *x -= step);
    }
    x
}

/// A rotation by a vector along its axis, as long as its angle.
fn rotation(turn: [f64; 3]) -> Quaternion<f64> {
    let turn = Vector3::from(turn);
    let angle = turn.dot(&turn).sqrt();
    if angle > 0.0 { Quaternion::about(turn / angle, angle) } else { Quaternion::identity() }
}

/// Pitch \[rad\] of blade `blade` for the lifts of the rods at 90, 180 and 270 degrees and the azimuth of the shaft.
pub fn pitch(lifts: [f64; 3], azimuth: f64, blade: usize) -> f64 {
    let [radius, below] = RODS;
    let on_plate = |quarter: usize| {
        let (sine, cosine) = (quarter as f64 * FRAC_PI_2).sin_cos();
        Vector3::new(radius * cosine, radius * sine, below)
    };
    // height of the sphere and turn of the lower plate: the rods' lengths, and the arm's head in the plane of the arm
    let [height, x, y, z] = solve([HEIGHTS[0] + lifts.iter().sum::<f64>() / 3.0, 0.0, 0.0, 0.0], |&[height, x, y, z]| {
        let plate = rotation([x, y, z]);
        let at = |quarter: usize| up() * height + plate.rotate(on_plate(quarter));
        let length = |k: usize| {
            let foot = Vector3::new(on_plate(k + 1)[0], on_plate(k + 1)[1], lifts[k]);
            let rod = at(k + 1) - foot;
            rod.dot(&rod) - ROD * ROD
        };
        [length(0), length(1), length(2), at(0)[1]]
    });
    let (centre, plate) = (up() * height, rotation([x, y, z]));
    let [along, across] = [0.0, FRAC_PI_2].map(|more| {
        let (sine, cosine) = (azimuth + more).sin_cos();
        Vector3::new(cosine, sine, 0.0)
    });
    let upper = |turn: f64, point: Vector3<f64>| plate.rotate(Quaternion::about(up(), turn).rotate(point));
    let [turn] = solve([azimuth], |&[turn]| [upper(turn, Vector3::from(SCISSORS)).dot(&across)]);
    let quarter = Quaternion::about(up(), blade as f64 * FRAC_PI_2);
    let foot = centre + upper(turn, quarter.rotate(Vector3::from(FOOT)));
    let [along, across] = [along, across].map(|own| quarter.rotate(own));
    let head = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        along * HEAD[0] + across * (HEAD[1] * cosine) + up() * (HEIGHTS[1] + HEAD[1] * sine)
    };
    let link = Vector3::new(HEAD[0] - FOOT[0], HEAD[1] - FOOT[1], HEIGHTS[1] - HEIGHTS[0] - FOOT[2]);
    let [angle] = solve([0.0], |&[angle]| {
        let own = head(angle) - foot;
        [own.dot(&own) - link.dot(&link)]
    });
    angle
}
