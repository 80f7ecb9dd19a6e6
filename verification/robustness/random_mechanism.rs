//! Mechanisms drawn by lot: any members, joints, springs, drivers and loads of the library between any of their nodes.

use crate::verification::Noise;
use costate::elements::flexible::{CableSection, FaceKind, Material, Section, Shape};
use costate::elements::forces::LoadFrame;
use costate::elements::joints;
use costate::functionals::quantities::SectionMeasure;
use costate::integrators::{STATIC_TABLE, StepControl};
use costate::internals::{AppliedForce, AppliedTorque};
use costate::prelude::*;
use costate::scenes::{BeamLine, CableLine, ConstraintId, Edge, NodeId};

/// Lots, each with the odds that it is asked for.
pub struct Lots(Noise);

impl Lots {
    /// One of several series of a seed.
    pub fn new(seed: u64, series: u64) -> Self {
        let mut noise = Noise::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ series);
        // neighbouring seeds begin alike
        (0..8).for_each(|_| _ = noise.next());
        Lots(noise)
    }
    pub fn number(&mut self, from: f64, to: f64) -> f64 {
        from + 0.5 * (to - from) * (self.0.next() + 1.0)
    }
    /// A positive number, any order of magnitude between two with the same odds.
    pub fn size(&mut self, from: f64, to: f64) -> f64 {
        self.number(from.ln(), to.ln()).exp()
    }
    pub fn happens(&mut self, odds: f64) -> bool {
        self.number(0.0, 1.0) < odds
    }
    pub fn below(&mut self, count: usize) -> usize {
        (self.number(0.0, count as f64) as usize).min(count - 1)
    }
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
    pub fn vector<S: Scalar>(&mut self) -> Vector3<S> {
        Vector3::from_f64([self.0.next(), self.0.next(), self.0.next()])
    }
    pub fn rotation<S: Scalar>(&mut self) -> Quaternion<S> {
        let axis = self.vector::<S>();
        Quaternion::about(axis * (S::one() / axis.length()), S::from(self.number(-3.0, 3.0)))
    }
}

/// The mechanism of a seed. Its design variables multiply all of its lengths, masses, stiffnesses, dampings, loads and drives.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct RandomMechanism {
    pub seed: u64,
    /// Has members without mass, stops, second hinges and tied sheets, which are drawn from a series of their own: the rest is what it is without.
    pub has_more: bool,
}

/// A stop of an angle: a spring on one side.
struct Stop;

impl Element for Stop {
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::non_negative("stiffness", "N m/rad"), Parameter::new("angle", "rad")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn strain_energy<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let beyond = q[0] - p[1];
        S::zero().less(beyond).select(beyond * beyond * p[0] * 0.5, S::zero())
    }
}

/// Integrators and how often each is drawn.
const METHODS: [&str; 18] = [
    "esdirk4",
    "esdirk4",
    "esdirk4",
    "bdf2",
    "generalized-alpha",
    "variational",
    "midpoint",
    "dirk2",
    "dirk3",
    "sdirk2",
    "sdirk3",
    "sdirk4",
    "esdirk3",
    "esdirk5",
    "newmark",
    "bdf1",
    "bdf3",
    STATIC_TABLE,
];

/// Those that can choose their steps.
const CHOOSING: [&str; 5] = ["sdirk4", "esdirk3", "esdirk4", "esdirk5", STATIC_TABLE];

impl RandomMechanism {
    fn table(&self) -> &'static str {
        Lots::new(self.seed, 2).pick(&METHODS)
    }

    /// The integrator, and the level of the constraints.
    ///
    /// # Errors
    /// None, as long as the tables have these names.
    pub fn method(&self) -> Result<Method, RunError> {
        let (table, level) = (self.table(), Lots::new(self.seed, 3).pick(&ConstraintLevel::ALL));
        let method = Prepared::method_of(&self.settings().with_method(table))?;
        Ok(if matches!(table, "variational" | STATIC_TABLE) { method } else { Method { level, ..method } })
    }
}

/// What is multiplied by each of the design variables.
struct Factors<S> {
    length: S,
    mass: S,
    stiffness: S,
    damping: S,
    load: S,
    drive: S,
}

