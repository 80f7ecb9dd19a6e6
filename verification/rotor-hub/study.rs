//! A rotor hub at speed: the steady start, frequencies of a turning blade, the kinematics of the swash plate, gradients through all of it.

mod blade_element;
mod flight;
mod series;
mod swash_plate;

use crate::whole_runs::{compare_with_whole_runs, inside};
use crate::{Form, Report, Study};
use costate::functionals::Sample;
use costate::integrators::RunError;
use costate::scalar::Quaternion;
use costate::scenes::{AnyScene, FileScene, Prepared, Scenario, Settings, built_in};
use series::blade_frequencies;
use std::f64::consts::TAU;
use std::time::Instant;
use swash_plate::pitch;

/// Pitch of rigid blades against their geometry \[rad\].
const PITCH: f64 = 1e-13;
/// Gaps of the joints over all turns \[m\].
const GAP: f64 = 1e-14;
/// By how much the extension changes over the first turn, as a share of it.
const STEADY: f64 = 1e-6;
/// The same of stresses.
const STRESS: f64 = 1e-3;
/// Extension of a wide blade against that of a rod, whose root is free to narrow.
const EXTENSION: f64 = 4e-3;
/// Frequencies of a turning beam against their series.
const FREQUENCY: f64 = 1e-3;
/// Southwell's coefficient of the first flapping mode.
const SOUTHWELL: f64 = 0.03;
/// Turns over which joints are watched.
const TURNS: usize = 10;

/// What the energy balance of rigid blades leaves, as a share of the works.
const BALANCE: f64 = 1e-6;
/// By what the balance of elastic blades falls at least where steps are halved: a method of third order.
const HALVED: f64 = 0.125;

/// Growth and rate of ground resonance against figures of ten digits.
const RESONANCE: f64 = 1e-8;

const HUB: &str = include_str!("../../examples/scenes/rotor-hub.toml");
const FLIGHTS: [(&str, [f64; 3]); 3] =
    [("collective", [0.05, 0.05, 0.05]), ("longitudinal", [0.025, 0.025, 0.05]), ("lateral", [0.025, 0.05, 0.025])];

/// The study.
pub struct RotorHub;

impl Study for RotorHub {
    fn name(&self) -> &'static str {
        "rotor-hub"
    }
    fn summary(&self) -> &'static str {
        "a rotor hub at speed: steady start, frequencies of a turning blade, swash plate, gradients, energy, hover, flapping"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        blade_extension(report)?;
        turning_beam(report)?;
        ground_resonance(report)?;
        swash_plate(report)?;
        flights(report)?;
        steps_and_meshes(report)?;
        flight::air_loads(report)
    }
}

/// Share of the controls after some turns: along 10 s^3 - 15 s^4 + 6 s^5 within the first one.
fn controls(turns: f64) -> f64 {
    let s = turns.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (-15.0 + 6.0 * s))
}

pub fn told(error: RunError) -> String {
    error.to_string()
}

/// A blade of shells on a driven hub.
fn blade(elements: usize) -> String {
    format!(
        "version = 1\n[variable]\nthickness = {{ initial = 0.02, bounds = [0.001, 0.05], unit = \"m\" }}\n\
         [settings]\nstart = \"steady\"\nend = \"2 * pi / 109.12\"\nsteps = 360\n[material.blade]\nyoung = 70e9\npoisson = 0.3\ndensity = 2500\n\
         [[body]]\nname = \"hub\"\nmass = 100\ninertia = [10, 10, 10]\n\
         [[joint]]\nname = \"shaft\"\ntype = \"revolute\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         [[driver]]\nname = \"motor\"\ntype = \"rotation\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         angle = {{ type = \"formula\", value = \"109.12 * t\" }}\n\
         [[shell]]\nname = \"blade\"\ntype = \"plate\"\ncorner = [0.44, -0.0605, 0]\nfirst = [1.56, 0, 0]\nsecond = [0, 0.121, 0]\n\
         elements = [{elements}, 1]\nmaterial = \"blade\"\nthickness = \"thickness\"\n\
         [[rigid_interface]]\nname = \"root\"\nbody = \"hub\"\nnodes = [\"blade.first_start\"]\n\
         [[spin]]\nparts = [\"hub\", \"blade\"]\naxis = [0, 0, 1]\nrate = 109.12\n\
         [[functional]]\nname = \"tip\"\ntype = \"position\"\non = \"blade.first_end[1]\"\ndirection = [1, 0, 0]\nover = \"initial\"\n\
         [[functional]]\nname = \"stress at the start\"\ntype = \"von_mises\"\nof = \"blade\"\nyield_stress = 276e6\n\
         over = {{ aggregate = \"smooth_maximum\", sharpness = 50, times = \"start\" }}\n\
         [[functional]]\nname = \"stress at the end\"\ntype = \"von_mises\"\nof = \"blade\"\nyield_stress = 276e6\n\
         over = {{ aggregate = \"smooth_maximum\", sharpness = 50, times = \"end\" }}\n"
    )
}

