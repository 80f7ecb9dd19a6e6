//! Frequency responses against closed forms.

use costate::elements::entries::{Entry, Example, Given, Key, ON};
use costate::elements::{NodeKind, Parameter, State};
use costate::functionals::Quantity;
use costate::scalar::{Complex64, Scalar};
use costate::scenes::file::OwnParts;
use costate::scenes::{FileScene, Prepared, built_in};

const RATES: [f64; 6] = [0.0, 1.0, 4.0, 7.1, 12.0, 80.0];
const MASS: f64 = 2.0;
const STIFFNESS: f64 = 100.0;
const DAMPING: f64 = 0.7;

/// y'' of a body.
#[derive(Hash)]
struct AccelerationAlongY;

impl Quantity for AccelerationAlongY {
    const PARAMETERS: &'static [Parameter] = &[];

    fn dofs(&self) -> usize {
        NodeKind::Body.dofs()
    }
    fn unit(&self) -> &'static str {
        "m/s2"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.a[1]
    }
}

impl Entry for AccelerationAlongY {
    type Law = Self;
    const NAME: &'static str = "acceleration_along_y";
    const DOC: &'static str = "y'' of a body [m/s2]";
    const KEYS: &'static [Key] = &[ON];
    const EXAMPLE: Example = (&[NodeKind::Body], &[]);

    fn make<S: Scalar>(_given: &mut Given<S>) -> (Self, Vec<S>) {
        (AccelerationAlongY, Vec::new())
    }
}

fn amplitudes(text: &str, by: &str, rates: &[f64]) -> Vec<Vec<Complex64>> {
    let parts = OwnParts::default().functional::<AccelerationAlongY>();
    let scene = FileScene::parse_with("response.toml", text, &parts).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap();
    let response = prepared.frequency_response(by, rates).unwrap();
    response.into_iter().map(|row| row.into_iter().map(|[re, im]| Complex64::new(re, im)).collect()).collect()
}

fn same(own: Complex64, other: Complex64, what: &str) {
    assert!((own - other).norm() <= 1e-12 * (1e-3 + other.norm()), "{what}: {own} {other}");
}

/// A mass on a slide with a spring and a damper.
const SLIDER: &str = r#"
version = 1
settings = { end = 1, steps = 10 }
variable.force = { initial = 3, bounds = [-10, 10], unit = "N" }
variable.move = { initial = 0, bounds = [-1, 1], unit = "m" }
body = [
    { name = "base", mass = 0.5, inertia = [1, 1, 1] },
    { name = "mass", position = ["0.2 + force / 100", 0, 0], mass = 2, inertia = [1, 1, 1] },
]
joint = [
    { name = "guide", type = "prismatic", between = ["ground", "base"], axis = [1, 0, 0] },
    { name = "slide", type = "prismatic", between = ["base", "mass"], axis = [1, 0, 0] },
]
driver = [{ name = "shaker", type = "translation", between = ["ground", "base"], axis = [1, 0, 0], displacement = "move" }]
spring = [{ name = "spring", type = "slide", between = ["base", "mass"], origin = [0, 0, 0], point = ["0.2 + force / 100", 0, 0], axis = [1, 0, 0], stiffness = 100, damping = 0.7, rest_displacement = 0.2 }]
force = [{ name = "push", on = "mass", direction = [1, 0, 0], size = "force" }]
functional = [
    { name = "x", type = "position", on = "mass", direction = [1, 0, 0], over = "terminal" },
    { name = "v", type = "velocity", on = "mass", direction = [1, 0, 0], over = "terminal" },
    { name = "drive", type = "reaction", joint = "shaker", weights = [1], over = "terminal" },
]
"#;

#[test]
fn a_mass_answers_a_force_and_a_shaken_base_by_the_closed_forms() {
    let (i, force) = (Complex64::new(0.0, 1.0), amplitudes(SLIDER, "force", &RATES));
    let shaken = amplitudes(SLIDER, "move", &RATES);
    for (place, &omega) in RATES.iter().enumerate() {
        let spring = i * (omega * DAMPING) + STIFFNESS;
        let dynamic = spring - MASS * omega * omega;
        // x = F / (k - m omega^2 + i c omega); the point of the spring moves with the variable, too, and stretches nothing
        let receptance = Complex64::from(1.0) / dynamic;
        same(force[place][0], receptance, &format!("receptance at {omega}"));
        same(force[place][1], i * omega * receptance, &format!("mobility at {omega}"));
        same(force[place][2].norm().into(), (spring * receptance).norm().into(), &format!("blocked force at {omega}"));
        let transmitted = spring / dynamic;
        same(shaken[place][0], transmitted, &format!("transmissibility at {omega}"));
        let driving = (spring * (1.0 - transmitted) - 0.5 * omega * omega).norm();
        same(shaken[place][2].norm().into(), driving.into(), &format!("force of the shaker at {omega}"));
    }
}

