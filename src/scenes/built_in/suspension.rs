use crate::assembly::NodeId;
use crate::design::DesignVariable;
use crate::elements::flexible::Shape;
use crate::elements::flexible::{CableSection, Material};
use crate::functionals::Over;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use crate::scenes::{CableLine, CableMember, Limit, MechanismBuilder, OptimizationProblem, Scene, Settings, Signal};
use std::f64::consts::TAU;

/// A car on four double-wishbone suspensions over a rugged road: x to the rear, y to the right, z up.
///
/// The chassis (300 kg) and the wheels (20 kg each) are bodies in natural coordinates. A wishbone is two steel tubes as cables, 30 mm
/// outside and 20 mm inside, each on a spherical joint to the chassis and welded to the other where a spherical joint holds the wheel. A
/// spring and a damper stand between wheel and chassis. The centres of the wheels are driven along z, the front ones by 50 mm at 1 Hz,
/// the rear ones by 75 mm at 2 Hz; all starts in the drawn pose with the chassis at rest, springs unstretched, weight acting.
///
/// The 60 variables are the places of the 16 joints at the chassis, the heights of the upper ends of the springs, the
/// stiffnesses and the dampings. Their numbers run over the right front (1 to 4), right rear (5 to 8), left rear (9 to 12) and left front
/// (13 to 16) wheel, upper wishbones first. No symmetry is asked for.
///
/// The source leaves open, and here is: gravity 9.81 m/s2; the wheel's joints 80 mm inside its centre, at the
/// heights of the wishbones' joints at the chassis in the first design; the spring from 80 mm inside the wheel's centre at z = 0 to a point of the chassis 150 mm farther inside;
/// a tie rod, without mass, that keeps the wheel from steering, 120 mm behind the wheel's centre and at its height; inertia of a
/// cuboid of 2 x 1.2 x 0.5 m for the chassis and of a disc of 0.3 m radius and 0.2 m width for the wheels.
///
/// Source: Ebrahimi et al., section 6.3, tables 1 to 3.
#[derive(Clone, Copy, Debug)]
pub struct Suspension {
    /// Elements of each tube.
    pub elements: usize,
}

impl Default for Suspension {
    fn default() -> Self {
        Suspension { elements: 2 }
    }
}

/// A wheel and what holds it, in the first design.
struct Corner {
    name: &'static str,
    /// Centre of the wheel \[m\].
    wheel: [f64; 3],
    /// Heights of its joints, the upper one first \[m\].
    joints: [f64; 2],
    /// Ends of the wishbones at the chassis \[m\]: both of the upper one, both of the lower one.
    points: [[f64; 3]; 4],
    /// Upper end of the spring \[m\], stiffness [N/m], damping [N s/m].
    absorber: [f64; 3],
    /// Amplitude \[m\] and frequency \[Hz\] of the road.
    road: [f64; 2],
}

/// Right side; the left one mirrors it.
const FRONT: Corner = Corner {
    name: "front",
    wheel: [-1.11, 0.68, 0.075],
    joints: [0.15, 0.0],
    points: [[-1.27, 0.21, 0.15], [-0.96, 0.21, 0.15], [-1.27, 0.18, 0.0], [-0.96, 0.18, 0.0]],
    absorber: [0.3, 10000.0, 50.0],
    road: [0.05, 1.0],
};
const REAR: Corner = Corner {
    name: "rear",
    wheel: [0.37, 0.56, 0.125],
    joints: [0.25, 0.0],
    points: [[0.21, 0.14, 0.25], [0.52, 0.14, 0.25], [0.21, 0.1, 0.0], [0.52, 0.1, 0.0]],
    absorber: [0.4, 10000.0, 500.0],
    road: [0.075, 2.0],
};
/// In the order of the variables, and on which side.
const CORNERS: [(&Corner, f64); 4] = [(&FRONT, 1.0), (&REAR, 1.0), (&REAR, -1.0), (&FRONT, -1.0)];

