use super::{Carried, ConstraintLevel, Table, TimeGrid};

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
                    let x = table.held_step(end - t, &mut carried, (step == first).then_some(struck));
                    velocities[step] += carried[1].abs();
                    accelerations[step].iter_mut().zip(&x).for_each(|(sum, x)| *sum += x.abs());
                }
            }
        }
        let largest = |sums: &mut dyn Iterator<Item = f64>| sums.fold(0.0, f64::max) * rounding;
        let velocity = largest(&mut velocities.into_iter());
        RoundOff { velocity, acceleration: largest(&mut accelerations.into_iter().flatten()) }
    }

    /// Makes a step of a coordinate that is held at 0, or at 1 at the stage `struck`; returns its accelerations.
    fn held_step(&self, h: f64, carried: &mut Vec<f64>, struck: Option<usize>) -> Vec<f64> {
        self.scalar_step(h, carried, |index, sum| {
            let (stage, aim) = (&self.stages[index], f64::from(u8::from(struck == Some(index))));
            (aim - sum(0, &stage.q)) / (stage.q.stages[index] * h * h)
        })
    }

    /// Accelerations that are solved anew follow from coordinates and velocities, not from what was carried.
    fn restart(&self, carried: &mut [f64]) {
        let accelerations = carried.iter_mut().zip(&self.carried).filter(|(_, kind)| **kind == Carried::A);
        accelerations.for_each(|(value, _)| *value = 0.0);
    }
}

/// What steps make of roundings of a coordinate that a constraint at position level holds, each stage rounded by itself: the covariance of the
/// carried vectors. A table that does not damp hands each on to all steps behind, and swings ever more.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldRoundings {
    covariance: Vec<Vec<f64>>,
}

impl HeldRoundings {
    /// Standard deviations of coordinate, velocity and acceleration, stages and end, of the next step of size `h` \[1, 1/s, 1/s2\], for
    /// roundings of 1; `begins_anew`: its first acceleration follows from coordinates and velocities.
    pub fn step(&mut self, table: &Table, h: f64, begins_anew: bool) -> [f64; 3] {
        let (carried, stages) = (table.carried.len(), table.stages.len());
        self.covariance.resize(carried, vec![0.0; carried]);
        // what each carried vector and each place of a stage, 1 by itself, makes of carried vectors and accelerations
        let mut made = Vec::with_capacity(carried + stages);
        for place in 0..carried + stages {
            let mut vectors: Vec<f64> = (0..carried).map(|other| f64::from(u8::from(other == place))).collect();
            if begins_anew {
                table.restart(&mut vectors);
            }
            let x = table.held_step(h, &mut vectors, place.checked_sub(carried));
            made.push([vectors, x].concat());
        }
        let old = std::mem::take(&mut self.covariance);
        let covariance = |i: usize, j: usize| {
            let of_row = |row: &[f64]| row.iter().zip(&made).map(|(covariance, own)| covariance * own[j]).sum::<f64>();
            let handed_on: f64 = made.iter().zip(&old).map(|(own, row)| own[i] * of_row(row)).sum();
            handed_on + made[carried..].iter().map(|own| own[i] * own[j]).sum::<f64>()
        };
        self.covariance = (0..carried).map(|i| (0..carried).map(|j| covariance(i, j)).collect()).collect();
        let acceleration = (carried..carried + stages).map(|i| covariance(i, i).sqrt()).fold(0.0, f64::max);
        [self.covariance[0][0].sqrt(), self.covariance[1][1].sqrt(), acceleration]
    }
}

#[cfg(test)]
mod tests {
    use super::HeldRoundings;
    use crate::integrators::{ConstraintLevel, TimeGrid, table_by_name, tables};

    /// The same sum over all stages of all steps before, of squares, each followed by itself.
    #[test]
    fn roundings_are_handed_on_as_each_by_itself() {
        for table in tables() {
            let (h, steps) = (0.1, 12);
            let scheme = |step: usize| table.scheme(table.scheme_at(&tenths(steps), step));
            let mut held = HeldRoundings::default();
            let mut found = [0.0; 3];
            for index in 0..steps {
                found = held.step(scheme(index), h, index == 0);
            }
            let mut sums = [0.0; 2];
            let of = |first: usize| (0..scheme(first).stages.len()).map(move |struck| (first, struck));
            for (first, struck) in (0..steps).flat_map(of) {
                let mut carried = vec![0.0; table.carried.len()];
                for step in first..steps {
                    scheme(step).held_step(h, &mut carried, (step == first).then_some(struck));
                }
                sums.iter_mut().zip(&carried).for_each(|(sum, own)| *sum += own * own);
            }
            for (found, sum) in found.iter().zip(sums) {
                assert!((found - f64::sqrt(sum)).abs() <= 1e-9 * found, "{}: {found} for {}", table.name, f64::sqrt(sum));
            }
        }
    }

    /// Midpoint: each rounding d makes velocities of 4 d / h, -12, 20, ...; its L-stable relative forgets them.
    #[test]
    fn what_is_not_damped_grows() {
        let after = |name: &str, steps: usize| {
            let (table, mut held) = (table_by_name(name).expect("listed"), HeldRoundings::default());
            (0..steps).map(|step| held.step(&table, 0.1, step == 0)[1]).last().expect("steps")
        };
        let squares: f64 = (0..50).map(|k| (40.0 * f64::from(2 * k + 1)).powi(2)).sum();
        assert!((after("midpoint", 50) - squares.sqrt()).abs() < 1e-9 * squares.sqrt());
        assert!((after("sdirk2", 50) - after("sdirk2", 20)).abs() < 1e-9 * after("sdirk2", 50));
    }

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
