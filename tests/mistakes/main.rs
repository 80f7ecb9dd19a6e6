//! A user's mistake gets an answer: what is wrong, where, how much, and what to do.

mod foreign_ids;

use costate::elements::flexible::{CableSection, Material, Section, Shape};
use costate::prelude::*;
use costate::scenes::{BeamLine, CableLine};
use std::hash::{Hash, Hasher};

/// A body on a joint, with room for one mistake.
#[derive(Clone, Copy)]
enum Mistake {
    NegativeMass,
    NonUnitQuaternion,
    LengtheningRates,
    UnconnectedBody,
    GapInJoint,
    WrongVelocity,
    RedundantJoint,
    NanParameter,
    NoInertia,
    WrongParameterCount,
    EnergyWithoutEnergies,
    TopologyFromDesign,
    JumpingDriver,
    ZeroPitch,
    SkewPins,
    PointForBody,
    OtherNodes,
    NoAxis,
    BodyForAngle,
    LooseCoordinate,
    NegativeMoment,
    UnevenMoments,
    NegativeSides,
    ThickWall,
    NoDiameter,
    SkewStiffness,
    IndefiniteStiffness,
    NoShear,
    TwoFunctionals,
    TwoJoints,
    TwoVariables,
}
struct Mistaken(Option<Mistake>);

/// States a residual and no energies.
#[derive(Hash)]
pub struct Drag;
impl Element for Drag {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body]
    }
    fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
        r[0] += s.v[0];
    }
}

fn steel<S: Scalar>() -> Material<S> {
    Material { young: S::from(2e11), poisson: S::from(0.3), density: S::from(7800.0) }
}

/// A section with stiffness 1, but for these entries.
fn stiff<S: Scalar>(entries: &[(usize, usize, f64)]) -> Section<S> {
    let mut stiffness = [[S::zero(); 6]; 6];
    (0..6).for_each(|i| stiffness[i][i] = S::one());
    entries.iter().for_each(|&(i, j, entry)| stiffness[i][j] = S::from(entry));
    Section::new([S::one(); 6]).with_stiffness(stiffness)
}

