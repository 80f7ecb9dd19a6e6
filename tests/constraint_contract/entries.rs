//! What every entry of a joint or driver owes: placed anywhere, on nodes of every kind that it takes, it holds as it stands.

use super::support::motion::random_coordinates;
use super::support::{Random, twelve};
use costate::elements::entries::{Entry, Example, Given, GivenValue, JointPart, Key, Part, Placed};
use costate::elements::joints::{DRIVERS, JOINTS, named};
use costate::elements::{Constraint, NodeKind};
use costate::functionals::{Quantity, QuantityPart, QuantityVisitor, quantities};
use costate::internals::ConstraintPhysics;
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::MechanismBuilder;
use costate::testing::{Sample, check_quantity};

use NodeKind::{Body, Natural, Point, Slope};

/// Kinds of nodes in space.
const KINDS: [NodeKind; 4] = [Point, Body, Natural, Slope];

/// All kinds of nodes that an entry may be asked to take.
fn choices<L: ?Sized>(part: &Part<L>) -> Vec<Vec<NodeKind>> {
    let in_space = part.example.0.iter().all(|kind| kind.in_space().is_some());
    part.example.0.iter().fold(vec![vec![]], |all, own| {
        let kinds = if in_space { &KINDS[..] } else { std::slice::from_ref(own) };
        let longer = |before: &Vec<NodeKind>| -> Vec<Vec<NodeKind>> {
            kinds.iter().map(|&kind| [&before[..], &[kind]].concat()).collect()
        };
        all.iter().flat_map(longer).collect()
    })
}

/// What an entry became.
#[derive(Debug)]
struct Made {
    equations: usize,
    parameters: usize,
    /// Its equations where its nodes stand.
    g: Vec<f64>,
    /// Whether its reactions are in balance.
    is_balanced: bool,
    /// Names of the parameters of the soft version.
    soft: Vec<String>,
}

/// Nodes of these kinds anywhere.
fn coordinates(kinds: &[NodeKind], random: &mut Random) -> Vec<f64> {
    let mut q = Vec::new();
    for kind in kinds {
        match kind {
            NodeKind::Coordinates(count) | NodeKind::States(count) => q.extend(random.vector(*count)),
            Natural => {
                let turn = Quaternion::from_slice(&random_coordinates(&[Body], random, |_| 1.0)[3..]);
                q.extend(random.vector(3));
                q.extend(turn.columns().iter().flat_map(|axis| axis.components()));
            }
            kind => q.extend(random_coordinates(&[*kind], random, |_| 1.0)),
        }
    }
    q
}

fn placed<'q>(kinds: &[NodeKind], q: &'q [f64]) -> Vec<(&'static str, Placed<'q, f64>)> {
    let mut first = 0;
    let node = |kind: &NodeKind| {
        first += kind.dofs();
        ("node", Placed { kind: *kind, q: &q[first - kind.dofs()..first] })
    };
    kinds.iter().map(node).collect()
}

