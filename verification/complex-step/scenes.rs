//! The list of small scenes: one element or constraint each, in unsymmetric spatial motion.

use super::beam::{self, BeamSubject, Kind};
use super::cable::CableSubject;
use super::measures;
use super::shell::ShellSubject;
use costate::elements::flexible::FaceKind;
use costate::elements::forces::LoadFrame;
use costate::elements::joints::HeldSlope;
use costate::elements::{NodeKind, TimeFunction};
use costate::scalar::{Interpolant, Scalar};
use costate::scenes::{DesignVariable, MechanismBuilder, Scene, Settings};
use std::ops::Range;
use std::sync::Arc;

/// Length of every run [s].
pub const END: f64 = 0.64;
/// Steps of every run.
pub const STEPS: usize = 32;
/// Load steps of equilibria.
const LOAD_STEPS: usize = 5;

/// What a scene puts to the test; all its parameters are design variables.
#[derive(Clone, Debug)]
pub enum Subject {
    RigidBody,
    NaturalBody,
    PointMass,
    GravityOnBody,
    GravityOnPoint,
    /// A spring by the name of its entry.
    Spring(&'static str),
    /// A damper by the name of its entry.
    Damper(&'static str),
    /// The soft version of a joint.
    Soft(Box<Subject>),
    Force(NodeKind, LoadFrame, TimeFunction),
    Torque(LoadFrame, TimeFunction),
    Spherical(NodeKind),
    Revolute,
    Fixed,
    Distance,
    Prismatic,
    Cylindrical,
    Planar,
    Universal,
    Helical,
    RigidLink(NodeKind),
    /// A body that two others carry.
    TiedNode,
    PointOnLine(NodeKind),
    PointInPlane(NodeKind),
    RackAndPinion,
    /// The first of the two joint angles of a pair of gears.
    JointAngle,
    Gear,
    DiscOnPlane,
    RollingDisc,
    RollingSphere,
    Rotation(TimeFunction),
    Translation(TimeFunction),
    Beam(BeamSubject),
    Cable(CableSubject),
    Shell(ShellSubject),
}

/// One scene of the list.
#[derive(Clone)]
pub struct Case {
    /// Every which of the subject's parameters is varied, from which on: all, or a share of very many.
    pub every: [usize; 2],
    /// Name in the table.
    pub name: &'static str,
    /// What it tests.
    pub subject: Subject,
    /// Values of the time function, if the subject has one.
    pub function: Vec<f64>,
    /// The start violates the constraints and is projected onto them.
    pub projected: bool,
    /// Equilibria under a growing load instead of a motion.
    pub statics: bool,
    /// Variables at which the motion has no derivative: they stay out of the difference quotient.
    pub one_sided: &'static [&'static str],
}

/// All scenes. A new element or constraint is one more subject and one line here.
///
/// # Panics
/// Not: the knots of the table increase.
pub fn list() -> Vec<Case> {
    use Subject::*;
    use TimeFunction::*;
    let element = |name, subject, function: &[f64]| Case {
        every: [1, 0],
        name,
        subject,
        function: function.into(),
        projected: false,
        statics: false,
        one_sided: &[],
    };
    let constraint = |name, subject, function: &[f64]| Case { projected: true, ..element(name, subject, function) };
    // off their equilibrium, so that every strain is something to start with
    let cable = |name, subject| constraint(name, Cable(subject), &[]);
    let beam = |name, subject, function: &[f64]| constraint(name, Beam(subject), function);
    let soft = |joint: Subject| Soft(Box::new(joint));
    let table = TimeFunction::table(&[-0.1, 0.12, 0.31, 0.6], Interpolant::Smooth).expect("the knots increase");
    let early = TimeFunction::table(&[-0.025, 0.0775, 0.15], Interpolant::Lines).expect("the knots increase");
    // before the end of a shell's motion
    let soon = TimeFunction::table(&[-0.01, 0.031, 0.06], Interpolant::Lines).expect("the knots increase");
    let (world, body) = (LoadFrame::World, LoadFrame::Body);
    let started = SmoothStart(Arc::new(Sine));
    let started = constraint("prescribed-translation-started", Translation(started), &[0.02, 0.1, 5.0, 0.2, 0.6]);
    let inside = constraint("prescribed-translation-ramp", Translation(SmoothRamp), &[0.02, 0.2, 0.1, 0.3]);
    vec![
        element("rigid-body", RigidBody, &[]),
        constraint("rigid-body-projected", RigidBody, &[]),
        element("natural-body", NaturalBody, &[]),
        constraint("natural-body-projected", NaturalBody, &[]),
        element("point-mass", PointMass, &[]),
        element("gravity-body", GravityOnBody, &[]),
        element("gravity-point", GravityOnPoint, &[]),
        element("line-spring", Spring("line"), &[]),
        element("line-damper", Damper("line"), &[]),
        element("vector-damper-point", Damper("vector"), &[]),
        element("torsion-spring-damper", Spring("torsion"), &[]),
        element("slide-spring-damper", Spring("slide"), &[]),
        element("coordinate-spring-damper", Spring("angle"), &[]),
        element("bushing", Spring("bushing"), &[]),
        element("line-law", Spring("line_law"), &[]),
        element("torsion-law", Spring("torsion_law"), &[]),
        // soft versions differ in nothing but their joints: the contract tests hold all, these are enough here
        element("soft-spherical", soft(Spherical(NodeKind::Body)), &[]),
        element("soft-spherical-point", soft(Spherical(NodeKind::Point)), &[]),
        element("soft-revolute", soft(Revolute), &[]),
        element("soft-prismatic", soft(Prismatic), &[]),
        element("soft-universal", soft(Universal), &[]),
        element("soft-helical", soft(Helical), &[]),
        element("soft-gear", soft(Gear), &[]),
        element("soft-prescribed-rotation", soft(Rotation(Sine)), &[0.02, 0.4, 5.0, 0.2]),
        element("soft-prescribed-translation", soft(Translation(Sine)), &[0.02, 0.1, 5.0, 0.2]),
        element("force-world-step", Force(NodeKind::Body, world, Step { switch: 0.205 }), &[4.0, -6.0]),
        element("force-body-table", Force(NodeKind::Body, body, table), &[2.0, 7.0, -3.0, 5.0, 30.0, -9.0, -8.0, 40.0]),
        element("force-point-sine", Force(NodeKind::Point, world, Sine), &[1.0, 4.0, 9.0, 0.4]),
        element("torque-world-rate", Torque(world, ConstantRate), &[0.3, 2.0]),
        element("torque-body-constant", Torque(body, Constant), &[0.7]),
        constraint("spherical", Spherical(NodeKind::Body), &[]),
        constraint("spherical-point", Spherical(NodeKind::Point), &[]),
        constraint("spherical-natural", Spherical(NodeKind::Natural), &[]),
        constraint("revolute", Revolute, &[]),
        constraint("fixed", Fixed, &[]),
        constraint("distance", Distance, &[]),
        constraint("prismatic", Prismatic, &[]),
        constraint("cylindrical", Cylindrical, &[]),
        constraint("planar", Planar, &[]),
        constraint("universal", Universal, &[]),
        constraint("helical", Helical, &[]),
        constraint("rigid-link", RigidLink(NodeKind::Body), &[]),
        constraint("rigid-link-point", RigidLink(NodeKind::Point), &[]),
        constraint("tied-node", TiedNode, &[]),
        constraint("point-on-line", PointOnLine(NodeKind::Body), &[]),
        constraint("point-on-line-point", PointOnLine(NodeKind::Point), &[]),
        constraint("point-in-plane", PointInPlane(NodeKind::Body), &[]),
        constraint("point-in-plane-point", PointInPlane(NodeKind::Point), &[]),
        constraint("rack-and-pinion", RackAndPinion, &[]),
        constraint("joint-angle", JointAngle, &[]),
        constraint("gear", Gear, &[]),
        constraint("disc-on-plane", DiscOnPlane, &[]),
        constraint("rolling-disc", RollingDisc, &[]),
        constraint("rolling-sphere", RollingSphere, &[]),
        constraint("prescribed-rotation-started", Rotation(SmoothStart(Arc::new(ConstantRate))), &[0.05, 3.0, 1.4]),
        constraint("prescribed-rotation-rate", Rotation(ConstantRate), &[0.05, 2.0]),
        constraint("prescribed-rotation-sine", Rotation(Sine), &[0.02, 0.4, 5.0, 0.2]),
        constraint("prescribed-rotation-ramp", Rotation(SmoothRamp), &[-0.1, 1.2, -0.2, 1.4]),
        constraint("prescribed-translation-sine", Translation(Sine), &[0.02, 0.1, 5.0, 0.2]),
        beam("beam", BeamSubject::Element(Kind::Plain), &[]),
        beam("beam-eccentric", BeamSubject::Element(Kind::Eccentric), &[]),
        beam("beam-offset-damped", BeamSubject::Element(Kind::Offset), &[]),
        beam("weight-of-beam", BeamSubject::Weight(Kind::Offset), &[]),
        beam("load-along-beam-world-lines", BeamSubject::Load(world, early), &[1.0, 3.0, -2.0]),
        beam("load-along-beam-body-sine", BeamSubject::Load(body, Sine), &[1.0, 2.0, 9.0, 0.4]),
        element("shell", Shell(ShellSubject::Isotropic), &[]),
        element("shell-of-plies", Shell(ShellSubject::Laminate), &[]),
        element("shell-damped", Shell(ShellSubject::Damped), &[]),
        element("shell-of-four-nodes", Shell(ShellSubject::Face(FaceKind::Quad4)), &[]),
        element("shell-of-triangles", Shell(ShellSubject::Face(FaceKind::Triangle6)), &[]),
        element("pressure-world-lines", Shell(ShellSubject::Pressure(world, soon)), &[1.0, 3.0, -2.0]),
        element("pressure-body-sine", Shell(ShellSubject::Pressure(body, Sine)), &[1.0, 2.0, 9.0, 0.4]),
        cable("cable", CableSubject::Element),
        cable("cable-damped", CableSubject::Damped),
        cable("cable-small-strains", CableSubject::SmallStrain),
        cable("inertia-of-cable", CableSubject::Inertia),
        cable("weight-of-cable", CableSubject::Weight),
        cable("cable-corner", CableSubject::Corner),
        cable("cable-end-direction", CableSubject::End(HeldSlope::Direction)),
        cable("cable-end-vector", CableSubject::End(HeldSlope::Vector)),
        cable("cable-end-plane", CableSubject::End(HeldSlope::Plane)),
        Case { projected: false, statics: true, ..beam("beam-design-equilibrium", BeamSubject::Design, &[]) },
        // its second derivative has corners at both ends: a start or duration moves them off the steps' ends
        Case { one_sided: &["start", "duration"], ..inside },
        // and here the fourth derivative, which the extrapolation of the quotient asks for
        Case { one_sided: &["start duration"], ..started },
    ]
}

impl Case {
    /// A shell.
    pub fn is_of_shells(&self) -> bool {
        matches!(self.subject, Subject::Shell(_))
    }

