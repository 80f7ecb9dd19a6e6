//! Small vibrations against closed forms.

use costate::elements::forces::LoadFrame;
use costate::integrators::Mode;
use costate::internals::AppliedForce;
use costate::prelude::*;
use costate::scenes::{AnyScene, NodeId};

const GRAVITY: f64 = 9.81;

/// What is built, by name.
#[derive(Clone, Copy)]
enum What {
    /// Masses between walls, joined by springs, along x.
    Chain { masses: usize },
    /// A rod on a revolute joint; upside down where the length is negative.
    Rod { length: f64, offset: f64 },
    /// Two point masses on massless links.
    DoublePendulum,
    /// A body that nothing holds.
    Free,
    /// Two bodies that nothing holds, joined by a bushing.
    FreePair,
    /// Two links with torsion springs under a follower load that grows with the load factor (Ziegler's column).
    Ziegler { load: f64 },
    /// A mass on a spring, with a point without inertia between two springs behind it.
    Massless,
    /// A mass between two springs that are stretched by a load.
    Taut,
    /// A ball that rolls.
    Rolling,
}

struct Small(What);

const MASS: f64 = 1.3;
const STIFFNESS: f64 = 250.0;

fn fixed_axis() -> Vector3<f64> {
    Vector3::from_f64([0.0, 1.0, 0.0])
}

fn load<S: Scalar>(
    m: &mut MechanismBuilder<S>,
    (node, on): (NodeId, NodeKind),
    direction: [f64; 3],
    point: Vector3<S>,
    frame: LoadFrame,
    size: f64,
) {
    let local = m.local_point(node, point);
    let p = [&direction.map(S::from)[..], &local.components(), &[S::zero(), S::from(size)]].concat();
    m.element("load", &[node], AppliedForce { on, frame, size: TimeFunction::ConstantRate }, &p);
}

