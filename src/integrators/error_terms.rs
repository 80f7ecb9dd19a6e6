//! The leading error terms of tables without an embedded solution.

use super::{Carried, Combination, Stage, Table};

/// Steps until what older vectors lack has died out.
const STEPS: usize = 60;

impl Table {
    /// Factors C of the leading errors of one step, C h^(p+1) d^(p+1)/dt^(p+1) of coordinates and of velocities, p the order: those of steps
    /// of length 1 for the acceleration t^(p-1)/(p-1)! and t^p/p!, which are given at the stages. Where that says nothing, of a rule that is
    /// exact for these, those of the trapezoidal rule.
    pub(super) fn error_factors(&self) -> [f64; 2] {
        if self.is_static() || self.embedded.is_some() {
            return [0.0; 2];
        }
        // a variational integrator of an order takes the mean velocities of steps where others have velocities: both have the rule's error
        let found = |order: i32, power: i32| if self.variational.is_some() { 0.0 } else { self.error_factor(order, power) };
        let power = self.order as i32 - 1;
        [(0, power), (1, power + 1)].map(|(order, power)| {
            let factor = found(order, power).abs();
            let trapezoidal = if self.order == 1 { 0.5 } else { 1.0 / 12.0 };
            if factor > 1e-6 && factor.is_finite() { factor } else { trapezoidal }
        })
    }

    /// Error that each step of length 1 adds to coordinates (`order` 0) beside that of velocities, or to velocities (1), for the acceleration
    /// t^power / power!.
    fn error_factor(&self, order: i32, power: i32) -> f64 {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        // about the middle of all steps, so that numbers stay small
        let at = |t: f64, derivative: i32| {
            let power = power + 2 - derivative;
            (t - STEPS as f64).powi(power) / factorial(power)
        };
        let mut ages = [0.0; 3];
        let mut carried: Vec<f64> = self
            .carried
            .iter()
            .map(|kind| {
                let age = &mut ages[kind.order() as usize];
                // accelerations are all that of now
                let t = if *kind == Carried::A { 0.0 } else { -*age };
                *age += 1.0;
                at(t, kind.order())
            })
            .collect();
        let mut errors = Vec::with_capacity(STEPS + 1);
        errors.push([0.0; 2]);
        for step in 0..STEPS {
            let t = step as f64;
            // a_i = sum U_a Y + sum A_a x_j is what is given
            self.scalar_step(1.0, &mut carried, |index, sum| {
                let Stage { a, c, .. } = &self.stages[index];
                (at(t + c, 2) - sum(2, a)) / a.stages[index]
            });
            errors.push([carried[0] - at(t + 1.0, 0), carried[1] - at(t + 1.0, 1)]);
        }
        let added = |which: usize| (errors[STEPS][which] - errors[STEPS - 2][which]) / 2.0;
        match order {
            0 => added(0) - 0.5 * (errors[STEPS][1] + errors[STEPS - 2][1]),
            _ => added(1),
        }
    }

    /// Whether accelerations at the last stage, and with them reactions there, converge where constraints are kept on coordinates: whether a
    /// coordinate that is t^2/2 at all stages has the acceleration 1 once its start is forgotten. Several stages of order 1 make other ones of
    /// it, in steps of any size: only their mean is right (Hairer, Lubich & Roche, The numerical solution of differential-algebraic systems by
    /// Runge-Kutta methods (1989)).
    pub fn reactions_converge(&self) -> bool {
        if self.is_static() || self.variational.is_some() {
            return true;
        }
        let motion = |t: f64, derivative: i32| [0.5 * t * t, t, 1.0][derivative as usize];
        let mut ages = [0.0; 3];
        let at_start = |kind: &Carried| {
            let age = &mut ages[kind.order() as usize];
            *age += 1.0;
            motion(1.0 - *age, kind.order())
        };
        let mut carried: Vec<f64> = self.carried.iter().map(at_start).collect();
        let last = (0..STEPS).fold(0.0, |_, step| {
            let x = self.scalar_step(1.0, &mut carried, |index, sum| {
                let stage = &self.stages[index];
                (motion(step as f64 + stage.c, 0) - sum(0, &stage.q)) / stage.q.stages[index]
            });
            x.last().copied().unwrap_or(0.0)
        });
        (last - 1.0).abs() < 1e-6
    }

    /// Makes one step of size `h` of a single coordinate, whose unknowns x follow from the sums of carried vectors and earlier ones; returns these.
    pub(super) fn scalar_step(
        &self,
        h: f64,
        carried: &mut Vec<f64>,
        unknown: impl Fn(usize, &dyn Fn(i32, &Combination) -> f64) -> f64,
    ) -> Vec<f64> {
        let sum = |order: i32, combination: &Combination, carried: &[f64], x: &[f64]| {
            let old = combination.carried.iter().zip(carried).zip(&self.carried);
            let old = old.map(|((c, y), kind)| c * y * h.powi(kind.order() - order)).sum::<f64>();
            old + combination.stages.iter().zip(x).map(|(c, x)| c * x * h.powi(2 - order)).sum::<f64>()
        };
        let mut x = Vec::with_capacity(self.stages.len());
        for (index, stage) in self.stages.iter().enumerate() {
            let own = stage.known.map(|place| carried[place]);
            x.push(own.unwrap_or_else(|| unknown(index, &|order, combination| sum(order, combination, carried, &x))));
        }
        let update = self.update.iter().zip(&self.carried);
        *carried = update.map(|(update, kind)| sum(kind.order(), update, carried, &x)).collect();
        x
    }
}

#[cfg(test)]
mod tests {
    use crate::integrators::{table_by_name, tables};

    /// The orders of multipliers that study `orders` measures at position level: 0 of those whose stages have order 1.
    #[test]
    fn reactions_of_stages_of_order_one_do_not_converge() {
        for table in tables().into_iter().filter(|table| table.radius_at_infinity < 1.0) {
            let has_rough_stages = ["dirk2", "dirk3", "sdirk2", "sdirk3", "sdirk4"].contains(&&table.name[..]);
            assert_eq!(table.reactions_converge(), !has_rough_stages, "{}", table.name);
        }
    }

    /// C of the rules' own textbooks: implicit Euler 1/2, backward differences of order 2 2/9 and of order 3 3/22 by the step of velocities
    /// that they divide by (2/3 and 6/11), the midpoint rule 1/24 and the trapezoidal rule 1/12 of velocities.
    #[test]
    fn factors_are_those_of_the_rules() {
        for (name, exact) in
            [("bdf1", 0.5), ("bdf2", 1.0 / 3.0), ("bdf3", 0.25), ("midpoint", 1.0 / 24.0), ("newmark", 1.0 / 12.0)]
        {
            let [q, v] = table_by_name(name).expect("listed").error_factors();
            assert!((v - exact).abs() < 1e-6, "{name}: {v} for {exact}");
            assert!(q > 0.0 && q < 2.0, "{name}: {q}");
        }
        for name in ["dirk2", "dirk3", "sdirk2", "sdirk3", "generalized-alpha", "variational"] {
            let factors = table_by_name(name).expect("listed").error_factors();
            assert!(factors.iter().all(|factor| (1e-6..2.0).contains(factor)), "{name}: {factors:?}");
        }
    }
}