/// Radius of the tip of a rod that turns: E u'' + rho omega^2 (x + u) = 0, clamped at the root.
fn rod_tip(young: f64, density: f64, omega: f64, [root, tip]: [f64; 2]) -> f64 {
    let k = omega * (density / young).sqrt();
    // y = x + u: y'' + k^2 y = 0, y(root) = root, y'(tip) = 1
    let length = tip - root;
    (root + (k * length).sin() / k) / (k * length).cos()
}

fn blade_extension(report: &mut Report) -> Result<(), String> {
    eprintln!("[1/7] extension of a blade");
    let (root, tip) = (0.44, 2.0);
    let expected = rod_tip(70e9, 2500.0, 109.12, [root, tip]) - tip;
    report.inform("blade/extension of a rod [mm]", 1e3 * expected);
    let meshes: &[usize] = if report.is_short() { &[12] } else { &[12, 24, 48] };
    for &elements in meshes {
        let scene = FileScene::parse("blade.toml", &blade(elements))?;
        let prepared = Prepared::new(&scene).map_err(told)?;
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).map_err(told)?;
        let extension = forward.values[0] - tip;
        let name = |what: &str| format!("blade/{elements} x 1/{what}");
        report.compare(name("extension by that of a rod"), extension / expected, 1.0, EXTENSION);
        let node = prepared.model().nodes.iter().rposition(|node| node.name.starts_with("blade")).ok_or("no blade")?;
        let first = prepared.model().nodes[node - 1].dofs.start;
        let radius = |sample: &Sample<f64>| sample.at.q[first].hypot(sample.at.q[first + 1]);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        let see = |sample: &Sample<f64>| (least, most) = (least.min(radius(sample)), most.max(radius(sample)));
        analysis.for_each_sample(&forward, see).map_err(told)?;
        report.at_most(name("change of the extension over the first turn, share"), (most - least) / extension, STEADY);
        let [before, after] = [forward.values[1], forward.values[2]];
        report.at_most(
            name("change of the largest stress over the first turn, share"),
            (after / before - 1.0).abs(),
            STRESS,
        );
    }
    Ok(())
}

/// A slender beam that turns about its clamped end: EI = rho A = L = 1.
fn beam(rate: f64) -> String {
    format!(
        "version = 1\n[variable]\nrate = {{ initial = {rate}, bounds = [0, 20], unit = \"rad/s\" }}\n\
         [settings]\nstart = \"steady\"\nend = 1\nsteps = 10\n\
         [section.slender]\ntype = \"beam\"\naxial = 1e6\nshear = [1e6, 1e6]\ntorsion = 1e4\nbending = [1, 4]\nmass = 1\ninertia = [1e-8, 1e-8]\n\
         [[body]]\nname = \"hub\"\nmass = 1\ninertia = [1, 1, 1]\n\
         [[joint]]\nname = \"shaft\"\ntype = \"revolute\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         [[driver]]\nname = \"motor\"\ntype = \"rotation\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         angle = {{ type = \"formula\", value = \"rate * t\" }}\n\
         [[beam]]\nname = \"blade\"\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nelements = 24\nsection = \"slender\"\nsecond_axis = [0, 1, 0]\n\
         [[joint]]\nname = \"root\"\ntype = \"fixed\"\nbetween = [\"hub\", \"blade.start\"]\n\
         [[spin]]\nparts = [\"hub\", \"blade\"]\naxis = [0, 0, 1]\nrate = \"rate\"\n\
         [[functional]]\nname = \"tip\"\ntype = \"position\"\non = \"blade.end\"\ndirection = [1, 0, 0]\nover = \"initial\"\n"
    )
}