/// tip = (sin b cosh b - cos b sinh b) L^3 / (EI b^3 (1 + cos b cosh b)) with b^4 = rho A omega^2 L^4 / EI and E (1 + i omega tau).
#[test]
fn a_damped_cantilever_answers_a_force_at_its_tip_as_euler_and_bernoulli_say() {
    const TAU: f64 = 5e-4;
    let text = r#"
version = 1
settings = { end = 1, steps = 10 }
variable.force = { initial = 0, bounds = [-10, 10], unit = "N" }
material.steel = { young = 2e11, poisson = 0.3, density = 7800 }
section.bar = { type = "rectangle", material = "steel", width = 0.004, height = 0.004, damping = 5e-4 }
beam = [{ name = "beam", section = "bar", from = [0, 0, 0], to = [1, 0, 0], second_axis = [0, 1, 0], elements = 12, clamped = ["start"] }]
force = [{ name = "push", on = "beam.end", direction = [0, 0, 1], size = "force" }]
functional = [{ name = "tip", type = "position", on = "beam.end", direction = [0, 0, 1], over = "terminal" }]
"#;
    let rates: Vec<f64> = (1..60).map(|k| 4.0 * f64::from(k)).collect();
    let own = amplitudes(text, "force", &rates);
    let closed = |omega: f64| {
        let stiffness = Complex64::new(1.0, omega * TAU) * (2e11 * 0.004_f64.powi(4) / 12.0);
        let b = (Complex64::from(7800.0 * 1.6e-5 * omega * omega) / stiffness).powf(0.25);
        (b.sin() * b.cosh() - b.cos() * b.sinh()) / (stiffness * b * b * b * (b.cos() * b.cosh() + 1.0))
    };
    for (row, &omega) in own.iter().zip(&rates) {
        let expected = closed(omega);
        let off = (row[0] - expected).norm() / expected.norm();
        // shear and rotary inertia move the modes, the first two at 21 and 130 rad/s, and what lies between them by some 1e-4 of their rates
        assert!(off < 1.5e-3, "{omega} rad/s: {} {expected}, off by {off:.1e}", row[0]);
    }
    // at rest, and a resonance
    let largest = own.iter().map(|row| row[0].norm()).fold(0.0, f64::max);
    assert!(largest > 10.0 * closed(1e-3).norm(), "{largest}");
}

#[test]
fn what_has_no_response_is_told() {
    let scene = FileScene::parse("response.toml", SLIDER).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let told = |by: &str, rates: &[f64]| prepared.frequency_response(by, rates).unwrap_err().to_string();
    assert!(told("force of a spring", &[1.0]).contains("force of a spring"), "{}", told("force of a spring", &[1.0]));
    // a mass that slides freely is nowhere at rest
    let free =
        SLIDER.replace("stiffness = 100, damping = 0.7", "stiffness = 0, damping = 0").replace("initial = 3", "initial = 0");
    let scene = FileScene::parse("response.toml", &free).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let why = prepared.frequency_response("force", &[0.0]).unwrap_err().to_string();
    assert!(why.contains("at 0 rad/s the response is not determined"), "{why}");
    assert!((prepared.frequency_response("force", &[2.0]).unwrap()[0][0][0] + 1.0 / 8.0).abs() < 1e-13);
}

/// At rest the response is the derivative of the equilibrium by the variable, of which the adjoint knows nothing of vibrations.
#[test]
fn at_rate_zero_the_response_is_the_gradient_of_the_equilibrium() {
    let prepared = Prepared::new(built_in::named("princeton-beam").unwrap()).unwrap();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap();
    for (place, variable) in prepared.variables.iter().enumerate().filter(|(_, own)| own.name.starts_with("load")) {
        let response = prepared.frequency_response(&variable.name, &[0.0]).unwrap();
        for (row, [re, im]) in gradient.rows.iter().zip(&response[0]) {
            // stretching is so much stiffer than bending that a rounding of the state is 1e-10 of its bending
            assert!(
                (row[place] - re).abs() < 3e-9 * re.abs() && *im == 0.0,
                "by {}: {} {re} {im}",
                variable.name,
                row[place]
            );
        }
    }
}

