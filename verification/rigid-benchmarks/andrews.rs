//! Andrews' squeezer: seven angles after 0.03 s, in planar coordinates and of rigid bodies.

use super::{end_state, place, prepare, watch, worse};
use crate::Report;
use crate::andrews::{self as angles, PUBLISHED, START};
use costate::scenes::{Prepared, built_in};

const NAMES: [&str; 7] = ["beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon"];
/// Duration [s].
const END: f64 = 0.03;
/// Steps of the reference.
const REFERENCE: usize = 8_000;

/// The seven angles from the angles by which the seven bodies have turned [rad].
pub fn angles_of_turns(turns: [f64; 7]) -> [f64; 7] {
    let [one, two, three, four, five, six, seven] = turns;
    let moved = [one, two - one, three, four - five, five, six - seven, seven];
    std::array::from_fn(|i| START[i] + moved[i])
}

/// Angle of each body about the axis of the hinges [rad], from its Euler parameters.
pub fn body_angles(q: &[f64], places: [usize; 7]) -> [f64; 7] {
    places.map(|first| 2.0 * q[first + 6].atan2(q[first + 3]))
}

/// Places of the bodies' coordinates.
pub fn places_of_bodies(prepared: &Prepared) -> Result<[usize; 7], String> {
    let places: Result<Vec<usize>, String> = (1..=7).map(|body| place(prepared, &format!("K{body}"))).collect();
    places?.try_into().map_err(|_| "the scene has not seven bodies".into())
}

fn planar(table: &str, steps: usize) -> Result<[f64; 7], String> {
    let [q, _] = end_state(&prepare(&angles::Andrews, table, END, steps)?)?;
    q.try_into().map_err(|_| "not seven angles".into())
}

fn rigid_bodies(steps: usize) -> Result<[f64; 7], String> {
    let prepared = prepare(built_in::named("andrews")?, "sdirk4", END, steps)?;
    let places = places_of_bodies(&prepared)?;
    let (mut last, mut turns) = (body_angles(&prepared.mechanism.numbers.q, places), [0.0; 7]);
    watch(&prepared, |_, _, q, _| {
        let now = body_angles(q, places);
        for ((turn, last), now) in turns.iter_mut().zip(last).zip(now) {
            // a small angle, whatever the branch of the arctangent
            *turn += (now - last).sin().atan2((now - last).cos());
        }
        last = now;
        true
    })?;
    Ok(angles_of_turns(turns))
}

fn largest_difference(a: &[f64; 7], b: &[f64; 7]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| worse(most, (a - b).abs()))
}

/// Planar coordinates and rigid bodies by sdirk4 against esdirk5 with small steps, and against the published angles.
pub fn andrews(report: &mut Report) -> Result<(), String> {
    let reference = planar("esdirk5", REFERENCE)?;
    // of order 5: halving the step leaves 1/32 of the error
    let error = largest_difference(&planar("esdirk5", REFERENCE / 2)?, &reference) / 31.0;
    report.at_most("andrews/error of the reference, estimated", error, 1e-11);
    for (name, angles) in [("planar angles", planar("sdirk4", 4_000)?), ("rigid bodies", rigid_bodies(4_000)?)] {
        for (i, what) in NAMES.iter().enumerate() {
            report.compare(format!("andrews/{name}/{what} at 0.03 s"), angles[i], reference[i], 1e-9);
            report.compare(format!("andrews/{name}/{what}, published"), angles[i], PUBLISHED[i], 2e-9);
        }
    }
    Ok(())
}
