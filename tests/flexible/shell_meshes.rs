//! Structures of shells that meet at edges, and of thin walls: held against beam theory, joined to bodies and beams.

use costate::elements::flexible::{Material, Section, Shape};
use costate::elements::forces::LoadFrame;
use costate::internals::{AppliedForce, AppliedTorque};
use costate::prelude::*;
use costate::scenes::{BeamLine, Extrusion, NodeId, Profile};

const YOUNG: f64 = 70e9;
/// Middle lines and length of the tube \[m\].
const SIDE: f64 = 0.05;
const LENGTH: f64 = 0.5;
const THICKNESS: f64 = 0.001;

fn material<S: Scalar>() -> Material<S> {
    Material { young: S::from(YOUNG), poisson: S::zero(), density: S::from(2500.0) }
}

fn extrusion<S: Scalar>(twist: f64, elements: usize) -> Extrusion<S> {
    let [along, first_axis] = [[LENGTH, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::from_f64);
    Extrusion { start: Vector3::zeros(), along, first_axis, twist: S::from(twist), elements }
}

#[derive(Clone, Copy, PartialEq)]
enum Load {
    /// Force along axis 1 or 2 of the profile at the end.
    Force(usize),
    /// Torque about the line.
    Torque,
}

#[derive(Clone, Copy)]
enum Walls {
    /// With as many elements across each wall.
    SquareTube(usize),
    /// With flanges of this width.
    ISection(f64),
    /// One wall of this height.
    Blade(f64),
}

impl Walls {
    fn profile<S: Scalar>(self) -> Profile<S> {
        let side = S::from(SIDE);
        match self {
            Walls::SquareTube(across) => Profile::box_tube([side; 2], [across; 2]),
            Walls::ISection(width) => Profile::i_section([S::from(width), side], [1, 2]),
            Walls::Blade(height) => {
                let ends = [-0.5, 0.5].map(|share| [S::from(share * height), S::zero()]);
                Profile::new(ends.to_vec(), vec![([0, 1], 1)])
            }
        }
    }
}

/// A thin-walled cantilever, both ends in rigid bodies.
struct Cantilever {
    profile: Walls,
    twist: f64,
    elements: usize,
    load: Load,
    /// In N or N m.
    size: f64,
    end: End,
}

/// What carries the edge at the end, and the load.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// A node of the edge.
    Node,
    /// A body without mass on the line.
    Body,
}

/// So small that linear theory holds.
const FORCE: f64 = 1e-3;
const TORQUE: f64 = 1e-3;