fn turning_beam(report: &mut Report) -> Result<(), String> {
    eprintln!("[2/7] frequencies of a turning beam");
    let mut first = Vec::new();
    for rate in [0.0, 2.0, 4.0, 6.0, 8.0, 10.0] {
        let scene = FileScene::parse("beam.toml", &beam(rate))?;
        let prepared = Prepared::new(&scene).map_err(told)?;
        let (_, modes) = prepared.complex_modes_with_state(4).map_err(told)?;
        // out of the plane of the turn with EI = 1; in it with EI = 4, and centrifugal forces that push aside
        let flaps = blade_frequencies::<2>(1.0, rate);
        let lags = blade_frequencies::<2>(4.0, rate).map(|omega| (omega * omega - rate * rate).sqrt());
        let tip = prepared.model().nodes.iter().rfind(|node| node.name.starts_with("blade")).ok_or("no blade")?.dofs.start;
        let flapping = |mode: &&costate::integrators::Mode| mode.shape[tip + 2].abs() > mode.shape[tip + 1].abs();
        let (own_flaps, own_lags): (Vec<_>, Vec<_>) = modes.iter().partition(flapping);
        for (what, own, expected) in [("flapping", own_flaps, flaps), ("lagging", own_lags, lags)] {
            for (number, (mode, expected)) in own.iter().zip(expected).enumerate() {
                let name = format!("turning beam/rate {rate}/{what} {}, omega by its series", number + 1);
                report.compare(name, mode.frequency / expected, 1.0, FREQUENCY);
            }
        }
        first.push((rate, modes.iter().find(flapping).ok_or("no flapping mode")?.frequency));
    }
    // omega^2 = omega0^2 + S rate^2 with S = 1.193 of a uniform cantilever (Southwell & Gough 1921)
    let [(_, still), (rate, turning), ..] = first[..] else { return Err("no rates".into()) };
    let southwell = (turning * turning - still * still) / (rate * rate);
    report.compare("turning beam/Southwell's coefficient of the first flapping mode", southwell / 1.193, 1.0, SOUTHWELL);
    Ok(())
}

/// Four blades with lag hinges on a support that differs by direction (Hammond 1974) at 29 rad/s with a tenth of the lag dampers: growth \[1/s\] and rate
/// of the regressing mode [rad/s], by an integration of the linear equations of hub and lag angles over a turn, kept apart.
const HAMMOND: [f64; 2] = [0.8361868786, 19.9367071];

fn ground_resonance(report: &mut Report) -> Result<(), String> {
    eprintln!("[3/7] ground resonance");
    let prepared = Prepared::new(built_in::named("ground-resonance")?).map_err(told)?;
    let found = prepared.periodic_modes(2).map_err(told)?;
    let [first, second] = &found.modes[..] else { return Err("two modes are wanted".into()) };
    let [growth, rate] = HAMMOND;
    report.compare("ground resonance/growth by that of Hammond's equations", first.growth / growth, 1.0, RESONANCE);
    let regressing = TAU / found.period - first.frequency;
    report.compare("ground resonance/rate by theirs", regressing / rate, 1.0, RESONANCE);
    report.inform("ground resonance/growth of the next mode [1/s]", second.growth);
    report.inform("ground resonance/by how much the motion does not return, share", found.gap);
    Ok(())
}

