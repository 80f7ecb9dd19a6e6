mod andrews;
mod loops;
mod mechanisms;

use crate::{Report, Study};
use costate::history::Watch;
use costate::integrators::{ConstraintLevel, DEFAULT_TABLE, Method, RunError, StepRecord, table_by_name};
use costate::internals::march;
use costate::scalar::{Quaternion, SpatialVector, Vector3};
use costate::scenes::{AnyScene, Prepared, Settings, Violation, built_in};

pub use andrews::{angles_of_turns, body_angles, places_of_bodies};

/// Rigid mechanisms against closed forms, published end values and recomputed gradients.
pub struct RigidBenchmarks;

impl Study for RigidBenchmarks {
    fn name(&self) -> &'static str {
        "rigid-benchmarks"
    }
    fn summary(&self) -> &'static str {
        "rigid mechanisms against closed forms, published values and gradients; constraints over 100,000 steps"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let parts: [(&str, Part); 14] = [
            ("pendulum, IFToMM A01", pendulum),
            ("two four-bar linkages, IFToMM A02", two_four_bar),
            ("car axis", car_axis),
            ("torque-free body", free_body),
            ("heavy top", heavy_top),
            ("five-bar gradient", five_bar),
            ("Andrews' squeezer", andrews::andrews),
            ("Bricard's mechanism, IFToMM A04", loops::bricard),
            ("flyball governor, IFToMM A05", mechanisms::flyball_governor),
            ("spatial slider-crank", mechanisms::spatial_slider_crank),
            ("universal shaft", mechanisms::universal_shaft),
            ("screw", mechanisms::screw),
            ("gear train", mechanisms::gear_train),
            ("constraints over 100,000 steps", constraint_drift),
        ];
        for (index, (title, part)) in parts.iter().enumerate() {
            eprintln!("[{}/{}] {title}", index + 1, parts.len());
            part(report).map_err(|error| format!("{title}: {error}"))?;
        }
        Ok(())
    }
}

/// Measures one problem.
type Part = fn(&mut Report) -> Result<(), String>;

/// A scene at its initial design with a table at acceleration level.
fn prepare<'s>(scene: &'s dyn AnyScene, table: &str, end: f64, steps: usize) -> Result<Prepared<'s>, String> {
    let table = table_by_name(table).ok_or_else(|| format!("no integrator is named \"{table}\""))?;
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let settings = Settings { end, steps, ..scene.settings().without_method() };
    Prepared::with(scene, &x, Method::new(table, ConstraintLevel::Acceleration), settings).map_err(|e| e.to_string())
}

/// Runs without a history: `each` sees the number of finished steps, time, q and v, and returns `false` to stop.
fn watch(prepared: &Prepared, mut each: impl FnMut(usize, f64, &[f64], &[f64]) -> bool) -> Result<(), String> {
    let mut steps = 0;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        steps += 1;
        each(steps, step.t + step.h, &step.q, &step.v)
    });
    match march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch) {
        Ok(_) | Err(RunError::Interrupted { .. }) => Ok(()),
        Err(error) => Err(error.to_string()),
    }
}

/// q and v at the end of a run.
fn end_state(prepared: &Prepared) -> Result<[Vec<f64>; 2], String> {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    watch(prepared, |_, _, q_end, v_end| {
        q = q_end.to_vec();
        v = v_end.to_vec();
        true
    })?;
    Ok([q, v])
}

/// Place of a named node's first coordinate.
fn place(prepared: &Prepared, node: &str) -> Result<usize, String> {
    let found = prepared.model().nodes.iter().find(|own| own.name == node);
    found.map(|node| node.dofs.start).ok_or_else(|| format!("no node is named \"{node}\""))
}

/// Rows (t, x, y) of a reference file with one line of headings.
fn rows(csv: &str) -> Result<Vec<[f64; 3]>, String> {
    csv.lines()
        .skip(1)
        .map(|line| {
            let numbers: Result<Vec<f64>, _> = line.split(',').map(|cell| cell.trim().parse::<f64>()).collect();
            numbers.ok().and_then(|row| row.try_into().ok()).ok_or_else(|| format!("not three numbers: \"{line}\""))
        })
        .collect()
}

