//! The plane curve of an inextensible rod, clamped along x, under a dead load across it at its tip (Euler 1744).

/// Steps of the quadrature over the length.
const STEPS: usize = 4000;
/// Halvings of the bracket around the angle of the tip.
const HALVINGS: usize = 60;

/// Tip (x, y) of a rod with EI = L = 1 under the load P along y.
///
/// theta'' = -P cos(theta), theta(0) = 0, theta'(1) = 0: by shooting from the tip, whose angle is bracketed by 0 and a right angle.
pub fn tip(load: f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        // the more the tip is turned, the less the clamp is
        let [theta, ..] = from_the_tip(load, middle);
        if theta > 0.0 { high = middle } else { low = middle }
    }
    let [_, _, x, y] = from_the_tip(load, 0.5 * (low + high));
    [x, y]
}

/// Angle at the clamp, its rate, and the tip as seen from there, by the classical Runge-Kutta method.
fn from_the_tip(load: f64, angle: f64) -> [f64; 4] {
    // over the distance from the tip
    let rate = |[theta, slope, ..]: [f64; 4]| [slope, -load * theta.cos(), theta.cos(), theta.sin()];
    let h = 1.0 / STEPS as f64;
    let moved = |state: [f64; 4], rate: [f64; 4], by: f64| std::array::from_fn(|i| state[i] + by * rate[i]);
    let mut state = [angle, 0.0, 0.0, 0.0];
    for _ in 0..STEPS {
        let first = rate(state);
        let second = rate(moved(state, first, 0.5 * h));
        let third = rate(moved(state, second, 0.5 * h));
        let fourth = rate(moved(state, third, h));
        state = std::array::from_fn(|i| state[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
    }
    state
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_tip_is_that_of_the_tables() {
        // Bisshopp & Drucker 1945, Mattiasson 1981: P L2/EI = 1 and 10
        for (load, [shortened, deflected]) in [(1.0, [0.05643, 0.30172]), (10.0, [0.55500, 0.81061])] {
            let [x, y] = super::tip(load);
            assert!((1.0 - x - shortened).abs() < 6e-6 && (y - deflected).abs() < 6e-6, "{x} {y}");
        }
    }
}
