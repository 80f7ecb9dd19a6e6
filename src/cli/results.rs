//! The files of a run: histories.csv, histories.png/.svg, motion.png/.svg, fields.pvd with its .vtu files.

use super::columns::{Columns, courses, moving};
use super::failure::Failure;
use super::history_files::HistoryFiles;
use super::kept_moments::KeptMoments;
use super::meshes::Meshes;
use super::motions::{extent, motion, write_film};
use super::snapshot::{Snapshot, thinned};
use crate::assembly::{Node, NodeId, VectorsAvq};
use crate::design::shortest;
use crate::elements::NodeKind;
use crate::functionals::{Measured, Sample, StepEnds};
use crate::history::{Dense, Observer};
use crate::integrators::{RunError, StartRecord, StepRecord};
use crate::io::{Chart, Progress, Series, Style, write_file, write_panels};
use crate::scenes::{Output, Prepared};
use std::path::{Path, PathBuf};

/// A joint whose load is below this share of the largest, a moment being a force by the size of the mechanism, carries none.
const NO_LOAD: f64 = 1e-9;
/// Most curves of one chart.
const MOST_CURVES: usize = 7;

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

/// The files of a run while it goes on: rows go to histories.csv, and of the motion so many moments are kept as a picture can show.
pub struct Results<'p> {
    prepared: &'p Prepared<'p>,
    folder: PathBuf,
    histories: HistoryFiles,
    meshes: Option<Meshes<'p>>,
    columns: Columns<'p>,
    /// Columns that are written.
    written: Vec<usize>,
    /// Redundant constraint equations that were left out last.
    dropped: Vec<usize>,
    is_conservative: bool,
    energy: Option<EnergyCourse>,
    measured_energy: Measured,
    rows: Rows,
    film: bool,
    /// Ends of steps that become known.
    ends: StepEnds<'p, f64>,
    row: Vec<f64>,
    kept: KeptMoments,
    /// Finished steps.
    steps: usize,
    /// Why rows and meshes end before the run.
    unwritten: Option<Failure>,
}

/// How the energy of a conservative scene, which is constant in an exact motion, changes.
#[derive(Clone, Copy, Debug)]
pub struct EnergyCourse {
    start: f64,
    /// Largest growth over the start and largest loss [J], and when [s].
    changes: [(f64, f64); 2],
    /// Largest kinetic energy [J].
    kinetic: f64,
    /// Largest size of the kinetic and of the potential energy [J].
    size: f64,
}

/// Share of the energies up to which a change is round-off: bodies at rest have nothing but that.
const ENERGY_ROUNDING: f64 = 1e-12;

impl EnergyCourse {
    fn new(start: f64, t: f64) -> Self {
        EnergyCourse { start, changes: [(0.0, t); 2], kinetic: 0.0, size: 0.0 }
    }

    /// Takes note of the energy and of its kinetic part at a time.
    fn note(&mut self, energy: f64, kinetic: f64, t: f64) {
        self.kinetic = self.kinetic.max(kinetic);
        self.size = self.size.max(kinetic.abs()).max((energy - kinetic).abs());
        for (change, own) in self.changes.iter_mut().zip([energy - self.start, self.start - energy]) {
            if own > change.0 {
                *change = (own, t);
            }
        }
    }

    /// Largest growth and largest loss beyond round-off as shares of the largest kinetic energy, and when [s].
    pub fn shares(&self) -> [(f64, f64); 2] {
        let is_some = |change: f64| change > ENERGY_ROUNDING * self.size && self.kinetic > 0.0;
        self.changes.map(|(change, t)| (if is_some(change) { change / self.kinetic } else { 0.0 }, t))
    }
}

/// What is left of a run when its files are written.
pub struct Finished {
    /// Files written.
    pub files: Vec<PathBuf>,
    /// Why others could not be.
    pub unwritten: Option<Failure>,
    /// Histories as charts.
    pub charts: Vec<Chart>,
    /// The moments that pictures show.
    pub moments: Vec<Snapshot>,
}

