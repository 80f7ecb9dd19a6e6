//! Mechanisms among the example scenes, held to calculations by hand.

use super::runge_kutta;
use costate::functionals::Extremes;
use costate::prelude::*;
use costate::scenes::built_in;
use std::f64::consts::PI;

type V = nalgebra::Vector3<f64>;

/// Values of the functionals of a scene with changes, whose gradients agree with complex step, and the largest values of what is aggregated.
fn run((name, limit): (&str, f64), changes: &str) -> (Vec<f64>, Vec<Vec<f64>>, Vec<Option<Extremes>>) {
    let scene = built_in::changed(name, changes).unwrap_or_else(|why| panic!("{why}"));
    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{name}: {why}"));
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).unwrap_or_else(|why| panic!("{name}: {why}"));
    let gradient = analysis.adjoint(&prepared.x, &forward).unwrap().rows;
    let other = analysis.complex_step(&prepared.x, &forward).unwrap_or_else(|why| panic!("{name}: {why}")).rows;
    for ((own, other), functional) in gradient.iter().zip(&other).zip(prepared.functionals()) {
        let apart = largest_difference(other, own);
        assert!(apart < limit, "{name}, {}: {apart:e}", functional.name);
    }
    (forward.values, gradient, forward.extremes)
}

fn assert_near(own: f64, other: f64, limit: f64, what: &str) {
    assert!((own - other).abs() < limit, "{what}: {own} for {other}");
}

/// Where the platform of the delta robot is, and the potential energy of all that it moves, for how far its motors have turned.
fn delta(turns: [f64; 3]) -> (V, f64) {
    let (base, platform, upper, fore, tilt) = (0.2, 0.05, 0.3, 0.7, 30.0_f64.to_radians());
    let out = [0.0, 120.0, 240.0].map(|degrees: f64| V::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0));
    let elbows: [V; 3] = std::array::from_fn(|k| {
        let angle = tilt - turns[k];
        out[k] * (base + upper * angle.cos()) - V::z() * (upper * angle.sin())
    });
    // the platform's centre is as far as a forearm from each elbow moved inwards by the platform: the lower point where three spheres meet
    let c: [V; 3] = std::array::from_fn(|k| elbows[k] - out[k] * platform);
    let x = (c[1] - c[0]).normalize();
    let i = x.dot(&(c[2] - c[0]));
    let y = (c[2] - c[0] - x * i).normalize();
    let (d, j) = ((c[1] - c[0]).norm(), y.dot(&(c[2] - c[0])));
    let along = d / 2.0;
    let aside = (i * i + j * j) / (2.0 * j) - i / j * along;
    let z = x.cross(&y);
    let depth = (fore * fore - along * along - aside * aside).sqrt();
    let place = c[0] + x * along + y * aside - z * (depth * z.z.signum());
    let mut weight_height = (0.4 + 0.5) * place.z;
    for k in 0..3 {
        let corner = place + out[k] * platform;
        weight_height +=
            0.6 * elbows[k].z / 2.0 + 0.05 * (elbows[k].z + corner.z) + 2.0 * 0.1 * (elbows[k].z + corner.z) / 2.0;
    }
    (place, 9.81 * weight_height)
}

#[test]
fn a_delta_robot_goes_where_three_spheres_meet_and_its_motors_hold_its_weight() {
    let (values, ..) = run(("delta-robot", 1e-12), "");
    let turns = [15.0_f64, 5.0, -5.0].map(f64::to_radians);
    let (place, _) = delta(turns);
    for k in 0..3 {
        assert_near(values[k], place[k], 1e-12, "a coordinate of the platform");
        let energy = |by: f64| {
            let mut turns = turns;
            turns[k] += by;
            delta(turns).1
        };
        let slope = (8.0 * (energy(1e-3) - energy(-1e-3)) - (energy(2e-3) - energy(-2e-3))) / 12e-3;
        assert_near(values[3 + k].abs(), slope.abs(), 1e-9, "the moment of a motor");
    }
}

