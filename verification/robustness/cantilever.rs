//! A slender cantilever under a load across its tip.

use costate::elements::flexible::Section;
use costate::elements::forces::LoadFrame;
use costate::internals::AppliedForce;
use costate::prelude::*;
use costate::scenes::BeamLine;

/// What bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    Beam,
    /// A cable with exact strains.
    Cable,
    /// One with those of small strains.
    SmallStrainCable,
}

/// A beam or cable along x with EI = L = 1, mass 1 and EA = GA as given, clamped, under a dead load along y at its tip: one that grows with the
/// load factor, or that is there from the start on.
pub struct SlenderCantilever {
    pub line: Line,
    pub axial: f64,
    pub load: f64,
    pub elements: usize,
    pub settings: Settings,
    /// Whether the load is there from the start on.
    pub sudden: bool,
}

/// Of a section that is as slender as EA = 1e7 says, by its length [kg m].
const ROTARY_INERTIA: f64 = 1e-7;

impl Scene for SlenderCantilever {
    fn name(&self) -> String {
        "slender-cantilever".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("load", self.load, (-100.0, 100.0), "N")]
    }
    fn settings(&self) -> Settings {
        self.settings.clone()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let (zero, one, axial) = (S::zero(), S::one(), S::from(self.axial));
        let [along, across] = [Vector3::new(one, zero, zero), Vector3::new(zero, one, zero)];
        let ends = [Vector3::zeros(), along];
        let end = if self.line == Line::Beam {
            let section = Section::new([axial, axial, axial, one, one, one]);
            let section = section.with_inertia(one, [S::from(ROTARY_INERTIA); 2]);
            m.beam("line", BeamLine::straight(ends, self.elements, across).clamped_start(), &section).end()
        } else {
            let section = CableSection::new(axial, one, one);
            let section = if self.line == Line::Cable { section } else { section.small_strains() };
            m.cable("line", CableLine::straight(ends, self.elements).clamped_start(), &section).end()
        };
        let size = if self.sudden { TimeFunction::Constant } else { TimeFunction::ConstantRate };
        let of_time = if self.sudden { vec![x[0]] } else { vec![zero, x[0]] };
        let pull = AppliedForce { on: m.model.node(end).kind, frame: LoadFrame::World, size };
        m.element("load", &[end], pull, &[&[zero, one, zero, zero, zero, zero], &of_time[..]].concat());
        for (name, direction) in [("x of the tip", along), ("y of the tip", across)] {
            m.position_functional(name, Over::Terminal, end, along, direction);
        }
        Ok(())
    }
}
