//! The files of a run: histories.csv, histories.png/.svg, motion.png/.svg.

use super::failure::Failure;
use costate::assembly::{Model, Node, NodeKind, VectorsAvq};
use costate::functionals::{Measured, Sample};
use costate::history::History;
use costate::io::{
    Chart, Frame, Motion, Polyline, Progress, Series, Style, Trail, View, write_csv, write_file, write_panels,
};
use costate::scenes::{Drawn, NodePoint, Prepared};
use costate::sensitivity::Forward;
use std::path::{Path, PathBuf};

/// Most points of a curve in a picture.
const MOST_POINTS: usize = 4000;
/// Most curves of one chart.
const MOST_CURVES: usize = 7;
/// Most trails of the picture of the motion.
const MOST_TRAILS: usize = 6;
/// An extent below this share of the largest is flat.
const FLAT: f64 = 1e-3;

/// The state at the start or at the end of a step.
struct Moment<'h> {
    t: f64,
    q: &'h [f64],
    v: &'h [f64],
    /// Of the first acceleration, or of the last stage.
    mu: &'h [f64],
}

fn moments(history: &History<f64>) -> Vec<Moment<'_>> {
    let start = history.start.iter().map(|start| {
        let record = &start.acceleration;
        Moment { t: record.t, q: &record.base.q, v: &record.base.v, mu: &record.unknowns.mu }
    });
    let steps = history.steps.iter().map(|step| {
        let mu = step.stages.last().map_or(&[][..], |stage| &stage.solve.unknowns.mu);
        Moment { t: step.t + step.h, q: &step.q, v: &step.v, mu }
    });
    start.chain(steps).collect()
}

/// Makes sure that the folder can take files, before anything is computed.
///
/// # Errors
/// Bad input that names the folder and the cause.
pub fn check_folder(folder: &Path) -> Result<(), Failure> {
    let probe = folder.join(format!(".probe-{}", std::process::id()));
    let written = write_file(&probe, b"");
    let _ = std::fs::remove_file(&probe);
    written.map_err(|error| {
        Failure::input(format!("--out {}: {}; it must be a folder that can be written to", folder.display(), error.cause))
    })
}

/// Writes all files of a run and returns their names.
///
/// # Errors
/// A file that cannot be written.
pub fn write_results(
    prepared: &Prepared,
    forward: &Forward,
    folder: &Path,
    progress: &Progress,
) -> Result<Vec<PathBuf>, Failure> {
    let moments = moments(&forward.history);
    let energies = energies(prepared.model(), &forward.numbers.p, &moments);
    let csv = folder.join("histories.csv");
    write_csv(&csv, &header(prepared, energies.is_some()), rows(prepared, &moments, energies.as_deref()))?;
    progress.set(1);
    let mut files = vec![csv];
    let mut add_picture = |name: &str| files.extend([".png", ".svg"].map(|end| folder.join(format!("{name}{end}"))));
    let charts = charts(prepared, &moments, energies.as_deref());
    if !charts.is_empty() {
        write_panels(&charts, &folder.join("histories"))?;
        add_picture("histories");
    }
    progress.set(2);
    if let Some(motion) = motion(prepared, &moments) {
        motion.write(&folder.join("motion"))?;
        add_picture("motion");
    }
    Ok(files)
}

fn moving(model: &Model) -> impl Iterator<Item = &Node> {
    model.nodes.iter().filter(|node| !node.fixed)
}

/// Column names: `bob.x [m]`, `bob.dx/dt [m/s]`, energy, `rod.mu1`.
fn header(prepared: &Prepared, energies: bool) -> Vec<String> {
    let model = prepared.model();
    let mut names = vec!["t [s]".to_string()];
    let named = |node: &Node, index: usize, rate: bool| {
        let (coordinate, unit, per_second) = match (node.kind, index) {
            (NodeKind::Coordinates(_), index) => (format!("q{index}"), "", ""),
            (kind, 0..3) => (kind.coordinate_name(index), " [m]", " [m/s]"),
            (kind, _) => (kind.coordinate_name(index), " [-]", " [1/s]"),
        };
        let node = &node.name;
        if rate { format!("{node}.d{coordinate}/dt{per_second}") } else { format!("{node}.{coordinate}{unit}") }
    };
    for rate in [false, true] {
        names.extend(moving(model).flat_map(|node| (0..node.dofs.len()).map(move |index| named(node, index, rate))));
    }
    if energies {
        names.push("energy [J]".into());
    }
    for joint in &model.constraints {
        let rows = joint.equations.clone().filter(|row| !prepared.plan.dropped.contains(row));
        names.extend(rows.map(|row| format!("{}.mu{}", joint.name, row - joint.equations.start + 1)));
    }
    names
}

