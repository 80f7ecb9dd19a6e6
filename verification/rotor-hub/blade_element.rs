//! Blade elements in rings of momentum, and the flapping of a blade under them: no multibody dynamics.

use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

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
/// Shapes in which a blade bends and twists, and places at which their products are summed.
const SHAPES: usize = 5;
const PLACES: usize = 2000;
/// Parts of a step of a blade that flaps, and times between which its pitch gives rates \[s\].
const DIVIDED: usize = 60;
const APART: f64 = 1e-5;

/// A strip of a rigid blade: its inflow [m/s], force on it for each length along the shaft [N/m], and the moment about the shaft for each
/// length \[N\].
pub struct Strip {
    pub inflow: f64,
    pub thrust: f64,
    pub torque: f64,
}

/// Lift for each length [N/m] of air that flows along the chord and out of its plane [m/s].
fn lift([along, up]: [f64; 2]) -> f64 {
    -0.5 * AIR * CHORD * SLOPE * up * along.hypot(up)
}

/// Forces for each length out of the plane of the chord and along it [N/m], with the drag of the NACA 0012 by Bailey (1941).
fn normal_and_chordwise([along, up]: [f64; 2]) -> [f64; 2] {
    let speed = along.hypot(up);
    let attack = -up / speed;
    let drag = 0.0087 - 0.0216 * attack + 0.4 * attack * attack;
    let pressure = 0.5 * AIR * CHORD * speed;
    [pressure * (SLOPE * attack * along - drag * up), pressure * (-SLOPE * attack * up - drag * along)]
}

/// What is left of 4 dL = 2 pi r rho 2 w^2 dr of rings of air [m2/s2], the root of w^2 rounded as in the scene.
fn over_momentum(flow: [f64; 2], radius: f64, w: f64) -> f64 {
    BLADES * lift(flow) / (TAU * radius * AIR) - 2.0 * w * w.hypot(0.1)
}

/// The strip at a radius of a blade at some pitch.
fn strip(radius: f64, pitch: f64) -> Strip {
    let (sine, cosine) = pitch.sin_cos();
    let flow = |w: f64| [OMEGA * radius * cosine + w * sine, -OMEGA * radius * sine + w * cosine];
    let (mut low, mut high) = (0.0, MOST_INFLOW);
    for _ in 0..HALVINGS {
        let w = 0.5 * (low + high);
        if over_momentum(flow(w), radius, w) > 0.0 { low = w } else { high = w }
    }
    let inflow = 0.5 * (low + high);
    let [normal, chordwise] = normal_and_chordwise(flow(inflow));
    let thrust = normal * cosine + chordwise * sine;
    Strip { inflow, thrust, torque: radius * (normal * sine - chordwise * cosine) }
}

/// Strips of equal width of a blade.
pub fn strips(count: usize, pitch: f64) -> Vec<Strip> {
    middles(count).0.map(|radius| strip(radius, pitch)).collect()
}

/// Power of a blade that has these strips \[W\].
pub fn power(strips: &[Strip]) -> f64 {
    let width = (TIP - ROOT) / strips.len() as f64;
    OMEGA * width * strips.iter().map(|own| own.torque).sum::<f64>()
}

/// A blade of a plate out of the plane of whose chord it bends by v = sum a_k s^(k + 2), and which twists by phi = sum b_k s^(k + 1), with
/// s from 0 at its root to 1 at its tip, and whose root is given a pitch:
///
/// m v.. + EI v'''' - (T v')' - m (omega^2 sin^2(pitch) + pitch.^2) v = p,
///
/// i (angle.. + omega^2 sin(angle) cos(angle)) - ((GJ + T c^2 / 12) phi')' = p c / 4 with angle = pitch + phi,
///
/// with T the centrifugal force beyond each place, the load p at a quarter of the chord c, and i = m c^2 / 12. Lag is left out.
pub struct Blade {
    /// i, of each length [kg m].
    polar: f64,
    /// Inertia and stiffness of bending and of twist.
    bending: [DMatrix<f64>; 2],
    twist: [DMatrix<f64>; 2],
}

/// Powers of s with their first and second derivatives by the radius.
fn shapes(radius: f64, first: i32) -> [DVector<f64>; 3] {
    let (s, length) = ((radius - ROOT) / (TIP - ROOT), TIP - ROOT);
    let shape = |derivative: i32| {
        DVector::from_fn(SHAPES, |k, _| {
            let power = first + k as i32;
            let factor: i32 = (0..derivative).map(|own| power - own).product();
            if factor == 0 { 0.0 } else { f64::from(factor) * s.powi(power - derivative) / length.powi(derivative) }
        })
    };
    [shape(0), shape(1), shape(2)]
}

/// Middles of strips of equal width, and the width.
fn middles(count: usize) -> (impl Iterator<Item = f64>, f64) {
    let width = (TIP - ROOT) / count as f64;
    ((0..count).map(move |i| ROOT + (i as f64 + 0.5) * width), width)
}

