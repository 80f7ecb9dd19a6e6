//! Redundant constraints: a loop of six hinges whose equations depend on each other at every pose.

use costate::elements::forces::LoadFrame;
use costate::functionals::{LoadKind, Over};
use costate::history::{Keep, Observer};
use costate::integrators::{ConstraintLevel, Method, RunError, StartRecord, StepControl, StepRecord, table_by_name};
use costate::internals::march;
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, MechanismBuilder, Prepared, Scene, Settings};
use costate::sensitivity::largest_difference;

/// Bricard's loop of six bars along the edges of a unit cube, each hinge at right angles to both its bars; one bar is the ground.
pub struct Loop {
    /// Order in which the hinges are given: the equations of the last are left out first.
    pub order: [usize; 6],
    pub end: f64,
    pub steps: usize,
}

const CORNERS: [[f64; 3]; 6] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.], [0., 0., 1.]];
const AXES: [[f64; 3]; 6] = [[0., 1., 0.], [0., 0., 1.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 0.]];

impl Scene for Loop {
    fn name(&self) -> String {
        "loop of six hinges".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 10.0, (1.0, 20.0), "kg"), DesignVariable::new("size", 1.0, (0.5, 2.0), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(self.end, self.steps).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let corner = |i: usize| Vector3::<S>::from_f64(CORNERS[i % 6]) * x[1];
        let mut bars: Vec<_> = (0..5)
            .map(|i| {
                let (from, to) = (corner(i), corner(i + 1));
                let along = (to - from).unit();
                let bar = m.body(&format!("bar {i}"), (from + to) * S::from(0.5), Quaternion::x_axis_to(along));
                let lateral = x[0] * x[1] * x[1] / 12.0;
                let zero = S::zero();
                m.rigid_body(
                    &format!("bar {i}"),
                    bar,
                    x[0],
                    Vector3::zeros(),
                    [lateral * 1e-3, lateral, lateral, zero, zero, zero],
                );
                bar
            })
            .collect();
        bars.push(m.ground());
        m.gravity(Vector3::from_f64([0.0, -9.81, 0.0]));
        let mut joints = vec![None; 6];
        for i in self.order {
            let nodes = [bars[(i + 5) % 6], bars[i]];
            joints[i] = Some(m.revolute(&format!("hinge {i}"), nodes, corner(i), Vector3::from_f64(AXES[i])));
        }
        m.position_functional("place", Over::Terminal, bars[2], corner(3), Vector3::from_f64([1.0, 0.5, -0.3]));
        m.energy_functional("energy", Over::Terminal);
        for (i, joint) in joints.into_iter().enumerate() {
            let weights = [1.0, 0.5, -0.7, 0.3, 0.2].map(S::from);
            m.reaction_functional(&format!("reaction {i}"), Over::Integral, joint.ok_or("no joint")?, &weights);
        }
        Ok(())
    }
}

/// Remembers which equations were left out, and how far those were violated.
struct Watching<'p> {
    prepared: &'p Prepared<'p>,
    dropped: Vec<Vec<usize>>,
    worst: f64,
}

impl Observer for Watching<'_> {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        self.dropped.push(start.dropped.clone());
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        if self.dropped.last() != Some(&step.dropped) {
            assert!(step.restart.is_some(), "t = {}: multipliers of other equations are solved for anew", step.t);
            self.dropped.push(step.dropped.clone());
        }
        self.worst = self.worst.max(self.prepared.violation(step.t + step.h, &step.q, &step.v).position);
        Ok(true)
    }
}

pub const ORDERS: [[usize; 6]; 3] = [[0, 1, 2, 3, 4, 5], [3, 4, 5, 0, 1, 2], [5, 4, 3, 2, 1, 0]];

#[test]
fn equations_are_exchanged_on_the_way_and_dropped_ones_hold() {
    let mut exchanges = 0;
    for order in ORDERS {
        let scene = Loop { order, end: 10.0, steps: 2000 };
        let prepared = Prepared::new(&scene).unwrap();
        let problem = prepared.problem();
        let mut watching = Watching { prepared: &prepared, dropped: Vec::new(), worst: 0.0 };
        march(&problem, &prepared.method, &prepared.grid, &prepared.plan, &mut watching).unwrap();
        assert!(watching.dropped.iter().all(|dropped| dropped.len() == 1), "{:?}", watching.dropped);
        assert!(watching.worst < 1e-13, "{order:?}: violation {:e}", watching.worst);
        exchanges += watching.dropped.len() - 1;
    }
    assert!(exchanges > 0, "the test is about exchanges");
}

#[test]
fn motion_energy_and_least_reactions_do_not_depend_on_which_equation_is_left_out() {
    let values = ORDERS.map(|order| {
        let scene = Loop { order, end: 4.0, steps: 1000 };
        Prepared::new(&scene).unwrap().analysis().forward(&[10.0, 1.0]).unwrap().values
    });
    println!("{values:?}");
    for other in &values[1..] {
        for (k, (a, b)) in values[0].iter().zip(other).enumerate() {
            assert!((a - b).abs() < 1e-6 * a.abs().max(1.0), "functional {k}: {a} against {b}");
        }
    }
    assert!((values[0][1] - 294.3).abs() < 1e-5 * 294.3, "energy {}", values[0][1]);
}

