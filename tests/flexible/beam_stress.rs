//! Von Mises stresses and section forces over beams and cables against closed forms, their gradients, and what is refused.

use super::assert_close;
use costate::elements::flexible::Shape;
use costate::internals::{AppliedForce, AppliedTorque, STRAINS};
use costate::prelude::*;
use costate::scenes::{BeamLine, BeamMember, CableLine, Edge, ShellMesh};
use costate::sensitivity::largest_difference;
use std::f64::consts::PI;

/// A shape of a beam's section, by its sizes [m].
#[derive(Clone, Copy)]
enum Of {
    Rectangle([f64; 2]),
    Box([f64; 3]),
    Circle(f64),
    Tube([f64; 2]),
}

/// A clamped bar under a dead load at the centroid of its tip.
struct Bar {
    of: Of,
    length: f64,
    offset: Option<[f64; 2]>,
    force: [f64; 3],
    moment: [f64; 3],
}

const YOUNG: f64 = 210e9;
const POISSON: f64 = 0.3;
/// So sharp that an upper maximum is the maximum to nine digits.
const SHARP: f64 = 1e9;

impl Bar {
    fn long(of: Of, force: [f64; 3], moment: [f64; 3]) -> Self {
        Bar { of, length: 1.0, offset: None, force, moment }
    }

    fn beam<S: Scalar>(&self, m: &mut MechanismBuilder<S>) -> BeamMember {
        let number = |value: f64| S::from(value);
        let material = Material { young: number(YOUNG), poisson: number(POISSON), density: number(7850.0) };
        let poisson = material.poisson;
        let shape = match self.of {
            Of::Rectangle([b, h]) => Shape::rectangle(number(b), number(h), poisson),
            Of::Box([b, h, t]) => Shape::box_section(number(b), number(h), number(t), poisson),
            Of::Circle(d) => Shape::circle(number(d), poisson),
            Of::Tube([d, t]) => Shape::tube(number(d), number(t), poisson),
        };
        let mut section = Section::of(material, shape);
        if let Some(offset) = self.offset {
            section = section.offset(offset.map(number));
        }
        let tip = Vector3::from_f64([self.length, 0.0, 0.0]);
        let line = BeamLine::straight([Vector3::zeros(), tip], 3, Vector3::from_f64([0.0, 1.0, 0.0])).clamped_start();
        let beam = m.beam("bar", line, &section);
        let [o2, o3] = self.offset.unwrap_or_default();
        let place = m.local_point(beam.end(), tip + Vector3::from_f64([0.0, o2, o3]));
        let p = [&self.force.map(number)[..], &place.components(), &[number(1.0)]].concat();
        let force = AppliedForce { on: NodeKind::Body, frame: LoadFrame::World, size: TimeFunction::Constant };
        m.element("force", &[beam.end()], force, &p);
        let moment = AppliedTorque { on: NodeKind::Body, frame: LoadFrame::World, size: TimeFunction::Constant };
        m.element("moment", &[beam.end()], moment, &[&self.moment.map(number)[..], &[number(1.0)]].concat());
        beam
    }
}

/// The largest von Mises stress of a bar, and over its length each section force: the largest, and its integral.
impl Scene for Bar {
    fn name(&self) -> String {
        "bar".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let group = self.beam(m).group();
        let largest = Aggregate::upper_maximum(SHARP).at(Times::End);
        m.von_mises_functional("stress by 1 MPa", largest, &group, S::from(1e6));
        for component in 0..STRAINS {
            m.section_forces_functional(&format!("largest {component}"), largest, &group, component);
            m.section_forces_functional(&format!("integral {component}"), Over::Terminal, &group, component);
        }
        Ok(())
    }
}

fn values(bar: &Bar) -> Vec<f64> {
    let prepared = Prepared::new(bar).expect("a sound scene");
    prepared.analysis().values(&[]).expect("it runs")
}

/// Largest von Mises stress [N/m2].
fn stress(bar: &Bar) -> f64 {
    values(bar)[0] * 1e6
}

/// Slopes at the tip are about 1e-3 rad: loads and arms change by their squares.
const SMALL: f64 = 3e-6;

