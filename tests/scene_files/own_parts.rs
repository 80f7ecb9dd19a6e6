//! Joints, springs and functionals of one's own in scene files: by their entries alone.

use super::runge_kutta;
use costate::elements::entries::{BETWEEN, Entry, Example, ExampleValue, Form, Given, Key, MadeEntry, Range, Type, need};
use costate::elements::{Constraint, Element, Frame, NodeKind, Parameter, State};
use costate::functionals::Quantity;
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::file::OwnParts;
use costate::scenes::{FileScene, Prepared, file};
use costate::testing::check_quantity;

/// A bead b on a parabolic wire of body a through the bead's start: z = k (x^2 - x0^2) / 2 in the frame of a, y as it stands.
#[derive(Hash)]
struct Wire {
    a: NodeKind,
}

impl Constraint for Wire {
    const EQUATIONS: usize = 2;
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("curvature", "1/m"), Parameter::new("lowest z", "m"), Parameter::new("y", "m")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, NodeKind::Point]
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let a = Frame::of(self.a, q);
        let seen = a.seen(Vector3::first_three(&q[self.a.dofs()..]) - a.origin);
        g[0] = seen.z - p[1] - p[0] * seen.x * seen.x * 0.5;
        g[1] = seen.y - p[2];
    }
}

impl Entry for Wire {
    type Law = Self;
    const NAME: &'static str = "parabolic_wire";
    const DOC: &'static str = "b, a bead, on a parabolic wire of body a";
    const KEYS: &'static [Key] =
        &[BETWEEN, need("curvature", Type::Number("1/m", Range::Any), "curvature at the lowest point")];
    const EXAMPLE: Example = (&[NodeKind::Body, NodeKind::Point], &[("curvature", ExampleValue::Number(0.8))]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let (a, curvature) = (given.body(0), given.number("curvature"));
        let place = given.node(0).local_point(given.node(1).position());
        (Wire { a }, vec![curvature, place.z - curvature * place.x * place.x * 0.5, place.y])
    }
}

/// A spring between points that hardens: V = k1 s^2 / 2 + k3 s^4 / 4 with s = x_b - x_a along the world's x.
#[derive(Hash)]
struct Hardening;

impl Element for Hardening {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("stiffness", "N/m"), Parameter::new("hardening", "N/m3")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point; 2]
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let s = q[3] - q[0];
        p[0] * s * s * 0.5 + p[1] * s.powi(4) * 0.25
    }
}

const HARDENING: [Key; 2] = [
    need("stiffness", Type::Number("N/m", Range::AtLeastZero), "stiffness without force"),
    need("hardening", Type::Number("N/m3", Range::Any), "how it grows"),
];

fn hardening<S: Scalar>(given: &mut Given<S>) -> Vec<S> {
    for node in [0, 1].into_iter().filter(|&node| given.node(node).kind != NodeKind::Point).collect::<Vec<_>>() {
        given.wrong(format!("\"{}\" needs points, but \"{}\" is none", given.owner(), given.name(node)));
    }
    vec![given.number("stiffness"), given.number("hardening")]
}

impl Entry for Hardening {
    type Law = Self;
    const NAME: &'static str = "hardening";
    const DOC: &'static str = "a spring that hardens";
    const KEYS: &'static [Key] = &[BETWEEN, HARDENING[0], HARDENING[1]];
    const EXAMPLE: Example = (
        &[NodeKind::Point, NodeKind::Point],
        &[("stiffness", ExampleValue::Number(2.0)), ("hardening", ExampleValue::Number(3.0))],
    );

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (Hardening, hardening(given))
    }
}

/// The force in it.
#[derive(Hash)]
struct HardeningForce;

impl Quantity for HardeningForce {
    const PARAMETERS: &'static [Parameter] = Hardening::PARAMETERS;

    fn dofs(&self) -> usize {
        6
    }
    fn unit(&self) -> &'static str {
        "N"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], _t: S) -> S {
        let stretch = s.q[3] - s.q[0];
        p[0] * stretch + p[1] * stretch.powi(3)
    }
}

impl Entry for HardeningForce {
    type Law = Self;
    const NAME: &'static str = "hardening_force";
    const DOC: &'static str = "force of a spring that hardens [N]";
    const KEYS: &'static [Key] = Hardening::KEYS;
    const EXAMPLE: Example = Hardening::EXAMPLE;

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        (HardeningForce, hardening(given))
    }
}

fn parts() -> OwnParts {
    OwnParts::default().joint::<Wire>().spring::<Hardening>().functional::<HardeningForce>()
}

