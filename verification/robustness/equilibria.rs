//! Equilibria near bifurcations, drawn by lot, and modes of systems with repeated frequencies.

use crate::{Noise, Report};
use costate::integrators::{Stability, StepControl, Verdict};
use costate::prelude::*;
use costate::scenes::FileScene;
use std::f64::consts::PI;

/// Columns, chains of links, and sets of oscillators in the short form; so many times as many in the long one.
const COUNTS: [usize; 3] = [12, 40, 12];
const LONG: usize = 20;
/// Distance of the tip of a column from the elastica, by its length, that 8 elements leave.
const TIP: f64 = 2e-3;
/// Steps of the quadrature over the length.
const STEPS: usize = 1000;

/// How equilibria end.
#[derive(Default)]
struct Outcomes {
    right: usize,
    warned: usize,
    errors: usize,
    wrong: usize,
}

impl Outcomes {
    fn report(&self, report: &mut Report, name: &str) {
        report.inform(format!("{name}/right"), self.right as f64);
        report.inform(format!("{name}/warned"), self.warned as f64);
        report.inform(format!("{name}/errors"), self.errors as f64);
        report.at_most(format!("{name}/wrong"), self.wrong as f64, 0.0);
    }
}

/// All of them.
pub fn count(report: &mut Report) -> Result<(), String> {
    let times = if report.is_long() { LONG } else { 1 };
    let mut noise = Noise::new(12);
    let [columns_drawn, chains_drawn, sets_drawn] = COUNTS.map(|count| count * times);
    columns(report, &mut noise, columns_drawn)?;
    chains(report, &mut noise, chains_drawn)?;
    oscillators(report, &mut noise, sets_drawn)
}

/// Columns with a side load, under up to four times the critical load, in steps of all kinds.
fn columns(report: &mut Report, noise: &mut Noise, count: usize) -> Result<(), String> {
    let ways = [
        ("3 steps", Settings::statics(3)),
        ("5 steps", Settings::statics(5)),
        ("20 steps", Settings::statics(20)),
        ("5 steps, divided", Settings::statics(5).dividing_steps()),
        ("chosen steps", Settings::statics(10).choosing_steps(StepControl::new(1e-6))),
    ];
    let mut all: Vec<Outcomes> = ways.iter().map(|_| Outcomes::default()).collect();
    for _ in 0..count {
        let load = 0.25 * PI * PI * 4.0_f64.powf(noise.next());
        let side = load * 10.0_f64.powf(-2.5 + 1.5 * noise.next());
        let reference = standing_tip(load, side);
        let scene = FileScene::parse("column.toml", &column(load, side))?;
        for ((_, settings), outcomes) in ways.iter().zip(&mut all) {
            let method = Prepared::method_of(settings).map_err(|error| error.to_string())?;
            let prepared = Prepared::with(&scene, &[], method, settings.clone()).map_err(|error| error.to_string())?;
            match prepared.analysis().forward(&[]) {
                Err(_) => outcomes.errors += 1,
                Ok(forward) if verdict(forward.stability.map(|course| course.end)) != Some(Verdict::Stable) => {
                    outcomes.warned += 1;
                }
                Ok(forward) => {
                    let off = (forward.values[0] - reference[0]).hypot(forward.values[1] - reference[1]);
                    // written so that a NaN is wrong
                    if off <= TIP { outcomes.right += 1 } else { outcomes.wrong += 1 }
                }
            }
        }
    }
    for ((way, _), outcomes) in ways.iter().zip(&all) {
        outcomes.report(report, &format!("equilibria/columns/{way}"));
    }
    Ok(())
}

fn verdict(stability: Option<Stability>) -> Option<Verdict> {
    stability.map(|stability| stability.verdict())
}

/// EI = L = 1, under P along it and H across it.
fn column(load: f64, side: f64) -> String {
    include_str!("column.toml").replace("LOAD", &format!("{load}")).replace("SIDE", &format!("{side}"))
}

/// Where the tip stands: theta'' = -(P sin theta + H cos theta), theta(0) = 0, theta'(1) = 0, by shooting from the tip, whose angle is the
/// one from which theta falls to zero within the length 1, and not before.
fn standing_tip(load: f64, side: f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, PI);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if from_the_tip(load, side, middle).is_some() { high = middle } else { low = middle }
    }
    from_the_tip(load, side, high).unwrap_or([f64::NAN; 2])
}

