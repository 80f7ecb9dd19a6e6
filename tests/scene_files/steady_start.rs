//! Motions that begin with a steady turn: where parts stand in it, that they stay there, gradients through it, what does not go on turning.

use super::{parsed, refused};
use costate::integrators::Verdict;
use costate::scenes::{FileScene, Prepared};
use costate::sensitivity::{Forward, largest_difference};

/// A mass that a spring holds on a slide of a hub that is free to turn, with other text in place of some of it.
fn whirled(changes: &[(&str, &str)]) -> String {
    let text = "version = 1\n[variable]\nomega = { initial = 20, bounds = [-30, 80], unit = \"rad/s\" }\n\
         k = { initial = 2000, bounds = [100, 1e4], unit = \"N/m\" }\n\
         [[body]]\nname = \"hub\"\nmass = 1\ninertia = [0.1, 0.1, 0.1]\n\
         [[body]]\nname = \"mass\"\nposition = [0.5, 0, 0]\nmass = 2\ninertia = [0.1, 0.1, 0.1]\n\
         [[joint]]\nname = \"shaft\"\ntype = \"revolute\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         [[joint]]\nname = \"slide\"\ntype = \"prismatic\"\nbetween = [\"hub\", \"mass\"]\naxis = [1, 0, 0]\n\
         [[spring]]\nname = \"spring\"\ntype = \"line\"\nbetween = [\"hub\", \"mass\"]\nstiffness = \"k\"\nrest_length = 0.5\n\
         [[hold]]\nnodes = [\"hub\"]\ndirections = [\"rotation_z\"]\n\
         [[spin]]\nparts = [\"hub\", \"mass\"]\naxis = [0, 0, 3]\nrate = \"omega\"\n\
         [[functional]]\nname = \"start\"\ntype = \"position\"\non = \"mass\"\ndirection = [1, 0, 0]\nover = \"initial\"\n\
         [[functional]]\nname = \"end\"\ntype = \"position\"\non = \"mass\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n\
         [settings]\nstart = \"steady\"\nend = 0.5\nsteps = 400\n";
    changes.iter().fold(text.to_string(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replace(old, new)
    })
}

fn prepared(scene: &FileScene) -> Prepared<'_> {
    Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"))
}

