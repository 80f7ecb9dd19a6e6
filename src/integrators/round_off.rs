use super::{Carried, Combination, ConstraintLevel, Table, TimeGrid};

/// How far velocities and accelerations of constrained directions may be off in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoundOff {
    /// Velocities at the ends of steps.
    pub velocity: f64,
    /// Accelerations at stages, and with them the multipliers.
    pub acceleration: f64,
}

impl Table {
    /// Largest changes in any step of a grid, when the constraint at every stage may be off by `rounding`: sums over all stages
    /// of that step and the ones before of |d v / d g| and |d a / d g|, times `rounding`.
    ///
    /// At position level a stage acceleration follows from A_q x = -U_q Y + rounding / h^2, a table that doesn't damp (|R(inf)| near 1) hands every rounding on to the end, and one that looks
    /// further back reads it again from each of its older vectors. At acceleration level the acceleration itself is rounded.
    pub fn round_off(&self, level: ConstraintLevel, grid: &TimeGrid, rounding: f64) -> RoundOff {
        if level == ConstraintLevel::Acceleration {
            return RoundOff { velocity: rounding, acceleration: rounding };
        }
        let mut velocities = vec![0.0; grid.steps()];
        let mut accelerations: Vec<Vec<f64>> =
            (0..grid.steps()).map(|step| vec![0.0; self.scheme(self.scheme_at(grid, step)).stages.len()]).collect();
        for first in 0..grid.steps() {
            for struck in 0..accelerations[first].len() {
                let mut carried = vec![0.0; self.carried.len()];
                for step in first..grid.steps() {
                    let table = self.scheme(self.scheme_at(grid, step));
                    let (t, end) = grid.span(step);
                    if grid.breakpoints.contains_key(&step) {
                        table.restart(&mut carried);
                    }
                    let x = table.constrained_step(end - t, &mut carried, (step == first).then_some(struck));
                    velocities[step] += carried[1].abs();
                    accelerations[step].iter_mut().zip(&x).for_each(|(sum, x)| *sum += x.abs());
                }
            }
        }
        let largest = |sums: &mut dyn Iterator<Item = f64>| sums.fold(0.0, f64::max) * rounding;
        let velocity = largest(&mut velocities.into_iter());
        RoundOff { velocity, acceleration: largest(&mut accelerations.into_iter().flatten()) }
    }

    /// Accelerations that are solved anew follow from coordinates and velocities, not from what was carried.
    fn restart(&self, carried: &mut [f64]) {
        let accelerations = carried.iter_mut().zip(&self.carried).filter(|(_, kind)| **kind == Carried::A);
        accelerations.for_each(|(value, _)| *value = 0.0);
    }

    /// One step of a coordinate that is held at 0, or at 1 at one stage; returns the stages' accelerations.
    fn constrained_step(&self, h: f64, carried: &mut Vec<f64>, at_one: Option<usize>) -> Vec<f64> {
        let sum = |order: i32, combination: &Combination, carried: &[f64], x: &[f64]| -> f64 {
            let old = combination.carried.iter().zip(carried).zip(&self.carried);
            let old = old.map(|((c, y), kind)| c * y * h.powi(kind.order() - order));
            old.chain(combination.stages.iter().zip(x).map(|(c, x)| c * x * h.powi(2 - order))).sum()
        };
        let mut x = Vec::with_capacity(self.stages.len());
        for (index, stage) in self.stages.iter().enumerate() {
            let aim = f64::from(u8::from(at_one == Some(index)));
            x.push(match stage.known {
                Some(place) => carried[place],
                None => (aim - sum(0, &stage.q, carried, &x)) / (stage.q.stages[index] * h.powi(2)),
            });
        }
        let update = self.update.iter().zip(&self.carried);
        *carried = update.map(|(update, kind)| sum(kind.order(), update, carried, &x)).collect();
        x
    }
}