/// A beam of one element.
fn arm<S: Scalar>(m: &mut MechanismBuilder<S>, section: Section<S>) {
    let points = [[0.0; 3], [1.0, 0.0, 0.0]].map(Vector3::from_f64);
    m.beam("arm", BeamLine::straight(points, 1, Vector3::from_f64([0.0, 1.0, 0.0])).clamped_start(), &section);
}
impl Scene for Mistaken {
    fn name(&self) -> String {
        "mistaken".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let length = DesignVariable::new("length", 1.0, (0.5, 2.0), "m");
        vec![length; if let Some(Mistake::TwoVariables) = self.0 { 2 } else { 1 }]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 50)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        use Mistake::*;
        let ground = m.ground();
        let axis = Vector3::from_f64([1.0, 0.0, 0.0]);
        let mut turn = Quaternion::identity();
        if let Some(NonUnitQuaternion) = self.0 {
            turn.0[0] = S::from(1.1);
        }
        let rod = m.body("rod", axis * (x[0] * 0.5), turn);
        let mass = match self.0 {
            Some(NegativeMass) => -2.0,
            Some(NanParameter) => f64::NAN,
            _ => 2.0,
        };
        let tensor = match self.0 {
            Some(NegativeMoment) => [0.01, 0.2, 0.2, 0.0, 0.0, 0.3],
            Some(UnevenMoments) => [0.01, 0.2, 0.5, 0.0, 0.0, 0.0],
            _ => [0.01, 0.2, 0.2, 0.0, 0.0, 0.0],
        };
        let tensor = tensor.map(S::from);
        m.rigid_body("rod", rod, S::from(mass), Vector3::zeros(), tensor);
        let hinge = Vector3::from_f64([0.0, 1.0, 0.0]);
        let pivot = if let Some(GapInJoint) = self.0 { 0.01 } else { 0.0 };
        m.revolute("hinge", [ground, rod], Vector3::zeros(), hinge);
        m.numbers.p[m.model.constraints[0].parameters.start] = S::from(pivot);
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        m.position_functional("tip", Over::Terminal, rod, axis * x[0], Vector3::from_f64([0.0, 0.0, 1.0]));
        match self.0 {
            Some(LengtheningRates) => {
                let first = m.model.nodes[1].dofs.start;
                m.numbers.v[first + 3] = S::from(0.25);
            }
            Some(UnconnectedBody) => {
                m.body("forgotten", Vector3::zeros(), Quaternion::identity());
            }
            Some(WrongVelocity) => m.set_velocity(rod, axis, Vector3::zeros()),
            Some(RedundantJoint) => {
                m.revolute("second hinge", [ground, rod], hinge, hinge);
            }
            Some(NoInertia) => {
                let point = m.point("tip", axis * x[0]);
                let ends = [axis * x[0], Vector3::from_f64([2.0, 0.0, 0.5])];
                m.line_spring("string", [point, ground], ends, S::from(10.0), S::from(0.1));
            }
            Some(WrongParameterCount) => {
                m.element("drag", &[rod], Drag, &[S::one()]);
            }
            Some(EnergyWithoutEnergies) => {
                m.element("drag", &[rod], Drag, &[]);
                m.energy_functional("energy", Over::Terminal);
            }
            Some(JumpingDriver) => {
                let jump = Signal::Step { before: S::zero(), after: S::one(), switch: 0.5 };
                m.prescribed_rotation("motor", [ground, rod], hinge, jump);
            }
            Some(ZeroPitch) => drop(m.helical("screw", [ground, rod], hinge, hinge, S::zero())),
            Some(SkewPins) => drop(m.universal("cross", [ground, rod], hinge, [axis, axis + hinge])),
            Some(NoAxis) => drop(m.prismatic("slide", [ground, rod], hinge, Vector3::zeros())),
            Some(PointForBody) => {
                let bob = m.point("bob", axis * x[0]);
                m.point_mass("bob", bob, S::one());
                m.cylindrical("sleeve", [rod, bob], axis * x[0], axis);
            }
            Some(OtherNodes) => {
                // as many coordinates as a body
                let numbers = m.coordinates("numbers", &[S::zero(); 7], &[S::zero(); 7]);
                m.element("drag", &[numbers], Drag, &[]);
            }
            Some(BodyForAngle) => {
                let angle = m.joint_angle("count", [ground, rod], hinge);
                m.gear("teeth", [angle, rod], [S::one(); 2]);
            }
            // one equation holds one of two coordinates without inertia
            Some(LooseCoordinate) => {
                let loose = ["first", "second"].map(|name| m.coordinates(name, &[S::zero()], &[S::zero()]));
                m.gear("teeth", loose, [S::one(); 2]);
            }
            Some(TopologyFromDesign) if !x[0].is_constant() => {
                m.line_damper("appears", [ground, rod], [hinge, axis * x[0]], S::one());
            }
            Some(NegativeSides) => {
                arm(m, Section::of(steel(), Shape::rectangle(S::from(-0.1), S::from(-0.2), S::from(0.3))))
            }
            Some(ThickWall) => arm(m, Section::of(steel(), Shape::tube(S::from(0.1), S::from(0.06), S::from(0.3)))),
            Some(NoDiameter) => {
                let line = CableLine::straight([axis, axis * S::from(2.0)], 1);
                m.cable("rope", line, &CableSection::of(steel(), Shape::circle(S::zero(), S::from(0.3))));
            }
            Some(SkewStiffness) => arm(m, stiff(&[(0, 0, 2.0), (0, 4, 0.5)])),
            Some(IndefiniteStiffness) => arm(m, stiff(&[(0, 4, 2.0), (4, 0, 2.0)])),
            Some(NoShear) => arm(m, Section::new([1.0, 0.0, 1.0, 1.0, 1.0, 1.0].map(S::from))),
            Some(TwoFunctionals) => m.energy_functional("tip", Over::Terminal),
            Some(TwoJoints) => drop(m.point_in_plane("hinge", [ground, rod], Vector3::zeros(), hinge)),
            _ => {}
        }
        Ok(())
    }
}

