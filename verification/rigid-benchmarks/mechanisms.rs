//! Mechanisms with sliders, a screw, a universal joint and gears, against closed forms and laws of conservation.

use super::loops::{Conserved, conserved};
use super::{end_state, place, prepare, watch, worse};
use crate::Report;
use costate::history::Watch;
use costate::integrators::StepRecord;
use costate::internals::march;
use costate::scalar::{Quaternion, SpatialVector, Vector3};
use costate::scenes::{AnyScene, Prepared, built_in};
use std::f64::consts::TAU;

/// Initial value of a scene's design variable.
fn initial(scene: &dyn AnyScene, name: &str) -> Result<f64, String> {
    let found = scene.variables().into_iter().find(|variable| variable.name == name);
    found.map(|variable| variable.initial).ok_or(format!("no variable {name}"))
}

/// Angular velocity in world components [rad/s].
fn omega(q: &[f64], v: &[f64]) -> Vector3<f64> {
    let e = Quaternion::from_slice(&q[3..]);
    e.rotate(e.g_times(Quaternion::from_slice(&v[3..])) * 2.0)
}

/// Angular momentum of all rigid bodies about the vertical through the origin [kg m2/s].
fn vertical_momentum(prepared: &Prepared, q: &[f64], v: &[f64]) -> f64 {
    let (model, p) = (prepared.model(), &prepared.mechanism.numbers.p);
    let mut sum = 0.0;
    // each body's inertia is named after its node; its parameters: mass, mass centre, moments and products of inertia
    for element in model.elements.iter().filter(|element| element.parameters.len() == 10) {
        let Some(node) = model.nodes.iter().find(|node| element.name.starts_with(&node.name)) else { return f64::NAN };
        let dofs = node.dofs.clone();
        let (q, v) = (&q[dofs.clone()], &v[dofs]);
        let [mass, cx, cy, cz, xx, yy, zz, ..] = p[element.parameters.clone()] else { unreachable!() };
        let (e, omega) = (Quaternion::from_slice(&q[3..]), omega(q, v));
        let arm = e.rotate(Vector3::new(cx, cy, cz));
        let velocity = Vector3::first_three(v) + omega.cross(&arm);
        let [x, y, z] = e.rotate_back(omega).components();
        let spin = e.rotate(Vector3::new(xx * x, yy * y, zz * z));
        sum += ((Vector3::first_three(q) + arm).cross(&(velocity * mass)) + spin)[2];
    }
    sum
}

/// Two methods and steps against each other; nothing has a moment about the vertical, so the angular momentum stays.
pub fn flyball_governor(report: &mut Report) -> Result<(), String> {
    let scene = built_in::named("flyball-governor")?;
    let prepared = prepare(scene, "esdirk5", 10.0, 20_000)?;
    let slider = place(&prepared, "slider")?;
    let shaft = place(&prepared, "shaft")?;
    let numbers = &prepared.mechanism.numbers;
    let start = vertical_momentum(&prepared, &numbers.q, &numbers.v);
    let mut change = 0.0;
    watch(&prepared, |_, _, q, v| {
        change = worse(change, (vertical_momentum(&prepared, q, v) - start).abs() / start);
        true
    })?;
    report.at_most("iftomm-a05/largest change of the angular momentum over 10 s, relative", change, 1e-9);
    let figures = |table: &str, steps: usize| -> Result<[f64; 2], String> {
        let [q, v] = end_state(&prepare(scene, table, 10.0, steps)?)?;
        Ok([q[slider + 2], omega(&q[shaft..], &v[shaft..])[2]])
    };
    let (fine, coarse, other) = (figures("esdirk5", 20_000)?, figures("esdirk5", 10_000)?, figures("esdirk4", 20_000)?);
    for (k, what) in ["height of the slider at 10 s [m]", "rate of the shaft at 10 s [rad/s]"].into_iter().enumerate() {
        report.at_most(
            format!("iftomm-a05/{what}, change of the reference by halving its step"),
            (fine[k] - coarse[k]).abs(),
            1e-7,
        );
        report.compare(format!("iftomm-a05/{what}"), other[k], fine[k], 1e-6);
    }
    Ok(())
}