#[cfg(test)]
mod tests {
    use crate::integrators::{ConstraintLevel, TimeGrid, table_by_name, tables};

    fn tenths(steps: usize) -> TimeGrid {
        TimeGrid::uniform(0.1 * steps as f64, steps, &[]).expect("steps")
    }

    #[test]
    fn midpoint_hands_every_rounding_on() {
        // q_i = q + h/2 v + h^2/4 x = d gives x = 4 d / h^2, afterwards -2 x, 2 x, -2 x, ... in turn
        let midpoint = table_by_name("midpoint").expect("listed");
        let sum = midpoint.round_off(ConstraintLevel::Position, &tenths(5), 1e-3).acceleration;
        let expected: f64 = {
            let (mut q, mut v, mut sum) = (0.0, 0.0, 0.0);
            for step in 0..5 {
                let x = (f64::from(u8::from(step == 0)) - q - v / 2.0) * 4.0;
                sum += f64::abs(x);
                (q, v) = (q + v + x / 2.0, v + x);
            }
            sum * 1e-3 / 0.01
        };
        assert!((sum - expected).abs() < 1e-12 * expected, "{sum} against {expected}");
        let longer = midpoint.round_off(ConstraintLevel::Position, &tenths(50), 1e-3).acceleration;
        assert!(longer > 5.0 * sum, "{longer} after ten times as many steps");
    }

    #[test]
    fn stiffly_accurate_tables_forget_it() {
        let table = table_by_name("sdirk4").expect("listed");
        let [short, long] = [5, 50].map(|n| table.round_off(ConstraintLevel::Position, &tenths(n), 0.01).acceleration);
        assert!((long - short).abs() < 1e-9 * short, "{short} {long}");
        // rows of |A^-2| of this tableau sum up to 2497; velocities hand on as much again, for two steps
        assert!((5435.0..5436.0).contains(&short), "{short}");
    }

    #[test]
    fn backward_differences_forget_it_in_as_many_steps_as_they_look_back() {
        // x = (g - 2 g_1 + g_2) / h^2 for order 1: 1, -2, 1 and nothing more
        let euler = table_by_name("bdf1").expect("listed");
        let [few, many] =
            [3, 30].map(|n| euler.round_off(ConstraintLevel::Position, &tenths(n), 1e-3).acceleration * 0.1 * 0.1 / 1e-3);
        assert!((few - 4.0).abs() < 1e-9 && (many - 4.0).abs() < 1e-9, "{few} {many}");
        // order 2 squared: (3/2, -2, 1/2) with itself
        let main = 2.25 + 6.0 + 5.5 + 2.0 + 0.25;
        let second = table_by_name("bdf2").expect("listed");
        let grid = tenths(30);
        let sum = second.round_off(ConstraintLevel::Position, &grid, 1e-3).acceleration * 0.1 * 0.1 / 1e-3;
        // the starter's first step counts, too
        assert!(sum >= main - 1e-9 && sum < 20.0 * main, "{sum} {main}");
    }

    #[test]
    fn the_shortest_step_decides_in_every_table() {
        // 0.5 to 0.51 s is the sixth step
        let mut divided = tenths(10);
        divided.times.insert(6, 0.51);
        divided.breakpoints.insert(6, vec![0]);
        for table in tables() {
            let level = ConstraintLevel::Position;
            let [even, uneven] = [&tenths(10), &divided].map(|grid| table.round_off(level, grid, 1e-3).acceleration);
            // struck in that step and read in the same
            let own = table.scheme(table.scheme_at(&divided, 5)).stages.iter().enumerate();
            let solved = own.filter(|(_, stage)| stage.known.is_none());
            let least = solved.fold(f64::INFINITY, |least: f64, (index, stage)| least.min(stage.q.stages[index].abs()));
            let direct = 1e-3 / (least * 0.01f64.powi(2));
            assert!(uneven.is_finite() && uneven > even && uneven > 0.999 * direct, "{}: {uneven}", table.name);
        }
    }
}