fn rows<'m>(
    prepared: &'m Prepared,
    moments: &'m [Moment<'m>],
    energies: Option<&'m [f64]>,
) -> impl Iterator<Item = Vec<f64>> + 'm {
    let dofs: Vec<usize> = moving(prepared.model()).flat_map(|node| node.dofs.clone()).collect();
    let equations: Vec<usize> = (0..prepared.model().equations).filter(|row| !prepared.plan.dropped.contains(row)).collect();
    moments.iter().enumerate().map(move |(index, moment)| {
        let mut row = vec![moment.t];
        row.extend(dofs.iter().map(|&dof| moment.q[dof]));
        row.extend(dofs.iter().map(|&dof| moment.v[dof]));
        if let Some(energies) = energies {
            row.push(energies[index]);
        }
        row.extend(equations.iter().map(|&equation| moment.mu[equation]));
        row
    })
}

/// Energy at each moment [J]; `None` if an element does not state its own.
fn energies(model: &Model, p: &[f64], moments: &[Moment]) -> Option<Vec<f64>> {
    if model.elements.iter().any(|element| !element.physics.has_energies()) {
        return None;
    }
    let at = |moment: &Moment| {
        let at = VectorsAvq { a: Vec::new(), v: moment.v.to_vec(), q: moment.q.to_vec() };
        Measured::Energy.value(model, &Sample { t: moment.t, weight: 0.0, at, mu: Vec::new() }, p)
    };
    Some(moments.iter().map(at).collect())
}

/// Every so many moments that a curve has no more points than a picture can show; the last one included.
fn thinned<'m>(moments: &'m [Moment<'m>]) -> impl Iterator<Item = (usize, &'m Moment<'m>)> {
    let stride = moments.len().div_ceil(MOST_POINTS).max(1);
    moments.iter().enumerate().filter(move |(index, _)| index % stride == 0 || index + 1 == moments.len())
}

/// One panel for each direction in which something moves, one for free coordinates, one for the energy.
fn charts(prepared: &Prepared, moments: &[Moment], energies: Option<&[f64]>) -> Vec<Chart> {
    let model = prepared.model();
    let curve = |name: String, value: &dyn Fn(usize, &Moment) -> f64| {
        let points = thinned(moments).map(|(index, moment)| (moment.t, value(index, moment))).collect();
        Series { name, points, style: Style::Line }
    };
    let panel = |y_label: String, mut series: Vec<Series>| {
        let hidden = series.len().saturating_sub(MOST_CURVES);
        series.truncate(MOST_CURVES);
        let title =
            if hidden > 0 { format!("{y_label}: {MOST_CURVES} of {} nodes", MOST_CURVES + hidden) } else { String::new() };
        Chart { title, x_label: "time [s]".into(), y_label, series, ..Chart::default() }
    };
    let mut charts = Vec::new();
    let places: Vec<&Node> = moving(model).filter(|node| !matches!(node.kind, NodeKind::Coordinates(_))).collect();
    for (index, direction) in ["x", "y", "z"].into_iter().enumerate() {
        let series: Vec<Series> =
            places.iter().map(|node| curve(node.name.clone(), &|_, m| m.q[node.dofs.start + index])).collect();
        if series.iter().any(|series| extent(series.points.iter().map(|point| point.1)) > 1e-9) {
            charts.push(panel(format!("{direction} [m]"), series));
        }
    }
    let free = moving(model).filter(|node| matches!(node.kind, NodeKind::Coordinates(_)));
    let series: Vec<Series> = free
        .flat_map(|node| node.dofs.clone().map(move |dof| (format!("{} q{}", node.name, dof - node.dofs.start), dof)))
        .map(|(name, dof)| curve(name, &|_, moment| moment.q[dof]))
        .collect();
    if !series.is_empty() {
        charts.push(panel("coordinates".into(), series));
    }
    if let Some(energies) = energies
        && let Some(start) = energies.first()
    {
        let drift = curve(String::new(), &|index, _| energies[index] - start);
        charts.push(panel("change of energy [J]".into(), vec![drift]));
    }
    // one key for all panels: a node has the same colour in each
    for chart in charts.iter_mut().skip(1).filter(|chart| !chart.y_label.starts_with("coordinates")) {
        chart.series.iter_mut().for_each(|series| series.name.clear());
    }
    if let Some(first) = charts.first_mut() {
        let kind = if first.title.is_empty() { String::new() } else { format!(", {}", first.title) };
        first.title = format!("{}{kind}", prepared.scene.scene_name());
        if let [only] = &mut first.series[..] {
            first.title += &format!(": {}", std::mem::take(&mut only.name));
        }
    }
    charts
}

fn extent(values: impl Iterator<Item = f64>) -> f64 {
    let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    most - least
}