impl Scene for Small {
    fn name(&self) -> String {
        "small".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        match self.0 {
            What::Ziegler { .. } | What::Taut | What::Massless => Settings::statics(4),
            _ => Settings::new(1.0, 10),
        }
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let at = |x: f64, z: f64| Vector3::<S>::from_f64([x, 0.0, z]);
        let axis = Vector3::from_f64(fixed_axis().components());
        let (along, down) = (at(1.0, 0.0), at(0.0, -GRAVITY));
        let tensor = [0.2, 0.3, 0.4, 0.0, 0.0, 0.0].map(S::from);
        match self.0 {
            What::Chain { masses } => {
                let mut last = (ground, at(0.0, 0.0));
                for i in 1..=masses {
                    let place = at(i as f64, 0.0);
                    let node = m.point(&format!("mass {i}"), place);
                    m.point_mass(&format!("mass {i}"), node, S::from(MASS));
                    m.point_on_line(&format!("guide {i}"), [ground, node], place, along);
                    m.line_spring(&format!("spring {i}"), [last.0, node], [last.1, place], S::from(STIFFNESS), S::one());
                    last = (node, place);
                }
                let end = at(masses as f64 + 1.0, 0.0);
                m.line_spring("last spring", [last.0, ground], [last.1, end], S::from(STIFFNESS), S::one());
            }
            What::Rod { length, offset } => {
                let rod = m.body("rod", at(0.0, -length + offset), Quaternion::identity());
                m.rigid_body("rod", rod, S::from(MASS), at(0.0, -offset), tensor);
                m.revolute("hinge", [ground, rod], Vector3::zeros(), axis);
                m.gravity(down);
            }
            What::DoublePendulum => {
                let mut last = (ground, at(0.0, 0.0));
                for (i, z) in [-1.0, -2.0].into_iter().enumerate() {
                    let node = m.point(&format!("bob {i}"), at(0.0, z));
                    m.point_mass(&format!("bob {i}"), node, S::from(MASS));
                    m.distance(&format!("link {i}"), [last.0, node], [last.1, at(0.0, z)]);
                    m.point_in_plane(&format!("plane {i}"), [ground, node], at(0.0, z), axis);
                    last = (node, at(0.0, z));
                }
                m.gravity(down);
            }
            What::Free => {
                let body = m.body("body", at(0.4, 0.7), Quaternion::identity());
                m.rigid_body("body", body, S::from(MASS), at(0.1, 0.2), tensor);
            }
            What::FreePair => {
                let nodes = [("left", 0.0), ("right", 1.0)].map(|(name, x)| {
                    let node = m.body(name, at(x, 0.0), Quaternion::identity());
                    m.rigid_body(name, node, S::from(MASS), Vector3::zeros(), tensor);
                    node
                });
                let rates = BushingRates {
                    stiffness_along: [100.0, 200.0, 300.0].map(S::from),
                    stiffness_about: [40.0, 50.0, 60.0].map(S::from),
                    damping_along: [S::zero(); 3],
                    damping_about: [S::zero(); 3],
                };
                m.bushing("bushing", nodes, at(0.5, 0.0), Quaternion::identity(), rates);
            }
            What::Ziegler { load: size } => {
                let mut last = (ground, 0.0);
                let spring = SpringDamper { stiffness: S::one(), damping: S::zero(), rest: S::zero() };
                for i in 1..=2 {
                    let (foot, top) = (f64::from(i - 1), f64::from(i));
                    // its mass is at the upper end
                    let link = m.body(&format!("link {i}"), at(0.0, top), Quaternion::identity());
                    let mass = if i == 1 { 2.0 } else { 1.0 };
                    m.rigid_body(&format!("link {i}"), link, S::from(mass), Vector3::zeros(), [S::zero(); 6]);
                    m.revolute(&format!("hinge {i}"), [last.0, link], at(0.0, foot), axis);
                    m.torsion_spring_damper(&format!("spring {i}"), [last.0, link], axis, spring);
                    last = (link, top);
                }
                load(m, (last.0, NodeKind::Body), [0.0, 0.0, -1.0], at(0.0, 2.0), LoadFrame::Body, size);
            }
            What::Massless => {
                let places = [at(1.0, 0.0), at(2.0, 0.0)];
                let [between, mass] = ["between", "mass"].map(|name| name.to_string()).map(|name| {
                    let place = if name == "mass" { places[1] } else { places[0] };
                    m.point(&name, place)
                });
                m.point_mass("mass", mass, S::from(MASS));
                m.line_spring("first", [ground, between], [at(0.0, 0.0), places[0]], S::from(STIFFNESS), S::one());
                m.line_spring("second", [between, mass], places, S::from(3.0 * STIFFNESS), S::one());
                m.point_on_line("guide of the point", [ground, between], places[0], along);
                m.point_on_line("guide of the mass", [ground, mass], places[1], along);
            }
            What::Taut => {
                let bob = m.point("bob", at(0.0, 0.0));
                m.point_mass("bob", bob, S::from(MASS));
                for (name, side) in [("left", -1.0), ("right", 1.0)] {
                    m.line_spring(name, [ground, bob], [at(side, 0.0), at(0.0, 0.0)], S::from(STIFFNESS), S::from(0.9));
                }
                load(m, (bob, NodeKind::Point), [1.0, 0.0, 0.0], at(0.0, 0.0), LoadFrame::World, 20.0);
            }
            What::Rolling => {
                let centre = at(0.0, 0.5);
                let ball = m.body("ball", centre, Quaternion::identity());
                m.rigid_body("ball", ball, S::from(MASS), Vector3::zeros(), tensor);
                m.rolling_sphere(["contact", "rolling"], [ground, ball], centre, at(0.0, 1.0), S::from(0.5));
            }
        }
        Ok(())
    }
}

fn modes_of(what: What, count: usize) -> Result<Vec<Mode>, RunError> {
    let scene = Small(what);
    Prepared::new(&scene as &dyn AnyScene)?.modes(count)
}

fn modes(what: What, count: usize) -> Vec<Mode> {
    modes_of(what, count).expect("an equilibrium")
}

fn assert_frequencies(modes: &[Mode], expected: &[f64], tolerance: f64) {
    assert_eq!(modes.len(), expected.len(), "{modes:?}");
    for (mode, expected) in modes.iter().zip(expected) {
        assert!((mode.frequency - expected).abs() <= tolerance * expected, "{} against {expected}", mode.frequency);
        assert!(!mode.is_unstable(), "grows by {}", mode.growth);
    }
}