/// Bounds of a joint at the chassis on the right side \[m\], by wheel (front, rear) and place (first, second): x; y; and z (upper, lower).
const X_BOUNDS: [[(f64, f64); 2]; 2] = [[(-1.35, -1.1), (-1.1, -0.8)], [(0.1, 0.35), (0.4, 0.65)]];
const Y_BOUNDS: [(f64, f64); 2] = [(0.1, 0.35), (0.1, 0.3)];
const Z_BOUNDS: [(f64, f64); 2] = [(0.1, 0.3), (-0.1, 0.1)];

/// Distance of the wheel's joints from its centre, inwards \[m\].
const INSIDE: f64 = 0.08;
/// Distance of the spring's ends, inwards \[m\].
const LEAN: f64 = 0.15;
/// Tie rod, behind the wheel's centre \[m\].
const BEHIND: f64 = 0.12;
/// Diameter and wall of the tubes \[m\].
const TUBE: [f64; 2] = [0.03, 0.005];
/// Young's modulus [N/m2] and density [kg/m3].
const STEEL: [f64; 2] = [2e11, 7800.0];
/// Largest stress allowed [N/m2], and 1 / rho of its smooth maximum.
const STRESS: f64 = 4e8;
const STRESS_SCALE: f64 = 2e6;
/// Shortest tube allowed \[m\].
const LENGTH: f64 = 1e-3;

/// Name of the stress of beam 1 to 16.
fn stress_name(beam: usize) -> String {
    format!("largest stress in beam {beam}")
}

/// Name of the length of beam 1 to 16.
fn length_name(beam: usize) -> String {
    format!("length of beam {beam}")
}

const OBJECTIVE: &str = "displacement of the chassis, squared, integral";

impl Suspension {
    /// Number of beams.
    pub(crate) const BEAMS: usize = 16;

    /// The variable that mirrors variable `index` on the other side, and its sign.
    pub fn mirrored(index: usize) -> (usize, f64) {
        match index {
            0..48 => {
                let (corner, place, axis) = (index / 12, index / 3 % 4, index % 3);
                ((3 - corner) * 12 + place * 3 + axis, if axis == 1 { -1.0 } else { 1.0 })
            }
            _ => (index / 4 * 4 + 3 - index % 4, 1.0),
        }
    }
}

/// What the pieces of one wheel move like at the start: the wheel's centre and turn, and the turn of both wishbones.
struct Motion<S> {
    velocity: Vector3<S>,
    omega: Vector3<S>,
    wishbones: [Vector3<S>; 2],
}

/// Motion of wishbones about their joints at a chassis at rest that lets the wheel's centre rise with a speed.
///
/// Wishbone k turns with phi_k about the line of its joints at the chassis. The joints of the wheel keep their distance, which gives the ratio of
/// phi_1 and phi_2; the wheel turns with them, and about their line as the tie rod says.
fn motion<S: Scalar>(
    hinges: [[Vector3<S>; 2]; 2],
    joints: [Vector3<S>; 2],
    tie: [Vector3<S>; 2],
    centre: Vector3<S>,
    rise: S,
) -> Motion<S> {
    let axes = hinges.map(|[first, second]| (second - first).unit());
    let unit: [Vector3<S>; 2] = std::array::from_fn(|k| axes[k].cross(&(joints[k] - hinges[k][0])));
    let line = joints[0] - joints[1];
    let ratio = line.dot(&unit[0]) / line.dot(&unit[1]);
    let speeds = [unit[0], unit[1] * ratio];
    let inverse = line.dot(&line).recip();
    let across = line.cross(&(speeds[0] - speeds[1])) * inverse;
    let (rod, arm) = (tie[1] - tie[0], tie[1] - joints[0]);
    let about = -(rod.dot(&(speeds[0] + across.cross(&arm))) / rod.dot(&line.cross(&arm)));
    let omega = across + line * about;
    let velocity = speeds[0] + omega.cross(&(centre - joints[0]));
    let factor = rise / velocity[2];
    Motion { velocity: velocity * factor, omega: omega * factor, wishbones: [axes[0] * factor, axes[1] * (ratio * factor)] }
}