/// The tip as seen from the clamp, if the angle stays above zero up to there; by the classical Runge-Kutta method.
fn from_the_tip(load: f64, side: f64, angle: f64) -> Option<[f64; 2]> {
    let rate = |[theta, slope, ..]: [f64; 4]| [slope, -(load * theta.sin() + side * theta.cos()), theta.cos(), theta.sin()];
    let h = 1.0 / STEPS as f64;
    let moved = |state: [f64; 4], rate: [f64; 4], by: f64| std::array::from_fn(|i| state[i] + by * rate[i]);
    let mut state = [angle, 0.0, 0.0, 0.0];
    for _ in 0..STEPS {
        let first = rate(state);
        let second = rate(moved(state, first, 0.5 * h));
        let third = rate(moved(state, second, 0.5 * h));
        let fourth = rate(moved(state, third, h));
        state = std::array::from_fn(|i| state[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
        if state[0] < 0.0 {
            return None;
        }
    }
    Some([state[2], state[3]])
}

/// Straight chains of links on hinges with torsion springs under a dead load along them: with the spring constant k and links of length l the
/// stiffness k T - P l I has as many negative eigenvalues as 4 k sin^2((2 j - 1) pi / (4 n + 2)), j = 1 to n, lie below P l.
fn chains(report: &mut Report, noise: &mut Noise, count: usize) -> Result<(), String> {
    let mut outcomes = Outcomes::default();
    for _ in 0..count {
        let links = 1 + (4.0 * (1.0 + noise.next())) as usize;
        let (stiffness, length) = (10.0_f64.powf(3.0 * noise.next()), 10.0_f64.powf(noise.next()));
        let critical =
            |j: usize| 4.0 * stiffness * ((2 * j - 1) as f64 * PI / (4 * links + 2) as f64).sin().powi(2) / length;
        // between the critical loads, or beyond all of them
        let load = critical(links) * 0.6 * (1.0 + noise.next());
        let expected = (1..=links).filter(|&j| critical(j) < load).count();
        let scene = FileScene::parse("chain.toml", &chain(links, stiffness, length, load))?;
        let prepared = Prepared::new(&scene).map_err(|error| error.to_string())?;
        match prepared.equilibrium() {
            Err(_) => outcomes.errors += 1,
            Ok(found) => match found.stability.map(|course| course.end) {
                Some(end) if end.negative == expected && end.neutral == 0 && end.determinant.is_none() => {
                    outcomes.right += 1
                }
                Some(end) if end.verdict() == Verdict::Undecided => outcomes.warned += 1,
                _ => outcomes.wrong += 1,
            },
        }
    }
    outcomes.report(report, "equilibria/chains, counts of negative eigenvalues");
    Ok(())
}

pub fn chain(links: usize, stiffness: f64, length: f64, load: f64) -> String {
    let mut text = String::from("version = 1\nsettings = { method = \"static\", steps = 1 }\n");
    for link in 0..links {
        let (start, before) = (link as f64 * length, if link == 0 { "ground".into() } else { format!("link {}", link - 1) });
        text += &format!(
            r#"
            [[body]]
            name = "link {link}"
            position = [{start}, 0, 0]
            mass = 1
            inertia = [1, 1, 1]
            [[joint]]
            name = "hinge {link}"
            type = "revolute"
            between = ["{before}", "link {link}"]
            point = [{start}, 0, 0]
            axis = [0, 0, 1]
            [[spring]]
            name = "spring {link}"
            type = "torsion"
            between = ["{before}", "link {link}"]
            axis = [0, 0, 1]
            stiffness = {stiffness}
            "#
        );
    }
    text + &format!(
        "[[force]]\nname = \"load\"\non = \"link {}\"\npoint = [{}, 0, 0]\ndirection = [-1, 0, 0]\n\
         size = {{ type = \"constant_rate\", rate = {load} }}\n",
        links - 1,
        links as f64 * length
    )
}

/// Bodies on hinges, each with a torsion spring of one of a few constants: omega^2 = k / J, as often as it was drawn.
fn oscillators(report: &mut Report, noise: &mut Noise, count: usize) -> Result<(), String> {
    let mut outcomes = Outcomes::default();
    for _ in 0..count {
        let bodies = 2 + (6.0 * (1.0 + noise.next())) as usize;
        let kinds: Vec<f64> = (0..3).map(|_| 10.0_f64.powf(2.0 + 4.0 * noise.next())).collect();
        let mut squares: Vec<f64> = (0..bodies).map(|_| kinds[(1.5 * (1.0 + noise.next())) as usize]).collect();
        let text = squares.iter().enumerate().fold(
            String::from("version = 1\nsettings = { end = 1, steps = 1 }\n"),
            |text, (body, stiffness)| {
                text + &format!(
                    r#"
                [[body]]
                name = "body {body}"
                position = [{body}, 0, 0]
                mass = 1
                inertia = [1, 1, 1]
                [[joint]]
                name = "hinge {body}"
                type = "revolute"
                between = ["ground", "body {body}"]
                axis = [0, 0, 1]
                [[spring]]
                name = "spring {body}"
                type = "torsion"
                between = ["ground", "body {body}"]
                axis = [0, 0, 1]
                stiffness = {stiffness}
                "#
                )
            },
        );
        squares.sort_by(f64::total_cmp);
        let wanted = 1 + (0.5 * (1.0 + noise.next()) * bodies as f64) as usize;
        let scene = FileScene::parse("oscillators.toml", &text)?;
        let prepared = Prepared::new(&scene).map_err(|error| error.to_string())?;
        match prepared.modes(wanted) {
            Err(_) => outcomes.errors += 1,
            Ok(modes) => {
                let is_right = modes.len() == wanted.min(bodies)
                    && modes.iter().zip(&squares).all(|(mode, square)| (mode.frequency / square.sqrt() - 1.0).abs() < 1e-8);
                if is_right { outcomes.right += 1 } else { outcomes.wrong += 1 }
            }
        }
    }
    outcomes.report(report, "equilibria/oscillators, modes with their multiplicities");
    Ok(())
}
