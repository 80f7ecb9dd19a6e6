//! Drawn chains of bodies with drawn stops, latches, joints that break, and switches: values by another method with finer steps, gradients by
//! quotients of whole runs. What is wrong must have said so.

use super::parsed;
use costate::integrators::{RunError, Table, tables};
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use std::fmt::Write;

/// Numbers between 0 and 1 from a seed.
struct Lots(u64);

impl Lots {
    fn next(&mut self) -> f64 {
        // splitmix64: Steele, Lea, Flood, 2014
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.next()
    }
    fn one_of<'w>(&mut self, words: &[&'w str]) -> &'w str {
        words[(self.next() * words.len() as f64) as usize]
    }
}

/// A chain that hangs from the ground, whose links turn about axes that differ, with something on each of its angles.
fn drawn(seed: u64) -> String {
    let mut lots = Lots(seed);
    let links = 1 + (lots.next() * 3.0) as usize;
    let mut text = String::from("version = 1\ngravity = [0, 0, -9.81]\n");
    let _ = writeln!(text, "settings = {{ end = {:.3}, steps = 200 }}", lots.between(0.5, 1.5));
    text += "variable.k = { initial = 3, bounds = [0.1, 10], unit = \"N m/rad\" }\n";
    text += "variable.m = { initial = 1, bounds = [0.1, 10], unit = \"kg\" }\n";
    let _ = writeln!(text, "variable.e = {{ initial = {:.3}, bounds = [0, 1], unit = \"-\" }}", lots.between(0.0, 0.9));
    let is_plane = lots.next() < 0.6;
    let (mut below, mut place) = ("ground".to_string(), [0.0, 0.0, 0.0]);
    for link in 1..=links {
        let length = lots.between(0.3, 0.6);
        let lean = lots.between(-0.8, 0.8);
        let to = [place[0] + length * f64::sin(lean), place[1], place[2] - length * f64::cos(lean)];
        let centre = [0, 1, 2].map(|axis| 0.5 * (place[axis] + to[axis]));
        let axis = if is_plane || link % 2 == 1 { "[0, 1, 0]" } else { "[1, 0, 0]" };
        let _ = writeln!(
            text,
            "[[body]]\nname = \"b{link}\"\nposition = {centre:?}\nmass = \"m\"\ninertia = [0.03, 0.04, 0.02]"
        );
        let _ = writeln!(
            text,
            "[[joint]]\nname = \"j{link}\"\ntype = \"revolute\"\nbetween = [\"{below}\", \"b{link}\"]\npoint = {place:?}\naxis = {axis}"
        );
        let _ = writeln!(text, "[[joint_angle]]\nname = \"a{link}\"\nbetween = [\"{below}\", \"b{link}\"]\naxis = {axis}");
        let _ = writeln!(
            text,
            "[[element]]\nname = \"s{link}\"\nnodes = {{ a = \"a{link}\" }}\nforce = {{ a = \"-k * a.value - {:.3} * a.rate\" }}",
            lots.between(0.0, 0.3)
        );
        let at = lots.between(0.05, 0.5) * if lots.next() < 0.5 { -1.0 } else { 1.0 };
        let side = if at > 0.0 { "most" } else { "least" };
        match lots.one_of(&["stop", "stop", "rest", "latch", "strength", "break", "both", "none"]) {
            "stop" => {
                let _ =
                    writeln!(text, "[[stop]]\nname = \"t{link}\"\non = \"a{link}\"\n{side} = {at:.3}\nrestitution = \"e\"");
            }
            "rest" => {
                let _ = writeln!(
                    text,
                    "[[stop]]\nname = \"t{link}\"\non = \"a{link}\"\n{side} = {at:.3}\nrestitution = {:.2}\nrest_speed = 0.2",
                    lots.between(0.0, 0.6)
                );
            }
            "both" => {
                let _ = writeln!(
                    text,
                    "[[stop]]\nname = \"t{link}\"\non = \"a{link}\"\nleast = {:.3}\nmost = {:.3}\nrestitution = \"e\"",
                    -at.abs(),
                    0.7 * at.abs()
                );
            }
            "latch" => {
                let _ = writeln!(text, "[[latch]]\nname = \"t{link}\"\non = \"a{link}\"\nat = {at:.3}");
            }
            "strength" => {
                let _ = writeln!(
                    text,
                    "[[latch]]\nname = \"t{link}\"\non = \"a{link}\"\nat = {at:.3}\nstrength = {:.3}",
                    lots.between(1.0, 6.0)
                );
            }
            "break" => {
                let _ = writeln!(
                    text,
                    "[[event]]\nname = \"t{link}\"\nnodes = {{ a = \"a{link}\" }}\nwhen = \"a.value - {at:.3}\"\nremove = \"j{link}\"\nonce = true"
                );
            }
            _ => {}
        }
        (below, place) = (format!("b{link}"), to);
    }
    let _ = writeln!(
        text,
        "[[functional]]\nname = \"place\"\ntype = \"position\"\non = \"{below}\"\ndirection = [0.6, 0.1, 0.8]\nover = \"terminal\"\n[[functional]]\nname = \
         \"mean\"\ntype = \"formula\"\nnodes = {{ b = \"{below}\" }}\nvalue = \"dot(b.velocity, b.velocity)\"\nover = \"integral\""
    );
    text
}

