//! Elements, joints and functionals by formulas of their nodes.

use super::{parsed, refused};
use costate::scenes::{FileScene, Prepared};

/// A body that spins and flies, and a point, in a field of gravity; and what is between them.
fn text(parts: &str) -> String {
    format!(
        "version = 1\ngravity = [0, 0, -9.81]\n\
         [variable]\nk = {{ initial = 40, bounds = [1, 100], unit = \"N/m\" }}\nl = {{ initial = 0.7, bounds = [0.1, 2], unit = \"m\" }}\n\
         [define]\narm = [0.2, 0, 0]\n\
         [[body]]\nname = \"body\"\nposition = [0.3, 0, \"l\"]\nmass = 2\ninertia = [0.02, 0.03, 0.04]\nvelocity = [0.3, 0.4, 1]\n\
         angular_velocity = [1, 2, 3]\n\
         [[point]]\nname = \"mass\"\nposition = [\"0.3 + l\", 0, 0]\nvelocity = [0, 1, 0]\nmass = 1.5\n\
         [[body]]\nname = \"wheel\"\ninertia = [0.1, 0.1, 0.2]\nmass = 1\n\
         [[joint]]\nname = \"bearing\"\ntype = \"revolute\"\nbetween = [\"ground\", \"wheel\"]\naxis = [0, 0, 1]\n\
         [[joint_angle]]\nname = \"angle\"\nbetween = [\"ground\", \"wheel\"]\naxis = [0, 0, 1]\n\
         {parts}\n\
         [[functional]]\nname = \"z\"\ntype = \"position\"\non = \"mass\"\ndirection = [0.1, 0.3, 1]\nover = \"terminal\"\n\
         [[functional]]\nname = \"height\"\ntype = \"position\"\non = \"body\"\npoint = [0.5, 0, \"l\"]\ndirection = [0.2, 0.1, 1]\n\
         over = \"integral\"\n\
         [[functional]]\nname = \"angle\"\ntype = \"coordinate\"\non = \"angle\"\nover = \"terminal\"\n\
         [settings]\nend = 0.4\nsteps = 80\nproject_start = true\n"
    )
}

/// Values and gradients at the design.
fn run(parts: &str) -> Vec<f64> {
    let scene = parsed(&text(parts));
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{why}"));
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap_or_else(|why| panic!("{why}"));
    forward.values.iter().copied().chain(gradient.rows.into_iter().flatten()).collect()
}

/// The same motion and the same gradients by parts of the library.
fn same(formulas: &str, library: &str, limit: f64) {
    let (own, twin) = (run(formulas), run(library));
    let size = twin.iter().fold(1.0, |most: f64, own| most.max(own.abs()));
    for (own, twin) in own.iter().zip(&twin) {
        assert!((own - twin).abs() <= limit * size, "{formulas}: {own} for {twin}");
    }
}

const HEADER: &str = "[[element]]\nname = \"own\"\n";

#[test]
fn a_coordinate_moves_as_its_equation_says() {
    let scene = FileScene::parse("coordinates.toml", include_str!("coverage/coordinates.toml")).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let run = prepared.run().unwrap();
    // m x'' + c x' + k x = 0
    let ([m, k, x, v], c, t): ([f64; 4], f64, f64) = ([1.3, 40.0, 0.3, 0.7], 0.4, 2.0);
    let (decay, undamped) = (0.5 * c / m, k / m);
    let rate = (undamped - decay * decay).sqrt();
    let exact = (-decay * t).exp() * (x * (rate * t).cos() + (v + decay * x) / rate * (rate * t).sin());
    assert!((run.forward.values[0] - exact).abs() < 1e-5, "{} for {exact}", run.forward.values[0]);
}

