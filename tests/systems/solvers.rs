//! Every solver of linear systems gives the same motion and the same gradient.

use costate::internals::SolverPlan;
use costate::linalg::Backend;
use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};

fn named(name: &str) -> &'static dyn AnyScene {
    built_in::named(name).expect("built in")
}

/// Values and gradients of a scene, with the solver that was used.
fn results(scene: &dyn AnyScene, settings: Settings, backend: Backend) -> (SolverPlan, Vec<Vec<f64>>) {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let method = Method { backend, ..Prepared::method_of(&settings).expect("a method") };
    let prepared = Prepared::with(scene, &x, method, settings).expect("a scene");
    let analysis = prepared.analysis();
    let forward = analysis.forward(&x).expect("a run");
    let gradient = analysis.adjoint(&x, &forward).expect("a gradient");
    let plan = prepared.linear_solver().expect("a solver");
    (plan, std::iter::once(forward.values).chain(gradient.rows).collect())
}

#[test]
fn gradients_are_the_same_whatever_solves_the_systems() {
    let scene = named("five-bar");
    let settings = scene.settings();
    let settings = Settings { end: 20.0 * settings.end / settings.steps as f64, steps: 20, ..settings };
    let (_, expected) = results(scene, settings.clone(), Backend::Automatic);
    for backend in Backend::ALL.into_iter().skip(1) {
        let (plan, own) = results(scene, settings.clone(), backend);
        assert_eq!(plan.backend, backend);
        for (own, expected) in own.iter().zip(&expected) {
            let difference = largest_difference(expected, own);
            assert!(difference < 1e-12, "{}: {difference:e}", backend.name());
        }
    }
}

/// Stages, projections and accelerations take turns with one solver there.
#[test]
fn a_large_system_whose_solver_is_shared_has_an_exact_gradient() {
    let changes = "define = { along = 40, across = 8 }\nsettings = { end = 2e-3, steps = 2 }";
    let plate = built_in::changed("plate-pendulum", changes).expect("sound");
    let prepared = Prepared::new(&plate).expect("a scene");
    let fill = prepared.linear_solver().expect("a plan").work.expect("an analysis").fill;
    assert!(fill > 1_000_000, "{fill} entries of L and U: small systems do not share");
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x).expect("a run");
    let adjoint = analysis.adjoint(x, &forward).expect("a gradient").rows;
    let complex = analysis.complex_step(x, &forward).expect("a gradient").rows;
    for (functional, (adjoint, complex)) in prepared.functionals().iter().zip(adjoint.iter().zip(&complex)) {
        let difference = largest_difference(complex, adjoint);
        assert!(difference < 1e-10, "{}: {difference:e}", functional.name);
    }
}

/// Systems that have a solver each, by dense and by multifrontal LU, which threads factor ahead, and large ones that share a solver.
#[test]
fn gradients_have_the_same_bits_on_any_number_of_threads() {
    let coarse = "beam = { AB.elements = 2, BC.elements = 4, CD.elements = 2 }\nsettings = { end = 0.2, steps = 20 }";
    let four_bar = &built_in::changed("flexible-four-bar", coarse).expect("sound");
    let first_steps = |name| (named(name), None, Settings { end: 0.2, steps: 20, ..named(name).settings() });
    let net = Net { side: 40 };
    let cases: [(&dyn AnyScene, Option<&'static str>, Settings); 7] = [
        (four_bar, Some("esdirk4"), four_bar.settings()),
        (four_bar, Some("bdf2"), four_bar.settings()),
        (four_bar, Some("variational"), four_bar.settings()),
        first_steps("five-bar"),
        first_steps("car-axis"),
        first_steps("slider-crank"),
        (&net, None, Scene::settings(&net)),
    ];
    for (scene, method, settings) in cases {
        let gradient = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let settings = Settings { method: method.map(String::from), ..settings.clone() };
                let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
                let method = Prepared::method_of(&settings).expect("a method");
                let prepared = Prepared::with(scene, &x, method, settings).expect("a scene");
                let analysis = prepared.analysis();
                let forward = analysis.forward(&x).expect("a run");
                analysis.adjoint(&x, &forward).expect("a gradient")
            })
        };
        let alone = gradient(1);
        assert!(alone.rows.iter().flatten().all(|value| value.is_finite()));
        for threads in [2, 3] {
            assert_eq!(gradient(threads), alone, "{}, {threads} threads", scene.name());
        }
    }
}

