//! Histories as charts.

use super::columns::{Columns, courses, moving};
use super::motions::extent;
use super::snapshot::{Snapshot, thinned};
use crate::io::{Chart, Series, Style};
use costate::assembly::{Node, NodeId};
use costate::elements::Output;
use costate::functionals::Measured;
use costate::scenes::Prepared;

/// A joint whose load is below this share of the largest, a moment being a force by the size of the mechanism, carries none.
const NO_LOAD: f64 = 1e-9;
/// Most curves of one chart.
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
    let (model, mut charts) = (prepared.model(), Vec::new());
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
        if series.iter().any(|series| extent(series.points.iter().map(|point| point.1)) > 1e-9) {
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

/// Forces and moments of springs, dampers and elements, and the numbers of each state.
fn charts_of_outputs(moments: &[Snapshot], columns: &Columns) -> Vec<Chart> {
    let all = || columns.outputs.iter().enumerate();
    let mut panels: Vec<(String, Vec<usize>)> = Vec::new();
    for (place, (owner, Output { name, unit })) in all() {
        let label = match *unit {
            "N" => "forces of springs, dampers and elements [N]".into(),
            "N m" => "moments of springs and elements [N m]".into(),
            "" if !name.contains("/dt") && columns.is_state(owner) => (*owner).to_string(),
            _ => continue,
        };
        match panels.iter_mut().find(|own| own.0 == label) {
            Some(own) => own.1.push(place),
            None => panels.push((label, vec![place])),
        }
    }
    let chart = |(label, mut places): (String, Vec<usize>)| {
        let peak = |place: usize| moments.iter().fold(0.0, |most: f64, moment| most.max(moment.outputs[place].abs()));
        let all = places.len();
        // the largest, in the order of their columns
        places.sort_by(|&a, &b| peak(b).total_cmp(&peak(a)));
        places.truncate(MOST_CURVES);
        let largest = peak(*places.first()?);
        places.retain(|&place| peak(place) > NO_LOAD * largest);
        places.sort_unstable();
        let series = places.into_iter().map(|place| {
            let (owner, Output { name, .. }) = &columns.outputs[place];
            let name = if columns.is_state(owner) {
                name.to_string()
            } else if name == "force" || name == "moment" {
                (*owner).to_string()
            } else {
                format!("{owner}.{name}")
            };
            curve(moments, name, |moment| moment.outputs[place])
        });
        let series: Vec<Series> = series.collect();
        (!series.is_empty()).then(|| panel(label, series, all))
    };
    panels.into_iter().filter_map(chart).collect()
}

/// Forces and moments of joints of a mechanism of a size.
fn charts_of_joints(moments: &[Snapshot], joints: &[&str], size: f64) -> Vec<Chart> {
    let mut charts = Vec::new();
    let peak = |k: usize, kind: usize| moments.iter().fold(0.0, |most: f64, moment| most.max(moment.loads[k][kind]));
    let [force, moment] = [0, 1].map(|kind| (0..joints.len()).fold(0.0, |most: f64, k| most.max(peak(k, kind))));
    // moments of a planar mechanism's hinges are what rounding leaves of its forces
    let least = [force + moment / size, moment + force * size].map(|scale| NO_LOAD * scale);
    for (kind, y_label) in ["forces of joints [N]", "moments of joints [N m]"].into_iter().enumerate() {
        let mut peaks: Vec<(usize, f64)> = (0..joints.len()).map(|k| (k, peak(k, kind))).collect();
        peaks.retain(|own| own.1 > least[kind]);
        let all = peaks.len();
        if all > MOST_CURVES {
            peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
            peaks.truncate(MOST_CURVES);
            peaks.sort_unstable_by_key(|own| own.0);
        }
        let series: Vec<Series> =
            peaks.into_iter().map(|(k, _)| curve(moments, joints[k].into(), |moment| moment.loads[k][kind])).collect();
        if !series.is_empty() {
            let title =
                if all > MOST_CURVES { format!("{y_label}: the {MOST_CURVES} largest of {all}") } else { String::new() };
            charts.push(Chart { title, ..panel(y_label.into(), series, 0) });
        }
    }
    charts
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