#[test]
fn gradients_of_motion_and_reactions_agree_across_exchanges() {
    let scene = Loop { order: ORDERS[0], end: 1.0, steps: 250 };
    for level in ConstraintLevel::ALL {
        let method = Method::new(table_by_name("esdirk4").unwrap(), level);
        let prepared = Prepared::with(&scene, &[10.0, 1.0], method, scene.settings()).unwrap();
        let mut watching = Watching { prepared: &prepared, dropped: Vec::new(), worst: 0.0 };
        march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watching).unwrap();
        assert!(watching.dropped.len() > 1, "{}: nothing was exchanged", level.name());
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).unwrap();
        let adjoint = analysis.adjoint(&prepared.x, &forward).unwrap();
        let stepped = analysis.complex_step(&prepared.x, &forward).unwrap();
        let tangent = analysis.tangent(&prepared.x, &forward).unwrap();
        let differences = [&adjoint, &tangent].map(|gradient| {
            let rows = gradient.rows.iter().zip(&stepped.rows);
            rows.map(|(own, stepped)| largest_difference(own, stepped)).fold(0.0, f64::max)
        });
        println!("{}: {differences:?}", level.name());
        let limit = if level == ConstraintLevel::Acceleration { 1e-12 } else { 1e-9 };
        assert!(differences.iter().all(|difference| *difference < limit), "{}: {differences:?}", level.name());
    }
}

/// A door of weight W and width b on two hinges a distance h apart, at rest: the couple W b / 2 is shared by the forces F h and the
/// moments m of both hinges; of all ways F h + 2 m = W b / 2 that with least norm of F and m / L has F = h m / (2 L2).
struct Door;

impl Scene for Door {
    fn name(&self) -> String {
        "door".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(0.1, 2).dropping_redundant()
    }
    fn build<S: Scalar>(&self, _: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let (ground, z) = (m.ground(), at([0.0, 0.0, 1.0]));
        let door = m.body("door", at([0.4, 0.0, 0.0]), Quaternion::identity());
        m.rigid_body("door", door, S::from(20.0), Vector3::zeros(), [1.0, 2.0, 1.0, 0.0, 0.0, 0.0].map(S::from));
        m.gravity(at([0.0, 0.0, -10.0]));
        let hinges = [1.0, -1.0].map(|height| {
            let point = at([0.0, 0.0, height]);
            (m.revolute(&format!("hinge at {height}"), [ground, door], point, z), point, height)
        });
        for (name, kind, direction) in [
            ("pull", LoadKind::Force, [1.0, 0.0, 0.0]),
            ("lift", LoadKind::Force, [0.0, 0.0, 1.0]),
            ("moment", LoadKind::Moment, [0.0, 1.0, 0.0]),
            ("size of the moment", LoadKind::MomentNorm, [0.0; 3]),
        ] {
            for (hinge, point, height) in hinges {
                let (name, load) = (format!("{name} at {height}"), (kind, LoadFrame::World));
                m.joint_load_functional(&name, Over::Terminal, (hinge, door), load, at(direction), point);
            }
        }
        Ok(())
    }
}

#[test]
fn a_door_on_two_hinges_shares_its_weight_and_its_couple() {
    let values = Prepared::new(&Door).unwrap().analysis().forward(&[]).unwrap().values;
    // W = 200 N, b = 0.8 m, h = 2 m: 80 N m = F h + 2 m with F = h m / (2 L2); L of the points (0, 0, 1) and (-0.4, 0, 1) of each hinge
    let (h, couple, square) = (2.0, 80.0, (1.0 + 1.16) / 6.0);
    let m = couple / (h * h / (2.0 * square) + 2.0);
    let f = h * m / (2.0 * square);
    let expected = [-f, f, 100.0, 100.0, -m, -m, m, m];
    for (value, expected) in values.iter().zip(expected) {
        assert!((value - expected).abs() < 1e-10, "{values:?}");
    }
}

#[test]
fn checkpoints_and_chosen_steps_go_through_exchanges_too() {
    let scene = Loop { order: ORDERS[0], end: 2.0, steps: 200 };
    let chosen = scene.settings().choosing_steps(StepControl::new(1e-6));
    for settings in [scene.settings(), chosen] {
        let mut prepared = Prepared::with(&scene, &[10.0, 1.0], Prepared::default_method(), settings).unwrap();
        let gradients = [Keep::Memory, Keep::Checkpoints(500_000)].map(|keep| {
            prepared.keep = keep;
            let analysis = prepared.analysis();
            let forward = analysis.forward(&prepared.x).unwrap();
            assert!(forward.counters.choices > 0, "the test is about exchanges");
            (forward.history.usage(), forward.values.clone(), analysis.adjoint(&prepared.x, &forward).unwrap().rows)
        });
        assert!(gradients[1].0.checkpoints > 0, "the test is about checkpoints");
        assert_eq!(gradients[0].1, gradients[1].1);
        // the same choices are made when steps are computed again; of their numbers the last bits may differ
        for (row, again) in gradients[0].2.iter().zip(&gradients[1].2) {
            assert!(largest_difference(row, again) < 1e-10, "{row:?} {again:?}");
        }
    }
}