#[test]
fn the_largest_stress_of_a_bent_cantilever_is_its_moment_by_its_modulus() {
    let (b, h, force) = (0.02, 0.05, 100.0);
    let [w2, w3] = [b * h * h / 6.0, h * b * b / 6.0];
    let rectangle = |force, moment| stress(&Bar::long(Of::Rectangle([b, h]), force, moment));
    assert_close("tip force", rectangle([0.0, 0.0, force], [0.0; 3]), force / w2, SMALL);
    assert_close("pure bending", rectangle([0.0; 3], [0.0, 0.0, 20.0]), 20.0 / w3, SMALL);
    assert_close("tension", rectangle([5e4, 0.0, 0.0], [0.0; 3]), 5e4 / (b * h), SMALL);
    let oblique = rectangle([0.0, 10.0, force], [0.0; 3]);
    assert_close("both axes", oblique, force / w2 + 10.0 / w3, 1e-4);
    let (d, t): (f64, f64) = (0.05, 0.004);
    let tube = PI * (d.powi(4) - (d - 2.0 * t).powi(4)) / (32.0 * d);
    assert_close("tube", stress(&Bar::long(Of::Tube([d, t]), [0.0, force, 0.0], [0.0; 3])), force / tube, SMALL);
    let hollow = (b * h.powi(3) - 0.016 * 0.046_f64.powi(3)) / (6.0 * h);
    let bent = stress(&Bar::long(Of::Box([b, h, 0.002]), [0.0; 3], [0.0, 50.0, 0.0]));
    assert_close("box", bent, 50.0 / hollow, SMALL);
}

#[test]
fn torsion_has_the_stress_of_saint_venant_and_of_bredt() {
    let twisted = |of, torque: f64| stress(&Bar::long(of, [0.0; 3], [torque, 0.0, 0.0])) / (3.0_f64.sqrt() * torque);
    let d = 0.04_f64;
    assert_close("round bar", twisted(Of::Circle(d), 50.0), 16.0 / (PI * d.powi(3)), 1e-7);
    let polar = PI / 32.0 * (d.powi(4) - 0.03_f64.powi(4));
    assert_close("tube", twisted(Of::Tube([d, 0.005]), 50.0), 0.5 * d / polar, 1e-7);
    let [b, h, t] = [0.03, 0.06, 0.002];
    assert_close("box", twisted(Of::Box([b, h, t]), 50.0), 1.0 / (2.0 * (b - t) * (h - t) * t), 1e-7);
    // tau = M1 / (k2 a b^2), a the longer side: Timoshenko & Goodier, section 109, three digits
    for (ratio, k2) in [(1.0, 0.208), (1.5, 0.231), (2.0, 0.246), (4.0, 0.282)] {
        for sides in [[b, ratio * b], [ratio * b, b]] {
            assert_close("rectangle", twisted(Of::Rectangle(sides), 20.0), 1.0 / (k2 * ratio * b.powi(3)), 2.5e-3);
        }
    }
    // both at once in a round bar
    let both = stress(&Bar::long(Of::Circle(d), [0.0; 3], [50.0, 40.0, 0.0]));
    let [bending, shear] = [32.0 * 40.0, 16.0 * 50.0].map(|moment| moment / (PI * d.powi(3)));
    assert_close("bent and twisted", both, (bending * bending + 3.0 * shear * shear).sqrt(), 1e-5);
}

#[test]
fn torsion_in_the_middles_of_a_rectangle_is_that_of_the_tables() {
    // shear stress for each G dtheta/dx in the middles of an edge along axis 3 and of one along axis 2
    let edges = |width: f64, height: f64| {
        let shape = Shape::rectangle(width, height, POISSON);
        let [_, along_3, along_2] = shape.stress.expect("a shape").torsion;
        [along_3 * shape.torsion, along_2 * shape.torsion]
    };
    // the longer side: k of Timoshenko & Goodier, section 109, three digits
    for (ratio, k) in [(1.0, 0.675), (2.0, 0.930), (10.0, 1.0)] {
        let [longer, shorter] = edges(1.0, ratio);
        assert!((longer - k).abs() < 6e-4 && shorter <= longer + 1e-12, "{longer} {shorter}");
        assert!((edges(ratio, 1.0)[1] - longer).abs() < 1e-15);
    }
    // the shorter side of a strip: 0.743 of the largest; both series of a square are one function
    assert!((edges(1.0, 1e4)[1] - 0.743).abs() < 1e-3);
    assert!((edges(1.0, 1.0 + 1e-12)[0] - edges(1.0, 1.0 - 1e-12)[0]).abs() < 1e-11);
}

