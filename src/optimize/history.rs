use crate::design::DesignVariable;
use crate::functionals::Extremes;
use crate::integrators::Counters;

/// What a point cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Simulations.
    pub simulations: usize,
    /// Work of the simulations.
    pub simulation: Counters,
    /// Their wall time \[s\].
    pub simulation_seconds: f64,
    /// Adjoint sweeps, or simulations for gradients.
    pub sweeps: usize,
    /// Work of the gradients.
    pub gradient: Counters,
    /// Their wall time \[s\].
    pub gradient_seconds: f64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.simulations += other.simulations;
        self.simulation += other.simulation;
        self.simulation_seconds += other.simulation_seconds;
        self.sweeps += other.sweeps;
        self.gradient += other.gradient;
        self.gradient_seconds += other.gradient_seconds;
    }
}

/// A design that was simulated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesignPoint {
    /// Its number, from 0 at the start.
    pub evaluation: usize,
    /// The iteration that led to it, if one did: the others are trials of a line search.
    pub iteration: Option<usize>,
    /// All design variables.
    pub design: Vec<f64>,
    /// The functionals of the problem; NaN where the simulation failed.
    pub functionals: Vec<f64>,
    /// Smallest and largest values of what those that are aggregates are made of.
    pub extremes: Vec<Option<Extremes>>,
    /// Names of the events of all its runs, in the order in which they happened, where they are known.
    pub events: Option<Vec<String>>,
    /// Derivatives of the functionals by all design variables, where they were computed.
    pub gradients: Option<Vec<Vec<f64>>>,
    /// The objective in its own unit and sense; NaN where the simulation failed.
    pub objective: f64,
    /// Largest violation of a constraint, in its scale; NaN where the simulation failed.
    pub violation: f64,
    /// What it cost.
    pub work: Work,
    /// A whole number for what its values and gradients follow from: laws, numbers, method, settings. Not a number where it
    /// is not known.
    pub fingerprint: f64,
}

impl DesignPoint {
    /// The simulation or its gradient failed.
    pub fn failed(&self) -> bool {
        !(self.objective.is_finite() && self.violation.is_finite())
    }
}

/// All designs that an optimization has simulated, in order; a table that can be read back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DesignHistory {
    /// Names and units of the design variables.
    pub variables: Vec<(String, String)>,
    /// Names and units of the functionals of the problem.
    pub functionals: Vec<(String, String)>,
    /// The objective is to become large.
    pub maximize: bool,
    /// Largest violation that counts as none.
    pub tolerance: f64,
    /// The points.
    pub points: Vec<DesignPoint>,
}

/// Columns before those of design variables.
const FIRST: [&str; 5] = ["evaluation", "iteration", "objective", "violation", "failed"];
/// Columns behind those of functionals.
const LAST: [&str; 10] = [
    "simulations",
    "simulation newton iterations",
    "simulation factorizations",
    "simulation time [s]",
    "gradient sweeps",
    "gradient factorizations",
    "gradient solves",
    "gradient element products",
    "gradient time [s]",
    "fingerprint",
];

