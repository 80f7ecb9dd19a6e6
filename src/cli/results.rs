//! The files of a run: histories.csv, with the feature `arrow` histories.arrow beside it, fields.pvd with its .vtu files.

use super::failure::Failure;
use super::measured_moments::{MeasuredMoments, MeasuredRun};
use super::meshes::Meshes;
#[cfg(feature = "arrow")]
use crate::io::ArrowFile;
use crate::io::{CsvFile, write_file};
use costate::assembly::VectorsAvq;
use costate::design::shortest;
use costate::functionals::{Sample, StepEnds};
use costate::history::{Dense, Observer};
use costate::integrators::{RunError, StartRecord, StepRecord};
use costate::scenes::{Output, Prepared};
use std::path::{Path, PathBuf};

/// Name of the table of states.
const HISTORIES: &str = "histories.csv";
/// The same as columns.
#[cfg(feature = "arrow")]
const COLUMNS: &str = "histories.arrow";

/// Makes sure that the folder can take files, before anything is computed.
pub fn check_folder(folder: &Path) -> Result<(), Failure> {
    let probe = folder.join(format!(".probe-{}", std::process::id()));
    let written = write_file(&probe, b"");
    let _ = std::fs::remove_file(&probe);
    written.map_err(|error| {
        Failure::input(format!("--out {}: {}; it must be a folder that can be written to", folder.display(), error.cause))
    })
}

/// The files of a run while it goes on: rows go to histories.csv, and of the motion so many moments are kept as a page can show.
pub struct Results<'p> {
    prepared: &'p Prepared<'p>,
    folder: PathBuf,
    histories: CsvFile,
    /// The same as columns.
    #[cfg(feature = "arrow")]
    columns: ArrowFile,
    meshes: Option<Meshes<'p>>,
    measured: MeasuredMoments<'p>,
    /// Places of the columns that are written among those that are measured.
    written: Vec<usize>,
    /// Redundant constraint equations that were left out last.
    dropped: Vec<usize>,
    rows: Rows,
    /// Ends of steps that become known.
    ends: StepEnds<'p, f64>,
    /// The next step starts behind an event that has changed the state.
    is_behind_event: bool,
    steps: usize,
    /// Why rows and meshes end before the run.
    unwritten: Option<Failure>,
}

/// What is left of a run when its files are written.
#[derive(Default)]
pub struct Finished {
    pub files: Vec<PathBuf>,
    /// Why others could not be.
    pub unwritten: Option<Failure>,
    pub measured: MeasuredRun,
}

/// At which times there are rows.
enum Rows {
    AtSteps,
    /// Multiples of `dt` and the end.
    AtMultiples {
        dt: f64,
        next: u32,
        dense: Option<Box<Dense>>,
    },
}

