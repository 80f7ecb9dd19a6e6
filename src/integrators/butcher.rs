use super::implicit_weights::implicit_weights;
use super::positive_weights::positive_weights;
use super::{Carried, Combination, Embedded, Stage, Table};
use crate::tolerances::ROUND_OFF;

/// A Runge-Kutta tableau with a lower-triangular matrix, and what it claims of itself.
#[derive(Clone, Debug, Default)]
pub struct Butcher {
    /// Name on the command line.
    pub name: String,
    /// Claimed order, at most 5.
    pub order: usize,
    /// Claimed order of the stages, at most 2.
    pub stage_order: usize,
    /// Claims R(infinity) = 0.
    pub l_stable: bool,
    /// Rows of the matrix up to the diagonal.
    pub a: Vec<Vec<f64>>,
    /// Weights.
    pub b: Vec<f64>,
    /// Order and weights of an embedded solution.
    pub embedded: Option<(usize, Vec<f64>)>,
}

impl Butcher {
    fn stages(&self) -> usize {
        self.b.len()
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.a[i].get(j).copied().unwrap_or(0.0)
    }

    /// Nodes: the row sums.
    fn nodes(&self) -> Vec<f64> {
        self.a.iter().map(|row| row.iter().sum()).collect()
    }

    /// A x.
    fn product(&self, x: &[f64]) -> Vec<f64> {
        self.a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
    }