/// One motion, gone back through with another solver; then with a motion of its own.
///
/// The axial force is EA / L = 2e9 N/m times changes of length: one rounding of a coordinate (0.1 m, 1.4e-17) is 1e-8 of its gradient.
/// The other limits are three times what moving all coordinates by one rounding changes.
#[test]
fn a_flexible_mechanism_has_the_same_gradient_whatever_solves_its_systems() {
    let scene = &built_in::changed("flexible-four-bar", "settings = { end = 0.2, steps = 20 }").expect("sound");
    let prepared = |backend: Backend| {
        let settings = scene.settings();
        let method = Method { backend, ..Prepared::method_of(&settings).expect("a method") };
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        Prepared::with(scene, &x, method, settings).expect("a scene")
    };
    let first = prepared(Backend::Dense);
    let motion = first.analysis().forward(&first.x).expect("a run");
    let expected = first.analysis().adjoint(&first.x, &motion).expect("a gradient");
    let other = prepared(Backend::Multifrontal);
    let own_motion = other.analysis().forward(&other.x).expect("a run");
    let of_one_motion = other.analysis().adjoint(&first.x, &motion).expect("a gradient");
    let of_its_own = other.analysis().adjoint(&first.x, &own_motion).expect("a gradient");
    for (k, functional) in first.functionals().iter().enumerate() {
        let limits = match functional.name.as_str() {
            "axial force at mid-span of AB" => [2e-8, 2e-8],
            name if name.contains("hinge") => [1e-12, 1e-10],
            _ => [1e-12, 5e-12],
        };
        for ((gradient, limit), what) in [&of_one_motion, &of_its_own].into_iter().zip(limits).zip(["one motion", "its own"])
        {
            let difference = largest_difference(&expected.rows[k], &gradient.rows[k]);
            assert!(difference < limit, "{}, {what}: {difference:e}", functional.name);
        }
    }
}

/// Newton's method must not take its first observed rate of convergence for the rate of all directions: at short steps it would stop up to a
/// thousand times above its round-off, and motions that differ by roundings would have gradients that differ by 1e-9.
#[test]
fn short_steps_are_solved_to_their_round_off() {
    let scene = &built_in::changed("flexible-four-bar", "settings = { end = 0.25, steps = 100 }").expect("sound");
    let of = |backend| results(scene, scene.settings(), backend).1;
    let (expected, own) = (of(Backend::Dense), of(Backend::Multifrontal));
    // values first, then a gradient for each functional: that of the largest moment
    let difference = largest_difference(&expected[1], &own[1]);
    assert!(difference < 1e-11, "{difference:e}");
}

/// A net of masses and springs, held at one edge, that falls and swings: its matrices fill as those of surfaces do.
struct Net {
    side: usize,
}
impl Scene for Net {
    fn name(&self) -> String {
        "net".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("stiffness", 400.0, (1.0, 1e4), "N/m"),
            DesignVariable::new("mass", 0.02, (1e-3, 1.0), "kg"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(0.005, 10)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        const MESH: f64 = 0.1;
        let ground = m.ground();
        let place = |i: usize, j: usize| Vector3::from_f64([MESH * i as f64, MESH * j as f64, 0.0]);
        let mut nodes = Vec::new();
        for (i, j) in (0..self.side * self.side).map(|k| (k / self.side, k % self.side)) {
            let node = if i == 0 { ground } else { m.point(&format!("knot {i} {j}"), place(i, j)) };
            if i > 0 {
                m.point_mass(&format!("mass {i} {j}"), node, x[1]);
            }
            nodes.push(node);
        }
        for (i, j) in (0..self.side * self.side).map(|k| (k / self.side, k % self.side)) {
            for (other_i, other_j) in [(i + 1, j), (i, j + 1), (i + 1, j + 1), (i + 1, j.wrapping_sub(1))] {
                if other_i < self.side && other_j < self.side && (i, other_i) != (0, 0) {
                    let pair = [nodes[i * self.side + j], nodes[other_i * self.side + other_j]];
                    let ends = [place(i, j), place(other_i, other_j)];
                    let rest = (ends[1] - ends[0]).length() * 0.95;
                    m.line_spring(&format!("spring {i} {j} {other_i} {other_j}"), pair, ends, x[0], rest);
                }
            }
        }
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        let corner = nodes[self.side * self.side - 1];
        let up = Vector3::from_f64([0.0, 0.0, 1.0]);
        m.position_functional("z of a corner", Over::Terminal, corner, place(self.side - 1, self.side - 1), up);
        m.position_functional("z of a corner, integral", Over::Integral, corner, place(self.side - 1, self.side - 1), up);
        Ok(())
    }
}