/// A rigid body with its mass \[kg\] and the moments of inertia about its principal axes \[kg m2\].
fn add_solid<S: Scalar>(
    m: &mut MechanismBuilder<S>,
    name: &str,
    centre: Vector3<S>,
    mass: f64,
    moments: [f64; 3],
) -> NodeId {
    let node = m.natural_body(name, centre, Quaternion::identity());
    let [a, b, c] = moments.map(S::from);
    m.rigid_body(name, node, S::from(mass), Vector3::zeros(), [a, b, c, S::zero(), S::zero(), S::zero()]);
    node
}

/// Stresses of the beams over the run, and their lengths at the start.
fn add_beam_functionals<S: Scalar>(m: &mut MechanismBuilder<S>, beams: &[CableMember], young: S, radius: S) {
    for (number, beam) in (1..).zip(beams) {
        m.largest_cable_stress_functional(&stress_name(number), beam, young, radius, 1.0 / STRESS_SCALE);
    }
    for (number, beam) in (1..).zip(beams) {
        let ends = [beam.start(), beam.end()];
        m.distance_functional(&length_name(number), Over::Initial, ends, ends.map(|node| m.position(node)));
    }
}

impl Scene for Suspension {
    fn name(&self) -> String {
        "suspension".into()
    }
    fn summary(&self) -> String {
        "car on four double-wishbone suspensions with flexible arms over a rugged road".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        let mut list = Vec::new();
        for (k, (corner, side)) in CORNERS.into_iter().enumerate() {
            let wheel = usize::from(corner.name == "rear");
            for (place, point) in corner.points.into_iter().enumerate() {
                let number = 4 * k + place + 1;
                let (low, high) = Y_BOUNDS[wheel];
                let across = if side > 0.0 { (low, high) } else { (-high, -low) };
                let bounds = [X_BOUNDS[wheel][place % 2], across, Z_BOUNDS[place / 2]];
                for (axis, initial) in [point[0], side * point[1], point[2]].into_iter().enumerate() {
                    let name = format!("{}{number}", ["X", "Y", "Z"][axis]);
                    list.push(DesignVariable::new(name, initial, bounds[axis], "m"));
                }
            }
        }
        let quantities = [("Z", (0.15, 0.6), "m", 17), ("k", (100.0, 30000.0), "N/m", 1), ("c", (20.0, 1000.0), "N s/m", 1)];
        for (index, (letter, bounds, unit, first)) in quantities.into_iter().enumerate() {
            for (k, (corner, _)) in CORNERS.into_iter().enumerate() {
                list.push(DesignVariable::new(format!("{letter}{}", first + k), corner.absorber[index], bounds, unit));
            }
        }
        list
    }
    fn settings(&self) -> Settings {
        Settings::new(3.0, 3000).with_method("variational")
    }
    fn optimization_problem(&self) -> Option<OptimizationProblem> {
        let mut problem = OptimizationProblem::minimize(OBJECTIVE);
        for beam in 1..=Self::BEAMS {
            problem = problem.subject_to(&stress_name(beam), Limit::AtMost(STRESS));
            problem = problem.subject_to(&length_name(beam), Limit::AtLeast(LENGTH));
        }
        // far from their limits, stresses and lengths need no gradient
        Some(problem.screened(0.5))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        if x.len() != 60 {
            return Err(format!("60 variables expected, {} given", x.len()));
        }
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let centre = at([0.243, 0.0, 0.365]);
        let cuboid = [[1.2, 0.5], [2.0, 0.5], [2.0, 1.2]].map(|[a, b]: [f64; 2]| 300.0 / 12.0 * (a * a + b * b));
        let chassis = add_solid(m, "chassis", centre, 300.0, cuboid);
        let ground = m.ground();
        let material = Material { young: S::from(STEEL[0]), poisson: S::from(0.3), density: S::from(STEEL[1]) };
        let [diameter, wall] = TUBE.map(S::from);
        let section = CableSection::of(material, Shape::tube(diameter, wall, material.poisson));
        let up = at([0.0, 0.0, 1.0]);

        let mut beams = Vec::new();
        for (k, (corner, side)) in CORNERS.into_iter().enumerate() {
            let of = |what: &str| format!("{what}, {} {}", if side > 0.0 { "right" } else { "left" }, corner.name);
            let points: [Vector3<S>; 4] = std::array::from_fn(|place| Vector3::first_three(&x[12 * k + 3 * place..]));
            let [wheel_x, wheel_y, wheel_z] = corner.wheel;
            let inside = |distance: f64, x: f64, z: f64| at([x, side * (wheel_y - distance), z]);
            let hub = inside(0.0, wheel_x, wheel_z);
            let joints = corner.joints.map(|z| inside(INSIDE, wheel_x, z));
            let tie = [wheel_y - corner.points[0][1], INSIDE].map(|distance| inside(distance, wheel_x + BEHIND, wheel_z));
            let [amplitude, frequency] = corner.road;
            let rise = S::from(amplitude * TAU * frequency);
            let hinges = [[points[0], points[1]], [points[2], points[3]]];
            let motion = motion(hinges, joints, tie, hub, rise);

            let (radius, width) = (0.3, 0.2);
            let (about, across) = (10.0 * radius * radius, 20.0 / 12.0 * (3.0 * radius * radius + width * width));
            let wheel = add_solid(m, &of("wheel"), hub, 20.0, [across, about, across]);
            m.set_velocity(wheel, motion.velocity, motion.omega);
            m.draw(wheel, &[joints[1], joints[0], hub, joints[1]]);

            for (level, name) in ["upper", "lower"].into_iter().enumerate() {
                let tubes: [CableMember; 2] = std::array::from_fn(|place| {
                    let (from, beam) = (hinges[level][place], beams.len() + place + 1);
                    let line = CableLine::straight([from, joints[level]], self.elements);
                    let tube = m.cable(&format!("beam {beam}"), line, &section);
                    m.set_rigid_motion(&tube.nodes, from, Vector3::zeros(), motion.wishbones[level]);
                    m.spherical(&format!("joint {beam}"), [chassis, tube.start()], from);
                    tube
                });
                let ends = [tubes[0].end(), tubes[1].end()];
                m.cable_corner(&of(&format!("weld of the {name} wishbone")), ends);
                m.spherical(&of(&format!("{name} joint of the wheel")), [ends[0], wheel], joints[level]);
                beams.extend(tubes);
            }
            m.distance(&of("tie rod"), [chassis, wheel], tie);
            let foot = inside(INSIDE, wheel_x, 0.0);
            let mut head = inside(INSIDE + LEAN, wheel_x, 0.0);
            head[2] = x[48 + k];
            m.line_spring(&of("spring"), [wheel, chassis], [foot, head], x[52 + k], (head - foot).length());
            m.line_damper(&of("damper"), [wheel, chassis], [foot, head], x[56 + k]);
            let [offset, phase, amplitude, angular_frequency] = [0.0, 0.0, amplitude, TAU * frequency].map(S::from);
            let wave = Signal::Sine { offset, amplitude, angular_frequency, phase };
            m.prescribed_translation(&of("road"), [ground, wheel], [hub; 2], up, wave);
        }
        m.gravity(up * S::from(-9.81));
        let corners = [[-1.3, 0.2], [0.6, 0.15], [0.6, -0.15], [-1.3, -0.2], [-1.3, 0.2]];
        m.draw(chassis, &corners.map(|[x, y]| at([x, y, 0.365])));

        m.target_functional(OBJECTIVE, Over::Integral, chassis, centre, centre);
        add_beam_functionals(m, &beams, material.young, diameter * 0.5);
        Ok(())
    }
}
