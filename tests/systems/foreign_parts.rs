//! What is measured belongs to one model: asked for in another one it is refused by every door, without a panic and without a number.

use costate::functionals::Functional;
use costate::internals::{ElementSum, JointLoad, Measured, MeasuredGroup, MeasuredQuantity, Position, Reaction};
use costate::optimize::{Optimization, Sqp};
use costate::prelude::*;
use costate::sensitivity::Analysis;

/// What a functional measures that does not belong to the model.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Strange {
    Nothing,
    Node,
    Sizes,
    Joint,
    Multipliers,
    Parameters,
    Element,
    LoadOfAJoint,
    JointOfALoad,
    KindOfALoad,
    PlaceOfALoad,
    Sharpness,
}

const ALL: [Strange; 11] = {
    use Strange::*;
    [Node, Sizes, Joint, Multipliers, Parameters, Element, LoadOfAJoint, JointOfALoad, KindOfALoad, PlaceOfALoad, Sharpness]
};

/// A point on a rod and a body on a hinge.
struct Held(Strange);

struct Parts {
    bob: NodeId,
    rod: ConstraintId,
    hinge: ConstraintId,
    heavy: ElementId,
}

fn hold<S: Scalar>(m: &mut MechanismBuilder<S>, mass: S) -> Parts {
    let at = |x: f64, y: f64, z: f64| Vector3::new(S::from(x), S::from(y), S::from(z));
    let (ground, bob) = (m.ground(), m.point("bob", at(1.0, 0.0, 0.0)));
    let arm = m.body("arm", at(0.0, 0.5, 0.0), Quaternion::identity());
    let heavy = m.point_mass("heavy", bob, mass);
    let inertia = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0].map(S::from);
    m.rigid_body("arm", arm, S::one(), Vector3::zeros(), inertia);
    m.gravity(at(0.0, -9.81, 0.0));
    let rod = m.distance("rod", [ground, bob], [Vector3::zeros(), at(1.0, 0.0, 0.0)]);
    let hinge = m.revolute("hinge", [ground, arm], Vector3::zeros(), at(0.0, 0.0, 1.0));
    Parts { bob, rod, hinge, heavy }
}

impl Scene for Held {
    fn name(&self) -> String {
        "held".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 2.0, (1.0, 3.0), "kg")]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.1, 10)
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        Some(OptimizationProblem::minimize("measured"))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let own = hold(m, x[0]);
        let mut elsewhere = MechanismBuilder::default();
        let other = hold(&mut elsewhere, x[0]);
        let strange = |kind: Strange| self.0 == kind;
        let (bob, rod) = (
            if strange(Strange::Node) { other.bob } else { own.bob },
            if strange(Strange::Joint) { other.rod } else { own.rod },
        );
        let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let parameters = m.model.add_parameters(numbers.len());
        m.numbers.p.extend(numbers.map(S::from));
        let local = |nodes: Vec<NodeId>, constraints, parameters, quantity| Measured::Local {
            nodes,
            constraints,
            parameters,
            quantity,
        };
        let loaded = |joint, place, on| {
            let load = JointLoad::new(LoadKind::Force, LoadFrame::World, place, on);
            Measured::Load { joint, parameters: parameters.clone(), load }
        };
        let ground = m.model.node_named("ground").map_or(0, |ground| m.model.node(ground).dofs.len());
        let place = ground..ground + 3;
        let measured = match self.0 {
            Strange::Nothing | Strange::Node | Strange::Sharpness => {
                local(vec![bob], vec![], parameters, MeasuredQuantity::new(Box::new(Position { of: NodeKind::Point }), 0))
            }
            Strange::Parameters => {
                let behind = parameters.start + 1..parameters.end + 1;
                local(vec![bob], vec![], behind, MeasuredQuantity::new(Box::new(Position { of: NodeKind::Point }), 0))
            }
            Strange::Sizes => {
                local(vec![bob], vec![], parameters, MeasuredQuantity::new(Box::new(Position { of: NodeKind::Body }), 0))
            }
            Strange::Joint => {
                let one = parameters.start..parameters.start + 1;
                local(vec![], vec![rod], one, MeasuredQuantity::new(Box::new(Reaction { equations: 1, unit: "N" }), 1))
            }
            Strange::Multipliers => {
                let one = parameters.start..parameters.start + 1;
                local(vec![], vec![own.hinge], one, MeasuredQuantity::new(Box::new(Reaction { equations: 1, unit: "N" }), 1))
            }
            Strange::Element => {
                let none = parameters.start..parameters.start;
                Measured::Group(MeasuredGroup::new(Some(vec![other.heavy]), ElementSum::Mass.into(), none))
            }
            Strange::LoadOfAJoint => loaded(other.rod, place, NodeKind::Point),
            Strange::JointOfALoad => loaded(own.hinge, place, NodeKind::Point),
            Strange::KindOfALoad => loaded(own.rod, place, NodeKind::Body),
            Strange::PlaceOfALoad => loaded(own.rod, place.start + 1..place.end + 1, NodeKind::Point),
        };
        let over = if strange(Strange::Sharpness) { Over::smooth_maximum(f64::NAN) } else { Over::Integral };
        m.functionals.push(Functional { name: "measured".into(), unit: "-", measured, over });
        Ok(())
    }
}