/// The hub without blades, at rest or turning on, with its controls.
fn rigid_hub(lifts: [f64; 3], turns: usize) -> Result<String, String> {
    let cut = |text: &str, from: &str, to: &str| -> Result<String, String> {
        let (before, rest) = text.split_once(from).ok_or(format!("no {from}"))?;
        let (_, after) = rest.split_once(to).ok_or(format!("no {to}"))?;
        Ok(format!("{before}{to}{after}"))
    };
    let text = cut(HUB, "[[shell]]", "# ---------------------------------------------------------------- joints")?;
    let text = cut(&text, "[[functional]]", "[[scenario]]")?;
    let text =
        cut(&text, "[output]", "# ---------------------------------------------------------------- what does not turn")?;
    let (text, _) = text.split_once("[[scenario]]").ok_or("no scenario")?;
    let [one, two, three] = lifts;
    Ok(text
        .replace("u1 = 0.05 ", &format!("u1 = {one} "))
        .replace("u2 = 0.05\n", &format!("u2 = {two}\n"))
        .replace("u3 = 0.05\n", &format!("u3 = {three}\n"))
        .replace("    \"blade 0\", \"blade 1\", \"blade 2\", \"blade 3\",\n", "")
        .replace("end = \"2 * pi / omega\"", &format!("end = \"{turns} * 2 * pi / omega\""))
        .replace("steps = 360", &format!("steps = {}", 360 * turns))
        + ENERGIES)
}

/// Energies, and works of what is in none.
const ENERGIES: &str = r#"
[[functional]]
name = "energy at the start"
type = "energy"
over = "initial"
[[functional]]
name = "energy at the end"
type = "energy"
over = "terminal"
[[functional]]
name = "work of loads"
type = "power"
over = "integral"
[[functional]]
name = "work of the motor"
type = "joint_power"
joint = "motor"
over = "integral"
[[functional]]
name = "work of actuator {k}"
for = { k = [1, 2, 3] }
type = "joint_power"
joint = "actuator {k}"
over = "integral"
"#;

/// What the energies leave of the works, as a share of these \[J\].
fn left_of_works(prepared: &Prepared, values: &[f64]) -> f64 {
    let named = |word: &str| {
        let all = prepared.functionals().iter().zip(values);
        all.filter(|own| own.0.name.starts_with(word)).map(|own| *own.1).collect::<Vec<f64>>()
    };
    let works = named("work of");
    let change = named("energy at the end")[0] - named("energy at the start")[0];
    (change - works.iter().sum::<f64>()).abs() / works.iter().map(|own| own.abs()).sum::<f64>()
}