#[test]
fn pitch_links_turn_the_blades_of_a_rotor_as_its_triangles_say() {
    let (values, ..) = run(("rotor", 1e-11), "");
    let (horn, link, lift, tilt_x, tilt_y) = (0.12, 0.35, 0.012, 0.04, -0.06);
    let (height, grip) = (0.5, 0.15);
    let about = |axis: V, angle: f64| nalgebra::Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(axis), angle);
    // after two whole turns the shaft stands as at the start; the scissors keep a point of the upper plate in a plane of the shaft
    let plate = about(V::x(), tilt_x) * about(V::y(), tilt_y);
    let carried = plate * about(V::z(), -(plate[(1, 0)] / plate[(1, 1)]).atan());
    for k in 0..4 {
        let blade = about(V::z(), f64::from(k) * PI / 2.0);
        let foot = V::z() * (height - link + lift) + carried * (blade * V::new(grip, horn, 0.0));
        let foot = blade.inverse() * (foot - V::z() * height);
        // |(grip, horn cos, horn sin) - foot| = link
        let rest = link * link - (grip - foot.x).powi(2) - horn * horn - foot.y * foot.y - foot.z * foot.z;
        let (cosine, sine) = (-2.0 * horn * foot.y, -2.0 * horn * foot.z);
        let (middle, half) = (sine.atan2(cosine), (rest / cosine.hypot(sine)).acos());
        let near = |angle: f64| (angle + PI).rem_euclid(2.0 * PI) - PI;
        let [one, other] = [near(middle + half), near(middle - half)];
        let pitch = if one.abs() < other.abs() { one } else { other };
        assert_near(values[k as usize], pitch, 1e-12, "the pitch of a blade");
    }
}

#[test]
fn a_perforated_plate_rests_on_its_motor_until_it_swings() {
    let name = "perforated-plate";
    // the last bits of places in a plane of 1.4e8 N/m are 1e-9 of its weight, which the motor carries
    let (values, gradient, _) = run((name, 2e-9), "");
    let mass_by_thickness = 2700.0 * (0.4 * 0.24 - PI * 0.06 * 0.06);
    assert_near(values[0], mass_by_thickness * 0.002, 1e-5 * values[0], "the mass");
    assert_near(gradient[0][0], mass_by_thickness, 1e-5 * mass_by_thickness, "the mass by the thickness");
    // it sags by a thousandth of its length, which moves its centre by the square of that
    assert_near(values[1].abs(), 9.81 * 0.2 * values[0], 1e-4 * values[1].abs(), "the moment at rest");
    let still = "settings = { end = 0.1, steps = 10 }\nfunctional.'height of the free edge at the end'.type = 'velocity'";
    let scene = built_in::changed(name, still).unwrap();
    let prepared = Prepared::new(&scene).unwrap();
    let values = prepared.analysis().forward(&prepared.x).unwrap().values;
    assert!(values[3].abs() < 1e-9, "the edge moves at {} m/s", values[3]);
}