fn text(joint: &str) -> String {
    format!(
        "version = 1\ngravity = [0, 0, -9.81]\n\
         [variable]\nk = {{ initial = 0.8, bounds = [0.1, 2], unit = \"1/m\" }}\n\
         [[point]]\nname = \"bead\"\nposition = [0.5, 0, 0.1]\nmass = 1\n\
         [[joint]]\nname = \"wire\"\nbetween = [\"ground\", \"bead\"]\n{joint}\n\
         [[functional]]\nname = \"x\"\ntype = \"position\"\non = \"bead\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n\
         [settings]\nend = 0.4\nsteps = 100\n"
    )
}

fn values(joint: &str, x: f64) -> Vec<f64> {
    let scene = FileScene::parse_with("own.toml", &text(joint), &parts()).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    analysis.forward(&[x]).unwrap_or_else(|why| panic!("{why}")).values
}

#[test]
fn a_joint_of_ones_own_is_used_by_its_name() {
    let joint = "type = \"parabolic_wire\"\ncurvature = \"k\"";
    let [low, mid, high] = [0.8 - 1e-4, 0.8, 0.8 + 1e-4].map(|x| values(joint, x)[0]);
    // along the wire: (1 + k^2 x^2) x'' + k^2 x x'^2 + g k x = 0
    let slide = |k: f64| {
        let slope = |_, [x, v]: [f64; 2]| [v, -(k * k * x * v * v + 9.81 * k * x) / (1.0 + k * k * x * x)];
        runge_kutta::integrated([0.5, 0.0], (4000, 1e-4), slope)[0]
    };
    assert!((mid - slide(0.8)).abs() < 1e-7, "{mid} for {}", slide(0.8));
    let scene = FileScene::parse_with("own.toml", &text(joint), &parts()).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&[0.8]).unwrap();
    let gradient = analysis.adjoint(&[0.8], &forward).unwrap();
    let quotient = (high - low) / 2e-4;
    let own = gradient.rows[0][0];
    assert!((own - quotient).abs() < 1e-6 * quotient.abs(), "{own} for {quotient}");
}

/// The wire by the name of a driver of the library, which stands in another section.
struct NamedLikeADriver;

impl Entry for NamedLikeADriver {
    type Law = Wire;
    const NAME: &'static str = "rotation";
    const DOC: &'static str = Wire::DOC;
    const KEYS: &'static [Key] = Wire::KEYS;
    const EXAMPLE: Example = Wire::EXAMPLE;

    fn make<S: Scalar>(given: &mut Given<S>) -> (Wire, Vec<S>) {
        Wire::make(given)
    }
}

#[test]
fn a_joint_by_the_name_of_a_driver_is_itself() {
    let own = OwnParts::default().joint::<NamedLikeADriver>();
    let text = text("type = \"rotation\"\ncurvature = \"k\"");
    let scene = FileScene::parse_with("own.toml", &text, &own).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let value = prepared.analysis().forward(&[0.8]).unwrap().values;
    assert_eq!(value, values("type = \"parabolic_wire\"\ncurvature = \"k\"", 0.8));
}

/// The wire by a name that a running program gives it.
struct Made {
    name: &'static str,
}

impl MadeEntry for Made {
    type Law = Wire;
    fn form(&self) -> Form {
        Form { name: self.name, doc: Wire::DOC, keys: Wire::KEYS }
    }
    fn example(&self) -> Example {
        Wire::EXAMPLE
    }
    fn make<S: Scalar>(&self, given: &mut Given<S>) -> (Wire, Vec<S>) {
        Wire::make(given)
    }
}

#[test]
fn a_joint_that_is_made_while_a_program_runs_is_that_of_its_type() {
    let made: &'static Made = Box::leak(Box::new(Made { name: "wire of the day" }));
    let text = text("type = \"wire of the day\"\ncurvature = \"k\"");
    let scene = FileScene::parse_with("own.toml", &text, &OwnParts::default().joint_by(made)).unwrap();
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let value = prepared.analysis().forward(&[0.8]).unwrap().values;
    assert_eq!(value, values("type = \"parabolic_wire\"\ncurvature = \"k\"", 0.8));
}

#[test]
fn it_is_soft_by_the_same_keys() {
    let [rigid, soft] = ["", "stiffness = [1e7, 1e7]\ndamping = [1e3, 1e3]"]
        .map(|soft| values(&format!("type = \"parabolic_wire\"\ncurvature = \"k\"\n{soft}"), 0.8)[0]);
    assert!(rigid != soft && (rigid - soft).abs() < 1e-3, "{rigid} and {soft}");
}

