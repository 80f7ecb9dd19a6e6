//! Blade elements in rings of momentum, and the flapping of a blade under them: no multibody dynamics.

use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Rate of the shaft [rad/s], chord, root and tip of a blade \[m\].
const OMEGA: f64 = 109.12;
const CHORD: f64 = 0.121;
const ROOT: f64 = 0.44;
const TIP: f64 = 2.0;
/// Air [kg/m3], slope of lift [1/rad], blades.
const AIR: f64 = 1.225;
const SLOPE: f64 = 5.7;
const BLADES: f64 = 4.0;
/// Halvings of an interval of inflows, whose upper end no rotor here reaches [m/s].
const HALVINGS: usize = 60;
const MOST_INFLOW: f64 = 200.0;
/// Places along a blade for its flapping.
const PLACES: usize = 400;

/// A strip of a rigid blade: its inflow [m/s], force on it for each length out of the plane of the chord and along the shaft [N/m], and the
/// moment about the shaft for each length \[N\].
pub struct Strip {
    pub inflow: f64,
    pub normal: f64,
    pub thrust: f64,
    pub torque: f64,
}

/// The strip at a radius of a blade at some pitch: lift 4 dL = 2 pi r rho 2 w^2 dr of rings of air, the root of w^2 rounded as in the scene.
fn strip(radius: f64, pitch: f64) -> Strip {
    let (sine, cosine) = pitch.sin_cos();
    let flow = |w: f64| [OMEGA * radius * cosine + w * sine, -OMEGA * radius * sine + w * cosine];
    let lift = |[along, up]: [f64; 2]| -0.5 * AIR * CHORD * SLOPE * up * along.hypot(up);
    let (mut low, mut high) = (0.0, MOST_INFLOW);
    for _ in 0..HALVINGS {
        let w = 0.5 * (low + high);
        let over = BLADES * lift(flow(w)) / (TAU * radius * AIR) - 2.0 * w * w.hypot(0.1);
        if over > 0.0 { low = w } else { high = w }
    }
    let inflow = 0.5 * (low + high);
    let [along, up] = flow(inflow);
    let speed = along.hypot(up);
    let attack = -up / speed;
    // NACA 0012 by Bailey (1941)
    let drag = 0.0087 - 0.0216 * attack + 0.4 * attack * attack;
    let pressure = 0.5 * AIR * CHORD * speed;
    let normal = pressure * (SLOPE * attack * along - drag * up);
    let chordwise = pressure * (-SLOPE * attack * up - drag * along);
    let thrust = normal * cosine + chordwise * sine;
    Strip { inflow, normal, thrust, torque: radius * (normal * sine - chordwise * cosine) }
}

/// Strips of equal width of a blade.
pub fn strips(count: usize, pitch: f64) -> Vec<Strip> {
    let width = (TIP - ROOT) / count as f64;
    (0..count).map(|i| strip(ROOT + (i as f64 + 0.5) * width, pitch)).collect()
}

/// Power of a blade that has these strips \[W\].
pub fn power(strips: &[Strip]) -> f64 {
    let width = (TIP - ROOT) / strips.len() as f64;
    OMEGA * width * strips.iter().map(|own| own.torque).sum::<f64>()
}

/// By how much the tip of a blade with EI [N m2] and a mass for each length [kg/m] rises out of the plane of the shaft \[m\]: EI v'''' - (T v')' - m omega^2 sin^2(pitch) v = p
/// with v out of the plane of the chord, T the centrifugal force beyond each place, p of the strips, by differences of second order.
pub fn coning(strips: &[Strip], pitch: f64, bending: f64, mass: f64) -> f64 {
    let h = (TIP - ROOT) / PLACES as f64;
    let tension = |x: f64| 0.5 * mass * OMEGA * OMEGA * (TIP * TIP - x * x);
    let (sine, cosine) = pitch.sin_cos();
    let aside = mass * OMEGA * OMEGA * sine * sine;
    // v(-1) = v(1), v(0) = 0 at the root; v'' = v''' = 0 at the tip: places beyond it are those of a straight line
    let mut matrix = DMatrix::<f64>::zeros(PLACES, PLACES);
    let mut load = DVector::<f64>::zeros(PLACES);
    for row in 0..PLACES {
        let place = row as isize + 1;
        let x = ROOT + place as f64 * h;
        let mut add = |at: isize, value: f64| {
            let last = PLACES as isize;
            match at {
                0 => {}
                -1 => matrix[(row, 0)] += value,
                at if at <= last => matrix[(row, at as usize - 1)] += value,
                beyond => {
                    let more = (beyond - last) as f64;
                    matrix[(row, PLACES - 1)] += value * (1.0 + more);
                    matrix[(row, PLACES - 2)] -= value * more;
                }
            }
        };
        let stiff = bending / h.powi(4);
        for (at, factor) in [(-2, 1.0), (-1, -4.0), (0, 6.0), (1, -4.0), (2, 1.0)] {
            add(place + at, factor * stiff);
        }
        let [before, after] = [x - 0.5 * h, x + 0.5 * h].map(|x| tension(x.min(TIP)) / (h * h));
        add(place - 1, -before);
        add(place, before + after - aside);
        add(place + 1, -after);
        let width = (TIP - ROOT) / strips.len() as f64;
        let own = (((x - ROOT) / width) as usize).min(strips.len() - 1);
        // half of the last piece is there
        load[row] = strips[own].normal;
    }
    let found = matrix.lu().solve(&load).map_or(f64::NAN, |v| v[PLACES - 1]);
    found * cosine
}
