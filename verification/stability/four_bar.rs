//! A four-bar linkage, driven or free, through its dead points.

use costate::functionals::Over;
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{DesignVariable, MechanismBuilder, Scene, Settings, Signal, SpringDamper};

/// A crank AB, a coupler BC and a rocker DC of round bars between two points of the ground; the crank can turn, the rocker swings.
pub struct FourBar {
    /// Angle of the crank at the start [rad].
    pub crank: f64,
    pub drive: Drive,
}

/// What moves it.
#[derive(Clone, Copy)]
pub enum Drive {
    /// The crank is turned at a rate [rad/s].
    Crank(f64),
    /// A flywheel on the crank turns at a rate [rad/s] at the start; a spring holds the rocker.
    Flywheel(f64),
    /// The rocker is turned by an angle [rad] within a time [s], from rest.
    Rocker(f64, f64),
}

/// Lengths of crank, coupler and rocker, and distance of their bearings [m].
const LENGTHS: [f64; 4] = [0.2, 0.7, 0.5, 0.6];

impl FourBar {
    /// Angle of the crank where it lies in one line with the coupler and the rocker cannot go further [rad].
    pub fn dead_point() -> f64 {
        let [a, b, c, d] = LENGTHS;
        // the triangle A C D with AC = a + b
        ((d * d + (a + b) * (a + b) - c * c) / (2.0 * d * (a + b))).acos()
    }

    /// Angle of the rocker for an angle of the crank [rad].
    pub fn rocker_of_crank(crank: f64) -> f64 {
        let [_, _, rocker] = joints(crank, LENGTHS);
        rocker[1].atan2(rocker[0] - LENGTHS[3])
    }

    /// Angle of the crank beyond the dead point for an angle of the rocker [rad].
    pub fn crank_of_rocker(rocker: f64) -> f64 {
        let [a, b, c, d] = LENGTHS;
        let (x, y) = (d + c * rocker.cos(), c * rocker.sin());
        let reach = x.hypot(y);
        y.atan2(x) + ((a * a + reach * reach - b * b) / (2.0 * a * reach)).min(1.0).acos()
    }
}

/// B, D and C for an angle of the crank; A is the origin.
fn joints<S: Scalar>(crank: S, [a, b, c, d]: [S; 4]) -> [Vector3<S>; 3] {
    let (sine, cosine) = crank.sin_cos();
    let tip = Vector3::new(a * cosine, a * sine, S::zero());
    let bearing = Vector3::new(d, S::zero(), S::zero());
    // C on circles about B and D, on the upper side
    let between = bearing - tip;
    let distance = between.length();
    let along = (distance * distance + b * b - c * c) / (distance * 2.0);
    let across = (b * b - along * along).sqrt();
    let direction = between * distance.recip();
    let up = Vector3::new(-direction[1], direction[0], S::zero());
    [tip, bearing, tip + direction * along + up * across]
}

impl Scene for FourBar {
    fn name(&self) -> String {
        "four-bar".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let names = ["crank", "coupler", "rocker", "distance of the bearings"];
        names.iter().zip(LENGTHS).map(|(&name, length)| DesignVariable::new(name, length, (0.1, 1.0), "m")).collect()
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 1000).dropping_redundant()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let lengths: [S; 4] = x.try_into().map_err(|_| format!("4 variables expected, {} given", x.len()))?;
        let [tip, bearing, end] = joints(S::from(self.crank), lengths);
        let hinge = Vector3::from_f64([0.0, 0.0, 1.0]);
        let rate = S::from(match self.drive {
            Drive::Crank(rate) | Drive::Flywheel(rate) => rate,
            Drive::Rocker(..) => 0.0,
        });
        // rates of coupler and rocker: both give C the same velocity
        let (coupler, rocker) = (end - tip, end - bearing);
        let speed = hinge.cross(&tip) * rate;
        let rates = [
            rate,
            -speed.dot(&rocker) / hinge.cross(&coupler).dot(&rocker),
            speed.dot(&coupler) / hinge.cross(&rocker).dot(&coupler),
        ];
        let ground = m.ground();
        let bars: Vec<_> = [("crank", Vector3::zeros(), tip), ("coupler", tip, end), ("rocker", bearing, end)]
            .into_iter()
            .zip(rates)
            .map(|((name, from, to), rate)| {
                let along = to - from;
                let length = along.length();
                let node = m.body(name, (from + to) * S::from(0.5), Quaternion::x_axis_to(along.unit()));
                let start = if name == "coupler" { hinge.cross(&tip) * rates[0] } else { Vector3::zeros() };
                m.set_velocity(node, start + hinge.cross(&along) * (rate * 0.5), hinge * rate);
                let mass = length * 2.0;
                let lateral = mass * length * length / 12.0;
                let wheel = if name == "crank" && matches!(self.drive, Drive::Flywheel(_)) { 0.05 } else { 0.0 };
                // a disc in the plane of the mechanism
                let [xx, yy, zz] = [lateral * 0.01 + wheel * 0.5, lateral + wheel * 0.5, lateral + wheel];
                m.rigid_body(name, node, mass, Vector3::zeros(), [xx, yy, zz, S::zero(), S::zero(), S::zero()]);
                node
            })
            .collect();
        m.revolute("bearing of the crank", [ground, bars[0]], Vector3::zeros(), hinge);
        m.revolute("crank pin", [bars[0], bars[1]], tip, hinge);
        m.revolute("bearing of the rocker", [ground, bars[2]], bearing, hinge);
        m.revolute("rocker pin", [bars[1], bars[2]], end, hinge);
        match self.drive {
            Drive::Crank(rate) => {
                let turning = Signal::ConstantRate { offset: S::zero(), rate: S::from(rate) };
                m.prescribed_rotation("drive", [ground, bars[0]], hinge, turning);
            }
            Drive::Flywheel(_) => {
                let spring = SpringDamper { stiffness: S::from(20.0), damping: S::zero(), rest: S::from(0.5) };
                m.torsion_spring_damper("spring", [ground, bars[2]], hinge, spring);
            }
            Drive::Rocker(angle, duration) => {
                let [from, to, start, duration] = [0.0, angle, 0.0, duration].map(S::from);
                let ramp = Signal::SmoothRamp { from, to, start, duration };
                m.prescribed_rotation("drive", [ground, bars[2]], hinge, ramp);
            }
        }
        m.position_functional(
            "height of the crank pin at the end",
            Over::Terminal,
            bars[0],
            tip,
            Vector3::from_f64([0.0, 1.0, 0.0]),
        );
        Ok(())
    }
}
