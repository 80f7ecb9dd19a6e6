mod member;

use crate::{Noise, Report, Study};
use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};
use member::{GROWING, Member, Rest, TipLoad};
use std::f64::consts::PI;

/// Beams against the elastica, published benchmarks, and what must not change.
pub struct BeamBenchmarks;

impl Study for BeamBenchmarks {
    fn name(&self) -> &'static str {
        "beam-benchmarks"
    }
    fn summary(&self) -> &'static str {
        "beams against the elastica, published static benchmarks, invariance of strains, and theory of vibrations"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let parts: [(&str, Part); 7] = [
            ("elastica", elastica),
            ("cantilever of 2011", thick_cantilever),
            ("Princeton beam", princeton),
            ("45-degree bend", bend),
            ("roll-up", roll_up),
            ("invariance", invariance),
            ("vibrations", vibrations),
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

const ELASTICA: &str = include_str!("cantilever_elastica.csv");

/// Rows of the table for one case: load parameter, quantity, value.
fn rows(case: &str) -> Result<Vec<(f64, &'static str, f64)>, String> {
    let of_case = ELASTICA.lines().filter(|line| line.starts_with(case));
    let parse = |line: &'static str| {
        let mut fields = line.rsplit(',');
        let value = fields.next()?.parse().ok()?;
        let quantity = fields.next()?;
        Some((fields.next()?.parse().ok()?, quantity, value))
    };
    of_case.map(|line| parse(line).ok_or_else(|| format!("the row \"{line}\" has no numbers"))).collect()
}

/// (u, w, theta) of the tip.
fn tip(solved: &member::Solved, q: &[f64]) -> [f64; 3] {
    let [u, w, _] = solved.tip(q);
    [u, w, solved.tip_angle(q)]
}

/// Largest difference of (u, w, theta) from the rows of one load.
fn miss([u, w, theta]: [f64; 3], length: f64, rows: &[(f64, &str, f64)]) -> f64 {
    let error = |(_, quantity, value): &(f64, &str, f64)| match *quantity {
        "u_axial/L" => (u / length - value).abs(),
        "w/L" => (w / length - value).abs(),
        "u_axial" => (u - value).abs(),
        "w_transverse" => (w - value).abs(),
        "theta" => (theta - value).abs(),
        _ => 0.0,
    };
    rows.iter().map(error).fold(0.0, f64::max)
}

fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

/// A bar of EI = 1 and length 1 that stretches and shears little.
fn slender(elements: usize, stiffness: f64) -> Member {
    Member::clamped(Rest::Straight(1.0), elements, [stiffness, stiffness, stiffness, 1.0, 1.0, 1.0])
}

fn elastica(report: &mut Report) -> Result<(), String> {
    let table = rows("elastica_tip_dead_load")?;
    let loads: Vec<f64> = (1..=10).map(f64::from).collect();
    let worst = |elements: usize| -> Result<f64, String> {
        let at = |stiffness: f64| {
            let member = Member { load_steps: 200, ..slender(elements, stiffness) };
            member.with(TipLoad::Force([0.0, 10.0, 0.0], GROWING)).solve_at(loads.len())
        };
        let (stiff, soft) = (at(1e6)?, at(5e5)?);
        let of_load = |((stiff_q, soft_q), &load): ((&Vec<f64>, &Vec<f64>), &f64)| {
            let own: Vec<_> = table.iter().filter(|row| row.0 == load).copied().collect();
            let (near, far) = (tip(&stiff, stiff_q), tip(&soft, soft_q));
            // what stretch and shear add is linear in 1 / EA = 1 / GA: their limit without
            miss(std::array::from_fn(|i| 2.0 * near[i] - far[i]), 1.0, &own)
        };
        Ok(stiff.equilibria.iter().zip(&soft.equilibria).zip(&loads).map(of_load).fold(0.0, f64::max))
    };
    let meshes = [8, 16, 32];
    let errors = meshes.iter().map(|&elements| worst(elements)).collect::<Result<Vec<_>, _>>()?;
    for (elements, error) in meshes.iter().zip(&errors) {
        report.inform(format!("elastica/{elements} elements/largest error"), *error);
    }
    report.at_most("elastica/32 elements/error of displacements by L and of rotation, ten loads", errors[2], 1e-6);
    report.compare("elastica/order in mesh size, 8 to 16 elements", order(errors[0], errors[1]), 4.0, 0.1);
    Ok(())
}