    /// About a beam, its weight or its loads.
    pub fn is_of_beams(&self) -> bool {
        matches!(self.subject, Subject::Beam(_))
    }
    /// A beam itself, which goes with every integrator.
    pub fn is_basic_beam(&self) -> bool {
        matches!(self.subject, Subject::Beam(BeamSubject::Element(_)))
    }
    /// With flexible parts.
    pub fn is_flexible(&self) -> bool {
        matches!(self.subject, Subject::Beam(_) | Subject::Cable(_) | Subject::Shell(_))
    }
    /// End of the motion [s]: steps of a quarter resolve the waves along flexible parts, of a tenth those between the nodes of a shell.
    pub fn end(&self) -> f64 {
        match self.subject {
            Subject::Shell(_) => 0.1 * END,
            _ if self.is_flexible() => 0.25 * END,
            _ => END,
        }
    }
    /// One that goes with every integrator: a body, a joint of two bodies, a nonholonomic constraint, a driver, a load that jumps.
    pub fn goes_with_all(&self) -> bool {
        use Subject::*;
        let jumps = matches!(self.subject, Force(NodeKind::Body, _, TimeFunction::Step { .. }));
        let driven = matches!(self.subject, Rotation(TimeFunction::Sine));
        jumps || driven || matches!(self.subject, RigidBody | Revolute | RollingDisc)
    }

