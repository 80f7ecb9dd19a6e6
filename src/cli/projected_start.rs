//! What the projection of a start made of what was given.

use super::columns::moving;
use super::console::count;
use super::summary::Summary;
use crate::io::{Cell, Table, cells, number};
use costate::elements::{Frame, NodeKind};
use costate::integrators::StartRecord;
use costate::program::tolerances::CONSISTENT;
use costate::scalar::{SpatialVector, Vector3};
use costate::scenes::Prepared;
use serde_json::{Value, json};

/// A vector of coordinates and velocities.
type Measure<'m> = &'m dyn Fn(&[f64], &[f64]) -> Vector3<f64>;

/// What was given of a part and what it begins with, where these are not the same.
pub struct Change {
    part: String,
    what: &'static str,
    unit: &'static str,
    given: Vec<f64>,
    used: Vec<f64>,
}

/// The projection of a start, where one was asked for.
pub struct ProjectedStart {
    changes: Vec<Change>,
    /// Parts that keep rates that were given.
    kept: Vec<String>,
}

const SHOWN: usize = 20;

/// One quantity of a node: what it is, its unit, given and used.
type Pair = (&'static str, &'static str, [Vec<f64>; 2]);

/// Place, orientation, velocity and angular velocity of a node, or its free coordinates and their rates.
fn pairs(kind: NodeKind, [q, used_q]: [&[f64]; 2], [v, used_v]: [&[f64]; 2]) -> Vec<Pair> {
    if let NodeKind::Coordinates(_) = kind {
        return vec![("value", "", [q.into(), used_q.into()]), ("rate", "1/s", [v.into(), used_v.into()])];
    }
    let both = |of: Measure| [of(q, v), of(used_q, used_v)].map(|own| own.components().to_vec());
    let place = both(&|q, _| kind.position(q, Vector3::zeros()));
    let velocity = both(&|q, v| kind.velocity(v, q, Vector3::zeros()));
    let mut all = vec![("place", "m", place), ("velocity", "m/s", velocity)];
    if kind.has_axes() {
        // the turn from one to the other, as small turns are added: half the sum of x_i x x_i'
        let [from, to] = [q, used_q].map(|q| Frame::of(kind, q).axes);
        let turn = from.iter().zip(&to).fold(Vector3::zeros(), |sum, (from, to)| sum + from.cross(to) * 0.5);
        all.push(("turn", "rad", [vec![0.0; 3], turn.components().to_vec()]));
        all.push(("angular velocity", "rad/s", both(&|q, v| kind.angular_velocity(v, q))));
    }
    all
}

fn largest<'n>(numbers: impl IntoIterator<Item = &'n f64>) -> f64 {
    numbers.into_iter().fold(0.0, |most: f64, own| most.max(own.abs()))
}

impl ProjectedStart {
    /// What the start of a run tells.
    pub fn of(prepared: &Prepared, start: &StartRecord<f64>) -> Option<Self> {
        let record = start.velocity_projection.as_ref()?;
        let (v, used_q) = (&record.base.v, &record.base.q);
        let q = start.position_projection.as_ref().map_or(used_q, |own| &own.base.q);
        let used_v: Vec<f64> = v.iter().zip(&record.unknowns.x).map(|(v, w)| v + w).collect();
        let nodes: Vec<_> = moving(prepared.model()).collect();
        let all = nodes.iter().flat_map(|node| {
            let own = |x: &'_ [f64]| x[node.dofs.clone()].to_vec();
            let [q, used_q, v, used_v] = [q, used_q, v, &used_v].map(|x| own(x));
            pairs(node.kind, [&q, &used_q], [&v, &used_v]).into_iter().map(|pair| (node.name.clone(), pair))
        });
        let all: Vec<(String, Pair)> = all.collect();
        // rates of rest are compared with those by which something comes as far as it is large, or turns, within the run
        let end = prepared.grid.times[prepared.grid.steps()];
        let length = largest(all.iter().filter(|own| own.1.0 == "place").flat_map(|own| &own.1.2[1]));
        let size = |unit: &str| {
            let least = match unit {
                "m" => length,
                "m/s" => length / end,
                "rad" => 1.0,
                _ => 1.0 / end,
            };
            all.iter().filter(|own| own.1.1 == unit).fold(least, |most, own| most.max(largest(own.1.2.iter().flatten())))
        };
        let (mut changes, mut kept) = (Vec::new(), Vec::new());
        for (part, (what, unit, [given, used])) in &all {
            let apart: Vec<f64> = given.iter().zip(used).map(|(given, used)| used - given).collect();
            if largest(&apart) > CONSISTENT * size(unit) {
                let (part, given, used) = (part.clone(), given.clone(), used.clone());
                changes.push(Change { part, what, unit, given, used });
            } else if unit.ends_with("/s") && largest(given) > 0.0 {
                kept.push(part.clone());
            }
        }
        kept.dedup();
        Some(ProjectedStart { changes, kept })
    }

    /// A table of what was given and what is used, and which rates stay.
    pub fn summary(&self) -> Summary {
        let mut summary = Summary::default();
        if self.changes.is_empty() {
            summary.words("project_start: the start fits the constraints as it is given\n");
            return summary;
        }
        summary.table("What the projection of the start changed", self.table(SHOWN));
        if let more @ 1.. = self.changes.len().saturating_sub(SHOWN) {
            summary.words(format!("and {} more", count(more, "change")));
        }
        match self.kept.len() {
            0 => {}
            1..=SHOWN => summary.words(format!("rates that stay as they are given: {}\n", self.kept.join(", "))),
            kept => summary.words(format!("rates that stay as they are given: of {}\n", count(kept, "part"))),
        }
        summary
    }

    fn table(&self, most: usize) -> Table {
        let titles = ["project_start", "", "given", "used", "unit"];
        let mut table = Table::new(&titles).keyed(&["part", "quantity", "given", "used", "unit"]);
        let cell = |numbers: &[f64]| match numbers {
            [one] => Cell::of(number(*one), numbers),
            all => Cell::of(format!("({})", all.iter().map(|own| number(*own)).collect::<Vec<_>>().join(", ")), numbers),
        };
        for Change { part, what, unit, given, used } in self.changes.iter().take(most) {
            table.row(cells![part, *what, cell(given), cell(used), *unit]);
        }
        table
    }

    pub fn json(&self) -> Value {
        json!({"changes": self.table(usize::MAX).json(), "rates_kept": self.kept})
    }
}