impl DesignHistory {
    /// Number and point of the best design: that of the best objective where all constraints hold, else of the least violation.
    pub fn best(&self) -> Option<&DesignPoint> {
        let sign = if self.maximize { -1.0 } else { 1.0 };
        let rank = |point: &DesignPoint| {
            if point.violation <= self.tolerance { (0, sign * point.objective) } else { (1, point.violation) }
        };
        let sound = self.points.iter().filter(|point| !point.failed());
        sound.min_by(|a, b| {
            let (a, b) = (rank(a), rank(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }

    /// What all points cost together.
    pub fn work(&self) -> Work {
        let mut work = Work::default();
        self.points.iter().for_each(|point| work += point.work);
        work
    }

    /// Names of the columns of [`DesignHistory::rows`].
    pub fn header(&self) -> Vec<String> {
        let named = |kind: &str, (name, unit): &(String, String)| format!("{kind} {name} [{unit}]");
        let mut header: Vec<String> = FIRST.map(String::from).to_vec();
        header.extend(self.variables.iter().map(|variable| named("design", variable)));
        header.extend(self.functionals.iter().map(|functional| named("functional", functional)));
        header.extend(LAST.map(String::from));
        let by = |functional: &str| self.variables.iter().map(move |own| format!("d {functional} / d {}", own.0)).collect();
        header.extend(self.functionals.iter().flat_map(|functional| -> Vec<String> { by(&functional.0) }));
        header
    }

    /// One row of numbers for each point; the iteration of a trial is NaN, as are derivatives that were not computed.
    pub fn rows(&self) -> impl Iterator<Item = Vec<f64>> {
        self.points.iter().map(|point| {
            let Work { simulations, simulation, simulation_seconds, sweeps, gradient, gradient_seconds } = point.work;
            let iteration = point.iteration.map_or(f64::NAN, |iteration| iteration as f64);
            let failed = f64::from(u8::from(point.failed()));
            let mut row = vec![point.evaluation as f64, iteration, point.objective, point.violation, failed];
            row.extend(&point.design);
            row.extend(&point.functionals);
            row.extend([simulations, simulation.iterations, simulation.factorizations].map(|count| count as f64));
            row.push(simulation_seconds);
            row.extend([sweeps, gradient.factorizations, gradient.solves, gradient.products].map(|count| count as f64));
            row.extend([gradient_seconds, point.fingerprint]);
            match &point.gradients {
                Some(gradients) => row.extend(gradients.iter().flatten()),
                None => row.resize(row.len() + self.functionals.len() * self.variables.len(), f64::NAN),
            }
            row
        })
    }

    /// The points of a table that was written from [`DesignHistory::header`] and [`DesignHistory::rows`] of a history with the same names,
    /// to the last digit; neither extremes nor events.
    ///
    /// # Errors
    /// Other columns.
    pub(crate) fn read(&mut self, header: &[String], rows: &[Vec<f64>]) -> Result<(), String> {
        let expected = self.header();
        if let Some(place) = (0..expected.len()).find(|&k| header.get(k) != Some(&expected[k])) {
            let found = header.get(place).map_or("nothing", String::as_str);
            return Err(format!(
                "column {} is \"{found}\", not \"{}\": it is of another optimization",
                place + 1,
                expected[place]
            ));
        }
        let (n, m) = (self.variables.len(), self.functionals.len());
        let work = FIRST.len() + n + m;
        let point = |(evaluation, row): (usize, &Vec<f64>)| {
            let last: [f64; LAST.len()] = std::array::from_fn(|k| row[work + k]);
            let count = |k: usize| last[k] as usize;
            let mut own = Work { simulations: count(0), simulation_seconds: last[3], ..Work::default() };
            (own.simulation.iterations, own.simulation.factorizations) = (count(1), count(2));
            (own.sweeps, own.gradient_seconds) = (count(4), last[8]);
            (own.gradient.factorizations, own.gradient.solves, own.gradient.products) = (count(5), count(6), count(7));
            let gradients = &row[work + LAST.len()..];
            let known = !gradients.is_empty() && gradients.iter().all(|g| g.is_finite());
            DesignPoint {
                evaluation,
                design: row[FIRST.len()..FIRST.len() + n].to_vec(),
                functionals: row[FIRST.len() + n..work].to_vec(),
                gradients: known.then(|| gradients.chunks(n).map(<[f64]>::to_vec).collect()),
                objective: row[2],
                violation: row[3],
                work: own,
                fingerprint: last[9],
                ..DesignPoint::default()
            }
        };
        self.points = rows.iter().enumerate().map(point).collect();
        Ok(())
    }

    /// The best design of a table that was written from [`DesignHistory::header`] and [`DesignHistory::rows`], its objective and its
    /// violation, for a scene with the given variables.
    ///
    /// # Errors
    /// A table with other variables or without a design whose simulation succeeded.
    pub fn best_of_table(
        header: &[String],
        rows: &[Vec<f64>],
        variables: &[DesignVariable],
        maximize: bool,
        tolerance: f64,
    ) -> Result<DesignPoint, String> {
        let column = |name: &str| {
            let found = header.iter().position(|own| own == name);
            found.ok_or_else(|| format!("it has no column \"{name}\", so it is no history of this scene's optimization"))
        };
        let names = variables.iter().map(|variable| format!("design {} [{}]", variable.name, variable.unit));
        let designs = names.map(|name| column(&name)).collect::<Result<Vec<_>, _>>()?;
        let [objective, violation] = [column("objective")?, column("violation")?];
        let point = |(evaluation, row): (usize, &Vec<f64>)| DesignPoint {
            evaluation,
            design: designs.iter().map(|&place| row[place]).collect(),
            objective: row[objective],
            violation: row[violation],
            fingerprint: f64::NAN,
            ..DesignPoint::default()
        };
        let points = rows.iter().enumerate().map(point).collect();
        let history = DesignHistory { maximize, tolerance, points, ..DesignHistory::default() };
        history.best().cloned().ok_or_else(|| "it has no design whose simulation succeeded".into())
    }
}
