//! Functionals over groups of elements: quantities against closed forms, a user's own, aggregates against their definition, gradients.

use super::assert_close;
use costate::elements::flexible::{Laminate, Material, Ply, PlyStrength, ShellKind};
use costate::functionals::{OfShells, Sample, ShellQuantity};
use costate::internals::{Measured, Shell, VectorsAvq};
use costate::prelude::*;
use costate::scenes::{ShellMember, ShellMesh, built_in};
use std::f64::consts::PI;

const STEEL: Material<f64> = Material { young: 210e9, poisson: 0.3, density: 7850.0 };
const THICKNESS: f64 = 0.01;
const SIZES: [f64; 2] = [0.4, 0.2];

fn rectangle<S: Scalar>(elements: [usize; 2]) -> ShellMesh<S> {
    let [along, across] = SIZES.map(S::from);
    let zero = S::zero();
    ShellMesh::plate(Vector3::zeros(), [Vector3::new(along, zero, zero), Vector3::new(zero, across, zero)], elements)
}

/// What functional `k` measures with every node moved.
fn measured(m: &MechanismBuilder<f64>, k: usize, to: impl Fn(Vector3<f64>) -> (Vector3<f64>, Quaternion<f64>)) -> f64 {
    let node = |q: &[f64]| {
        let (place, turn) = to(Vector3::new(q[0], q[1], q[2]));
        place.iter().copied().chain(turn.times(Quaternion::from_slice(&q[3..])).0).collect::<Vec<f64>>()
    };
    let q: Vec<f64> = m.numbers.q.chunks_exact(7).flat_map(node).collect();
    let mut sample = Sample::empty();
    sample.at = VectorsAvq { a: vec![0.0; q.len()], v: vec![0.0; q.len()], q };
    m.functionals[k].measured_at(&m.model, &sample, &m.numbers.p)
}

fn at_rest(x: Vector3<f64>) -> (Vector3<f64>, Quaternion<f64>) {
    (x, Quaternion::identity())
}

fn stretched(by: f64) -> impl Fn(Vector3<f64>) -> (Vector3<f64>, Quaternion<f64>) {
    move |x| (Vector3::new(x[0] * (1.0 + by), x[1], x[2]), Quaternion::identity())
}

#[test]
fn a_stretched_plate_fails_where_its_stress_is_the_yield_stress() {
    let mut m = MechanismBuilder::default();
    let material = Material { poisson: 0.0, ..STEEL };
    let plate = m.shell("plate", rectangle([2, 1]), &material, THICKNESS);
    let (yield_stress, sharpness) = (300e6, 50.0);
    let sum = Aggregate::new(AggregateKind::SmoothMaximum { normalized: false }, sharpness);
    for aggregate in [Aggregate::smooth_maximum(sharpness), sum, sum.continuous()] {
        let name = format!("{aggregate:?}");
        m.von_mises_functional(&name, aggregate.at(Times::End), &plate.group(), yield_stress);
    }
    m.von_mises_functional("integral", Over::Terminal, &plate.group(), yield_stress);
    let m = m.finish().expect("sound");
    let both_surfaces = 2.0 * SIZES[0] * SIZES[1];
    for stretch in [1e-3, -2e-3] {
        let ratio = (210e9 * stretch * (1.0 + 0.5 * stretch) / yield_stress).abs();
        let own: Vec<f64> = (0..4).map(|k| measured(&m, k, stretched(stretch))).collect();
        assert_close("mean", own[0], ratio, 1e-12);
        // the smooth maximum of 36 equal numbers
        assert_close("sum", own[1], ratio + 36.0_f64.ln() / sharpness, 1e-12);
        assert_close("continuous", own[2], ratio + both_surfaces.ln() / sharpness, 1e-12);
        assert_close("integral", own[3], ratio * both_surfaces, 1e-12);
    }
}