fn table(name: &str) -> Table {
    tables().into_iter().find(|table| table.name == name).expect("listed")
}

#[derive(Debug, Default)]
struct Counts {
    right: usize,
    refused: usize,
    sensitive: usize,
    wrong: Vec<(u64, String)>,
    events: usize,
}

fn examine(seed: u64, scene: &FileScene, counts: &mut Counts) -> Result<(), RunError> {
    let x: Vec<f64> = AnyScene::variables(scene).iter().map(|variable| variable.initial).collect();
    let with = |table: &str, factor: usize| {
        let mut settings = AnyScene::settings(scene).without_method();
        settings.steps *= factor;
        let method = Method::new(self::table(table), settings.level);
        Prepared::with(scene, &x, method, settings)
    };
    let prepared = with("esdirk4", 1)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x)?;
    let count = |own: &Prepared, forward| own.analysis().events(forward).len();
    let happened = count(&prepared, &forward);
    counts.events += happened;
    let adjoint = analysis.adjoint(&x, &forward)?.rows;
    let others = [with("esdirk4", 2)?, with("esdirk5", 3)?];
    let other = [others[0].analysis().forward(&x)?, others[1].analysis().forward(&x)?];
    if others.iter().zip(&other).any(|(own, forward)| count(own, forward) != happened) {
        // one hit more or less: at the limit between two motions
        counts.sensitive += 1;
        return Ok(());
    }
    for (k, value) in forward.values.iter().enumerate() {
        let (apart, course) = ((value - other[1].values[k]).abs(), (value - other[0].values[k]).abs());
        if apart > 1e-5 * (1.0 + value.abs()) + 5.0 * course {
            counts.wrong.push((seed, format!("value {k}: {value} for {}", other[1].values[k])));
            return Ok(());
        }
    }
    let on_steps = analysis.on_steps_of(&forward);
    for i in 0..x.len() {
        let mut along = vec![0.0; x.len()];
        along[i] = 1.0;
        // the best of several sizes: where a hit enters or leaves the run none is right
        let sizes = [1e-4, 1e-5, 1e-6].map(|size| size * x[i].abs().max(0.1));
        let quotients = sizes.map(|size| on_steps.central_difference(&x, &along, size));
        for k in 0..adjoint.len() {
            let row = adjoint[k].iter().fold(forward.values[k].abs().max(1e-3), |size: f64, own| size.max(own.abs()));
            let apart = |own: &Result<Vec<f64>, RunError>| {
                own.as_ref().map_or(f64::INFINITY, |own| (own[k] - adjoint[k][i]).abs() / row)
            };
            if quotients.iter().all(|own| apart(own) > 1e-5) {
                let told: Vec<f64> = quotients.iter().filter_map(|own| Some(own.as_ref().ok()?[k])).collect();
                let scatter = told.iter().fold(0.0, |most: f64, own| most.max((own - told[0]).abs())) / row;
                if told.len() < 3 || scatter > 1e-3 {
                    counts.sensitive += 1;
                } else {
                    counts.wrong.push((seed, format!("derivative {k} by {i}: {} for {told:?}", adjoint[k][i])));
                }
                return Ok(());
            }
        }
    }
    counts.right += 1;
    Ok(())
}

#[test]
fn drawn_mechanisms_with_events_are_right_or_say_so() {
    let asked = std::env::var("COSTATE_DRAWN_EVENTS").ok().and_then(|own| own.parse().ok()).unwrap_or(24);
    let first = std::env::var("COSTATE_FIRST_SEED").ok().and_then(|own| own.parse().ok()).unwrap_or(0);
    let mut counts = Counts::default();
    for seed in first..first + asked {
        let scene = parsed(&drawn(seed));
        if let Err(why) = examine(seed, &scene, &mut counts) {
            counts.refused += 1;
            println!("{seed}: {why}");
        }
    }
    println!("{counts:?}");
    assert!(counts.wrong.is_empty(), "{:?}", counts.wrong);
    assert!(10 * counts.right > 7 * asked as usize, "{counts:?}");
}