fn thick_cantilever(report: &mut Report) -> Result<(), String> {
    let table = rows("Nachbagauer2011")?;
    let (young, height, width) = (2.07e11, 0.5_f64, 0.1);
    let shear = young / 2.6 * width * height * 13.0 / 15.3;
    let bending = young * width * height.powi(3) / 12.0;
    let stiffness = [young * width * height, shear, shear, bending, bending, bending];
    let mut errors = Vec::new();
    for elements in [8, 16, 32, 64] {
        let member =
            Member::clamped(Rest::Straight(2.0), elements, stiffness).with(TipLoad::Force([0.0, 6.25e7, 0.0], GROWING));
        let solved = member.solve()?;
        let error = miss(tip(&solved, solved.last()), 1.0, &table);
        report.inform(format!("cantilever 2011/{elements} elements/largest error"), error);
        errors.push(error);
    }
    report.at_most("cantilever 2011/64 elements/error of displacements [m] and rotation", errors[3], 1e-7);
    report.compare("cantilever 2011/order, 8 to 16 elements", order(errors[0], errors[1]), 4.0, 0.1);
    Ok(())
}

fn princeton(report: &mut Report) -> Result<(), String> {
    // soft and stiff displacement of the tip [m]
    let reference = [
        (15.0, [0.0421258459541, 0.0106257691259]),
        (30.0, [0.0794572226645, 0.0101472563547]),
        (45.0, [0.109043083125, 0.00888888596702]),
    ];
    let scene = built_in::named("princeton-beam")?;
    for (degrees, expected) in reference {
        let x: Vec<f64> = scene
            .variables()
            .iter()
            .map(|variable| if variable.name == "load angle" { f64::to_radians(degrees) } else { variable.initial })
            .collect();
        let settings = scene.settings();
        let method = Prepared::method_of(&settings).map_err(|error| error.to_string())?;
        let prepared = Prepared::with(scene, &x, method, settings).map_err(|error| error.to_string())?;
        let tip = prepared.equilibrium().map_err(|error| error.to_string())?;
        let last = tip.q.len() - 7;
        for (direction, (value, expected)) in ["soft", "stiff"].into_iter().zip(tip.q[last + 1..].iter().zip(expected)) {
            report.compare(format!("Princeton/{degrees} degrees/{direction} displacement [m]"), *value, expected, 1e-5);
        }
    }
    Ok(())
}

fn bend(report: &mut Report) -> Result<(), String> {
    let reference = [58.7791224897, 22.2447809454, 40.1918916702];
    let (young, radius, angle) = (1e7, 100.0, PI / 4.0);
    let stiffness = [young, 0.5 * young, 0.5 * young, young / 12.0, young / 12.0, young / 12.0];
    let start = [radius * angle.sin(), radius * (1.0 - angle.cos()), 0.0];
    let mut errors = Vec::new();
    let mut tips = Vec::new();
    for elements in [4, 8, 16, 32] {
        let member = Member::clamped(Rest::Arc(radius, angle), elements, stiffness_of_bend(stiffness));
        let solved = member.with(TipLoad::Force([0.0, 0.0, 300.0], GROWING)).solve()?;
        let moved = solved.tip(solved.last());
        let tip: [f64; 3] = std::array::from_fn(|i| start[i] + moved[i]);
        let error = tip.iter().zip(reference).map(|(tip, reference)| (tip - reference).abs()).fold(0.0, f64::max);
        report.inform(format!("45-degree bend/{elements} elements/largest error [m]"), error);
        errors.push(error);
        tips.push(tip);
    }
    report.at_most("45-degree bend/8 elements/error of the tip [m]", errors[1], 1e-3);
    report.compare("45-degree bend/order, 8 to 16 elements", order(errors[1], errors[2]), 4.0, 0.1);
    // Richardson's extrapolation with order 4
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        let limit = tips[3][i] + (tips[3][i] - tips[2][i]) / 15.0;
        report.compare(format!("45-degree bend/limit of 16 and 32 elements/{name} [m]"), limit, reference[i], 1e-6);
    }
    Ok(())
}

/// GJ is G / 6 with nu = 0, the value of the benchmark, not that of a square.
fn stiffness_of_bend(mut stiffness: [f64; 6]) -> [f64; 6] {
    stiffness[3] = 0.5 * stiffness[0] / 6.0;
    stiffness
}

fn roll_up(report: &mut Report) -> Result<(), String> {
    // M = 2 pi EI / L: the tip comes back to the clamp
    let mut errors = Vec::new();
    for elements in [4, 8, 16] {
        let member = Member::clamped(Rest::Straight(1.0), elements, [1e5, 1e5, 1e5, 1.0, 1.0, 1.0]);
        let member = Member { load_steps: 100, ..member }.with(TipLoad::Moment([0.0, 0.0, 2.0 * PI], GROWING));
        let solved = member.solve()?;
        let [u, w, _] = solved.tip(solved.last());
        let gap = (u + 1.0).hypot(w);
        report.inform(format!("roll-up/{elements} elements/gap of the circle by L"), gap);
        errors.push(gap);
    }
    report.at_most("roll-up/16 elements/gap of the circle by L", errors[2], 1e-4);
    report.compare("roll-up/order, 8 to 16 elements", order(errors[1], errors[2]), 4.0, 0.1);
    Ok(())
}