#[test]
fn a_bent_plate_fails_on_its_surfaces() {
    let mut m = MechanismBuilder::default();
    let material = Material { poisson: 0.0, ..STEEL };
    let plate = m.shell("plate", rectangle([4, 1]), &material, THICKNESS);
    m.von_mises_functional("bent", Aggregate::smooth_maximum(1e3).at(Times::End), &plate.group(), 300e6);
    let m = m.finish().expect("sound");
    let curvature = 0.02;
    let circle = |x: Vector3<f64>| {
        let angle = curvature * x[0];
        let place = Vector3::new(angle.sin() / curvature, x[1], (1.0 - angle.cos()) / curvature);
        (place, Quaternion::about(Vector3::new(0.0, 1.0, 0.0), -angle))
    };
    assert_close("failure ratio", measured(&m, 0, circle), 210e9 * 0.5 * THICKNESS * curvature / 300e6, 1e-4);
}

#[test]
fn a_ply_reaches_each_of_its_strengths_alone_at_a_ratio_of_one() {
    let strength = PlyStrength { tension: [1500.0, 40.0], compression: [1200.0, 150.0], shear: 70.0 };
    let single =
        [[1500.0, 0.0, 0.0], [-1200.0, 0.0, 0.0], [0.0, 40.0, 0.0], [0.0, -150.0, 0.0], [0.0, 0.0, 70.0], [0.0, 0.0, -70.0]];
    for stress in single {
        for share in [0.3, 1.0, 2.5] {
            let ratio = strength.failure_ratio(stress.map(|own: f64| own * share));
            assert_close(&format!("{stress:?}"), ratio, share, 1e-13);
        }
    }
    // the criterion itself, where all act together
    let [along, across, between] = [700.0, -90.0, 33.0];
    let ratio = strength.failure_ratio([along, across, between]);
    let [s1, s2, s12] = [along / ratio, across / ratio, between / ratio];
    let [f1, f2] = [1.0 / 1500.0 - 1.0 / 1200.0, 1.0 / 40.0 - 1.0 / 150.0];
    let [f11, f22, f66]: [f64; 3] = [1.0 / (1500.0 * 1200.0), 1.0 / (40.0 * 150.0), 1.0 / (70.0 * 70.0)];
    let criterion = f1 * s1 + f2 * s2 + f11 * s1 * s1 + f22 * s2 * s2 + f66 * s12 * s12 - (f11 * f22).sqrt() * s1 * s2;
    assert_close("criterion", criterion, 1.0, 1e-13);
}

#[test]
fn plies_fail_by_the_stresses_in_their_own_axes() {
    let ply = |angle: f64| Ply {
        thickness: 0.5 * THICKNESS,
        angle,
        young: [140e9, 10e9],
        poisson: 0.0,
        shear: [5e9, 5e9, 3e9],
        density: 1600.0,
    };
    let strength = PlyStrength { tension: [1500e6, 40e6], compression: [1200e6, 150e6], shear: 70e6 };
    let stretch = 1e-2;
    // along the fibres and across them; without lateral contraction each ply has its own stress
    for (angles, expected) in [([0.0, 0.0], 140e9 / 1500e6), ([0.5 * PI; 2], 10e9 / 40e6), ([0.0, 0.5 * PI], 10e9 / 40e6)] {
        let mut m = MechanismBuilder::default();
        let laminate = Laminate::new(angles.map(ply).to_vec());
        let plate = m.laminate_shell("plate", rectangle([2, 1]), &laminate, Vector3::new(1.0, 0.0, 0.0));
        let over = Aggregate::new(AggregateKind::Power, 400.0).at(Times::End);
        m.tsai_wu_functional("failure", over, &plate.group(), &laminate, &[strength; 2]);
        let m = m.finish().expect("sound");
        let strain = stretch * (1.0 + 0.5 * stretch);
        assert_close(&format!("{angles:?}"), measured(&m, 0, stretched(stretch)), expected * strain, 1e-12);
    }
}

