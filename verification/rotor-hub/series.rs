//! Frequencies of a uniform cantilever that turns about its clamped end: EI w'''' - (T w')' = omega^2 w with T = rate^2 (1 - x^2) / 2, by power
//! series (as Wright, Smith, Thresher & Wang 1982).

/// Terms of the series: each is smaller than the one before by the square of the place.
const TERMS: usize = 120;

/// w'' and w''' at the tip of the solution with w = w' = 0 and (w'', w''') given at the root.
fn at_tip(stiffness: f64, rate: f64, square: f64, [second, third]: [f64; 2]) -> [f64; 2] {
    let mut c = vec![0.0; TERMS + 4];
    (c[2], c[3]) = (0.5 * second, third / 6.0);
    let half = 0.5 * rate * rate;
    for n in 0..TERMS {
        let at = |k: usize| if k < c.len() { c[k] } else { 0.0 };
        // (T w')' = half ((1 - x^2) w'' - 2 x w')
        let of_tension = half * ((n + 2) as f64 * (n + 1) as f64 * at(n + 2) - (n * (n + 1)) as f64 * at(n));
        let product = ((n + 4) * (n + 3) * (n + 2) * (n + 1)) as f64;
        c[n + 4] = (of_tension + square * at(n)) / (stiffness * product);
    }
    let sum = |order: usize| -> f64 {
        let factor = |k: usize| (0..order).map(|i| (k - i) as f64).product::<f64>();
        (order..c.len()).map(|k| factor(k) * c[k]).sum()
    };
    [sum(2), sum(3)]
}

/// The determinant of the conditions at the free end.
fn determinant(stiffness: f64, rate: f64, omega: f64) -> f64 {
    let [a, b] = [[1.0, 0.0], [0.0, 1.0]].map(|start| at_tip(stiffness, rate, omega * omega, start));
    a[0] * b[1] - a[1] * b[0]
}

/// The lowest ones, with L = rho A = 1.
pub fn blade_frequencies<const N: usize>(stiffness: f64, rate: f64) -> [f64; N] {
    let (step, mut found, mut omega) = (0.05, Vec::new(), 0.05);
    let mut before = determinant(stiffness, rate, omega);
    while found.len() < N {
        let after = determinant(stiffness, rate, omega + step);
        if before * after < 0.0 {
            let (mut low, mut high) = (omega, omega + step);
            while high - low > 1e-13 * high {
                let middle = 0.5 * (low + high);
                if determinant(stiffness, rate, middle) * before > 0.0 { low = middle } else { high = middle }
            }
            found.push(0.5 * (low + high));
        }
        (before, omega) = (after, omega + step);
    }
    std::array::from_fn(|k| found[k])
}
