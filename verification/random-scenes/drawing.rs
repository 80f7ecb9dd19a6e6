//! Scenes drawn by lot, as the text of a scene file: any members, joints, springs, drivers, loads, laws, states and functionals between any of
//! their nodes. Joints, springs, drivers and quantities are drawn by the keys of their entries, methods from the list of tables: a new one is
//! drawn by being listed. All else is text with marks, such as `<N/m>` for a number of this unit.

mod happenings;
mod rubbing;

use crate::Lots;
use costate::elements::NodeKind;
use costate::elements::entries::{Form, Part, Type};
use costate::elements::forces::{DAMPERS, SPRINGS};
use costate::elements::joints::{DRIVERS, JOINTS};
use costate::functionals::quantities::QUANTITIES;
use costate::integrators::{DEFAULT_TABLE, Table, tables};
use std::fmt::Write;

/// Design variables: each multiplies all numbers of its kind, the last one all times at which something happens.
pub const VARIABLES: [&str; 7] = ["length", "mass", "stiffness", "damping", "load", "drive", "late"];
const LATE: usize = 6;
/// A design.
pub type Design = [f64; VARIABLES.len()];
/// Where all scenes are drawn.
pub const DRAWN: Design = [1.0; VARIABLES.len()];

/// What a scene is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Motion,
    /// A motion with stops, latches, events and forces that set in.
    Events,
    /// A motion with friction, clutches and contacts.
    Friction,
    /// Of parts on bushings, under loads.
    Equilibrium,
    /// Parts on bushings, or free in space, with states of first order; modes are measured.
    Vibration,
}

impl Kind {
    fn moves(self) -> bool {
        self == Kind::Motion || self.has_events()
    }

    /// Whether steps end where something happens.
    pub fn has_events(self) -> bool {
        matches!(self, Kind::Events | Kind::Friction)
    }
}

/// What tells the program when formulas of time jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jumps {
    /// Nothing: it finds them.
    Found,
    /// Forces of nothing that step there, by numbers that hold for this design alone: steps end there in any case, for a reference.
    Given,
}

/// Units of length, mass and time in which the numbers of a scene are of the order of 1 [m, kg, s].
#[derive(Clone, Copy)]
pub struct Units([f64; 3]);

impl Units {
    /// The size that a quantity of a unit such as "N m/rad" has.
    pub fn size(&self, unit: &str) -> f64 {
        let [m, kg, s] = self.0;
        let of = |word: &str| -> f64 {
            let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
            let own = match name {
                "m" => m,
                "kg" => kg,
                "s" => s,
                "N" => kg * m / (s * s),
                "J" => kg * m * m / (s * s),
                "W" => kg * m * m / (s * s * s),
                _ => 1.0,
            };
            own.powi(word[name.len()..].parse().unwrap_or(1))
        };
        let side = |side: &str| side.split([' ', '(', ')', '^']).map(of).product::<f64>();
        let (over, under) = unit.split_once('/').unwrap_or((unit, ""));
        side(over) / side(under)
    }
}

/// A scene.
pub struct Drawn {
    pub text: String,
    pub units: Units,
    /// Number of steps, and the tolerance by which they are chosen instead.
    pub steps: usize,
    pub tolerance: Option<f64>,
    /// Order of its method.
    pub order: usize,
}

/// The variable that multiplies numbers of a unit.
fn variable(unit: &str) -> &'static str {
    match unit {
        "m" => "length",
        "s" => "late",
        "N/m" | "N m/rad" | "N/m2" => "stiffness",
        "N" | "N m" => "load",
        unit if unit.starts_with("kg") => "mass",
        unit if unit.starts_with("N ") => "damping",
        _ => "drive",
    }
}

/// A vector in units of length.
type Place3 = [f64; 3];

fn sum(a: Place3, b: Place3, share: f64) -> Place3 {
    std::array::from_fn(|i| a[i] + share * b[i])
}

/// A node that joints and forces may hold.
#[derive(Clone, PartialEq)]
struct Place {
    name: String,
    at: Place3,
    has_axes: bool,
    /// In how many ways joints let it move, its holders with it.
    freedom: i32,
}

/// Of what bends: enough for any loop.
const BENDS: i32 = 100;

/// In how many ways two bodies, or a body and a point, move against each other on a joint.
fn freedom_on(joint: &str, of_bodies: bool) -> i32 {
    let turning = if of_bodies { 3 } else { 0 };
    match joint {
        "fixed" | "rigid_link" => 0,
        "revolute" | "prismatic" | "helical" => 1,
        "cylindrical" | "universal" => 2,
        "spherical" => turning,
        "planar" => 3,
        "point_on_line" => turning + 1,
        "point_in_plane" | "distance" => turning + 2,
        _ => 1,
    }
}

/// Where a joint stands: its point and two directions at right angles.
#[derive(Clone)]
struct Geometry {
    point: Place3,
    axes: [Place3; 2],
}

struct Joint {
    name: String,
    form: &'static str,
    ends: [Place; 2],
    geometry: Geometry,
}

/// A scene that grows.
struct Growing {
    lots: Lots,
    text: String,
    units: Units,
    /// Duration \[s\].
    end: f64,
    kind: Kind,
    x: Design,
    jumps: Jumps,
    /// Nothing holds it to the ground.
    is_free: bool,
    /// It has beams and cables, and begins at rest: velocities of their ends alone would stretch them within a step.
    is_flexible: bool,
    /// It is a chain of hinges.
    is_chain: bool,
    /// Steps end where formulas pass from one piece to another.
    is_locating: bool,
    /// The ground first.
    places: Vec<Place>,
    joints: Vec<Joint>,
    angles: Vec<String>,
    coordinates: Vec<String>,
    beams: Vec<String>,
    loops: i32,
    /// Names, what formulas know of them, and units.
    states: Vec<[String; 3]>,
    named: usize,
    /// When formulas of time jump or bend \[s\].
    times: Vec<f64>,
}

