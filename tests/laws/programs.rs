//! Constraints whose recordings are equal operation by operation, but read other kinds of arguments.

use costate::prelude::*;
use std::sync::Arc;

/// g, or h, is x_left - x_right of x = (v, q, p, t).
#[derive(Clone, Copy, Hash)]
struct Difference {
    coordinates: usize,
    parameters: usize,
    left: usize,
    right: usize,
}

impl Difference {
    fn of<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S) -> S {
        let x = [v, q, p, &[t]].concat();
        x[self.left] - x[self.right]
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        (0..self.parameters).map(|k| Parameter::named(format!("number {k}"), "m")).collect()
    }
}

/// On coordinates.
#[derive(Hash)]
struct Holonomic(Difference);

impl Constraint for Holonomic {
    const EQUATIONS: usize = 1;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(self.0.coordinates)]
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameter_list()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        g[0] = self.0.of(&vec![S::zero(); q.len()], q, p, t);
    }
}

/// On velocities.
#[derive(Hash)]
struct OfRates(Difference);

impl NonholonomicConstraint for OfRates {
    const EQUATIONS: usize = 1;
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(self.0.coordinates)]
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameter_list()
    }
    fn h<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, h: &mut [S]) {
        h[0] = self.0.of(v, q, p, t);
    }
}

/// Unit masses on all coordinates, with a force on each that is its number, counted from 1.
#[derive(Hash)]
struct Pushed(usize);

impl Element for Pushed {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(self.0)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
        for (k, r) in r.iter_mut().enumerate() {
            *r = s.a[k] - (k + 1) as f64;
        }
    }
}

/// Nodes of masses with a constraint each, whose parameters are all the variable.
struct Pairs {
    constraints: Vec<Difference>,
    is_of_rates: bool,
}

const PLACE: f64 = 0.25;

impl Scene for Pairs {
    fn name(&self) -> String {
        "pairs".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("place", PLACE, (0.0, 1.0), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 40)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        for (k, own) in self.constraints.iter().enumerate() {
            // which coordinate stands on a parameter, or moves with its velocity
            let on_parameter = |place: usize| own.right >= 2 * own.coordinates && own.left % own.coordinates == place;
            let held = (0..own.coordinates).map(|place| if on_parameter(place) { x[0] } else { S::zero() });
            let (held, still): (Vec<S>, _) = (held.collect(), vec![S::zero(); own.coordinates]);
            let (q, v) = if self.is_of_rates { (still, held) } else { (held, still) };
            let node = m.coordinates(&format!("masses {k}"), &q, &v);
            m.element(&format!("masses {k}"), &[node], Pushed(own.coordinates), &[]);
            let p = vec![x[0]; own.parameters];
            let name = format!("pair {k}");
            let joint = match self.is_of_rates {
                false => m.constraint(&name, &[node], Holonomic(*own), &p),
                true => m.nonholonomic(&name, &[node], OfRates(*own), &p),
            };
            m.reaction_functional(&format!("reaction {k}"), Over::Terminal, joint, &[S::one()]);
            for place in 0..own.coordinates {
                m.coordinate_functional(&format!("q {k} {place}"), Over::Terminal, node, place);
            }
        }
        Ok(())
    }
}

/// Values of a run by name, and gradients by the adjoint that were compared with differences of whole runs.
fn values(constraints: &[Difference], is_of_rates: bool, method: &str) -> Vec<(String, f64)> {
    let scene = Pairs { constraints: constraints.to_vec(), is_of_rates };
    let settings = Settings { steps: 40, ..Settings::new(1.0, 40).with_method(method) };
    let method = Prepared::method_of(&settings).expect("listed");
    let prepared = Prepared::with(&scene, &[PLACE], method, settings).expect("a sound scene");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&[PLACE]).expect("runs");
    let gradient = analysis.adjoint(&[PLACE], &forward).expect("has a gradient");
    let differences = analysis.central_difference(&[PLACE], &[1.0], 1e-2).expect("runs");
    for (row, difference) in gradient.rows.iter().zip(differences) {
        assert!((row[0] - difference).abs() < 1e-9, "{} {difference}", row[0]);
    }
    prepared.functionals().iter().map(|own| own.name.clone()).zip(forward.values).collect()
}