/// Order 4, h = 0.5 ms: the slider's place and speed are those of the crank's angle and rate; energy; published places.
pub fn spatial_slider_crank(report: &mut Report) -> Result<(), String> {
    const STEPS: usize = 10_000;
    let scene = built_in::named("spatial-slider-crank")?;
    let prepared = prepare(scene, "sdirk4", 5.0, STEPS)?;
    let (crank, slider) = (place(&prepared, "crank")?, place(&prepared, "slider")?);
    // the bearing of the crank, and the lengths
    let ([beside, above], [length, rod]) = ([0.1, 0.12], [initial(scene, "crank length")?, initial(scene, "rod length")?]);
    let (mut place_error, mut speed_error) = (0.0, 0.0);
    let mut rows = Vec::new();
    watch(&prepared, |step, _, q, v| {
        let (sine, cosine) = (2.0 * q[crank + 4].atan2(q[crank + 3])).sin_cos();
        let (y, z) = (beside - length * sine, above + length * cosine);
        let x = (rod * rod - y * y - z * z).sqrt();
        let rate = omega(&q[crank..], &v[crank..])[0];
        let speed = (y * length * cosine + z * length * sine) * rate / x;
        place_error = worse(place_error, (q[slider] - x).abs());
        speed_error = worse(speed_error, (v[slider] - speed).abs());
        if step % (STEPS / 50) == 0 {
            rows.push(q[slider]);
        }
        true
    })?;
    report.at_most("spatial slider-crank/slider from the crank's angle, largest error [m]", place_error, 1e-12);
    report.at_most("spatial slider-crank/its speed from the crank's rate, largest error [m/s]", speed_error, 1e-11);
    let Conserved { energy, worst } = conserved(&prepared)?;
    report.at_most("spatial slider-crank/largest change of energy by the range of the potential energy", energy, 1e-8);
    report.at_most("spatial slider-crank/largest |g|", worst.position, 1e-13);
    // a solution in the benchmark's library; others there differ from it and from each other by up to 2e-2 m after 5 s
    for (tenth, gonzalez) in [(10, 0.211754668), (30, 0.228450093), (50, 0.240761815)] {
        let time = tenth as f64 / 10.0;
        report.compare(format!("spatial slider-crank/slider at {time} s, Gonzalez [m]"), rows[tenth - 1], gonzalez, 1e-4);
    }
    Ok(())
}

/// Order 4, h = 1 ms: output angle and rate in closed form, the driving moment from the balance of power.
pub fn universal_shaft(report: &mut Report) -> Result<(), String> {
    let scene = built_in::named("universal-shaft")?;
    let (bend, rate) = (initial(scene, "bend")?, initial(scene, "rate")?);
    let (inertia, brake) = (initial(scene, "inertia of the output")?, initial(scene, "braking torque")?);
    let prepared = prepare(scene, "sdirk4", 3.0, 3_000)?;
    report.compare("universal shaft/equations left out", prepared.plan.dropped.len() as f64, 3.0, 0.0);
    let output = place(&prepared, "output")?;
    let drive = prepared.model().constraints.iter().find(|joint| joint.name == "drive").ok_or("no drive")?;
    let multiplier = drive.equations.start;
    let start = Quaternion::from_slice(&prepared.mechanism.numbers.q[output + 3..]);
    let (cosine, sine) = (bend.cos(), bend.sin());
    // output rate and its derivative over the input's angle, by the input's rate and its square
    let ratio = |input: f64| cosine / (1.0 - (input.sin() * sine).powi(2));
    let bending = |input: f64| ratio(input).powi(2) / cosine * sine * sine * (2.0 * input).sin();
    let [mut angle_error, mut rate_error, mut moment_error] = [0.0; 3];
    let mut watch = Watch(|step: &StepRecord<f64>| {
        let input = rate * (step.t + step.h);
        let [scalar, x, ..] = start.conjugate().times(Quaternion::from_slice(&step.q[output + 3..])).0;
        let exact = (cosine * input.sin()).atan2(input.cos());
        let apart = 2.0 * x.atan2(scalar) - exact;
        angle_error = worse(angle_error, (apart - TAU * (apart / TAU).round()).abs());
        let turning = omega(&step.q[output..], &step.v[output..]);
        let along = turning[0] * cosine + turning[2] * sine;
        rate_error = worse(rate_error, (along - ratio(input) * rate).abs());
        if let Some(stage) = step.stages.last() {
            let input = rate * stage.solve.t;
            let exact = (inertia * bending(input) * rate * rate + brake) * ratio(input);
            moment_error = worse(moment_error, (-stage.solve.unknowns.mu[multiplier] - exact).abs());
        }
        true
    });
    march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch).map_err(|e| e.to_string())?;
    report.at_most("universal shaft/output angle, largest error [rad]", angle_error, 1e-12);
    report.at_most("universal shaft/output rate, largest error [rad/s]", rate_error, 1e-10);
    report.at_most("universal shaft/driving moment, largest error [N m]", moment_error, 1e-6);
    Ok(())
}