/// Formulas of time of a unit U, the first ones smooth.
const OF_TIME: [&str; 9] = [
    "<U> * sin(<rate> * t) + <U> * t / <end>",
    "<U> * cos(<rate> * t)",
    "if_less(t, <time>, <U>, <U>)",
    "if_less(<time>, t, <U> * sin(<rate> * t), 0)",
    "<U> * max(0, t - <time>) / <end>",
    "<U> * abs(t - <time>) / <end> + <U>",
    "<U> * min(t, <time>) / <end>",
    "if_less(t, <time>, <U>, if_less(t, <time>, <U>, <U>))",
    "if_less(t, <time>, <U>, <U>) + <U> * max(0, t - <time>) / <end>",
];
/// Functions of time of a unit U, the first ones smooth and at rest at the start, as drivers must be.
const SIGNALS: [&str; 8] = [
    "{ type = \"smooth_ramp\", to = \"<U>\", duration = \"<moment> * late\" }",
    "{ type = \"smooth_ramp\", to = \"<U>\", start = \"<moment> * late\", duration = \"<moment> * late\" }",
    "{ type = \"sine\", amplitude = \"<U>\", angular_frequency = <rate>, smooth_start = \"<moment> * late\" }",
    "{ type = \"sine\", offset = \"<U>\", amplitude = \"<U>\", angular_frequency = <rate>, phase = 0.7 }",
    "{ type = \"step\", before = \"<U>\", after = \"<U>\", at = <moment> }",
    "{ type = \"table\", times = [0, <early>, <moment>], values = [\"<U>\", \"<U>\", \"<U>\"], interpolation = \"<way>\" }",
    "{ type = \"formula\", value = \"<of time>\"  }",
    "{ type = \"formula\", value = \"<of time>\"  }",
];
const DRIVING: usize = 3;
/// Forces F or moments that pull a stretch s of a size S back, with a stiffness K and a damping C.
const LAWS: [&str; 9] = [
    "\"<K> * s + <C> * v\"",
    "\"<K> * s + <K> * s^3 / S^2\"",
    "\"<K> * s + <F> * tanh(v / (0.3 * S / <size s>))\"",
    "\"<K> * s + <C> * v + <F> * cos(<rate> * t)\"",
    "\"<K> * max(0, s - <share> * S) + <C> * v\"",
    "\"if_less(s, <share> * S, 0, <K> * (s - <share> * S)) + <C> * v\"",
    "\"<K> * s + <F> * if_less(v, 0, -1, 1)\"",
    "\"<K> * abs(s - <share> * S) + <C> * v\"",
    "{ type = \"table\", points = [\"-S\", \"-0.4 * S\", \"0.5 * S\", \"1.2 * S\"], values = [\"-<K> * S\", \"-0.3 * <K> * S\", \"0.5 * <K> * S\", \"<K> * S\"], interpolation = \"<way>\" }",
];
/// How many of them are smooth.
const SMOOTH: usize = 4;
/// Forces on a node p.
const FORCES: [&str; 7] = [
    "-0.5 * <positive N> * norm(p.velocity) * p.velocity / <size m/s>^2",
    "-<positive N> * p.velocity / <size m/s>",
    "[<N> * max(0, -p.position.z) / <size m>, 0, 0]",
    "[0, <N> * if_less(p.position.x, 0.2 * <size m>, 1, 0), 0]",
    "(<of time>) * [0.3, -0.5, 0.6]",
    "(<of time>) * [-0.3, 0.5, 0.6]",
    "[<N> * curve(p.position.x / <size m>), 0, <N> * curve(p.velocity.z / <size m/s>)]",
];
/// What is measured of a node p, with units.
const FORMULAS: [[&str; 2]; 5] = [
    ["norm(p.velocity)^2", "m2/s2"],
    ["p.position.x * p.position.y", "m2"],
    ["dot(p.velocity, p.position)", "m2/s"],
    ["max(0, p.position.z)", "m"],
    ["sin(p.position.z / <size m>)", "-"],
];