/// At which times there are rows.
enum Rows {
    /// The start and the ends of steps.
    AtSteps,
    /// Multiples of `dt` and the end.
    AtMultiples { dt: f64, next: u32, dense: Option<Box<Dense>> },
}

impl<'p> Results<'p> {
    /// Begins the files in a folder.
    ///
    /// # Errors
    /// A history that the scene does not have; a file that cannot be written.
    pub fn begin(prepared: &'p Prepared<'p>, output: &Output, folder: &Path) -> Result<Self, Failure> {
        let model = prepared.model();
        let columns = Columns::new(prepared);
        let energies = columns.have_energy();
        let written = columns.chosen(&output.histories).map_err(Failure::input)?;
        let names = columns.names();
        let names: Vec<String> = written.iter().map(|&place| names[place].clone()).collect();
        let histories = HistoryFiles::create(folder, &names)?;
        Ok(Results {
            prepared,
            folder: folder.to_path_buf(),
            histories,
            meshes: output.meshes.then(|| Meshes::new(prepared, folder)),
            columns,
            written,
            dropped: Vec::new(),
            is_conservative: energies && !prepared.method.table.is_static() && model.is_conservative(),
            energy: None,
            measured_energy: Measured::energy(),
            rows: output.step.map_or(Rows::AtSteps, |dt| Rows::AtMultiples { dt, next: 0, dense: None }),
            film: output.film,
            ends: StepEnds::new(&prepared.method.table),
            row: Vec::new(),
            kept: KeptMoments::default(),
            steps: 0,
            unwritten: None,
        })
    }

    /// A row of a sample at the end of a step.
    fn add_sample(&mut self, sample: Option<Sample<f64>>) -> Result<(), RunError> {
        let Some(Sample { t, at, mu, dropped, .. }) = sample else { return Ok(()) };
        self.dropped = dropped;
        self.add(t, [&at.a, &at.v, &at.q], &mu)
    }

    fn add(&mut self, t: f64, [a, v, q]: [&[f64]; 3], mu: &[f64]) -> Result<(), RunError> {
        let energy_of = |v: Vec<f64>| {
            let at = VectorsAvq { a: Vec::new(), v, q: q.to_vec() };
            let sample = Sample { t, at, ..Sample::empty() };
            self.measured_energy.value(self.prepared.model(), &sample, &self.prepared.mechanism.numbers.p)
        };
        let energy = self.columns.have_energy().then(|| energy_of(v.to_vec()));
        if let Some(energy) = energy.filter(|_| self.is_conservative) {
            let kinetic = energy - energy_of(vec![0.0; v.len()]);
            self.energy.get_or_insert(EnergyCourse::new(energy, t)).note(energy, kinetic, t);
        }
        let (model, p) = (self.prepared.model(), &self.prepared.mechanism.numbers.p);
        let at = VectorsAvq { a: a.to_vec(), v: v.to_vec(), q: q.to_vec() };
        let (mu, dropped) = (mu[..model.equations].to_vec(), self.dropped.clone());
        let mut sample = Sample { t, at, mu, dropped, ..Sample::empty() };
        sample.share(model, p);
        self.row.clear();
        self.columns.add_row(&sample, energy, &mut self.row);
        // a full disk ends the files, not the simulation, whose other results may have room elsewhere
        if self.unwritten.is_none() {
            let row: Vec<f64> = self.written.iter().map(|&place| self.row[place]).collect();
            let written = self.histories.row(&row);
            let mut meshes = || self.meshes.as_mut().map_or(Ok(()), |meshes| meshes.add(&sample));
            let place =
                if self.steps == 0 { "start".into() } else { format!("step {} (t = {} s)", self.steps, shortest(t)) };
            self.unwritten = written.and_then(|()| meshes()).err().map(|error| {
                Failure::run(format!("{place}: {error}; the files end there: choose a folder on a disk with room (--out)"))
            });
        }
        let moment = Snapshot {
            t,
            q: q.to_vec(),
            energy,
            measured: self.row[self.row.len() - courses(self.prepared).count()..].to_vec(),
            loads: self.columns.loads(&self.row),
        };
        self.kept.add(moment);
        Ok(())
    }