impl<'p> Results<'p> {
    pub fn begin(prepared: &'p Prepared<'p>, output: &Output, folder: &Path) -> Result<Self, Failure> {
        let measured = MeasuredMoments::new(prepared);
        let written = measured.columns.chosen(&output.histories).map_err(Failure::input)?;
        let names = measured.columns.names();
        let names: Vec<String> = written.iter().map(|&place| names[place].clone()).collect();
        Ok(Results {
            prepared,
            folder: folder.to_path_buf(),
            histories: CsvFile::create(&folder.join(HISTORIES), &names)?,
            #[cfg(feature = "arrow")]
            columns: ArrowFile::create(&folder.join(COLUMNS), &names)?,
            meshes: output.meshes.then(|| Meshes::new(prepared, folder)),
            measured,
            written,
            dropped: Vec::new(),
            rows: output.step.map_or(Rows::AtSteps, |dt| Rows::AtMultiples { dt, next: 0, dense: None }),
            ends: StepEnds::new(&prepared.method.table),
            is_behind_event: false,
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
        let (model, p) = (self.prepared.model(), &self.prepared.mechanism.numbers.p);
        let at = VectorsAvq { a: a.to_vec(), v: v.to_vec(), q: q.to_vec() };
        let (mu, dropped) = (mu[..model.equations].to_vec(), self.dropped.clone());
        let mut sample = Sample { t, at, mu, dropped, ..Sample::empty() };
        sample.share(model, p);
        self.measured.add(&sample);
        // a full disk ends the files, not the simulation, whose other results may have room elsewhere
        if self.unwritten.is_none() {
            let row: Vec<f64> = self.written.iter().map(|&place| self.measured.row[place]).collect();
            let written = self.histories.row(&row);
            #[cfg(feature = "arrow")]
            let written = written.and_then(|()| self.columns.row(&row));
            let mut meshes = || self.meshes.as_mut().map_or(Ok(()), |meshes| meshes.add(&sample));
            let place =
                if self.steps == 0 { "start".into() } else { format!("step {} (t = {} s)", self.steps, shortest(t)) };
            self.unwritten = written.and_then(|()| meshes()).err().map(|error| {
                Failure::run(format!("{place}: {error}; the files end there: choose a folder on a disk with room (--out)"))
            });
        }
        Ok(())
    }

    /// A second row at the time of an event, behind it.
    fn add_start(&mut self, step: &StepRecord<f64>) -> Result<(), RunError> {
        let last = self.ends.end();
        self.add_sample(last)?;
        self.dropped.clone_from(&step.dropped);
        let solved = step.restart.as_ref().or(step.stages.first().map(|stage| &stage.solve));
        let Some(solved) = solved else { return Ok(()) };
        let [v, q] = step.start();
        self.add(step.t, [&solved.unknowns.x, v, q], &solved.unknowns.mu)
    }

    /// Rows at the multiples within the latest step; those at its end belong to the next one.
    fn add_multiples(&mut self) -> Result<(), RunError> {
        while let Rows::AtMultiples { dt, next, dense: Some(dense) } = &mut self.rows {
            let ((start, end), t) = (dense.span(), f64::from(*next) * *dt);
            // a multiple within round-off of the end is the end
            if t >= end - costate::program::tolerances::SAME_TIME * dt.min(end - start) {
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

    /// Finishes all files, of which there are none without a finished step.
    pub fn finish(mut self) -> Finished {
        if self.steps == 0 {
            return Finished::default();
        }
        let (mut files, mut unwritten) = (Vec::new(), None);
        let mut keep = |written: Result<(), Failure>, own: &[PathBuf]| match written {
            Ok(()) => files.extend_from_slice(own),
            Err(failure) => unwritten = unwritten.take().or(Some(failure)),
        };
        keep(self.add_end().map_err(Failure::from), &[]);
        keep(self.unwritten.take().map_or(Ok(()), Err), &[]);
        let folder = self.folder;
        keep(self.histories.finish_cut().map_err(Failure::from), &[folder.join(HISTORIES)]);
        #[cfg(feature = "arrow")]
        keep(self.columns.finish().map_err(Failure::from), &[folder.join(COLUMNS)]);
        if let Some(meshes) = &self.meshes {
            keep(meshes.finish().map_err(Failure::from), &[folder.join(super::meshes::SERIES)]);
        }
        Finished { files, unwritten, measured: self.measured.finish() }
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
        if std::mem::take(&mut self.is_behind_event) {
            self.add_start(step)?;
        }
        let known = self.ends.add(step);
        self.add_sample(known)?;
        self.is_behind_event = !step.set.is_empty() || !step.impacts.is_empty();
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Folder;
    use crate::motions::{View, view};
    use crate::snapshot::MOST_POINTS;
    use costate::design::DesignVariable;
    use costate::elements::{Element, NodeKind, Parameter, State};
    use costate::scalar::{Scalar, SpatialVector, Vector3};
    use costate::scenes::{MechanismBuilder, Scene, Settings};

    /// R = a + q: an oscillator without a place in space, and without energies.
    #[derive(Hash)]
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
            assert_eq!(view(&prepared, &results.measured.finish().moments), Some(expected), "{velocity:?}");
        }
    }

    #[test]
    fn a_scene_without_a_place_in_space_has_histories() {
        let (scene, folder) = (Thrown(None), Folder::new("free"));
        let prepared = Prepared::new(&scene).unwrap();
        let Finished { files, unwritten, measured } = ran(&prepared, &folder).finish();
        assert_eq!(view(&prepared, &measured.moments), None);
        assert!(unwritten.is_none(), "{unwritten:?}");
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        let arrow = cfg!(feature = "arrow").then_some("histories.arrow");
        let expected: Vec<&str> = ["histories.csv"].into_iter().chain(arrow).collect();
        assert_eq!(names, expected);
        let text = std::fs::read_to_string(&files[0]).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("t [s],free.q0,free.dq0/dt,free.d2q0/dt2"));
        let last: Vec<f64> = lines.last().unwrap().split(',').map(|word| word.parse().unwrap()).collect();
        assert!((last[1] - 1f64.cos()).abs() < 1e-5 && (last[2] + 1f64.sin()).abs() < 1e-5, "{last:?}");
        assert!((last[3] + last[1]).abs() < 1e-12, "{last:?}");
    }
    #[test]
    fn a_long_run_keeps_no_more_moments_than_pages_show() {
        let (scene, folder) = (Thrown(None), Folder::new("long"));
        let (steps, method) = (5 * MOST_POINTS + 7, Prepared::default_method());
        let prepared = Prepared::with(&scene, &[], method, Settings::new(1.0, steps)).unwrap();
        let results = ran(&prepared, &folder);
        let Finished { measured: MeasuredRun { moments, .. }, unwritten, .. } = results.finish();
        assert!(unwritten.is_none());
        assert!((MOST_POINTS..=2 * MOST_POINTS).contains(&moments.len()), "{} moments", moments.len());
        let stride = steps / moments.len() + 1;
        assert_eq!([moments[1].t, moments[moments.len() - 1].t], [prepared.grid.times[stride], 1.0]);
        let text = std::fs::read_to_string(folder.0.join(HISTORIES)).unwrap();
        assert_eq!(text.lines().count(), steps + 2);
    }
}