/// A node that joints and forces may hold, and where it is at the start.
#[derive(Clone, Copy)]
struct Place<S> {
    node: NodeId,
    kind: NodeKind,
    at: Vector3<S>,
}

/// A mechanism that grows.
struct Growing<'m, S: Scalar> {
    lots: Lots,
    /// Those of members without mass, stops, second hinges and tied sheets.
    more: Option<Lots>,
    /// Whether redundant equations are left out.
    drops: bool,
    m: &'m mut MechanismBuilder<S>,
    by: Factors<S>,
    /// Nodes with axes.
    bodies: Vec<Place<S>>,
    /// Nodes without.
    points: Vec<Place<S>>,
    joints: Vec<ConstraintId>,
    angles: Vec<NodeId>,
    named: usize,
    /// Nothing is pushed off, and nothing rolls: for equilibria.
    at_rest: bool,
}

impl<S: Scalar> Growing<'_, S> {
    fn name(&mut self, what: &str) -> String {
        self.named += 1;
        format!("{what} {}", self.named)
    }

    fn place(&mut self) -> Vector3<S> {
        self.lots.vector::<S>() * self.by.length
    }

    fn axis(&mut self) -> Vector3<S> {
        let axis = self.lots.vector::<S>();
        axis * (S::one() / axis.length())
    }

    /// Whether one more of what only some mechanisms have is asked for.
    fn wants_more(&mut self, odds: f64) -> bool {
        self.more.as_mut().is_some_and(|lots| lots.happens(odds))
    }

    /// Draws from the series of what only some mechanisms have.
    fn by_more_lots<T>(&mut self, draw: impl FnOnce(&mut Self) -> T) -> T {
        let Some(more) = self.more.take() else { return draw(self) };
        let usual = std::mem::replace(&mut self.lots, more);
        let drawn = draw(self);
        self.more = Some(std::mem::replace(&mut self.lots, usual));
        drawn
    }

    /// A body without mass that is fixed to another one, or that a drive turns or pushes.
    fn carrier(&mut self, held: NodeId, at: Vector3<S>) -> NodeId {
        let (name, turned, axis) = (self.name("carrier"), self.lots.rotation(), self.axis());
        let is_natural = self.lots.happens(0.3);
        let own = if is_natural { self.m.natural_body(&name, at, turned) } else { self.m.body(&name, at, turned) };
        let (joint, drive, nodes) = (self.name("hold"), self.name("drive"), [held, own]);
        match self.lots.below(3) {
            0 => self.joints.push(self.m.fixed(&joint, nodes, at)),
            1 => {
                let (function, values) = self.time_function();
                self.joints.push(self.m.revolute(&joint, nodes, at, axis));
                self.joints.push(self.m.prescribed_rotation(&drive, nodes, axis, Signal::of(function, &values)));
            }
            _ => {
                let (function, mut values) = self.time_function();
                values.iter_mut().take(2).for_each(|value| *value *= self.by.length);
                let signal = Signal::of(function, &values);
                self.joints.push(self.m.prismatic(&joint, nodes, at, axis));
                self.joints.push(self.m.prescribed_translation(&drive, nodes, [at; 2], axis, signal));
            }
        }
        let kind = if is_natural { NodeKind::Natural } else { NodeKind::Body };
        self.bodies.push(Place { node: own, kind, at });
        own
    }

    /// A point without mass on a body, and a spring from it.
    fn add_eye(&mut self) {
        let (name, joint, at) = (self.name("eye"), self.name("joint"), self.place());
        let Place { node: held, .. } = self.bodies[self.lots.below(self.bodies.len())];
        let node = self.m.point(&name, at);
        self.joints.push(self.m.spherical(&joint, [held, node], at));
        let other = self.any();
        self.spring([Place { node, kind: NodeKind::Point, at }, other]);
    }

    fn any(&mut self) -> Place<S> {
        let count = self.bodies.len() + self.points.len();
        let place = self.lots.below(count);
        if place < self.bodies.len() { self.bodies[place] } else { self.points[place - self.bodies.len()] }
    }

    /// A body of the mass distribution of a brick, whose frame is anywhere in it.
    fn add_body(&mut self) {
        let (name, at, turned) = (self.name("body"), self.place(), self.lots.rotation());
        let is_natural = self.lots.happens(0.2);
        let body = if is_natural { self.m.natural_body(&name, at, turned) } else { self.m.body(&name, at, turned) };
        let mass = self.by.mass * self.lots.size(0.01, 100.0);
        let sides = [(); 3].map(|()| self.by.length * self.lots.size(0.02, 1.0));
        let squares = sides.map(|side| side * side);
        let moment = |i: usize, j: usize| mass * (squares[i] + squares[j]) * (1.0 / 12.0);
        let zero = S::zero();
        let inertia = [moment(1, 2), moment(0, 2), moment(0, 1), zero, zero, zero];
        let centre = if self.lots.happens(0.5) { self.place() * S::from(0.2) } else { Vector3::zeros() };
        self.m.rigid_body(&name, body, mass, centre, inertia);
        self.push_off(body);
        let kind = if is_natural { NodeKind::Natural } else { NodeKind::Body };
        self.bodies.push(Place { node: body, kind, at });
        self.hold_body(body, at);
    }

    fn push_off(&mut self, node: NodeId) {
        if self.lots.happens(0.6) && !self.at_rest {
            let (velocity, omega) = (self.place() * S::from(2.0), self.lots.vector::<S>() * S::from(3.0));
            self.m.set_velocity(node, velocity, omega);
        }
    }

    /// Joins the body that was added last to one of those before, or leaves it free.
    fn hold_body(&mut self, body: NodeId, at: Vector3<S>) {
        let place = self.lots.below(self.bodies.len() - 1);
        let Place { node: other, at: near, .. } = self.bodies[place];
        let nodes = if self.lots.happens(0.8) { [other, body] } else { [body, other] };
        let point = at + (near - at) * S::from(self.lots.number(0.0, 1.0));
        self.join(nodes, point);
    }

    fn join(&mut self, [mut held, other]: [NodeId; 2], point: Vector3<S>) {
        if self.wants_more(0.25) {
            held = self.by_more_lots(|own| own.carrier(held, point));
        }
        let nodes = [held, other];
        let (axis, name) = (self.axis(), self.name("joint"));
        let joint = match self.lots.below(16) {
            0 | 1 => self.m.spherical(&name, nodes, point),
            2..=4 => {
                let joint = self.m.revolute(&name, nodes, point, axis);
                self.along_axis(nodes, axis);
                if self.drops && self.wants_more(0.3) {
                    let beside = point + axis * (self.by.length * 0.5);
                    self.joints.push(self.m.revolute(&format!("{name}, again"), nodes, beside, axis));
                }
                joint
            }
            5 => {
                let joint = self.m.prismatic(&name, nodes, point, axis);
                self.along_slide(nodes, point, axis);
                joint
            }
            6 => self.m.cylindrical(&name, nodes, point, axis),
            7 => self.m.planar(&name, nodes, point, axis),
            8 => {
                let second = axis.perpendiculars()[0];
                self.m.universal(&name, nodes, point, [axis, second])
            }
            9 => {
                let pitch = self.by.length * self.lots.number(-0.3, 0.3);
                self.m.helical(&name, nodes, point, axis, pitch)
            }
            10 => self.m.fixed(&name, nodes, point),
            11 => self.m.rigid_link(&name, nodes),
            12 => {
                let ends = [point, point + self.place()];
                self.m.distance(&name, nodes, ends)
            }
            13 => self.m.point_on_line(&name, nodes, point, axis),
            14 => self.m.point_in_plane(&name, nodes, point, axis),
            _ => return,
        };
        self.joints.push(joint);
    }

    /// What a hinge may have: an angle that is counted, a spring, a drive.
    fn along_axis(&mut self, nodes: [NodeId; 2], axis: Vector3<S>) {
        match self.lots.below(6) {
            0 => {
                let name = self.name("torsion spring");
                let coefficients = self.spring_damper();
                self.m.torsion_spring_damper(&name, nodes, axis, coefficients);
            }
            1 => {
                let name = self.name("drive");
                let (function, values) = self.time_function();
                let signal = Signal::of(function, &values);
                self.joints.push(self.m.prescribed_rotation(&name, nodes, axis, signal));
            }
            2 => {
                let name = self.name("angle");
                let angle = self.m.joint_angle(&name, nodes, axis);
                if let (Some(&other), true) = (self.angles.last(), self.lots.happens(0.5)) {
                    let name = self.name("gear");
                    let radii = [(); 2].map(|()| self.by.length * self.lots.size(0.1, 1.0));
                    self.joints.push(self.m.gear(&name, [other, angle], radii));
                } else if self.lots.happens(0.5) {
                    let name = self.name("spring of an angle");
                    let coefficients = self.spring_damper();
                    self.m.coordinate_spring_damper(&name, angle, 0, coefficients);
                }
                if self.wants_more(0.5) {
                    self.by_more_lots(|own| own.stop(angle));
                }
                self.angles.push(angle);
            }
            _ => {}
        }
    }

    fn stop(&mut self, angle: NodeId) {
        let (name, at) = (self.name("stop"), S::from(self.lots.number(-0.02, 0.1)));
        let stiffness = self.by.stiffness * self.lots.size(1.0, 1e4);
        self.m.element(&name, &[angle], Stop, &[stiffness, at]);
    }

    fn along_slide(&mut self, nodes: [NodeId; 2], point: Vector3<S>, axis: Vector3<S>) {
        match self.lots.below(4) {
            0 => {
                let name = self.name("drive");
                let (function, mut values) = self.time_function();
                values.iter_mut().take(2).for_each(|value| *value *= self.by.length);
                self.joints.push(self.m.prescribed_translation(
                    &name,
                    nodes,
                    [point; 2],
                    axis,
                    Signal::of(function, &values),
                ));
            }
            1 => {
                let name = self.name("slide spring");
                let coefficients = self.spring_damper();
                self.m.slide_spring_damper(&name, nodes, [point; 2], axis, coefficients);
            }
            _ => {}
        }
    }

    /// Stiffness, damping and the place of rest.
    fn spring_damper(&mut self) -> SpringDamper<S> {
        let stiffness = self.by.stiffness * self.lots.size(0.1, 1e5);
        let damping = if self.lots.happens(0.5) { self.by.damping * self.lots.size(1e-2, 1e2) } else { S::zero() };
        SpringDamper { stiffness, damping, rest: S::from(self.lots.number(-0.3, 0.3)) }
    }

    /// A function that begins with zero, and its parameters.
    fn time_function(&mut self) -> (TimeFunction, Vec<S>) {
        let (size, zero) = (self.by.drive * self.lots.number(-2.0, 2.0), S::zero());
        match self.lots.below(3) {
            0 => (TimeFunction::ConstantRate, vec![zero, size]),
            1 => (TimeFunction::Sine, vec![zero, size, S::from(self.lots.size(0.5, 50.0)), zero]),
            _ => (TimeFunction::SmoothRamp, vec![zero, size, zero, S::from(self.lots.size(0.01, 1.0))]),
        }
    }

    fn add_point(&mut self) {
        let (name, at) = (self.name("point"), self.place());
        let point = self.m.point(&name, at);
        let mass = self.by.mass * self.lots.size(0.01, 100.0);
        self.m.point_mass(&name, point, mass);
        self.push_off(point);
        let other = self.any();
        let Place { node: held, at: near, .. } = other;
        let own = Place { node: point, kind: NodeKind::Point, at };
        let (name, axis) = (self.name("joint"), self.axis());
        match self.lots.below(6) {
            0 => self.joints.push(self.m.distance(&name, [held, point], [near, at])),
            1 => self.joints.push(self.m.point_on_line(&name, [held, point], at, axis)),
            2 => self.joints.push(self.m.point_in_plane(&name, [held, point], at, axis)),
            3 => self.joints.push(self.m.spherical(&name, [held, point], at)),
            _ => self.spring([other, own]),
        }
        self.points.push(own);
    }

    fn spring(&mut self, places: [Place<S>; 2]) {
        let name = self.name("spring");
        let ends = places.map(|place| place.at + self.place() * S::from(0.1));
        let nodes = places.map(|place| place.node);
        let SpringDamper { stiffness, damping, .. } = self.spring_damper();
        let rest = (ends[1] - ends[0]).length() * self.lots.number(0.5, 1.2);
        self.m.line_spring(&name, nodes, ends, stiffness, rest);
        let name = self.name("damper");
        match self.lots.below(3) {
            0 => _ = self.m.line_damper(&name, nodes, ends, damping),
            1 => _ = self.m.vector_damper(&name, nodes, ends, damping),
            _ => {}
        }
    }

    fn section(&mut self) -> (Material<S>, Shape<S>) {
        let young = self.by.stiffness * self.lots.size(1e6, 2e11);
        let material = Material { young, poisson: S::from(0.3), density: self.by.mass * self.lots.size(500.0, 8000.0) };
        let side = self.by.length * self.lots.size(0.005, 0.1);
        let shape = match self.lots.below(4) {
            0 => Shape::rectangle(side, side * self.lots.size(0.2, 5.0), material.poisson),
            1 => Shape::tube(side, side * 0.1, material.poisson),
            2 => Shape::box_section(side, side * self.lots.size(0.5, 2.0), side * 0.05, material.poisson),
            _ => Shape::circle(side, material.poisson),
        };
        (material, shape)
    }

    fn add_beam(&mut self) {
        let (name, mut from, to) = (self.name("beam"), self.place(), self.place());
        let second = self.axis();
        let (material, shape) = self.section();
        let mut section = Section::of(material, shape);
        if self.lots.happens(0.5) {
            section = section.damped(self.by.damping * self.lots.size(1e-5, 1e-2));
        }
        let holds = self.lots.below(3);
        let Place { node: other, at: near, .. } = self.bodies[self.lots.below(self.bodies.len())];
        if holds == 0 {
            from = near;
        }
        let elements = 1 + self.lots.below(3);
        let line = BeamLine::straight([from, to], elements, second);
        let line = match holds {
            0 => line.from_node(other),
            1 => line.clamped_start(),
            _ => line,
        };
        let member = self.m.beam(&name, line, &section);
        if member.nodes.is_empty() {
            return;
        }
        self.bodies.push(Place { node: member.end(), kind: NodeKind::Body, at: to });
        if holds == 2 {
            self.bodies.push(Place { node: member.start(), kind: NodeKind::Body, at: from });
            self.join([other, member.start()], from);
        }
        if self.lots.happens(0.3) {
            let name = self.name("load on a beam");
            let (frame, direction) = (self.lots.pick(&[LoadFrame::World, LoadFrame::Body]), self.axis());
            let size = self.by.load * self.lots.size(0.1, 10.0);
            self.m.distributed_load(&name, &member, (frame, direction), Signal::Constant(size));
        }
        if self.lots.happens(0.3) {
            let (name, share) = (self.name("strain"), self.lots.number(0.0, 1.0));
            let measure = SectionMeasure::Strain(self.lots.below(6));
            self.m.section_functional(&name, Over::Terminal, &member, share, measure);
        }
    }

    fn add_cable(&mut self) {
        let (name, from, to) = (self.name("cable"), self.place(), self.place());
        let (material, shape) = self.section();
        let mut section = CableSection::of(material, shape);
        match self.lots.below(3) {
            0 => section = section.damped(self.by.damping * self.lots.size(1e-5, 1e-2)),
            1 => section = section.small_strains(),
            _ => {}
        }
        let line = CableLine::straight([from, to], 1 + self.lots.below(3));
        let line = if self.lots.happens(0.4) { line.clamped_start() } else { line };
        let member = self.m.cable(&name, line, &section);
        if member.nodes.is_empty() {
            return;
        }
        let other = self.any();
        let own = Place { node: member.end(), kind: NodeKind::Slope, at: to };
        let (joint, axis) = (self.name("joint"), self.axis());
        match self.lots.below(4) {
            0 => self.joints.push(self.m.spherical(&joint, [other.node, own.node], to)),
            1 => self.joints.push(self.m.cable_hinge(&joint, [other.node, own.node], (to - from).cross(&axis))),
            2 => self.spring([other, own]),
            _ => {}
        }
        self.points.push(own);
    }

    /// Two panels side by side, one fixed to another member, the other tied to it where their nodes do not meet.
    fn add_tied_sheet(&mut self) {
        let [along, across] = self.axis().perpendiculars();
        let [wide, high] = [(); 2].map(|()| self.by.length * self.lots.size(0.1, 1.0));
        let (corner, (material, _)) = (self.place(), self.section());
        let thickness = self.by.length * self.lots.size(2e-3, 2e-2);
        let damping = if self.lots.happens(0.3) { self.by.damping * self.lots.size(1e-5, 1e-2) } else { S::zero() };
        let [first, second] = [0.0, 1.0].map(|place| {
            let edges = [along * wide, across * high];
            let counts = [1, if place > 0.5 { 2 } else { 1 + 2 * self.lots.below(2) }];
            let face = self.lots.pick(&[FaceKind::Quad4, FaceKind::Quad4, FaceKind::Triangle6, FaceKind::Quad9]);
            let mesh = ShellMesh::plate(corner + edges[0] * S::from(place), edges, counts).with_faces(face);
            let name = self.name("panel");
            self.m.shell(&name, mesh.damped(damping), &material, thickness)
        });
        let Place { node: held, .. } = self.bodies[self.lots.below(self.bodies.len())];
        let (name, seam) = (self.name("hold"), self.name("seam"));
        self.joints.push(self.m.fixed(&name, [held, first.node(0, 0)], corner));
        self.joints.extend(self.m.tie(&seam, &second.edge(Edge::FirstStart), &[&first]));
        let end = second.edge(Edge::FirstEnd)[0];
        self.bodies.push(Place { node: end, kind: NodeKind::Body, at: self.m.position(end) });
    }

    fn load(&mut self) {
        let Place { node, kind: on, .. } = self.any();
        let (name, direction, arm) = (self.name("load"), self.axis(), self.place());
        let (size, frame) =
            (self.by.load * self.lots.size(0.1, 100.0), self.lots.pick(&[LoadFrame::World, LoadFrame::Body]));
        if on.has_axes() && self.lots.happens(0.4) {
            let torque = AppliedTorque { on, frame, size: TimeFunction::Constant };
            self.m.element(&name, &[node], torque, &[&direction.components()[..], &[size]].concat());
        } else {
            let force = AppliedForce { on, frame, size: TimeFunction::Constant };
            self.m.element(&name, &[node], force, &[&direction.components()[..], &arm.components(), &[size]].concat());
        }
    }

    fn bushing(&mut self) {
        let [a, b] = [(); 2].map(|()| self.bodies[self.lots.below(self.bodies.len())]);
        let at = a.at;
        let (name, axes) = (self.name("bushing"), self.lots.rotation());
        let stiffness = [(); 6].map(|()| self.by.stiffness * self.lots.size(0.1, 1e5));
        let damping = [(); 6].map(|()| self.by.damping * self.lots.size(1e-3, 10.0));
        if self.lots.happens(0.5) {
            let halves = |[a, b, c, d, e, f]: [S; 6]| [[a, b, c], [d, e, f]];
            let ([stiffness_along, stiffness_about], [damping_along, damping_about]) = (halves(stiffness), halves(damping));
            let rates = BushingRates { stiffness_along, stiffness_about, damping_along, damping_about };
            self.m.bushing(&name, [a.node, b.node], at, axes, rates);
        } else {
            let axis = self.axis();
            let keys = [("point", at.into()), ("axis", axis.into())];
            let revolute = joints::named("revolute").expect("an entry of this name");
            self.m.soft_joint(revolute, &name, &[a.node, b.node], keys, [&stiffness[..5], &damping[..5]]);
        }
    }

    /// A ball or a coin on the ground.
    fn roll(&mut self) {
        let (names, up) = ([self.name("contact"), self.name("rolling")], Vector3::from_f64([0.0, 0.0, 1.0]));
        let names = [&names[0][..], &names[1][..]];
        let radius = self.by.length * self.lots.size(0.05, 0.5);
        let on = self.place();
        let centre = Vector3::new(on.x, on.y, S::zero()) + up * radius;
        let (name, turned) = (self.name("roller"), self.lots.rotation());
        let body = self.m.body(&name, centre, turned);
        let mass = self.by.mass * self.lots.size(0.1, 10.0);
        let (moment, zero) = (mass * radius * radius * 0.4, S::zero());
        self.m.rigid_body(&name, body, mass, Vector3::zeros(), [moment, moment, moment, zero, zero, zero]);
        self.push_off(body);
        let ground = self.m.ground();
        let joints = if self.lots.happens(0.5) {
            self.m.rolling_sphere(names, [ground, body], centre, up, radius)
        } else {
            let along = Vector3::from_f64([self.lots.number(-1.0, 1.0), 1.0, 0.0]);
            let point = Vector3::new(on.x, on.y, S::zero());
            self.m.rolling_disc(names, [ground, body], (centre, along), (point, up), radius)
        };
        self.joints.extend(joints);
        self.bodies.push(Place { node: body, kind: NodeKind::Body, at: centre });
    }

    fn measure(&mut self) {
        let (Place { node, at, .. }, direction) = (self.any(), self.axis());
        let over = self.lots.pick(&[Over::Terminal, Over::Integral]);
        self.m.position_functional("place", over, node, at, direction);
        self.m.energy_functional("energy", Over::Terminal);
        if let Some(&joint) = self.joints.last() {
            self.m.reaction_norm_functional("reaction", Over::Integral, joint);
        }
    }
}