fn refused(mistake: Mistake) -> String {
    match Prepared::new(&Mistaken(Some(mistake))) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("the mistake went unnoticed"),
    }
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "\"{part}\" is missing in: {message}");
    }
}

#[test]
fn without_a_mistake_the_scene_runs() {
    let scene = Prepared::new(&Mistaken(None)).expect("no mistake");
    let forward = scene.analysis().forward(&scene.x).expect("no mistake");
    assert!(forward.values[0].abs() <= 1.0, "the tip stays within the rod's length");
}

#[test]
fn a_negative_mass_is_named_with_its_value_and_range() {
    assert_says(&refused(Mistake::NegativeMass), &["\"rod\"", "mass is -2 kg", "0 or greater"]);
}

#[test]
fn nan_in_a_parameter_stops_at_the_door() {
    assert_says(&refused(Mistake::NanParameter), &["\"rod\"", "mass is NaN kg", "0 or greater"]);
}

#[test]
fn a_quaternion_that_is_not_of_unit_length_is_shown() {
    assert_says(&refused(Mistake::NonUnitQuaternion), &["\"rod\"", "1.1", "not 1", "normalize"]);
}

#[test]
fn rates_that_lengthen_a_quaternion_are_shown() {
    assert_says(&refused(Mistake::LengtheningRates), &["\"rod\"", "2.500e-1", "angular velocity"]);
}

#[test]
fn an_unconnected_body_is_named() {
    assert_says(&refused(Mistake::UnconnectedBody), &["\"forgotten\"", "not connected", "inertia"]);
}

#[test]
fn a_start_off_its_joints_is_refused_with_the_numbers() {
    assert_says(&refused(Mistake::GapInJoint), &["\"hinge\", constraint 1", "g = -1.0", "e-2", "projected"]);
}

#[test]
fn velocities_against_the_joints_are_refused_with_the_numbers() {
    assert_says(&refused(Mistake::WrongVelocity), &["\"hinge\", constraint 1", "dg/dt = 1.0", "projected"]);
}

#[test]
fn a_start_off_its_joints_can_be_projected() {
    for mistake in [Mistake::GapInJoint, Mistake::WrongVelocity, Mistake::NonUnitQuaternion, Mistake::LengtheningRates] {
        let scene = Mistaken(Some(mistake));
        let settings = scene.settings().projecting_start();
        let prepared = Prepared::with(&scene, &[1.0], Prepared::default_method(), settings).expect("can be projected");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&[1.0]).expect("runs after projection");
        let gradient = analysis.adjoint(&[1.0], &forward).expect("has a gradient");
        let check = analysis.complex_step(&[1.0], &forward).expect("has a gradient");
        assert!(largest_difference(&check.rows[0], &gradient.rows[0]) < 1e-12);
    }
}

#[test]
fn redundant_constraints_are_named_with_the_subset_that_remains() {
    let message = refused(Mistake::RedundantJoint);
    assert_says(
        &message,
        &["5 of 10 equations", "\"second hinge\", constraint", "independent subset is", "\"hinge\", constraint 1"],
    );
}

#[test]
fn a_point_without_inertia_is_named() {
    assert_says(&refused(Mistake::NoInertia), &["\"tip\"", "inertia", "mass"]);
}

#[test]
fn a_wrong_number_of_parameters_shows_both_numbers() {
    assert_says(&refused(Mistake::WrongParameterCount), &["\"drag\"", "0 parameters", "1 values"]);
}

#[test]
fn a_driver_that_jumps_is_refused() {
    assert_says(&refused(Mistake::JumpingDriver), &["\"motor\"", "jump at t = 0.5 s", "smooth ramp"]);
}

#[test]
fn a_screw_without_pitch_is_refused() {
    assert_says(&refused(Mistake::ZeroPitch), &["\"screw\"", "pitch is 0 m", "other than 0"]);
}

#[test]
fn pins_of_a_universal_joint_that_are_not_at_right_angles_are_shown_with_their_angle() {
    assert_says(&refused(Mistake::SkewPins), &["\"cross\"", "45.000000 degrees", "must be at 90"]);
}

#[test]
fn a_point_where_a_joint_needs_a_body_is_named() {
    assert_says(&refused(Mistake::PointForBody), &["\"sleeve\" needs a body", "\"bob\"", "joint for points"]);
}