#[test]
fn masses_and_moments_of_inertia_of_parts_add_up_and_meet_closed_forms() {
    let mut m = MechanismBuilder::<f64>::default();
    let plate = m.shell("plate", rectangle([4, 2]), &STEEL, THICKNESS);
    let at = Vector3::new(0.3, 0.7, -0.2);
    let body = m.body("body", at, Quaternion::about(Vector3::new(0.0, 0.6, 0.8), 0.4));
    let block = m.rigid_body("body", body, 2.0, Vector3::zeros(), [0.3, 0.3, 0.3, 0.0, 0.0, 0.0]);
    let half = plate.part("half", |[along, _]| along < 2);
    let quarter = plate.part("quarter", |[along, across]| along >= 2 && across == 1);
    let three_quarters = ElementGroup::of_groups("three quarters", [&half, &quarter, &half]);
    let with_body = ElementGroup::new("with the body", plate.elements.iter().copied().chain([block]));
    for group in [&half, &three_quarters, &with_body] {
        m.group_mass_functional(&format!("mass of {}", group.name), Over::Initial, group);
    }
    let (point, axis) = (Vector3::new(0.1, 0.0, 0.0), Vector3::new(0.0, 0.0, 2.0));
    m.inertia_moment_functional("about z", Over::Initial, &plate.group(), point, axis);
    m.inertia_moment_functional("with the body", Over::Initial, &with_body, point, axis);
    m.inertia_moment_functional("about x", Over::Initial, &plate.group(), point, Vector3::new(1.0, 0.0, 0.0));
    m.mass_functional("all", Over::Initial);
    let m = m.finish().expect("sound");
    let whole = 7850.0 * THICKNESS * SIZES[0] * SIZES[1];
    let [half, three_quarters, with_body, about_z, both, about_x, all] = std::array::from_fn(|k| measured(&m, k, at_rest));
    assert_close("half", half, 0.5 * whole, 1e-13);
    assert_close("three quarters", three_quarters, 0.75 * whole, 1e-13);
    assert_close("with the body", with_body, whole + 2.0, 1e-13);
    assert_close("all", all, whole + 2.0, 1e-13);
    let [a, b] = SIZES.map(|size| size * size);
    let expected = whole * ((a + b) / 12.0 + 0.1 * 0.1 + 0.1 * 0.1);
    // the inertia against drilling is none of the material: a thousandth of the rotary one
    assert_close("about z", about_z, expected, 1e-3 * THICKNESS * THICKNESS / a);
    assert_close("with the body", both - about_z, 0.3 + 2.0 * (0.2 * 0.2 + 0.7 * 0.7), 1e-12);
    let rotary = THICKNESS * THICKNESS / 12.0;
    assert_close("about x", about_x, whole * (b / 3.0 + rotary), 1e-6);
}

/// The largest principal strain of a shell's reference surface: what a user may write.
#[derive(Hash)]
struct PrincipalStrain;

impl ShellQuantity for PrincipalStrain {
    const NAME: &'static str = "the principal strain of a shell";
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("allowed strain", "-")];

    fn at_points<S: Scalar>(&self, shell: ShellKind, s: State<S>, p: PointParameters<S>, _t: S) -> Vec<PointValue<S>> {
        let points = shell.points(s.q, p.element);
        let value = |[along, across, twice]: [S; 3]| {
            let (mean, half, shear) = ((along + across) * 0.5, (along - across) * 0.5, twice * 0.5);
            (mean + (half * half + shear * shear).sqrt()) / p.own[0]
        };
        points.iter().map(|point| PointValue { value: value(point.strain), weight: point.area }).collect()
    }
}

/// A quantity that looks at a value.
#[derive(Hash)]
struct Branching;

impl PointQuantity for Branching {
    type Element = Shell;
    const NAME: &'static str = "a branch";

    fn at_points<S: Scalar>(&self, shell: &Shell, s: State<S>, p: PointParameters<S>, _t: S) -> Vec<PointValue<S>> {
        let points = shell.points(s.q, p.element);
        let value = |strain: S| if strain.value() > 0.0 { strain } else { S::zero() };
        points.iter().map(|point| PointValue { value: value(point.strain[0]), weight: point.area }).collect()
    }
}

