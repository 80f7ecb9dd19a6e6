//! Motions that begin at an equilibrium: where it is, that nothing moves there, what is let go, gradients through it.

use super::{parsed, refused};
use costate::history::Keep;
use costate::integrators::Verdict;
use costate::scenes::{FileScene, Prepared, built_in};
use costate::sensitivity::{Forward, largest_difference};

/// A mass on a spring that hangs from the ground, 1 m long without load, with more keys and sections; starts at its given place or not.
fn hanging(more: &str) -> String {
    format!(
        "version = 1\ngravity = [0, 0, -9.81]\n[variable]\nk = {{ initial = 100, bounds = [10, 1000], unit = \"N/m\" }}\n\
         m = {{ initial = 2, bounds = [0.1, 10], unit = \"kg\" }}\n\
         [[point]]\nname = \"mass\"\nposition = [0, 0, -1]\nmass = \"m\"\n\
         [[spring]]\nname = \"spring\"\ntype = \"line\"\nbetween = [\"ground\", \"mass\"]\nstiffness = \"k\"\nrest_length = 1\n\
         [[functional]]\nname = \"start\"\ntype = \"position\"\non = \"mass\"\ndirection = [0, 0, 1]\nover = \"initial\"\n\
         [[functional]]\nname = \"end\"\ntype = \"position\"\non = \"mass\"\ndirection = [0, 0, 1]\nover = \"terminal\"\n\
         [settings]\nstart = \"equilibrium\"\nend = 0.5\nsteps = 400\n{more}"
    )
}

const SIDEWAYS: &str = "[[hold]]\nnodes = [\"mass\"]\ndirections = [\"x\", \"y\"]\n";

fn prepared(scene: &FileScene) -> Prepared<'_> {
    Prepared::new(scene).unwrap_or_else(|why| panic!("{why}"))
}

fn forward(prepared: &Prepared) -> Forward {
    prepared.analysis().forward(&prepared.x).unwrap_or_else(|why| panic!("{why}"))
}

/// Largest relative difference of adjoint and complex step.
fn check(prepared: &Prepared, forward: &Forward) -> f64 {
    let analysis = prepared.analysis();
    let own = analysis.adjoint(&prepared.x, forward).unwrap_or_else(|why| panic!("{why}"));
    let other = analysis.complex_step(&prepared.x, forward).unwrap_or_else(|why| panic!("{why}"));
    let pairs = own.rows.iter().zip(&other.rows);
    pairs.fold(0.0, |most: f64, (own, other)| most.max(largest_difference(other, own)))
}

#[test]
fn a_mass_hangs_where_its_spring_carries_it() {
    let scene = parsed(&hanging(SIDEWAYS));
    let prepared = prepared(&scene);
    let forward = forward(&prepared);
    let sag = 2.0 * 9.81 / 100.0;
    for value in &forward.values {
        assert!((value + 1.0 + sag).abs() < 1e-12, "{:?}", forward.values);
    }
    assert_eq!(forward.stability.map(|course| course.end.verdict()), Some(Verdict::Stable));
    let gradient = prepared.analysis().adjoint(&prepared.x, &forward).unwrap();
    for row in gradient.rows {
        assert!((row[0] - sag / 100.0).abs() < 1e-13 && (row[1] + sag / 2.0).abs() < 1e-13, "{row:?}");
    }
    assert!(check(&prepared, &forward) < 1e-12);
}

#[test]
fn what_is_held_is_let_go() {
    // held in all directions where it stands, which is where the spring is without load: it falls from there
    let scene = parsed(&hanging("[[hold]]\nnodes = [\"mass\"]\n"));
    let prepared = prepared(&scene);
    let forward = forward(&prepared);
    let exact = |k: f64, m: f64| -1.0 - m * 9.81 / k * (1.0 - ((k / m).sqrt() * 0.5).cos());
    assert!((forward.values[0] + 1.0).abs() < 1e-14, "{:?}", forward.values);
    assert!((forward.values[1] - exact(100.0, 2.0)).abs() < 1e-8, "{:?}", forward.values);
    let rows = prepared.analysis().adjoint(&prepared.x, &forward).unwrap().rows;
    let slope = (exact(100.1, 2.0) - exact(99.9, 2.0)) / 0.2;
    assert!(rows[0].iter().all(|entry| entry.abs() < 1e-15) && (rows[1][0] - slope).abs() < 1e-7, "{rows:?} {slope}");
    assert!(check(&prepared, &forward) < 1e-12);
}

