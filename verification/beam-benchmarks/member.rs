//! One beam, clamped or free, with loads at its tip that grow with the load factor: every static problem of the study.

use costate::elements::flexible::Section;
use costate::elements::forces::LoadFrame;
use costate::elements::{NodeKind, TimeFunction};
use costate::history::Watch;
use costate::integrators::StepRecord;
use costate::internals::{AppliedForce, AppliedTorque, Model, march_dividing};
use costate::prelude::*;
use costate::scenes::BeamLine;

/// Shape of the line at rest.
#[derive(Clone, Copy)]
pub enum Rest {
    /// Along x, of this length [m].
    Straight(f64),
    /// An arc in the xy plane that starts along x and bends towards +y: radius [m] and angle [rad].
    Arc(f64, f64),
}

/// A load at the tip: values at load factors 0, 1/2 and 1.
#[derive(Clone, Copy)]
pub enum TipLoad {
    /// Dead force [N].
    Force([f64; 3], [f64; 3]),
    /// Dead moment [N m].
    Moment([f64; 3], [f64; 3]),
}

/// Growing with the load factor.
pub const GROWING: [f64; 3] = [0.0, 0.5, 1.0];

/// The beam.
#[derive(Clone)]
pub struct Member {
    pub rest: Rest,
    pub elements: usize,
    /// EA, GA2, GA3, GJ, EI2, EI3.
    pub stiffness: [f64; 6],
    /// Mass and rotary inertia for each length.
    pub inertia: [f64; 2],
    pub clamped: bool,
    pub loads: Vec<TipLoad>,
    /// Equal ones; those that Newton's method cannot make are halved.
    pub load_steps: usize,
}

impl Member {
    /// A clamped beam without inertia.
    pub fn clamped(rest: Rest, elements: usize, stiffness: [f64; 6]) -> Self {
        Member { rest, elements, stiffness, inertia: [0.0; 2], clamped: true, loads: Vec::new(), load_steps: 20 }
    }

    /// With a load more.
    pub fn with(mut self, load: TipLoad) -> Self {
        self.loads.push(load);
        self
    }

    /// The equilibrium under the whole load.
    pub fn solve(&self) -> Result<Solved, String> {
        self.solve_at(1)
    }

    /// Equilibria at as many equal parts of the load.
    pub fn solve_at(&self, parts: usize) -> Result<Solved, String> {
        let prepared = Prepared::new(self).map_err(|error| error.to_string())?;
        let mut equilibria: Vec<Vec<f64>> = Vec::new();
        let mut watch = Watch(|step: &StepRecord<f64>| {
            if step.t + step.h >= (equilibria.len() + 1) as f64 / parts as f64 - 1e-9 {
                equilibria.push(step.q.clone());
            }
            true
        });
        march_dividing(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch)
            .1
            .map_err(|error| error.to_string())?;
        let (model, numbers) = (prepared.mechanism.model, prepared.mechanism.numbers);
        Ok(Solved { start: numbers.q, p: numbers.p, model, equilibria })
    }
}

/// Equilibria with their model.
pub struct Solved {
    model: Model,
    p: Vec<f64>,
    start: Vec<f64>,
    /// Coordinates; the last is under the whole load.
    pub equilibria: Vec<Vec<f64>>,
}

impl Solved {
    /// Under the whole load.
    pub fn last(&self) -> &[f64] {
        &self.equilibria[self.equilibria.len() - 1]
    }
    /// Displacement of the tip [m].
    pub fn tip(&self, q: &[f64]) -> [f64; 3] {
        let last = self.start.len() - 7;
        std::array::from_fn(|i| q[last + i] - self.start[last + i])
    }
    /// Rotation of the tip about z [rad], in (-pi, pi].
    pub fn tip_angle(&self, q: &[f64]) -> f64 {
        let e = &q[self.start.len() - 4..];
        let half = e[3].atan2(e[0]);
        2.0 * (half - std::f64::consts::PI * (half / std::f64::consts::PI).round())
    }
    /// Strain energy [J] at coordinates of all nodes.
    pub fn energy(&self, q: &[f64]) -> f64 {
        let energy = |index: usize| {
            let element = &self.model.elements[index];
            let own: Vec<f64> =
                element.nodes.iter().flat_map(|node| q[self.model.node(*node).dofs.clone()].to_vec()).collect();
            let rest = vec![0.0; own.len()];
            element.physics.energies_at(&rest, &own, &self.p[element.parameters.clone()])[1]
        };
        let beams = |index: &usize| self.model.elements[*index].name.starts_with("beam");
        (0..self.model.elements.len()).filter(beams).map(energy).sum()
    }
}

impl Scene for Member {
    fn name(&self) -> String {
        "member".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(self.load_steps)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, rotary] = self.inertia.map(S::from);
        let section = Section::new(self.stiffness.map(S::from)).with_inertia(mass, [rotary; 2]);
        let vector = |components: [f64; 3]| Vector3::<S>::from_f64(components);
        let mut line = match self.rest {
            Rest::Straight(length) => {
                BeamLine::straight([Vector3::zeros(), vector([length, 0.0, 0.0])], self.elements, vector([0.0, 1.0, 0.0]))
            }
            Rest::Arc(radius, angle) => {
                let centre = vector([0.0, radius, 0.0]);
                BeamLine::arc(Vector3::zeros(), centre, vector([0.0, 0.0, 1.0]), S::from(angle), self.elements)
            }
        };
        if self.clamped {
            line = line.clamped_start();
        }
        let beam = m.beam("beam", line, &section);
        let zero = S::zero();
        for (index, load) in self.loads.iter().enumerate() {
            let size = TimeFunction::table(&[0.0, 0.5, 1.0], Interpolant::Lines)?;
            let name = format!("load {}", index + 1);
            match *load {
                TipLoad::Force(direction, course) => {
                    let p = [direction.map(S::from), [zero; 3], course.map(S::from)].concat();
                    m.element(&name, &[beam.end()], AppliedForce { on: NodeKind::Body, frame: LoadFrame::World, size }, &p);
                }
                TipLoad::Moment(direction, course) => {
                    let p = [direction.map(S::from), course.map(S::from)].concat();
                    m.element(&name, &[beam.end()], AppliedTorque { on: NodeKind::Body, frame: LoadFrame::World, size }, &p);
                }
            }
        }
        Ok(())
    }
}