#[test]
fn energies_and_loads_are_those_of_the_library() {
    same(
        &format!(
            "{HEADER}nodes = {{ a = \"body\", b = \"mass\" }}\n\
             potential = \"0.5 * k * (norm(b.position - a.position - 0.2 * a.x_axis) - 0.5)^2\""
        ),
        "[[spring]]\nname = \"spring\"\ntype = \"line\"\nbetween = [\"body\", \"mass\"]\npoints = [[0.5, 0, \"l\"], [\"0.3 + l\", 0, 0]]\n\
         stiffness = \"k\"\nrest_length = 0.5",
        1e-11,
    );
    same(
        &format!(
            "{HEADER}nodes = {{ a = \"body\", b = \"mass\" }}\n\
             force = {{ a = \"0.1 * k * (b.velocity - a.velocity)\", b = \"0.1 * k * (a.velocity - b.velocity)\" }}"
        ),
        "[[damper]]\nname = \"damper\"\ntype = \"vector\"\nbetween = [\"body\", \"mass\"]\ndamping = \"0.1 * k\"",
        1e-11,
    );
    same(
        &format!(
            "{HEADER}nodes = {{ a = \"body\" }}\nforce = {{ a = \"k * sin(9 * t) * a.z_axis\" }}\n\
             moment = {{ a = [0, \"0.01 * k * cos(5 * t)\", 0] }}"
        ),
        "[[force]]\nname = \"force\"\non = \"body\"\nframe = \"body\"\ndirection = [0, 0, 1]\nsize = { type = \"formula\", value = \"k * sin(9 * t)\" }\n\
         [[torque]]\nname = \"torque\"\non = \"body\"\naxis = [0, 1, 0]\nsize = { type = \"formula\", value = \"0.01 * k * cos(5 * t)\" }",
        1e-11,
    );
    same(
        &format!(
            "{HEADER}nodes = {{ phi = \"angle\" }}\nforce = {{ phi = \"0.3 - 0.05 * k * phi.value - 0.2 * phi.rate\" }}"
        ),
        "[[spring]]\nname = \"spring\"\ntype = \"angle\"\non = \"angle\"\nstiffness = \"0.05 * k\"\ndamping = 0.2\n\
         [[torque]]\nname = \"torque\"\non = \"wheel\"\naxis = [0, 0, 1]\nsize = 0.3",
        1e-11,
    );
    same(
        &format!(
            "{HEADER}nodes = {{ m = \"mass\" }}\nkinetic = \"0.005 * k * dot(m.velocity, m.velocity)\"\npotential = \"0.01 * k * 9.81 * m.position.z\""
        ),
        "[[body]]\nname = \"other\"\nposition = [\"0.3 + l\", 0, 0]\nvelocity = [0, 1, 0]\nmass = \"0.01 * k\"\ninertia = [1, 1, 1]\n\
         [[joint]]\nname = \"link\"\ntype = \"spherical\"\nbetween = [\"mass\", \"other\"]",
        1e-9,
    );
}

#[test]
fn points_of_nodes_have_their_own_place_velocity_and_force() {
    let nodes = "nodes = { a = { on = \"body\", point = [0.5, \"0.1 * l\", \"l\"] }, b = \"mass\" }";
    let points = "points = [[0.5, \"0.1 * l\", \"l\"], [\"0.3 + l\", 0, 0]]";
    let spring = format!(
        "[[spring]]\nname = \"spring\"\ntype = \"line\"\nbetween = [\"body\", \"mass\"]\n{points}\nstiffness = \"k\"\nrest_length = 0.5"
    );
    let damper = format!(
        "[[damper]]\nname = \"damper\"\ntype = \"vector\"\nbetween = [\"body\", \"mass\"]\n{points}\ndamping = \"0.1 * k\""
    );
    same(&format!("{HEADER}{nodes}\npotential = \"0.5 * k * (norm(b.position - a.position) - 0.5)^2\""), &spring, 1e-11);
    // what is named is what it stands for, also in what is named after it
    let named = "define = { way = \"b.position - a.position\", pull = \"k * (norm(way) - 0.5) * unit(way)\" }\n\
                 force = { a = \"pull\", b = \"-pull\" }";
    same(&format!("{HEADER}{nodes}\n{named}"), &spring, 1e-11);
    let force = "force = { a = \"0.1 * k * (b.velocity - a.velocity)\", b = \"0.1 * k * (a.velocity - b.velocity)\" }";
    same(&format!("{HEADER}{nodes}\n{force}"), &damper, 1e-11);
}

#[test]
fn names_of_an_entry_hide_those_of_the_file() {
    let force = |names: &str, formula: &str| format!("{HEADER}{names}\nforce = {{ {formula} }}");
    let plain = force("nodes = { a = \"mass\" }", "a = \"-7 * a.position + k * arm\"");
    same(&force("nodes = { l = \"mass\" }", "l = \"-7 * l.position + k * arm\""), &plain, 0.0);
    same(&force("nodes = { arm = \"mass\" }", "arm = \"-7 * arm.position + k * [0.2, 0, 0]\""), &plain, 0.0);
    let defined = "nodes = { a = \"mass\" }\ndefine = { l = \"-7 * a.position\", arm = \"k * arm\" }";
    same(&force(defined, "a = \"l + arm\""), &plain, 0.0);
}

