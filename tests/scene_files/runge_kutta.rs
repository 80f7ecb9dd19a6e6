//! The classical method of fourth order, against which files are held.

/// The state at the end of some steps of one length from t = 0, with its slope y'(t, y).
pub fn integrated<const N: usize>(
    mut y: [f64; N],
    (steps, h): (u32, f64),
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    for step in 0..steps {
        let t = f64::from(step) * h;
        let along = |k: [f64; N], c: f64| std::array::from_fn(|i| y[i] + c * k[i]);
        let k1 = slope(t, y);
        let k2 = slope(t + h / 2.0, along(k1, h / 2.0));
        let k3 = slope(t + h / 2.0, along(k2, h / 2.0));
        let k4 = slope(t + h, along(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    y
}