    /// Rows at the multiples within the latest step; those at its end belong to the next one.
    fn add_multiples(&mut self) -> Result<(), RunError> {
        while let Rows::AtMultiples { dt, next, dense: Some(dense) } = &mut self.rows {
            let ((start, end), t) = (dense.span(), f64::from(*next) * *dt);
            // a multiple within round-off of the end is the end
            if t >= end - 1e-9 * dt.min(end - start) {
                break;
            }
            *next += 1;
            let moment = dense.at(t);
            self.add(t, [&moment.a, &moment.v, &moment.q], &moment.mu)?;
        }
        Ok(())
    }

    /// The row at the end of a run, where the last step did not bring it.
    fn add_end(&mut self) -> Result<(), RunError> {
        if let Rows::AtMultiples { dense: Some(dense), .. } = &self.rows
            && self.steps > 0
        {
            let end = dense.span().1;
            let moment = dense.at(end);
            self.add(end, [&moment.a, &moment.v, &moment.q], &moment.mu)?;
        }
        let last = self.ends.end();
        self.add_sample(last)
    }

    /// How the energy changed, where it should be constant.
    pub fn energy_course(&self) -> Option<EnergyCourse> {
        self.energy
    }

    /// Finishes all files, of which there are none without a finished step.
    pub fn finish(mut self, progress: &Progress) -> Finished {
        let (mut files, mut unwritten) = (Vec::new(), None);
        if self.steps == 0 {
            return Finished { files, unwritten, charts: Vec::new(), moments: Vec::new() };
        }
        let mut keep = |written: Result<(), Failure>, own: &[PathBuf]| match written {
            Ok(()) => files.extend_from_slice(own),
            Err(failure) => unwritten = unwritten.take().or(Some(failure)),
        };
        keep(self.add_end().map_err(Failure::from), &[]);
        keep(self.unwritten.take().map_or(Ok(()), Err), &[]);
        let folder = self.folder;
        for (file, written) in self.histories.finish() {
            keep(written.map_err(Failure::from), &[file]);
        }
        if let Some(meshes) = &self.meshes {
            keep(meshes.finish().map_err(Failure::from), &[folder.join(super::meshes::SERIES)]);
        }
        progress.set(1);
        let moments = self.kept.finish();
        let picture = |name: &str| [".png", ".svg"].map(|end| folder.join(format!("{name}{end}")));
        let joints: Vec<&str> = self.columns.loaded_joints().collect();
        let charts = charts(self.prepared, &moments, &joints);
        if !charts.is_empty() {
            keep(write_panels(&charts, &folder.join("histories")).map_err(Failure::from), &picture("histories"));
        }
        progress.set(2);
        if let Some(motion) = motion(self.prepared, &moments) {
            keep(motion.write(&folder.join("motion")).map_err(Failure::from), &picture("motion"));
        }
        if self.film {
            let film = folder.join("film.png");
            match write_film(self.prepared, &moments, &film) {
                Ok(true) => keep(Ok(()), &[film]),
                Ok(false) => {}
                Err(error) => keep(Err(error.into()), &[]),
            }
        }
        Finished { files, unwritten, charts, moments }
    }
}

impl Observer for Results<'_> {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        self.dropped.clone_from(&start.dropped);
        if let Rows::AtMultiples { dense, .. } = &mut self.rows {
            *dense = Some(Box::new(Dense::new(start)));
            return Ok(());
        }
        let record = &start.acceleration;
        self.add(record.t, [&record.unknowns.x, &record.base.v, &record.base.q], &record.unknowns.mu)
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.steps += 1;
        self.dropped.clone_from(&step.dropped);
        if let Rows::AtMultiples { dense: Some(dense), .. } = &mut self.rows {
            dense.step(step);
            self.add_multiples()?;
            return Ok(true);
        }
        let known = self.ends.add(step);
        self.add_sample(known)?;
        Ok(true)
    }
}

