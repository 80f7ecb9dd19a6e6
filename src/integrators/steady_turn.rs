//! Whether a turn that is steady at the start stays so.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::RunError;
use crate::assembly::{Model, NodeId};
use crate::elements::State;
use crate::scalar::{Quaternion, SpatialVector, Vector3};
use crate::tolerances::CONSISTENT;

/// Angle by which what turns is turned on \[rad\], to see whether forces turn with it.
const ANGLE: f64 = 1.0;
/// Change of a force that is none, too, in changes that round-off of places makes of forces.
const NOISE: f64 = 30.0;

/// Checks the state at which a motion begins, in which some nodes turn steadily: it is in equilibrium in their frame.
pub(super) fn check(model: &Model, p: &[f64], [q, v]: [&[f64]; 2]) -> Result<(), RunError> {
    let Some(spin) = &model.spin else { return Ok(()) };
    let numbers = &p[spin.parameters.clone()];
    let omega = Vector3::first_three(&numbers[3..]) * numbers[6];
    let mut a = vec![0.0; model.dofs];
    for node in spin.nodes.iter().map(|node| &model.nodes[node.0]) {
        node.kind.turn(&v[node.dofs.clone()], Vector3::zeros(), omega, &mut a[node.dofs.clone()]);
    }
    let largest = a.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
    for joint in &model.constraints {
        let [a, v, q] = [&a, v, q].map(|x| gathered(model, &joint.nodes, x));
        let g = joint.physics.motion(State { a: &a, v: &v, q: &q }, &p[joint.parameters.clone()], 0.0);
        if let Some(row) = g.iter().position(|g| !(g[2].abs() <= CONSISTENT * largest)) {
            return Err(RunError::Input(format!(
                "the turn at the start is not steady: joint \"{}\", constraint {}: d2g/dt2 = {:.6e}; joints and drives must let what turns go on at the \
                 same rate",
                joint.name,
                row + 1,
                g[row][2]
            )));
        }
    }
    forces_turn(model, p, [q, v])
}

fn gathered(model: &Model, nodes: &[NodeId], x: &[f64]) -> Vec<f64> {
    nodes.iter().flat_map(|node| x[model.nodes[node.0].dofs.clone()].to_vec()).collect()
}

/// Forces must be the same, turned, when what turns is turned on.
pub(crate) fn forces_turn(model: &Model, p: &[f64], [q, v]: [&[f64]; 2]) -> Result<(), RunError> {
    let Some(spin) = &model.spin else { return Ok(()) };
    let resting = model.about_rest(true);
    let (own_p, numbers) = (resting.parameters(p), &p[spin.parameters.clone()]);
    let q = &resting.coordinates(q, v);
    let about = Vector3::first_three(numbers);
    let rotation = Quaternion::about(Vector3::first_three(&numbers[3..]), ANGLE);
    let rotated = |nodes: &[NodeId], x: &[f64], (about, rotation): (Vector3<f64>, Quaternion<f64>)| {
        let (mut turned, mut first) = (x.to_vec(), 0);
        for id in nodes {
            let places = first..first + model.nodes[id.0].dofs.len();
            first = places.end;
            if spin.nodes.contains(id) {
                model.nodes[id.0].kind.rotate(&x[places.clone()], about, rotation, &mut turned[places]);
            }
        }
        turned
    };
    let back = rotation.conjugate();
    let (mut most, mut largest, mut noise) = ((0.0, ""), 0.0_f64, 0.0_f64);
    for element in resting.model.elements.iter().filter(|own| own.nodes.iter().any(|node| spin.nodes.contains(node))) {
        let here = gathered(model, &element.nodes, q);
        let there = rotated(&element.nodes, &here, (about, rotation));
        let zeros = vec![0.0; here.len()];
        let p = &own_p[element.parameters.clone()];
        let force = |q: &[f64]| element.physics.residual_at(State { a: &zeros, v: &zeros, q }, p, 0.0);
        let own = force(&here);
        let turned = rotated(&element.nodes, &own, (Vector3::zeros(), rotation));
        // places that differ by round-off: stiff members make forces of it
        let beside = force(&rotated(&element.nodes, &there, (about, back)));
        for (((own, beside), turned), there) in own.iter().zip(beside).zip(turned).zip(force(&there)) {
            largest = largest.max(own.abs());
            noise = noise.max((own - beside).abs());
            if !((turned - there).abs() <= most.0) {
                most = ((turned - there).abs(), &element.name);
            }
        }
    }
    if !(most.0 <= (CONSISTENT * largest).max(NOISE * noise)) {
        return Err(RunError::Input(format!(
            "the turn at the start is not steady: the forces of \"{}\" change by {:.1e} of the largest one while it turns on by {ANGLE} rad; \
             what acts on parts that turn must turn with them, or act along the axis or about it",
            most.1,
            most.0 / largest
        )));
    }
    Ok(())
}
