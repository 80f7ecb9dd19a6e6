//! Implicit Runge-Kutta methods whose first stage is solved for like all others.

use crate::integrators::Butcher;

/// Implicit midpoint rule: order 2, A-stable, symplectic.
pub fn midpoint() -> Butcher {
    Butcher { name: "midpoint".into(), order: 2, a: vec![vec![0.5]], b: vec![1.0], ..Butcher::default() }
}

/// Two stages, order 3, A-stable (Crouzeix 1975; Boopathy & Kennedy, table of DIRK coefficients).
pub fn dirk2() -> Butcher {
    let gamma = (3.0 + f64::sqrt(3.0)) / 6.0;
    let a = vec![vec![gamma], vec![1.0 - 2.0 * gamma, gamma]];
    Butcher { name: "dirk2".into(), order: 3, a, b: vec![0.5, 0.5], ..Butcher::default() }
}

/// Three stages, order 4, A-stable (Crouzeix 1975, Alexander 1977; Boopathy & Kennedy).
pub fn dirk3() -> Butcher {
    let alpha = 2.0 * f64::cos(std::f64::consts::PI / 18.0) / f64::sqrt(3.0);
    let diagonal = (1.0 + alpha) / 2.0;
    let outer = 1.0 / (6.0 * alpha * alpha);
    Butcher {
        name: "dirk3".into(),
        order: 4,
        a: vec![vec![diagonal], vec![-alpha / 2.0, diagonal], vec![1.0 + alpha, -(1.0 + 2.0 * alpha), diagonal]],
        b: vec![outer, 1.0 - 2.0 * outer, outer],
        ..Butcher::default()
    }
}

/// Two stages, order 2, L-stable and stiffly accurate (Alexander 1977).
pub fn sdirk2() -> Butcher {
    let gamma = 1.0 - f64::sqrt(0.5);
    let b = vec![1.0 - gamma, gamma];
    Butcher { name: "sdirk2".into(), order: 2, l_stable: true, a: vec![vec![gamma], b.clone()], b, ..Butcher::default() }
}

/// Root near 0.436 of g^3 - 3 g^2 + 3/2 g - 1/6 = 0: the diagonal of L-stable methods of order 3.
pub fn l_stable_diagonal() -> f64 {
    let mut gamma: f64 = 0.4358665215;
    for _ in 0..4 {
        let value = ((gamma - 3.0) * gamma + 1.5) * gamma - 1.0 / 6.0;
        gamma -= value / ((3.0 * gamma - 6.0) * gamma + 1.5);
    }
    gamma
}

/// Three stages, order 3, L-stable and stiffly accurate (Alexander 1977).
pub fn sdirk3() -> Butcher {
    let gamma = l_stable_diagonal();
    let first = -(6.0 * gamma * gamma - 16.0 * gamma + 1.0) / 4.0;
    let second = (6.0 * gamma * gamma - 20.0 * gamma + 5.0) / 4.0;
    let b = vec![first, second, gamma];
    let a = vec![vec![gamma], vec![(1.0 - gamma) / 2.0, gamma], b.clone()];
    Butcher { name: "sdirk3".into(), order: 3, l_stable: true, a, b, ..Butcher::default() }
}

/// Five stages, order 4, L-stable and stiffly accurate, with an embedded solution of order 3 (Hairer & Wanner, Solving
/// ODEs II, table IV.6.5).
pub fn sdirk4() -> Butcher {
    let d = 0.25;
    let b = vec![25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0, d];
    let a = vec![
        vec![d],
        vec![0.5, d],
        vec![17.0 / 50.0, -1.0 / 25.0, d],
        vec![371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0, d],
        b.clone(),
    ];
    let embedded = Some((3, vec![59.0 / 48.0, -17.0 / 96.0, 225.0 / 32.0, -85.0 / 12.0, 0.0]));
    Butcher { name: "sdirk4".into(), order: 4, l_stable: true, a, b, embedded, ..Butcher::default() }
}
