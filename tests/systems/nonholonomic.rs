//! Constraints on velocities: rolling against closed forms, conservation and complex steps.

use crate::support::Random;
use costate::elements::{NodeKind, Nonholonomic, State};
use costate::functionals::Over;
use costate::integrators::{ConstraintLevel, Method, table_by_name};
use costate::internals::{ConstraintPhysics, RollingDisc, RollingSphere};
use costate::scalar::{COMPLEX_STEP, Complex64, Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, MechanismBuilder, Prepared, Scene, Settings, Signal};
use costate::sensitivity::largest_difference;
use std::sync::Arc;

const END: f64 = 4.0;
const START: [f64; 2] = [0.7, -0.2];
const SPEED: [f64; 2] = [0.3, 0.5];
const TURN: f64 = 3.0;

/// A solid ball on a turntable: its centre moves on a circle with 2/7 of the table's angular velocity, whatever its size and mass.
///
/// Source: Earnshaw (1844); Burns (1981), American Journal of Physics 49, 56-58.
struct BallOnTurntable;

impl Scene for BallOnTurntable {
    fn name(&self) -> String {
        "ball on turntable".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("radius", 0.15, (0.01, 1.0), "m"),
            DesignVariable::new("mass", 0.4, (0.01, 1.0), "kg"),
            DesignVariable::new("turn", TURN, (0.0, 10.0), "rad/s"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(END, 400)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [radius, mass, turn] = x else { return Err("3 variables".into()) };
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let (ground, z) = (m.ground(), at([0.0, 0.0, 1.0]));
        let table = m.body("table", Vector3::zeros(), Quaternion::identity());
        m.set_velocity(table, Vector3::zeros(), z * *turn);
        m.rigid_body("table", table, S::from(2.0), Vector3::zeros(), [1.0, 1.0, 2.0, 0.0, 0.0, 0.0].map(S::from));
        m.revolute("bearing", [ground, table], Vector3::zeros(), z);
        m.prescribed_rotation("drive", [ground, table], z, Signal::ConstantRate { offset: S::zero(), rate: *turn });

        let centre = at([START[0], START[1], 0.0]) + z * *radius;
        let velocity = at([SPEED[0], SPEED[1], 0.0]);
        let ball = m.body("ball", centre, Quaternion::about(at([0.6, 0.0, 0.8]), S::from(0.4)));
        // v - r omega x z = turn z x centre, and a spin about z that changes nothing
        let sliding = velocity - z.cross(&centre) * *turn;
        m.set_velocity(ball, velocity, z.cross(&sliding) * (S::one() / *radius) + z * S::from(1.7));
        let moment = *mass * *radius * *radius * 0.4;
        let zero = S::zero();
        m.rigid_body("ball", ball, *mass, Vector3::zeros(), [moment, moment, moment, zero, zero, zero]);
        m.gravity(z * S::from(-9.81));
        let [contact, rolling] = m.rolling_sphere(["contact", "rolling"], [table, ball], centre, z, *radius);
        for (name, direction) in
            [("place, x", [1.0, 0.0, 0.0]), ("place, y", [0.0, 1.0, 0.0]), ("place, z", [0.0, 0.0, 1.0])]
        {
            m.position_functional(name, Over::Terminal, ball, centre, at(direction));
        }
        m.velocity_functional("speed", Over::Integral, ball, centre, at([0.3, 0.4, 0.5]));
        m.reaction_functional("normal force", Over::Integral, contact, &[S::one()]);
        m.reaction_functional("friction", Over::Integral, rolling, &[0.7, 0.6].map(S::from));
        Ok(())
    }
}

#[test]
fn a_ball_on_a_turntable_moves_on_a_circle() {
    // 0.01 rad of spin a step: the method's error is 1e-10
    let (x, settings) = ([0.15, 0.4, TURN], Settings::new(END, 1600));
    let prepared = Prepared::with(&BallOnTurntable, &x, Prepared::default_method(), settings).unwrap();
    let values = prepared.analysis().forward(&x).unwrap().values;
    let rate = 2.0 / 7.0 * TURN;
    // v = rate z x (x - c): c = x + z x v / rate
    let centre = [START[0] - SPEED[1] / rate, START[1] + SPEED[0] / rate];
    let from = [START[0] - centre[0], START[1] - centre[1]];
    let (s, c) = (rate * END).sin_cos();
    let expected = [centre[0] + c * from[0] - s * from[1], centre[1] + s * from[0] + c * from[1], 0.15];
    for (value, expected) in values.iter().zip(expected) {
        assert!((value - expected).abs() < 1e-9, "{values:?} against {expected:?}");
    }
    // the multiplier is minus the force on the ball along the normal
    assert!((values[4] + 0.4 * 9.81 * END).abs() < 1e-9, "{values:?}");
}

fn differences(scene: &(impl Scene + Sync), level: ConstraintLevel, table: &str) -> [f64; 2] {
    let method = Method::new(table_by_name(table).unwrap(), level);
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let prepared = Prepared::with(scene, &x, method, scene.settings()).unwrap();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).unwrap();
    let stepped = analysis.complex_step(&x, &forward).unwrap();
    let adjoint = analysis.adjoint(&x, &forward).unwrap();
    let tangent = analysis.tangent(&x, &forward).unwrap();
    // components of one vector are measured in its scale: the vector turns, and one of them may come near zero
    let vector = |name: &str| name.split_once(", ").map_or(name, |(vector, _)| vector).to_string();
    let of_one = prepared.functionals().chunk_by(|a, b| vector(&a.name) == vector(&b.name));
    let vectors: Vec<usize> = of_one.map(<[_]>::len).collect();
    [adjoint, tangent].map(|gradient| {
        let (mut start, mut largest) = (0, 0.0f64);
        for length in &vectors {
            let [own, stepped] = [&gradient.rows, &stepped.rows].map(|rows| rows[start..start + length].concat());
            let difference = largest_difference(&stepped, &own);
            assert!(difference.is_finite());
            largest = largest.max(difference);
            start += length;
        }
        largest
    })
}