#[test]
fn a_choice_that_is_none_of_the_time_has_no_breakpoints() {
    let force = "a = \"k * max(a.position.z - 0.5, 0) * cos(3 * t) * a.x_axis\"";
    let own = format!("{HEADER}nodes = {{ a = \"body\" }}\nforce = {{ {force} }}\nbreakpoints = []");
    assert!(run(&own).iter().all(|own| own.is_finite()));
}

#[test]
fn a_force_of_the_velocity_brakes_as_its_equation_says() {
    // quadratic drag without weight: v = v0 / (1 + c v0 t / m)
    let text = "version = 1\n[variable]\nc = { initial = 0.7, bounds = [0, 2] }\n[[point]]\nname = \"ball\"\nposition = [0, 0, 0]\nmass = 0.5\n\
                velocity = [3, 4, 0]\n\
                [[element]]\nname = \"drag\"\nnodes = { ball = \"ball\" }\nforce = { ball = \"-c * norm(ball.velocity) * ball.velocity\" }\n\
                [[functional]]\nname = \"speed\"\ntype = \"formula\"\nnodes = { ball = \"ball\" }\nvalue = \"norm(ball.velocity)\"\n\
                unit = \"m/s\"\nover = \"terminal\"\n[settings]\nend = 1\nsteps = 200\n";
    let scene = FileScene::parse("drag.toml", text).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap();
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap().rows[0][0];
    let (c, v0, m) = (0.7, 5.0, 0.5);
    let speed = v0 / (1.0 + c * v0 / m);
    assert!((forward.values[0] - speed).abs() < 1e-7, "{} for {speed}", forward.values[0]);
    let slope = -v0 * v0 / m / (1.0 + c * v0 / m).powi(2);
    assert!((gradient - slope).abs() < 1e-6, "{gradient} for {slope}");
    assert_eq!(prepared.functionals()[0].value_unit(), "m/s");
}

#[test]
fn equations_hold_like_those_of_a_joint_of_the_library() {
    // the place of the body's point, and l from it to the mass
    let joint = "[[joint]]\nname = \"rod\"\ntype = \"formula\"\nnodes = { a = \"body\", b = \"mass\" }\n\
                 equations = [\"norm(b.position - a.position) - l * sqrt(2)\"]";
    let library = "[[joint]]\nname = \"rod\"\ntype = \"distance\"\nbetween = [\"body\", \"mass\"]";
    same(joint, library, 1e-9);
    let soft = "stiffness = [\"100 * k\"]\ndamping = [3]";
    same(
        &format!("{joint}\n{soft}"),
        "[[spring]]\nname = \"rod\"\ntype = \"line\"\nbetween = [\"body\", \"mass\"]\nstiffness = \"100 * k\"\nrest_length = \"l * sqrt(2)\"\n[[damper]]\nname = \"damper\"\ntype = \"line\"\nbetween = [\"body\", \"mass\"]\ndamping = 3",
        1e-9,
    );
    // and drives
    let driven = "[[joint]]\nname = \"drive\"\ntype = \"formula\"\nnodes = { phi = \"angle\" }\nequations = [\"phi.value - 0.3 * k * t^3\"]";
    let library = "[[driver]]\nname = \"drive\"\ntype = \"rotation\"\nbetween = [\"ground\", \"wheel\"]\naxis = [0, 0, 1]\nangle = { type = \"formula\", value = \"0.3 * k * t^3\" }";
    same(driven, library, 1e-9);
}