/// A plate that falls from a hinge with functionals of its own.
struct Falling<F>(F);

type Plate<'m, S> = (&'m mut MechanismBuilder<S>, &'m ShellMember, S);

trait Measures: Sync {
    fn add<S: Scalar>(&self, plate: Plate<S>);
}

impl<F: Measures> Scene for Falling<F> {
    fn name(&self) -> String {
        "falling".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let variable = |name: &str, value: f64| DesignVariable::new(name, value, (0.5 * value, 2.0 * value), "");
        vec![variable("thickness", THICKNESS), variable("young", 2e9), variable("allowed", 0.01)]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.01, 10)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let material = Material { young: x[1], poisson: S::from(0.3), density: S::from(1200.0) };
        let plate = m.shell("plate", rectangle([2, 1]), &material, x[0]);
        let ground = m.ground();
        for node in [plate.node(0, 0), plate.node(0, 1), plate.node(0, 2)] {
            let at = m.position(node);
            m.revolute(&format!("hinge {}", at[1].value()), [ground, node], at, Vector3::from_f64([0.0, 1.0, 0.0]));
        }
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        self.0.add((m, &plate, x[2]));
        Ok(())
    }
}

/// Aggregates of a user's quantity over all kinds, points and times.
struct OfAllKinds;

impl Measures for OfAllKinds {
    fn add<S: Scalar>(&self, (m, plate, allowed): Plate<S>) {
        for kind in Aggregate::KINDS {
            let discrete = Aggregate::new(kind, if kind == AggregateKind::Exponential { 50.0 } else { 8.0 });
            // a bound from above counts each point as one
            let ways =
                if kind == AggregateKind::UpperMaximum { vec![discrete] } else { vec![discrete, discrete.continuous()] };
            for aggregate in ways {
                for times in [Times::Start, Times::End, Times::Run] {
                    // nothing is strained at the start
                    if times != Times::Start || !kind.is_power() && !kind.is_squared() {
                        let name = format!("{aggregate:?} {times:?}");
                        m.group_functional(
                            &name,
                            "-",
                            aggregate.at(times),
                            &plate.group(),
                            OfShells(PrincipalStrain),
                            &[allowed],
                        );
                    }
                }
            }
        }
        m.strain_energy_functional("strain energy", Over::Integral, &plate.group());
        let (point, axis) = (Vector3::zeros(), Vector3::from_f64([0.3, 0.4, 0.5]));
        m.inertia_moment_functional("moment of inertia", Over::Terminal, &plate.group(), point, axis);
    }
}

#[test]
fn a_users_quantity_has_exact_gradients_in_every_aggregate() {
    let scene = Falling(OfAllKinds);
    for method in ["dirk2", "esdirk4", "bdf2"] {
        let table = table_by_name(method).expect("known");
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        let method_of = Method::new(table, ConstraintLevel::default());
        let prepared = Prepared::with(&scene, &x, method_of, scene.settings()).expect("sound");
        let analysis = prepared.analysis();
        let forward = analysis.forward(&x).expect("runs");
        let adjoint = analysis.adjoint(&x, &forward).expect("a gradient");
        let complex = analysis.complex_step(&x, &forward).expect("a gradient");
        for (k, functional) in prepared.functionals().iter().enumerate() {
            let scaled = |row: &[f64]| -> Vec<f64> { row.iter().zip(&x).map(|(own, x)| own * x).collect() };
            let difference = largest_difference(&scaled(&complex.rows[k]), &scaled(&adjoint.rows[k]));
            let name = &functional.name;
            assert!(forward.values[k].is_finite() && difference <= 1e-11, "{method}, {name}: {difference:.1e}");
        }
    }
}