/// The scene of a seed, as it stands at a design.
pub fn draw(seed: u64, kind: Kind, x: &Design, jumps: Jumps) -> Drawn {
    let mut lots = Lots::new(seed, 7);
    let units = Units([lots.size(1e-2, 1e2), lots.size(1e-3, 1e3), lots.size(1e-2, 1e1)]);
    let end = if kind == Kind::Equilibrium { 1.0 } else { round(lots.number(0.5, 2.5) * units.size("s")) };
    let has_events = kind.has_events();
    // what stays at a stop lets go by the forces at the ends of steps
    let may_stop = |own: &Table| !has_events || own.stiffly_accurate && own.variational.is_none();
    let methods: Vec<_> = tables().into_iter().filter(|table| !table.is_static() && may_stop(table)).collect();
    let mut method = &methods[lots.below(methods.len())];
    if has_events && lots.happens(0.5) {
        method = methods.iter().find(|own| own.name == DEFAULT_TABLE).unwrap_or(method);
    }
    // friction is not there at position level
    let level = if kind == Kind::Friction { "acceleration" } else { lots.pick(&["position", "acceleration"]) };
    let may_choose = kind.moves() && method.embedded.is_some() && lots.happens(0.3);
    let tolerance = may_choose.then(|| round(lots.size(1e-7, 1e-3)));
    let steps = match kind {
        Kind::Motion => lots.pick(&[20, 30, 40, 60, 80]),
        Kind::Events | Kind::Friction => lots.pick(&[40, 60, 100]),
        Kind::Equilibrium => lots.pick(&[5, 10, 20]),
        Kind::Vibration => 2,
    };
    let is_free = kind == Kind::Vibration && lots.happens(0.5);
    let is_flexible = !kind.moves() || lots.happens(0.5);
    let [is_chain, is_locating] = [0.4, 0.6].map(|odds| has_events && lots.happens(odds));
    let places = vec![Place { name: "ground".into(), at: [0.0; 3], has_axes: true, freedom: 0 }];
    let (joints, angles, coordinates, beams, states, times) = Default::default();
    let text = String::new();
    let mut growing = Growing {
        lots,
        text,
        units,
        end,
        kind,
        x: *x,
        jumps,
        is_free,
        is_flexible,
        is_chain,
        is_locating,
        places,
        joints,
        angles,
        coordinates,
        beams,
        loops: 0,
        states,
        named: 0,
        times,
    };
    growing.line("version = 1");
    if is_chain {
        let down = growing.lots.number(-10.0, -3.0);
        let down = growing.formula(down, "m/s2");
        growing.line(&format!("gravity = [0, 0, \"{down}\"]"));
    } else if kind != Kind::Vibration && growing.lots.happens(0.8) {
        growing.line("gravity = [\"<m/s2>\", \"<m/s2>\", \"<m/s2>\"]");
    }
    growing.line("[variable]");
    for (name, x) in VARIABLES.iter().zip(x) {
        growing.line(&format!("{name} = {{ initial = {x:?}, bounds = [0.5, 2] }}"));
    }
    growing.line(&format!("[settings]\nend = {end:?}"));
    let level = if method.name == "variational" { String::new() } else { format!("constraint_level = \"{level}\"\n") };
    match kind {
        Kind::Motion | Kind::Events | Kind::Friction => {
            growing.line(&format!("method = \"{}\"\n{level}project_start = true", method.name))
        }
        Kind::Equilibrium => growing.line("method = \"static\""),
        Kind::Vibration if !is_free => growing.line("start = \"equilibrium\""),
        Kind::Vibration => {}
    }
    growing.line(&tolerance.map_or(format!("steps = {steps}"), |tolerance| format!("tolerance = {tolerance:?}")));
    if growing.lots.happens(0.7) {
        growing.line("drop_redundant = true");
    }
    if is_locating {
        growing.line("locate = true");
    }
    growing.grow();
    Drawn { text: growing.text, units, steps, tolerance, order: method.order }
}