    /// One of the basic elements and constraints, of which each further integrator gets a share; what others add to them is their formula
    /// alone, and that is the same for all integrators.
    pub fn is_basic(&self) -> bool {
        use Subject::*;
        !matches!(
            self.subject,
            Spring("slide")
                | Spring("angle")
                | Spring("bushing")
                | Spring("line_law")
                | Spring("torsion_law")
                | Soft(_)
                | Prismatic
                | Cylindrical
                | Planar
                | Universal
                | Helical
                | RigidLink(_)
                | TiedNode
                | PointOnLine(_)
                | PointInPlane(_)
                | RackAndPinion
                | JointAngle
                | Gear
                | Beam(_)
                | Cable(_)
        )
    }

    /// The joint itself, hard or soft, or another subject.
    pub fn kind(&self) -> &Subject {
        match &self.subject {
            Subject::Soft(joint) => joint,
            other => other,
        }
    }

    /// Soft drives do work of their own.
    pub fn has_energies(&self) -> bool {
        match &self.subject {
            Subject::Soft(joint) => !matches!(**joint, Subject::Rotation(_) | Subject::Translation(_)),
            // for what their forces do at rest no energy is stated
            Subject::Spring(kind) => !kind.ends_with("_law"),
            _ => true,
        }
    }

    /// The numbers that the builder takes for the beam, if they are what is varied.
    pub fn is_design(&self) -> bool {
        matches!(self.subject, Subject::Beam(BeamSubject::Design))
    }