impl Scene for RandomMechanism {
    fn name(&self) -> String {
        format!("mechanism {}", self.seed)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let of = |name: &str| DesignVariable::new(name, 1.0, (0.5, 2.0), "-");
        ["length", "mass", "stiffness", "damping", "load", "drive"].map(of).to_vec()
    }
    fn settings(&self) -> Settings {
        let mut lots = Lots::new(self.seed, 1);
        let (h, steps) = (lots.size(1e-4, 2e-2), 5 + lots.below(10));
        let mut settings = Settings::new(h * steps as f64, steps).projecting_start();
        if lots.happens(0.5) {
            settings = settings.dropping_redundant();
        }
        if lots.happens(0.2) {
            settings = settings.dividing_steps();
        } else if CHOOSING.contains(&self.table()) && lots.happens(0.3) {
            settings = settings.choosing_steps(StepControl::new(lots.size(1e-8, 1e-3)));
        }
        settings
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let &[length, mass, stiffness, damping, load, drive] = x else { return Err("6 variables".into()) };
        let by = Factors { length, mass, stiffness, damping, load, drive };
        let ground = m.ground();
        let bodies = vec![Place { node: ground, kind: NodeKind::Body, at: Vector3::zeros() }];
        let lots = Lots::new(self.seed, 0);
        let (points, joints, angles) = (Vec::new(), Vec::new(), Vec::new());
        let more = self.has_more.then(|| Lots::new(self.seed, 4));
        let (drops, at_rest) = (self.settings().policy.drop_redundant, self.table() == STATIC_TABLE);
        let mut growing = Growing { lots, more, drops, m, by, bodies, points, joints, angles, named: 0, at_rest };
        if growing.lots.happens(0.8) {
            let gravity = growing.lots.vector::<S>() * S::from(10.0);
            growing.m.gravity(gravity);
        }
        for _ in 0..1 + growing.lots.below(4) {
            match growing.lots.below(10) {
                0 => growing.add_point(),
                1 => growing.add_beam(),
                2 => growing.add_cable(),
                3 if !growing.at_rest => growing.roll(),
                _ => growing.add_body(),
            }
        }
        for _ in 0..growing.lots.below(3) {
            match growing.lots.below(4) {
                0 => growing.bushing(),
                1 => growing.load(),
                2 => {
                    let ends = [growing.any(), growing.any()];
                    growing.spring(ends);
                }
                // a loop
                _ => {
                    let [a, b] = [(); 2].map(|()| growing.bodies[growing.lots.below(growing.bodies.len())]);
                    growing.join([a.node, b.node], (a.at + b.at) * S::from(0.5));
                }
            }
        }
        if growing.wants_more(0.3) {
            growing.by_more_lots(Growing::add_eye);
        }
        if growing.wants_more(0.2) {
            growing.by_more_lots(Growing::add_tied_sheet);
        }
        growing.measure();
        Ok(())
    }
}