    /// Largest violation by weights `b` of the conditions for `order` (at most 5, all 17 trees), with its name.
    pub fn order_defect(&self, b: &[f64], order: usize) -> (f64, &'static str) {
        let times = |x: &[f64], y: &[f64]| -> Vec<f64> { x.iter().zip(y).map(|(x, y)| x * y).collect() };
        let one = vec![1.0; self.stages()];
        let c = self.nodes();
        let (c2, ac) = (times(&c, &c), self.product(&c));
        let (c3, c_ac, ac2, aac) = (times(&c2, &c), times(&c, &ac), self.product(&c2), self.product(&ac));
        let conditions = [
            (1, "sum b = 1", 1.0, one),
            (3, "sum b c^2 = 1/3", 3.0, c2.clone()),
            (3, "sum b A c = 1/6", 6.0, ac.clone()),
            (4, "sum b c^3 = 1/4", 4.0, c3.clone()),
            (4, "sum b c A c = 1/8", 8.0, c_ac.clone()),
            (4, "sum b A c^2 = 1/12", 12.0, ac2.clone()),
            (4, "sum b A A c = 1/24", 24.0, aac.clone()),
            (5, "sum b c^4 = 1/5", 5.0, times(&c2, &c2)),
            (5, "sum b c^2 A c = 1/10", 10.0, times(&c2, &ac)),
            (5, "sum b (A c)^2 = 1/20", 20.0, times(&ac, &ac)),
            (5, "sum b c A c^2 = 1/15", 15.0, times(&c, &ac2)),
            (5, "sum b A c^3 = 1/20", 20.0, self.product(&c3)),
            (5, "sum b c A A c = 1/30", 30.0, times(&c, &aac)),
            (5, "sum b A (c A c) = 1/40", 40.0, self.product(&c_ac)),
            (5, "sum b A A c^2 = 1/60", 60.0, self.product(&ac2)),
            (5, "sum b A A A c = 1/120", 120.0, self.product(&aac)),
            (2, "sum b c = 1/2", 2.0, c),
        ];
        let defect = |elementary: &[f64], density: f64| {
            let terms = times(b, elementary);
            let size = terms.iter().fold(1.0, |size: f64, term| size.max(term.abs()));
            (terms.iter().sum::<f64>() - 1.0 / density).abs() / size
        };
        let claimed = conditions.iter().filter(|condition| condition.0 <= order);
        let defects = claimed.map(|(_, name, density, elementary)| (defect(elementary, *density), *name));
        defects.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, ""))
    }

    /// Largest violation of sum a_ij c_j = c_i^2 / 2 over the stages.
    pub fn second_stage_order_defect(&self) -> f64 {
        let c = self.nodes();
        self.product(&c).iter().zip(&c).fold(0.0, |worst: f64, (ac, c)| worst.max((ac - c * c / 2.0).abs()))
    }

    /// Stability function at infinity, where stages balance: A Y = 0 in all rows that are solved for.
    ///
    /// With an explicit first stage (Y_1 = 1) the last stage must be the new state.
    pub fn stability_at_infinity(&self) -> f64 {
        let first = usize::from(self.a[0][0] == 0.0);
        // explicit first stage: the stages' values; otherwise their slopes, scaled: A k = -1, R = 1 + b k
        let mut solution = vec![1.0; first];
        for i in first..self.stages() {
            let known: f64 = (0..i).map(|j| self.entry(i, j) * solution[j]).sum();
            let demanded = if first == 1 { 0.0 } else { -1.0 };
            solution.push((demanded - known) / self.entry(i, i));
        }
        if first == 1 {
            solution[self.stages() - 1]
        } else {
            1.0 + self.b.iter().zip(&solution).map(|(b, k)| b * k).sum::<f64>()
        }
    }

    /// Makes sure that the tableau is what it claims to be.
    ///
    /// # Panics
    /// With the violated claim: a mistake in the coefficients.
    fn check(&self) {
        let (name, s) = (&self.name, self.stages());
        assert!(self.a.len() == s && self.a.iter().zip(1..).all(|(row, n)| row.len() == n), "{name}: shape");
        let (defect, condition) = self.order_defect(&self.b, self.order);
        assert!(defect < ROUND_OFF, "{name}: order {} needs {condition}, missed by {defect:e}", self.order);
        let stiffly_accurate = self.a[s - 1] == self.b;
        assert!(
            self.a[0][0] != 0.0 || stiffly_accurate,
            "{name}: with an explicit first stage the last one is the new state"
        );
        if self.stage_order >= 2 {
            let defect = self.second_stage_order_defect();
            assert!(defect < ROUND_OFF, "{name}: stage order 2 is missed by {defect:e}");
        }
        if self.l_stable {
            let rest = self.stability_at_infinity();
            assert!(stiffly_accurate && rest.abs() < 10.0 * ROUND_OFF, "{name}: R(infinity) = {rest:e}");
        }
        if let Some((order, weights)) = &self.embedded {
            let (defect, condition) = self.order_defect(weights, *order);
            assert!(
                *order < self.order && defect < ROUND_OFF,
                "{name}: embedded order {order} needs {condition}, missed by {defect:e}"
            );
        }
    }

    /// The table for second-order systems: the tableau applied to (q, v)' = (v, a).
    ///
    /// # Panics
    /// If the tableau is not what it claims to be: a mistake in the coefficients.
    pub fn into_table(self) -> Table {
        self.check();
        let s = self.stages();
        let c = self.nodes();
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
        // weights A: a first-order sum of velocities in terms of accelerations
        let square = |weights: &[f64]| -> Vec<f64> {
            (0..s).map(|j| weights.iter().enumerate().map(|(k, weight)| weight * self.entry(k, j)).sum()).collect()
        };
        let stages = (0..s)
            .map(|i| {
                let known = (i == 0 && explicit_first).then_some(2);
                let unit = (0..s).map(|j| f64::from(u8::from(i == j && known.is_none()))).collect();
                let mut a = combine(&[], unit);
                if let Some(place) = known {
                    a.carried[place] = 1.0;
                }
                let v = combine(&[0.0, 1.0], (0..s).map(|j| self.entry(i, j)).collect());
                let q = combine(&[1.0, c[i]], square(&self.a[i]));
                Stage { c: c[i], a, v, q, known }
            })
            .collect();
        let mut update = vec![combine(&[1.0, 1.0], square(&self.b)), combine(&[0.0, 1.0], self.b.clone())];
        if explicit_first {
            update.push(combine(&[], (0..s).map(|j| f64::from(u8::from(j == s - 1))).collect()));
        }
        let solution = |order: usize, weights: &[f64], implicit: Option<Box<Embedded>>| {
            let difference: Vec<f64> = self.b.iter().zip(weights).map(|(b, weight)| b - weight).collect();
            let q = combine(&[], square(&difference));
            Embedded { order, q, v: combine(&[], difference), implicit }
        };
        let embedded = self.embedded.as_ref().map(|(order, weights)| {
            let implicit = explicit_first.then(|| solution(*order, &implicit_weights(&self.a, &self.b, &c), None));
            solution(*order, weights, implicit.map(Box::new))
        });
        let stiffly_accurate = self.a[s - 1] == self.b;
        let radius_at_infinity = self.stability_at_infinity().abs();
        Table {
            name: self.name,
            order: self.order,
            carried,
            stages,
            update,
            aggregate_weights: positive_weights(&self.b, &c, self.order),
            quadrature: Combination { carried: vec![1.0], stages: self.b },
            stiffly_accurate,
            radius_at_infinity,
            embedded,
            ..Table::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Butcher;

    /// Order 5, 17 conditions: the explicit tableau of Butcher (1964) has them all, and none survives a changed coefficient.
    #[test]
    fn every_coefficient_is_held_by_an_order_condition() {
        let a: [&[f64]; 6] = [
            &[0.0],
            &[1.0 / 4.0, 0.0],
            &[1.0 / 8.0, 1.0 / 8.0, 0.0],
            &[0.0, -1.0 / 2.0, 1.0, 0.0],
            &[3.0 / 16.0, 0.0, 0.0, 9.0 / 16.0, 0.0],
            &[-3.0 / 7.0, 2.0 / 7.0, 12.0 / 7.0, -12.0 / 7.0, 8.0 / 7.0, 0.0],
        ];
        let b = [7.0, 0.0, 32.0, 12.0, 32.0, 7.0].map(|weight: f64| weight / 90.0);
        let right = Butcher { a: a.iter().map(|row| row.to_vec()).collect(), b: b.to_vec(), ..Butcher::default() };
        let defect = |tableau: &Butcher| tableau.order_defect(&tableau.b, 5).0;
        assert!(defect(&right) < 1e-15, "{:?}", right.order_defect(&right.b, 5));
        for i in 0..6 {
            let mut wrong = right.clone();
            wrong.b[i] += 1e-9;
            assert!(defect(&wrong) > 1e-12, "b[{i}]");
            for j in 0..i {
                let mut wrong = right.clone();
                // the row sum kept, where there is another coefficient: only conditions with A beyond c can see it
                wrong.a[i][j] += 1e-9;
                wrong.a[i][(j + 1) % i] -= if i > 1 { 1e-9 } else { 0.0 };
                // the second stage has no weight, and what enters it counts twice over
                assert!(defect(&wrong) > 1e-12, "a[{i}][{j}]: {:?}", wrong.order_defect(&wrong.b, 5));
            }
        }
    }

    #[test]
    fn stability_at_infinity_is_that_of_known_methods() {
        let implicit = |a: &[&[f64]], b: &[f64]| Butcher {
            a: a.iter().map(|row| row.to_vec()).collect(),
            b: b.to_vec(),
            ..Butcher::default()
        };
        assert_eq!(implicit(&[&[1.0]], &[1.0]).stability_at_infinity(), 0.0);
        assert_eq!(implicit(&[&[0.5]], &[1.0]).stability_at_infinity(), -1.0);
        assert_eq!(implicit(&[&[0.0], &[0.5, 0.5]], &[0.5, 0.5]).stability_at_infinity(), -1.0);
    }

    #[test]
    #[should_panic(expected = "embedded order 1 needs sum b = 1")]
    fn a_wrong_embedded_solution_is_refused() {
        let b = vec![0.5, 0.5];
        let a = vec![vec![0.0], b.clone()];
        let embedded = Some((1, vec![0.6, 0.5]));
        Butcher { name: "wrong".into(), order: 2, stage_order: 0, l_stable: false, a, b, embedded }.into_table();
    }
}
