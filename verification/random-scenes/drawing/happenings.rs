//! What happens at instants of a drawn motion: stops, ropes, latches, joints that break, numbers and states that are set, contacts of soft parts,
//! the end of the run. Limits lie where the motion without them gets, so that most are reached.

use super::{DRAWN, Geometry, Growing, Place, form_of, list, round, sum};
use costate::elements::joints::JOINTS;
use costate::prelude::*;
use costate::scenes::{AnyScene, FileScene};
use costate::sensitivity::Forward;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Distances, as shares of the usual size, that count as no motion at all.
pub(super) const STILL: f64 = 1e-3;
/// Steps from which on a run that asks for a hundred is taken for one that does not end.
const MOST_STEPS: usize = 10_000;
/// Potentials of a depth D beyond a limit, in parts of a size S with a stiffness K or a force F.
const SOFT: [&str; 4] = [
    "0.5 * <K> * max(0, D)^2",
    "0.4 * <K> / sqrt(S) * max(0, D)^2.5",
    "if_less(D, 0, 0, 0.5 * <K> * D^2 + 0.1 * <K> * D^3 / S)",
    "<positive F> * max(0, D)",
];
/// Forces against the depth, whose rate is R, with a damping C.
const CONTACTS: [&str; 4] = [
    "<K> * max(0, D) + if_less(D, 0, 0, <C> * R)",
    "<K> / sqrt(S) * max(0, D)^1.5 * (1 + 0.3 * R / V)",
    "0.5 * <K> * (D + abs(D)) + <C> * R",
    "if_less(D, 0, 0, <positive F>) + <C> * R",
];

/// A quantity x of the motion.
pub(super) struct Course {
    /// Its nodes, by the names that its formula gives them.
    pub nodes: String,
    pub formula: String,
    pub unit: &'static str,
    /// The coordinate or angle that it is.
    pub on: Option<String>,
}

/// Where a quantity is at the start, where it gets, and its mean speed.
struct Reach {
    start: f64,
    there: f64,
    speed: f64,
}