/// A bead on a slide of a table that a motor turns, and a disc in a soft bearing on the same table.
const TABLE: &str = r#"
version = 1
settings = { start = "steady", end = 1, steps = 10 }
variable.force = { initial = 5, bounds = [-10, 10], unit = "N" }
variable.push = { initial = 0, bounds = [-10, 10], unit = "N" }
variable.rate = { initial = 3, bounds = [0, 10], unit = "rad/s" }
body = [
    { name = "table", mass = 1, inertia = [1, 1, 1] },
    { name = "bead", position = [0.5, 0, 0], mass = 2, inertia = [1e-3, 1e-3, 1e-3] },
    { name = "disc", mass = 3, inertia = [0.2, 0.2, 0.4] },
]
joint = [
    { name = "shaft", type = "revolute", between = ["ground", "table"], axis = [0, 0, 1] },
    { name = "slide", type = "prismatic", between = ["table", "bead"], axis = [1, 0, 0] },
]
driver = [{ name = "motor", type = "rotation", between = ["ground", "table"], axis = [0, 0, 1], angle = { type = "formula", value = "rate * t" } }]
spring = [
    { name = "spring", type = "slide", between = ["table", "bead"], origin = [0, 0, 0], point = [0.5, 0, 0], axis = [1, 0, 0], stiffness = 100, damping = 0.7, rest_displacement = 0.4 },
    { name = "bearing", type = "bushing", between = ["table", "disc"], stiffness = [200, 200, 300, 50, 50, 60] },
]
force = [
    { name = "pull", on = "bead", frame = "body", direction = [1, 0, 0], size = "force" },
    { name = "blow", on = "disc", frame = "body", direction = [1, 0, 0], size = "push" },
]
spin = [{ parts = ["table", "bead", "disc"], axis = [0, 0, 1], rate = "rate" }]
functional = [
    { name = "r", type = "position", on = "bead", direction = [1, 0, 0], over = "terminal" },
    { name = "outwards", type = "velocity", on = "bead", direction = [1, 0, 0], over = "terminal" },
    { name = "along", type = "velocity", on = "bead", direction = [0, 1, 0], over = "terminal" },
    { name = "moment", type = "reaction", joint = "motor", weights = [1], over = "terminal" },
    { name = "x", type = "position", on = "disc", direction = [1, 0, 0], over = "terminal" },
    { name = "y", type = "position", on = "disc", direction = [0, 1, 0], over = "terminal" },
    { name = "y'", type = "velocity", on = "disc", direction = [0, 1, 0], over = "terminal" },
    { name = "power", type = "power", over = "terminal" },
    { name = "y''", type = "acceleration_along_y", on = "disc", over = "terminal" },
]
"#;

/// m (r'' - W^2 r) + c r' + k (r - r0) = F, with the motor's moment d(m r^2 W)/dt; D x - 2 i omega m W y = F and D y + 2 i omega m W x = 0 of the
/// disc with D = k - m W^2 - m omega^2.
#[test]
fn what_turns_answers_by_the_closed_forms_of_its_frame() {
    let (turn, i) = (3.0, Complex64::new(0.0, 1.0));
    let radius = (STIFFNESS * 0.4 + 5.0) / (STIFFNESS - MASS * turn * turn);
    let [pulled, blown] = ["force", "push"].map(|by| amplitudes(TABLE, by, &RATES));
    for (place, &omega) in RATES.iter().enumerate() {
        let dynamic = i * (omega * DAMPING) + STIFFNESS - MASS * (turn * turn + omega * omega);
        let r = Complex64::from(1.0) / dynamic;
        same(pulled[place][0], r, &format!("radius at {omega}"));
        same(pulled[place][1], i * omega * r, &format!("rate of the radius at {omega}"));
        same(pulled[place][2], r * turn, &format!("velocity along the circle at {omega}"));
        same(
            pulled[place][3].norm().into(),
            (r * 2.0 * MASS * radius * turn * omega).norm().into(),
            &format!("moment at {omega}"),
        );
        // of the force alone: the damper's is of second order
        same(pulled[place][7], i * (5.0 * omega) * r, &format!("power at {omega}"));
        let (d, cross) = (Complex64::from(200.0 - 3.0 * (turn * turn + omega * omega)), i * (2.0 * omega * 3.0 * turn));
        let x = d / (d * d + cross * cross);
        let y = -cross / d * x;
        same(blown[place][4], x, &format!("x of the disc at {omega}"));
        same(blown[place][5], y, &format!("y of the disc at {omega}"));
        same(blown[place][6], i * omega * y + x * turn, &format!("velocity of the disc at {omega}"));
        let acceleration = -(omega * omega + turn * turn) * y + i * omega * x * 2.0 * turn;
        same(blown[place][8], acceleration, &format!("acceleration of the disc at {omega}"));
    }
    let scene = FileScene::parse_with("table.toml", TABLE, &OwnParts::default().functional::<AccelerationAlongY>()).unwrap();
    let why = Prepared::new(&scene).unwrap().frequency_response("rate", &RATES).unwrap_err().to_string();
    assert!(why.contains("\"rate\" is part of the steady turn itself"), "{why}");
    // no force now, and one that stands still in space
    let still = TABLE.replace(r#"on = "disc", frame = "body","#, r#"on = "disc", frame = "world","#);
    let scene =
        FileScene::parse_with("table.toml", &still, &OwnParts::default().functional::<AccelerationAlongY>()).unwrap();
    let why = Prepared::new(&scene).unwrap().frequency_response("push", &RATES).unwrap_err().to_string();
    assert!(why.contains("with more of \"push\"") && why.contains("the forces of \"blow\" change"), "{why}");
}
