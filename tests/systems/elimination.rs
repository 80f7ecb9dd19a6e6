//! Eliminating a node's own constraints is exact: the unreduced system, with the Euler-parameter norms or the right angles of natural
//! coordinates as ordinary multipliers, gives the same motion and the same gradient, at every constraint level.

use costate::history::Watch;
use costate::integrators::{StepRecord, TimeGrid, tables};
use costate::prelude::*;

/// Two unsymmetric bodies, tumbling on spherical joints, with a spring: everything turns about all axes.
struct Tumbler {
    natural: bool,
}
impl Scene for Tumbler {
    fn name(&self) -> String {
        "tumbler".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("mass", 1.3), ("length", 0.7), ("inertia", 0.2), ("stiffness", 30.0), ("spin", 2.0)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.0, 100.0), ""))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        // few and large steps: at position level round-off enters accelerations as eps / h^2 and adds up from step to step
        Settings::new(0.2, 4)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, length, inertia, stiffness, spin] = x else { return Err("5 variables expected".into()) };
        let ground = m.ground();
        let axis = Vector3::from_f64([0.6, 0.0, 0.8]);
        let middle = axis * *length;
        let omega = Vector3::from_f64([0.3, -0.5, 1.0]) * *spin;
        let products = [0.03, -0.02, 0.05].map(S::from);
        let tensor = [*inertia, *inertia * 1.5, *inertia * 2.0, products[0], products[1], products[2]];
        let turn = Quaternion::about(Vector3::from_f64([0.0, 0.6, 0.8]), S::from(0.4));
        let body = |m: &mut MechanismBuilder<S>, name: &str, place: Vector3<S>, turn: Quaternion<S>| {
            if self.natural { m.natural_body(name, place, turn) } else { m.body(name, place, turn) }
        };
        let first = body(m, "first", middle * S::from(0.5), turn);
        m.rigid_body("first", first, *mass, Vector3::from_f64([0.05, 0.02, -0.03]), tensor);
        m.set_velocity(first, omega.cross(&(middle * S::from(0.5))), omega);
        let second = body(m, "second", middle + Vector3::from_f64([0.2, 0.1, 0.0]), Quaternion::identity());
        m.rigid_body("second", second, *mass * 0.5, Vector3::zeros(), tensor);
        m.set_velocity(second, omega.cross(&middle) - omega.cross(&Vector3::from_f64([-0.2, -0.1, 0.0])), omega);
        m.spherical("pivot", [ground, first], Vector3::zeros());
        m.spherical("knee", [first, second], middle);
        let tip = middle + Vector3::from_f64([0.4, 0.2, 0.1]);
        m.line_spring("spring", [ground, second], [Vector3::from_f64([1.0, 1.0, 1.0]), tip], *stiffness, S::from(0.5));
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        m.target_functional("path", Over::Integral, second, tip, Vector3::zeros());
        m.energy_functional("energy", Over::Terminal);
        let knee = m.spherical("tied", [ground, first], Vector3::zeros());
        m.reaction_functional("force", Over::Integral, knee, &[S::one(), S::zero(), S::zero()]);
        Ok(())
    }
}

#[test]
fn reduced_and_unreduced_systems_agree_forward_and_transposed() {
    assert_reduction_is_exact(&Tumbler { natural: false });
}

#[test]
fn so_they_do_for_six_equations_inside_each_node() {
    assert_reduction_is_exact(&Tumbler { natural: true });
}

fn assert_reduction_is_exact(tumbler: &Tumbler) {
    let x: Vec<f64> = tumbler.variables().iter().map(|variable| variable.initial).collect();
    // the joint "tied" doubles the pivot, so that dropped equations are part of the comparison
    let settings = tumbler.settings().dropping_redundant();
    for table in tables() {
        for level in ConstraintLevel::ALL {
            let mut method = Method::new(table.clone(), level);
            let place = format!("{}, {}", table.name, level.name());
            let mut results = Vec::new();
            for unreduced in [false, true] {
                method.unreduced = unreduced;
                let scene = Prepared::with(tumbler, &x, method.clone(), settings.clone()).expect(&place);
                let analysis = scene.analysis();
                let mut last = None;
                let mut watch = Watch(|step: &StepRecord<f64>| {
                    last = Some(step.clone());
                    true
                });
                let (forward, stopped) = analysis.observed(&x, &mut watch).expect(&place);
                assert_eq!(stopped, None, "{place}");
                let gradient = analysis.adjoint(&x, &forward).expect(&place);
                results.push((last.expect("4 steps"), forward.values, gradient.rows));
            }
            let [(a, values_a, rows_a), (b, values_b, rows_b)] = &results[..] else { unreachable!() };
            // both round every constraint; with coordinates kept on it, velocities hand that on divided by the step
            let grid = TimeGrid::uniform(settings.end, settings.steps, &[]).expect("a grid");
            let of_velocities = table.round_off(level, &grid, 2.0 * f64::EPSILON).velocity.max(1e-12);
            let rows = rows_a.iter().zip(rows_b).map(|(a, b)| (a, b, 1e-12));
            for (reduced, full, limit) in
                [(&a.q, &b.q, 1e-12), (&a.v, &b.v, of_velocities), (values_a, values_b, 1e-12)].into_iter().chain(rows)
            {
                let difference = largest_difference(full, reduced);
                assert!(difference < limit, "{place}: {difference:e}\n{full:?}\n{reduced:?}");
            }
        }
    }
}