fn assert_refused<T>(what: impl std::fmt::Debug, result: Result<T, RunError>) {
    match result.err() {
        Some(RunError::Input(why)) => {
            assert!(why.contains("functional \"measured\"") || why.contains("functional \"other\""), "{what:?}: {why}");
        }
        other => panic!("{what:?}: {other:?} instead of a refusal"),
    }
}

#[test]
fn a_scene_that_measures_what_is_not_its_own_is_refused() {
    let sound = Held(Strange::Nothing);
    Prepared::new(&sound).expect("sound").analysis().forward(&[2.0]).expect("runs");
    for strange in ALL {
        let scene = Held(strange);
        assert_refused(strange, Prepared::new(&scene));
        let mut optimization = Optimization::of(&scene).expect("a problem");
        optimization.stopping.iterations = 2;

        match optimization.run(&Sqp, &[2.0], &mut ()) {
            Err(RunError::Input(why)) => assert!(why.contains("functional \"measured\""), "{strange:?}: {why}"),
            other => panic!("{strange:?}: {:?} instead of a refusal", other.err()),
        }
    }
}

#[test]
fn an_analysis_with_functionals_of_another_model_is_refused_by_every_door() {
    let scene = Held(Strange::Nothing);
    let (own, other) = (Prepared::new(&scene).expect("sound"), Prepared::new(&scene).expect("sound"));
    let x = [2.0];
    let (of_own, of_other) = (own.analysis().forward(&x).expect("runs"), other.analysis().forward(&x).expect("runs"));
    let mixed = Analysis { functionals: other.functionals(), ..own.analysis() };
    assert_refused("forward", mixed.forward(&x));
    assert_refused("values", mixed.values(&x));
    assert_refused("nearby", mixed.values_nearby(&x));
    assert_refused("differences", mixed.central_difference(&x, &[1.0], 1e-3));
    for forward in [&of_own, &of_other] {
        assert_refused("adjoint", mixed.adjoint(&x, forward));
        assert_refused("tangent", mixed.tangent(&x, forward));
        assert_refused("complex step", mixed.complex_step(&x, forward));
        assert_refused("over time", mixed.complex_step_over_time(&x, forward));
        assert_refused("motion", mixed.motion(forward, &[0.05]));
    }
    // energy and mass name no element: what they found in one model is not what another one has
    for measured in [|| Measured::energy(), || Measured::Group(MeasuredGroup::new(None, ElementSum::Mass.into(), 0..0))] {
        let functionals = [Functional { name: "other".into(), unit: "J", measured: measured(), over: Over::Integral }];
        Analysis { functionals: &functionals, ..own.analysis() }.forward(&x).expect("runs");
        assert_refused("another model", Analysis { functionals: &functionals, ..other.analysis() }.forward(&x));
    }
}