#[test]
fn derivatives_by_parameters_are_those_of_variables_that_would_touch_them() {
    // of five elements, all with variables of their own, or four with numbers that no variable touches
    let scene = |thicknesses: &str| {
        let changes = format!("shell.plate.thickness = [{thicknesses}]\nsettings = {{ end = 0.01, steps = 10 }}");
        built_in::changed("plate-pendulum", &changes).expect("sound")
    };
    let (touched, untouched) = ("'t1', 't2', 't3', 't4', 't5'", "'t1', 0.01, 0.01, 0.01, 0.01");
    let of = |thicknesses: &str| {
        let scene = scene(thicknesses);
        let prepared = Prepared::new(&scene).expect("sound");
        let (analysis, x) = (prepared.analysis(), &prepared.x);
        let forward = analysis.forward(x).expect("runs");
        let surfaces = prepared.mechanism.surfaces();
        let mut asked = vec![false; prepared.model().parameters];
        let places: Vec<_> = surfaces.iter().map(|own| own.thicknesses().expect("isotropic")).collect();
        places.iter().for_each(|own| asked[own.clone()].fill(true));
        let (gradient, by_parameters) = analysis.adjoint_by_parameters(x, &forward, &asked).expect("a gradient");
        let alone = analysis.adjoint(x, &forward).expect("a gradient");
        let pairs = gradient.rows.iter().zip(&alone.rows);
        assert!(pairs.clone().all(|(own, alone)| largest_difference(own, alone) < 1e-12));
        let sums: Vec<Vec<f64>> = by_parameters
            .iter()
            .map(|row| {
                assert!(row.iter().zip(&asked).all(|(own, asked)| *asked || *own == 0.0));
                places.iter().map(|own| row[own.clone()].iter().sum()).collect()
            })
            .collect();
        let few = analysis.adjoint_by_parameters(x, &forward, &asked[1..]);
        assert!(few.expect_err("refused").to_string().contains("parameters, but"));
        (gradient.rows, sums, analysis.complex_step(x, &forward).expect("a gradient").rows)
    };
    let (rows, by_elements, complex) = of(touched);
    let (row, of_untouched, _) = of(untouched);
    for k in 0..rows.len() {
        for (what, own) in [("touched", &by_elements), ("untouched", &of_untouched)] {
            let difference = largest_difference(&complex[k], &own[k]);
            println!("functional {k}, {what}: {difference:.1e} from complex steps");
            assert!(difference < 1e-11, "functional {k}, {what}: {difference:.1e}");
        }
        assert!(largest_difference(&rows[k][..1], &row[k][..1]) < 1e-11);
    }
}

#[test]
fn each_element_of_a_group_has_the_value_of_its_largest_point() {
    let mut m = MechanismBuilder::<f64>::default();
    let plate = m.shell("plate", rectangle([2, 1]), &STEEL, THICKNESS);
    let over = Aggregate::smooth_maximum(1e4).at(Times::End);
    m.group_functional("strain", "-", over, &plate.group(), OfShells(PrincipalStrain), &[1e-3]);
    let m = m.finish().expect("sound");
    let Measured::Group(group) = &m.functionals[0].measured else { unreachable!() };
    // the second element is pulled, the first one is not
    let mut q = m.numbers.q.clone();
    let far = m.model.node(plate.node(4, 0)).dofs.start;
    q[far] += 1e-4;
    let at = VectorsAvq { a: vec![0.0; q.len()], v: vec![0.0; q.len()], q };
    let values = |at: VectorsAvq<f64>| group.element_values(&m.model, &Sample { at, ..Sample::empty() }, &m.numbers.p);
    let found = values(at.clone());
    assert_eq!(found.iter().map(|(element, _)| *element).collect::<Vec<_>>(), plate.elements);
    assert!(found[0].1.abs() < 1e-12 && found[1].1 > 1e-2, "{found:?}");
    let mut broken = at;
    broken.q[far] = f64::NAN;
    assert!(values(broken)[1].1.is_nan());
}