/// Of many nodes those that say something by their name: what functionals measure, then what the scene made itself; all of them where
/// there are none of these.
fn telling<'p>(prepared: &'p Prepared, all: Vec<&'p Node>) -> Vec<&'p Node> {
    let model = prepared.model();
    let is_in = |ids: &[NodeId], node: &Node| ids.iter().any(|&id| model.node(id).dofs == node.dofs);
    let measured = |node: &&Node| {
        prepared.functionals().iter().any(|functional| match &functional.measured {
            // a place, velocity or angle is that of one node; stresses see those of their whole element
            Measured::Local { nodes, .. } => nodes.len() == 1 && is_in(nodes, node),
            _ => false,
        })
    };
    let (of_functionals, others): (Vec<_>, Vec<_>) = all.into_iter().partition(measured);
    let (of_members, own): (Vec<_>, Vec<_>) =
        others.into_iter().partition(|node| is_in(&prepared.mechanism.nodes_of_members, node));
    let named = [of_functionals, own].concat();
    if named.is_empty() { of_members } else { named }
}

/// One panel for each direction in which something moves, one for free coordinates, one for the energy, those of forces and moments of joints,
/// one for each unit of what functionals measure.
fn charts(prepared: &Prepared, moments: &[Snapshot], joints: &[&str]) -> Vec<Chart> {
    let in_space = |node: &&Node| !matches!(node.kind, NodeKind::Coordinates(_));
    let places: Vec<&Node> = moving(prepared.model()).filter(in_space).collect();
    let mut charts = charts_of_places(prepared, moments, &places);
    if let Some(start) = moments.first().and_then(|moment| moment.energy) {
        let drift = curve(moments, String::new(), |moment| moment.energy.unwrap_or(f64::NAN) - start);
        charts.push(panel("change of energy [J]".into(), vec![drift], 1));
    }
    // one key for all panels: a node has the same colour in each
    for chart in charts.iter_mut().skip(1).filter(|chart| !chart.y_label.starts_with("coordinates")) {
        chart.series.iter_mut().for_each(|series| series.name.clear());
    }
    charts.extend(charts_of_joints(moments, joints, size_of(moments, &places)));
    charts.extend(charts_of_quantities(prepared, moments));
    if let Some(first) = charts.first_mut() {
        let kind = if first.title.is_empty() { String::new() } else { format!(", {}", first.title) };
        first.title = format!("{}{kind}", prepared.scene.name());
        if let [only] = &mut first.series[..] {
            first.title += &format!(": {}", std::mem::take(&mut only.name));
        }
    }
    charts
}

fn curve(moments: &[Snapshot], name: String, value: impl Fn(&Snapshot) -> f64) -> Series {
    let points = thinned(moments).map(|(_, moment)| (moment.t, value(moment))).collect();
    Series { name, points, style: Style::Line }
}

fn panel(y_label: String, mut series: Vec<Series>, all: usize) -> Chart {
    series.truncate(MOST_CURVES);
    let title = if series.len() < all { format!("{y_label}: {} of {all}", series.len()) } else { String::new() };
    Chart { title, x_label: "time [s]".into(), y_label, series, ..Chart::default() }
}

/// How far nodes spread and move, 1 for those that stand in one place \[m\].
fn size_of(moments: &[Snapshot], places: &[&Node]) -> f64 {
    let along = |k| extent(moments.iter().flat_map(|m| places.iter().map(move |node| m.q[node.dofs.start + k])));
    let size = (0..3).map(along).fold(0.0, f64::max);
    if size > 0.0 { size } else { 1.0 }
}

