//! Andrews' squeezer: seven bodies in a plane, in seven angles, by an element and a constraint of their own.
//!
//! A point of a body is a chain of arms, z = sum (along + i across) exp(i angle). Bodies 1, 3, 5, 7 turn about fixed points; 2, 4, 6
//! hang on 1, 5, 7, so with rates w_i of the seven bodies and relative angles Theta, Phi, Omega
//!
//! T = (sum J_i w_i^2) / 2 + c2 cos(Theta) w1 w2 + c4 sin(Phi) w5 w4 + c6 sin(Omega) w7 w6,  V = k (l - l0)^2 / 2,
//!
//! a torque drives body 1, and three chains meet in one pin: g = 0, six equations. All 42 numbers are design variables.
//!
//! Source: Test Set for IVP Solvers (Bari), problem "Andrews' squeezing mechanism"; Schiehlen (1990).
//! Run: `cargo run --release --example 06_andrews`

use costate::prelude::*;

/// Masses and inertias of the bodies, places of hinges and mass centres, spring, torque.
#[rustfmt::skip]
pub const NUMBERS: [(&str, f64, &str); 42] = [
    ("m1", 0.04325, "kg"), ("m2", 0.00365, "kg"), ("m3", 0.02373, "kg"), ("m4", 0.00706, "kg"), ("m5", 0.07050, "kg"),
    ("m6", 0.00706, "kg"), ("m7", 0.05498, "kg"), ("I1", 2.194e-6, "kg m2"), ("I2", 4.410e-7, "kg m2"), ("I3", 5.255e-6, "kg m2"),
    ("I4", 5.667e-7, "kg m2"), ("I5", 1.169e-5, "kg m2"), ("I6", 5.667e-7, "kg m2"), ("I7", 1.912e-5, "kg m2"),
    ("rr", 7e-3, "m"), ("d", 28e-3, "m"), ("ss", 35e-3, "m"), ("e", 20e-3, "m"), ("zt", 40e-3, "m"), ("zf", 20e-3, "m"), ("u", 40e-3, "m"),
    ("xa", -0.06934, "m"), ("ya", -0.00227, "m"), ("xb", -0.03635, "m"), ("yb", 0.03273, "m"), ("xc", 0.014, "m"), ("yc", 0.072, "m"),
    ("ra", 0.92e-3, "m"), ("da", 11.5e-3, "m"), ("sa", 18.74e-3, "m"), ("sb", 10.43e-3, "m"), ("ea", 14.21e-3, "m"),
    ("ta", 23.08e-3, "m"), ("tb", 9.16e-3, "m"), ("fa", 14.21e-3, "m"), ("ua", 12.28e-3, "m"), ("ub", 4.49e-3, "m"),
    ("sc", 18e-3, "m"), ("sd", 20e-3, "m"), ("stiffness", 4530.0, "N/m"), ("rest length", 77.85e-3, "m"), ("torque", 0.033, "N m"),
];
/// beta, Theta, gamma, Phi, delta, Omega, epsilon at the start, at rest [rad].
#[rustfmt::skip]
pub const START: [f64; 7] = [
    -0.06171389001427645, 0.0, 0.4552798191630704, 0.2226683901658859, 0.4873649795438426, -0.2226683901658859, 1.2305474445498212,
];
/// The same after 0.03 s, as published [rad].
#[rustfmt::skip]
pub const PUBLISHED: [f64; 7] = [
    15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304, 0.5347301163226948, 1.048080741042263,
];

/// (along + i across) exp(i angle).
pub fn arm<S: Scalar>(angle: S, along: S, across: S) -> [S; 2] {
    let (sine, cosine) = angle.sin_cos();
    [along * cosine - across * sine, along * sine + across * cosine]
}

/// Inertia of the seven bodies, spring and torque; parameters: J1 to J7, c2, c4, c6, then those of the spring and the torque.
#[derive(Hash)]
pub struct SevenBodies;
impl Element for SevenBodies {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(7)]
    }
    fn parameters(&self) -> Vec<Parameter> {
        let inertia = (1..=7).map(|i| Parameter::named(format!("J{i}"), "kg m2"));
        let rest = ["c2", "c4", "c6", "xb - xc", "yb - yc", "sc", "sd", "stiffness", "rest length", "torque"];
        inertia.chain(rest.map(|name| Parameter::new(name, "SI"))).collect()
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let rates = [v[0], v[0] + v[1], v[2], v[4] + v[3], v[4], v[6] + v[5], v[6]];
        let mut alone = S::zero();
        for (&rate, &inertia) in rates.iter().zip(p) {
            alone += inertia * rate * rate * 0.5;
        }
        let [w1, w2, _, w4, w5, w6, w7] = rates;
        alone + p[7] * q[1].cos() * w1 * w2 + p[8] * q[3].sin() * w5 * w4 + p[9] * q[5].sin() * w7 * w6
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let [x, y] = arm(q[2], p[13], -p[12]);
        let stretch = ((p[10] + x) * (p[10] + x) + (p[11] + y) * (p[11] + y)).sqrt() - p[15];
        p[14] * stretch * stretch * 0.5
    }
    fn add_force<S: Scalar>(&self, _v: &[S], _q: &[S], p: &[S], _t: S, force: &mut [S]) {
        force[0] += p[16];
    }
}