#[test]
fn elements_without_the_quantity_are_skipped() {
    let mut m = MechanismBuilder::<f64>::default();
    let plate = m.shell("plate", rectangle([2, 1]), &STEEL, THICKNESS);
    let body = m.body("body", Vector3::new(1.0, 0.0, 0.0), Quaternion::identity());
    m.rigid_body("body", body, 2.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let over = Aggregate::smooth_maximum(1e4).at(Times::End);
    for group in [plate.group(), m.all_elements()] {
        m.group_functional(&group.name, "-", over, &group, OfShells(PrincipalStrain), &[1e-3]);
    }
    let m = m.finish().expect("sound");
    let own = [0, 1].map(|k| measured(&m, k, stretched(1e-3)));
    assert_close("principal strain", own[0], 1.0005, 1e-12);
    assert_eq!(own[0], own[1]);
}

#[test]
fn mistakes_name_the_group_and_the_quantity() {
    let refused = |build: &dyn Fn(&mut MechanismBuilder<f64>)| {
        let mut m = MechanismBuilder::default();
        build(&mut m);
        m.finish().err().expect("refused")
    };
    let plies = || Laminate::new(vec![Ply::isotropic(&STEEL, THICKNESS)]);
    let layered = refused(&|m| {
        let plate = m.laminate_shell("wing", rectangle([1, 1]), &plies(), Vector3::new(1.0, 0.0, 0.0));
        m.von_mises_functional("failure", Over::smooth_maximum(10.0), &plate.group(), 1.0);
    });
    let says = |message: &str, words: &[&str]| assert!(words.iter().all(|word| message.contains(word)), "{message}");
    says(&layered, &["\"failure\"", "\"wing\"", "the von Mises stress of a shell of one material"]);
    let strengths = refused(&|m| {
        let plate = m.laminate_shell("wing", rectangle([1, 1]), &plies(), Vector3::new(1.0, 0.0, 0.0));
        m.tsai_wu_functional("failure", Over::smooth_maximum(10.0), &plate.group(), &plies(), &[]);
    });
    says(&strengths, &["1 plies, but strengths of 0"]);
    let soft = refused(&|m| {
        let plate = m.shell("plate", rectangle([1, 1]), &STEEL, THICKNESS);
        let over = Aggregate::new(AggregateKind::Power, 1.0).at(Times::Run);
        m.von_mises_functional("failure", over, &plate.group(), 1.0);
    });
    says(&soft, &["\"failure\" has a sharpness of 1; it must be at least 2"]);
    let sharp = refused(&|m| {
        let plate = m.shell("plate", rectangle([1, 1]), &STEEL, THICKNESS);
        let (point, axis) = (Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0));
        m.position_functional("place", Over::smooth_maximum(-3.0), plate.node(0, 0), point, axis);
    });
    says(&sharp, &["a sharpness of -3; it must be greater than 0"]);
    let stranger = refused(&|m| {
        let plate = MechanismBuilder::<f64>::default().shell("plate", rectangle([1, 1]), &STEEL, THICKNESS);
        m.von_mises_functional("failure", Over::smooth_maximum(10.0), &plate.group(), 1.0);
    });
    says(&stranger, &["failure", "an element"]);
}

/// A quantity that cannot be recorded.
struct OfABranch;

impl Measures for OfABranch {
    fn add<S: Scalar>(&self, (m, plate, _): Plate<S>) {
        m.group_functional("branching", "-", Over::Terminal, &plate.group(), Branching, &[]);
    }
}

#[test]
fn a_quantity_that_branches_on_a_value_is_refused_by_name() {
    let scene = Falling(OfABranch);
    let why = Prepared::new(&scene).err().expect("refused").to_string();
    assert!(why.contains("\"branching\"") && why.contains("looks at the value"), "{why}");
}