#[test]
fn shear_of_walls_adds_up_to_the_force() {
    // a parabola from corner to corner in both webs, by Simpson's rule
    let (sizes, wall) = ([0.1, 0.2], 1e-4);
    let own = Shape::<f64>::box_section(sizes[0], sizes[1], wall, POISSON).stress.expect("a shape");
    for (k, size) in sizes.into_iter().enumerate() {
        let (corner, middle) = (own.shear_in_corners[k], own.shear_in_middles[k]);
        let force = 2.0 * wall * (size - wall) * (2.0 * corner + 4.0 * middle) / 6.0;
        assert!((force - 1.0).abs() < 1e-5, "{force}");
    }
    let tube = Shape::<f64>::tube(1.0, 1e-6, POISSON);
    let thin = tube.stress.expect("a shape").shear_in_corners[0] * tube.area;
    assert!((thin - 2.0).abs() < 1e-5, "{thin}");
}

#[test]
fn a_short_bar_fails_by_shear() {
    let short = |of, length, force| stress(&Bar { of, length, offset: None, force, moment: [0.0; 3] });
    let (root, force) = (3.0_f64.sqrt(), 1e4);
    let (b, h) = (0.02, 0.05);
    let rectangle = short(Of::Rectangle([b, h]), 0.005, [0.0, 0.0, force]);
    assert_close("rectangle", rectangle, root * 1.5 * force / (b * h), SMALL);
    let circle = short(Of::Circle(h), 0.005, [0.0, force, 0.0]);
    assert_close("circle", circle, root * 4.0 / 3.0 * force / (PI * h * h / 4.0), SMALL);
    // the neutral axis of an oblique force has the largest shear and no bending
    let (d, t): (f64, f64) = (0.05, 1e-4);
    let area = PI / 4.0 * (d * d - (d - 2.0 * t).powi(2));
    let tube = short(Of::Tube([d, t]), 0.02, [0.0, force / 200.0, force / 200.0]);
    assert_close("tube", tube, root * 2.0 * (force / 200.0 * 2.0_f64.sqrt()) / area, 1e-5);
    // the flow of the webs: V (b h / 4 + h^2 / 8) / I2 in their middles, on the middle line
    let t = 1e-3;
    let (across, up) = (b - t, h - t);
    let moment = (b * h.powi(3) - (b - 2.0 * t) * (h - 2.0 * t).powi(3)) / 12.0;
    let hollow = short(Of::Box([b, h, t]), 0.002, [0.0, 0.0, force / 10.0]);
    assert_close("box", hollow, root * force / 10.0 * (across * up / 4.0 + up * up / 8.0) / moment, 1e-5);
}

#[test]
fn a_line_beside_the_centroid_changes_no_stress() {
    let cases = [([5e4, 0.0, 0.0], [0.0; 3]), ([0.0, 30.0, 100.0], [0.0; 3]), ([0.0; 3], [40.0, 10.0, 5.0])];
    for (force, moment) in cases {
        let own = Bar::long(Of::Box([0.03, 0.05, 0.002]), force, moment);
        let beside = Bar { offset: Some([0.04, -0.03]), ..Bar { ..own } };
        assert_close("beside the line", stress(&beside), stress(&own), 3e-5);
    }
}

#[test]
fn section_forces_over_a_cantilever_are_those_of_its_load() {
    let bar = Bar::long(Of::Rectangle([0.02, 0.05]), [100.0, -20.0, -100.0], [15.0, 0.0, 0.0]);
    let found = values(&bar);
    // M2 = -z force times the arm, M3 = y force times the arm
    let exact = [100.0, -20.0, -100.0, 15.0, 100.0, -20.0];
    for (component, own) in found[1..].chunks(2).enumerate() {
        let (size, bends) = (exact[component], component > 3);
        let largest = if bends && size < 0.0 { 0.0 } else { size };
        // turned by 2e-3 rad, times forces of 100 N
        assert!((own[0] - largest).abs() < 0.2, "largest {component}: {} against {largest}", own[0]);
        let integral = if bends { 0.5 * size } else { size };
        assert!((own[1] - integral).abs() < 0.2, "integral {component}: {} against {integral}", own[1]);
    }
}

