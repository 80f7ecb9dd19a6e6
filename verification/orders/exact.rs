//! The exact motions: minimal coordinates, no constraint, and nothing of the library but its vectors.

use costate::scalar::{Quaternion, SpatialVector, Vector3};

/// What is compared at a time.
pub struct Exact {
    /// Coordinates of the moving node.
    pub q: Vec<f64>,
    /// Their rates.
    pub v: Vec<f64>,
    /// Multipliers of the joint.
    pub mu: Vec<f64>,
    /// Integral of the functional's quantity from the start.
    pub integral: f64,
}

/// Classical Runge-Kutta of order 4 with steps of about 1/20000 of a second: its own error is below round-off here.
fn integrate<const N: usize>(start: [f64; N], end: f64, rate: impl Fn(&[f64; N]) -> [f64; N]) -> [f64; N] {
    let steps = (end * 20_000.0).ceil().max(1.0);
    let h = end / steps;
    let moved = |y: &[f64; N], k: &[f64; N], h: f64| -> [f64; N] { std::array::from_fn(|i| y[i] + h * k[i]) };
    let (mut y, mut lost) = (start, [0.0; N]);
    for _ in 0..steps as usize {
        let k1 = rate(&y);
        let k2 = rate(&moved(&y, &k1, h / 2.0));
        let k3 = rate(&moved(&y, &k2, h / 2.0));
        let k4 = rate(&moved(&y, &k3, h));
        for i in 0..N {
            // compensated sum: 20000 additions would lose two digits
            let increment = h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) - lost[i];
            let sum = y[i] + increment;
            lost[i] = (sum - y[i]) - increment;
            y[i] = sum;
        }
    }
    y
}

/// The pendulum of mass 1 kg and length 1 m, released from rest at (-1, 0): theta'' = -g sin(theta), theta from below.
pub fn pendulum(t: f64) -> Exact {
    let gravity = 9.81;
    let start = [std::f64::consts::FRAC_PI_2, 0.0, 0.0];
    let [theta, rate, integral] = integrate(start, t, |[theta, rate, _]| [*rate, -gravity * theta.sin(), -theta.cos()]);
    let (sine, cosine) = theta.sin_cos();
    // g = (|x|^2 - l^2) / (2 l) pulls with mu: m l theta'^2 = mu - m g cos(theta)
    let mu = rate * rate + gravity * cosine;
    Exact { q: vec![-sine, -cosine, 0.0], v: vec![-cosine * rate, sine * rate, 0.0], mu: vec![mu], integral }
}

/// Time after its release at which the moving pendulum is taken over [s].
pub const TAKEN_OVER: f64 = 0.3;

/// The same pendulum, its time counted from a moment at which it moves.
pub fn moving_pendulum(t: f64) -> Exact {
    let before = pendulum(TAKEN_OVER).integral;
    let later = pendulum(TAKEN_OVER + t);
    Exact { integral: later.integral - before, ..later }
}

/// Angle of the same pendulum in closed form: sin(theta/2) = k cd(sqrt(g) t, k), k = sin(pi/4).
///
/// Source: Abramowitz & Stegun, 16.4 (arithmetic-geometric mean).
pub fn pendulum_angle(t: f64) -> f64 {
    let k = std::f64::consts::FRAC_1_SQRT_2;
    let (mut a, mut b, mut ratios) = (1.0f64, (1.0 - k * k).sqrt(), Vec::new());
    for _ in 0..6 {
        let c = (a - b) / 2.0;
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
        ratios.push(c / a);
    }
    let mut phi = f64::powi(2.0, 6) * a * 9.81f64.sqrt() * t;
    for ratio in ratios.iter().rev() {
        phi = (phi + (ratio * phi.sin()).asin()) / 2.0;
    }
    let cd = phi.cos() / (1.0 - k * k * phi.sin() * phi.sin()).sqrt();
    2.0 * (k * cd).asin()
}

/// A top of three different moments of inertia on a spherical joint at the origin.
pub struct HeavyTop;

impl HeavyTop {
    pub const MASS: f64 = 1.5;
    /// Principal moments about the mass centre [kg m2].
    pub const INERTIA: [f64; 3] = [0.05, 0.08, 0.03];
    /// From the joint to the mass centre, body frame [m].
    pub const ARM: [f64; 3] = [0.1, -0.05, 0.4];
    pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
    /// Start: Euler parameters before normalization, and body-frame angular velocity [rad/s].
    pub const ROTATION: [f64; 4] = [0.9, 0.3, -0.2, 0.1];
    pub const OMEGA: [f64; 3] = [0.5, -1.0, 6.0];

    /// Start rotation.
    pub fn start() -> Quaternion<f64> {
        let length = Quaternion(Self::ROTATION).norm_squared().sqrt();
        Quaternion(Self::ROTATION.map(|e| e / length))
    }

    /// domega/dt from Euler's equation about the joint, body frame.
    fn angular_acceleration(e: Quaternion<f64>, omega: Vector3<f64>) -> Vector3<f64> {
        let arm = Vector3::from(Self::ARM);
        // J_O = J + m (|c|^2 I - c c^T)
        let about_joint = |x: Vector3<f64>| {
            let own = Vector3::new(Self::INERTIA[0] * x[0], Self::INERTIA[1] * x[1], Self::INERTIA[2] * x[2]);
            own + (x * arm.dot(&arm) - arm * arm.dot(&x)) * Self::MASS
        };
        let moment = arm.cross(&e.rotate_back(Vector3::from(Self::GRAVITY))) * Self::MASS - omega.cross(&about_joint(omega));
        // Cramer's rule with the columns of J_O
        let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| about_joint(Vector3::from(unit)));
        let determinant = a.dot(&b.cross(&c));
        let components = [moment.dot(&b.cross(&c)), moment.dot(&c.cross(&a)), moment.dot(&a.cross(&b))];
        Vector3::from(components.map(|x| x / determinant))
    }

    /// The motion at a time; the integral is that of the height of the mass centre.
    pub fn at(t: f64) -> Exact {
        let (e, w) = (Self::start().0, Self::OMEGA);
        let start = [e[0], e[1], e[2], e[3], w[0], w[1], w[2], 0.0];
        let arm = Vector3::from(Self::ARM);
        let y = integrate(start, t, |y| {
            let (e, omega) = (Quaternion::from_slice(y), Vector3::first_three(&y[4..]));
            let (rate, acceleration) = (e.rate_of_body_velocity(omega), Self::angular_acceleration(e, omega).components());
            let height = e.rotate(arm)[2];
            [rate[0], rate[1], rate[2], rate[3], acceleration[0], acceleration[1], acceleration[2], height]
        });
        let (e, omega) = (Quaternion::from_slice(&y), Vector3::first_three(&y[4..]));
        let swing = omega.cross(&arm);
        let acceleration = e.rotate(Self::angular_acceleration(e, omega).cross(&arm) + omega.cross(&swing));
        // the multipliers are the force on the ground: m g - m a
        let mu = (Vector3::from(Self::GRAVITY) - acceleration) * Self::MASS;
        let q = [e.rotate(arm).components().to_vec(), e.0.to_vec()].concat();
        let v = [e.rotate(swing).components().to_vec(), e.rate_of_body_velocity(omega).to_vec()].concat();
        Exact { q, v, mu: mu.components().to_vec(), integral: y[7] }
    }
}