impl Scene for Cantilever {
    fn name(&self) -> String {
        "cantilever".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("thickness", THICKNESS, (1e-4, 1e-2), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let ground = m.ground();
        let walls =
            m.thin_walls("walls", &self.profile.profile(), &extrusion(self.twist, self.elements), &material(), |_, _| x[0]);
        m.rigid_interface("root", ground, &walls.start());
        let on_line = Vector3::from_f64([LENGTH, 0.0, 0.0]);
        let tip = match self.end {
            End::Node => walls.end()[0],
            End::Body => m.body("end", on_line, Quaternion::identity()),
        };
        m.rigid_interface("end", tip, &walls.end());
        let (frame, size, on) = (LoadFrame::World, TimeFunction::ConstantRate, NodeKind::Body);
        let (at, axis) = (m.local_point(tip, on_line), |k: usize| {
            Vector3::<S>::from_f64(std::array::from_fn(|i| f64::from(u8::from(i == k))))
        });
        let grown = |direction: usize, size: f64| -> Vec<S> {
            axis(direction).components().into_iter().chain([S::zero(), S::from(size)]).collect()
        };
        match self.load {
            Load::Force(along) => {
                let mut p = grown(along, self.size);
                p.splice(3..3, at.components());
                m.element("load", &[tip], AppliedForce { on, frame, size }, &p);
                m.position_functional("deflection", Over::Terminal, tip, on_line, axis(along));
            }
            Load::Torque => {
                m.element("load", &[tip], AppliedTorque { on, frame, size }, &grown(0, self.size));
                // of a point one metre beside the line
                m.position_functional("turn", Over::Terminal, tip, on_line + axis(1), axis(2));
            }
        }
        Ok(())
    }
}

/// Deflection \[m\] or turn \[rad\] of the end, and its slope by the thickness.
fn end_of(scene: &Cantilever) -> [f64; 2] {
    let prepared = Prepared::new(scene).expect("sound");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("an equilibrium");
    [forward.values[0], analysis.adjoint(x, &forward).expect("differentiable").rows[0][0]]
}

#[test]
fn a_square_tube_bends_as_a_beam_and_twists_as_bredt_says() {
    let scene = |load, across| Cantilever {
        profile: Walls::SquareTube(across),
        twist: 0.0,
        elements: 10,
        load,
        size: FORCE,
        end: End::Node,
    };
    let (shear, area) = (YOUNG / 2.0, 4.0 * SIDE * THICKNESS);
    let bending = YOUNG * 4.0 * (SIDE * SIDE.powi(2) * THICKNESS / 4.0 + THICKNESS * SIDE.powi(3) / 12.0) / 2.0;
    // Cowper (1966), thin-walled square tube: 20 (1 + nu) / (48 + 39 nu)
    let deflection = FORCE * (LENGTH.powi(3) / (3.0 * bending) + LENGTH / (shear * area * 20.0 / 48.0));
    for along in [1, 2] {
        let [own, slope] = end_of(&scene(Load::Force(along), 2));
        assert!((own / deflection - 1.0).abs() < 5e-3, "{}", own / deflection);
        // in proportion to 1 / h but for the walls' own bending
        assert!((slope * THICKNESS / own + 1.0).abs() < 0.01, "{}", slope * THICKNESS / own);
    }
    // Bredt: J = 4 A^2 h / s, with that of the walls, s h^3 / 3
    let enclosed = SIDE * SIDE;
    let torsion = shear * (4.0 * enclosed * enclosed * THICKNESS / (4.0 * SIDE) + 4.0 * SIDE * THICKNESS.powi(3) / 3.0);
    let turn = TORQUE * LENGTH / torsion;
    // at a corner the penalty against drilling of one wall resists the turning that the other one asks for: no more than bending does
    let errors = [2, 4].map(|across| 1.0 - end_of(&scene(Load::Torque, across))[0] / turn);
    assert!(errors.iter().all(|error| error.abs() < 3e-4), "{errors:?}");
}

#[test]
fn a_body_without_mass_carries_an_edge_as_a_node_of_it_does() {
    // what turns the body against its links is of the size of the load, round-off of it at the start
    for size in [1e-6, 1e-3, 1.0, 100.0] {
        for load in [Load::Force(1), Load::Force(2), Load::Torque] {
            let tube = |end| Cantilever { profile: Walls::SquareTube(2), twist: 0.0, elements: 4, load, size, end };
            let [node, body] = [End::Node, End::Body].map(|end| end_of(&tube(end)));
            // coordinates are rounded to 1e-16 m, and stretch is a thousand times stiffer than bending
            let known = 1e-9 + 1e-14 / node[0].abs();
            for (node, body) in node.into_iter().zip(body) {
                assert!(
                    (body / node - 1.0).abs() < known,
                    "{size:e}: {node:e} and {body:e}, {:e} of {known:e}",
                    body / node - 1.0
                );
            }
        }
    }
}

#[test]
fn an_i_section_bends_about_both_axes_as_a_beam() {
    let width = 0.04;
    let strong = 2.0 * width * THICKNESS * SIDE * SIDE / 4.0 + THICKNESS * SIDE.powi(3) / 12.0;
    let weak = 2.0 * THICKNESS * width.powi(3) / 12.0;
    // the web carries the shear along it, five sixths of the flanges that along them
    let shear = [2.0 * width * 5.0 / 6.0, SIDE].map(|height| YOUNG / 2.0 * height * THICKNESS);
    for (along, inertia) in [(2, strong), (1, weak)] {
        let expected = FORCE * (LENGTH.powi(3) / (3.0 * YOUNG * inertia) + LENGTH / shear[along - 1]);
        let [own, _] = end_of(&Cantilever {
            profile: Walls::ISection(width),
            twist: 0.0,
            elements: 10,
            load: Load::Force(along),
            size: FORCE,
            end: End::Node,
        });
        assert!((own / expected - 1.0).abs() < 0.01, "{along}: {}", own / expected);
    }
}

#[test]
fn a_twisted_blade_bends_as_a_beam_of_twisted_sections() {
    let height = 0.01;
    let blade = |twist| {
        end_of(&Cantilever {
            profile: Walls::Blade(height),
            twist,
            elements: 12,
            load: Load::Force(2),
            size: FORCE,
            end: End::Node,
        })[0]
    };
    let flexibility =
        [height * THICKNESS.powi(3) / 12.0, THICKNESS * height.powi(3) / 12.0].map(|inertia| 1.0 / (YOUNG * inertia));
    let twist = 1.2;
    // w = P integral of (L - x)^2 (cos^2 / EI_weak + sin^2 / EI_strong) dx, by Simpson's rule; the root is turned by 0, the end by 1.2
    let steps = 200;
    let integrand = |i: usize| {
        let share = i as f64 / steps as f64;
        let (s, c) = (twist * share).sin_cos();
        (LENGTH * (1.0 - share)).powi(2) * (c * c * flexibility[0] + s * s * flexibility[1])
    };
    let weight = |i: usize| {
        if i == 0 || i == steps {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    let expected = FORCE * 1e-3 * (0..=steps).map(|i| weight(i) * integrand(i)).sum::<f64>() * LENGTH / (3.0 * steps as f64);
    let own = blade(twist) * 1e-3;
    assert!((own / expected - 1.0).abs() < 0.01, "{}", own / expected);
}

#[test]
fn walls_share_nodes_at_corners_and_lists_of_nodes_have_each_once() {
    let mut m = MechanismBuilder::<f64>::default();
    let tube =
        m.thin_walls("tube", &Profile::box_tube([SIDE; 2], [2, 1]), &extrusion(0.3, 3), &material(), |_, _| THICKNESS);
    m.mass_functional("mass", Over::Initial);
    let m = m.finish().expect("sound");
    let around = 2 * (2 + 1 + 2 + 1);
    assert_eq!(m.model.nodes.len(), around * 7);
    let [start, end]: [Vec<NodeId>; 2] = [tube.start(), tube.end()];
    assert_eq!([start.len(), end.len()], [around; 2]);
    let at = |node: &NodeId| m.numbers.q[m.model.node(*node).dofs.start];
    assert!(start.iter().all(|node| at(node) == 0.0) && end.iter().all(|node| (at(node) - LENGTH).abs() < 1e-15));
}

#[test]
fn a_beam_ends_in_a_body_that_carries_the_edges_of_a_tube() {
    // half of the cantilever is a beam of the tube's section
    struct Half;
    impl Scene for Half {
        fn name(&self) -> String {
            "half".into()
        }
        fn variables(&self) -> Vec<DesignVariable> {
            Vec::new()
        }
        fn settings(&self) -> Settings {
            Settings::statics(1)
        }
        fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
            let ground = m.ground();
            let profile = Walls::SquareTube(2).profile();
            let [half, across] = [[0.5 * LENGTH, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vector3::<S>::from_f64);
            let drawn = Extrusion { along: half, ..extrusion(0.0, 5) };
            let walls = m.thin_walls("walls", &profile, &drawn, &material(), |_, _| S::from(THICKNESS));
            m.rigid_interface("root", ground, &walls.start());
            let (outer, wall) = (S::from(SIDE + THICKNESS), S::from(THICKNESS));
            let section = Section::of(material(), Shape::box_section(outer, outer, wall, S::zero()));
            let beam = m.beam("beam", BeamLine::straight([half, half * S::from(2.0)], 4, across), &section);
            m.rigid_interface("joint", beam.start(), &walls.end());
            let p = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, FORCE].map(S::from);
            let load = AppliedForce { on: NodeKind::Body, frame: LoadFrame::World, size: TimeFunction::ConstantRate };
            m.element("load", &[beam.end()], load, &p);
            let (at, up) = (m.position(beam.end()), Vector3::from_f64([0.0, 0.0, 1.0]));
            m.position_functional("deflection", Over::Terminal, beam.end(), at, up);
            Ok(())
        }
    }
    let prepared = Prepared::new(&Half).expect("sound");
    let own = prepared.analysis().values(&prepared.x).expect("an equilibrium")[0];
    let whole = Cantilever {
        profile: Walls::SquareTube(2),
        twist: 0.0,
        elements: 10,
        load: Load::Force(2),
        size: FORCE,
        end: End::Node,
    };
    let [whole, _] = end_of(&whole);
    assert!((own / whole - 1.0).abs() < 0.01, "{}", own / whole);
}

#[test]
fn mistakes_of_thin_walls_and_interfaces_are_told() {
    let refused = |build: &dyn Fn(&mut MechanismBuilder<f64>)| {
        let mut m = MechanismBuilder::default();
        build(&mut m);
        m.finish().err().expect("refused")
    };
    let oblique = refused(&|m| {
        let drawn = Extrusion { first_axis: Vector3::new(1.0, 1.0, 0.0), ..extrusion(0.0, 1) };
        m.thin_walls("tube", &Profile::box_tube([SIDE; 2], [1; 2]), &drawn, &material(), |_, _| THICKNESS);
    });
    assert!(oblique.contains("cosine is 7.071e-1"), "{oblique}");
    let corner = refused(&|m| {
        let profile = Profile::new(vec![[0.0, 0.0], [1.0, 0.0]], vec![([0, 2], 1)]);
        m.thin_walls("tube", &profile, &extrusion(0.0, 1), &material(), |_, _| THICKNESS);
    });
    assert!(corner.contains("corner [0, 2]; there are 2, from 0 on"), "{corner}");
    let nothing = refused(&|m| {
        let ground = m.ground();
        m.rigid_interface("root", ground, &[]);
    });
    assert!(nothing.contains("\"root\" joins no nodes"), "{nothing}");
}

#[test]
fn a_stretched_plate_has_the_stress_of_its_strain_everywhere() {
    let scene = costate::scenes::built_in::named("plate-pendulum").expect("built in");
    let prepared = Prepared::new(scene).expect("sound");
    let (q, p) = (&prepared.mechanism.numbers.q, &prepared.mechanism.numbers.p);
    let surfaces = prepared.mechanism.surfaces();
    assert_eq!(surfaces.len(), 5);
    // stretched by 1e-3 along x: E e / (1 - nu^2) along, nu times that across
    let mut stretched = q.clone();
    for node in surfaces.iter().flat_map(|surface| &surface.nodes) {
        let (start, _) = node.identity();
        stretched[start] = q[start] * 1.001;
    }
    let along: f64 = 70e9 / (1.0 - 0.09) * (1e-3 + 0.5e-6);
    let expected = along * (1.0 - 0.3 + 0.09_f64).sqrt();
    for stress in surfaces.iter().filter_map(|surface| surface.stresses(&stretched, p)).flatten() {
        assert!((stress / expected - 1.0).abs() < 1e-9, "{stress:e} {expected:e}");
    }
}