/// A bar on two springs, guided along z and about y, with its mass off the middle by a variable.
const SUSPENDED: &str = r#"
version = 1
gravity = [0, 0, -9.81]
[variable]
front = { initial = 20000, bounds = [5000, 50000], unit = "N/m" }
rear = { initial = 24000, bounds = [5000, 50000], unit = "N/m" }
off = { initial = -0.3, bounds = [-1, 1], unit = "m" }
[[body]]
name = "guide"
position = [0, 0, 0.6]
mass = 1
inertia = [1, 1, 1]
[[body]]
name = "bar"
position = [0, 0, 0.6]
mass = 400
mass_centre = ["off", 0, 0.1]
inertia = [10, 500, 500]
[[joint]]
name = "slide"
type = "prismatic"
between = ["ground", "guide"]
axis = [0, 0, 1]
[[joint]]
name = "hinge"
type = "revolute"
between = ["guide", "bar"]
axis = [0, 1, 0]
[[spring]]
name = "front spring"
type = "line"
between = ["ground", "bar"]
points = [[1.2, 0, 0], [1.2, 0, 0.6]]
stiffness = "front"
rest_length = 0.65
[[spring]]
name = "rear spring"
type = "line"
between = ["ground", "bar"]
points = [[-1.2, 0, 0], [-1.2, 0, 0.6]]
stiffness = "rear"
rest_length = 0.65
[[functional]]
name = "nose"
type = "position"
on = "bar"
point = [1.2, 0, 0.6]
direction = [0, 0, 1]
over = "terminal"
[settings]
start = "equilibrium"
end = 0.5
steps = 50
"#;

/// Largest velocity of a coordinate in a run.
fn largest_rate(prepared: &Prepared) -> f64 {
    let forward = forward(prepared);
    let mut most = 0.0_f64;
    let see = |sample: &costate::functionals::Sample<f64>| {
        most = sample.at.v.iter().fold(most, |most, v| most.max(v.abs()));
    };
    prepared.analysis().for_each_sample(&forward, see).unwrap();
    most
}

#[test]
fn nothing_moves_at_an_equilibrium() {
    let scene = parsed(SUSPENDED);
    let prepared = prepared(&scene);
    assert!(largest_rate(&prepared) < 1e-9, "{:e}", largest_rate(&prepared));
    // the springs carry the weight with the lever of its centre
    let forward = forward(&prepared);
    let nose = forward.values[0];
    assert!((0.5..0.6).contains(&nose), "{nose}");
    assert!(check(&prepared, &forward) < 1e-12);
    let gradient = prepared.analysis().adjoint(&prepared.x, &forward).unwrap();
    for (k, &entry) in gradient.rows[0].iter().enumerate() {
        let mut direction = vec![0.0; prepared.x.len()];
        direction[k] = prepared.x[k].abs();
        let by_runs = prepared.analysis().quotients(&prepared.x, &direction).unwrap()[0].value;
        assert!((by_runs / (entry * direction[k]) - 1.0).abs() < 1e-7, "{k}: {by_runs} {}", entry * direction[k]);
    }
}

/// A scene of the examples that begins at the equilibrium of its first position instead, for a short time.
fn example(name: &str, steps: usize, end: f64) -> FileScene {
    let settings = format!("settings = {{ start = 'equilibrium', steps = {steps}, end = {end} }}");
    built_in::changed(name, &settings).unwrap_or_else(|why| panic!("{why}"))
}