impl Growing {
    /// A chain that hangs from the ground, with an angle and its moment at each hinge.
    pub(super) fn chain(&mut self) {
        let (mut below, mut hinge, is_plane) = (self.places[0].clone(), [0.0; 3], self.lots.happens(0.6));
        for link in 0..1 + self.lots.below(3) {
            let (length, lean) = (self.lots.number(0.3, 0.6), self.lots.number(-0.8, 0.8));
            let along = [length * f64::sin(lean), 0.0, -length * f64::cos(lean)];
            let (at, axis) =
                (sum(hinge, along, 0.5), [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]][(!is_plane && link % 2 == 1) as usize]);
            let inertia = list([0.03, 0.04, 0.02].map(|own| format!("\"{} * length^2\"", self.formula(own, "kg m2"))));
            let keys = format!("position = {}\nmass = \"<kg>\"\ninertia = {inertia}", self.vector(at));
            let own = Place { name: self.add("body", "body", &keys), at, has_axes: true, freedom: below.freedom + 1 };
            let geometry = Geometry { point: hinge, axes: [axis, [0.0, 0.0, 1.0]] };
            self.join(&form_of(JOINTS, "revolute"), [&below, &own], &geometry);
            self.angle([&below, &own], axis);
            self.places.push(own.clone());
            (below, hinge) = (own, sum(hinge, along, 1.0));
        }
    }

    /// A coordinate with a mass of its own, on a spring with a node.
    pub(super) fn coordinate(&mut self) {
        let name = self.add("coordinate", "coordinate", "initial = \"<m>\"\nrate = \"<m/s>\"");
        let on = self.moving();
        let node = self.named_node(&on);
        self.add(
            "element",
            "own mass",
            &format!(
                "nodes = {{ c = \"{name}\", p = {node} }}\nkinetic = \"0.5 * <kg> * c.rate^2\"\n\
                 potential = \"0.5 * <N/m> * (c.value - p.position.z)^2\"\nforce = {{ c = \"-<N s/m> * c.rate + <of time>\" }}"
            ),
        );
        self.coordinates.push(name);
    }

    /// Things that happen, and what is measured of them.
    pub(super) fn happenings(&mut self) {
        let mut courses: Vec<Course> =
            if self.is_chain { self.angles.clone().into_iter().map(Course::on).collect() } else { Vec::new() };
        let more = if self.is_chain { self.lots.below(2) } else { 2 + self.lots.below(3) };
        courses.extend((0..more).map(|_| self.course()).collect::<Vec<_>>());
        let time = round(self.lots.number(0.4, 0.9) * self.end);
        // what cannot be run is told by the run itself
        let reached = self.reached(&courses, time).unwrap_or_default();
        let mut timed = Vec::new();
        for (course, [start, there]) in courses.iter().zip(reached) {
            if (there - start).abs() > STILL * self.units.size(course.unit) {
                timed.extend(self.happening(course, &Reach { start, there, speed: (there - start).abs() / time }));
            }
        }
        if self.lots.happens(0.2) {
            let (nodes, what) = self.change("");
            timed.push(self.add("event", "event", &format!("{nodes}at = \"<moment> * late\"\n{what}")));
        }
        // a time is that of what happens
        let happened = self.run(&self.text, |prepared, forward| prepared.analysis().events(forward)).unwrap_or_default();
        timed.retain(|name| happened.iter().any(|event| event.name == *name));
        if !timed.is_empty() && self.lots.happens(0.5) {
            let event = &timed[self.lots.below(timed.len())];
            self.add("functional", "time", &format!("type = \"event_time\"\nevent = \"{event}\"\nover = \"terminal\""));
        }
    }

    fn course(&mut self) -> Course {
        let own: Vec<&String> = self.angles.iter().chain(&self.coordinates).collect();
        if !own.is_empty() && self.lots.happens(0.6) {
            return Course::on(self.lots.pick(&own).clone());
        }
        let (a, b) = (self.moving(), self.any());
        let mut nodes = format!("a = {}", self.named_node(&a));
        let formula = match self.lots.below(5) {
            0..=1 if a != b => {
                nodes += &format!(", b = {}", self.named_node(&b));
                "norm(a.position - b.position)"
            }
            2 => "dot(a.position, <axis>)",
            3 => "a.position.x + 0.3 * <m/s> * t",
            _ => "a.position.z",
        };
        let formula = self.fill(formula);
        Course { nodes, formula, unit: "m", on: None }
    }

    /// Where quantities are at the start and at a time, in the motion as far as it is drawn.
    pub(super) fn reached(&self, courses: &[Course], time: f64) -> Option<Vec<[f64; 2]>> {
        let mut text = self.text.replacen(&format!("end = {:?}", self.end), &format!("end = {time:?}"), 1);
        for (k, Course { nodes, formula, .. }) in courses.iter().enumerate() {
            for over in ["initial", "terminal"] {
                text += &format!(
                    "\n[[functional]]\nname = \"{over} {k}\"\ntype = \"formula\"\nnodes = {{ {nodes} }}\nvalue = \"{formula}\"\nover = \"{over}\"\n"
                );
            }
        }
        let values = self.run(&text, |_, forward| forward.values.clone())?;
        let own = &values[values.len() - 2 * courses.len()..];
        Some(own.chunks(2).map(|own| [own[0], own[1]]).collect())
    }

    /// What a run of a scene tells, if it gets to its end.
    fn run<T>(&self, text: &str, take: impl Fn(&Prepared, &Forward) -> T) -> Option<T> {
        let run = || {
            let scene = FileScene::parse("probe", text).ok()?;
            let settings = Settings { control: None, ..AnyScene::settings(&scene).without_method() };
            let prepared = Prepared::with(&scene, &DRAWN, Prepared::default_method(), settings).ok()?;
            let mut steps = 0;
            let goes_on = |_: &StepRecord<f64>| {
                steps += 1;
                steps < MOST_STEPS
            };
            let (forward, stopped) = prepared.analysis().observed(&prepared.x, &mut Watch(goes_on)).ok()?;
            stopped.is_none().then(|| take(&prepared, &forward))
        };
        // a panic is found where the scene itself is run
        catch_unwind(AssertUnwindSafe(run)).ok().flatten()
    }

    /// Something at a limit of a quantity; the name of what has a time.
    fn happening(&mut self, course: &Course, reach: &Reach) -> Option<String> {
        let Course { nodes, formula, unit, on } = course;
        let Reach { start, there, speed } = *reach;
        let by = match on {
            Some(on) if self.lots.happens(0.5) => format!("on = \"{on}\"\n"),
            _ => format!("nodes = {{ {nodes} }}\nvalue = \"{formula}\"\n"),
        };
        let is_rising = there > start;
        let size = self.units.size(unit);
        let share = self.lots.number(0.3, 0.95);
        let limit = self.formula((start + share * (there - start)) / size, unit);
        let (side, other, direction) = if is_rising { ("most", "least", "rising") } else { ("least", "most", "falling") };
        let of_force = if on.is_some() && *unit == "rad" { "N m" } else { "N" };
        let is_locating = self.is_locating;
        match self.lots.below(if is_locating { 15 } else { 11 }) {
            0..=3 => {
                let law = self.restitution(speed, unit);
                Some(self.add("stop", "stop", &format!("{by}{side} = \"{limit}\"\n{law}")))
            }
            4 => {
                let share = self.lots.number(0.2, 1.0);
                let behind = self.formula((start - share * (there - start)) / size, unit);
                let law = self.restitution(speed, unit);
                self.add("stop", "stops", &format!("{by}{side} = \"{limit}\"\n{other} = \"{behind}\"\n{law}"));
                None
            }
            5 => Some(self.add("latch", "latch", &format!("{by}at = \"{limit}\""))),
            6 => Some(self.add("latch", "catch", &format!("{by}at = \"{limit}\"\nstrength = \"<positive {of_force}>\""))),
            7 if self.lots.happens(0.3) => {
                let keys = format!("nodes = {{ {nodes} }}\nwhen = \"{formula} - ({limit})\"\nend = true");
                Some(self.add("event", "end", &keys))
            }
            8 if on.as_ref().is_some_and(|on| on.starts_with("coordinate")) => {
                let keys = format!("nodes = {{ {nodes} }}\nwhen = \"{formula} - ({limit})\"\ndirection = \"{direction}\"");
                Some(self.add("event", "blow", &format!("{keys}\nset = {{ \"a.rate\" = \"-0.6 * a.rate\" }}")))
            }
            place @ 7..=10 => {
                let way = self.lots.pick(&["", "direction = \"both\"\n", "once = true\n"]);
                let way = if way.is_empty() { format!("direction = \"{direction}\"\n") } else { way.into() };
                let when = format!("when = \"{formula} - ({limit})\"\n{way}");
                let kept = if on.is_some() { "a.rate" } else { "dot(a.velocity, [1, 0.5, -0.3])" };
                let kept = format!("{kept} / {:?}", round(self.units.size(&format!("{unit}/s"))));
                let (others, what) = if place < 9 { self.change(nodes) } else { self.setting(nodes, &kept) };
                Some(self.add("event", "event", &format!("{others}{when}{what}")))
            }
            place => {
                let (depth, sign) = match is_rising {
                    true => (format!("({formula} - ({limit}))"), "-"),
                    false => (format!("({limit} - ({formula}))"), ""),
                };
                let [stiffness, damping] = if of_force == "N" { ["N/m", "N s/m"] } else { ["N m/rad", "N m s/rad"] };
                let fill = |text: &str| {
                    let text = text.replace("<K>", &format!("<{stiffness}>")).replace("<C>", &format!("<{damping}>"));
                    let text = text.replace("<positive F>", &format!("<positive {of_force}>"));
                    let rate = if is_rising { "a.rate" } else { "(-a.rate)" };
                    let text = text.replace('D', &depth).replace('R', rate).replace('V', &format!("{:?}", round(speed)));
                    text.replace('S', &format!("{:?}", round(size)))
                };
                let keys = match on {
                    Some(_) if place % 2 == 0 => {
                        format!("force = {{ a = \"{sign}({})\" }}", fill(self.lots.pick(&CONTACTS)))
                    }
                    // a potential knows no time
                    _ if formula.ends_with("* t") => return None,
                    _ => format!("potential = \"{}\"", fill(self.lots.pick(&SOFT))),
                };
                self.add("element", "contact", &format!("nodes = {{ {nodes} }}\n{keys}"));
                None
            }
        }
    }

    /// What becomes of the speed of a hit: nothing, a share of it, or a share that a variable changes; most come to rest.
    pub(super) fn restitution(&mut self, speed: f64, unit: &str) -> String {
        let (share, unit) = (round(self.lots.number(0.2, 0.8)), format!("{unit}/s"));
        let own = match self.lots.below(3) {
            0 => return String::new(),
            1 => format!("restitution = {share:?}\n"),
            _ => format!("restitution = \"{:?} * damping\"\n", round(0.5 * share)),
        };
        if self.lots.happens(0.1) {
            return own;
        }
        let rest = self.lots.number(0.1, 0.5) * speed / self.units.size(&unit);
        format!("{own}rest_speed = \"{}\"\n", self.formula(rest, &unit))
    }

    /// A joint that goes, or a setting.
    fn change(&mut self, nodes: &str) -> (String, String) {
        // points may have no mass of their own
        let listed = |form: &str| JOINTS.iter().any(|part| part.form.name == form);
        let joints = self.joints.iter().filter(|own| listed(own.form) && own.ends.iter().all(|end| end.has_axes));
        let joints: Vec<String> = joints.map(|own| own.name.clone()).collect();
        if joints.is_empty() || self.lots.happens(0.3) {
            return self.setting(nodes, "0.7");
        }
        let joint = &joints[self.lots.below(joints.len())];
        (named(nodes, ""), format!("remove = \"{joint}\"\n"))
    }

    /// A number that acts by a force, or a state, that is set.
    fn setting(&mut self, nodes: &str, kept: &str) -> (String, String) {
        let states = self.states.iter().filter(|own| ["s.value", "s.z"].contains(&&*own[1])).cloned().collect::<Vec<_>>();
        if !states.is_empty() && self.lots.happens(0.5) {
            let [name, value, _] = &states[self.lots.below(states.len())];
            return (named(nodes, &format!("s = \"{name}\"")), format!("set = {{ \"{value}\" = \"-0.4 * {value}\" }}\n"));
        }
        let initial = self.lots.pick(&["", "initial = 0.5"]);
        let number = self.add("number", "number", initial);
        let on = self.moving().name;
        let force = "force = { p = \"n.value * [<N>, <N>, <N>]\" }";
        self.add("element", "mode", &format!("nodes = {{ p = \"{on}\", n = \"{number}\" }}\n{force}"));
        let value = self.lots.pick(&["1", "n.value + 0.5", kept]);
        (named(nodes, &format!("n = \"{number}\"")), format!("set = {{ n = \"{value}\" }}\n"))
    }
}

impl Course {
    fn on(name: String) -> Self {
        let unit = if name.starts_with("angle") { "rad" } else { "m" };
        Course { nodes: format!("a = \"{name}\""), formula: "a.value".into(), unit, on: Some(name) }
    }
}

/// The nodes of an event.
fn named(nodes: &str, more: &str) -> String {
    let all: Vec<&str> = [nodes, more].into_iter().filter(|own| !own.is_empty()).collect();
    if all.is_empty() { String::new() } else { format!("nodes = {{ {} }}\n", all.join(", ")) }
}