/// An entry made of its example on nodes of these kinds that stand anywhere; nothing where it refuses them.
fn made(part: &JointPart, kinds: &[NodeKind], random: &mut Random) -> Option<Made> {
    let mut q = coordinates(kinds, random);
    // what has no axes is held where it is: the other node stands there
    if !kinds[0].has_axes() && kinds[0].in_space().is_some() && part.form.name != "distance" {
        let place: Vec<f64> = q[..3].to_vec();
        q[kinds[0].dofs()..][..3].copy_from_slice(&place);
    }
    let nodes = placed(kinds, &q);
    let turn = Quaternion::from_slice(&random_coordinates(&[Body], random, |_| 1.0)[3..]);
    let mut values: Vec<(&'static str, GivenValue<f64>)> =
        part.example_values(Vector3::first_three(&random.vector(3)), turn);
    // nodes without axes have no points but themselves; a cable's hinge is across the cable, a drive starts where they are
    let all_have_axes = kinds.iter().all(|kind| kind.has_axes());
    values.retain(|(key, _)| all_have_axes || !["point", "points", "origin"].contains(key));
    if part.form.name == "cable_hinge" && kinds[1] == Slope {
        values = vec![("axis", nodes[1].1.slope().unit().perpendiculars()[1].into())];
    }
    if part.form.name == "translation" && !all_have_axes {
        values.push(("origin", nodes[1].1.position().into()));
    }
    let mut given = Given::new("any", nodes, values);
    let mut given_again = given.clone();
    let (law, p) = part.make(&mut given).expect("real numbers");
    if !given.mistakes().is_empty() {
        return None;
    }
    let equations = law.equations();
    let (again, _) = part.make(&mut given_again).expect("real numbers");
    let law = ConstraintPhysics::new(law.rigid().into());
    assert_eq!(law.parameter_count(), p.len(), "{}", part.form.name);
    assert_eq!(law.equation_count(), equations, "{}", part.form.name);
    let soft = again.soft().parameter_list().into_iter().map(|own| own.name.into_owned()).collect();
    Some(Made { equations, parameters: p.len(), g: law.value(&q, &p, 0.0), is_balanced: law.is_balanced(&p), soft })
}

#[test]
fn every_entry_holds_where_its_nodes_stand() {
    let mut taken = 0;
    for part in JOINTS.iter().chain(DRIVERS) {
        let mut of_this = 0;
        for kinds in choices(part) {
            for made in twelve(|random| made(part, &kinds, random)).into_iter().flatten() {
                let largest = made.g.iter().fold(0.0, |largest: f64, own| largest.max(own.abs()));
                assert!(largest < 1e-13, "{} between {kinds:?}: {:?}", part.form.name, made.g);
                // all act between bodies as these stand to each other
                let in_space = kinds.iter().all(|kind| kind.in_space().is_some());
                assert_eq!(made.is_balanced, in_space, "{} between {kinds:?}", part.form.name);
                assert_eq!(made.soft.len(), 2 * made.equations + made.parameters, "{}", part.form.name);
                assert_eq!(made.soft[made.equations], "damping 1");
                of_this += 1;
            }
        }
        assert!(of_this > 0, "no nodes are right for a {}", part.form.name);
        taken += of_this;
    }
    // all kinds of bodies with each other, points and cables where they are guided
    assert!(taken > 12 * 100, "only {taken} were taken");
}

/// How often an entry of a quantity was taken on nodes of all kinds.
#[derive(Default)]
struct Measured(usize);

impl QuantityVisitor for Measured {
    fn visit<Q: Entry<Law: Quantity>>(&mut self) {
        let (part, before) = (QuantityPart::of::<Q>(), self.0);
        for kinds in choices(&part) {
            for q in twelve(|random| coordinates(&kinds, random)) {
                let all_have_axes = kinds.iter().all(|kind| kind.has_axes());
                let mut values = part.example_values(Vector3::from_f64([0.3, 0.1, -0.2]), Quaternion::identity());
                values.retain(|(key, _)| all_have_axes || !["point", "points"].contains(key));
                let mut given = Given::new("any", placed(&kinds, &q), values);
                let (quantity, p) = Q::make(&mut given);
                if given.mistakes().is_empty() {
                    check_quantity(&quantity, 0, &Sample::random(&kinds, &p, 4))
                        .unwrap_or_else(|why| panic!("{} of {kinds:?}: {why}", Q::NAME));
                    let doc = format!("[{}]", quantity.unit());
                    assert!(Q::DOC.contains(&doc) || quantity.unit() == "-", "{}: {} does not say {doc}", Q::NAME, Q::DOC);
                    self.0 += 1;
                }
            }
        }
        assert!(self.0 > before, "no nodes are right for a {}", Q::NAME);
    }
}

#[test]
fn every_quantity_has_the_derivatives_of_its_formula() {
    let mut measured = Measured::default();
    quantities::visit_all(&mut measured);
    assert!(measured.0 > 12 * 50, "only {} were taken", measured.0);
}

/// A joint of one's own: one distance from a plane of a, as an offset says.
#[derive(Hash)]
struct Shelf {
    a: NodeKind,
    b: NodeKind,
}

impl Constraint for Shelf {
    const EQUATIONS: usize = 1;
    const PARAMETERS: &'static [costate::elements::Parameter] = &[costate::elements::Parameter::new("height", "m")];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.a, self.b]
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        let b = Vector3::first_three(&q[self.a.dofs()..]);
        g[0] = b.z - Vector3::first_three(q).z - p[0];
    }
}