fn forward(prepared: &Prepared) -> Forward {
    prepared.analysis().forward(&prepared.x).unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn a_mass_on_a_spring_turns_where_centrifugal_force_and_spring_are_equal() {
    let scene = parsed(&whirled(&[]));
    let prepared = prepared(&scene);
    let (forward, analysis) = (forward(&prepared), prepared.analysis());
    // k (r - r0) = m omega^2 r
    let (m, k, omega, r0) = (2.0, 2000.0, 20.0_f64, 0.5);
    let left: f64 = k - m * omega * omega;
    let (r, by) = (k * r0 / left, [2.0 * m * omega * k * r0 / (left * left), -m * omega * omega * r0 / (left * left)]);
    assert!((forward.values[0] - r).abs() < 1e-13, "{:?}", forward.values);
    assert!((forward.values[1] - r * (0.5 * omega).cos()).abs() < 1e-8, "{:?}", forward.values);
    assert_eq!(forward.stability.map(|course| course.end.verdict()), Some(Verdict::Stable));
    let own = analysis.adjoint(&prepared.x, &forward).unwrap();
    let turned = [by[0] * (0.5 * omega).cos() - r * 0.5 * (0.5 * omega).sin(), by[1] * (0.5 * omega).cos()];
    for (variable, (start, end)) in by.into_iter().zip(turned).enumerate() {
        assert!((own.rows[0][variable] - start).abs() < 1e-14, "{:?}", own.rows);
        assert!((own.rows[1][variable] - end).abs() < 1e-7 * end.abs().max(1e-3), "{:?} {end}", own.rows);
    }
    let steps = analysis.complex_step(&prepared.x, &forward).unwrap();
    own.rows.iter().zip(&steps.rows).for_each(|(own, steps)| assert!(largest_difference(own, steps) < 1e-12));
}

#[test]
fn beyond_its_critical_speed_a_mass_turns_on_the_other_side() {
    // beyond sqrt(k / m) = 31.6 rad/s the energy in the frame is not least
    let line = "type = \"line\"\nbetween = [\"hub\", \"mass\"]\nstiffness = \"k\"\nrest_length = 0.5";
    let along =
        "type = \"slide\"\nbetween = [\"hub\", \"mass\"]\naxis = [1, 0, 0]\nstiffness = \"k\"\nrest_displacement = 0.5";
    let scene = parsed(&whirled(&[("initial = 20,", "initial = 50,"), (line, along)]));
    let prepared = prepared(&scene);
    let start = prepared.resting_start().unwrap();
    let place = prepared.model().nodes.iter().find(|node| node.name == "mass").map(|node| node.dofs.start).unwrap();
    let (m, k, omega, r0) = (2.0, 2000.0, 50.0, 0.5);
    let r = k * r0 / (k - m * omega * omega);
    assert!((start[place] - r).abs() < 1e-12, "{} {r}", start[place]);
    let short = Prepared::with(&scene, &prepared.x, prepared.method.clone(), {
        let mut settings = costate::scenes::AnyScene::settings(&scene);
        (settings.end, settings.steps) = (1e-3, 2);
        settings
    });
    let short = short.unwrap();
    assert_eq!(forward(&short).stability.map(|course| course.end.verdict()), Some(Verdict::Undecided));
}

#[test]
fn all_kinds_of_members_go_on_turning() {
    // gravity along the axis
    let text = include_str!("coverage/steady.toml");
    let upright = text
        .replace("gravity = [3, 0, -9.81]", "gravity = [0, 0, -9.81]")
        .replace("end = 0.1\nsteps = 20", "end = 0.05\nsteps = 100");
    let scene = parsed(&upright);
    let prepared = prepared(&scene);
    let (start, mut most, mut speed) = (prepared.resting_start().unwrap(), 0.0_f64, 0.0_f64);
    // distances of tips from the axis, and heights, in every step
    let model = prepared.model();
    let places: Vec<usize> = model.nodes.iter().filter(|node| !node.fixed).map(|node| node.dofs.start).collect();
    let measure = |q: &[f64], first: usize| [(q[first] - 0.05).hypot(q[first + 1]), q[first + 2]];
    let see = |sample: &costate::functionals::Sample<f64>| {
        for &first in &places {
            let (own, before) = (measure(&sample.at.q, first), measure(&start, first));
            most = own.iter().zip(before).fold(most, |most, (own, before)| most.max((own - before).abs()));
            speed = speed.max(sample.at.v[first].abs());
        }
    };
    prepared.analysis().for_each_sample(&forward(&prepared), see).unwrap();
    assert!(most < 1e-8 && speed > 10.0, "{most:e} m at {speed} m/s");
    // weights count along the axis: gravity across it changes nothing
    let inclined = self::parsed(text);
    let other = self::prepared(&inclined).resting_start().unwrap();
    assert!(start.iter().zip(&other).all(|(own, other)| own == other));
}

#[test]
fn gradients_of_a_steady_turn_are_quotients_of_whole_runs() {
    let scene = parsed(include_str!("coverage/steady.toml"));
    let prepared = prepared(&scene);
    let analysis = prepared.analysis();
    let own = analysis.adjoint(&prepared.x, &forward(&prepared)).unwrap();
    for (variable, x) in prepared.x.iter().enumerate() {
        let mut direction = vec![0.0; prepared.x.len()];
        direction[variable] = *x;
        for (row, by_runs) in own.rows.iter().zip(analysis.quotients(&prepared.x, &direction).unwrap()) {
            let own = row[variable] * x;
            assert!((own - by_runs.value).abs() < 1e-6 * own.abs().max(1e-3), "{variable}: {own} {}", by_runs.value);
        }
    }
}

#[test]
fn what_does_not_turn_on_is_refused_by_name() {
    let load = "[[force]]\nname = \"wind\"\non = \"mass\"\ndirection = [0, 1, 0]\nsize = 3\n[[spin]]";
    let text = refused(&whirled(&[("[[spin]]", load)]));
    assert!(text.contains("not steady") && text.contains("\"wind\""), "{text}");
    let driven = "[[driver]]\nname = \"motor\"\ntype = \"rotation\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
                  angle = { type = \"formula\", value = \"20 * t + 3 * t^2\" }\n[[spin]]";
    let held = "[[hold]]\nnodes = [\"hub\"]\ndirections = [\"rotation_z\"]\n";
    let text = refused(&whirled(&[("[[spin]]", driven), (held, "")]));
    assert!(text.contains("not steady") && text.contains("\"motor\""), "{text}");
    let slow = driven.replace("20 * t + 3 * t^2", "19 * t");
    let text = refused(&whirled(&[("[[spin]]", &slow), (held, "")]));
    assert!(text.contains("dg/dt") && text.contains("\"motor\""), "{text}");
    let text = refused(&whirled(&[("parts = [\"hub\", \"mass\"]", "parts = [\"hub\"]")]));
    assert!(text.contains("slide"), "{text}");
    let text = refused(&whirled(&[(
        "inertia = [0.1, 0.1, 0.1]\n[[body]]",
        "inertia = [0.1, 0.1, 0.1]\nangular_velocity = [0, 0, 3]\n[[body]]",
    )]));
    assert!(text.contains("initial velocity of \"hub\"") && text.contains("leave it out"), "{text}");
    let text = refused(&whirled(&[("start = \"steady\"\n", "")]));
    assert!(text.contains("[[spin]]") && text.contains("start = \"steady\""), "{text}");
    let text = refused(&whirled(&[("[[spin]]\nparts = [\"hub\", \"mass\"]\naxis = [0, 0, 3]\nrate = \"omega\"\n", "")]));
    assert!(text.contains("needs a [[spin]]"), "{text}");
    let twice = "[[spin]]\nparts = [\"mass\"]\naxis = [0, 0, 1]\nrate = 2\n[[functional]]\nname = \"start\"";
    let text = refused(&whirled(&[("[[functional]]\nname = \"start\"", twice)]));
    assert!(text.contains("one steady turn"), "{text}");
    let text = refused(&whirled(&[("axis = [0, 0, 3]", "axis = [0, 0, 0]")]));
    assert!(text.contains("a direction cannot be [0.0, 0.0, 0.0]"), "{text}");
}