/// Order 5, h = 0.5 ms: the nut's fall is g m / (m + J (2 pi / pitch)^2) t^2 / 2, and it turns with it.
pub fn screw(report: &mut Report) -> Result<(), String> {
    let scene = built_in::named("screw")?;
    let [mass, inertia, pitch] = [initial(scene, "mass")?, initial(scene, "inertia")?, initial(scene, "pitch")?];
    let prepared = prepare(scene, "esdirk5", 1.5, 3_000)?;
    let nut = place(&prepared, "nut")?;
    let acceleration = -9.81 * mass / (mass + inertia * (TAU / pitch).powi(2));
    let [mut place_error, mut angle_error, mut rate_error] = [0.0; 3];
    watch(&prepared, |_, t, q, v| {
        let height = acceleration * t * t / 2.0;
        place_error = worse(place_error, (q[nut + 2] - height).abs());
        let apart = 2.0 * q[nut + 6].atan2(q[nut + 3]) - TAU * height / pitch;
        angle_error = worse(angle_error, (apart - TAU * (apart / TAU).round()).abs());
        rate_error = worse(rate_error, (omega(&q[nut..], &v[nut..])[2] - TAU * acceleration * t / pitch).abs());
        true
    })?;
    report.at_most("screw/height of the nut over 1.5 s, largest error [m]", place_error, 1e-9);
    report.at_most("screw/its angle, largest error [rad]", angle_error, 1e-7);
    report.at_most("screw/its rate, largest error [rad/s]", rate_error, 1e-7);
    Ok(())
}

/// Order 5, h = 0.5 ms: the rack falls with g m / (m + (J1 + J2 (r1 / r2)^2) / r^2), the flywheel turns against the pinion.
pub fn gear_train(report: &mut Report) -> Result<(), String> {
    let scene = built_in::named("gear-train")?;
    let own = |name: &str| initial(scene, name);
    let (mass, radius) = (own("rack mass")?, own("pinion radius")?);
    let ratio = own("first gear radius")? / own("second gear radius")?;
    let inertia = own("inertia of the first shaft")? + own("inertia of the flywheel")? * ratio * ratio;
    let acceleration = -9.81 * mass / (mass + inertia / (radius * radius));
    let prepared = prepare(scene, "esdirk5", 1.0, 2_000)?;
    let (rack, angle) = (place(&prepared, "rack")?, place(&prepared, "angle of the flywheel")?);
    let [mut place_error, mut angle_error] = [0.0; 2];
    watch(&prepared, |_, t, q, _| {
        let height = acceleration * t * t / 2.0;
        place_error = worse(place_error, (q[rack + 1] - height).abs());
        // the rack is on the left of the pinion: falling, it turns it to the left
        angle_error = worse(angle_error, (q[angle] - height / radius * ratio).abs());
        true
    })?;
    report.at_most("gear train/height of the rack over 1 s, largest error [m]", place_error, 1e-9);
    report.at_most("gear train/angle of the flywheel, largest error [rad]", angle_error, 1e-7);
    Ok(())
}