impl Entry for Shelf {
    type Law = Self;
    const NAME: &'static str = "shelf";
    const DOC: &'static str = "b at the height over a at which it stands";
    const KEYS: &'static [Key] = &[costate::elements::entries::BETWEEN];
    const EXAMPLE: Example = (&[Body, Body], &[]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let [a, b] = [given.in_space(0), given.in_space(1)];
        let height = given.node(1).position().z - given.node(0).position().z;
        (Shelf { a, b }, vec![height])
    }
}

#[test]
fn an_entry_of_ones_own_goes_where_those_of_the_library_go() {
    let mut m = MechanismBuilder::<f64>::default();
    let ground = m.ground();
    let body = m.body("body", Vector3::new(0.1, 0.2, 0.7), Quaternion::identity());
    m.rigid_body("body", body, 1.0, Vector3::zeros(), [1.0; 6].map(|own| own * 0.1));
    let shelf = JointPart::of::<Shelf>();
    m.joint(&shelf, "shelf", &[ground, body], []);
    m.soft_joint(&shelf, "soft shelf", &[ground, body], [], [&[3.0], &[0.2]]);
    let own = m.model.constraints.iter().find(|own| own.name == "shelf").expect("what was added");
    assert_eq!(m.numbers.p[own.parameters.clone()], [0.7]);
    // the height is that of the world: its reactions turn both together
    assert!(!own.physics.is_balanced(&[0.7]));
    assert_eq!(m.numbers.p[m.model.elements[1].parameters.clone()], [3.0, 0.2, 0.7]);
}

#[test]
fn what_is_wrong_with_the_keys_of_an_entry_is_told() {
    let revolute = named("revolute").expect("an entry");
    let told = |nodes: usize, keys: Vec<(&'static str, GivenValue<f64>)>| {
        let mut m = MechanismBuilder::<f64>::default();
        let ground = m.ground();
        let body = m.body("body", Vector3::zeros(), Quaternion::identity());
        let point = m.point("point", Vector3::zeros());
        m.rigid_body("body", body, 1.0, Vector3::zeros(), [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]);
        m.point_mass("point", point, 1.0);
        m.joint(revolute, "hinge", &[ground, body, point][3 - nodes..], keys);
        m.finish().err().unwrap_or_default()
    };
    let axis = || ("axis", GivenValue::Vector(Vector3::new(0.0, 0.0, 2.0)));
    assert_eq!(told(3, vec![axis()]), "\"hinge\" needs 2 nodes, but 3 were given");
    assert_eq!(
        told(2, vec![axis(), ("pitch", 0.3.into())]),
        "\"hinge\", a revolute, has no key pitch: it has point, axis; \"hinge\" needs a body, which has axes, but node \"point\" is none: \
         make it a body, or take a joint for points"
    );
    let missing = told(2, vec![("point", GivenValue::Vector(Vector3::zeros()))]);
    assert!(missing.contains("\"hinge\", axis: \"hinge\" needs a vector for axis"), "{missing}");
    let elsewhere = told(2, vec![axis(), ("point", GivenValue::Vector(Vector3::new(1.0, 0.0, 0.0)))]);
    assert!(elsewhere.contains("\"hinge\", point: this point lies 1 m from \"point\", which has no axes"), "{elsewhere}");
    // a value of another kind is none at all, also where the key may be left out
    let mistyped = told(2, vec![axis(), ("point", 0.3.into())]);
    assert!(mistyped.contains("\"hinge\", point: \"hinge\" needs a vector for point"), "{mistyped}");
    let no_axis = told(2, vec![("axis", GivenValue::Vector(Vector3::zeros()))]);
    assert!(no_axis.contains("\"hinge\": a direction cannot be [0.0, 0.0, 0.0]"), "{no_axis}");
}
