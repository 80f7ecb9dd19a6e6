/// What a residual costs: rho(z) of its square z, as SciPy's `least_squares` names and defines it, in units of deviations. The sum of all rho is to
/// become least.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loss {
    /// z: least squares, the most likely of normally distributed errors.
    #[default]
    Linear,
    /// z up to 1, and 2 sqrt(z) - 1 beyond: what lies farther than a deviation pulls as if it lay there.
    Huber,
    /// 2 (sqrt(1 + z) - 1): the same smoothly.
    SoftL1,
    /// ln(1 + z): the farther away, the less it pulls.
    Cauchy,
}

impl Loss {
    /// All of them.
    #[doc(hidden)]
    pub const ALL: [Loss; 4] = [Loss::Linear, Loss::Huber, Loss::SoftL1, Loss::Cauchy];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Loss::Linear => "linear",
            Loss::Huber => "huber",
            Loss::SoftL1 => "soft_l1",
            Loss::Cauchy => "cauchy",
        }
    }

    /// rho(z) with its first and second derivative.
    #[doc(hidden)]
    pub fn rho(self, z: f64) -> [f64; 3] {
        match self {
            Loss::Huber if z > 1.0 => [2.0 * z.sqrt() - 1.0, z.powf(-0.5), -0.5 * z.powf(-1.5)],
            Loss::Linear | Loss::Huber => [z, 1.0, 0.0],
            Loss::SoftL1 => [2.0 * ((1.0 + z).sqrt() - 1.0), (1.0 + z).powf(-0.5), -0.5 * (1.0 + z).powf(-1.5)],
            Loss::Cauchy => [z.ln_1p(), 1.0 / (1.0 + z), -1.0 / (1.0 + z).powi(2)],
        }
    }
}

/// A curve that was measured, and the functional whose quantity it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Its name.
    pub name: String,
    /// Name of the functional; of a scenario as in "stress \[hover\]". What is made of its quantity over time counts for nothing here.
    pub functional: String,
    /// Unit of the values, where their table says it.
    pub unit: Option<String>,
    /// When was measured \[s\], increasing.
    pub times: Vec<f64>,
    /// What was measured.
    pub values: Vec<f64>,
    /// Standard deviation of the error of each value; without them all are alike, and their size follows from the residuals.
    pub deviations: Option<Vec<f64>>,
    /// Name of the design variable by which its times are too late \[s\].
    pub delay: Option<String>,
}

impl Measurement {
    /// Deviation of a value; 1 where none are known.
    pub(crate) fn deviation(&self, place: usize) -> f64 {
        self.deviations.as_ref().map_or(1.0, |all| all[place])
    }
}

/// What is known of a design variable beside the measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Its name.
    pub variable: String,
    /// What it is expected to be.
    pub mean: f64,
    /// How exactly that is known.
    pub deviation: f64,
}

/// Measurements that a scene is to be fitted to, by some of its design variables within their bounds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitProblem {
    /// What was measured.
    pub measurements: Vec<Measurement>,
    /// What is known beside.
    pub priors: Vec<Prior>,
    /// Names of the design variables that may change; all without it.
    pub varying: Option<Vec<String>>,
    /// What residuals of measurements cost; those of priors are squared.
    pub loss: Loss,
}