fn invariance(report: &mut Report) -> Result<(), String> {
    let bent = |first: [f64; 3], second: [f64; 3]| {
        let member = Member::clamped(Rest::Arc(1.0, 1.2), 8, [1e5, 4e4, 4e4, 8.0, 20.0, 10.0]);
        let member = member.with(TipLoad::Force([3.0, -8.0, 12.0], first)).with(TipLoad::Moment([4.0, 3.0, -6.0], second));
        member.solve()
    };
    let solved = bent(GROWING, GROWING)?;
    let q = solved.last();
    let energy = solved.energy(q);
    let mut random = Noise::new(1);
    let mut worst: f64 = 0.0;
    for _ in 0..1000 {
        let turn = Quaternion(std::array::from_fn(|_| random.next()));
        let norm = turn.norm_squared().sqrt();
        let turn = Quaternion(turn.0.map(|e| e / norm));
        let shift = Vector3::from(std::array::from_fn(|_| random.next()));
        let moved: Vec<f64> = q
            .chunks_exact(7)
            .flat_map(|node| {
                let place = turn.rotate(Vector3::first_three(node)) + shift;
                place.components().into_iter().chain(turn.times(Quaternion::from_slice(&node[3..])).0)
            })
            .collect();
        worst = worst.max((solved.energy(&moved) / energy - 1.0).abs());
    }
    report.at_most("invariance/strain energy under 1000 rigid motions, relative change", worst, 1e-12);
    for (name, first, second) in [
        ("force first, then moment", [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]),
        ("moment first, then force", [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]),
        ("there, too far and back", [0.0, 1.5, 1.0], [0.0, -0.7, 1.0]),
    ] {
        let other = bent(first, second)?;
        let change = other.energy(other.last()) / energy - 1.0;
        report.at_most(format!("invariance/strain energy, {name}, relative change"), change.abs(), 1e-12);
    }
    Ok(())
}

/// Root of a function near a start, by Newton's method with the derivative beside the value.
fn root(mut x: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    for _ in 0..50 {
        let (value, slope) = function(x);
        x -= value / slope;
    }
    x
}

fn vibrations(report: &mut Report) -> Result<(), String> {
    // Bernoulli's beam of EI = 1, mass 1, length 1: omega = (beta L)^2, with cosh cos = 1 (free) and -1 (clamped), by cosh
    let free = |x: f64| (x.cos() - 1.0 / x.cosh(), -x.sin() + x.tanh() / x.cosh());
    let clamped = |x: f64| (x.cos() + 1.0 / x.cosh(), -x.sin() - x.tanh() / x.cosh());
    let roots = |function: &dyn Fn(f64) -> (f64, f64), starts: [f64; 3]| starts.map(|start| root(start, function));
    for (name, is_clamped, roots) in
        [("clamped", true, roots(&clamped, [1.9, 4.7, 7.9])), ("free", false, roots(&free, [4.7, 7.9, 11.0]))]
    {
        let mut largest = Vec::new();
        for elements in [8, 16, 64] {
            let mut member = slender(elements, 2e7);
            // torsion and the other bending lie far above; what shear and rotary inertia take off is 4e-6 of the third frequency
            (member.stiffness[3], member.stiffness[4]) = (100.0, 1e4);
            (member.inertia, member.clamped) = ([1.0, 1e-8], is_clamped);
            let prepared = Prepared::with(&member, &[], Prepared::default_method(), Settings::new(1.0, 1))
                .map_err(|error| error.to_string())?;
            let rigid = if is_clamped { 0 } else { 6 };
            let modes = prepared.modes(rigid + 3).map_err(|error| error.to_string())?;
            // the turn about the line itself has next to no inertia here, and its zero is beyond the digits of the others
            let mut vibrations = modes.iter().map(|mode| mode.frequency).filter(|&omega| omega > 1.0);
            let errors = roots.map(|root| (vibrations.next().unwrap_or(f64::NAN) / (root * root) - 1.0).abs());
            let worst = errors.into_iter().fold(0.0, |worst: f64, error| if error <= worst { worst } else { error });
            report.inform(format!("vibrations/{name}/{elements} elements/largest relative error of three"), worst);
            largest.push(worst);
        }
        report.at_most(format!("vibrations/{name}/64 elements/relative error of three frequencies"), largest[2], 1e-5);
        report.compare(format!("vibrations/{name}/order, 8 to 16 elements"), order(largest[0], largest[1]), 4.0, 0.1);
    }
    let stout = Member {
        clamped: false,
        inertia: [1.0, 1e-3],
        ..Member::clamped(Rest::Arc(1.0, 1.0), 4, [1e4, 4e3, 4e3, 8.0, 10.0, 10.0])
    };
    let prepared =
        Prepared::with(&stout, &[], Prepared::default_method(), Settings::new(1.0, 1)).map_err(|error| error.to_string())?;
    let modes = prepared.modes(8).map_err(|error| error.to_string())?;
    let rigid = modes.iter().filter(|mode| mode.frequency == 0.0 && mode.growth == 0.0).count();
    report.compare("vibrations/free arc/rigid motions among the eight lowest modes", rigid as f64, 6.0, 0.0);
    Ok(())
}
