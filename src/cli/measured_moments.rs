//! What is measured at the moments of a run: rows of its histories, and what pages show.

use super::columns::{Columns, courses};
use super::history_charts::charts;
use super::kept_moments::KeptMoments;
use super::snapshot::Snapshot;
use super::table_ranges::TableWatch;
use crate::io::Chart;
use costate::assembly::VectorsAvq;
use costate::functionals::{Measured, Sample};
use costate::program::tolerances;
use costate::scenes::Prepared;

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
        let is_some = |change: f64| change > tolerances::LONG_SUM * self.size && self.kinetic > 0.0;
        self.changes.map(|(change, t)| (if is_some(change) { change / self.kinetic } else { 0.0 }, t))
    }
}

#[derive(Default)]
pub struct MeasuredRun {
    /// So many moments as a page can show.
    pub moments: Vec<Snapshot>,
    pub charts: Vec<Chart>,
    /// How the energy changed, where it should be constant.
    pub energy: Option<EnergyCourse>,
    /// Warnings where tables were read beyond their points.
    pub left_tables: Vec<String>,
}

/// The moments of a run while it goes on, or is read again.
pub struct MeasuredMoments<'p> {
    prepared: &'p Prepared<'p>,
    pub columns: Columns<'p>,
    /// All columns of the latest moment.
    pub row: Vec<f64>,
    /// How the energy changed, where it should be constant.
    energy: Option<EnergyCourse>,
    tables: TableWatch<'p>,
    is_conservative: bool,
    measured_energy: Measured,
    kept: KeptMoments,
}

impl<'p> MeasuredMoments<'p> {
    pub fn new(prepared: &'p Prepared<'p>) -> Self {
        let columns = Columns::new(prepared);
        let is_motion = !prepared.method.table.is_static();
        MeasuredMoments {
            prepared,
            is_conservative: columns.have_energy() && is_motion && prepared.model().is_conservative(),
            columns,
            tables: TableWatch::new(prepared),
            row: Vec::new(),
            energy: None,
            measured_energy: Measured::energy(),
            kept: KeptMoments::default(),
        }
    }

    /// Measures at the next moment, at which redundant constraints share their forces.
    pub fn add(&mut self, sample: &Sample<f64>) {
        let (t, VectorsAvq { v, q, .. }) = (sample.t, &sample.at);
        let energy_of = |v: Vec<f64>| {
            let at = VectorsAvq { a: Vec::new(), v, q: q.clone() };
            let sample = Sample { t, at, ..Sample::empty() };
            self.measured_energy.value(self.prepared.model(), &sample, &self.prepared.mechanism.numbers.p)
        };
        let energy = self.columns.have_energy().then(|| energy_of(v.clone()));
        if let Some(energy) = energy.filter(|_| self.is_conservative) {
            let kinetic = energy - energy_of(vec![0.0; v.len()]);
            self.energy.get_or_insert(EnergyCourse::new(energy, t)).note(energy, kinetic, t);
        }
        self.row.clear();
        self.tables.add(sample);
        let outputs = self.columns.outputs_at(sample);
        self.columns.add_row(sample, energy, &outputs, &mut self.row);
        self.kept.add(Snapshot {
            t,
            q: q.clone(),
            energy,
            measured: self.row[self.row.len() - courses(self.prepared).count()..].to_vec(),
            outputs,
            loads: self.columns.loads(&self.row),
        });
    }

    pub fn finish(self) -> MeasuredRun {
        let (left_tables, moments) = (self.tables.in_words(), self.kept.finish());
        let charts = charts(self.prepared, &moments, &self.columns);
        MeasuredRun { moments, charts, energy: self.energy, left_tables }
    }
}
