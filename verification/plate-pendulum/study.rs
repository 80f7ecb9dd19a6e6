//! Time and memory of a plate of shells, phase by phase, on one thread and two.

use crate::falling::{plate, tube};
use crate::phases::{Phases, USUAL, prepare, timed};
use crate::{Form, Report, Study, median, on_one_thread, on_threads};
use costate::elements::flexible::Material;
use costate::prelude::*;
use costate::scenes::{AnyScene, Edge, FileScene, ShellMesh, built_in};

/// The study.
pub struct PlatePendulumStudy;

/// Meshes of the source, and one of 192,000 unknowns as it counts them: eight a node.
const MESHES: [[usize; 2]; 4] = [[25, 5], [55, 11], [100, 20], [150, 39]];
/// Elements along the box tube of the source, and across each of its four walls.
const TUBE: [usize; 2] = [100, 5];
/// A mesh of 10,000 nodes, each with a thickness of its own.
const OF_NODES: [usize; 2] = [112, 22];
/// Largest difference of adjoint and complex step.
const EXACT: f64 = 1e-11;
/// Pairs of gradients by one thickness and by many.
const PAIRS: usize = 10;

impl Study for PlatePendulumStudy {
    fn name(&self) -> &'static str {
        "plate-pendulum"
    }
    fn summary(&self) -> &'static str {
        "falling plate and box tube of up to 5,850 shell elements: time of each phase, of steps and gradients, and memory"
    }
    fn forms(&self) -> &'static [Form] {
        &[Form::Short]
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let words = |error: RunError| error.to_string();
        gradient(report, built_in::named("plate-pendulum")?).map_err(words)?;
        gradient(report, built_in::named("box-tube-pendulum")?).map_err(words)?;
        if report.is_short() {
            return Ok(());
        }
        let of_mesh = |elements: [usize; 2]| {
            let name = format!("{} x {}", elements[0], elements[1]);
            Ok(Subject { name, elements: elements[0] * elements[1], scene: plate(elements)? })
        };
        let name = format!("box tube {} x 4 x {}", TUBE[0], TUBE[1]);
        let tube = Subject { name, elements: 4 * TUBE[0] * TUBE[1], scene: tube(TUBE)? };
        let subjects = MESHES.into_iter().map(of_mesh).chain([Ok(tube)]).collect::<Result<Vec<Subject>, String>>()?;
        for (index, subject) in subjects.iter().enumerate() {
            eprintln!("[{}/{}] {}", index + 1, subjects.len() + 1, subject.name);
            for threads in [1, 2] {
                on_threads(threads, || phases(report, subject, threads).map_err(words))?;
            }
        }
        eprintln!("[{0}/{0}] thicknesses", subjects.len() + 1);
        on_one_thread(|| thicknesses(report).map_err(words))
    }
}

/// A scene whose phases are measured.
struct Subject {
    name: String,
    /// Number of shell elements.
    elements: usize,
    scene: FileScene,
}

/// Gradients of a coarse mesh against complex step.
fn gradient(report: &mut Report, scene: &dyn AnyScene) -> Result<(), RunError> {
    let prepared = Prepared::new(scene)?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x)?;
    let (adjoint, stepped) = (analysis.adjoint(&prepared.x, &forward)?, analysis.complex_step(&prepared.x, &forward)?);
    for ((functional, own), other) in prepared.functionals().iter().zip(&adjoint.rows).zip(&stepped.rows) {
        report.at_most(
            format!("gradient/{}/{}, adjoint - complex step", scene.name(), functional.name),
            largest_difference(own, other),
            EXACT,
        );
    }
    Ok(())
}

/// A clamped plate of one thickness, or with a thickness of each node.
struct OfNodes {
    for_each: bool,
}

impl Scene for OfNodes {
    fn name(&self) -> String {
        "plate".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let count = if self.for_each { OF_NODES.iter().map(|count| 2 * count + 1).product() } else { 1 };
        (0..count).map(|node| DesignVariable::new(format!("thickness {node}"), 0.01, (0.002, 0.03), "m")).collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(1e-3, 1)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let material = Material { young: S::from(70e9), poisson: S::from(0.3), density: S::from(2500.0) };
        let edges = [[0.25, 0.0, 0.0], [0.0, 0.05, 0.0]].map(Vector3::from_f64);
        let mesh = ShellMesh::plate(Vector3::zeros(), edges, OF_NODES).clamped(Edge::FirstStart);
        let thickness = |_, shares: [f64; 2]| {
            let [i, j] = [0, 1].map(|k| (shares[k] * (2 * OF_NODES[k]) as f64).round() as usize);
            x[if self.for_each { i + j * (2 * OF_NODES[0] + 1) } else { 0 }]
        };
        let plate = m.tapered_shell("plate", mesh, &material, thickness);
        m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
        m.strain_energy_functional("strain energy", Over::Integral, &plate.group());
        m.mass_functional("mass", Over::Initial);
        Ok(())
    }
}

/// A gradient by one thickness, and by that of each of 10,000 nodes.
fn thicknesses(report: &mut Report) -> Result<(), RunError> {
    let scenes = [false, true].map(|for_each| OfNodes { for_each });
    let mut all = Vec::new();
    for scene in &scenes {
        let prepared = prepare(scene, 1, 1)?;
        let forward = prepared.analysis().forward(&prepared.x)?;
        all.push((prepared, forward, Vec::new()));
    }
    // in turn, so that what disturbs one disturbs both, and each as often first
    for round in 0..PAIRS {
        for place in 0..all.len() {
            let (prepared, forward, times) = &mut all[(place + round) % 2];
            let (gradient, [seconds, _]) = timed(|| prepared.analysis().adjoint(&prepared.x, forward));
            gradient?;
            times.push(seconds);
        }
    }
    for (prepared, _, times) in &all {
        report.inform(format!("thicknesses/gradient by {} [s]", prepared.x.len()), median(times.clone()));
    }
    let ratios = all[1].2.iter().zip(&all[0].2).map(|(many, one)| many / one).collect();
    report.compare("thicknesses/time with many by that with one, median", median(ratios), 1.0, 0.05);
    Ok(())
}

/// Phases of one step, whole steps, and their gradient.
fn phases(report: &mut Report, subject: &Subject, threads: usize) -> Result<(), RunError> {
    let name = |what: &str| format!("{}, {threads} thread{}/{what}", subject.name, if threads > 1 { "s" } else { "" });
    let own = Phases::measure(&subject.scene, USUAL)?;
    report.inform(name("unknowns"), own.system.unknowns);
    for (what, [seconds, _]) in own.system.parts {
        report.inform(name(&format!("{what} [s]")), seconds);
    }
    let of_element = (own.system.parts[0].1[0] + own.system.parts[1].1[0]) / subject.elements as f64;
    report.inform(name("residual and matrix of an element [us]"), 1e6 * of_element);
    report.inform(name("one forward step [s]"), own.step[0]);
    report.inform(name("its adjoint and gradient [s]"), own.adjoint[0][0]);
    report.inform(name("Newton iterations of a step"), own.iterations);
    report.inform(name("factorizations of a step"), own.factorizations);
    if let Some(memory) = own.memory {
        report.inform(name("memory at its peak, simulation of one step and gradients [MB]"), 1e-6 * memory);
    }
    Ok(())
}