/// Those of nodes in space and of free coordinates.
fn charts_of_places(prepared: &Prepared, moments: &[Snapshot], places: &[&Node]) -> Vec<Chart> {
    let (model, mut charts) = (prepared.model(), Vec::new());
    let all = places.len();
    let places = if all > MOST_CURVES { telling(prepared, places.to_vec()) } else { places.to_vec() };
    let label = |node: &Node| {
        let index = model.nodes.iter().position(|own| own.dofs == node.dofs);
        index.map_or_else(|| node.name.clone(), |index| prepared.mechanism.label(model.node_id(index)))
    };
    let labels: Vec<String> = places.iter().map(|node| label(node)).collect();
    for (index, direction) in ["x", "y", "z"].into_iter().enumerate() {
        let named = places.iter().zip(&labels);
        let series: Vec<Series> =
            named.map(|(node, label)| curve(moments, label.clone(), |m| m.q[node.dofs.start + index])).collect();
        if series.iter().any(|series| extent(series.points.iter().map(|point| point.1)) > 1e-9) {
            charts.push(panel(format!("{direction} [m]"), series, all));
        }
    }
    let free = moving(model).filter(|node| matches!(node.kind, NodeKind::Coordinates(_)));
    let series: Vec<Series> = free
        .flat_map(|node| node.dofs.clone().map(move |dof| (format!("{} q{}", node.name, dof - node.dofs.start), dof)))
        .map(|(name, dof)| curve(moments, name, |moment| moment.q[dof]))
        .collect();
    if !series.is_empty() {
        let all = series.len();
        charts.push(panel("coordinates".into(), series, all));
    }
    charts
}

/// Forces and moments of joints of a mechanism of a size.
fn charts_of_joints(moments: &[Snapshot], joints: &[&str], size: f64) -> Vec<Chart> {
    let mut charts = Vec::new();
    let peak = |k: usize, kind: usize| moments.iter().fold(0.0, |most: f64, moment| most.max(moment.loads[k][kind]));
    let [force, moment] = [0, 1].map(|kind| (0..joints.len()).fold(0.0, |most: f64, k| most.max(peak(k, kind))));
    // moments of a planar mechanism's hinges are what rounding leaves of its forces
    let least = [force + moment / size, moment + force * size].map(|scale| NO_LOAD * scale);
    for (kind, y_label) in ["forces of joints [N]", "moments of joints [N m]"].into_iter().enumerate() {
        let mut peaks: Vec<(usize, f64)> = (0..joints.len()).map(|k| (k, peak(k, kind))).collect();
        peaks.retain(|own| own.1 > least[kind]);
        let all = peaks.len();
        if all > MOST_CURVES {
            peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
            peaks.truncate(MOST_CURVES);
            peaks.sort_unstable_by_key(|own| own.0);
        }
        let series: Vec<Series> =
            peaks.into_iter().map(|(k, _)| curve(moments, joints[k].into(), |moment| moment.loads[k][kind])).collect();
        if !series.is_empty() {
            let title =
                if all > MOST_CURVES { format!("{y_label}: the {MOST_CURVES} largest of {all}") } else { String::new() };
            charts.push(Chart { title, ..panel(y_label.into(), series, 0) });
        }
    }
    charts
}