/// Order 4: 100 steps per row of the reference, h = 1 ms.
fn pendulum(report: &mut Report) -> Result<(), String> {
    const STEPS_PER_ROW: usize = 100;
    let reference = rows(include_str!("iftomm_a01_pendulum.csv"))?;
    let prepared = prepare(built_in::named("pendulum")?, "sdirk4", 10.0, STEPS_PER_ROW * (reference.len() - 1))?;
    let first = place(&prepared, "bob")?;
    let mut largest: f64 = 0.0;
    watch(&prepared, |step, _, q, _| {
        if step.is_multiple_of(STEPS_PER_ROW) {
            let [_, x, y] = reference[step / STEPS_PER_ROW];
            largest = worse(largest, (q[first] - x).hypot(q[first + 1] - y));
        }
        true
    })?;
    report.at_most("iftomm-a01/largest position error over 10 s", largest, 1e-8);
    Ok(())
}

/// The larger of two errors; a NaN wins, so that it is seen.
fn worse(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

/// Order 4, h = 0.5 ms, up to the first pose with all links in one line; then on, to see what happens there.
fn two_four_bar(report: &mut Report) -> Result<(), String> {
    const STEPS_PER_ROW: usize = 200;
    let reference = rows(include_str!("iftomm_a02_two_four_bar.csv"))?;
    let prepared = prepare(built_in::named("two-four-bar")?, "sdirk4", 10.0, STEPS_PER_ROW * (reference.len() - 1))?;
    let first = place(&prepared, "vertical 0")?;
    // B0 is one metre from A0 along the body's x axis
    let head = |q: &[f64]| {
        let middle = Vector3::first_three(&q[first..]);
        middle + Quaternion::from_slice(&q[first + 3..]).rotate(Vector3::new(0.5, 0.0, 0.0))
    };
    let (mut before, mut after) = (0.0, 0.0);
    let mut singular_at = None;
    let (mut last, mut reached) = (1.0, 0.0);
    let ended = watch(&prepared, |step, t, q, _| {
        let [x, y, _] = head(q).components();
        if singular_at.is_none() && y <= 0.0 {
            // linear between the ends of the step
            singular_at = Some(t - prepared.grid.times[1] * y / (y - last));
        }
        (last, reached) = (y, t);
        if step.is_multiple_of(STEPS_PER_ROW) {
            let [_, x_exact, y_exact] = reference[step / STEPS_PER_ROW];
            let error = (x - x_exact).hypot(y - y_exact);
            let largest = if singular_at.is_none() { &mut before } else { &mut after };
            *largest = worse(*largest, error);
        }
        true
    });
    report.at_most("iftomm-a02/largest error of B0 before the first singular pose", before, 1e-6);
    let singular_at = singular_at.ok_or("the links never lay flat")?;
    report.compare("iftomm-a02/time of the first singular pose", singular_at, flat_time(), 1e-6);
    report.inform("iftomm-a02/time reached", reached);
    report.inform("iftomm-a02/largest error of B0 behind the first singular pose", after);
    if let Err(error) = ended {
        report.note(format!("IFToMM A02 behind the singular pose: {error}"));
    }
    Ok(())
}

/// Time at which the parallelogram lies flat: Simpson's rule for the integral of dtheta / theta' over a quarter turn.
///
/// On that branch energy is T + V with T = 3 m L^2 theta'^2 / 2 and V = 7/2 m g L cos(theta), and theta' = 1 at the start.
fn flat_time() -> f64 {
    // three links turn (m L^2 / 3 each), two move along (m L^2 each); m = 1 kg, L = 1 m
    let c = 2.0 * 3.5 * 9.81 / 3.0;
    let rate = |theta: f64| (1.0 + c * (1.0 - theta.cos())).sqrt();
    let n = 2000;
    let h = std::f64::consts::FRAC_PI_2 / f64::from(n);
    let weight = |i: i32| {
        if i == 0 || i == n {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        }
    };
    (0..=n).map(|i| weight(i) / rate(f64::from(i) * h)).sum::<f64>() * h / 3.0
}

/// Order 4, h = 0.1 ms; relative errors of all coordinates and velocities at t = 3.
fn car_axis(report: &mut Report) -> Result<(), String> {
    let prepared = prepare(built_in::named("car-axis")?, "sdirk4", 3.0, 30_000)?;
    let [q, v] = end_state(&prepared)?;
    let (left, right) = (place(&prepared, "left")?, place(&prepared, "right")?);
    let computed = [
        ("xl", q[left]),
        ("yl", q[left + 1]),
        ("xr", q[right]),
        ("yr", q[right + 1]),
        ("vxl", v[left]),
        ("vyl", v[left + 1]),
        ("vxr", v[right]),
        ("vyr", v[right + 1]),
    ];
    for (name, value) in computed {
        let line = include_str!("car_axis_final.csv").lines().find(|line| line.split(',').next() == Some(name));
        // the third column is the recomputed value
        let reference = line.and_then(|line| line.split(',').nth(2)?.parse().ok()).ok_or(format!("no row {name}"))?;
        report.compare(format!("car-axis/{name} at t = 3"), value, reference, 1e-9);
    }
    Ok(())
}

/// Angular velocity in the body frame: 2 G(e) de/dt [rad/s].
fn body_omega(q: &[f64], v: &[f64]) -> Vector3<f64> {
    Quaternion::from_slice(&q[3..]).g_times(Quaternion::from_slice(&v[3..])) * 2.0
}

/// Order 4, h = 1 ms.
fn free_body(report: &mut Report) -> Result<(), String> {
    let prepared = prepare(built_in::named("free-body")?, "sdirk4", 10.0, 10_000)?;
    let [q, v] = end_state(&prepared)?;
    let omega = body_omega(&q, &v).components();
    let reference = [-0.921069998444332, 0.389397044115332, 0.974400660583082];
    for (i, (value, reference)) in omega.into_iter().zip(reference).enumerate() {
        report.compare(format!("free-body/omega {} at 10 s", i + 1), value, reference, 1e-10);
    }
    Ok(())
}

/// Order 4, h = 0.5 ms.
fn heavy_top(report: &mut Report) -> Result<(), String> {
    let prepared = prepare(built_in::named("heavy-top")?, "sdirk4", 5.0, 10_000)?;
    let top = place(&prepared, "top")?;
    let [q, _] = end_state(&prepared)?;
    let axis = Quaternion::from_slice(&q[top + 3..]).rotate(Vector3::new(0.0, 0.0, 1.0)).components();
    report.compare("heavy-top/cos theta at 5 s", axis[2], 0.86326281381065, 1e-10);
    report.compare("heavy-top/phi at 5 s", axis[1].atan2(axis[0]), 1.0767309147832, 1e-10);
    Ok(())
}

/// Order 4, h = 1 ms; relative errors.
fn five_bar(report: &mut Report) -> Result<(), String> {
    let prepared = prepare(built_in::named("five-bar")?, "sdirk4", 5.0, 5_000)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).map_err(|e| e.to_string())?;
    let gradient = analysis.adjoint(&prepared.x, &forward).map_err(|e| e.to_string())?;
    report.compare("five-bar/psi", forward.values[0], 58.6382104668, 1e-8 * 58.6);
    for (name, reference) in [("L01", 32.7579734), ("k1", 0.0882896650), ("c", 1.01503782)] {
        let variable = prepared.variables.iter().position(|own| own.name == name).ok_or(format!("no variable {name}"))?;
        report.compare(format!("five-bar/d psi/d {name}"), gradient.rows[0][variable], reference, 1e-8 * reference);
    }
    Ok(())
}

/// The default method, h = 1 ms, 100,000 steps.
fn constraint_drift(report: &mut Report) -> Result<(), String> {
    const STEPS: usize = 100_000;
    for name in ["double-pendulum", "heavy-top"] {
        let prepared = prepare(built_in::named(name)?, DEFAULT_TABLE, 100.0, STEPS)?;
        let mut worst = Violation::default();
        watch(&prepared, |step, t, q, v| {
            worst = worst.worse(prepared.violation(t, q, v));
            if step.is_multiple_of(STEPS / 4) {
                eprintln!("    {name}: step {step} of {STEPS}");
            }
            true
        })?;
        report.at_most(format!("{name}/largest |g| over 100,000 steps"), worst.position, 1e-13);
        report.at_most(format!("{name}/largest ||e| - 1| over 100,000 steps"), worst.norm, 1e-13);
        report.inform(format!("{name}/largest |dg/dt| over 100,000 steps"), worst.velocity);
    }
    Ok(())
}
