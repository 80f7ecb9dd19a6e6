//! Modes of what is damped, controlled or turns, against closed forms.

use super::parsed;
use costate::integrators::Mode;
use costate::scenes::Prepared;
use num_complex::Complex64;

fn modes(text: &str, count: usize) -> Vec<Mode> {
    let scene = parsed(text);
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    prepared.complex_modes_with_state(count).unwrap_or_else(|why| panic!("{why}")).1
}

/// Values lambda with a positive imaginary part or none, in the order of their sizes.
fn sorted(values: impl IntoIterator<Item = Complex64>) -> Vec<Complex64> {
    let mut values: Vec<Complex64> = values.into_iter().map(|own| Complex64::new(own.re, own.im.abs())).collect();
    values.sort_by(|a, b| a.norm().total_cmp(&b.norm()).then(a.re.total_cmp(&b.re)));
    values
}

fn assert_values(modes: &[Mode], expected: Vec<Complex64>) {
    let own = sorted(modes.iter().map(|mode| Complex64::new(mode.growth, mode.frequency)));
    let expected = sorted(expected);
    assert_eq!(own.len(), expected.len(), "{own:?} {expected:?}");
    let size = expected.iter().fold(0.0, |size: f64, value| size.max(value.norm()));
    for (own, expected) in own.iter().zip(&expected) {
        assert!((own - expected).norm() < 1e-9 * expected.norm().max(1e-3 * size), "{own} {expected}");
    }
}

/// Both roots of x^2 + 2 half x + product.
fn roots(half: Complex64, product: Complex64) -> [Complex64; 2] {
    let root = (half * half - product).sqrt();
    [root - half, -root - half]
}

fn real(x: f64) -> Complex64 {
    Complex64::new(x, 0.0)
}

/// A mass of 2 kg that slides along x between a spring of 200 N/m and a damper, with more text.
fn sliding(damping: f64, more: &str) -> String {
    format!(
        "version = 1\n[variable]\nc = {{ initial = {damping}, bounds = [0, 100], unit = \"N s/m\" }}\n[settings]\nend = 1\nsteps = 10\n\
         [[body]]\nname = \"mass\"\nmass = 2\ninertia = [1, 1, 1]\n\
         [[joint]]\nname = \"slide\"\ntype = \"prismatic\"\nbetween = [\"ground\", \"mass\"]\naxis = [1, 0, 0]\n\
         [[spring]]\nname = \"spring\"\ntype = \"slide\"\nbetween = [\"ground\", \"mass\"]\naxis = [1, 0, 0]\nstiffness = 200\ndamping = \"c\"\n\
         [[functional]]\nname = \"x\"\ntype = \"position\"\non = \"mass\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n{more}"
    )
}

#[test]
fn a_damped_mass_has_the_roots_of_its_polynomial() {
    for damping in [0.0, 8.0, 39.999, 80.0] {
        let pair = roots(real(0.25 * damping), real(100.0));
        let expected = if damping < 40.0 { pair[..1].to_vec() } else { pair.to_vec() };
        let modes = modes(&sliding(damping, ""), 2);
        assert_values(&modes, expected);
        if damping == 8.0 {
            assert!((modes[0].damping_ratio() - 0.2).abs() < 1e-12, "{}", modes[0].damping_ratio());
        }
    }
}

#[test]
fn states_of_first_order_are_modes_too() {
    // m x'' + c x' + k x = z,  z' = -6 z - 500 x
    let more = "[[state]]\nname = \"control\"\ntype = \"formula\"\nnodes = { m = \"mass\" }\ninitial = { z = 0 }\n\
                rate = { z = \"-6 * control.z - 500 * m.position.x\" }\n\
                [[element]]\nname = \"actuator\"\nnodes = { m = \"mass\", own = \"control\" }\nforce = { m = \"[own.z, 0, 0]\" }\n";
    let more = more.replace("control.z", "z");
    let modes = modes(&sliding(8.0, &more), 4);
    assert_eq!(modes.len(), 2, "{modes:?}");
    for mode in &modes {
        let x = Complex64::new(mode.growth, mode.frequency);
        let left = (x * x * 2.0 + x * 8.0 + 200.0) * (x + 6.0) + 500.0;
        assert!(left.norm() < 1e-9 * 1700.0, "{x}: {left}");
    }
    // of three roots one is real
    assert!(modes.iter().any(|mode| mode.frequency == 0.0) && modes.iter().any(|mode| mode.frequency > 1.0));
}