/// A tapered beam beside its line with damping, a tube, a plate and cables of both kinds in motion.
struct Falling;

impl Scene for Falling {
    fn name(&self) -> String {
        "falling".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let size = |name: &str, value: f64| DesignVariable::new(name, value, (0.1 * value, 10.0 * value), "m");
        vec![
            size("width", 0.02),
            size("height", 0.03),
            size("diameter", 0.025),
            size("wall", 0.003),
            size("thickness", 0.004),
            size("length", 0.4),
            DesignVariable::new("E", 2e8, (1e7, 1e10), "N/m2"),
            DesignVariable::new("yield stress", 1e5, (1e4, 1e7), "N/m2"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.02, 6)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let &[width, height, diameter, wall, thickness, length, young, yield_stress] = x else { unreachable!() };
        let material = Material { young, poisson: S::from(0.3), density: S::from(1200.0) };
        let poisson = material.poisson;
        let (zero, second) = (S::zero(), Vector3::from_f64([0.0, 1.0, 0.0]));
        let tip = Vector3::new(length, zero, length * 0.2);
        let tapered = |share: f64| {
            let shape = Shape::rectangle(width * (1.0 - 0.4 * share), height, poisson);
            Section::of(material, shape).damped(S::from(1e-3)).offset([width * 0.5, height * 0.2])
        };
        let arm = m.tapered_beam("arm", BeamLine::straight([Vector3::zeros(), tip], 2, second).clamped_start(), tapered);
        let pipe = Section::of(material, Shape::tube(diameter, wall, poisson));
        let line = BeamLine::straight([tip, tip + second * length], 1, tip).from_node(arm.end());
        let pipe = m.beam("pipe", line, &pipe);
        let box_section = Section::of(material, Shape::box_section(height, width, wall, poisson));
        let girder = [tip, tip - second * length];
        let girder = m.beam("girder", BeamLine::straight(girder, 1, tip).from_node(arm.end()), &box_section);
        let sides = [Vector3::new(length, zero, zero), Vector3::new(zero, length, zero)];
        let plate = m.shell(
            "plate",
            ShellMesh::plate(Vector3::zeros(), sides, [1, 1]).clamped(Edge::FirstStart),
            &material,
            thickness,
        );
        let rope = CableSection::of(material, Shape::circle(diameter, poisson));
        let cables = [("rope", rope), ("light rope", rope.small_strains())].map(|(name, rope)| {
            let ends = [Vector3::zeros(), Vector3::new(length, zero, zero)];
            m.cable(name, CableLine::straight(ends, 2).clamped_start(), &rope)
        });
        m.gravity(Vector3::from_f64([1.0, 2.0, -9.81]));
        let beams = ElementGroup::of_groups("beams", [&arm.group(), &pipe.group(), &girder.group()]);
        let ropes = ElementGroup::of_groups("ropes", [&cables[0].group(), &cables[1].group()]);
        let all = ElementGroup::of_groups("all", [&beams, &plate.group(), &ropes]);
        for (name, group) in [("beams", &beams), ("plate", &plate.group()), ("ropes", &ropes), ("all", &all)] {
            let end = Aggregate::upper_maximum(SHARP).at(Times::End);
            m.von_mises_functional(&format!("largest of {name}"), end, group, yield_stress);
            m.von_mises_functional(&format!("bound of {name}"), Over::upper_maximum(20.0), group, yield_stress);
        }
        for kind in [AggregateKind::SquaredPower, AggregateKind::Exponential] {
            let run = Aggregate::new(kind, 4.0).at(Times::Run);
            m.von_mises_functional(&format!("{kind:?}"), run, &all, yield_stress);
        }
        m.von_mises_functional(
            "by length",
            Aggregate::smooth_maximum(9.0).continuous().at(Times::Run),
            &beams,
            yield_stress,
        );
        m.von_mises_functional("integral", Over::Integral, &beams, yield_stress);
        for component in 0..STRAINS {
            let over = Aggregate::smooth_maximum(1.0).at(Times::Run);
            m.section_forces_functional(&format!("component {component}"), over, &beams, component);
        }
        m.strain_energy_functional("energy of ropes", Over::Terminal, &ropes);
        Ok(())
    }
}

#[test]
fn stresses_of_all_members_together_have_the_gradient_of_a_complex_step() {
    let prepared = Prepared::new(&Falling).expect("a sound scene");
    let x: Vec<f64> = prepared.x.clone();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).expect("runs");
    let own = analysis.values(&x).expect("runs");
    let largest = own[0].max(own[2]).max(own[4]);
    assert!(own[0] > 0.0 && own[2] > 0.0 && own[4] > 0.0, "{own:?}");
    assert_close("all of them", own[6], largest, 1e-8);
    let adjoint = analysis.adjoint(&x, &forward).expect("adjoint");
    let complex_step = analysis.complex_step(&x, &forward).expect("complex step");
    // forces have the digits of strains, which are differences of lengths
    let limits = prepared.gradient_limits(1e-12).expect("complex steps nearby");
    for (k, functional) in prepared.functionals().iter().enumerate() {
        let expected = &complex_step.rows[k];
        let worst = largest_difference(&adjoint.rows[k], expected);
        println!("{}: {} {worst:.1e} of {:.1e}", functional.name, own[k], limits[k]);
        assert!(worst < limits[k], "{}: {worst:e}", functional.name);
        // forces of beams do not follow the plate, but each has derivatives by sizes of its own
        assert!(expected.iter().any(|entry| *entry != 0.0), "{}", functional.name);
    }
}

