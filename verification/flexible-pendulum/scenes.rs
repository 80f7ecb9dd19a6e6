//! The pendulum with less and less stretch, as a cable and as a geometrically exact beam, and one that is set in motion smoothly.

use costate::elements::flexible::{CableSection, Section};
use costate::elements::forces::LoadFrame;
use costate::internals::AppliedForce;
use costate::prelude::*;
use costate::scenes::{BeamLine, CableLine};

/// Which formulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formulation {
    /// Absolute nodal coordinates: Green's strain and the curvature of the deformed line, no shear.
    Cable,
    /// Geometrically exact: stretch and curvature for each length of the reference, with shear and rotary inertia.
    Beam,
}

/// The pendulum of the study, `stiffening` times as stiff to stretch and shear and with as many times less rotary inertia: what the two
/// formulations differ in vanishes with its inverse.
pub struct Stiffened {
    pub formulation: Formulation,
    pub elements: usize,
    pub stiffening: f64,
    /// Duration [s] and number of steps.
    pub run: (f64, usize),
}

/// Length and side of the section [m], density [kg/m3], Young's modulus [N/m2].
const LENGTH: f64 = 1.2;
const SIDE: f64 = 0.05;
const DENSITY: f64 = 4000.0;
const YOUNG: f64 = 1e7;

impl Scene for Stiffened {
    fn name(&self) -> String {
        format!("{:?} of {} elements, stiffened {} times", self.formulation, self.elements, self.stiffening)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(self.run.0, self.run.1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let vector = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let (area, second) = (SIDE * SIDE, SIDE.powi(4) / 12.0);
        let (axial, bending, mass) = (YOUNG * area * self.stiffening, YOUNG * second, DENSITY * area);
        let ends = [Vector3::zeros(), vector([LENGTH, 0.0, 0.0])];
        let ground = m.ground();
        match self.formulation {
            Formulation::Cable => {
                let section = CableSection::new(S::from(axial), S::from(bending), S::from(mass));
                let cable = m.cable("pendulum", CableLine::straight(ends, self.elements), &section);
                m.spherical("hinge", [ground, cable.start()], Vector3::zeros());
            }
            Formulation::Beam => {
                let stiffnesses = [axial, axial, axial, bending, bending, bending].map(S::from);
                let rotary = S::from(DENSITY * second / self.stiffening);
                let section = Section::new(stiffnesses).with_inertia(S::from(mass), [rotary; 2]);
                let normal = vector([0.0, 0.0, 1.0]);
                let beam = m.beam("pendulum", BeamLine::straight(ends, self.elements, normal), &section);
                m.revolute("hinge", [ground, beam.start()], Vector3::zeros(), normal);
            }
        }
        m.gravity(vector([0.0, -9.81, 0.0]));
        Ok(())
    }
}

/// The pendulum without weight, from rest under a force across its tip that begins smoothly: nothing in it has a breakpoint.
pub struct Pushed {
    pub elements: usize,
}

/// Size of the force, about half the weight of the pendulum [N], and how long it grows [s].
const PUSH: f64 = 60.0;
const GROWTH: f64 = 0.5;

impl Scene for Pushed {
    fn name(&self) -> String {
        format!("pendulum of {} elements, pushed", self.elements)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 1000)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let section = CableSection::new(
            S::from(YOUNG * SIDE * SIDE),
            S::from(YOUNG * SIDE.powi(4) / 12.0),
            S::from(DENSITY * SIDE * SIDE),
        );
        let ends = [Vector3::zeros(), Vector3::from_f64([LENGTH, 0.0, 0.0])];
        let ground = m.ground();
        let cable = m.cable("pendulum", CableLine::straight(ends, self.elements), &section);
        m.spherical("hinge", [ground, cable.start()], Vector3::zeros());
        let push = AppliedForce { on: NodeKind::Slope, frame: LoadFrame::World, size: TimeFunction::SmoothRamp };
        let numbers = [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, PUSH, 0.0, GROWTH].map(S::from);
        m.element("push", &[cable.end()], push, &numbers);
        Ok(())
    }
}