#[test]
fn a_chain_of_masses_has_the_frequencies_and_shapes_in_closed_form() {
    for (masses, count) in [(7, 7), (60, 5)] {
        let modes = modes(What::Chain { masses }, count);
        let angle = |k: usize| std::f64::consts::PI * (k + 1) as f64 / (masses + 1) as f64;
        let expected: Vec<f64> = (0..count).map(|k| 2.0 * (STIFFNESS / MASS).sqrt() * (0.5 * angle(k)).sin()).collect();
        // omega^2 = K / M has the round-off of 4 k / m, the lowest is some 1500 times smaller
        assert_frequencies(&modes, &expected, 1e-12);
        for (k, mode) in modes.iter().enumerate() {
            // x = sqrt(2 / (m (n + 1))) sin(i angle); the ground has seven coordinates
            let factor = (2.0 / (MASS * (masses + 1) as f64)).sqrt();
            let shape: Vec<f64> = (0..masses).map(|i| factor * (angle(k) * (i + 1) as f64).sin()).collect();
            let own: Vec<f64> = (0..masses).map(|i| mode.shape[7 + 3 * i]).collect();
            let apart = |sign: f64| own.iter().zip(&shape).fold(0.0, |most: f64, (a, b)| most.max((sign * a - b).abs()));
            assert!(apart(1.0).min(apart(-1.0)) < 1e-9, "mode {k}: {own:?} against {shape:?}");
            assert!(mode.ahead.iter().all(|part| *part == 0.0));
        }
    }
}

#[test]
fn a_physical_pendulum_swings_by_the_reaction_of_its_joint() {
    for offset in [0.0, 0.3] {
        let length: f64 = 0.8;
        let expected = (MASS * GRAVITY * length / (0.3 + MASS * length * length)).sqrt();
        assert_frequencies(&modes(What::Rod { length, offset }, 3), &[expected], 1e-13);
    }
}

#[test]
fn an_inverted_pendulum_is_unstable_at_the_rate_of_its_fall() {
    let length: f64 = 0.8;
    let expected = (MASS * GRAVITY * length / (0.3 + MASS * length * length)).sqrt();
    let modes = modes(What::Rod { length: -length, offset: 0.0 }, 2);
    assert_eq!(modes.len(), 1);
    assert!(modes[0].is_unstable() && modes[0].frequency == 0.0);
    assert!((modes[0].growth / expected - 1.0).abs() < 1e-13, "{} against {expected}", modes[0].growth);
}

#[test]
fn a_double_pendulum_has_two_modes() {
    // equal masses and links: omega^2 = (2 -+ sqrt 2) g / l
    let expected = [2.0 - 2f64.sqrt(), 2.0 + 2f64.sqrt()].map(|factor| (factor * GRAVITY).sqrt());
    assert_frequencies(&modes(What::DoublePendulum, 4), &expected, 1e-13);
}

#[test]
fn a_free_body_has_six_rigid_modes() {
    let modes = modes(What::Free, 9);
    assert_frequencies(&modes, &[0.0; 6], 0.0);
}

#[test]
fn free_bodies_on_a_bushing_have_six_rigid_modes_and_six_others() {
    let modes = modes(What::FreePair, 12);
    assert_frequencies(&modes[..6], &[0.0; 6], 0.0);
    // along the line: k (2 / m); about it: k (2 / I); bending with shear: k_theta (2 / I), and for shear k on arms of 1/2 each
    // k (2 / m + 2 (1/2)^2 / I)
    let mut expected = [
        100.0 * 2.0 / MASS,
        200.0 * (2.0 / MASS + 0.5 / 0.4),
        300.0 * (2.0 / MASS + 0.5 / 0.3),
        40.0 * 2.0 / 0.2,
        50.0 * 2.0 / 0.3,
        60.0 * 2.0 / 0.4,
    ]
    .map(f64::sqrt);
    expected.sort_by(f64::total_cmp);
    assert_frequencies(&modes[6..], &expected, 1e-12);
    // and the lowest ones alone
    let few = self::modes(What::FreePair, 7);
    assert_frequencies(&few[..6], &[0.0; 6], 0.0);
    assert_frequencies(&few[6..], &expected[..1], 1e-10);
}