#[test]
fn an_element_on_nodes_of_another_kind_is_named_with_both_kinds() {
    assert_says(&refused(Mistake::OtherNodes), &["\"drag\"", "takes hold of a body", "its nodes are 7 coordinates"]);
}

#[test]
fn an_axis_of_no_length_is_shown() {
    assert_says(&refused(Mistake::NoAxis), &["\"slide\"", "[0.0, 0.0, 0.0]", "any length but zero"]);
}

#[test]
fn a_gear_on_a_body_asks_for_a_joint_angle() {
    assert_says(&refused(Mistake::BodyForAngle), &["gear \"teeth\"", "\"rod\"", "joint_angle"]);
}

#[test]
fn coordinates_without_inertia_that_joints_leave_free_are_named() {
    assert_says(&refused(Mistake::LooseCoordinate), &["coordinate 0", "no inertia", "give it a mass or a constraint"]);
}

#[test]
fn an_energy_functional_refuses_elements_without_energies() {
    assert_says(&refused(Mistake::EnergyWithoutEnergies), &["energy", "\"drag\""]);
}

#[test]
fn topology_that_depends_on_the_design_is_refused() {
    let scene = Mistaken(Some(Mistake::TopologyFromDesign));
    let prepared = Prepared::new(&scene).expect("real numbers see no change");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).expect("runs");
    let error = analysis.adjoint(&prepared.x, &forward).expect_err("the recorded scene has one more element").to_string();
    assert_says(&error, &["\"mistaken\"", "topology changes"]);
}

#[test]
fn a_design_out_of_bounds_is_refused_with_the_bounds() {
    let scene = Mistaken(None);
    let message = match Prepared::with(&scene, &[3.0], Prepared::default_method(), scene.settings()) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("out of bounds went unnoticed"),
    };
    assert_says(&message, &["\"length\"", "3 m", "between 0.5 and 2 m"]);
}

#[test]
fn a_step_that_is_too_large_says_where_newton_stopped() {
    let scene = Mistaken(None);
    let settings = Settings::new(40.0, 4);
    let prepared = Prepared::with(&scene, &[1.0], Prepared::default_method(), settings).expect("the start is sound");
    let message = prepared.analysis().forward(&[1.0]).expect_err("10 s per step").to_string();
    assert_says(&message, &["step ", "t = ", "Newton", "largest row", "smaller step"]);
}

/// A bead whose formula takes the root of its place.
struct Root {
    place: f64,
    /// Points beside it that nothing connects with it.
    others: usize,
}

// its formulas read none of them
impl Hash for Root {
    fn hash<H: Hasher>(&self, _state: &mut H) {}
}

impl Element for Root {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg"), Parameter::new("pull", "N")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[0] = p[0] * s.a[0] + p[1] + s.q[0].sqrt();
    }
}

impl Scene for Root {
    fn name(&self) -> String {
        "root".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 2.0, (1.0, 3.0), "kg")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 20)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let rod = m.body("rod", Vector3::from_f64([0.5, 0.0, 0.0]), Quaternion::identity());
        m.rigid_body("rod", rod, S::one(), Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0].map(S::from));
        m.revolute("hinge", [ground, rod], Vector3::zeros(), Vector3::from_f64([0.0, 1.0, 0.0]));
        let bead = m.coordinates("bead", &[S::from(self.place)], &[S::zero()]);
        m.element("rooted bead", &[bead], Root { place: 0.0, others: 0 }, &[x[0], S::from(3.0)]);
        for other in 0..self.others {
            let name = format!("point {other}");
            let point = m.point(&name, Vector3::zeros());
            m.point_mass(&name, point, S::one());
        }
        m.coordinate_functional("place", Over::Terminal, bead, 0);
        Ok(())
    }
}

