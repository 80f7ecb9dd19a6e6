//! Formulas that pass from one piece to another on the way, and formulas that look at numbers.

use costate::integrators::{Crossing, SwitchKind};
use costate::prelude::*;
use costate::scalar::Curve;
use costate::scenes::built_in;
use std::sync::Arc;

/// m a + f(q) = 0 with one of several laws f.
#[derive(Clone, Debug, PartialEq, Hash)]
enum Law {
    Wrapped,
    Sign,
    Floor,
    Length,
    OneSided,
    Curve(Arc<Curve>),
    SineOfAngle,
    WithoutTurns,
    Series,
    FreeLength,
    Equal,
    IsZero,
    IsConstant,
    Text,
}

impl Law {
    fn force<S: Scalar>(&self, q: S) -> S {
        let (sin, cos) = q.sin_cos();
        let wrapped = sin.atan2(cos);
        let length = Vector3::new(q, S::zero(), S::zero()).length();
        let looked = |is: bool| if is { q * 3.0 } else { q };
        match self {
            Law::Wrapped => wrapped * 9.0,
            Law::Sign => q.sign() * 4.0,
            Law::Floor => q.floor() + 2.0,
            Law::Length => (length - 0.2) * 9.0 * q / length,
            Law::OneSided => q.max(S::zero()) * 9.0,
            Law::Curve(curve) => q.on_curve(curve, 0),
            Law::SineOfAngle => wrapped.sin() * 9.0,
            Law::WithoutTurns => {
                let beyond = wrapped - 1.0;
                beyond - (beyond / std::f64::consts::TAU + 0.5).floor() * std::f64::consts::TAU
            }
            Law::Series => q.abs().less(S::from(1e-3)).select(q - q * q * q / 6.0, sin),
            Law::FreeLength => length * 9.0 * q / length,
            Law::Equal => looked(q == S::one()),
            Law::IsZero => looked(q.is_zero()),
            Law::IsConstant => looked(q.is_constant()),
            Law::Text => looked(format!("{q:?}").starts_with('1')),
        }
    }
}

impl Element for Law {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[0] += p[0] * s.a[0] + self.force(s.q[0]);
    }
}

/// A mass that starts at a place with a velocity.
struct Mass(Law, f64);

impl Scene for Mass {
    fn name(&self) -> String {
        "mass".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("velocity", self.1, (-100.0, 100.0), "m/s")]
    }
    fn settings(&self) -> Settings {
        Settings { locate: false, ..Settings::new(1.0, 100) }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.coordinates("mass", &[S::from(-0.5)], &[x[0]]);
        m.element("law", &[node], self.0.clone(), &[S::one()]);
        m.coordinate_functional("end", Over::Terminal, node, 0);
        Ok(())
    }
}

fn crossings(law: &Law, velocity: f64) -> Vec<Crossing> {
    let scene = Mass(law.clone(), velocity);
    let prepared = Prepared::new(&scene).expect("sound");
    prepared.analysis().forward(&prepared.x).expect("runs").crossings
}

fn table(interpolant: Interpolant) -> Law {
    Law::Curve(Curve::new(&[-2.0, 0.003, 2.0], &[-3.0, 0.1, 1.0], interpolant).expect("sound"))
}

#[test]
fn jumps_and_kinks_are_told_by_part_and_time() {
    use SwitchKind::{Jump, Kink};
    let cases = [
        (Law::Wrapped, 12.0, Jump),
        (Law::Sign, 2.0, Jump),
        (Law::Floor, 2.0, Jump),
        (Law::Length, 2.0, Jump),
        (Law::OneSided, 2.0, Kink),
        (table(Interpolant::Lines), 2.0, Kink),
        (table(Interpolant::Steps), 2.0, Jump),
    ];
    for (law, velocity, kind) in cases {
        let found = crossings(&law, velocity);
        assert!(!found.is_empty(), "{law:?} is not told");
        assert_eq!((found[0].part.as_str(), found[0].kind), ("law", kind), "{law:?}: {found:?}");
    }
    // without force the mass is at 0 after 0.2475 s: in step 25
    let found = crossings(&Law::OneSided, 2.02);
    assert_eq!((found[0].step, found[0].count), (25, 1), "{found:?}");
    assert!(found[0].t > 0.2475 && found[0].t <= 0.25 + 1e-12, "{found:?}");
}

#[test]
fn what_goes_on_smoothly_is_not_told() {
    let smooth = [
        (Law::SineOfAngle, 12.0),
        (Law::WithoutTurns, 4.0),
        (Law::Series, 2.0),
        (Law::FreeLength, 2.0),
        (table(Interpolant::Smooth), 2.0),
        (table(Interpolant::Monotone), 2.0),
        // on one side
        (Law::OneSided, -2.0),
        (Law::Wrapped, 0.5),
    ];
    for (law, velocity) in smooth {
        let found = crossings(&law, velocity);
        assert!(found.is_empty(), "{law:?}: {found:?}");
    }
}

#[test]
fn drives_through_half_a_turn_do_not_jump() {
    for name in ["universal-shaft", "flexible-four-bar"] {
        let prepared = Prepared::new(built_in::named(name).expect("built in")).expect("sound");
        let found = prepared.analysis().forward(&prepared.x).expect("runs").crossings;
        assert!(found.is_empty(), "{name}: {found:?}");
    }
}

#[test]
fn a_formula_that_looks_at_a_number_is_refused_by_the_name_of_its_part() {
    for law in [Law::Equal, Law::IsZero, Law::IsConstant, Law::Text] {
        let scene = Mass(law.clone(), 1.0);
        let refused = Prepared::new(&scene).map(|_| ()).expect_err("refused").to_string();
        assert!(refused.contains("\"law\"") && refused.contains("looks at the value of a number"), "{law:?}: {refused}");
    }
}

