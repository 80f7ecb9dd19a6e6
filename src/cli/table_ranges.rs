//! Parts that read their tables beyond their points.

use costate::assembly::{Model, NodeId};
use costate::design::shortest;
use costate::functionals::{Sample, Times};
use costate::integrators::Place;
use costate::program::{Formula, Program, ProgramWork, TableRange};
use costate::scenes::Prepared;
use std::ops::Range;
use std::sync::Arc;

/// A part with tables, and where it left them.
struct WatchedTable {
    part: String,
    times: Times,
    /// First and last point of each table.
    ranges: Vec<TableRange>,
    /// Computes what each table is read at.
    program: Arc<Program>,
    /// Where the arguments of the program stand.
    places: Vec<Place>,
    /// For each table, if it was left: since when, and the number furthest beyond.
    left: Vec<Option<(f64, f64)>>,
}

/// Looks at the tables of a model's elements, joints and functionals.
pub struct TableWatch<'p> {
    p: &'p [f64],
    parts: Vec<WatchedTable>,
    is_begun: bool,
}

fn places(model: &Model, lists: &[fn(usize) -> Place], nodes: &[NodeId], parameters: &Range<usize>) -> Vec<Place> {
    let dofs = || nodes.iter().flat_map(|&node| model.node(node).dofs.clone());
    let state = lists.iter().flat_map(|list| dofs().map(list));
    state.chain(parameters.clone().map(Place::P)).chain([Place::Time]).collect()
}

impl<'p> TableWatch<'p> {
    pub fn new(prepared: &'p Prepared) -> Self {
        let (model, mut parts) = (prepared.model(), Vec::new());
        let mut add = |name: &str, times: Times, formula: &Formula, places: &dyn Fn() -> Vec<Place>| {
            if let Some((ranges, program)) = formula.table_arguments() {
                let left = vec![None; ranges.len()];
                parts.push(WatchedTable { part: name.into(), times, ranges, program, places: places(), left });
            }
        };
        for own in &model.elements {
            let lists: &[fn(usize) -> Place] = &[Place::A, Place::V, Place::Q];
            add(&own.name, Times::Run, own.physics.residual(), &|| places(model, lists, &own.nodes, &own.parameters));
        }
        for own in &model.constraints {
            let lists: &[fn(usize) -> Place] = &[Place::V, Place::Q];
            add(&own.name, Times::Run, own.physics.formula(), &|| places(model, lists, &own.nodes, &own.parameters));
        }
        for own in prepared.functionals() {
            if let Some((formula, places)) = own.formula(model) {
                add(&own.name, own.over.times(), &formula, &|| places.clone());
            }
        }
        TableWatch { p: &prepared.mechanism.numbers.p, parts, is_begun: false }
    }

    pub fn add(&mut self, Sample { t, at, mu, .. }: &Sample<f64>) {
        let value = |place: &Place| match *place {
            Place::A(dof) => at.a[dof],
            Place::V(dof) => at.v[dof],
            Place::Q(dof) => at.q[dof],
            Place::Mu(row) => mu[row],
            Place::P(index) => self.p[index],
            Place::Time => *t,
        };
        let is_begun = std::mem::replace(&mut self.is_begun, true);
        for WatchedTable { times, ranges, program, places, left, .. } in &mut self.parts {
            match times {
                Times::Start if is_begun => continue,
                // until a later one comes
                Times::End => left.fill(None),
                _ => {}
            }
            let inputs: Vec<f64> = places.iter().map(value).collect();
            let mut numbers = vec![0.0; ranges.len()];
            program.run_in(&inputs, &mut numbers, &mut ProgramWork::default());
            for ((x, [first, last]), left) in numbers.into_iter().zip(ranges).zip(left) {
                let beyond = |x: f64| (*first - x).max(x - *last);
                if beyond(x) > 0.0 {
                    let (_, most) = left.get_or_insert((*t, x));
                    *most = if beyond(x) > beyond(*most) { x } else { *most };
                }
            }
        }
    }

    /// Which tables were left.
    pub fn in_words(&self) -> Vec<String> {
        let words = |own: &WatchedTable| -> Vec<String> {
            let left = own.ranges.iter().zip(&own.left).filter_map(|(range, left)| Some((range, (*left)?)));
            let sentence = |([first, last], (t, most)): (&TableRange, (f64, f64))| {
                let [first, last, most, t] = [*first, *last, most, t].map(shortest);
                format!(
                    "\"{}\" reads a table beyond its points from t = {t} s on: at {most} for points from {first} to {last}; there it is \
                     extrapolated, as its key extrapolation or its interpolation says: give it more points, or see that the motion stays within",
                    own.part
                )
            };
            left.map(sentence).collect()
        };
        self.parts.iter().flat_map(words).collect()
    }
}
