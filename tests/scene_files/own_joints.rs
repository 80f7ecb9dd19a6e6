//! Joints of one's own in scene files: by their entries alone.

use costate::elements::entries::{BETWEEN, Entry, Example, ExampleValue, Given, JointPart, Key, Range, Type, need};
use costate::elements::{Constraint, Frame, NodeKind, Parameter};
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{FileScene, Prepared, file};

/// A bead b on a parabolic wire of body a through the bead's start: z = k (x^2 - x0^2) / 2 in the frame of a, y as it stands.
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

const JOINTS: &[JointPart] = &[JointPart::of::<Wire>()];

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
    let scene = FileScene::parse_with("own.toml", &text(joint), JOINTS).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    analysis.forward(&[x]).unwrap_or_else(|why| panic!("{why}")).values
}

#[test]
fn a_joint_of_ones_own_is_used_by_its_name() {
    let joint = "type = \"parabolic_wire\"\ncurvature = \"k\"";
    let [low, mid, high] = [0.8 - 1e-4, 0.8, 0.8 + 1e-4].map(|x| values(joint, x)[0]);
    // along the wire: (1 + k^2 x^2) x'' + k^2 x x'^2 + g k x = 0, by a Runge-Kutta method of its own
    let slide = |k: f64| {
        let rate = |[x, v]: [f64; 2]| [v, -(k * k * x * v * v + 9.81 * k * x) / (1.0 + k * k * x * x)];
        let (mut s, h) = ([0.5, 0.0], 1e-4);
        for _ in 0..4000 {
            let along = |d: [f64; 2], c: f64| [s[0] + c * d[0], s[1] + c * d[1]];
            let k1 = rate(s);
            let k2 = rate(along(k1, h / 2.0));
            let k3 = rate(along(k2, h / 2.0));
            let k4 = rate(along(k3, h));
            for i in 0..2 {
                s[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        s[0]
    };
    assert!((mid - slide(0.8)).abs() < 1e-7, "{mid} for {}", slide(0.8));
    let scene = FileScene::parse_with("own.toml", &text(joint), JOINTS).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&[0.8]).unwrap();
    let gradient = analysis.adjoint(&[0.8], &forward).unwrap();
    let quotient = (high - low) / 2e-4;
    let own = gradient.rows[0][0];
    assert!((own - quotient).abs() < 1e-6 * quotient.abs(), "{own} for {quotient}");
}

#[test]
fn it_is_soft_by_the_same_keys() {
    let [rigid, soft] = ["", "stiffness = [1e7, 1e7]\ndamping = [1e3, 1e3]"]
        .map(|soft| values(&format!("type = \"parabolic_wire\"\ncurvature = \"k\"\n{soft}"), 0.8)[0]);
    assert!(rigid != soft && (rigid - soft).abs() < 1e-3, "{rigid} and {soft}");
}

#[test]
fn its_mistakes_and_its_schema_are_those_of_any_joint() {
    let wrong = |joint: &str, joints: &[JointPart]| FileScene::parse_with("own.toml", &text(joint), joints).unwrap_err();
    let curved = "type = \"parabolic_wire\"\ncurvature = \"k\"";
    assert!(wrong(curved, &[]).contains("type \"parabolic_wire\" is not known"), "{}", wrong(curved, &[]));
    let missing = wrong("type = \"parabolic_wire\"", JOINTS);
    assert!(missing.contains("needs the key curvature: curvature at the lowest point"), "{missing}");
    let unknown = wrong("type = \"parabolic_wire\"\ncurvature = 1\nradius = 2", JOINTS);
    assert!(unknown.contains("of type parabolic_wire: key \"radius\" is not known"), "{unknown}");
    let mistyped = wrong("type = \"parabolic_wir\"\ncurvature = 1", JOINTS);
    assert!(mistyped.contains("did you mean \"parabolic_wire\""), "{mistyped}");
    let schema = file::schema(JOINTS).to_string();
    assert!(schema.contains("parabolic_wire") && !file::schema(&[]).to_string().contains("parabolic_wire"));
}
