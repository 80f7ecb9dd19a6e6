//! A beam that carries the elbow of the arm: two elements, curved and twisted, clamped to the ground.

use super::measures::Reach;
use costate::elements::TimeFunction;
use costate::elements::flexible::{Material, Section, Shape};
use costate::elements::forces::LoadFrame;
use costate::scalar::{Scalar, SpatialVector, Vector3};
use costate::scenes::{BeamLine, BeamMember, MechanismBuilder, Signal};

/// What is tested of the beam.
#[derive(Clone, Debug)]
pub enum BeamSubject {
    /// The parameters of its first element, with sections as given by [`Kind`].
    Element(Kind),
    /// Those of the weight of its first element.
    Weight(Kind),
    /// Those of a load along its first element.
    Load(LoadFrame, TimeFunction),
    /// The numbers that the scene gives to the builder: [`DESIGN`].
    Design,
}

/// Which of its formulas a section needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Stiffness on the diagonal, mass centre on the line.
    Plain,
    /// Mass centre beside the line.
    Eccentric,
    /// Moved away from the line, with damping: stiffness off the diagonal, mass centre beside the line.
    Offset,
}

use Reach::{Force, Later, Nothing, ProjectedInertia, ProjectedMass, Stored};

/// Numbers of the builder, and what each can reach: sections of a soft material, so that 50 steps resolve the motion.
pub const DESIGN: [(&str, f64, Reach); 20] = [
    ("width", 0.8, ProjectedMass),
    ("height", 0.6, ProjectedMass),
    ("Young's modulus", 1250.0, Stored),
    ("Poisson's ratio", 0.3, Stored),
    ("density", 1.25, ProjectedMass),
    ("x2 of the section", 0.05, ProjectedInertia),
    ("x3 of the section", -0.03, ProjectedInertia),
    ("damping", 0.02, Force),
    ("taper", 0.2, ProjectedMass),
    ("twist", 0.5, ProjectedInertia),
    ("clamp x", 1.2, ProjectedMass),
    ("clamp y", -0.5, ProjectedMass),
    ("clamp z", 0.3, ProjectedMass),
    ("bulge x", 0.12, ProjectedMass),
    ("bulge y", 0.1, ProjectedMass),
    ("bulge z", -0.07, ProjectedMass),
    ("second axis x", 0.4, ProjectedInertia),
    ("second axis y", -0.3, ProjectedInertia),
    ("second axis z", 0.8, ProjectedInertia),
    ("load", 1.5, Force),
];

/// Its values.
pub fn design<S: Scalar>() -> Vec<S> {
    DESIGN.iter().map(|(_, value, _)| S::from(*value)).collect()
}

impl BeamSubject {
    fn kind(&self) -> Kind {
        match self {
            BeamSubject::Element(kind) | BeamSubject::Weight(kind) => *kind,
            BeamSubject::Load(..) | BeamSubject::Design => Kind::Offset,
        }
    }

    /// The part whose parameters are tested, if it is one.
    pub fn part(&self) -> Option<&'static str> {
        match self {
            BeamSubject::Element(_) => Some("beam, element 1"),
            BeamSubject::Weight(_) => Some("weight of beam, element 1"),
            BeamSubject::Load(..) => Some("load, element 1"),
            BeamSubject::Design => None,
        }
    }

    /// What each of its numbers can reach.
    pub fn reaches(&self, statics: bool) -> Vec<Reach> {
        let own = |count: usize, reach: Reach| vec![reach; count];
        match self {
            BeamSubject::Element(kind) => {
                let moved = *kind == Kind::Offset;
                let stiffnesses = if moved { 21 } else { 6 };
                let tying = [own(7 + stiffnesses, Stored), own(usize::from(moved), Force)].concat();
                let first = if *kind == Kind::Plain { Nothing } else { ProjectedInertia };
                let gauss = [vec![ProjectedMass], own(3, first), own(6, ProjectedInertia)].concat();
                [tying.clone(), tying, gauss.clone(), gauss.clone(), gauss].concat()
            }
            BeamSubject::Weight(_) => own(21, Stored),
            BeamSubject::Load(_, size) => {
                let values = match size {
                    // the frequency shows from the second moment on, and the last of three knots in the end
                    TimeFunction::Sine => vec![Force, Force, Later, Force],
                    _ => vec![Force, Force, Later],
                };
                [own(4, Force), values].concat().repeat(3)
            }
            BeamSubject::Design => {
                let at_rest = |name: &str| statics && name == "damping";
                DESIGN.iter().map(|(name, _, reach)| if at_rest(name) { Nothing } else { *reach }).collect()
            }
        }
    }

    /// Adds the beam from a clamp beside the shoulder up to the elbow, which alone turns with the start: the beam changes its length.
    pub fn add<S: Scalar>(
        &self,
        m: &mut MechanismBuilder<S>,
        [shoulder, elbow]: [Vector3<S>; 2],
        numbers: &[S],
        function: &[S],
    ) -> BeamMember {
        let [width, height, young, poisson, density, x2, x3, damping, taper, twist, rest @ ..] = numbers else {
            unreachable!("{} numbers", DESIGN.len())
        };
        let vector = |first: usize| Vector3::first_three(&rest[first..]);
        let clamp = shoulder + vector(0);
        let bulge = vector(3);
        let point = |share: f64| clamp + (elbow - clamp) * S::from(share) + bulge * S::from(4.0 * share * (1.0 - share));
        let points: Vec<Vector3<S>> = (0..=4).map(|i| point(0.25 * f64::from(i))).collect();
        let line = BeamLine::through(&points, vector(6)).twisted(*twist).clamped_start();
        let material = Material { young: *young, poisson: *poisson, density: *density };
        let section = |share: f64| {
            let size = S::one() - *taper * share;
            let own = Section::of(material, Shape::rectangle(*width * size, *height * size, *poisson));
            match self.kind() {
                Kind::Plain => own,
                Kind::Eccentric => own.with_centre([*x2, *x3]),
                Kind::Offset => own.offset([*x2, *x3]).damped(*damping),
            }
        };
        let beam = m.tapered_beam("beam", line, section);
        let load = rest[9];
        match self {
            BeamSubject::Load(frame, size) => {
                let (direction, size) = (Vector3::from_f64([0.5, -0.3, 0.8]), Signal::of(size.clone(), function));
                m.distributed_load("load", &beam, (*frame, direction), size);
            }
            BeamSubject::Design => {
                let direction = (LoadFrame::Body, Vector3::from_f64([0.5, -0.3, 0.8]));
                m.distributed_load("load", &beam, direction, Signal::ConstantRate { offset: load, rate: load });
            }
            BeamSubject::Element(_) | BeamSubject::Weight(_) => {}
        }
        beam
    }
}