/// The largest stress of the coupler of a four-bar of rigid bars, driven at constant speed: a beam between two pins under its inertia.
fn stress_of_the_coupler(speed: f64, [coupler, rocker]: [f64; 2]) -> f64 {
    let (density, height) = (2700.0, 0.02);
    let (b_length, c_length, pivot) = (0.75, 0.4, V::new(0.8, 0.0, 0.0));
    let places = |angle: f64| {
        let b = V::new(-angle.sin(), angle.cos(), 0.0) * 0.15;
        let line = pivot - b;
        let along = (b_length * b_length - c_length * c_length + line.norm_squared()) / (2.0 * line.norm());
        let unit = line.normalize();
        (b, b + unit * along + V::z().cross(&unit) * (b_length * b_length - along * along).sqrt())
    };
    let of_line = density * coupler * height;
    let mut largest = 0.0_f64;
    for step in 0..720 {
        let angle = f64::from(step) * PI / 360.0;
        let (b, c) = places(angle);
        let second =
            |of: &dyn Fn(f64) -> V| (of(angle + 1e-3) + of(angle - 1e-3) - of(angle) * 2.0) * (speed * speed / 1e-6);
        let (a_b, a_c) = (second(&|angle| places(angle).0), second(&|angle| places(angle).1));
        let (bar, arm) = (c - b, c - pivot);
        // moments about D of the rocker, and about B of the coupler, by the force on the coupler at C
        let cross = |x: V, y: V| x.x * y.y - x.y * y.x;
        let of_rocker = density * rocker * height * c_length * cross(arm, a_c) / 3.0;
        let of_coupler = of_line * b_length * cross(bar, a_b / 6.0 + a_c / 3.0);
        let rows = nalgebra::Matrix2::new(arm.y, -arm.x, -bar.y, bar.x);
        let force = rows.lu().solve(&nalgebra::Vector2::new(of_rocker, of_coupler)).expect("no dead centre");
        let force = V::new(force.x, force.y, 0.0);
        for part in 0..=100 {
            let share = f64::from(part) / 100.0;
            // from the section on to C, the acceleration grows evenly from a_s to a_c
            let (a_s, rest) = (a_b * (1.0 - share) + a_c * share, bar * (1.0 - share));
            let length = rest.norm();
            let moment = cross(rest, force) - of_line * length * cross(rest, a_s / 6.0 + a_c / 3.0);
            let axial = (force - (a_s + a_c) * (of_line * length / 2.0)).dot(&bar) / b_length;
            largest = largest.max(axial.abs() / (coupler * height) + moment.abs() * 6.0 / (height * coupler * coupler));
        }
    }
    largest
}

#[test]
fn bars_of_a_four_bar_have_the_stress_of_beams_between_pins() {
    let slow = "define.speed = 8\ndriver.motor.angle.smooth_start = 1\nsettings = { end = 2, steps = 300 }";
    let (values, _, extremes) = run(("stressed-four-bar", 1e-11), slow);
    assert_near(values[0], 2700.0 * 0.01 * 0.02 * (0.15 + 0.75 + 0.4), 1e-12, "the mass");
    let own = extremes[2].as_ref().expect("an aggregate").largest.value * 30e6;
    let by_hand = stress_of_the_coupler(8.0, [0.01; 2]);
    assert_near(own, by_hand, 0.02 * by_hand, "the largest stress of the coupler");
}

#[test]
fn a_tyre_moves_as_its_equations_say() {
    let (values, ..) = run(("tyre", 1e-12), "");
    let slope = |t: f64, [_, v, slip, _]: [f64; 4]| {
        let force = 3e3 * (4e4 * slip / 3e3).tanh();
        [v, (force + 2500.0 * (2.0 * PI * t).sin().powi(2)) / 400.0, (-v - 15.0 * slip) / 0.4, force * v]
    };
    let end = runge_kutta::integrated([0.0; 4], (15_000, 1e-4), slope);
    assert!((values[0] - end[0]).abs() < 1e-8 && (values[2] - end[3]).abs() < 1e-4, "{values:?} for {end:?}");
}

#[test]
fn blades_under_air_loads_hover_as_momentum_theory_says() {
    let (values, ..) = run(("air-loads", 1e-12), "");
    // at rest in the rotating frame: lift of a ring is its momentum, which gives the inflow; the blade cones by a few degrees
    let (omega, pitch, slope, chord) = (60.0, 6.0_f64.to_radians(), 5.7, 0.1);
    // the middle of the last of eight strips
    let place = 0.4 + 7.5 * (2.0 - 0.4) / 8.0;
    let mut w = 0.0;
    for _ in 0..200 {
        let angle = pitch - (w / (omega * place)).atan();
        let lift = chord * slope * angle * ((omega * place).powi(2) + w * w);
        w = 0.5 * (w + (lift / (4.0 * PI * place)).sqrt());
    }
    // 2 rho 2 pi r w^2 = blades rho / 2 c a alpha u^2, with two blades
    assert!((values[2] - w).abs() < 0.01 * w, "{} for {w}", values[2]);
}
