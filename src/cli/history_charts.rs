//! Histories as charts.

use super::columns::{Columns, courses, moving};
use super::motions::extent;
use super::snapshot::{Snapshot, thinned};
use crate::io::{Chart, Series, Style};
use costate::assembly::{Node, NodeId};
use costate::elements::Output;
use costate::functionals::Measured;
use costate::scenes::Prepared;

/// Below this share of the largest load, a moment being a force by the size of the mechanism, a joint carries none; below this share of that size nothing
/// moves: no chart shows nine digits.
const NONE: f64 = 1e-9;
const MOST_CURVES: usize = 7;

/// Of many nodes those that say something by their name: what functionals measure, then what the scene made itself; all of them where
/// there are none of these.
fn telling<'p>(prepared: &'p Prepared, all: Vec<&'p Node>) -> Vec<&'p Node> {
    let model = prepared.model();
    let is_in = |ids: &[NodeId], node: &Node| ids.iter().any(|&id| model.node(id).dofs == node.dofs);
    let measured = |node: &&Node| {
        prepared.functionals().iter().any(|functional| match &functional.measured {
            // a place, velocity or angle is that of one node; stresses see those of their whole element
            Measured::Local { nodes, .. } => nodes.len() == 1 && is_in(nodes, node),
            _ => false,
        })
    };
    let (of_functionals, others): (Vec<_>, Vec<_>) = all.into_iter().partition(measured);
    let (of_members, own): (Vec<_>, Vec<_>) =
        others.into_iter().partition(|node| is_in(&prepared.mechanism.nodes_of_members, node));
    let named = [of_functionals, own].concat();
    if named.is_empty() { of_members } else { named }
}

/// One panel for each direction in which something moves, one for free coordinates, one for the energy, those of forces and moments of joints,
/// one for each unit of what functionals measure.
pub fn charts(prepared: &Prepared, moments: &[Snapshot], columns: &Columns) -> Vec<Chart> {
    let in_space = |node: &&Node| node.kind.in_space().is_some();
    let places: Vec<&Node> = moving(prepared.model()).filter(in_space).collect();
    let joints: Vec<&str> = columns.loaded_joints().collect();
    let mut charts = charts_of_places(columns, prepared, moments, &places);
    if let Some(start) = moments.first().and_then(|moment| moment.energy) {
        let drift = curve(moments, String::new(), |moment| moment.energy.unwrap_or(f64::NAN) - start);
        charts.push(panel("change of energy [J]".into(), vec![drift], 1));
    }
    // one key for all panels: a node has the same colour in each
    for chart in charts.iter_mut().skip(1).filter(|chart| !chart.y_label.starts_with("coordinates")) {
        chart.series.iter_mut().for_each(|series| series.name.clear());
    }
    charts.extend(charts_of_outputs(moments, columns));
    charts.extend(charts_of_joints(moments, &joints, size_of(moments, &places)));
    charts.extend(charts_of_quantities(prepared, moments));
    if let Some(first) = charts.first_mut() {
        let kind = if first.title.is_empty() { String::new() } else { format!(", {}", first.title) };
        first.title = format!("{}{kind}", prepared.scene.name());
        if let [only] = &mut first.series[..] {
            first.title += &format!(": {}", std::mem::take(&mut only.name));
        }
    }
    charts
}

fn curve(moments: &[Snapshot], name: String, value: impl Fn(&Snapshot) -> f64) -> Series {
    let points = thinned(moments).map(|(_, moment)| (moment.t, value(moment))).collect();
    Series { name, points, style: Style::Line }
}

fn panel(y_label: String, mut series: Vec<Series>, all: usize) -> Chart {
    series.truncate(MOST_CURVES);
    let title = if series.len() < all { format!("{y_label}: {} of {all}", series.len()) } else { String::new() };
    Chart { title, x_label: "time [s]".into(), y_label, series, ..Chart::default() }
}

/// How far nodes spread and move, 1 for those that stand in one place \[m\].
fn size_of(moments: &[Snapshot], places: &[&Node]) -> f64 {
    let along = |k| extent(moments.iter().flat_map(|m| places.iter().map(move |node| m.q[node.dofs.start + k])));
    let size = (0..3).map(along).fold(0.0, f64::max);
    if size > 0.0 { size } else { 1.0 }
}