#[test]
fn what_has_no_stress_is_refused_by_what_is_missing() {
    let refused = |build: &dyn Fn(&mut MechanismBuilder<f64>)| {
        let mut m = MechanismBuilder::default();
        build(&mut m);
        m.finish().err().expect("refused").to_string()
    };
    let says = |message: &str, words: &[&str]| assert!(words.iter().all(|word| message.contains(word)), "{message}");
    let over = Over::smooth_maximum(10.0);
    let line = || {
        let ends = [Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0)];
        BeamLine::straight(ends, 2, Vector3::new(0.0, 1.0, 0.0)).clamped_start()
    };
    let material = Material { young: YOUNG, poisson: POISSON, density: 7850.0 };
    let by_stiffness = refused(&|m| {
        let beam = m.beam("spar", line(), &Section::new([1e6; STRAINS]));
        m.von_mises_functional("failure", over, &beam.group(), 1e8);
    });
    says(
        &by_stiffness,
        &["\"failure\"", "\"spar, element 1\"", "stiffness alone", "points of its outline", "a material and a shape"],
    );
    let pointed = refused(&|m| {
        let cone = |share: f64| Section::of(material, Shape::circle(0.1 * (1.0 - share), POISSON));
        let beam = m.tapered_beam("cone", line(), cone);
        m.von_mises_functional("failure", over, &beam.group(), 1e8);
    });
    says(&pointed, &["\"cone, element 2\"", "its diameter is 0 m"]);
    let rope = refused(&|m| {
        let ends = [Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0)];
        let cable = m.cable("rope", CableLine::straight(ends, 1), &CableSection::new(1e4, 1.0, 0.1));
        m.von_mises_functional("failure", over, &cable.group(), 1e8);
    });
    says(&rope, &["\"rope, element 1\"", "stiffness alone"]);
    let both = refused(&|m| {
        let beam = m.beam("spar", line(), &Section::of(material, Shape::circle(0.1, POISSON)));
        let sides = [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0)];
        let plate = m.shell("plate", ShellMesh::plate(Vector3::zeros(), sides, [1, 1]), &material, 0.01);
        let all = ElementGroup::of_groups("both", [&beam.group(), &plate.group()]);
        m.von_mises_functional("failure", Over::Integral, &all, 1e8);
    });
    says(&both, &["\"failure\"", "\"both\"", "areas and for lengths"]);
    let component = refused(&|m| {
        let beam = m.beam("spar", line(), &Section::new([1e6; STRAINS]));
        m.section_forces_functional("force", over, &beam.group(), 6);
    });
    says(&component, &["\"force\" asks for component 6", "0 to 5"]);
}