#[test]
fn what_is_measured_by_a_formula_is_what_the_library_measures() {
    let common = "over = \"terminal\"";
    let of = |keys: &str| run(&format!("[[functional]]\nname = \"own\"\n{keys}\n{common}"));
    for (own, library) in [
        ("type = \"formula\"\nnodes = { b = \"body\" }\nvalue = \"dot(b.velocity + cross(b.angular_velocity, 0.2 * b.x_axis), [1, \\\"l\\\", 2])\"".replace("\\\"", ""), "type = \"velocity\"\non = \"body\"\npoint = [0.5, 0, \"l\"]\ndirection = [1, \"l\", 2]"),
        ("type = \"formula\"\nnodes = { b = \"body\", m = \"mass\" }\nvalue = \"norm(b.position - m.position)\"".into(), "type = \"distance\"\nbetween = [\"body\", \"mass\"]"),
        ("type = \"formula\"\nnodes = { p = \"angle\" }\nvalue = \"p.value + 0 * t\"".into(), "type = \"coordinate\"\non = \"angle\""),
    ] {
        let (own, library) = (of(&own), of(library));
        for (own, library) in own.iter().zip(&library) {
            assert!((own - library).abs() <= 1e-11 * library.abs().max(1.0), "{own} for {library}");
        }
    }
}

#[test]
fn what_is_wrong_with_formulas_is_told() {
    let element = |keys: &str| format!("{HEADER}{keys}");
    for (parts, part) in [
        (element("potential = \"1\""), "needs the key nodes"),
        (element("nodes = { a = \"body\" }"), "an element needs kinetic, potential, force or moment"),
        (element("nodes = { a = \"bod\" }\npotential = \"a.position.z\""), "did you mean \"body\""),
        (
            element("nodes = { a = \"body\" }\npotential = \"a.place.z\""),
            "\"a\" is a node, of which formulas know a.position, a.velocity",
        ),
        (element("nodes = { a = \"mass\" }\npotential = \"a.x_axis.z\""), "of which formulas know a.position, a.velocity"),
        (
            element("nodes = { a = \"body\" }\npotential = \"a.velocity.z\""),
            "this depends on places alone: a.velocity cannot stand here",
        ),
        (element("nodes = { a = \"body\" }\npotential = \"t * a.position.z\""), "this cannot depend on the time t"),
        (element("nodes = { a = \"body\" }\npotential = \"a.position\""), "must be a number"),
        (element("nodes = { a = \"body\" }\nforce = { b = \"a.position\" }"), "there is no \"b\" among the nodes"),
        (
            element("nodes = { a = { on = \"mass\", point = [0, 0, 0] } }\npotential = \"a.position.z\""),
            "this is a point, which has no points but itself",
        ),
        (
            element("nodes = { a = { on = \"body\", point = \"a.x_axis\" } }\npotential = \"a.position.z\""),
            "a point is one of the start, which depends on the design alone",
        ),
        (element("nodes = { a = { on = \"body\" } }\npotential = \"a.position.z\""), "needs the key point"),
        (
            element("nodes = { a = { on = \"body\", at = 1, point = [0, 0, 0] } }\npotential = \"a.position.z\""),
            "key \"at\" is not known",
        ),
        (element("nodes = { a = \"body\" }\ndefine = { a = \"2\" }\npotential = \"a\""), "\"a\" is a name here already"),
        (
            element("nodes = { a = \"body\" }\ndefine = { u = \"v + 1\", v = \"2\" }\npotential = \"u\""),
            "name \"v\" is not known",
        ),
        (element("nodes = { a = \"body\" }\ndefine = 2\npotential = \"a.position.z\""), "define must be a table of names"),
        (
            element("nodes = { a = \"body\" }\ndefine = { u = \"a.velocity.z\" }\npotential = \"u\""),
            "this depends on places alone: a.velocity cannot stand here",
        ),
        (
            element("nodes = { a = \"body\" }\nforce = { a = \"norm(a.position)\" }"),
            "\"a\" is a body, which takes a vector here",
        ),
        (
            element("nodes = { a = \"mass\" }\nmoment = { a = \"a.position\" }"),
            "\"a\" is a point, which takes no moment here",
        ),
        (
            element("nodes = { a = \"angle\" }\nforce = { a = [1, 2, 3] }"),
            "\"a\" is a coordinate, which takes a number here",
        ),
        (element("nodes = { k = \"body\" }\nforce = { k = \"k * k.x_axis\" }"), "\"k\" is a node, of which formulas know"),
        (element("nodes = { sin = \"body\" }\nforce = { sin = \"sin.x_axis\" }"), "\"sin\" means a function in formulas"),
        (
            "[[joint]]\nname = \"j\"\ntype = \"formula\"\nnodes = { a = \"body\" }\nequations = [\"a.velocity.x\"]".into(),
            "this depends on places alone",
        ),
    ] {
        let told = refused(&text(&parts));
        assert!(told.contains(part), "{parts}: {told}");
    }
}