/// A disc on a bushing of a hub that turns, both about z.
fn disc(rate: f64, damping: [f64; 2]) -> String {
    let [along, about] = damping;
    format!(
        "version = 1\n[variable]\nrate = {{ initial = {rate}, bounds = [-500, 500], unit = \"rad/s\" }}\n\
         [settings]\nstart = \"steady\"\nend = 0.01\nsteps = 2\n\
         [[body]]\nname = \"hub\"\nmass = 1\ninertia = [1, 1, 1]\n\
         [[body]]\nname = \"disc\"\nmass = 2\ninertia = [0.03, 0.03, 0.05]\n\
         [[joint]]\nname = \"shaft\"\ntype = \"revolute\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         [[driver]]\nname = \"motor\"\ntype = \"rotation\"\nbetween = [\"ground\", \"hub\"]\naxis = [0, 0, 1]\n\
         angle = {{ type = \"formula\", value = \"rate * t\" }}\n\
         [[spring]]\nname = \"shaft's stiffness\"\ntype = \"bushing\"\nbetween = [\"hub\", \"disc\"]\nstiffness = [800, 800, 5000, 30, 30, 70]\n\
         damping = [{along}, {along}, 0, {about}, {about}, 0]\n\
         [[spin]]\nparts = [\"hub\", \"disc\"]\naxis = [0, 0, 1]\nrate = \"rate\"\n\
         [[functional]]\nname = \"x\"\ntype = \"position\"\non = \"disc\"\ndirection = [1, 0, 0]\nover = \"terminal\"\n"
    )
}

#[test]
fn a_turning_disc_has_the_modes_of_a_rotor_seen_from_its_shaft() {
    let (m, across, polar, diametral, tilt) = (2.0, 800.0, 0.05, 0.03, 30.0);
    for rate in [0.0, 7.0, -7.0, 19.0, 60.0] {
        for damping in [[0.0; 2], [3.0, 0.2]] {
            let i = Complex64::I;
            // z = x + i y in the frame: z'' + (c/m + 2 i W) z' + (k/m - W^2) z = 0
            let moves = roots(0.5 * real(damping[0] / m) + i * rate, real(across / m - rate * rate));
            // of a tilt a + i b: It a'' + (c + i (2 It - Ip) W) a' + (k + (Ip - It) W^2) a = 0
            let [own, stiff] = [2.0 * diametral - polar, tilt + (polar - diametral) * rate * rate];
            let tilts = roots(0.5 * (real(damping[1]) + i * own * rate) / diametral, real(stiff / diametral));
            let alone = [5000.0 / m, 70.0 / polar].map(|square: f64| Complex64::new(0.0, square.sqrt()));
            let expected = [&moves[..], &tilts, &alone].concat();
            let found = modes(&disc(rate, damping), 6);
            assert_values(&found, expected);
            // what a shaft's own damping does beyond its critical speed of 20 rad/s
            let grows = found.iter().any(|mode| mode.growth > 1e-6);
            assert_eq!(grows, damping[0] > 0.0 && rate.abs() > 20.0, "{rate} {damping:?} {found:?}");
        }
    }
}

#[test]
fn whirls_have_the_sense_of_their_circles() {
    let text = disc(7.0, [0.0; 2]);
    let scene = parsed(&text);
    let prepared = Prepared::new(&scene).unwrap();
    let (q, found) = prepared.complex_modes_with_state(6).unwrap();
    // seen from the shaft the circle of 20 rad/s along with the turn is one of 13, the one against it one of 27
    let [own, stiff]: [f64; 2] = [0.01 * 7.0 / 0.06, (30.0 + 0.02 * 49.0) / 0.03];
    let tilts = [own, -own].map(|own| (stiff + own * own).sqrt() + own);
    for (omega, sense) in [(13.0, 1.0), (27.0, -1.0), (tilts[0], -1.0), (tilts[1], 1.0)] {
        let mode = found.iter().find(|mode| (mode.frequency - omega).abs() < 1e-6).unwrap();
        let whirl = prepared.whirl(&q, mode).unwrap();
        assert!((whirl - sense).abs() < 1e-6, "{omega}: {whirl}");
    }
}

