use crate::verification::{Clock, Report, Study, on_one_thread};
use costate::assembly::{Equations, Jacobian, Level, Residual, Shift, System, SystemOptions, VectorsAvq};
use costate::elements::TimeFunction;
use costate::elements::flexible::Section;
use costate::prelude::*;
use costate::scenes::BeamLine;

/// Time of one residual and one matrix of beams, rigid bodies and joints.
pub struct ElementCost;

impl Study for ElementCost {
    fn name(&self) -> &'static str {
        "element-cost"
    }
    fn summary(&self) -> &'static str {
        "microseconds for residual and matrix of beam, rigid body and each joint, on one thread"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        if !Clock::counts_computing() {
            report.note("This system does not count the time of a thread: other work on the machine is in these figures.");
        }
        on_one_thread(|| measure(report))
    }
}

type Builder = MechanismBuilder<f64>;
type Nodes = [costate::assembly::NodeId; 3];
/// Adds one copy of what is measured to three bodies.
type Add = fn(&mut Builder, usize, Nodes);

/// Copies in one model.
const COPIES: usize = 40;
/// Evaluations in one measurement; the least of several counts.
const EVALUATIONS: usize = 100;
const MEASUREMENTS: usize = 15;

const AXIS: Vector3<f64> = Vector3::new(0.0, 0.6, 0.8);
const POINT: Vector3<f64> = Vector3::new(0.4, 0.1, 0.2);

fn section() -> Section<f64> {
    Section::new([1e6, 4e5, 4e5, 80.0, 100.0, 100.0]).with_inertia(1.2, [1e-4; 2])
}

fn beam(m: &mut Builder, copy: usize, nodes: Nodes, section: &Section<f64>) {
    let points = nodes.map(|node| m.position(node));
    // the middle node is one of its own: the second body stays alone
    let line = BeamLine::through(&points, Vector3::new(0.0, 0.0, 1.0)).from_node(nodes[0]).to_node(nodes[2]);
    m.beam(&format!("beam {copy}"), line, section);
}

const ITEMS: [(&str, Add); 18] = [
    ("beam", |m, copy, nodes| beam(m, copy, nodes, &section())),
    ("beam, damped", |m, copy, nodes| beam(m, copy, nodes, &section().damped(1e-3))),
    ("beam, coupled and eccentric", |m, copy, nodes| beam(m, copy, nodes, &section().offset([0.02, 0.03]))),
    ("rigid body", |m, copy, [a, ..]| {
        m.rigid_body(&format!("body {copy}"), a, 1.2, Vector3::new(0.1, 0.2, 0.3), [1.0, 1.1, 1.2, 0.1, 0.2, 0.1]);
    }),
    ("spherical", |m, copy, [a, b, _]| {
        m.spherical(&format!("joint {copy}"), [a, b], POINT);
    }),
    ("revolute", |m, copy, [a, b, _]| {
        m.revolute(&format!("joint {copy}"), [a, b], POINT, AXIS);
    }),
    ("universal", |m, copy, [a, b, _]| {
        m.universal(&format!("joint {copy}"), [a, b], POINT, [AXIS, Vector3::new(1.0, 0.0, 0.0)]);
    }),
    ("cylindrical", |m, copy, [a, b, _]| {
        m.cylindrical(&format!("joint {copy}"), [a, b], POINT, AXIS);
    }),
    ("prismatic", |m, copy, [a, b, _]| {
        m.prismatic(&format!("joint {copy}"), [a, b], POINT, AXIS);
    }),
    ("planar", |m, copy, [a, b, _]| {
        m.planar(&format!("joint {copy}"), [a, b], POINT, AXIS);
    }),
    ("helical", |m, copy, [a, b, _]| {
        m.helical(&format!("joint {copy}"), [a, b], POINT, AXIS, 0.1);
    }),
    ("fixed", |m, copy, [a, b, _]| {
        m.fixed(&format!("joint {copy}"), [a, b], POINT);
    }),
    ("point on line", |m, copy, [a, b, _]| {
        m.point_on_line(&format!("joint {copy}"), [a, b], POINT, AXIS);
    }),
    ("point in plane", |m, copy, [a, b, _]| {
        m.point_in_plane(&format!("joint {copy}"), [a, b], POINT, AXIS);
    }),
    ("distance", |m, copy, [a, b, _]| {
        m.distance(&format!("joint {copy}"), [a, b], [POINT, POINT + AXIS]);
    }),
    ("rigid link", |m, copy, [a, b, _]| {
        m.rigid_link(&format!("joint {copy}"), [a, b]);
    }),
    ("driven rotation", |m, copy, [a, b, _]| {
        m.prescribed_rotation(&format!("joint {copy}"), [a, b], AXIS, TimeFunction::ConstantRate, &[0.0, 1.0]);
    }),
    ("bushing", |m, copy, [a, b, _]| {
        m.bushing(&format!("bushing {copy}"), [a, b], POINT, Quaternion::identity(), [[1e3; 6], [1.0; 6]]);
    }),
];