#[test]
fn cables_and_shells_hang_down_from_their_hinges() {
    for (name, tip, height) in [
        // a rod of length 1.2 m under its own weight is longer by rho g L^2 / (2 E), to first order
        ("flexible-pendulum", "height of the tip at the end", -1.2),
        ("plate-pendulum", "height of the tip at the end", -0.25),
    ] {
        let scene = example(name, 5, 0.01);
        let prepared = prepared(&scene);
        assert!(largest_rate(&prepared) < 1e-9, "{name}: {:e}", largest_rate(&prepared));
        let forward = forward(&prepared);
        let own = forward.values[prepared.functional(tip).unwrap()];
        assert!((own - height).abs() < 3e-3 && own < height, "{name}: {own}");
        let analysis = prepared.analysis();
        // by relative changes of the variables: derivatives by a height and by a density differ by orders of ten
        let relative = |row: Vec<f64>| row.iter().zip(&prepared.x).map(|(own, x)| own * x).collect::<Vec<_>>();
        let rows = [analysis.adjoint(&prepared.x, &forward), analysis.complex_step(&prepared.x, &forward)]
            .map(|own| own.unwrap().rows.into_iter().map(relative).collect::<Vec<_>>());
        for (k, (adjoint, complex_step)) in rows[0].iter().zip(&rows[1]).enumerate() {
            let apart = largest_difference(complex_step, adjoint);
            assert!(apart < 1e-13, "{name}, {k}: {apart:e}");
        }
    }
}

#[test]
fn a_bent_plate_that_is_stiff_in_its_plane_has_derivatives_to_the_last_digits() {
    let scene = example("perforated-plate", 1, 0.01);
    let prepared = prepared(&scene);
    let forward = forward(&prepared);
    // of the matrix of the equilibrium alone the adjoint of the moment would have nine digits
    let apart = check(&prepared, &forward);
    assert!(apart < 1e-12, "{apart:e}");
}

#[test]
fn it_is_the_equilibrium_of_load_steps() {
    let bent = |settings: &str| {
        format!(
            "version = 1\ngravity = [0, 0, -9.81]\n[variable]\nwidth = {{ initial = 0.004, bounds = [0.001, 0.01], unit = \"m\" }}\n\
             [material]\nsteel = {{ young = 2e11, poisson = 0.3, density = 7800 }}\n\
             [section]\nstrip = {{ type = \"rectangle\", width = 0.02, height = \"width\", material = \"steel\" }}\n\
             [[beam]]\nname = \"beam\"\nfrom = [0, 0, 0]\nto = [2, 0, 0]\nelements = 8\nsection = \"strip\"\nclamped = [\"start\"]\n\
             second_axis = [0, 1, 0]\n\
             [[functional]]\nname = \"tip\"\ntype = \"position\"\non = \"beam.end\"\ndirection = [0, 0, 1]\nover = \"terminal\"\n\
             [settings]\n{settings}\n"
        )
    };
    let of = |settings: &str| {
        let scene = parsed(&bent(settings));
        let prepared = prepared(&scene);
        let forward = forward(&prepared);
        let gradient = prepared.analysis().adjoint(&prepared.x, &forward).unwrap();
        [forward.values[0], gradient.rows[0][0]]
    };
    let [tip, slope] = of("method = \"static\"\nsteps = 4");
    let [own, own_slope] = of("start = \"equilibrium\"\nend = 0.01\nsteps = 10");
    assert!(tip < -0.1 && (own - tip).abs() < 1e-9, "{own} {tip}");
    assert!((own_slope / slope - 1.0).abs() < 1e-7, "{own_slope} {slope}");
}

