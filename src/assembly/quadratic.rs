use super::reduction::RotationCoordinates;
use super::{Level, Rates};
use crate::elements::{ConstraintPhysics, State};
use crate::program::Node;
use crate::scalar::Scalar;

/// A constraint inside a node in closed form: g_k = c_k + b_k . q + q . H_k q / 2.
///
/// The unit length of Euler parameters is one; so are the right angles of natural coordinates. Their rows A = b + H q and all time
/// derivatives cost a few multiplications, in every scalar. The coefficients are derivatives of the constraint itself, taken once.
pub(super) struct Quadratic {
    constant: Vec<f64>,
    /// (equation, coordinate, b).
    linear: Vec<(usize, usize, f64)>,
    /// (equation, row, column, H).
    second: Vec<(usize, usize, usize, f64)>,
    unit_length: Option<UnitLength>,
    turning: Option<RotationCoordinates>,
}

/// The one equation (x . x) h / 2 + c = 0 of four coordinates in a row: Euler parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnitLength {
    /// The first of them.
    pub first: usize,
    /// h.
    pub second: f64,
    /// c.
    pub constant: f64,
}

impl Quadratic {
    /// Coefficients of a constraint without parameters.
    ///
    /// # Panics
    /// If it is not quadratic: a mistake in the list of node kinds.
    pub fn of(physics: &ConstraintPhysics) -> Self {
        let (n, count) = (physics.dof_count(), physics.equation_count());
        // derivatives with respect to the coordinates alone, whatever they are: constants
        let (constants, gradients, second) = physics.formula().inspect(|graph, outputs| {
            let q: Vec<Node> = (0..n).map(|dof| graph.input(n + dof)).collect();
            let (zero, one) = (graph.zero(), graph.constant(1.0));
            let at_origin: Vec<(Node, Node)> = q.iter().map(|&q| (q, zero)).collect();
            let constants = graph.substitute(outputs, &at_origin);
            let (mut gradients, mut second) = (Vec::new(), Vec::new());
            for &output in outputs {
                let gradient = graph.reverse(&[output], &[one], &q);
                for &entry in &gradient {
                    second.extend(graph.reverse(&[entry], &[one], &q));
                }
                gradients.extend(graph.substitute(&gradient, &at_origin));
            }
            [constants, gradients, second]
                .map(|nodes| {
                    let value = |node: &Node| graph.constant_of(*node);
                    nodes
                        .iter()
                        .map(|node| value(node).expect("constraints inside nodes are quadratic"))
                        .collect::<Vec<f64>>()
                })
                .into()
        });
        let places = |index: usize| (index / (n * n), index / n % n, index % n);
        let nonzero = |(_, value): &(usize, &f64)| **value != 0.0;
        let linear = gradients.iter().enumerate().filter(nonzero).map(|(place, &b)| (place / n, place % n, b)).collect();
        let entry = |(index, &h): (usize, &f64)| (places(index).0, places(index).1, places(index).2, h);
        let second = second.iter().enumerate().filter(nonzero).map(entry).collect();
        debug_assert_eq!(gradients.len(), count * n);
        let mut quadratic = Quadratic { constant: constants, linear, second, unit_length: None, turning: None };
        let probe: Vec<f64> = (0..n).map(|i| 0.3 + 0.7 * (i as f64 * 1.7).sin()).collect();
        quadratic.unit_length = quadratic.as_unit_length();
        quadratic.turning = [RotationCoordinates::Euler, RotationCoordinates::Axes]
            .into_iter()
            .find(|turning| quadratic.is_free_in(*turning, &probe));
        quadratic
    }