/// The chains over body 3, bodies 5 and 4, bodies 7 and 6 end at the pin of body 2; parameters: rr to yb.
#[derive(Hash)]
pub struct Closure;
impl Constraint for Closure {
    const EQUATIONS: usize = 6;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(7)]
    }
    fn parameters(&self) -> Vec<Parameter> {
        NUMBERS[14..25].iter().map(|&(name, _, unit)| Parameter::new(name, unit)).collect()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let [rr, d, ss, e, zt, zf, u, xa, ya, xb, yb] = *p else { unreachable!() };
        let zero = S::zero();
        let (one, two, three) = (arm(q[0], rr, zero), arm(q[0] + q[1], -d, zero), arm(q[2], zero, -ss));
        let (four, five) = (arm(q[3] + q[4], zero, -e), arm(q[4], zt, zero));
        let (six, seven) = (arm(q[5] + q[6], zf, zero), arm(q[6], zero, -u));
        for (i, [a, b]) in [[xa, xb], [ya, yb]].into_iter().enumerate() {
            let pin = one[i] + two[i];
            g[i] = pin - three[i] - b;
            g[2 + i] = pin - four[i] - five[i] - a;
            g[4 + i] = pin - six[i] - seven[i] - a;
        }
    }
}

/// Parameters of [`SevenBodies`] from the 42 numbers.
#[rustfmt::skip]
pub fn inertia_and_spring<S: Scalar>(x: &[S]) -> Vec<S> {
    let [m1, m2, m3, m4, m5, m6, m7, i1, i2, i3, i4, i5, i6, i7, rr, _, _, e, zt, zf, u, _, _, xb, yb, xc, yc,
        ra, da, sa, sb, ea, ta, tb, fa, ua, ub, sc, sd, stiffness, rest, torque] = *x else { unreachable!() };
    let (four, six) = (e - ea, zf - fa);
    vec![
        i1 + m1 * ra * ra + m2 * rr * rr, i2 + m2 * da * da, i3 + m3 * (sa * sa + sb * sb), i4 + m4 * four * four,
        i5 + m5 * (ta * ta + tb * tb) + m4 * zt * zt, i6 + m6 * six * six, i7 + m7 * (ua * ua + ub * ub) + m6 * u * u,
        -m2 * rr * da, m4 * zt * four, -m6 * u * six, xb - xc, yb - yc, sc, sd, stiffness, rest, torque,
    ]
}

/// The mechanism; a start that a new design leaves open is projected onto closed ones.
pub struct Andrews;
impl Scene for Andrews {
    fn name(&self) -> String {
        "andrews-angles".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let bounds = |value: f64| (value - 0.1 * value.abs(), value + 0.1 * value.abs());
        NUMBERS.iter().map(|&(name, value, unit)| DesignVariable::new(name, value, bounds(value), unit)).collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.03, 600).projecting_start()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let angles = m.coordinates("angles", &START.map(S::from), &[S::zero(); 7]);
        m.element("seven bodies", &[angles], SevenBodies, &inertia_and_spring(x));
        m.constraint("closure", &[angles], Closure, &x[14..25]);
        m.coordinate_functional("beta at the end", Over::Terminal, angles, 0);
        Ok(())
    }
}

fn main() -> Result<(), RunError> {
    let scene = Prepared::new(&Andrews)?;
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x)?;
    let gradient = analysis.adjoint(&scene.x, &forward)?;
    let check = analysis.complex_step(&scene.x, &forward)?;
    println!("beta after 0.03 s: {:.10} rad (published {:.10})", forward.values[0], PUBLISHED[0]);
    for (variable, derivative) in scene.variables.iter().zip(&gradient.rows[0]) {
        println!(
            "a change of {:<11} by 1 % turns body 1 by {:>9.5} rad",
            variable.name,
            0.01 * variable.initial * derivative
        );
    }
    let scaled = |row: &[f64]| row.iter().zip(&scene.x).map(|(g, x)| g * x).collect::<Vec<_>>();
    let difference = largest_difference(&scaled(&check.rows[0]), &scaled(&gradient.rows[0]));
    println!("largest difference to complex step: {difference:.1e}");
    assert!((forward.values[0] - PUBLISHED[0]).abs() < 1e-7 && difference < 1e-10);
    Ok(())
}