#[test]
fn multipliers_between_axes_are_moments_and_others_count_as_forces() {
    let mut m = MechanismBuilder::<f64>::default();
    let (ground, one) = (m.ground(), Quaternion::identity());
    let body = m.body("body", Vector3::new(1.0, 0.0, 0.0), one);
    m.rigid_body("body", body, 1.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let axis = Vector3::new(0.0, 0.6, 0.8);
    let hinge = m.revolute("hinge", [ground, body], Vector3::zeros(), axis);
    let angle = m.joint_angle("angle", [ground, body], axis);
    let wheel = m.coordinates("wheel", &[0.0], &[0.0]);
    let gear = m.gear("gear", [angle, wheel], [1.0, 2.0]);
    for (joint, weights, unit) in [
        (hinge, [1.0, 0.0, 0.0, 0.0, 0.0].as_slice(), "N"),
        (hinge, &[0.0, 0.0, 0.0, 1.0, -2.0], "N m"),
        (hinge, &[0.0, 0.0, 1.0, 1.0, 0.0], "N"),
        (gear, &[1.0], "N"),
    ] {
        m.reaction_functional(&format!("{unit}{weights:?}"), Over::Terminal, joint, weights);
        assert_eq!(m.functionals.last().unwrap().unit, unit, "{weights:?}");
    }
}

#[test]
#[should_panic(expected = "measured in one model is measured in another one")]
fn an_energy_of_one_model_is_not_taken_for_that_of_another() {
    let bodies = |count: usize| {
        let mut m = MechanismBuilder::<f64>::default();
        for index in 0..count {
            let body = m.body(&format!("body {index}"), Vector3::zeros(), Quaternion::identity());
            m.rigid_body(&format!("body {index}"), body, 2.0, Vector3::zeros(), [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        }
        m
    };
    let energy = Measured::energy();
    let of = |m: &MechanismBuilder<f64>| {
        let mut sample = Sample::empty();
        sample.at = VectorsAvq { a: Vec::new(), v: vec![1.0; m.numbers.v.len()], q: m.numbers.q.clone() };
        energy.value(&m.model, &sample, &m.numbers.p)
    };
    let one = bodies(1);
    assert!(of(&one) > 0.0 && of(&one) == of(&one));
    of(&bodies(2));
}

/// Coordinates with a mass: one alone and then two, or two and then one.
#[derive(Hash)]
struct Ballast {
    one_first: bool,
}

impl Element for Ballast {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg")];
    fn nodes(&self) -> Vec<NodeKind> {
        let [first, second] = if self.one_first { [1, 2] } else { [2, 1] };
        vec![NodeKind::Coordinates(first), NodeKind::Coordinates(second)]
    }
    fn kinetic<S: Scalar>(&self, v: &[S], _q: &[S], p: &[S]) -> S {
        p[0] * 0.5 * (v[0] * v[0] + v[1] * v[1] * 2.0 + v[2] * v[2] * 3.0)
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0]
    }
}

#[test]
fn elements_of_unlike_nodes_with_equal_recordings_are_measured_each_at_its_own() {
    let mut m = MechanismBuilder::<f64>::default();
    let mut expected = [0.0; 2];
    for k in 0..12 {
        let (one_first, mass, speed) = (k % 2 == 0, 1.0 + 0.1 * f64::from(k), f64::from(k + 1));
        let one = m.coordinates(&format!("one {k}"), &[0.0], &[speed]);
        let two = m.coordinates(&format!("two {k}"), &[0.0; 2], &[-0.5 * speed, 2.0 * speed]);
        let nodes = if one_first { [one, two] } else { [two, one] };
        m.element(&format!("ballast {k}"), &nodes, Ballast { one_first }, &[mass]);
        let v = if one_first { [1.0, -0.5, 2.0] } else { [-0.5, 2.0, 1.0] }.map(|v| v * speed);
        expected[0] += mass;
        expected[1] += 0.5 * mass * (v[0] * v[0] + 2.0 * v[1] * v[1] + 3.0 * v[2] * v[2]);
    }
    m.mass_functional("mass", Over::Initial);
    m.energy_functional("energy", Over::Initial);
    let m = m.finish().expect("sound");
    let at = VectorsAvq { a: vec![0.0; m.model.dofs], v: m.numbers.v.clone(), q: m.numbers.q.clone() };
    let sample = Sample { at, ..Sample::empty() };
    for (functional, expected) in m.functionals.iter().zip(expected) {
        let value = functional.measured.value(&m.model, &sample, &m.numbers.p);
        assert!((value / expected - 1.0).abs() < 1e-14, "{}: {value} and not {expected}", functional.name);
    }
}
