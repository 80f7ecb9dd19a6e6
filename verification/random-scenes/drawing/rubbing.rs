//! What rubs in a drawn motion: joints, clutches and brakes between angles and coordinates, and spheres and points that hit planes.

use super::happenings::{Course, STILL};
use super::{Growing, Place3, round, sum};
use std::fmt::Write;

/// Joints that may have friction.
const RUBBING: [&str; 3] = ["revolute", "prismatic", "point_on_line"];
/// Capacities of clutches between angles, or coordinates, of a force F.
const CAPACITIES: [&str; 3] = ["<positive F>", "<positive F> * (1.2 + sin(<rate> * t))", "<positive F> * exp(-t / <end>)"];

impl Growing {
    /// Friction of joints and of coordinates, then contacts.
    pub(super) fn rubbing(&mut self) {
        let joints = self.joints.iter().filter(|own| RUBBING.contains(&own.form));
        let joints: Vec<_> = joints.map(|own| (own.name.clone(), own.form)).collect();
        for (name, form) in joints {
            if self.lots.happens(0.6) {
                let mut keys = format!("joint = \"{name}\"\n{}", self.coefficients());
                if form == "revolute" {
                    let radius = self.lots.number(0.01, 0.1);
                    _ = writeln!(keys, "radius = \"{}\"", self.formula(radius, "m"));
                }
                if self.lots.happens(0.5) {
                    keys += "preload = \"<positive N>\"\n";
                }
                self.add("friction", "friction", &keys);
            }
        }
        let (angles, coordinates) = (self.angles.clone(), self.coordinates.clone());
        for (between, force) in [(angles, "N m"), (coordinates, "N")] {
            let count = if self.lots.happens(0.3) { 2 } else { 1 };
            if between.len() >= count && self.lots.happens(0.5) {
                let between = between[..count].join("\", \"");
                let mut keys = format!(
                    "between = [\"{between}\"]\ncapacity = \"{}\"\n",
                    self.lots.pick(&CAPACITIES).replace('F', force)
                );
                keys = self.fill(&keys);
                if let (true, Some(capacity)) =
                    (self.lots.happens(0.5), keys.lines().find(|line| line.starts_with("capacity")))
                {
                    keys = format!(
                        "{keys}static = \"1.3 * ({})\"\n",
                        capacity.trim_start_matches("capacity = ").trim_matches('"')
                    );
                }
                self.add("clutch", "clutch", &keys);
            }
        }
        (0..self.lots.below(3)).for_each(|_| self.contact());
    }

    /// Coefficients of sliding and static friction, which a variable multiplies.
    fn coefficients(&mut self) -> String {
        let sliding = round(self.lots.number(0.05, 0.8));
        let more = round(sliding * self.lots.number(1.0, 1.5));
        match self.lots.below(3) {
            0 => format!("sliding = {sliding:?}\n"),
            1 => format!("sliding = \"{sliding:?} * drive\"\n"),
            _ => format!("sliding = \"{sliding:?} * drive\"\nstatic = \"{more:?} * drive\"\n"),
        }
    }

    /// A sphere or a point that hits a plane of the ground, where the motion without it gets.
    fn contact(&mut self) {
        let (on, normal) = (self.moving(), self.lots.direction());
        let time = round(self.lots.number(0.4, 0.9) * self.end);
        let course = Course {
            nodes: format!("a = \"{}\"", on.name),
            formula: format!("dot(a.position, {normal:?})"),
            unit: "m",
            on: None,
        };
        let size = self.units.size("m");
        let Some([start, there]) = self.reached(&[course], time).and_then(|own| own.first().copied()) else { return };
        if (there - start).abs() <= STILL * size {
            return;
        }
        let radius = if on.has_axes { self.lots.number(0.02, 0.3) } else { 0.0 };
        let away = if there > start { -1.0 } else { 1.0 };
        // the centre stops a radius before the plane
        let limit = (start + self.lots.number(0.3, 0.95) * (there - start)) / size - away * radius;
        let at: Place3 = sum([0.0; 3], normal, limit);
        let (kind, keys) = match on.has_axes {
            true => ("sphere", format!("radius = \"{}\"\n", self.formula(radius, "m"))),
            false => ("point", String::new()),
        };
        let shape = self.add("shape", kind, &format!("type = \"{kind}\"\non = \"{}\"\n{keys}", on.name));
        let keys = format!("point = {}\nnormal = {:?}", self.vector(at), normal.map(|own| away * own));
        let plane = self.add("shape", "plane", &format!("type = \"plane\"\non = \"ground\"\n{keys}"));
        let mut keys =
            format!("between = [\"{shape}\", \"{plane}\"]\n{}", self.restitution((there - start).abs() / time, "m"));
        if self.lots.happens(0.7) {
            keys += &self.coefficients();
        }
        self.add("contact", "contact", &keys);
    }
}
