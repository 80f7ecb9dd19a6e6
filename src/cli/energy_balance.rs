//! The energy of a mechanism against the work of its loads, losses and drivers, by the integrator's own weights.

use crate::io::number;
use costate::assembly::{ConstraintId, Model, last_bit};
use costate::functionals::{ElementSum, Functional, JointLoad, Measured, MeasuredGroup, Over, Sample, Values};
use costate::integrators::{StartRecord, StepRecord};
use costate::program::tolerances::{LONG_SUM, ROUND_OFF};
use costate::scenes::Prepared;
use serde_json::{Value, json};

/// What is measured for the balance of a scene in motion that is not conservative; those that are have a stricter check of their own.
pub struct BalanceFunctionals {
    functionals: Vec<Functional>,
    /// Parameters of the model, and behind them those of loads, which a power does not read.
    p: Vec<f64>,
}

/// The balance of a run.
#[derive(Clone, Copy, Debug)]
pub struct EnergyBalance {
    /// Change of kinetic and potential energy \[J\].
    pub change: f64,
    /// Work of all that is in no energy: loads, dampers, actuators, losses \[J\].
    pub forces: f64,
    /// Work of drivers, and of the friction of joints and contacts \[J\].
    pub drivers: f64,
    /// Which of these there are.
    who: &'static str,
    /// What events change, impacts among them \[J\].
    pub events: f64,
    /// What energy there was to lose: the largest kinetic energy, the range of the potential one, and all that works put in and took out \[J\].
    size: f64,
    /// What rounding may leave \[J\].
    round_off: f64,
}

impl EnergyBalance {
    /// What the balance leaves \[J\].
    pub fn left(&self) -> f64 {
        self.change - self.forces - self.drivers - self.events
    }

    /// As a share of the energy that moved: kinetic, potential and exchanged; `None` where nothing but rounding is left.
    pub fn share(&self) -> Option<f64> {
        (self.left().abs() > self.round_off).then(|| self.left().abs() / self.size)
    }

    pub fn json(&self) -> Value {
        let [change, forces, drivers, left] = [self.change, self.forces, self.drivers, self.left()];
        json!({"change": change, "forces": forces, "drivers": drivers, "events": self.events, "left": left})
    }

    pub fn in_words(&self) -> String {
        let beside = |words: &str, work: f64| match work.abs() > self.round_off {
            true => format!(", {words} {} J", number(work)),
            false => String::new(),
        };
        let beside = beside(self.who, self.drivers) + &beside("events and impacts change it by", self.events);
        let left = self.share().map_or_else(String::new, |share| format!(", {share:.1e} of all energy that moved"));
        let [change, forces, apart] = [self.change, self.forces, self.left()].map(number);
        format!("energy changes by {change} J, loads and losses work {forces} J{beside}: {apart} J apart{left}")
    }
}

impl BalanceFunctionals {
    /// Of a scene; `None` where nothing moves or all is conservative.
    pub fn new(prepared: &Prepared) -> Option<Self> {
        let model = prepared.model();
        if prepared.method.table.is_static() || model.is_conservative() {
            return None;
        }
        let work = |name: &str, measured| Functional { name: name.into(), unit: "J", measured, over: Over::Integral };
        let power = |kind: ElementSum| Measured::Group(MeasuredGroup::new(None, kind.into(), 0..0));
        let mut functionals = vec![work("forces", power(ElementSum::Power))];
        let mut p = prepared.mechanism.numbers.p.clone();
        let parameters = p.len()..p.len() + JointLoad::PARAMETERS;
        p.resize(parameters.end, 0.0);
        for (place, attached) in model.constraints.iter().enumerate() {
            let joint = ConstraintId(place, model.identity());
            if !attached.physics.is_scleronomic() {
                let load = JointLoad::power(0..attached.physics.dof_count());
                let measured = Measured::Load { joint, parameters: parameters.clone(), load };
                functionals.push(work(&attached.name, measured));
            }
        }
        Some(BalanceFunctionals { functionals, p })
    }

    /// What sees the run.
    pub fn begin<'l>(&'l self, prepared: &'l Prepared) -> RunningBalance<'l> {
        let values = Values::new(&self.functionals, prepared.model(), &prepared.method.table, &self.p);
        RunningBalance {
            values,
            works: vec![0.0; self.functionals.len()],
            exchanged: 0.0,
            events: 0.0,
            held: 0.0,
            model: prepared.model(),
            p: &self.p,
            energy: Measured::energy(),
            range: None,
            latest: None,
        }
    }
}