/// What has a unit of its own; places and speeds of points are seen elsewhere.
fn charts_of_quantities(prepared: &Prepared, moments: &[Snapshot]) -> Vec<Chart> {
    let loads: Vec<_> =
        courses(prepared).enumerate().filter(|(_, own)| !matches!(own.unit, "m" | "m2" | "m/s" | "-")).collect();
    let mut units: Vec<&str> = loads.iter().map(|(_, own)| own.unit).collect();
    units.sort_unstable();
    units.dedup();
    let chart = |unit| {
        let own = loads.iter().filter(|(_, functional)| functional.unit == unit);
        let series: Vec<Series> =
            own.map(|(k, functional)| curve(moments, functional.name.clone(), |moment| moment.measured[*k])).collect();
        let all = series.len();
        panel(format!("[{unit}]"), series, all)
    };
    units.into_iter().map(chart).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::history_files::HISTORIES;
    use crate::cli::snapshot::MOST_POINTS;
    use crate::design::DesignVariable;
    use crate::elements::{Element, Parameter, State};
    use crate::io::View;
    use crate::scalar::{Scalar, SpatialVector, Vector3};
    use crate::scenes::{MechanismBuilder, Scene, Settings};

    /// R = a + q: an oscillator without a place in space, and without energies.
    struct Oscillator;
    impl Element for Oscillator {
        const PARAMETERS: &'static [Parameter] = &[];
        fn nodes(&self) -> Vec<NodeKind> {
            vec![NodeKind::Coordinates(1)]
        }
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
            let ball = m.point("ball", Vector3::zeros());
            m.point_mass("ball", ball, S::one());
            m.gravity(Vector3::from_f64([0.0, 0.0, -9.81]));
            m.set_velocity(ball, Vector3::from_f64(velocity), Vector3::zeros());
            Ok(())
        }
    }

    fn ran<'p>(prepared: &'p Prepared, folder: &Folder) -> Results<'p> {
        let mut results = Results::begin(prepared, &Output::default(), &folder.0).unwrap();
        let (_, stopped) = prepared.analysis().observed(&prepared.x, &mut results).unwrap();
        assert_eq!(stopped, None);
        results
    }

    /// A folder of its own for one test, removed when dropped.
    struct Folder(PathBuf);
    impl Folder {
        fn new(name: &str) -> Self {
            Folder(std::env::temp_dir().join(format!("costate-results-{}-{name}", std::process::id())))
        }
    }
    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
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
            let (scene, folder) = (Thrown(Some(velocity)), Folder::new("view"));
            let prepared = Prepared::new(&scene).unwrap();
            let results = ran(&prepared, &folder);
            assert_eq!(motion(&prepared, &results.kept.finish()).unwrap().view, expected, "{velocity:?}");
        }
    }

    #[test]
    fn a_scene_without_a_place_in_space_has_histories_but_no_picture_of_its_motion() {
        let (scene, folder) = (Thrown(None), Folder::new("free"));
        let prepared = Prepared::new(&scene).unwrap();
        let Finished { files, unwritten, .. } = ran(&prepared, &folder).finish(&Progress::new("writing", 3));
        assert!(unwritten.is_none(), "{unwritten:?}");
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        let arrow = cfg!(feature = "arrow").then_some("histories.arrow");
        let expected: Vec<&str> =
            ["histories.csv"].into_iter().chain(arrow).chain(["histories.png", "histories.svg"]).collect();
        assert_eq!(names, expected);
        let text = std::fs::read_to_string(&files[0]).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("t [s],free.q0,free.dq0/dt,free.d2q0/dt2"));
        let last: Vec<f64> = lines.last().unwrap().split(',').map(|word| word.parse().unwrap()).collect();
        assert!((last[1] - 1f64.cos()).abs() < 1e-5 && (last[2] + 1f64.sin()).abs() < 1e-5, "{last:?}");
        assert!((last[3] + last[1]).abs() < 1e-12, "{last:?}");
    }
    #[test]
    fn a_long_run_keeps_no_more_moments_than_pictures_show() {
        let (scene, folder) = (Thrown(None), Folder::new("long"));
        let (steps, method) = (5 * MOST_POINTS + 7, Prepared::default_method());
        let prepared = Prepared::with(&scene, &[], method, Settings::new(1.0, steps)).unwrap();
        let results = ran(&prepared, &folder);
        let Finished { moments, unwritten, .. } = results.finish(&Progress::new("writing", 3));
        assert!(unwritten.is_none());
        assert!((MOST_POINTS..=2 * MOST_POINTS).contains(&moments.len()), "{} moments", moments.len());
        let stride = steps / moments.len() + 1;
        assert_eq!([moments[1].t, moments[moments.len() - 1].t], [prepared.grid.times[stride], 1.0]);
        let text = std::fs::read_to_string(folder.0.join(HISTORIES)).unwrap();
        assert_eq!(text.lines().count(), steps + 2);
    }
}