/// With as many digits as a file would have.
fn round(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn list(values: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", values.into_iter().collect::<Vec<_>>().join(", "))
}

/// The form of this name.
fn form_of<L: ?Sized>(parts: &'static [Part<L>], name: &str) -> Form {
    let listed = parts.iter().find(|part| part.form.name == name);
    listed.map(|part| part.form).unwrap_or_else(|| unreachable!("{name} is listed"))
}

impl Growing {
    /// Adds lines with what their marks stand for.
    fn line(&mut self, lines: &str) {
        let lines = self.fill(lines);
        self.text += lines.trim_end();
        self.text.push('\n');
    }

    /// An entry of a list by its keys; its name.
    fn add(&mut self, section: &str, kind: &str, keys: &str) -> String {
        self.named += 1;
        let name = format!("{kind} {}", self.named);
        self.line(&format!("\n[[{section}]]\nname = \"{name}\"\n{keys}"));
        name
    }

    /// A text with what its marks stand for.
    fn fill(&mut self, text: &str) -> String {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, behind)) = rest.split_once('<') {
            let Some((mark, behind)) = behind.split_once('>') else { break };
            filled += before;
            filled += &self.of_mark(mark);
            rest = behind;
        }
        filled + rest
    }

    fn of_mark(&mut self, mark: &str) -> String {
        let units = self.units;
        match mark {
            "end" => format!("{:?}", self.end),
            "rate" => format!("{:?}", round(self.lots.number(0.5, 6.0) / units.size("s"))),
            "share" => format!("{:.4}", self.lots.number(0.0, 0.3)),
            "early" => format!("{:?}", round(self.lots.number(0.05, 0.15) * self.end)),
            "moment" => format!("{:?}", round(self.lots.number(0.2, 0.85) * self.end)),
            "time" => {
                let time = round(self.lots.number(0.2, 0.85) * self.end);
                self.times.push(time);
                format!("{time:?} * late")
            }
            "axis" => format!("{:?}", self.lots.direction()),
            "way" => self.lots.pick(&["monotone", "smooth", "lines", "steps"]).into(),
            "of time" => {
                let text = self.lots.pick(&OF_TIME).replace("<U>", "<N>");
                self.fill(&text)
            }
            mark => match mark.split_once(' ') {
                Some(("size", unit)) => format!("{:?}", round(units.size(unit))),
                Some(("positive", unit)) => {
                    let amount = self.amount(unit).abs();
                    self.formula(amount, unit)
                }
                _ => {
                    let amount = self.amount(mark);
                    self.formula(amount, mark)
                }
            },
        }
    }

    /// The formula of a number, given as a multiple of what is usual in its unit.
    fn formula(&self, value: f64, unit: &str) -> String {
        // bodies are smaller than their distances
        let turned = if unit.starts_with("N m") { 0.3 } else { 1.0 };
        let number = round(value * self.units.size(unit) * turned);
        let by = variable(unit);
        if number < 0.0 { format!("({number:?} * {by})") } else { format!("{number:?} * {by}") }
    }
    fn vector(&self, at: Place3) -> String {
        list(at.map(|value| format!("\"{}\"", self.formula(value, "m"))))
    }
    /// A number that is usual in a unit.
    fn amount(&mut self, unit: &str) -> f64 {
        match variable(unit) {
            // what stands moves by a tenth of its size under a load: with less it folds up, and nobody builds that
            "stiffness" if self.kind == Kind::Equilibrium => self.lots.size(20.0, 600.0),
            "stiffness" => self.lots.size(0.1, 30.0),
            // what vibrates is damped little
            "damping" if self.kind == Kind::Vibration => self.lots.size(1e-3, 0.1),
            "damping" => self.lots.size(0.01, 1.0),
            "mass" => self.lots.size(0.3, 3.0),
            "load" => self.lots.number(-2.0, 2.0),
            "length" => self.lots.number(0.2, 1.0),
            _ => self.lots.number(-1.0, 1.0),
        }
    }

    /// A function of time, as a table of a file.
    fn signal(&mut self, unit: &str, drives: bool) -> String {
        let text = self.lots.pick(if drives { &SIGNALS[..DRIVING] } else { &SIGNALS });
        let text = text.replace("<of time>", self.lots.pick(&OF_TIME)).replace("<U>", &format!("<{unit}>"));
        self.fill(&text)
    }

    /// Events stand alone: elsewhere laws in pieces are, too.
    fn is_smooth(&self) -> bool {
        self.kind.has_events() && !self.is_locating
    }

    /// A force that pulls a stretch back, by formula or table.
    fn law(&mut self, unit: &str) -> String {
        let (stiffness, damping, size) = match unit {
            "N" => ("<N/m>", "<N s/m>", self.units.size("m")),
            _ => ("<N m/rad>", "<N m s/rad>", 1.0),
        };
        let laws = if self.is_smooth() { &LAWS[..SMOOTH] } else { &LAWS[..] };
        let text = self.lots.pick(laws).replace("<K>", stiffness).replace("<C>", damping);
        let text = text.replace("<F>", &format!("<{unit}>")).replace('S', &format!("{:?}", round(size)));
        self.fill(&text)
    }

    fn geometry(&mut self, point: Place3) -> Geometry {
        let axis = self.lots.direction();
        loop {
            let other = self.lots.direction();
            let along: f64 = (0..3).map(|i| axis[i] * other[i]).sum();
            let rest = sum(other, axis, -along);
            let length = rest.iter().map(|own| own * own).sum::<f64>().sqrt();
            if length > 0.3 {
                return Geometry { point, axes: [axis, rest.map(|own| own / length)] };
            }
        }
    }

    /// A part by the keys of its form: places and directions are those given, numbers are drawn by their units.
    fn part(&mut self, section: &str, form: &Form, nodes: [&Place; 2], geometry: &Geometry, more: &str) -> String {
        let mut keys = format!("type = \"{}\"\n", form.name);
        let mut directions = geometry.axes.into_iter();
        for key in form.keys {
            let is_number = matches!(key.takes, Type::Number(..) | Type::Numbers(..));
            // what vibrates about its start rests there
            if self.is_free && key.name.starts_with("rest_") {
                continue;
            }
            let value = match key.takes {
                _ if is_number && !key.is_needed && self.lots.happens(0.3) => continue,
                Type::List(Type::Node, ..) => list(nodes.map(|place| format!("\"{}\"", place.name))),
                Type::Node => format!("\"{}\"", nodes[1].name),
                // what has no axes is held where it stands
                Type::Vector("m") if key.name == "point" && !nodes[1].has_axes => continue,
                Type::Vector("m") => self.vector(geometry.point),
                Type::Vector(_) => format!("{:?}", directions.next().unwrap_or(geometry.axes[0])),
                Type::List(Type::Vector(_), ..) => list(nodes.map(|place| {
                    let beside = sum(place.at, self.lots.place(), 0.1);
                    self.vector(if place.has_axes { beside } else { place.at })
                })),
                Type::Number(unit, _) => format!("\"<{unit}>\""),
                Type::Numbers(counts, units, _) => {
                    let units: Vec<&str> = units.split(", ").collect();
                    list((0..counts[0]).map(|place| format!("\"<{}>\"", units[place * units.len() / counts[0]])))
                }
                Type::Law(unit, _) => self.law(unit),
                Type::Function(unit, _) => self.signal(unit, true),
                _ => continue,
            };
            _ = writeln!(keys, "{} = {value}", key.name);
        }
        self.add(section, form.name, &(keys + more))
    }

    fn any(&mut self) -> Place {
        let place = self.lots.below(self.places.len());
        self.places[place].clone()
    }
    /// One that moves, if any does.
    fn moving(&mut self) -> Place {
        let free: Vec<Place> = self.places.iter().skip(1).filter(|place| place.freedom > 0).cloned().collect();
        let any = if free.is_empty() { &self.places[1..] } else { &free[..] };
        let place = self.lots.below(any.len());
        any[place].clone()
    }
    /// What may hold a new part: of what is free the ground is nothing.
    fn holder(&mut self) -> Option<Place> {
        let may_hold = |place: &&Place| place.has_axes && !(self.is_free && place.name == "ground");
        let holders: Vec<Place> = self.places.iter().filter(may_hold).cloned().collect();
        (!holders.is_empty()).then(|| holders[self.lots.below(holders.len())].clone())
    }
    /// A node, or a point of it, as formulas name it.
    fn named_node(&mut self, place: &Place) -> String {
        if place.has_axes && self.lots.happens(0.5) {
            let point = sum(place.at, self.lots.place(), 0.2);
            return format!("{{ on = \"{}\", point = {} }}", place.name, self.vector(point));
        }
        format!("\"{}\"", place.name)
    }

    /// Whether a part begins with a velocity.
    fn moves(&mut self) -> bool {
        self.kind.moves() && !self.is_flexible && self.lots.happens(0.5)
    }

    fn body(&mut self) {
        let (at, holder) = (self.lots.place(), self.holder());
        let (mass, sides): (f64, Place3) = (self.amount("kg"), std::array::from_fn(|_| self.lots.number(0.5, 1.5)));
        let moment = |i: usize, j: usize| mass * (sides[i].powi(2) + sides[j].powi(2)) / 12.0;
        let moments = [moment(1, 2), moment(0, 2), moment(0, 1)];
        let inertia = list(moments.map(|own| format!("\"{} * length^2\"", self.formula(own, "kg m2"))));
        let mut keys =
            format!("position = {}\nmass = \"{}\"\ninertia = {inertia}\n", self.vector(at), self.formula(mass, "kg"));
        if self.lots.happens(0.5) {
            keys += "orientation = { type = \"angle\", axis = <axis>, angle = 0.7 }\n";
        }
        if self.lots.happens(0.5) {
            let centre = sum([0.0; 3], self.lots.place(), 0.2);
            _ = writeln!(keys, "mass_centre = {}", self.vector(centre));
        }
        let kind = self.lots.pick(&["body", "body", "body", "natural body"]);
        if kind == "natural body" {
            keys += "coordinates = \"natural\"\n";
        }
        if self.moves() {
            keys += "velocity = [\"<m/s>\", \"<m/s>\", 0]\nangular_velocity = [0, \"<rad/s>\", \"<rad/s>\"]\n";
        }
        let mut own = Place { name: self.add("body", kind, &keys), at, has_axes: true, freedom: 6 };
        if let Some(holder) = holder {
            own.freedom = self.hold([&holder, &own]);
        }
        self.places.push(own);
    }

    /// Holds a body by another: by a joint of the list, or by a bushing where it must stand. Returns in how many ways it moves.
    fn hold(&mut self, [a, b]: [&Place; 2]) -> i32 {
        let geometry = self.geometry(sum(a.at, sum(b.at, a.at, -1.0), 0.5));
        if !self.kind.moves() {
            self.part("spring", &form_of(SPRINGS, "bushing"), [a, b], &geometry, "");
            return 6;
        }
        let of_bodies = |part: &&costate::elements::entries::JointPart| part.example.0 == [NodeKind::Body; 2];
        let forms: Vec<Form> = JOINTS.iter().filter(of_bodies).map(|part| part.form).collect();
        // half of all are hinges and slides, which springs and drivers go with
        let form = match self.lots.below(20) {
            0 => return 6,
            1..=6 => form_of(JOINTS, "revolute"),
            7..=9 => form_of(JOINTS, "prismatic"),
            _ => self.lots.pick(&forms),
        };
        // nobody simulates what cannot move
        let is_locked = a.freedom + freedom_on(form.name, true) == 0;
        let form = if is_locked { form_of(JOINTS, "revolute") } else { form };
        let freedom = a.freedom + freedom_on(form.name, true);
        let ends = if self.lots.happens(0.2) { [b, a] } else { [a, b] };
        self.join(&form, ends, &geometry);
        let others = match form.name {
            "revolute" => ["torsion", "torsion_law", "rotation"],
            "prismatic" => ["slide", "slide_law", "translation"],
            _ => return freedom,
        };
        match self.lots.below(6) {
            place @ 0..=1 => drop(self.part("spring", &form_of(SPRINGS, others[place]), ends, &geometry, "")),
            // what a driver alone moves reaches no stop
            2 if !self.kind.has_events() || a.freedom > 0 => {
                let (form, [a, b]) = (form_of(DRIVERS, others[2]), ends.map(Place::clone));
                let name = self.part("driver", &form, ends, &geometry, "");
                self.joints.push(Joint { name, form: form.name, ends: [a, b], geometry });
                // what is driven moves, and closes no loop
                return freedom.max(2) - 1;
            }
            3 if form.name == "revolute" => self.angle(ends, geometry.axes[0]),
            _ => {}
        }
        freedom
    }

    fn join(&mut self, form: &Form, ends: [&Place; 2], geometry: &Geometry) {
        let name = self.part("joint", form, ends, geometry, "");
        self.joints.push(Joint { name, form: form.name, ends: ends.map(Place::clone), geometry: geometry.clone() });
    }

    /// An angle that is counted, on a gear with another or with a spring.
    fn angle(&mut self, ends: [&Place; 2], axis: Place3) {
        let between = list(ends.map(|place| format!("\"{}\"", place.name)));
        let name = self.add("joint_angle", "angle", &format!("between = {between}\naxis = {axis:?}"));
        match self.angles.last() {
            Some(other) if self.lots.happens(0.5) => {
                let between = format!("between = [\"{other}\", \"{name}\"]");
                self.add("joint", "gear", &format!("type = \"gear\"\n{between}\nradii = [\"<m>\", \"<m>\"]"));
            }
            _ => {
                let moment = self.law("N m");
                self.add("spring", "angle law", &format!("type = \"angle_law\"\non = \"{name}\"\nmoment = {moment}"));
            }
        }
        self.angles.push(name);
    }

    fn point(&mut self) {
        let (at, other, holder) = (self.lots.place(), self.any(), self.holder());
        // what has no mass is carried by a body
        let is_carried = self.kind.moves() && other.has_axes && self.lots.happens(0.2);
        let mass = if is_carried { "" } else { "mass = \"<kg>\"\n" };
        let moves = !is_carried && self.moves();
        let velocity = if moves { "velocity = [\"<m/s>\", 0, \"<m/s>\"]\n" } else { "" };
        let name = self.add("point", "point", &format!("position = {}\n{mass}{velocity}", self.vector(at)));
        let (mut own, geometry) = (Place { name, at, has_axes: false, freedom: 3 }, self.geometry(at));
        if !self.kind.moves() {
            for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
                let along = Geometry { point: at, axes: [axis; 2] };
                holder.iter().for_each(|holder| {
                    self.part("spring", &form_of(SPRINGS, "slide"), [holder, &own], &along, "");
                });
            }
        } else if is_carried {
            self.join(&form_of(JOINTS, "spherical"), [&other, &own], &geometry);
            own.freedom = other.freedom;
            let far = self.any();
            self.spring([&far, &own]);
        } else if self.lots.happens(0.3) {
            self.spring([&other, &own]);
        } else {
            let of_bodies = ["point_on_line", "point_in_plane", "spherical", "distance"];
            let form = if other.has_axes { self.lots.pick(&of_bodies) } else { "distance" };
            let is_locked = other.freedom + freedom_on(form, false) == 0;
            let form = if is_locked { "distance" } else { form };
            own.freedom = other.freedom + freedom_on(form, false);
            self.join(&form_of(JOINTS, form), [&other, &own], &geometry);
        }
        self.places.push(own);
    }

    /// Along the line between two places.
    fn spring(&mut self, ends: [&Place; 2]) {
        let geometry = self.geometry(ends[0].at);
        let form = self.lots.pick(&["line", "line_law", "line_law"]);
        self.part("spring", &form_of(SPRINGS, form), ends, &geometry, "");
        if self.lots.happens(0.4) {
            let form = self.lots.pick(DAMPERS).form;
            self.part("damper", &form, ends, &geometry, "");
        }
    }

    /// A beam on a body, clamped, or joined; or a cable. A load at its end bends it by a fifth of its length at most, and its lowest frequency is a
    /// few times that of what hangs on springs.
    fn flexible(&mut self, kind: &str) {
        let (is_beam, share, free) = (kind == "beam", self.lots.number(0.5, 1.0), self.lots.place());
        let [height, density, frequency] =
            [(0.03, 0.08), (2.0, 6.0), (12.0, 30.0)].map(|(from, to)| self.lots.size(from, to));
        let height = height * share;
        let young = density * frequency.powi(2) * share.powi(4) / height.powi(4);
        let [young, density] =
            [(young, "N/m2"), (density / height.powi(2), "kg/m3")].map(|(own, unit)| self.formula(own, unit));
        let (side, wall) = (self.formula(height, "m"), self.formula(0.2 * height, "m"));
        let shape = self.lots.pick(&["rectangle\"\nwidth = W\nheight", "tube\"\nwall = T\ndiameter", "circle\"\ndiameter"]);
        let shape = shape.replace('W', &format!("\"1.4 * {side}\"")).replace('T', &format!("\"{wall}\""));
        let is_damped = self.lots.happens(0.5);
        let damping = if is_damped { "damping = \"1e-3 * <size s> * damping\"" } else { "" };
        let section = format!("section_{}", self.named);
        self.line(&format!(
            "\n[material.m_{section}]\nyoung = \"{young}\"\npoisson = 0.3\ndensity = \"{density}\"\n\n\
             [section.{section}]\ntype = \"{shape} = \"{side}\"\nmaterial = \"m_{section}\"\n{damping}"
        ));
        let holder = self.holder().filter(|holder| is_beam && !holder.name.starts_with("natural"));
        let holder = holder.filter(|_| self.lots.happens(0.5));
        let from = holder.as_ref().map_or(free, |holder| holder.at);
        let Geometry { axes: [along, across], .. } = self.geometry(from);
        let to = sum(from, along, share);
        let elements = self.lots.pick(&[1, 2]);
        let mut keys = format!(
            "from = {}\nto = {}\nelements = {elements}\nsection = \"{section}\"\n",
            self.vector(from),
            self.vector(to)
        );
        let is_held = holder.is_some();
        match holder.filter(|holder| holder.name != "ground") {
            Some(holder) => _ = writeln!(keys, "start_node = \"{}\"", holder.name),
            None if is_held || !self.kind.moves() || self.lots.happens(0.7) => keys += "clamped = [\"start\"]\n",
            None => {}
        }
        if is_beam {
            _ = writeln!(keys, "second_axis = {across:?}");
        } else if !is_damped && self.lots.happens(0.5) {
            keys += "strains = \"small\"\n";
        }
        let name = self.add(kind, kind, &keys);
        self.places.push(Place { name: format!("{name}.end"), at: to, has_axes: is_beam, freedom: BENDS });
        if is_beam {
            self.beams.push(name);
        }
    }

    /// A ball on the ground.
    fn roller(&mut self) {
        let ([x, y, _], radius, mass) = (self.lots.place(), self.lots.number(0.1, 0.5), self.amount("kg"));
        let moment = format!("\"{} * length^2\"", self.formula(0.4 * mass * radius * radius, "kg m2"));
        let (at, mass) = ([x, y, radius], self.formula(mass, "kg"));
        let inertia = list([(); 3].map(|()| moment.clone()));
        let keys = format!("position = {}\nmass = \"{mass}\"\ninertia = {inertia}", self.vector(at));
        let own = Place { name: self.add("body", "ball", &keys), at, has_axes: true, freedom: 3 };
        let radius = self.formula(radius, "m");
        let keys = format!("between = [\"ground\", \"{}\"]\nnormal = [0, 0, 1]\nradius = \"{radius}\"", own.name);
        self.add("joint", "rolling", &format!("type = \"rolling_sphere\"\n{keys}"));
        self.places.push(own);
    }

    fn load(&mut self) {
        let on = self.moving();
        let (name, kind) = (&on.name, self.lots.below(4));
        match kind {
            0 => {
                let size = self.signal("N", false);
                let frame = if on.has_axes { self.lots.pick(&["world", "body"]) } else { "world" };
                self.add(
                    "force",
                    "force",
                    &format!("on = \"{name}\"\nframe = \"{frame}\"\ndirection = <axis>\nsize = {size}"),
                );
            }
            1 if on.has_axes => {
                let size = self.signal("N m", false);
                self.add("torque", "torque", &format!("on = \"{name}\"\naxis = <axis>\nsize = {size}"));
            }
            _ => {
                let (node, force) =
                    (self.named_node(&on), self.lots.pick(if self.is_smooth() { &FORCES[..2] } else { &FORCES[..] }));
                let keys = format!("nodes = {{ p = {node} }}\nforce = {{ p = \"{force}\" }}");
                self.add("element", "own load", &keys);
            }
        }
    }

    /// A state of first order that acts on a node.
    fn state(&mut self) {
        let seen = self.moving();
        let (node, place) = (self.named_node(&seen), self.lots.below(3));
        let (axis, lag) = (["x", "y", "z"][place], round(self.lots.size(0.05, 1.0) * self.units.size("s")));
        let is_motion = self.kind.moves();
        let of_time = if is_motion && self.lots.happens(0.6) { self.lots.pick(&OF_TIME) } else { "0" };
        let [rates, places] = ["<m/s>", "<m>"].map(|unit| of_time.replace("<U>", unit));
        let rest = if is_motion { "<m/s>" } else { "0" };
        // without this gain the integral stays at any value: a mode at rest
        let integral = if is_motion { "" } else { "integral = \"<N/m> / <size s>\"\n" };
        let (kind, keys, force, value, unit) = match self.lots.below(if self.is_free { 2 } else { 3 }) {
            0 => (
                "lag",
                format!("input = \"p.velocity.{axis} + {rates}\"\ntime_constant = \"{lag:?} * late\"\ninitial = \"{rest}\""),
                "-s.value * <N s/m>",
                "s.value",
                "m/s",
            ),
            1 => (
                "formula",
                format!(
                    "initial = {{ z = \"{rest}\" }}\nrate = {{ z = \"(p.velocity.{axis} - z + {rates}) / ({lag:?} * late)\" }}\n\
                     output = {{ push = \"-z * <N s/m>\" }}"
                ),
                "s.push",
                "s.z",
                "m/s",
            ),
            _ => (
                "pid",
                format!(
                    "measured = \"p.position.{axis}\"\nset_point = \"0.3 * <size m> + {places}\"\nproportional = \"<N/m>\"\n\
                     {integral}derivative = \"<N s/m>\"\nfilter_time = {lag:?}"
                ),
                "s.output",
                "s.output",
                "N",
            ),
        };
        let keys = format!("type = \"{kind}\"\nnodes = {{ p = {node} }}\n{keys}");
        let name = self.add("state", kind, &keys);
        let mut components = ["0"; 3];
        components[place] = force;
        let keys = format!(
            "nodes = {{ p = \"{}\", s = \"{name}\" }}\nforce = {{ p = \"[{}]\" }}",
            seen.name,
            components.join(", ")
        );
        self.add("element", "acts", &keys);
        self.states.push([name, value.into(), unit.into()]);
    }

    fn functional(&mut self) {
        let (on, is_motion) = (self.moving(), self.kind.moves());
        // over a load an integral is a sum of as many terms as there are steps, which nobody asks for
        let over = self.lots.pick(&["terminal", "terminal", "integral", "maximum"]);
        let over = if is_motion { over } else { "terminal" };
        let formula = |own: &mut Self, node: String, [value, unit]: [&str; 2]| {
            let size = own.units.size(unit) * own.lots.size(0.3, 3.0);
            let over = match over {
                "maximum" => format!("{{ aggregate = \"smooth_maximum\", sharpness = 3, size = {:?} }}", round(size)),
                over => format!("\"{over}\""),
            };
            let keys = format!("nodes = {{ p = {node} }}\nvalue = \"{value}\"\nunit = \"{unit}\"\nover = {over}");
            own.add("functional", "functional", &format!("type = \"formula\"\n{keys}"));
        };
        let over = if over == "maximum" { "integral" } else { over };
        let over = format!("over = \"{over}\"");
        let joint = (!self.joints.is_empty()).then(|| self.lots.below(self.joints.len()));
        match (self.lots.below(9), joint) {
            (0, _) if is_motion => _ = self.add("functional", "functional", &format!("type = \"power\"\n{over}")),
            // laws by forces state no energy
            (1, _) if is_motion && !self.text.contains("_law\"") => {
                self.add("functional", "functional", &format!("type = \"energy\"\n{over}"));
            }
            (2 | 3, Some(joint)) => {
                let (kind, joint) = (self.lots.pick(&["reaction_norm", "joint_power"]), &self.joints[joint].name);
                let keys = format!("type = \"{kind}\"\njoint = \"{joint}\"\n{over}");
                self.add("functional", "functional", &keys);
            }
            (4, _) if !self.states.is_empty() => {
                let [name, value, unit] = self.states[self.lots.below(self.states.len())].clone();
                formula(self, format!("\"{name}\""), [&value.replace("s.", "p."), &unit]);
            }
            (5, _) if !self.beams.is_empty() => {
                let (beam, of) = (self.lots.below(self.beams.len()), self.lots.pick(&["axial", "bending_2", "torsion"]));
                let keys = format!("beam = \"{}\"\nshare = 0.5\ncomponent = \"{of}\"\n{over}", self.beams[beam]);
                self.add("functional", "functional", &format!("type = \"section_force\"\n{keys}"));
            }
            (6, _) => {
                let (node, own) = (self.named_node(&on), self.lots.pick(&FORMULAS));
                formula(self, node, own);
            }
            _ => {
                let forms: Vec<Form> = QUANTITIES.iter().map(|part| part.form).collect();
                let (form, at) = (self.lots.pick(&forms), self.lots.place());
                let hinge = self.joints.iter().find(|joint| ["revolute", "prismatic"].contains(&joint.form));
                let hinge = hinge.filter(|_| form.name.starts_with("joint"));
                let hinge = hinge.map(|hinge| (hinge.ends.clone(), hinge.geometry.clone()));
                let ground = Place { at: [2.0; 3], ..self.places[0].clone() };
                let (ends, geometry) = hinge.unwrap_or_else(|| ([ground, on], self.geometry(at)));
                let form = match form.name {
                    name if name.starts_with("joint") && ends[0].at == [2.0; 3] => form_of(QUANTITIES, "velocity"),
                    "cable_deflection" => form_of(QUANTITIES, "position"),
                    _ => form,
                };
                self.part("functional", &form, [&ends[0], &ends[1]], &geometry, &over);
            }
        }
    }

    fn grow(&mut self) {
        let is_motion = self.kind.moves();
        if self.is_chain {
            self.chain();
        }
        let members = if self.is_chain { 0 } else { 1 + self.lots.below(4) };
        for _ in 0..members {
            match self.lots.below(14) {
                7 if !self.is_free || self.places.len() > 1 => self.point(),
                8..=11 if self.is_flexible && !self.is_free => self.flexible("beam"),
                12 if self.is_flexible && is_motion => self.flexible("cable"),
                13 if is_motion => self.roller(),
                _ => self.body(),
            }
        }
        // one body alone has no modes behind its rigid motions
        while self.is_free && self.places.len() < 3 {
            self.body();
        }
        if self.kind.has_events() && !self.is_chain && self.lots.happens(0.3) {
            self.coordinate();
        }
        for _ in 0..self.lots.below(3) {
            let (a, b) = (self.any(), self.moving());
            match self.lots.below(3) {
                _ if a == b || !is_motion => {}
                0 if a.freedom + b.freedom - self.loops < 2 => {}
                0 => {
                    // a loop
                    self.loops += 1;
                    let geometry = self.geometry(a.at);
                    self.join(&form_of(JOINTS, "distance"), [&a, &b], &geometry);
                }
                1 if a.has_axes && b.has_axes => {
                    let geometry = self.geometry(a.at);
                    self.part("spring", &form_of(SPRINGS, "bushing"), [&a, &b], &geometry, "");
                }
                _ => self.spring([&a, &b]),
            }
        }
        if self.kind == Kind::Vibration {
            (0..1 + self.lots.below(2)).for_each(|_| self.state());
            // behind the rigid motions of what is free
            let rigid = if self.is_free { 6 } else { 0 };
            for (number, measure) in [1, 2, 3].into_iter().flat_map(|number| [(number, "frequency"), (number, "growth")]) {
                let number = rigid + number;
                self.add("mode", measure, &format!("number = {number}\ndamped = true\nmeasure = \"{measure}\""));
            }
            self.add("functional", "functional", "type = \"mass\"\nover = \"initial\"");
            return;
        }
        (0..1 + self.lots.below(3)).for_each(|_| self.load());
        if is_motion {
            (0..self.lots.pick(&[0, 0, 1, 2])).for_each(|_| self.state());
        }
        (0..2 + self.lots.below(2)).for_each(|_| self.functional());
        if self.text.contains("curve(") {
            let values = "points = [-1.5, -0.4, 0.6, 1.5]\nvalues = [-1, \"-0.2 * drive\", 0.5, \"0.8 * drive\"]";
            self.line(&format!("\n[table.curve]\n{values}\ninterpolation = \"<way>\"\nextrapolation = \"constant\""));
        }
        if self.kind == Kind::Friction {
            self.rubbing();
        }
        if self.kind == Kind::Events || self.kind == Kind::Friction && self.lots.happens(0.3) {
            self.happenings();
        }
        if self.jumps == Jumps::Given {
            // a force of nothing whose steps in time everyone sees
            for time in std::mem::take(&mut self.times) {
                let (on, at) = (&self.places[1].name, time * self.x[LATE]);
                let size = format!("{{ type = \"step\", before = 0, after = 1e-99, at = {at:?} }}");
                let keys = format!("on = \"{on}\"\ndirection = [0, 0, 1]\nsize = {size}");
                self.add("force", "nothing", &keys);
            }
        }
    }
}