#[test]
fn its_mistakes_and_its_schema_are_those_of_any_joint() {
    let wrong = |joint: &str, parts: &OwnParts| FileScene::parse_with("own.toml", &text(joint), parts).unwrap_err();
    let curved = "type = \"parabolic_wire\"\ncurvature = \"k\"";
    let without = wrong(curved, &OwnParts::default());
    assert!(without.contains("type \"parabolic_wire\" is not known"), "{without}");
    let missing = wrong("type = \"parabolic_wire\"", &parts());
    assert!(missing.contains("needs the key curvature: curvature at the lowest point"), "{missing}");
    let unknown = wrong("type = \"parabolic_wire\"\ncurvature = 1\nradius = 2", &parts());
    assert!(unknown.contains("of type parabolic_wire: key \"radius\" is not known"), "{unknown}");
    let mistyped = wrong("type = \"parabolic_wir\"\ncurvature = 1", &parts());
    assert!(mistyped.contains("did you mean \"parabolic_wire\""), "{mistyped}");
    let schema = file::schema(&parts()).to_string();
    assert!(schema.contains("parabolic_wire") && !file::schema(&OwnParts::default()).to_string().contains("parabolic_wire"));
}

/// A mass that starts from rest at 0.5 m of a wall, on a spring that hardens.
fn on_a_spring(spring: &str, functional: &str) -> String {
    format!(
        "version = 1\n[variable]\nk3 = {{ initial = 40, bounds = [1, 100], unit = \"N/m3\" }}\n\
         [[point]]\nname = \"wall\"\nposition = [0, 0, 0]\n[[point]]\nname = \"mass\"\nposition = [0.5, 0, 0]\nmass = 2\n\
         [[joint]]\nname = \"fixed\"\ntype = \"rigid_link\"\nbetween = [\"ground\", \"wall\"]\n\
         [[spring]]\nname = \"spring\"\ntype = \"{spring}\"\nbetween = [\"wall\", \"mass\"]\nstiffness = 3\nhardening = \"k3\"\n\
         [[functional]]\nname = \"force\"\n{functional}\nover = \"terminal\"\n\
         [settings]\nend = 0.8\nsteps = 400\n"
    )
}

const FORCE: &str = "type = \"hardening_force\"\nbetween = [\"wall\", \"mass\"]\nstiffness = 3\nhardening = \"k3\"";

#[test]
fn a_spring_and_a_functional_of_ones_own_are_used_by_their_names() {
    let text = on_a_spring("hardening", FORCE);
    let scene = FileScene::parse_with("own.toml", &text, &parts()).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap();
    let analysis = prepared.analysis();
    let at = |k3: f64| analysis.forward(&[k3]).unwrap();
    let forward = at(40.0);
    // x'' = -(3 x + k3 x^3) / 2
    let force = |k3: f64| {
        let law = |x: f64| 3.0 * x + k3 * x.powi(3);
        law(runge_kutta::integrated([0.5, 0.0], (8000, 1e-4), |_, [x, v]| [v, -law(x) / 2.0])[0])
    };
    assert!((forward.values[0] - force(40.0)).abs() < 1e-6, "{} for {}", forward.values[0], force(40.0));
    let own = analysis.adjoint(&[40.0], &forward).unwrap().rows[0][0];
    let quotient = (force(40.0 + 1e-3) - force(40.0 - 1e-3)) / 2e-3;
    assert!((own - quotient).abs() < 1e-5 * quotient.abs(), "{own} for {quotient}");
    assert_eq!(prepared.functionals()[0].value_unit(), "N");
    let samples = costate::testing::Sample::random(&[NodeKind::Point; 2], &[3.0, 40.0], 12);
    check_quantity(&HardeningForce, 0, &samples).unwrap();
}

#[test]
fn what_is_wrong_with_them_is_told_like_that_of_any_part() {
    let wrong = |text: &str| FileScene::parse_with("own.toml", text, &parts()).map(drop);
    let message = |text: &str| match FileScene::parse_with("own.toml", text, &parts()) {
        Ok(scene) => Prepared::new(&scene).map(drop).unwrap_err().to_string(),
        Err(why) => why,
    };
    assert!(wrong(&on_a_spring("hardening", FORCE)).is_ok());
    let told = message(&on_a_spring("hardenin", FORCE));
    assert!(told.contains("did you mean \"hardening\""), "{told}");
    let told = message(&on_a_spring("hardening", &FORCE.replace("\nstiffness = 3", "")));
    assert!(told.contains("needs the key stiffness: stiffness without force"), "{told}");
    let told = message(&on_a_spring("hardening", &FORCE.replace("\"wall\"", "\"ground\"")));
    assert!(told.contains("\"force\" needs points, but \"ground\" is none"), "{told}");
    let twice = parts().spring::<Hardening>();
    let told = FileScene::parse_with("own.toml", &on_a_spring("hardening", FORCE), &twice).unwrap_err();
    assert!(told.contains("two parts of the section [[spring]] are named \"hardening\""), "{told}");
}