/// A mass whose numbers follow a variable, or its value.
#[derive(Clone, Copy, Debug)]
enum Way {
    Variable,
    Branch,
    Mass,
    Place,
    HalfOfTheVelocity,
}

impl Scene for Way {
    fn name(&self) -> String {
        "mass".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("x", 0.7, (0.1, 2.0), "-"), DesignVariable::new("y", 0.0, (-1.0, 1.0), "-")]
    }
    fn settings(&self) -> Settings {
        Settings { locate: false, ..Settings::new(1.0, 20) }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let known = S::from(x[0].value());
        let [mass, place, velocity] = match self {
            Way::Variable => [x[0], x[0] * x[0] - x[0].powi(3), x[0] + x[1]],
            Way::Branch if x[0].value() > 0.5 => [x[0], x[0].sqrt() - x[1], S::one()],
            Way::Branch => [S::one(); 3],
            Way::Mass => [known, x[0], x[1]],
            Way::Place => [x[0], known * 1e-6, x[1]],
            Way::HalfOfTheVelocity => [x[0], x[1], (x[0] + known) * 0.5],
        };
        let node = m.coordinates("mass", &[place], &[velocity]);
        m.element("law", &[node], Law::OneSided, &[mass]);
        m.coordinate_functional("end", Over::Terminal, node, 0);
        Ok(())
    }
}

#[test]
fn a_scene_that_goes_through_the_value_of_a_variable_has_no_gradient() {
    for (way, named) in [
        (Way::Variable, None),
        (Way::Branch, None),
        (Way::Mass, Some("parameter 1 of \"law\"")),
        (Way::Place, Some("initial coordinate 1 of \"mass\"")),
        (Way::HalfOfTheVelocity, Some("initial velocity 1 of \"mass\"")),
    ] {
        let prepared = Prepared::new(&way).expect("sound");
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x).expect("runs");
        let ends = [
            analysis.adjoint(x, &forward).map(|_| ()),
            analysis.tangent(x, &forward).map(|_| ()),
            analysis.complex_step(x, &forward).map(|_| ()),
            analysis.tangent_over_time(x, &forward).map(|_| ()),
        ];
        for end in ends {
            match (end, named) {
                (Ok(()), None) => {}
                (Err(error), Some(name)) => {
                    let text = error.to_string();
                    assert!(text.contains(name) && text.contains("Scalar::value"), "{text}");
                }
                (end, _) => panic!("{way:?}: {end:?}"),
            }
        }
    }
}

/// What is measured of a mass: one at a place beyond 0 and zero before it, the size of the place, or its square.
#[derive(Clone, Copy, Debug, PartialEq, Hash)]
enum Seen {
    Beyond,
    Size,
    Square,
    OfElement,
}

impl Quantity for Seen {
    fn dofs(&self) -> usize {
        1
    }
    fn unit(&self) -> &'static str {
        "-"
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        match self {
            Seen::Beyond | Seen::OfElement => S::zero().less(s.q[0]),
            Seen::Size => s.q[0].abs(),
            Seen::Square => s.q[0] * s.q[0],
        }
    }
}

impl PointQuantity for Seen {
    type Element = Law;
    const NAME: &'static str = "whether a mass is beyond 0";
    fn at_points<S: Scalar>(&self, _of: &Law, s: State<S>, _p: PointParameters<S>, t: S) -> Vec<PointValue<S>> {
        vec![PointValue { value: Quantity::value(self, s, &[], &[], t), weight: S::one() }]
    }
}

/// A free mass that passes 0, and what is measured of it.
struct Watched(Seen, Over);

impl Scene for Watched {
    fn name(&self) -> String {
        "mass".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("velocity", 2.02, (0.0, 100.0), "m/s")]
    }
    fn settings(&self) -> Settings {
        Settings { locate: false, ..Settings::new(1.0, 100) }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.coordinates("mass", &[S::from(-0.5)], &[x[0]]);
        let element = m.element("law", &[node], Law::SineOfAngle, &[S::from(1e9)]);
        match self.0 {
            Seen::OfElement => {
                let group = ElementGroup::new("mass", [element]);
                m.group_functional("seen", "-", self.1, &group, self.0, &[]);
            }
            _ => m.functional("seen", self.1, (&[node], &[]), self.0, &[]),
        }
        Ok(())
    }
}

#[test]
fn a_functional_that_jumps_is_told_where_it_reads_the_whole_run() {
    use SwitchKind::{Jump, Kink};
    let largest = Over::smooth_maximum(3.0);
    for (seen, over, told) in [
        (Seen::Beyond, Over::Integral, Some(Jump)),
        (Seen::OfElement, Over::Integral, Some(Jump)),
        (Seen::Beyond, largest, Some(Jump)),
        (Seen::Size, Over::Integral, Some(Kink)),
        (Seen::Size, largest, None),
        (Seen::Square, Over::Integral, None),
        (Seen::Beyond, Over::Terminal, None),
    ] {
        let scene = Watched(seen, over);
        let prepared = Prepared::new(&scene).expect("sound");
        let found = prepared.analysis().forward(&prepared.x).expect("runs").crossings;
        let found: Vec<_> = found.iter().map(|own| (&*own.part, own.is_functional, own.kind, own.step)).collect();
        let expected: Vec<_> = told.into_iter().map(|kind| ("seen", true, kind, 25)).collect();
        assert_eq!(found, expected, "{seen:?} {over:?}");
    }
}