    /// Types of the part whose parameters are varied, and of the constraints inside the nodes.
    pub fn types(&self) -> Vec<&'static str> {
        let mut m = MechanismBuilder::default();
        let places = self.mechanism(&START.map(|(_, value)| value), &beam::design(), &mut m).1;
        let elements = m.model.elements.iter().map(|e| (&e.parameters, e.physics.type_name()));
        let joints = m.model.constraints.iter().map(|c| (&c.parameters, c.physics.type_name()));
        let subject = elements.chain(joints).filter(|(own, _)| is_of(own, &places));
        let inside = m.model.nodes.iter().filter_map(|node| Some(node.kind.local_constraint()?.type_name()));
        subject.map(|(_, name)| name).chain(inside).collect()
    }

    /// Whether a parameter of the subject is a design variable.
    pub fn varies(&self, place: usize) -> bool {
        place % self.every[0] == self.every[1] % self.every[0]
    }

    /// The parameters of the subject as they are designed, before anything is varied.
    pub fn nominal(&self) -> (Vec<f64>, Vec<String>) {
        if self.is_design() {
            return (beam::design(), beam::DESIGN.iter().map(|(name, ..)| name.to_string()).collect());
        }
        let mut m = MechanismBuilder::default();
        let places = self.mechanism(&START.map(|(_, value)| value), &beam::design(), &mut m).1;
        let model = &m.model;
        let elements = model.elements.iter().map(|e| (&e.parameters, e.physics.parameter_list()));
        let joints = model.constraints.iter().map(|c| (&c.parameters, c.physics.parameter_list()));
        let mut parameters =
            elements.chain(joints).find(|(own, _)| is_of(own, &places)).map_or(Vec::new(), |(_, list)| list);
        let own = parameters.len() - self.function.len();
        let mut values = m.numbers.p[places].to_vec();
        // nothing special: no unit vectors, right angles or closed loops that a wrong derivative could hide behind
        for (i, value) in values.iter_mut().take(own).enumerate() {
            let phase = i as f64;
            // inertia of a beam's points is small, and stays positive
            let size = value.abs().min(1.0);
            let added = if self.is_flexible() { size } else { 1.0 };
            *value = *value * (1.0 + 0.04 * (phase + 1.0).sin()) + 0.02 * size + 0.01 * added * (2.0 * phase).cos();
        }
        (values, parameters.drain(..).map(|parameter| parameter.name.into_owned()).collect())
    }
}

/// Whether some parameters are those of a part, behind which the sides of its switches may stand.
fn is_of(own: &Range<usize>, places: &Range<usize>) -> bool {
    own.start == places.start && !own.is_empty() && !places.is_empty()
}

/// Variables of every scene behind the parameters of its subject, with their values.
const START: [(&str, f64); 2] = [("turn of the start", 0.2), ("spin of the start", 0.6)];

impl Scene for Case {
    fn name(&self) -> String {
        self.name.into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let (values, names) = self.nominal();
        let start = START.map(|(name, value)| (name.to_string(), value));
        let all = names.into_iter().zip(values).enumerate().filter(|(place, _)| self.varies(*place)).map(|(_, own)| own);
        let all = all.chain(start).chain([("sensor".to_string(), 1.0)]);
        all.map(|(name, value)| DesignVariable::new(name, value, (value - 1.0, value + 1.0), "")).collect()
    }
    fn settings(&self) -> Settings {
        if self.statics {
            return Settings::statics(LOAD_STEPS);
        }
        let settings = Settings::new(self.end(), STEPS);
        if self.projected { settings.projecting_start() } else { settings }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let Some(varied) = x.len().checked_sub(3) else { return Err(format!("too few variables: {}", x.len())) };
        let (varied, rest) = x.split_at(varied);
        let mut subject: Vec<S> = self.nominal().0.into_iter().map(S::from).collect();
        let own = subject.len();
        let places = (0..own).filter(|&place| self.varies(place));
        places.zip(varied).for_each(|(place, &x)| subject[place] = x);
        let beam = if self.is_design() { subject.clone() } else { beam::design() };
        let (seen, places) = self.mechanism(&rest[..2], &beam, m);
        if !self.is_design() {
            if places.len() != own {
                return Err(format!("{} variables for {} parameters", own, places.len()));
            }
            m.numbers.p[places].copy_from_slice(&subject);
        }
        if self.projected {
            // off the constraints, so that the projection moves something
            // less where nodes lie close to each other
            let size = if self.is_flexible() { 0.02 } else { 1.0 };
            for node in m.model.nodes.iter().filter(|node| !node.fixed) {
                for i in node.dofs.clone() {
                    m.numbers.q[i] += S::from(size * 0.01 * (3.0 * i as f64).sin());
                    m.numbers.v[i] += S::from(size * 0.05 * (2.0 * i as f64).cos());
                }
            }
        }
        measures::add(m, &seen, &self.measures(), rest[2]);
        Ok(())
    }
}
