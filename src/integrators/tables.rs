//! The listed integrators. A new one is a function here and a line in [`tables`].

use super::{Butcher, Table};

/// Name of the table used when none is given: full order under constraints and with stiff members.
pub const DEFAULT_TABLE: &str = "esdirk3";

/// All integrators.
pub fn tables() -> Vec<Table> {
    [midpoint(), dirk2(), dirk3(), sdirk2(), sdirk3(), sdirk4(), esdirk3()].into_iter().map(Butcher::into_table).collect()
}

/// The integrator with a given name.
pub fn table_by_name(name: &str) -> Option<Table> {
    tables().into_iter().find(|table| table.name == name)
}

/// Implicit midpoint rule: order 2, A-stable, symplectic.
fn midpoint() -> Butcher {
    Butcher { name: "midpoint", order: 2, a: vec![vec![0.5]], b: vec![1.0] }
}

/// Two stages, order 3, A-stable (Crouzeix 1975; Boopathy & Kennedy, table of DIRK coefficients).
fn dirk2() -> Butcher {
    let gamma = (3.0 + f64::sqrt(3.0)) / 6.0;
    Butcher { name: "dirk2", order: 3, a: vec![vec![gamma], vec![1.0 - 2.0 * gamma, gamma]], b: vec![0.5, 0.5] }
}

/// Three stages, order 4, A-stable (Crouzeix 1975, Alexander 1977; Boopathy & Kennedy).
fn dirk3() -> Butcher {
    let alpha = 2.0 * f64::cos(std::f64::consts::PI / 18.0) / f64::sqrt(3.0);
    let diagonal = (1.0 + alpha) / 2.0;
    let outer = 1.0 / (6.0 * alpha * alpha);
    Butcher {
        name: "dirk3",
        order: 4,
        a: vec![vec![diagonal], vec![-alpha / 2.0, diagonal], vec![1.0 + alpha, -(1.0 + 2.0 * alpha), diagonal]],
        b: vec![outer, 1.0 - 2.0 * outer, outer],
    }
}

/// Two stages, order 2, L-stable and stiffly accurate (Alexander 1977).
fn sdirk2() -> Butcher {
    let gamma = 1.0 - f64::sqrt(0.5);
    Butcher { name: "sdirk2", order: 2, a: vec![vec![gamma], vec![1.0 - gamma, gamma]], b: vec![1.0 - gamma, gamma] }
}

/// Root near 0.436 of g^3 - 3 g^2 + 3/2 g - 1/6 = 0: the diagonal of L-stable methods of order 3.
fn l_stable_diagonal() -> f64 {
    let mut gamma: f64 = 0.4358665215;
    for _ in 0..4 {
        let value = ((gamma - 3.0) * gamma + 1.5) * gamma - 1.0 / 6.0;
        gamma -= value / ((3.0 * gamma - 6.0) * gamma + 1.5);
    }
    gamma
}

/// Three stages, order 3, L-stable and stiffly accurate (Alexander 1977).
fn sdirk3() -> Butcher {
    let gamma = l_stable_diagonal();
    let first = -(6.0 * gamma * gamma - 16.0 * gamma + 1.0) / 4.0;
    let second = (6.0 * gamma * gamma - 20.0 * gamma + 5.0) / 4.0;
    let b = vec![first, second, gamma];
    Butcher { name: "sdirk3", order: 3, a: vec![vec![gamma], vec![(1.0 - gamma) / 2.0, gamma], b.clone()], b }
}

/// Five stages, order 4, L-stable and stiffly accurate (Hairer & Wanner, Solving ODEs II, table IV.6.5).
fn sdirk4() -> Butcher {
    let d = 0.25;
    let b = vec![25.0 / 24.0, -49.0 / 48.0, 125.0 / 16.0, -85.0 / 12.0, d];
    let a = vec![
        vec![d],
        vec![0.5, d],
        vec![17.0 / 50.0, -1.0 / 25.0, d],
        vec![371.0 / 1360.0, -137.0 / 2720.0, 15.0 / 544.0, d],
        b.clone(),
    ];
    Butcher { name: "sdirk4", order: 4, a, b }
}

/// Explicit first stage and three implicit ones, order 3, stage order 2, L-stable and stiffly accurate: the tableau of
/// Kennedy & Carpenter (2003), ARK3(2)4L[2]SA, computed from its defining conditions with c = (0, 2 gamma, 3/5, 1).
fn esdirk3() -> Butcher {
    let gamma = l_stable_diagonal();
    let (c2, c3) = (2.0 * gamma, 0.6);
    // stage order 2: sum a_3j c_j = c_3^2 / 2
    let a32 = (c3 * c3 / 2.0 - gamma * c3) / c2;
    // sum b c = 1/2 and sum b c^2 = 1/3 with b_4 = gamma
    let (first, second) = (0.5 - gamma, 1.0 / 3.0 - gamma);
    let b3 = (second - c2 * first) / (c3 * (c3 - c2));
    let b2 = (first - b3 * c3) / c2;
    let b = vec![1.0 - b2 - b3 - gamma, b2, b3, gamma];
    Butcher {
        name: "esdirk3",
        order: 3,
        a: vec![vec![0.0], vec![gamma, gamma], vec![c3 - a32 - gamma, a32, gamma], b.clone()],
        b,
    }
}
