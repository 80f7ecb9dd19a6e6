//! Motions as a page plays them: places of all vertices at some times, as whole numbers within the box around all of them.

use super::{Page, floats};
use crate::io::base64;
use crate::motions::{View, extent};
use costate::scenes::{Drawn, Solids};
use serde_json::{Value, json};

/// Bytes for the places and stresses of all motions of a page: in the file a third more.
const ROOM: usize = 5_000_000;
const MOST_FRAMES: usize = 400;
const FEWEST_FRAMES: usize = 12;
const NO_PART: usize = u32::MAX as usize;
/// The whole number that stands for no stress.
const NONE: u16 = u16::MAX;

/// A motion: the coordinates of the mechanism at some times.
pub struct Clip<'c> {
    /// Its name in the list of motions.
    pub name: String,
    /// A mode of vibration, which is played over and over.
    pub swings: bool,
    /// Times \[s\] and coordinates, in order.
    pub moments: Vec<(f64, &'c [f64])>,
}

/// Whole numbers between the least and the largest of some numbers.
fn quantized(values: &[f64]) -> Value {
    let (least, most) = values
        .iter()
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &value| (value.min(least), value.max(most)));
    let step = (most - least) / f64::from(NONE - 1);
    let number = |value: f64| match value {
        value if !value.is_finite() => NONE,
        _ if step > 0.0 => ((value - least) / step).round() as u16,
        _ => 0,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|&value| number(value).to_le_bytes()).collect();
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    json!({"least": finite(least), "step": finite(step), "numbers": base64(&bytes)})
}

impl Page {
    /// The mechanism in space with its motions, seen first from a side.
    pub fn space(&mut self, solids: &Solids, view: View, clips: &[Clip]) {
        if solids.is_empty() {
            return;
        }
        let whole = |numbers: Vec<usize>| -> Value {
            base64(&numbers.into_iter().flat_map(|number| (number as u32).to_le_bytes()).collect::<Vec<u8>>()).into()
        };
        let rods = solids
            .rods
            .iter()
            .map(|rod| json!({"link": rod.drawn == Drawn::Link, "part": rod.part, "vertices": rod.vertices}));
        let followed = solids.followed.iter().map(|(name, vertex)| json!({"name": name, "vertex": vertex}));
        let space = json!({
            "count": solids.count(),
            "view": format!("{view:?}"),
            "triangles": whole(solids.triangles.iter().flatten().copied().collect()),
            "edges": whole(solids.edges.iter().flatten().copied().collect()),
            "rods": rods.collect::<Vec<_>>(),
            "points": solids.points,
            "parts": solids.parts,
            "solids": whole(solids.parts_of_vertices().iter().map(|part| part.unwrap_or(NO_PART)).collect()),
            "followed": followed.collect::<Vec<_>>(),
            "anchors": solids.anchors,
        });
        self.object.insert("space".into(), space);
        let each = solids.count() * if solids.have_stress() { 8 } else { 6 };
        let frames = (ROOM / each.max(1) / clips.len().max(1)).clamp(FEWEST_FRAMES, MOST_FRAMES);
        for clip in clips {
            self.clip(solids, clip, frames);
        }
    }

    fn clip(&mut self, solids: &Solids, clip: &Clip, most: usize) {
        let all = clip.moments.len();
        let count = most.min(all);
        // evenly, the first and the last included
        let places = (0..count).map(|k| if count > 1 { k * (all - 1) / (count - 1) } else { 0 });
        let chosen: Vec<&(f64, &[f64])> = places.map(|place| &clip.moments[place]).collect();
        if count < all {
            self.note(format!("The motion is shown at {count} of {all} kept times, with straight lines between them."));
        }
        let positions: Vec<[f64; 3]> = chosen.iter().flat_map(|(_, q)| solids.positions(q)).collect();
        let axes: Vec<Value> =
            (0..3).map(|k| quantized(&positions.iter().map(|point| point[k]).collect::<Vec<f64>>())).collect();
        let mut object = json!({
            "name": clip.name,
            "swings": clip.swings,
            "times": floats(chosen.iter().map(|moment| moment.0)),
            "axes": axes,
        });
        if solids.have_stress() && !clip.swings {
            let stresses: Vec<f64> = chosen.iter().flat_map(|(_, q)| solids.stresses(q)).collect();
            if extent(stresses.iter().copied().filter(|stress| stress.is_finite())) > 0.0 {
                object["stress"] = quantized(&stresses);
            }
        }
        self.push("clips", object);
    }

    /// Something to colour by that does not change with time: a number for each vertex.
    pub fn colouring(&mut self, name: String, unit: String, of_vertices: &[f64]) {
        if of_vertices.iter().any(|value| value.is_finite() && *value != 0.0) {
            self.push("colourings", json!({"name": name, "unit": unit, "values": floats(of_vertices.iter().copied())}));
        }
    }
}