#[test]
fn an_element_that_gives_no_number_is_named_with_its_arguments() {
    let message = match Prepared::new(&Root { place: -0.25, others: 0 }) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("a root of a negative number went unnoticed"),
    };
    assert_says(&message, &["start", "\"rooted bead\"", "row 0 of its formula is NaN", "q = (-2.5000e-1)", "mass = 2 kg"]);
    // later: the bead falls below zero, whatever moves on beside it
    for others in [0, 5] {
        let scene = Root { place: 0.5, others };
        let prepared = Prepared::new(&scene).expect("the start is sound");
        let message = prepared.analysis().forward(&prepared.x).expect_err("falls out of its formula").to_string();
        assert_says(&message, &["step ", "\"rooted bead\"", "row 0 of its formula is NaN", "q = (-", "pull = 3 N"]);
    }
}

/// A spring between points that coincide has no direction.
struct NoLength;

impl Scene for NoLength {
    fn name(&self) -> String {
        "no length".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("stiffness", 2.0, (1.0, 3.0), "N/m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 20)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let bob = m.point("bob", Vector3::zeros());
        m.point_mass("bob", bob, S::one());
        m.line_spring("string", [ground, bob], [Vector3::zeros(); 2], x[0], S::from(0.1));
        Ok(())
    }
}

#[test]
fn a_spring_of_no_length_is_named() {
    let prepared = Prepared::new(&NoLength).expect("its force is taken to be zero there");
    let message = prepared.analysis().forward(&[2.0]).expect_err("its stiffness is no number").to_string();
    assert_says(&message, &["step 1", "\"string\"", "a derivative of row", "is NaN", "stiffness = 2 N/m"]);
}

#[test]
fn a_tensor_of_inertia_with_a_negative_principal_moment_is_refused_with_its_moments() {
    let message = refused(Mistake::NegativeMoment);
    assert_says(&message, &["\"rod\"", "principal moments", "-1.000e-1, 1.000e-2 and 5.000e-1 kg m2", "mass centre"]);
}

#[test]
fn a_tensor_of_inertia_that_no_body_has_is_refused_with_its_moments() {
    let message = refused(Mistake::UnevenMoments);
    assert_says(&message, &["\"rod\"", "1.000e-2, 2.000e-1 and 5.000e-1 kg m2", "exceeds the sum", "by 2.900e-1"]);
}

#[test]
fn shapes_of_impossible_sizes_are_refused_with_their_numbers() {
    assert_says(&refused(Mistake::NegativeSides), &["\"arm\"", "width is -0.1 m", "greater than 0"]);
    assert_says(&refused(Mistake::ThickWall), &["\"arm\"", "wall is 0.06 m", "half of its diameter, 0.05 m"]);
    assert_says(&refused(Mistake::NoDiameter), &["\"rope\"", "diameter is 0 m", "greater than 0"]);
}

#[test]
fn stiffness_of_a_section_without_an_energy_is_refused_with_its_entries() {
    assert_says(&refused(Mistake::SkewStiffness), &["\"arm\"", "row 1, column 5", "0.5", "0", "symmetric"]);
    assert_says(&refused(Mistake::IndefiniteStiffness), &["\"arm\"", "not positive definite", "-1.0"]);
    assert_says(&refused(Mistake::NoShear), &["\"arm\"", "row 2, column 2", "is 0", "greater than 0"]);
}

#[test]
fn results_that_share_a_name_are_refused() {
    assert_says(&refused(Mistake::TwoFunctionals), &["two functionals are named \"tip\""]);
    assert_says(&refused(Mistake::TwoJoints), &["two joints are named \"hinge\""]);
    assert_says(&refused(Mistake::TwoVariables), &["two design variables are named \"length\""]);
}

#[test]
fn a_run_at_a_design_out_of_bounds_is_refused_with_the_bounds() {
    let scene = Prepared::new(&Mistaken(None)).expect("no mistake");
    let analysis = scene.analysis();
    let forward = analysis.forward(&scene.x).expect("no mistake");
    let refused: [(&[f64], &[&str]); 3] = [
        (&[3.0], &["\"length\" is 3 m", "between 0.5 and 2 m"]),
        (&[f64::NAN], &["\"length\" is NaN m", "between 0.5 and 2 m"]),
        (&[1.0, 1.0], &["1 design variable", "2 values"]),
    ];
    for (x, expected) in refused {
        let runs = [analysis.values(x).err(), analysis.forward(x).err()];
        let gradients = [analysis.adjoint(x, &forward), analysis.tangent(x, &forward), analysis.complex_step(x, &forward)];
        for error in runs.into_iter().chain(gradients.map(Result::err)) {
            assert_says(&error.expect("out of bounds went unnoticed").to_string(), expected);
        }
    }
}

#[test]
fn settings_that_name_another_method_than_the_given_one_are_refused() {
    let settings = Mistaken(None).settings().with_method("bdf2");
    let error = Prepared::with(&Mistaken(None), &[1.0], Prepared::default_method(), settings).err();
    assert_says(
        &error.expect("two methods went unnoticed").to_string(),
        &["\"bdf2\"", "\"esdirk4\"", "Prepared::method_of"],
    );
}

#[test]
fn numbers_of_many_digits_are_told_in_few() {
    let scene = Mistaken(None);
    let error = Prepared::with(&scene, &[1e300], Prepared::default_method(), scene.settings()).err();
    assert_says(&error.expect("out of bounds went unnoticed").to_string(), &["is 1e300 m"]);
}

#[test]
fn more_steps_than_can_be_kept_are_refused() {
    let settings = Settings::new(1.0, usize::MAX);
    let error = Prepared::with(&Mistaken(None), &[1.0], Prepared::default_method(), settings).err();
    assert_says(&error.expect("the number went unnoticed").to_string(), &["18446744073709551615 steps", "at most"]);
}

#[test]
fn gradients_are_asked_for_by_one_flag_for_each_functional() {
    let scene = Prepared::new(&Mistaken(None)).expect("no mistake");
    let forward = scene.analysis().forward(&scene.x).expect("no mistake");
    for flags in [&[][..], &[true, true]] {
        let error = scene.analysis().adjoint_of(&scene.x, &forward, flags).err();
        assert_says(
            &error.expect("the flags went unnoticed").to_string(),
            &["1 functional", &format!("{} flags", flags.len())],
        );
    }
}

/// The root of a coordinate: at zero its slope is that of a wall.
#[derive(Hash)]
struct RootOfPlace;

impl Quantity for RootOfPlace {
    fn dofs(&self) -> usize {
        3
    }
    fn unit(&self) -> &'static str {
        "-"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.q[0].sqrt()
    }
}

