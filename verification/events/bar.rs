//! A bar of springs and masses that hits a rigid wall: its time of contact against 2 L / c of the continuum.

use super::{Check, measure};
use crate::Report;

/// Elements of the bar.
const ELEMENTS: [usize; 4] = [4, 8, 16, 32];
/// Speed before [m/s].
const SPEED: f64 = 1.5;
/// Height of the face above the wall at which it counts as gone [m]; the way of a wave during contact is some 0.1 mm.
const GONE: f64 = 1e-9;

/// E = 210 GPa, 7800 kg/m3, 100 mm2, 0.5 m, 1.5 m/s: elements of lumped masses, the face stops at the wall without restitution.
fn text(elements: usize) -> String {
    let mut text = "version = 1\nsettings = { end = 3.5e-4, steps = 400 }\n\
         variable.E = { initial = 210e9, bounds = [1e9, 1e12], unit = \"Pa\" }\n\
         define = { rho = 7800, A = 1e-4, L = 0.5 }\n"
        .to_string();
    let (mut nodes, mut springs, mut mean) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=elements {
        nodes.push(format!("{{ name = \"u{i}\", initial = 2.9e-5, rate = -{SPEED} }}"));
        mean.push(format!("{} * n{i}.rate", if i == 0 || i == elements { 0.5 } else { 1.0 }));
    }
    for i in 0..elements {
        springs.push(format!(
            "{{ name = \"bar {i}\", nodes = {{ a = \"u{i}\", b = \"u{}\" }}, kinetic = \"rho * A * L / {} * (a.rate^2 + b.rate^2)\", \
             potential = \"0.5 * E * A * {elements} / L * (b.value - a.value)^2\" }}",
            i + 1,
            4 * elements
        ));
    }
    let all: Vec<String> = (0..=elements).map(|i| format!("n{i} = \"u{i}\"")).collect();
    text += &format!("coordinate = [{}]\nelement = [{}]\n", nodes.join(", "), springs.join(", "));
    text += &format!(
        "stop = [{{ name = \"wall\", on = \"u0\", least = 0 }}]\n\
         event = [{{ name = \"leaves\", nodes = {{ u = \"u0\" }}, when = \"u.value - {GONE:e}\", direction = \"rising\" }}]\n\
         functional = [{{ name = \"hit\", type = \"event_time\", event = \"wall\", over = \"terminal\" }}, \
         {{ name = \"left\", type = \"event_time\", event = \"leaves\", over = \"terminal\" }}, \
         {{ name = \"rebound\", type = \"formula\", nodes = {{ {} }}, value = \"({}) / {elements}\", unit = \"m/s\", over = \"terminal\" }}]\n",
        all.join(", "),
        mean.join(" + ")
    );
    text
}

/// Errors of the time of contact and of the rebound, and their orders in the mesh; the time is that of a wave, proportional to 1 / sqrt(E) whatever
/// the mesh.
pub fn against_a_wall(report: &mut Report, contact: f64) -> Result<(), String> {
    let mut errors = Vec::new();
    for elements in ELEMENTS {
        let own = measure(&text(elements), |settings| settings, Check::Gradient)?;
        let time = own.values[1] - own.values[0];
        let derivative = own.rows[1][0] - own.rows[0][0];
        errors.push([time / contact - 1.0, 1.0 - own.values[2] / SPEED]);
        let name = format!("bar, {elements} elements");
        report.inform(format!("{name}/relative error of the time of contact"), time / contact - 1.0);
        report.inform(format!("{name}/share of the speed that the bar does not get back"), 1.0 - own.values[2] / SPEED);
        // but for the way to where it counts as gone
        report.compare(format!("{name}/dT/dE of contact times E/T"), derivative * 210e9 / time, -0.5, 2e-3);
    }
    for (which, what, order) in [(0, "time of contact", 0.6), (1, "speed", 0.75)] {
        let [first, last] = [errors[0][which], errors[errors.len() - 1][which]];
        report.compare(format!("bar/order of the {what} in the mesh"), (first / last).log2() / 3.0, order, 0.1);
    }
    Ok(())
}