    /// Whether all directions at right angles to the rows are turns.
    fn is_free_in(&self, turning: RotationCoordinates, probe: &[f64]) -> bool {
        let (n, count) = (probe.len(), self.constant.len());
        if n < turning.coordinates() || n - count != n - turning.coordinates() + 3 || !self.linear.is_empty() {
            return false;
        }
        let (free, mut rows) = (n - turning.coordinates(), vec![0.0; count * n]);
        let mut scaled = probe[free..].to_vec();
        turning.scale(&mut scaled);
        self.rows(probe, &mut rows);
        // of a row and a turn about an axis
        let product = |row: &[f64], axis: usize| -> f64 {
            let moved = |(coordinate, weight): (usize, &f64)| weight * turning.value(coordinate, axis, &scaled);
            row[free..].iter().enumerate().map(moved).sum()
        };
        let is_free =
            |row: &[f64]| row[..free].iter().all(|&x| x == 0.0) && (0..3).all(|axis| product(row, axis).abs() < 1e-13);
        rows.chunks_exact(n).all(is_free)
    }

    /// The coordinates that turn, if its rows leave them nothing else.
    pub fn turning(&self) -> Option<RotationCoordinates> {
        self.turning
    }

    fn as_unit_length(&self) -> Option<UnitLength> {
        let &[(_, first, _, h), ..] = &self.second[..] else { return None };
        let expected = (first..first + 4).map(|dof| (0, dof, dof, h));
        let own = self.constant.len() == 1 && self.linear.is_empty() && expected.eq(self.second.iter().copied());
        own.then_some(UnitLength { first, second: h, constant: self.constant[0] })
    }

    /// The equation in short, if it is one of unit length.
    pub fn unit_length(&self) -> Option<UnitLength> {
        self.unit_length
    }

    /// Writes rows A (equations by coordinates, row-major).
    pub fn rows<S: Scalar>(&self, q: &[S], rows: &mut [S]) {
        rows.fill(S::zero());
        for &(equation, dof, b) in &self.linear {
            rows[equation * q.len() + dof] += S::from(b);
        }
        for &(equation, row, column, h) in &self.second {
            rows[equation * q.len() + row] += q[column] * h;
        }
    }

    /// Writes rows A with their derivatives along the motion.
    pub fn moving_rows(&self, s: State<f64>, rows: &mut [Rates<f64>]) {
        let n = s.q.len();
        rows.fill(Rates::zero());
        for &(equation, dof, b) in &self.linear {
            rows[equation * n + dof].value += b;
        }
        for &(equation, row, column, h) in &self.second {
            let entry = &mut rows[equation * n + row];
            entry.value += h * s.q[column];
            entry.first += h * s.v[column];
            entry.second += h * s.a[column];
        }
    }

    /// Adds a weighted sum of one row A and of its derivatives along the motion, each with the vector (q, v or a) that it is linear in.
    pub fn add_row<S: Scalar>(&self, equation: usize, weighted: [(f64, &[S]); 3], row: &mut [S]) {
        for &(_, dof, b) in self.linear.iter().filter(|(own, ..)| *own == equation) {
            row[dof] += S::from(b * weighted[0].0);
        }
        for &(_, i, j, h) in self.second.iter().filter(|(own, ..)| *own == equation) {
            for (weight, vector) in weighted {
                row[i] += vector[j] * (h * weight);
            }
        }
    }

