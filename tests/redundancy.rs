//! Redundant constraints: a loop of six hinges whose equations depend on each other at every pose.

use costate::design::DesignVariable;
use costate::functionals::Over;
use costate::integrators::{ConstraintLevel, Method, Recorder, RunError, StartRecord, StepRecord, march, table_by_name};
use costate::scalar::{Quaternion, Scalar, Vec3};
use costate::scenes::{MechanismBuilder, Prepared, Scene, Settings};
use costate::sensitivity::largest_difference;

/// Bricard's loop of six bars along the edges of a unit cube, each hinge at right angles to both its bars; one bar is the ground.
struct Loop {
    /// Order in which the hinges are given: the equations of the last are left out first.
    order: [usize; 6],
    end: f64,
    steps: usize,
}

const CORNERS: [[f64; 3]; 6] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.], [0., 0., 1.]];
const AXES: [[f64; 3]; 6] = [[0., 1., 0.], [0., 0., 1.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 0., 0.]];

impl Scene for Loop {
    fn name(&self) -> String {
        "loop of six hinges".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("mass", 10.0, (1.0, 20.0), "kg"), DesignVariable::new("size", 1.0, (0.5, 2.0), "m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(self.end, self.steps).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let corner = |i: usize| Vec3::<S>::from_f64(CORNERS[i % 6]) * x[1];
        let mut bars: Vec<_> = (0..5)
            .map(|i| {
                let (from, to) = (corner(i), corner(i + 1));
                let along = (to - from).normalized();
                let bar = m.body(&format!("bar {i}"), (from + to) * S::from(0.5), Quaternion::x_axis_to(along));
                let lateral = x[0] * x[1] * x[1] / 12.0;
                let zero = S::zero();
                m.rigid_body(
                    &format!("bar {i}"),
                    bar,
                    x[0],
                    Vec3::zero(),
                    [lateral * 1e-3, lateral, lateral, zero, zero, zero],
                );
                bar
            })
            .collect();
        bars.push(m.ground());
        m.gravity(Vec3::from_f64([0.0, -9.81, 0.0]));
        let mut joints = vec![None; 6];
        for i in self.order {
            let nodes = [bars[(i + 5) % 6], bars[i]];
            joints[i] = Some(m.revolute(&format!("hinge {i}"), nodes, corner(i), Vec3::from_f64(AXES[i])));
        }
        m.position_functional("place", Over::Terminal, bars[2], corner(3), Vec3::from_f64([1.0, 0.5, -0.3]));
        m.energy_functional("energy", Over::Terminal);
        for (i, joint) in joints.into_iter().enumerate() {
            let weights = [1.0, 0.5, -0.7, 0.3, 0.2].map(S::from);
            m.reaction_functional(&format!("reaction {i}"), Over::Integral, joint.ok_or("no joint")?, &weights);
        }
        Ok(())
    }
}

/// Remembers which equations were left out, and how far those were violated.
#[derive(Default)]
struct Log {
    dropped: Vec<Vec<usize>>,
    last: Option<(f64, Vec<f64>, Vec<f64>)>,
    worst: f64,
}

struct Watching<'p>(&'p Prepared<'p>, Log);

impl Recorder<f64> for Watching<'_> {
    fn start(&mut self, start: StartRecord<f64>) -> Result<(), RunError> {
        self.1.dropped.push(start.dropped);
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        if self.1.dropped.last() != Some(&step.dropped) {
            println!("t = {} {:?}", step.t, step.dropped);
            self.1.dropped.push(step.dropped.clone());
        }
        self.1.worst = self.1.worst.max(self.0.violation(step.t + step.h, &step.q, &step.v).position);
        Ok(true)
    }
}

#[test]
fn the_loop_moves_with_constant_energy_and_dropped_equations_hold() {
    for order in [[0, 1, 2, 3, 4, 5], [3, 4, 5, 0, 1, 2], [5, 4, 3, 2, 1, 0]] {
        let scene = Loop { order, end: 10.0, steps: 2000 };
        let prepared = Prepared::new(&scene).unwrap();
        println!("{:?} dropped", prepared.plan.dropped);
        let mut log = Watching(&prepared, Log::default());
        let problem = prepared.problem();
        let run = march(&problem, &prepared.method, &prepared.grid, &prepared.plan, &mut log);
        println!("{:?} {}", run.map(|run| run.counters), log.1.worst);
        let run = prepared.analysis().forward(&prepared.x).unwrap();
        println!("{:?}", run.values);
    }
}