/// Those of nodes in space and of free coordinates.
fn charts_of_places(columns: &Columns, prepared: &Prepared, moments: &[Snapshot], places: &[&Node]) -> Vec<Chart> {
    let (model, mut charts, size) = (prepared.model(), Vec::new(), size_of(moments, places));
    let all = places.len();
    let places = if all > MOST_CURVES { telling(prepared, places.to_vec()) } else { places.to_vec() };
    let label = |node: &Node| {
        let index = model.nodes.iter().position(|own| own.dofs == node.dofs);
        index.map_or_else(|| node.name.clone(), |index| prepared.mechanism.label(model.node_id(index)))
    };
    let labels: Vec<String> = places.iter().map(|node| label(node)).collect();
    for (index, direction) in ["x", "y", "z"].into_iter().enumerate() {
        let named = places.iter().zip(&labels);
        let series: Vec<Series> =
            named.map(|(node, label)| curve(moments, label.clone(), |m| m.q[node.dofs.start + index])).collect();
        if series.iter().any(|series| extent(series.points.iter().map(|point| point.1)) > NONE * size) {
            charts.push(panel(format!("{direction} [m]"), series, all));
        }
    }
    let free = columns.nodes().filter(|node| node.kind.in_space().is_none());
    let series: Vec<Series> = free
        .flat_map(|node| node.dofs.clone().map(move |dof| (format!("{} q{}", node.name, dof - node.dofs.start), dof)))
        .map(|(name, dof)| curve(moments, name, |moment| moment.q[dof]))
        .collect();
    if !series.is_empty() {
        let all = series.len();
        charts.push(panel("coordinates".into(), series, all));
    }
    charts
}

/// A number of each moment.
type Quantity<'c> = Box<dyn Fn(&Snapshot) -> f64 + 'c>;

/// A panel of the largest of some quantities, in their order, without those below the least, or below [`NONE`] of the largest; none where
/// nothing is left.
fn largest_of(moments: &[Snapshot], y_label: String, all: &[(String, Quantity)], least: Option<f64>) -> Option<Chart> {
    let peak = |own: &(String, Quantity)| moments.iter().fold(0.0, |most: f64, moment| most.max(own.1(moment).abs()));
    let mut peaks: Vec<(usize, f64)> = all.iter().map(peak).enumerate().collect();
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
    let least = least.unwrap_or(NONE * peaks.first()?.1);
    peaks.retain(|own| own.1 > least);
    let count = peaks.len();
    peaks.truncate(MOST_CURVES);
    peaks.sort_unstable_by_key(|own| own.0);
    let series = peaks.iter().map(|&(place, _)| curve(moments, all[place].0.clone(), &all[place].1)).collect();
    (count > 0).then(|| panel(y_label, series, count))
}

/// Forces and moments of springs, dampers and elements, and the numbers of each state.
fn charts_of_outputs(moments: &[Snapshot], columns: &Columns) -> Vec<Chart> {
    let mut panels: Vec<(String, Vec<(String, Quantity)>)> = Vec::new();
    for (place, (owner, Output { name, unit })) in columns.outputs.iter().enumerate() {
        let is_state = columns.is_state(owner);
        let label = match *unit {
            "N" => "forces of springs, dampers and elements [N]".into(),
            "N m" => "moments of springs and elements [N m]".into(),
            "" if !name.contains("/dt") && is_state => (*owner).to_string(),
            _ => continue,
        };
        let name = match &name[..] {
            name if is_state => name.to_string(),
            "force" | "moment" => (*owner).to_string(),
            name => format!("{owner}.{name}"),
        };
        let own: (String, Quantity) = (name, Box::new(move |moment| moment.outputs[place]));
        match panels.iter_mut().find(|own| own.0 == label) {
            Some((_, all)) => all.push(own),
            None => panels.push((label, vec![own])),
        }
    }
    panels.into_iter().filter_map(|(label, all)| largest_of(moments, label, &all, None)).collect()
}

/// Forces and moments of joints of a mechanism of a size.
fn charts_of_joints(moments: &[Snapshot], joints: &[&str], size: f64) -> Vec<Chart> {
    let loads = || moments.iter().flat_map(|moment| &moment.loads);
    let [force, moment] = [0, 1].map(|kind| loads().fold(0.0, |most: f64, own| most.max(own[kind])));
    // moments of a planar mechanism's hinges are what rounding leaves of its forces
    let least = [force + moment / size, moment + force * size].map(|scale| NONE * scale);
    let chart = |(kind, y_label): (usize, &str)| {
        let own = |(k, joint): (usize, &&str)| -> (String, Quantity) {
            ((*joint).into(), Box::new(move |moment| moment.loads[k][kind]))
        };
        let all: Vec<_> = joints.iter().enumerate().map(own).collect();
        largest_of(moments, y_label.into(), &all, Some(least[kind]))
    };
    ["forces of joints [N]", "moments of joints [N m]"].into_iter().enumerate().filter_map(chart).collect()
}

/// What has a unit of its own; places and speeds of points are seen elsewhere.
fn charts_of_quantities(prepared: &Prepared, moments: &[Snapshot]) -> Vec<Chart> {
    let loads: Vec<_> =
        courses(prepared).enumerate().filter(|(_, own)| !matches!(own.unit, "m" | "m2" | "m/s" | "-")).collect();
    let mut units: Vec<&str> = loads.iter().map(|(_, own)| own.unit).collect();
    units.sort_unstable();
    units.dedup();
    let chart = |unit| {
        let own = loads.iter().filter(|(_, functional)| functional.unit == unit);
        let series: Vec<Series> =
            own.map(|(k, functional)| curve(moments, functional.name.clone(), |moment| moment.measured[*k])).collect();
        let all = series.len();
        panel(format!("[{unit}]"), series, all)
    };
    units.into_iter().map(chart).collect()
}