/// The time lapse; `None` if nothing of the scene has a place in space.
fn motion(prepared: &Prepared, moments: &[Moment]) -> Option<Motion> {
    let sketch = prepared.mechanism.sketch();
    if sketch.lines.is_empty() && sketch.followed.is_empty() {
        return None;
    }
    let bodies = sketch.lines.iter().any(|line| line.0 == Drawn::Body);
    let line = |(drawn, points): &(Drawn, Vec<NodePoint>), moment: &Moment| Polyline {
        points: points.iter().map(|point| point.at(moment.q)).collect(),
        role: usize::from(bodies && *drawn == Drawn::Link),
    };
    let frame = |(index, moment): (usize, &Moment)| {
        // springs and dampers of earlier times would hide the bodies
        let links = !bodies || index + 1 == moments.len();
        let of = |kind: Drawn| sketch.lines.iter().filter(move |line| line.0 == kind).map(|own| line(own, moment));
        let links = of(Drawn::Link).filter(|_| links);
        Frame { time: moment.t, lines: links.chain(of(Drawn::Body)).collect() }
    };
    let trail = |(name, point): &(String, NodePoint)| Trail {
        name: name.clone(),
        points: thinned(moments).map(|(_, moment)| point.at(moment.q)).collect(),
    };
    let frames: Vec<Frame> = thinned(moments).map(frame).collect();
    let trails: Vec<Trail> = sketch.followed.iter().take(MOST_TRAILS).map(trail).collect();
    let title = prepared.scene.scene_name();
    let mut motion = Motion { title, frames, trails, anchors: sketch.anchors, view: View::Isometric };
    motion.view = view(&motion);
    Some(motion)
}

/// Along the direction in which nothing extends, or from a corner.
fn view(motion: &Motion) -> View {
    let lines = motion.frames.iter().flat_map(|frame| &frame.lines).flat_map(|line| &line.points);
    let trails = motion.trails.iter().flat_map(|trail| &trail.points);
    let points: Vec<&[f64; 3]> = lines.chain(trails).chain(&motion.anchors).collect();
    let extents = [0, 1, 2].map(|index| extent(points.iter().map(|point| point[index])));
    let largest = extents.iter().fold(0.0, |most: f64, &x| most.max(x));
    match extents.map(|extent| extent <= FLAT * largest) {
        // a motion along one line is seen upright
        [true, true, false] => View::Xz,
        [_, _, true] => View::Xy,
        [_, true, _] => View::Xz,
        [true, _, _] => View::Yz,
        _ => View::Isometric,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::design::DesignVariable;
    use costate::elements::{Element, Parameter, State};
    use costate::scalar::{Scalar, Vec3};
    use costate::scenes::{AnyScene, MechanismBuilder, Scene, Settings};

    /// R = a + q: an oscillator without a place in space, and without energies.
    struct Oscillator;
    impl Element for Oscillator {
        const DOFS: usize = 1;
        const PARAMETERS: &'static [Parameter] = &[];
        fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
            r[0] += s.a[0] + s.q[0];
        }
    }

    /// A free oscillator, or a ball thrown in some direction.
    struct Thrown(Option<[f64; 3]>);
    impl Scene for Thrown {
        fn name(&self) -> String {
            "thrown".into()
        }
        fn variables(&self) -> Vec<DesignVariable> {
            Vec::new()
        }
        fn settings(&self) -> Settings {
            Settings::new(1.0, 20)
        }
        fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
            let Some(velocity) = self.0 else {
                let node = m.coordinates("free", &[S::one()], &[S::zero()]);
                m.element("oscillator", &[node], Oscillator, &[]);
                return Ok(());
            };
            let ball = m.point("ball", Vec3::zero());
            m.point_mass("ball", ball, S::one());
            m.gravity(Vec3::from_f64([0.0, 0.0, -9.81]));
            m.set_velocity(ball, Vec3::from_f64(velocity), Vec3::zero());
            Ok(())
        }
    }

    fn ran(scene: &dyn AnyScene) -> (Prepared<'_>, Forward) {
        let prepared = Prepared::new(scene).unwrap();
        let forward = prepared.analysis().forward(&prepared.x).unwrap();
        (prepared, forward)
    }

    #[test]
    fn the_view_is_along_the_direction_in_which_nothing_moves() {
        let cases = [
            ([1.0, 0.0, 5.0], View::Xz),
            ([0.0, 1.0, 5.0], View::Yz),
            ([1.0, 1.0, 5.0], View::Isometric),
            ([0.0, 0.0, 5.0], View::Xz),
        ];
        for (velocity, expected) in cases {
            let scene = Thrown(Some(velocity));
            let (prepared, forward) = ran(&scene);
            assert_eq!(motion(&prepared, &moments(&forward.history)).unwrap().view, expected, "{velocity:?}");
        }
    }

    #[test]
    fn a_scene_without_a_place_in_space_has_histories_but_no_picture_of_its_motion() {
        let folder = std::env::temp_dir().join(format!("costate-results-{}", std::process::id()));
        let (prepared, forward) = ran(&Thrown(None));
        let files = write_results(&prepared, &forward, &folder, &Progress::new("writing", 3)).unwrap();
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names, ["histories.csv", "histories.png", "histories.svg"]);
        let text = std::fs::read_to_string(&files[0]).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("t [s],free.q0,free.dq0/dt"));
        let last: Vec<f64> = lines.last().unwrap().split(',').map(|word| word.parse().unwrap()).collect();
        assert!((last[1] - 1f64.cos()).abs() < 1e-5 && (last[2] + 1f64.sin()).abs() < 1e-5, "{last:?}");
    }
}
