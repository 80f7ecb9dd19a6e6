/// What a vector that goes from step to step is: how many times it has been differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// Coordinates.
    Q,
    /// Velocities.
    V,
    /// Accelerations.
    A,
}

impl Carried {
    /// Number of time derivatives: a term of order s enters one of order k with the factor h^(s - k).
    pub fn order(self) -> i32 {
        match self {
            Carried::Q => 0,
            Carried::V => 1,
            Carried::A => 2,
        }
    }
}

/// Coefficients of the carried vectors and of the stage accelerations; powers of h are implied by [`Carried::order`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Combination {
    /// One for each carried vector.
    pub carried: Vec<f64>,
    /// One for each stage.
    pub stages: Vec<f64>,
}

/// One stage: where (a, v, q) of the residual lie.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Time within the step, as a share of h.
    pub c: f64,
    /// Acceleration.
    pub a: Combination,
    /// Velocity.
    pub v: Combination,
    /// Coordinates.
    pub q: Combination,
    /// The stage's acceleration is this carried vector instead of an unknown (explicit first stage).
    pub known: Option<usize>,
}

/// Stage and update relations of an integrator.
///
/// For stages i and carried vectors Y (the first two are q and v):
///
/// q_i = sum U_q Y + h^2 sum A_q x_j,  v_i = sum U_v Y + h sum A_v x_j,  a_i = sum U_a Y + sum A_a x_j,
/// Y' = sum V Y + sum B x_j, with R(a_i, v_i, q_i, p, t_i) = 0 for the unknown x_i.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name on the command line.
    pub name: &'static str,
    /// Order for ordinary differential equations.
    pub order: usize,
    /// Vectors that go from step to step.
    pub carried: Vec<Carried>,
    /// Stages in the order of their solution.
    pub stages: Vec<Stage>,
    /// New carried vectors.
    pub update: Vec<Combination>,
    /// Quadrature weights of functionals at the stages.
    pub weights: Vec<f64>,
    /// First-order coefficients a_ij, and b in the last row: how rate corrections of the velocity level enter q.
    pub rates: Vec<Vec<f64>>,
    /// The last stage lies at the end of the step and is the new state.
    pub stiffly_accurate: bool,
}

/// A Runge-Kutta tableau with a lower-triangular matrix.
#[derive(Clone, Debug)]
pub struct Butcher {
    /// Name on the command line.
    pub name: &'static str,
    /// Claimed order.
    pub order: usize,
    /// Rows of the matrix up to the diagonal.
    pub a: Vec<Vec<f64>>,
    /// Weights.
    pub b: Vec<f64>,
}

impl Butcher {
    /// Nodes: the row sums.
    fn nodes(&self) -> Vec<f64> {
        self.a.iter().map(|row| row.iter().sum()).collect()
    }

    /// Largest violation of the conditions for the claimed order (at most 4), with their names.
    pub fn order_defect(&self) -> (f64, &'static str) {
        let c = self.nodes();
        let b = &self.b;
        let sum = |f: &dyn Fn(usize) -> f64| (0..b.len()).map(|i| b[i] * f(i)).sum::<f64>();
        let row = |i: usize, f: &dyn Fn(usize) -> f64| self.a[i].iter().enumerate().map(|(j, a)| a * f(j)).sum::<f64>();
        let conditions = [
            (1, "sum b = 1", sum(&|_| 1.0) - 1.0),
            (2, "sum b c = 1/2", sum(&|i| c[i]) - 1.0 / 2.0),
            (3, "sum b c^2 = 1/3", sum(&|i| c[i] * c[i]) - 1.0 / 3.0),
            (3, "sum b A c = 1/6", sum(&|i| row(i, &|j| c[j])) - 1.0 / 6.0),
            (4, "sum b c^3 = 1/4", sum(&|i| c[i].powi(3)) - 1.0 / 4.0),
            (4, "sum b c A c = 1/8", sum(&|i| c[i] * row(i, &|j| c[j])) - 1.0 / 8.0),
            (4, "sum b A c^2 = 1/12", sum(&|i| row(i, &|j| c[j] * c[j])) - 1.0 / 12.0),
            (4, "sum b A A c = 1/24", sum(&|i| row(i, &|j| row(j, &|k| c[k]))) - 1.0 / 24.0),
        ];
        let claimed = conditions.into_iter().filter(|(order, ..)| *order <= self.order);
        claimed.map(|(_, name, defect)| (defect.abs(), name)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, ""))
    }

    /// The table for second-order systems: the tableau applied to (q, v)' = (v, a).
    ///
    /// # Panics
    /// If the tableau misses its claimed order or is not lower triangular: a mistake in the coefficients.
    pub fn into_table(self) -> Table {
        let (defect, condition) = self.order_defect();
        assert!(defect < 1e-14, "{}: order {} needs {condition}, missed by {defect:e}", self.name, self.order);
        let s = self.b.len();
        assert!(self.a.len() == s && self.a.iter().zip(1..).all(|(row, n)| row.len() == n), "{}: shape", self.name);
        let c = self.nodes();
        let entry = |i: usize, j: usize| self.a[i].get(j).copied().unwrap_or(0.0);
        let explicit_first = self.a[0][0] == 0.0;
        let mut carried = vec![Carried::Q, Carried::V];
        if explicit_first {
            carried.push(Carried::A);
        }
        let combine = |given: &[f64], stages: Vec<f64>| {
            let mut all = vec![0.0; carried.len()];
            all[..given.len()].copy_from_slice(given);
            Combination { carried: all, stages }
        };
        let square = |weights: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..s).map(|j| (0..s).map(|k| weights(k) * entry(k, j)).sum()).collect()
        };
        let stages = (0..s)
            .map(|i| {
                let known = (i == 0 && explicit_first).then_some(2);
                let unit = (0..s).map(|j| f64::from(u8::from(i == j && known.is_none()))).collect();
                let mut a = combine(&[], unit);
                if let Some(place) = known {
                    a.carried[place] = 1.0;
                }
                let v = combine(&[0.0, 1.0], (0..s).map(|j| entry(i, j)).collect());
                let q = combine(&[1.0, c[i]], square(&|k| entry(i, k)));
                Stage { c: c[i], a, v, q, known }
            })
            .collect();
        let mut update = vec![combine(&[1.0, 1.0], square(&|k| self.b[k])), combine(&[0.0, 1.0], self.b.clone())];
        if explicit_first {
            update.push(combine(&[], (0..s).map(|j| f64::from(u8::from(j == s - 1))).collect()));
        }
        let stiffly_accurate = self.a[s - 1] == self.b;
        let mut rates = self.a.clone();
        rates.push(self.b.clone());
        Table { name: self.name, order: self.order, carried, stages, update, weights: self.b, rates, stiffly_accurate }
    }
}

impl Table {
    /// h times the last diagonal coefficient: the time scale of the metric of the projections.
    pub fn projection_step(&self, h: f64) -> f64 {
        let last = self.stages.len() - 1;
        h * self.stages[last].v.stages[last]
    }
}