/// A point that rests at the origin.
struct AtTheOrigin;

impl Scene for AtTheOrigin {
    fn name(&self) -> String {
        "at the origin".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 2.0, (1.0, 3.0), "kg"), DesignVariable::new("place", 0.0, (-1.0, 1.0), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.1, 5)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let point = m.point("point", Vector3::new(x[1], S::zero(), S::zero()));
        m.point_mass("point", point, x[0]);
        m.functional("root of its place", Over::Terminal, (&[point], &[]), RootOfPlace, &[]);
        Ok(())
    }
}

#[test]
fn a_functional_without_a_derivative_is_told() {
    let prepared = Prepared::new(&AtTheOrigin).expect("a scene");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("a run");
    assert_eq!(forward.values, [0.0]);
    for gradient in [analysis.adjoint(x, &forward), analysis.tangent(x, &forward)] {
        let error = gradient.expect_err("a gradient that is no number").to_string();
        assert_says(&error, &["\"root of its place\"", "by variable \"", "has none at a state", "leave the functional out"]);
    }
}

/// Looks for a coordinate that it does not have.
#[derive(Hash)]
struct OutOfRange;

impl Element for OutOfRange {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(2)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
        r[0] += s.a[0] + s.q[2];
        r[1] += s.a[1];
    }
}

/// A scene with it.
struct Beyond;

impl Scene for Beyond {
    fn name(&self) -> String {
        "beyond".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 10)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.coordinates("mass", &[S::zero(); 2], &[S::zero(); 2]);
        m.element("finger", &[node], OutOfRange, &[]);
        Ok(())
    }
}

#[test]
fn a_formula_that_panics_is_told_by_the_name_of_its_part() {
    let error = Prepared::new(&Beyond).map(|_| ()).expect_err("an index out of range").to_string();
    assert_says(&error, &["\"finger\"", "its formula panics", "index out of bounds"]);
}