/// A model of copies, each between three bodies, or of these bodies alone.
fn model(add: Option<Add>, middle_nodes: bool) -> Result<Builder, String> {
    let mut m = Builder::default();
    for copy in 0..COPIES {
        let at = |x: f64| Vector3::new(x, 0.01 * copy as f64, 0.0);
        let nodes = [0.0, 0.5, 1.0].map(|x| m.body(&format!("node {copy}, {x}"), at(x), Quaternion::identity()));
        if let Some(add) = add {
            add(&mut m, copy, nodes);
        } else if middle_nodes {
            m.body(&format!("middle {copy}"), at(0.5), Quaternion::identity());
        }
    }
    m.finish()
}

/// Least time [us] for each copy of one residual and of one matrix, at a state out of equilibrium.
fn times(m: &Builder) -> [f64; 2] {
    let system = System::new(&m.model, SystemOptions::default());
    let wave = |scale: f64, n: usize| -> Vec<f64> { (0..n).map(|i| scale * (1.3 * i as f64).sin()).collect() };
    let n = m.model.dofs;
    let mut base = VectorsAvq { a: wave(1.0, n), v: wave(0.5, n), q: m.numbers.q.clone() };
    base.q.iter_mut().zip(wave(1e-3, n)).for_each(|(q, change)| *q += change);
    let h = 0.01;
    let equations = Equations::stage(Shift::new(1.0, 0.25 * h, 0.0625 * h * h), Level::Acceleration);
    let mut residual = Residual::<f64>::new(&system);
    let mut unknowns = Residual::unknowns(&system);
    unknowns.mu.iter_mut().enumerate().for_each(|(i, mu)| *mu = (0.7 * i as f64).cos());
    let mut jacobian = Jacobian::new(&system);
    let mut best = [f64::INFINITY; 2];
    for _ in 0..MEASUREMENTS {
        let clock = Clock::start();
        for _ in 0..EVALUATIONS {
            residual.evaluate(&system, &equations, &base, &mut unknowns, &m.numbers.p, 0.3);
        }
        let of_residual = clock.seconds();
        let clock = Clock::start();
        for _ in 0..EVALUATIONS {
            jacobian.assemble(&system, &equations, &residual, &unknowns, &m.numbers.p, 0.3);
        }
        for (best, seconds) in best.iter_mut().zip([of_residual, clock.seconds()]) {
            *best = best.min(1e6 * seconds / (COPIES * EVALUATIONS) as f64);
        }
    }
    best
}

fn measure(report: &mut Report) -> Result<(), String> {
    let three = times(&model(None, false)?);
    let four = times(&model(None, true)?);
    report.inform("a body's node alone/residual [us]", three[0] / 3.0);
    report.inform("a body's node alone/matrix [us]", three[1] / 3.0);
    for (name, add) in ITEMS {
        let m = model(Some(add), false)?;
        let nodes = if name.starts_with("beam") { four } else { three };
        let together = times(&m);
        let own: [f64; 2] = std::array::from_fn(|i| together[i] - nodes[i]);
        report.inform(format!("{name}/residual [us]"), own[0]);
        report.inform(format!("{name}/matrix [us]"), own[1]);
        report.inform(format!("{name}/matrix by residual"), own[1] / own[0]);
        let sum = own[0] + own[1];
        match name {
            "beam" => report.at_most("beam/residual and matrix [us], aim", sum, 5.0),
            "rigid body" => report.at_most("rigid body/residual and matrix [us], aim", sum, 0.5),
            _ => report.inform(format!("{name}/residual and matrix [us]"), sum),
        }
    }
    report.note(format!(
        "Each figure is the least of {MEASUREMENTS} measurements of {EVALUATIONS} evaluations of a model with {COPIES} copies, less the same model \
         with the nodes alone: their part of node-local elimination is reported on its own."
    ));
    Ok(())
}