/// The balance while a run goes on.
pub struct RunningBalance<'l> {
    values: Values<'l, f64>,
    /// Each work so far.
    works: Vec<f64>,
    /// All that they have put in and taken out, and what events have changed.
    exchanged: f64,
    events: f64,
    /// Largest reaction times largest coordinate: energies of this size are differences of what joints hold.
    held: f64,
    model: &'l Model,
    p: &'l [f64],
    energy: Measured,
    /// Energies at the ends of steps.
    range: Option<EnergyRange>,
    /// The end of the latest step, and its size [s].
    latest: Option<(Sample<f64>, f64)>,
}

/// What energies were [J].
#[derive(Clone, Copy)]
struct EnergyRange {
    start: f64,
    end: f64,
    kinetic: f64,
    potential: [f64; 2],
}

impl RunningBalance<'_> {
    fn energy_of(&self, sample: &Sample<f64>) -> f64 {
        self.energy.value(self.model, sample, self.p)
    }

    /// Takes note of the start, or of the end of a step of size `h`.
    fn note(&mut self, mut sample: Sample<f64>, h: f64) {
        let end = self.energy_of(&sample);
        let v = std::mem::take(&mut sample.at.v);
        sample.at.v = vec![0.0; v.len()];
        let potential = self.energy_of(&sample);
        sample.at.v = v;
        let begin = || EnergyRange { start: end, end, kinetic: 0.0, potential: [potential; 2] };
        let EnergyRange { end: latest, kinetic, potential: [lowest, highest], .. } = self.range.get_or_insert_with(begin);
        *latest = end;
        *kinetic = kinetic.max((end - potential).abs());
        (*lowest, *highest) = (lowest.min(potential), highest.max(potential));
        self.latest = Some((sample, h));
    }

    /// By how much the energy of the latest state changes where each coordinate moves by what Newton's method leaves of the largest one, and each
    /// velocity by as much over a step: what does not move by more than that has no energy.
    fn round_off(&self) -> f64 {
        let Some((sample, h)) = &self.latest else { return 0.0 };
        let moved = ROUND_OFF * sample.at.q.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        let mut rounded = sample.clone();
        // in no pattern that coordinates could follow
        let sign = |place: usize| last_bit(place).signum();
        rounded.at.q.iter_mut().enumerate().for_each(|(place, own)| *own += sign(2 * place) * moved);
        rounded.at.v.iter_mut().enumerate().for_each(|(place, own)| *own += sign(2 * place + 1) * moved / h);
        (self.energy_of(&rounded) - self.energy_of(sample)).abs()
    }

    pub fn start(&mut self, start: &StartRecord<f64>) {
        self.values.start(start);
        self.note(Sample::initial(start), f64::INFINITY);
    }

    pub fn step(&mut self, step: &StepRecord<f64>) {
        self.values.step(step);
        for (place, before) in self.works.iter_mut().enumerate() {
            let own = self.values.so_far(place);
            self.exchanged += (own - *before).abs();
            *before = own;
        }
        let mut end = Sample::empty();
        end.set_terminal(step);
        self.note(end.clone(), step.h);
        if !step.set.is_empty() || !step.impacts.is_empty() {
            let before = self.range.map_or(0.0, |range| range.end);
            end.follow_events(step, self.p);
            self.note(end, step.h);
            let own = self.range.map_or(0.0, |range| range.end) - before;
            self.events += own;
            self.exchanged += own.abs();
        }
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        let reactions = step.stages.last().map_or(0.0, |stage| largest(&stage.solve.unknowns.mu));
        self.held = self.held.max(reactions * largest(&step.q));
    }

    /// At the end of the last step; `None` of a run without steps.
    pub fn finish(self) -> Option<EnergyBalance> {
        let EnergyRange { start, end, kinetic, potential: [lowest, highest] } = self.range?;
        let (round_off, events) = (self.round_off(), self.events);
        let round_off = round_off.max(LONG_SUM * self.held.max(start.abs()).max(end.abs()));
        let (works, ..) = self.values.finish();
        let (change, drivers) = (end - start, works[1..].iter().sum());
        let constraints = &self.model.constraints;
        let is_driven = constraints.iter().any(|own| own.physics.is_driver());
        let who = match (is_driven, constraints.iter().any(|own| own.physics.has_friction())) {
            (_, false) => "drivers",
            (true, true) => "drivers and friction",
            (false, true) => "friction",
        };
        let size = kinetic + (highest - lowest) + self.exchanged;
        change.is_finite().then_some(EnergyBalance { change, forces: works[0], drivers, who, events, size, round_off })
    }
}