#[test]
fn histories_on_disk_and_checkpoints_lead_back_through_it() {
    let scene = parsed(SUSPENDED);
    let own = prepared(&scene);
    let expected = own.analysis().adjoint(&own.x, &forward(&own)).unwrap().rows;
    let folder = std::env::temp_dir().join(format!("costate-equilibrium-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for keep in [Keep::File(folder.join("run.bin")), Keep::Resumed(folder.join("run.bin")), Keep::Checkpoints(1 << 20)] {
        let mut prepared = prepared(&scene);
        prepared.keep = keep;
        let gradient = prepared.analysis().adjoint(&prepared.x, &forward(&prepared)).unwrap();
        assert_eq!(gradient.rows, expected, "{:?}", prepared.keep);
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_rod_that_stands_on_its_hinge_is_told() {
    let upright = "version = 1\ngravity = [0, 0, -9.81]\n[[body]]\nname = \"rod\"\nposition = [0, 0, 0.5]\nmass = 1\ninertia = [1, 1, 1]\n\
                   [[joint]]\nname = \"hinge\"\ntype = \"revolute\"\nbetween = [\"ground\", \"rod\"]\npoint = [0, 0, 0]\naxis = [0, 1, 0]\n\
                   [[functional]]\nname = \"z\"\ntype = \"position\"\non = \"rod\"\ndirection = [0, 0, 1]\nover = \"initial\"\n\
                   [settings]\nstart = \"equilibrium\"\nend = 0.1\nsteps = 10\n";
    let height = |text: &str| {
        let scene = parsed(text);
        let prepared = prepared(&scene);
        let forward = forward(&prepared);
        (forward.values[0], forward.stability.map(|course| course.end.verdict()))
    };
    let (z, verdict) = height(upright);
    assert!((z - 0.5).abs() < 1e-12 && verdict == Some(Verdict::Unstable), "{z} {verdict:?}");
    // a little beside, it falls down
    let (z, verdict) = height(&upright.replace("position = [0, 0, 0.5]", "position = [0.01, 0, 0.5]"));
    assert!((z + 0.5_f64.hypot(0.01)).abs() < 1e-12 && verdict == Some(Verdict::Stable), "{z} {verdict:?}");
}

#[test]
fn what_has_no_equilibrium_is_refused() {
    let moving = hanging(SIDEWAYS).replace("position = [0, 0, -1]", "position = [0, 0, -1]\nvelocity = [0, 0, 1]");
    let omega = (100.0_f64 / 2.0).sqrt();
    let exact = -1.0 - 2.0 * 9.81 / 100.0 + (omega * 0.5).sin() / omega;
    let end = forward(&prepared(&parsed(&moving))).values[1];
    assert!((end - exact).abs() < 1e-8, "velocities stay: {end} for {exact}");
    for (text, parts) in [
        // a body that hangs from its own point can turn as it likes
        (
            hanging("").replace("[[point]]", "[[body]]\ninertia = [1, 1, 1]"),
            &["\"mass\"", "[[hold]]", "nothing but inertia holds it"][..],
        ),
        (hanging(SIDEWAYS).replace("stiffness = \"k\"", "stiffness = 0"), &["\"mass\", z goes on moving", "[[hold]]"]),
        (hanging(SIDEWAYS).replace("start = \"equilibrium\"\n", ""), &["[[hold]]", "start = \"equilibrium\""]),
        (
            hanging(&SIDEWAYS.replace("\"x\"", "\"rotation_x\"")),
            &["\"mass\" cannot be held in the direction rotation_x", "a point"],
        ),
        (hanging(&SIDEWAYS.replace("\"mass\"", "\"ground\"")), &["\"ground\" cannot be held: it never moves"]),
        (
            hanging(SIDEWAYS).replace("start =", "method = \"static\"\nstart ="),
            &["start of [settings] means nothing with the method static"],
        ),
        (
            SUSPENDED.replace("inertia = [1, 1, 1]", "inertia = [1, 1, 1]\nvelocity = [0, 0, 1]"),
            &["at the equilibrium where the motion begins", "dg/dt"],
        ),
    ] {
        let told = refused(&text);
        parts.iter().for_each(|part| assert!(told.contains(part), "{part}: {told}"));
    }
}

#[test]
fn what_stands_on_its_tip_stays_there_however_fast_it_would_fall() {
    // so heavy that no step of the search from rest is short enough
    let text = "version = 1\ngravity = [0, 0, -2000]\nsettings = { start = \"equilibrium\", end = 1e-3, steps = 2 }\n\
                variable.m = { initial = 2, bounds = [1, 3], unit = \"kg\" }\n\
                [[body]]\nname = \"rod\"\nmass = \"m\"\nmass_centre = [0, 0, 1]\ninertia = [0.1, 0.1, 0.1]\n\
                [[joint]]\nname = \"hinge\"\ntype = \"revolute\"\nbetween = [\"ground\", \"rod\"]\naxis = [0, 1, 0]\n\
                [[functional]]\nname = \"tip\"\ntype = \"position\"\non = \"rod\"\npoint = [0, 0, 1]\ndirection = [0, 0, 1]\nover = \"initial\"\n";
    let scene = parsed(text);
    let prepared = prepared(&scene);
    let forward = forward(&prepared);
    assert_eq!(forward.values, [1.0]);
    assert_eq!(forward.stability.map(|course| course.end.verdict()), Some(Verdict::Unstable));
}
