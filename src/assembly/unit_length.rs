use super::batches::ConstraintBatch;
use super::reduction::{NodeReduction, RotationCoordinates};
use super::{Equations, Level, StageCoefficients, Unknowns, VectorsAvq};
use crate::elements::RunScalar;
use crate::linalg::{Kernel, dispatch};
use crate::scalar::Scalar;

/// Euler parameters e of all bodies, kept at unit length in closed form, g = (e . e - 1) / 2 and A = e: the one constraint inside nodes whose
/// corrections and multipliers are not programs. For four coordinates it takes longer to lay numbers side by side than to compute with them: a
/// step of a chain of bodies took 16 % more instructions.
pub(super) struct UnitLengths<'b> {
    batch: &'b ConstraintBatch,
}

impl<'b> UnitLengths<'b> {
    /// If that is what a batch of constraints inside nodes is about.
    pub fn of(batch: &'b ConstraintBatch) -> Option<Self> {
        let turning = RotationCoordinates::Euler;
        let is_own = matches!(batch.nodes[0], NodeReduction::RotationCoordinates { turning: own, .. } if own == turning);
        is_own.then_some(UnitLengths { batch })
    }

    fn starts(&self) -> impl Iterator<Item = usize> {
        (0..self.batch.parts.len()).map(|part| self.batch.places.nodes[0].of(part).start)
    }

    /// Corrects unknowns until these hold to round-off, at most so many times.
    pub fn restore<S: RunScalar>(
        &self,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        corrections: usize,
    ) {
        dispatch(Restoration { lengths: self, equations, base, unknowns, corrections });
    }

    /// Sets the multipliers so that a force has no part along the reactions, and adds these.
    pub fn eliminate<S: RunScalar>(&self, q: &[S], force: &mut [S], multipliers: &mut [S]) {
        for (part, start) in self.starts().enumerate() {
            let multiplier = balance(four(q, start), &mut force[start..start + 4]);
            multipliers[self.batch.places.multipliers.of(part).start] = multiplier;
        }
    }
}

struct Restoration<'r, S> {
    lengths: &'r UnitLengths<'r>,
    equations: &'r Equations,
    base: &'r VectorsAvq<S>,
    unknowns: &'r mut Unknowns<S>,
    corrections: usize,
}

impl<S: RunScalar> Kernel for Restoration<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Restoration { lengths, equations, base, unknowns, corrections } = self;
        let (weights, scale) = (equations.row_weights(), equations.row_scale());
        for start in lengths.starts() {
            let mut before = f64::INFINITY;
            for _ in 0..corrections {
                let gap = correct(start, (equations, weights, scale), base, &mut unknowns.x);
                // below a quarter of the last one: still converging
                if gap == 0.0 || gap >= 0.25 * before {
                    break;
                }
                before = gap;
            }
        }
    }
}

/// One correction of the Euler parameters that start at a coordinate. Returns what was corrected, 0 for round-off.
#[inline(always)]
fn correct<S: RunScalar>(
    start: usize,
    (equations, weights, scale): (&Equations, [f64; 3], f64),
    base: &VectorsAvq<S>,
    x: &mut [S],
) -> f64 {
    let StageCoefficients { gamma, beta, alpha } = equations.constraint;
    let x: &mut [S; 4] = x[start..].first_chunk_mut().expect("four parameters");
    let own = |base: &[S], factor: f64| -> [S; 4] {
        let base = four(base, start);
        std::array::from_fn(|i| base[i] + x[i] * factor)
    };
    let (a, v, q) = (own(&base.a, gamma), own(&base.v, beta), own(&base.q, alpha));
    let size = |x: &[S; 4], y: &[S; 4]| (0..4).fold(0.0, |sum, i| sum + (x[i].value() * y[i].value()).abs());
    let (gap, terms) = match equations.level {
        Level::Position => (dot(&q, &q) * 0.5 - 0.5, 0.5 * size(&q, &q) + 0.5),
        Level::Velocity => (dot(&q, &v), size(&q, &v)),
        Level::Acceleration => (dot(&q, &a) + dot(&v, &v), size(&q, &a) + size(&v, &v)),
    };
    if gap.value().abs() <= f64::EPSILON * terms {
        return 0.0;
    }
    let row: [S; 4] = std::array::from_fn(|i| q[i] * weights[0] + v[i] * weights[1] + a[i] * weights[2]);
    let multiplier = gap * scale / dot(&row, &row);
    x.iter_mut().zip(row).for_each(|(x, row)| *x -= multiplier * row);
    gap.value().abs()
}