/// Rolling constraints at random states: what the framework derives from h, held against h in complex numbers.
#[test]
fn rows_and_reactions_follow_from_h() {
    let mut random = Random::new(3);
    let constraints: [(&str, ConstraintPhysics, usize); 2] = [
        ("sphere", ConstraintPhysics::new(Arc::new(Nonholonomic(RollingSphere([NodeKind::Body; 2])))), 13),
        ("disc", ConstraintPhysics::new(Arc::new(Nonholonomic(RollingDisc([NodeKind::Body; 2])))), 16),
    ];
    let complex = |x: &[f64]| x.iter().map(|&x| Complex64::from(x)).collect::<Vec<_>>();
    for (name, constraint, parameters) in &constraints {
        for _ in 0..6 {
            let [a, v, q] = [(); 3].map(|()| random.vector(14));
            let p: Vec<f64> = (0..*parameters).map(|_| random.uniform(0.3, 1.3)).collect();
            // [0, h, dh/dt]
            let motion = |a: &[Complex64], v: &[Complex64], q: &[Complex64]| {
                constraint.motion(State { a, v, q }, &complex(&p), 0.2.into())
            };
            let close = |own: f64, exact: f64, what: &str| {
                assert!((own - exact).abs() < 1e-12 * exact.abs().max(10.0), "{name}, {what}: {own} {exact}");
            };
            let rows = constraint.rows(&q, &p, 0.2);
            for dof in 0..14 {
                let stepped = |x: &[f64]| {
                    let mut x = complex(x);
                    x[dof].im = COMPLEX_STEP;
                    x
                };
                let of_v = motion(&complex(&a), &stepped(&v), &complex(&q));
                let of_a = motion(&stepped(&a), &complex(&v), &complex(&q));
                for row in 0..2 {
                    let own = rows[row * 14 + dof];
                    close(own, of_v[row][1].im / COMPLEX_STEP, "dh/dv");
                    close(own, of_a[row][2].im / COMPLEX_STEP, "d(dh/dt)/da");
                    assert_eq!(of_a[row][1].im, 0.0, "{name}: h does not depend on accelerations");
                }
            }
            // dh/dt is the change of h along the motion
            let along = |x: &[f64], rate: &[f64]| -> Vec<Complex64> {
                x.iter().zip(rate).map(|(&x, &rate)| Complex64::new(x, rate * COMPLEX_STEP)).collect()
            };
            let time = Complex64::new(0.2, COMPLEX_STEP);
            let (moved_v, moved_q, still) = (along(&v, &a), along(&q, &v), complex(&a));
            let moved = constraint.motion(State { a: &still, v: &moved_v, q: &moved_q }, &complex(&p), time);
            let real = constraint.motion(State { a: &a, v: &v, q: &q }, &p, 0.2);
            for row in 0..2 {
                close(real[row][2], moved[row][1].im / COMPLEX_STEP, "dh/dt");
            }
            // h is linear in v: its difference from v = 0 is B v, and the reaction pulls along B^T
            let mu = [0.7, -1.3];
            let reaction = constraint.reaction(&q, &mu, &p, 0.2);
            let work: f64 = reaction.iter().zip(&v).map(|(r, v)| r * v).sum();
            let resting = constraint.value(&q, &p, 0.2);
            let power: f64 = (0..2).map(|row| mu[row] * (real[row][1] - resting[row])).sum();
            close(work, power, "power");
        }
    }
}