/// Two bodies on a bushing that nothing holds; with more text.
fn free_pair(damping: f64, more: &str) -> String {
    format!(
        "version = 1\nsettings = {{ end = 1, steps = 10 }}\n\
         body = [{{ name = \"left\", mass = 1.3, inertia = [0.2, 0.3, 0.4] }}, \
         {{ name = \"right\", position = [1, 0, 0], mass = 1.3, inertia = [0.2, 0.3, 0.4] }}]\n\
         [[spring]]\nname = \"bushing\"\ntype = \"bushing\"\nbetween = [\"left\", \"right\"]\npoint = [0.5, 0, 0]\n\
         stiffness = [100, 200, 300, 40, 50, 60]\ndamping = [{damping}, 0, 0, 0, 0, 0]\n{more}"
    )
}

#[test]
fn every_count_shows_the_first_of_all_modes() {
    // a point on a damper alone: it rests anywhere, and comes to rest at c/m
    let braked = "[[point]]\nname = \"p\"\nposition = [0, 2, 0]\nmass = 2\n\
                  [[joint]]\nname = \"line\"\ntype = \"point_on_line\"\nbetween = [\"ground\", \"p\"]\naxis = [1, 0, 0]\n\
                  [[spring]]\nname = \"brake\"\ntype = \"slide\"\nbetween = [\"ground\", \"p\"]\naxis = [1, 0, 0]\nstiffness = 0\ndamping = 6\n";
    for (damping, more, rigid, others) in [(0.0, "", 6, 6), (9.0, "", 6, 6), (40.0, "", 6, 7), (9.0, braked, 7, 7)] {
        let scene = parsed(&free_pair(damping, more));
        let prepared = Prepared::new(&scene).unwrap();
        let all = prepared.modes_at_rest(40, true).unwrap();
        assert!(all.proved && all.modes.len() == rigid + others, "{damping}: {:?}", all.modes);
        for (place, mode) in all.modes.iter().enumerate() {
            assert_eq!(mode.frequency == 0.0 && mode.growth == 0.0, place < rigid, "{damping}, {place}: {mode:?}");
        }
        // along the line: x'' + 2 c/m x' + 2 k/m x = 0
        let pair = roots(real(damping / 1.3), real(200.0 / 1.3));
        for root in if pair[0].im == 0.0 { &pair[..] } else { &pair[..1] } {
            let near = |mode: &Mode| (Complex64::new(mode.growth, mode.frequency) - root).norm() < 1e-9 * root.norm();
            assert!(all.modes.iter().any(near), "{damping}: {root}");
        }
        assert!(more.is_empty() || all.modes.iter().any(|mode| mode.frequency == 0.0 && (mode.growth + 3.0).abs() < 1e-9));
        for count in 1..=rigid + others + 1 {
            let found = prepared.modes_at_rest(count, true).unwrap().modes;
            assert_eq!(found.len(), count.min(rigid + others), "{damping}: {count}");
            for (own, expected) in found.iter().zip(&all.modes) {
                let [own, expected] = [own, expected].map(|mode| Complex64::new(mode.growth, mode.frequency));
                assert!((own - expected).norm() <= 1e-9 * expected.norm(), "{damping}, {count}: {own} {expected}");
            }
        }
    }
}