    /// The entries of H that are not zero: (equation, row, column, H).
    pub fn second_derivatives(&self) -> impl Iterator<Item = (usize, usize, usize, f64)> + '_ {
        self.second.iter().copied()
    }

    /// target += factor (sum_k multiplier_k H_k) direction: the derivative of the reaction along a direction.
    pub fn add_curvature(&self, multipliers: &[f64], direction: &[f64], factor: f64, target: &mut [f64]) {
        for &(equation, row, column, h) in &self.second {
            target[row] += factor * multipliers[equation] * h * direction[column];
        }
    }

    /// Sum of the terms of all equations at a level, without their signs: round-off is a share of it. Zero at two levels at once.
    pub fn size_of_terms<S: Scalar>(&self, level: Level, s: State<S>) -> f64 {
        let size = |x: S| x.value().abs();
        let of = |x: &[S]| self.linear.iter().fold(0.0, |sum, &(_, dof, b)| sum + size(x[dof]) * b.abs());
        let product =
            |x: &[S], y: &[S]| self.second.iter().fold(0.0, |sum, &(_, i, j, h)| sum + size(x[i]) * size(y[j]) * h.abs());
        match level {
            Level::Position => {
                let constants = self.constant.iter().fold(0.0, |sum: f64, constant| sum + constant.abs());
                constants + of(s.q) + 0.5 * product(s.q, s.q)
            }
            Level::Velocity => of(s.v) + product(s.q, s.v),
            Level::Acceleration => of(s.a) + product(s.q, s.a) + product(s.v, s.v),
            Level::Stabilized => 0.0,
        }
    }

    /// Writes g with its first and second derivative along the motion.
    pub fn derivatives<S: Scalar>(&self, s: State<S>, g: &mut [Rates<S>]) {
        for (g, &constant) in g.iter_mut().zip(&self.constant) {
            *g = Rates { value: S::from(constant), ..Rates::zero() };
        }
        for &(equation, dof, b) in &self.linear {
            let g = &mut g[equation];
            g.value += s.q[dof] * b;
            g.first += s.v[dof] * b;
            g.second += s.a[dof] * b;
        }
        for &(equation, i, j, h) in &self.second {
            let g = &mut g[equation];
            g.value += s.q[i] * s.q[j] * (0.5 * h);
            g.first += s.q[i] * s.v[j] * h;
            g.second += (s.q[i] * s.a[j] + s.v[i] * s.v[j]) * h;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::bodies::{EulerParameterNorm, OrthonormalAxes};
    use crate::elements::{Constraint, NodeKind};

    #[test]
    fn closed_form_equals_the_constraint_with_its_rows_and_rates() {
        let all: [Box<dyn crate::elements::AnyConstraint>; 2] = [Box::new(EulerParameterNorm), Box::new(OrthonormalAxes)];
        for physics in all.map(ConstraintPhysics::new) {
            let (n, count) = (physics.dof_count(), physics.equation_count());
            let own = Quadratic::of(&physics);
            let numbers = |phase: f64| (0..n).map(|i| (i as f64 + phase).sin()).collect::<Vec<f64>>();
            let (q, v, a) = (numbers(0.1), numbers(1.3), numbers(2.6));
            let state = State { a: &a, v: &v, q: &q };
            let mut g = vec![Rates::zero(); count];
            own.derivatives(state, &mut g);
            for (own, expected) in g.iter().zip(physics.motion(state, &[], 0.0)) {
                let own = [own.value, own.first, own.second];
                assert!(
                    own.iter().zip(expected).all(|(own, expected)| (own - expected).abs() < 1e-14),
                    "{own:?} {expected:?}"
                );
            }
            let mut rows = vec![0.0; count * n];
            own.rows(&q, &mut rows);
            let expected = physics.rows(&q, &[], 0.0);
            assert!(rows.iter().zip(&expected).all(|(own, expected)| (own - expected).abs() < 1e-14));
            assert!(own.turning().is_some());
        }
        let unit = Quadratic::of(&ConstraintPhysics::new(Box::new(EulerParameterNorm))).unit_length();
        assert_eq!(unit.map(|unit| unit.first), Some(3));
    }

    #[test]
    #[should_panic(expected = "quadratic")]
    fn other_constraints_are_refused() {
        struct Cubic;
        impl Constraint for Cubic {
            const EQUATIONS: usize = 1;
            fn nodes(&self) -> Vec<NodeKind> {
                vec![NodeKind::Coordinates(1)]
            }
            fn g<S: Scalar>(&self, q: &[S], _p: &[S], _t: S, g: &mut [S]) {
                g[0] = q[0] * q[0] * q[0];
            }
        }
        Quadratic::of(&ConstraintPhysics::new(Box::new(Cubic)));
    }
}