fn assert_values(found: &[(String, f64)], expected: &[(&str, f64)]) {
    for (name, value) in expected {
        let own = found.iter().find(|own| own.0 == *name).expect("is measured").1;
        assert!((own - value).abs() < 1e-9, "{name}: {own}, not {value}");
    }
}

// recordings of 7 numbers each: (v, q, p, t) are 2 + 2 + 2 + 1 and 3 + 3 + 0 + 1
const ON_A_PARAMETER: Difference = Difference { coordinates: 2, parameters: 2, left: 3, right: 4 };
const ON_EACH_OTHER: Difference = Difference { coordinates: 3, parameters: 0, left: 3, right: 4 };

/// q_1 = p_0 while q_0 falls under 1 N; q_0 = q_1 under 1 N and 2 N together while q_2 falls under 3 N.
const EXPECTED: [[(&str, f64); 3]; 2] =
    [[("q 0 0", 0.5), ("q 0 1", PLACE), ("reaction 0", 2.0)], [("q 1 0", 0.75), ("q 1 1", 0.75), ("q 1 2", 1.5)]];

#[test]
fn constraints_with_equal_recordings_of_unequal_arguments_keep_their_own_programs() {
    for method in ["esdirk4", "bdf2", "variational"] {
        let found = values(&[ON_A_PARAMETER, ON_EACH_OTHER], false, method);
        assert_values(&found, &EXPECTED.concat());
    }
    // the other way round, and in scenes of their own in one process
    let swapped = values(&[ON_EACH_OTHER, ON_A_PARAMETER], false, "esdirk4");
    assert_values(&swapped, &[("q 0 0", 0.75), ("q 0 2", 1.5), ("q 1 0", 0.5), ("q 1 1", PLACE), ("reaction 1", 2.0)]);
    assert_values(&values(&[ON_A_PARAMETER], false, "esdirk4"), &EXPECTED[0]);
    assert_values(&values(&[ON_EACH_OTHER], false, "esdirk4"), &[("q 0 0", 0.75), ("q 0 1", 0.75), ("q 0 2", 1.5)]);
}

#[test]
fn constraints_on_velocities_with_equal_recordings_keep_their_own_programs() {
    // v_1 = p_0 beside v_1 = q_1, which stays at rest: both subtract the fifth number from the second
    let on_parameter = Difference { coordinates: 2, parameters: 2, left: 1, right: 4 };
    let on_coordinate = Difference { coordinates: 3, parameters: 0, left: 1, right: 4 };
    for order in [[on_parameter, on_coordinate], [on_coordinate, on_parameter]] {
        let found = values(&order, true, "esdirk4");
        let place = usize::from(order[0].parameters == 0);
        let [own, other] = [place, 1 - place];
        let name = |k: usize, place: usize| format!("q {k} {place}");
        let expected = [
            (name(own, 0), 0.5),
            (name(own, 1), PLACE),
            (name(other, 0), 0.5),
            (name(other, 1), 0.0),
            (name(other, 2), 1.5),
        ];
        let expected: Vec<(&str, f64)> = expected.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        assert_values(&found, &expected);
    }
}

#[test]
fn a_holonomic_constraint_and_one_on_velocities_with_one_recording_are_two_formulas() {
    use costate::elements::Nonholonomic;
    use costate::internals::ConstraintPhysics;
    // neither reads a velocity: the operations are the same, the reactions are not
    let own = Difference { coordinates: 1, parameters: 1, left: 1, right: 2 };
    let holonomic = ConstraintPhysics::new(Arc::new(Holonomic(own)));
    let of_rates = ConstraintPhysics::new(Arc::new(Nonholonomic(OfRates(own))));
    assert_eq!(holonomic.reaction(&[0.5], &[3.0], &[0.2], 0.0), [3.0]);
    assert_eq!(of_rates.reaction(&[0.5], &[3.0], &[0.2], 0.0), [0.0]);
    assert_eq!(holonomic.rows(&[0.5], &[0.2], 0.0), [1.0]);
    assert_eq!(of_rates.rows(&[0.5], &[0.2], 0.0), [0.0]);
}