#[test]
fn a_follower_load_makes_a_column_flutter() {
    // Ziegler's column: masses 2 m and m at the ends of two links of length l, torsion springs c:
    // 2 m^2 l^4 w^4 - (7 c - 2 P l) m l^2 w^2 + c^2 = 0, with flutter from P l / c = 7/2 - sqrt 2 on
    let critical = 3.5 - 2f64.sqrt();
    for load in [0.5, critical - 0.05] {
        let b = 7.0 - 2.0 * load;
        let root = (b * b - 8.0).sqrt();
        let expected = [(b - root) / 4.0, (b + root) / 4.0].map(f64::sqrt);
        assert_frequencies(&modes(What::Ziegler { load }, 4), &expected, 1e-12);
    }
    let load = critical + 0.1;
    let modes = modes(What::Ziegler { load }, 4);
    let (b, minus) = (7.0 - 2.0 * load, 8.0 - (7.0 - 2.0 * load).powi(2));
    // omega^2 = (b -+ i sqrt(minus)) / 4
    let (re, im) = (b / 4.0, minus.sqrt() / 4.0);
    let size = re.hypot(im);
    assert_eq!(modes.len(), 1, "{modes:?}");
    let [frequency, growth] = [((size + re) / 2.0).sqrt(), ((size - re) / 2.0).sqrt()];
    assert!((modes[0].frequency / frequency - 1.0).abs() < 1e-12, "{} against {frequency}", modes[0].frequency);
    assert!((modes[0].growth / growth - 1.0).abs() < 1e-11, "{} against {growth}", modes[0].growth);
    assert!(modes[0].ahead.iter().any(|part| part.abs() > 0.01), "both parts of a flutter mode move");
}

#[test]
fn what_has_no_inertia_follows() {
    // springs k and 3 k one behind the other
    let expected = (0.75 * STIFFNESS / MASS).sqrt();
    let modes = modes(What::Massless, 4);
    assert_frequencies(&modes, &[expected], 1e-13);
    // the point between moves by the share of its spring
    assert!((modes[0].shape[7] / modes[0].shape[10] - 0.75).abs() < 1e-12);
}

#[test]
fn tension_raises_the_frequency_across_a_stretched_spring() {
    // displaced by u under the load: lengths 1 + u and 1 - u, 2 k along and k (2 - l0 / l1 - l0 / l2) across
    let u = 20.0 / (2.0 * STIFFNESS);
    let across = STIFFNESS * (2.0 - 0.9 / (1.0 + u) - 0.9 / (1.0 - u));
    let expected = [across, across, 2.0 * STIFFNESS].map(|k| (k / MASS).sqrt());
    assert_frequencies(&modes(What::Taut, 5), &expected, 1e-12);
}

/// A rod that is released from an angle.
struct Released;
impl Scene for Released {
    fn name(&self) -> String {
        "released".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 10)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let rod = m.body("rod", Vector3::from_f64([0.3, 0.0, -0.4]), Quaternion::identity());
        m.rigid_body("rod", rod, S::one(), Vector3::zeros(), [0.1, 0.1, 0.1, 0.0, 0.0, 0.0].map(S::from));
        m.revolute("hinge", [ground, rod], Vector3::zeros(), Vector3::from_f64(fixed_axis().components()));
        m.gravity(Vector3::from_f64([0.0, 0.0, -GRAVITY]));
        Ok(())
    }
}

#[test]
fn states_without_vibrations_are_refused_by_name() {
    let message = |result: Result<Vec<Mode>, RunError>| match result {
        Err(RunError::Input(message)) => message,
        other => panic!("{other:?}"),
    };
    let released = message(Prepared::new(&Released as &dyn AnyScene).expect("sound").modes(2));
    assert!(released.contains("equilibrium") && released.contains("static"), "{released}");
    let rolling = message(modes_of(What::Rolling, 2));
    assert!(rolling.contains("\"rolling\""), "{rolling}");
    let none = message(modes_of(What::Free, 0));
    assert!(none.contains("at least 1"), "{none}");
}