#[test]
fn gradients_agree_at_every_level() {
    for level in ConstraintLevel::ALL {
        for table in ["esdirk4", "sdirk2", "bdf2", "generalized-alpha"] {
            let of_ball = differences(&BallOnTurntable, level, table);
            let of_disc = differences(&TumblingDisc, level, table);
            println!("{} {table}: {of_ball:?} {of_disc:?}", level.name());
            let limit = if level == ConstraintLevel::Acceleration { 1e-12 } else { 1e-9 };
            assert!(of_ball.into_iter().chain(of_disc).all(|difference| difference < limit), "{} {table}", level.name());
        }
    }
}

/// A coin that rolls, leans and turns: its energy is constant, and it neither lifts off nor slides.
struct TumblingDisc;

impl Scene for TumblingDisc {
    fn name(&self) -> String {
        "tumbling disc".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("radius", 0.3, (0.01, 1.0), "m"),
            DesignVariable::new("roll", -6.0, (-10.0, 10.0), "rad/s"),
            DesignVariable::new("lean", 0.2, (-1.0, 1.0), "rad"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 400)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [radius, roll, lean] = x else { return Err("3 variables".into()) };
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let (ground, z) = (m.ground(), at([0.0, 0.0, 1.0]));
        // rolls along x; the axis y leans about x
        let turn = Quaternion::about(at([1.0, 0.0, 0.0]), *lean);
        let axis = turn.rotate(at([0.0, 1.0, 0.0]));
        let up = turn.rotate(z);
        let centre = up * *radius;
        let omega = axis * *roll + z * S::from(1.1) + at([0.3, 0.0, 0.0]);
        let disc = m.body("disc", centre, turn);
        m.set_velocity(disc, omega.cross(&centre), omega);
        let quarter = *radius * *radius * 0.25;
        let zero = S::zero();
        m.rigid_body("disc", disc, S::one(), Vector3::zeros(), [quarter, quarter * 2.0, quarter, zero, zero, zero]);
        m.gravity(z * S::from(-9.81));
        let [_, rolling] =
            m.rolling_disc(["contact", "rolling"], [ground, disc], (centre, axis), (Vector3::zeros(), z), *radius);
        m.energy_functional("energy at the start", Over::Initial);
        m.energy_functional("energy", Over::Terminal);
        m.position_functional("path", Over::Integral, disc, centre, at([0.3, 0.5, 0.4]));
        m.reaction_functional("friction", Over::Integral, rolling, &[0.7, 0.6].map(S::from));
        Ok(())
    }
}

#[test]
fn a_tumbling_disc_keeps_its_energy() {
    let values = Prepared::new(&TumblingDisc).unwrap().analysis().forward(&[0.3, -6.0, 0.2]).unwrap().values;
    assert!((values[1] - values[0]).abs() < 1e-9 * values[0], "{values:?}");
}