#[test]
fn modes_of_a_large_damped_model_are_all_there_at_every_count() {
    let chain: String = (0..150)
        .map(|k| {
            let point = format!(
                "[[point]]\nname = \"p{k}\"\nposition = [{k}, 0, 0]\nmass = 1\n\
                 [[joint]]\nname = \"g{k}\"\ntype = \"point_on_line\"\nbetween = [\"ground\", \"p{k}\"]\naxis = [1, 0, 0]\n"
            );
            let spring = format!(
                "[[spring]]\nname = \"s{k}\"\ntype = \"line\"\nbetween = [\"p{}\", \"p{k}\"]\nstiffness = 100\n",
                (k + 149) % 150
            );
            if k == 0 { point } else { point + &spring }
        })
        .collect();
    let scene = parsed(&format!("version = 1\nsettings = {{ end = 1, steps = 10 }}\n{chain}"));
    let prepared = Prepared::new(&scene).unwrap();
    for count in [1, 5] {
        let found = prepared.modes_at_rest(count, true).unwrap();
        assert!(!found.proved && found.modes.len() == count, "{count}: {:?}", found.modes.len());
        for (k, mode) in found.modes.iter().enumerate() {
            // free chain: 2 sqrt(k/m) sin(pi j / 2 n), the first at rest
            let omega = 20.0 * (std::f64::consts::PI * k as f64 / 300.0).sin();
            let size = mode.frequency.hypot(mode.growth);
            assert!((size - omega).abs() <= 1e-8 * omega, "{count}, {k}: {size} {omega}");
        }
    }
}

#[test]
fn a_start_that_is_no_equilibrium_is_told_as_that() {
    let hinged = "[[joint]]\nname = \"hinge\"\ntype = \"revolute\"\nbetween = [\"left\", \"panel\"]\npoint = [-0.5, 0, 0]\naxis = [0, 1, 0]\n\
                  [[spring]]\nname = \"opens\"\ntype = \"torsion\"\nbetween = [\"left\", \"panel\"]\naxis = [0, 1, 0]\nstiffness = 0.3\nrest_angle = 1.7\n";
    let panel = "body = [{ name = \"panel\", position = [-0.5, 0, 0.4], mass = 4, inertia = [1, 1, 1] }, ";
    let scene = parsed(&free_pair(1.0, hinged).replace("body = [", panel));
    let prepared = Prepared::new(&scene).unwrap();
    for damped in [false, true] {
        let why = prepared.modes_at_rest(4, damped).unwrap_err().to_string();
        assert!(why.contains("need an equilibrium") && !why.contains("redundant"), "{why}");
    }
}

/// Stiffness of the angle of a joint alone: rigid motions leave that angle but for round-off, which no other term of the stiffness is measured by. Two
/// bodies that turn about the axis through both mass centres: omega^2 = k (1/I_1 + 1/I_2).
#[test]
fn free_bodies_are_held_together_by_the_angle_of_their_joint() {
    let text = |damping: f64, unit: f64| {
        let [inertia, other, k] = [0.3, 0.7, 5.0].map(|own| own * unit * unit);
        format!(
            r#"
version = 1
settings = {{ end = 1, steps = 10 }}
body = [
    {{ name = "a", position = [0, 0, {unit}], mass = 2, inertia = [{other}, {other}, {inertia}] }},
    {{ name = "b", mass = 3, inertia = [{other}, {other}, {other}] }},
]
joint = [{{ name = "hinge", type = "revolute", between = ["a", "b"], point = [0, 0, 0], axis = [0, 0, 1] }}]
joint_angle = [{{ name = "angle", between = ["a", "b"], axis = [0, 0, 1] }}]
element = [{{ name = "spring", nodes = {{ angle = "angle" }}, force = {{ angle = "-{k} * angle.value - {damping} * angle.rate" }} }}]
functional = [{{ name = "angle", type = "joint_angle", between = ["a", "b"], axis = [0, 0, 1], over = "terminal" }}]
"#
        )
    };
    let omega = (5.0_f64 * (1.0 / 0.3 + 1.0 / 0.7)).sqrt();
    for unit in [1e-3, 1.0, 1e3] {
        for count in [1, 6, 7, 9] {
            let scene = parsed(&text(0.0, unit));
            let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
            let undamped = prepared.modes(count).unwrap_or_else(|why| panic!("{unit} {count}: {why}"));
            for own in [undamped, modes(&text(0.0, unit), count)] {
                assert_eq!(own.len(), count.min(7), "{unit} {count}");
                assert!(own.iter().take(6).all(|mode| mode.frequency == 0.0), "{unit} {count}: {own:?}");
                assert!(
                    own.iter().skip(6).all(|mode| (mode.frequency - omega).abs() < 1e-9 * omega),
                    "{unit} {count}: {own:?}"
                );
            }
        }
    }
}