impl Blade {
    /// Of Young's modulus, shear modulus [N/m2], density [kg/m3] and thickness \[m\].
    pub fn new(young: f64, shear: f64, density: f64, thickness: f64) -> Self {
        let zero = || DMatrix::zeros(SHAPES, SHAPES);
        let (mut bending, mut twist) = ([zero(), zero()], [zero(), zero()]);
        let mass = density * CHORD * thickness;
        let (polar, radius_squared) = (mass * CHORD * CHORD / 12.0, CHORD * CHORD / 12.0);
        // a narrow rectangle in torsion (Timoshenko & Goodier, Theory of Elasticity)
        let torsion = shear * CHORD * thickness.powi(3) / 3.0 * (1.0 - 0.63 * thickness / CHORD);
        let (places, width) = middles(PLACES);
        for radius in places {
            let product = |shape: &DVector<f64>, factor: f64| shape * shape.transpose() * (factor * width);
            let tension = 0.5 * mass * OMEGA * OMEGA * (TIP * TIP - radius * radius);
            let [shape, slope, curvature] = shapes(radius, 2);
            bending[0] += product(&shape, mass);
            bending[1] += product(&curvature, young * CHORD * thickness.powi(3) / 12.0) + product(&slope, tension);
            let [shape, slope, _] = shapes(radius, 1);
            twist[0] += product(&shape, polar);
            twist[1] += product(&slope, torsion + tension * radius_squared);
        }
        Blade { polar, bending, twist }
    }

    /// By how much the tip rises at the ends of steps \[m\], from a straight blade in still air on, under a pitch that changes in time; `strips` of equal
    /// width have a load and an inflow each.
    pub fn tip(&self, strips: usize, pitch: impl Fn(f64) -> f64, step: f64, steps: usize) -> Vec<f64> {
        let inverse = |matrix: &DMatrix<f64>| matrix.clone().cholesky().map(|own| own.inverse());
        let [Some(by_bending), Some(by_twist)] = [&self.bending[0], &self.twist[0]].map(inverse) else { return Vec::new() };
        let (radii, width) = middles(strips);
        let strips: Vec<_> = radii.map(|radius| (radius, shapes(radius, 2), shapes(radius, 1))).collect();
        let rates = |t: f64, y: &DVector<f64>| {
            let [before, root, after] = [t - APART, t, t + APART].map(&pitch);
            let (turn, turning) = ((after - before) / (2.0 * APART), (after - 2.0 * root + before) / (APART * APART));
            let [a, a_rate, b, b_rate] = [0, 1, 2, 3].map(|own| y.rows(own * SHAPES, SHAPES));
            let aside = (OMEGA * root.sin()).powi(2) + turn * turn;
            let mut force = &self.bending[0] * a * aside - &self.bending[1] * a;
            let mut moment = -&self.twist[1] * b;
            let mut rate = DVector::zeros(y.len());
            for (i, (radius, [bent, ..], [twisted, ..])) in strips.iter().enumerate() {
                let w = y[4 * SHAPES + i];
                let (angle, turn) = (root + twisted.dot(&b), turn + twisted.dot(&b_rate));
                let (sine, cosine) = angle.sin_cos();
                // at three quarters of the chord
                let along = OMEGA * radius * cosine - turn * bent.dot(&a) + w * sine;
                let up = bent.dot(&a_rate) - OMEGA * radius * sine - turn * 0.25 * CHORD + w * cosine;
                let [normal, _] = normal_and_chordwise([along, up]);
                force += bent * (normal * width);
                moment +=
                    twisted * ((normal * 0.25 * CHORD - self.polar * (OMEGA * OMEGA * sine * cosine + turning)) * width);
                // the mass of air of Pitt & Peters (1981)
                rate[4 * SHAPES + i] = over_momentum([along, up], *radius, w) * 3.0 * PI / (8.0 * TIP);
            }
            rate.rows_mut(0, SHAPES).copy_from(&a_rate);
            rate.rows_mut(SHAPES, SHAPES).copy_from(&(&by_bending * force));
            rate.rows_mut(2 * SHAPES, SHAPES).copy_from(&b_rate);
            rate.rows_mut(3 * SHAPES, SHAPES).copy_from(&(&by_twist * moment));
            rate
        };
        let (mut y, h) = (DVector::zeros(4 * SHAPES + strips.len()), step / DIVIDED as f64);
        let mut heights = Vec::new();
        for part in 1..=steps * DIVIDED {
            // Kutta (1901)
            let t = (part - 1) as f64 * h;
            let first = rates(t, &y);
            let second = rates(t + 0.5 * h, &(&y + &first * (0.5 * h)));
            let third = rates(t + 0.5 * h, &(&y + &second * (0.5 * h)));
            let fourth = rates(t + h, &(&y + &third * h));
            y += (first + (second + third) * 2.0 + fourth) * (h / 6.0);
            if part % DIVIDED == 0 {
                heights.push(y.rows(0, SHAPES).sum() * pitch(part as f64 * h).cos());
            }
        }
        heights
    }
}