/// Leaves a force no part along e; returns the multiplier.
#[inline(always)]
fn balance<S: Scalar>(e: &[S; 4], f: &mut [S]) -> S {
    let multiplier = -(dot(e, four(f, 0)) / dot(e, e));
    f.iter_mut().zip(e).for_each(|(f, &e)| *f += e * multiplier);
    multiplier
}

#[inline(always)]
fn four<S>(values: &[S], start: usize) -> &[S; 4] {
    values[start..].first_chunk().expect("four parameters")
}

#[inline(always)]
fn dot<S: Scalar>(x: &[S; 4], y: &[S; 4]) -> S {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2] + x[3] * y[3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::constraint_programs::{Asked, ConstraintLayout, ConstraintPart};
    use crate::assembly::node_programs;
    use crate::elements::{ConstraintPhysics, NodeKind};
    use crate::program::{Program, ProgramWork};

    const LAYOUT: ConstraintLayout = ConstraintLayout { n: 4, parameters: 0, equations: 1 };

    fn results(program: &Program, physics: &ConstraintPhysics, own: &[f64]) -> Vec<f64> {
        let (inputs, mut outputs) = ([&vec![0.0; physics.formula().inputs], own].concat(), vec![0.0; program.outputs()]);
        program.run(&inputs, &mut outputs, &mut ProgramWork::default());
        outputs
    }

    fn near(own: &[f64], expected: &[f64]) -> bool {
        own.len() == expected.len() && own.iter().zip(expected).all(|(own, expected)| (own - expected).abs() < 1e-14)
    }

    #[test]
    fn closed_form_equals_the_programs_of_the_recorded_constraint() {
        let physics = NodeKind::Body.local_constraint().expect("Euler parameters have unit length");
        let numbers = |phase: f64| (0..4).map(|i| (f64::from(i) + phase).sin()).collect::<Vec<f64>>();
        let base = VectorsAvq { a: numbers(2.6), v: numbers(1.3), q: numbers(0.1) };
        let (x, none) = (numbers(0.7), [0.0]);
        for level in [Level::Position, Level::Velocity, Level::Acceleration] {
            let shift = StageCoefficients { gamma: 0.9, beta: 0.3, alpha: 0.2 };
            let equations = Equations::stage(shift, level);
            let (asked, scale) = Asked::inside(ConstraintPart::Equations, &equations);
            let point = [&base.v[..], &base.q, &[0.0], &base.a, &none, &[scale]];
            let own = [&point.concat()[..], &[shift.gamma, shift.beta, shift.alpha], &x].concat();
            let found = results(&node_programs::correction(&physics, LAYOUT, asked), &physics, &own);
            let mut corrected = x.clone();
            let how = (&equations, equations.row_weights(), equations.row_scale());
            let gap = correct(0, how, &base, &mut corrected);
            assert!(gap > 0.01 && near(&[gap * scale], &[found[1].abs()]), "{level:?}: {gap} {found:?}");
            let expected: Vec<f64> = x.iter().zip(&found[2..]).map(|(x, change)| x + change).collect();
            assert!(near(&corrected, &expected), "{level:?}: {corrected:?} {expected:?}");
        }
        let mut force = numbers(3.1);
        let own = [&base.v[..], &base.q, &[0.0], &force, &none, &none].concat();
        let found = results(&node_programs::elimination(&physics, LAYOUT), &physics, &own);
        let expected: Vec<f64> = force.iter().zip(&found).map(|(f, reaction)| f + reaction).collect();
        let multiplier = balance(four(&base.q, 0), &mut force);
        assert!(near(&force, &expected) && near(&[multiplier], &found[4..]), "{force:?} {multiplier} {found:?}");
    }
}