fn swash_plate(report: &mut Report) -> Result<(), String> {
    eprintln!("[4/7] swash plate and pitch links");
    for (flight, lifts) in FLIGHTS {
        let turns = if flight == "collective" && !report.is_short() { TURNS } else { 1 };
        let scene = FileScene::parse("rigid-hub.toml", &rigid_hub(lifts, turns)?)?;
        let prepared = Prepared::new(&scene).map_err(told)?;
        let model = prepared.model();
        let node = |name: &str| model.nodes.iter().find(|node| node.name == name).map(|node| node.dofs.clone());
        let horns: Vec<_> = (0..4).filter_map(|k| node(&format!("horn {k}"))).collect();
        let hub = node("hub").ok_or("no hub")?;
        let analysis = prepared.analysis();
        let forward = analysis.forward(&prepared.x).map_err(told)?;
        let (mut off, mut gap, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
        let p = &forward.numbers.p;
        let see = |sample: &Sample<f64>| {
            let axes = |dofs: &std::ops::Range<usize>| Quaternion::from_slice(&sample.at.q[dofs.clone()][3..]).columns();
            let azimuth = axes(&hub)[0][1].atan2(axes(&hub)[0][0]);
            let share = controls(sample.t * 109.12 / TAU);
            for (k, horn) in horns.iter().enumerate() {
                let own = axes(horn)[1][2].asin();
                let expected = pitch(lifts.map(|lift| lift * share), azimuth, k);
                (off, largest) = (off.max((own - expected).abs()), largest.max(own.abs()));
            }
            for joint in &model.constraints {
                let q: Vec<f64> =
                    joint.nodes.iter().flat_map(|own| sample.at.q[model.node(*own).dofs.clone()].to_vec()).collect();
                let g = joint.physics.value(&q, &p[joint.parameters.clone()], sample.t);
                gap = g.iter().fold(gap, |gap, g| gap.max(g.abs()));
            }
        };
        analysis.for_each_sample(&forward, see).map_err(told)?;
        report.inform(format!("swash plate/{flight}/largest pitch [rad]"), largest);
        report.at_most(format!("swash plate/{flight}/pitch of four blades against geometry [rad]"), off, PITCH);
        report.at_most(format!("swash plate/{flight}/largest gap of a joint over {turns} turns [m]"), gap, GAP);
        let left = left_of_works(&prepared, &forward.values);
        report.at_most(format!("swash plate/{flight}/energy less the works of drives, share of these"), left, BALANCE);
    }
    Ok(())
}

fn flights(report: &mut Report) -> Result<(), String> {
    eprintln!("[5/7] three flights of the hub with blades");
    let scene = built_in::named("rotor-hub")?;
    let short = report.is_short();
    for Scenario { name, scene } in scene.scenarios().into_iter().take(if short { 1 } else { 3 }) {
        let mut settings = scene.settings();
        if short {
            (settings.end, settings.steps) = (settings.end / 24.0, 15);
        }
        let x = inside(scene);
        let prepared = Prepared::with(scene, &x, Prepared::method_of(&settings).map_err(told)?, settings).map_err(told)?;
        let (analysis, clock) = (prepared.analysis(), Instant::now());
        let forward = analysis.forward(&x).map_err(told)?;
        let seconds = clock.elapsed().as_secs_f64();
        let gradient = analysis.adjoint(&x, &forward).map_err(told)?;
        report.inform(format!("{name}/unknowns"), prepared.linear_solver().map_err(told)?.unknowns as f64);
        if !short {
            report.inform(format!("{name}/simulation [s]"), seconds);
            report.inform(
                format!("{name}/gradient of {} functionals [s]", forward.values.len()),
                clock.elapsed().as_secs_f64() - seconds,
            );
        }
        report.inform(format!("{name}/largest stress by the yield stress"), forward.values[0]);
        compare_with_whole_runs(report, &name, &prepared, (&forward, &gradient), |_| true).map_err(told)?;
    }
    Ok(())
}

/// The stress and the energy balance over steps and meshes.
fn steps_and_meshes(report: &mut Report) -> Result<(), String> {
    eprintln!("[6/7] steps and meshes");
    let run = |along: usize, scenario: &str, method: &str, steps: usize| -> Result<[f64; 2], String> {
        let scene = built_in::changed("rotor-hub", &format!("define.along = {along}{ENERGIES}"))?;
        let scenarios = scene.scenarios();
        let scene = scenarios.iter().find(|own| own.name == scenario).ok_or("no scenario")?.scene;
        let settings = Settings { steps, method: Some(method.into()), ..scene.settings() };
        let method = Prepared::method_of(&settings).map_err(told)?;
        let prepared = Prepared::with(scene, &inside(scene), method, settings).map_err(told)?;
        let values = prepared.analysis().values(&prepared.x).map_err(told)?;
        Ok([values[0], left_of_works(&prepared, &values)])
    };
    let finest = if report.is_short() { 180 } else { 720 };
    let (mut courses, mut before) = (Vec::new(), None);
    for steps in [90, 180, 360, 720].into_iter().take_while(|steps| *steps <= finest) {
        let [stress, left] = run(12, "longitudinal", "esdirk4", steps)?;
        let name = |what: &str| format!("steps/esdirk4, {steps} a turn/{what}");
        report.inform(name("largest stress by the yield stress"), stress);
        report.inform(name("energy less works, share of these"), left);
        if let Some(before) = before.replace(left) {
            report.at_most(name("by what is left with half as many"), left / before, HALVED);
        }
        courses.push(stress);
    }
    let best = courses[courses.len() - 1];
    for steps in [360, 720, 1440].into_iter().take(if report.is_short() { 0 } else { 3 }) {
        let [stress, left] = run(12, "longitudinal", "dirk2", steps)?;
        let name = |what: &str| format!("steps/dirk2, {steps} a turn/{what}");
        report.inform(name("largest stress by that of the finest"), stress / best);
        report.inform(name("energy less works, share of these"), left);
    }
    for along in [12, 24, 48].into_iter().take(if report.is_short() { 0 } else { 3 }) {
        let [stress, left] = run(along, "longitudinal", "esdirk4", 360)?;
        report.inform(format!("meshes/{along} x 1/largest stress by the yield stress"), stress);
        report.inform(format!("meshes/{along} x 1/energy less works, share of these"), left);
    }
    Ok(())
}
