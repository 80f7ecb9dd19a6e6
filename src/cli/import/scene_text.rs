//! Robots as texts of scene files.

use super::robot::{Joint, Looks, Pose, Robot};
use super::welded::{BodyInertia, WeldedBody};
use costate::design::shortest;
use costate::elements::bodies::inertia_tensor;
use costate::scalar::{Quaternion, SpatialVector, Vector3};
use costate::scenes::file::is_free_name;
use costate::scenes::folder_name;
use std::path::{Path, PathBuf};

/// Names that formulas of joints and elements here give their nodes.
const NODES: [&str; 4] = ["a", "b", "leader", "follower"];

/// A text in quotation marks.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn list(numbers: &[f64]) -> String {
    // -0 is 0
    let words: Vec<String> = numbers.iter().map(|&x| shortest(x + 0.0)).collect();
    format!("[{}]", words.join(", "))
}

fn vector(own: Vector3<f64>) -> String {
    list(&own.components())
}

/// The key `orientation`, with what stands before it, for axes that are not those of the world.
fn orientation(before: &str, turn: Quaternion<f64>) -> String {
    let values = turn.0;
    if values[1..] == [0.0; 3] {
        return String::new();
    }
    format!("{before}orientation = {{ type = \"euler_parameters\", values = {} }}", list(&values))
}

/// Where meshes are looked for, and from where scene files name them.
struct Folders {
    of_robot: PathBuf,
    of_scene: PathBuf,
}

impl Folders {
    /// The file of a mesh as the scene file names it. The package of a `package://` path may be any folder above the description.
    fn find(&self, file: &str) -> Option<String> {
        let plain = file.strip_prefix("file://").unwrap_or(file);
        let inner = plain.strip_prefix("package://");
        let tries = self.of_robot.ancestors().flat_map(|folder| match inner {
            Some(path) => {
                let behind = path.split_once('/').map_or(path, |own| own.1);
                vec![folder.join(path), folder.join(behind)]
            }
            None => vec![folder.join(plain)],
        });
        let found = tries.into_iter().find(|path| path.is_file())?;
        let found = found.strip_prefix(&self.of_scene).map_or_else(|_| found.clone(), Path::to_path_buf);
        Some(found.display().to_string())
    }
}

/// A shape as one of the solids of a body, drawn only.
fn solid(looks: &Looks, pose: Pose, folders: &Folders) -> Result<String, String> {
    let at = |x: f64, y: f64, z: f64| vector(pose.place + pose.turn.rotate(Vector3::new(x, y, z)));
    let positive = |sizes: &[f64]| match sizes.iter().all(|size| *size > 0.0) {
        true => Ok(()),
        false => Err(format!("it has a size that is not positive, {}", list(sizes))),
    };
    match looks {
        Looks::Box([x, y, z]) => positive(&[*x, *y, *z]).map(|()| {
            let (from, to, across) = (at(-0.5 * x, 0.0, 0.0), at(0.5 * x, 0.0, 0.0), vector(pose.turn.rotate(Vector3::y())));
            let sizes = format!("width = {}, height = {}", shortest(*y), shortest(*z));
            format!("{{ type = \"box\", from = {from}, to = {to}, second_axis = {across}, {sizes} }}")
        }),
        Looks::Cylinder { radius, length } => positive(&[*radius, *length]).map(|()| {
            let (from, to) = (at(0.0, 0.0, -0.5 * length), at(0.0, 0.0, 0.5 * length));
            format!("{{ type = \"cylinder\", from = {from}, to = {to}, diameter = {} }}", shortest(2.0 * radius))
        }),
        Looks::Sphere { radius } => positive(&[*radius]).map(|()| {
            format!("{{ type = \"sphere\", centre = {}, diameter = {} }}", at(0.0, 0.0, 0.0), shortest(2.0 * radius))
        }),
        Looks::Mesh { file, scale: [x, y, z] } => {
            if x != y || y != z || *x <= 0.0 {
                return Err(format!("the mesh \"{file}\" is scaled by {} along its axes", list(&[*x, *y, *z])));
            }
            if !file.to_ascii_lowercase().ends_with(".stl") {
                return Err(format!("the mesh \"{file}\" is no STL"));
            }
            let found = folders.find(file).ok_or_else(|| format!("the mesh \"{file}\" was not found"))?;
            let place = format!("position = {}{}", vector(pose.place), orientation(", ", pose.turn));
            Ok(format!("{{ type = \"surface\", file = {}, scale = {}, {place} }}", quoted(&found), shortest(*x)))
        }
    }
}

/// A name that is not taken, by as many underscores as it takes.
fn free_name(wanted: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut name = wanted.to_string();
    while is_taken(&name) {
        name.push('_');
    }
    name
}

/// What a scene file leaves out or changes, with the parts of the robot of which it is said.
#[derive(Default)]
struct Notes(Vec<(String, Vec<String>)>);

impl Notes {
    fn add(&mut self, what: impl Into<String>, name: &str) {
        let (what, name) = (what.into(), quoted(name));
        match self.0.iter_mut().find(|own| own.0 == what) {
            Some((_, names)) => names.push(name),
            None => self.0.push((what, vec![name])),
        }
    }
}

struct Writer<'r> {
    robot: &'r Robot,
    folders: Folders,
    bodies: Vec<WeldedBody<'r>>,
    names: Vec<String>,
    notes: Notes,
}

impl Writer<'_> {
    /// The name of the body of a link, in quotation marks.
    fn body_of(&self, link: &str) -> String {
        let place = self.bodies.iter().position(|body| body.links.iter().any(|own| own.0.name == link));
        quoted(place.map_or(link, |place| &self.names[place]))
    }

    fn body(&mut self, place: usize) -> String {
        let WeldedBody { pose, links, .. } = &self.bodies[place];
        let name = quoted(&self.names[place]);
        let mut text =
            format!("\n[[body]]\nname = {name}\nposition = {}{}\n", vector(pose.place), orientation("\n", pose.turn));
        let (inertia, given) = self.bodies[place].admissible_inertia();
        if let Some(BodyInertia { mass, centre, tensor }) = inertia {
            let round_off = inertia_tensor::round_off(mass, centre, tensor);
            if mass > 0.0 && tensor.iter().all(|entry| entry.abs() <= round_off) {
                self.notes
                    .add("the inertia about the mass centre is zero, as of a point of mass, of bodies", &self.names[place]);
            }
            let (centre, tensor) = (vector(centre), list(&tensor));
            text += &format!("mass = {}\nmass_centre = {centre}\ninertia = {tensor}\n", shortest(mass));
            if let Some((links, given)) = given {
                let of = links.iter().map(|link| quoted(link)).collect::<Vec<_>>().join(", ");
                let what = format!(
                    "no body can have the inertia of {of}: the nearest is taken, {tensor} kg m2 for {}, of the body",
                    list(&given.tensor)
                );
                self.notes.add(what, &self.names[place]);
            }
        }
        let mut solids = Vec::new();
        for (link, inner) in links {
            if link.inertial.as_ref().is_some_and(|own| own.mass < 0.0) {
                self.notes.add("a negative mass is left out, with its inertia, of links", &link.name);
            }
            for (own, looks) in &link.visuals {
                match solid(looks, pose.then(*inner).then(*own), &self.folders) {
                    Ok(own) => solids.push(own),
                    Err(why) => self.notes.add(format!("{why}; a shape is left out of links"), &link.name),
                }
            }
        }
        if !solids.is_empty() {
            text += &format!("solids = [\n    {},\n]\n", solids.join(",\n    "));
        }
        text
    }

    /// Places of links that are welded to others, by names that formulas can use.
    fn frames(&self) -> String {
        let mut names: Vec<String> = NODES.map(String::from).into();
        let mut text = String::new();
        for (body, name) in self.bodies.iter().zip(&self.names) {
            for (link, inner) in &body.links[1..] {
                let letter = |own: char| if own.is_ascii_alphanumeric() { own } else { '_' };
                let word: String = link.name.chars().map(letter).collect();
                let begun = if word.starts_with(|own: char| own.is_ascii_alphabetic()) { word } else { format!("_{word}") };
                let frame = free_name(&begun, |own| !is_free_name(own) || names.iter().any(|other| other == own));
                let of = if frame == link.name { String::new() } else { format!("{}, ", quoted(&link.name)) };
                text += &format!("{frame} = {} # {of}on {}\n", vector(body.pose.then(*inner).place), quoted(name));
                names.push(frame);
            }
        }
        match text.is_empty() {
            true => text,
            false => format!(
                "\n# where links stand that are welded to others: the one called camera on the body \"head\" is on = \"head\", point = \"camera\"\n\
                 [define]\n{text}"
            ),
        }
    }

    /// Nodes of a formula, and the formula, of how far a joint has moved since the start.
    fn moved(&self, own: &Joint, pose: Pose, node: &str) -> (String, String) {
        if own.turns() {
            return (format!("{node} = {}", angle_name(&own.name)), format!("{node}.value"));
        }
        let end = |end: &str, link: &str| {
            format!("{node}_{end} = {{ on = {}, point = {} }}", self.body_of(link), vector(pose.place))
        };
        let axis = own.axis.components().into_iter().zip(["x_axis", "y_axis", "z_axis"]).filter(|(share, _)| *share != 0.0);
        let along: Vec<String> = axis.map(|(share, name)| format!("{} * {node}_b.{name}", shortest(share))).collect();
        let nodes = format!("{}, {}", end("a", &own.parent), end("b", &own.child));
        (nodes, format!("dot({node}_b.position - {node}_a.position, {})", along.join(" + ")))
    }

    /// The pose of the body that a joint carries.
    fn carried(&self, own: &Joint) -> Pose {
        let body = self.bodies.iter().find(|body| body.carrier.is_some_and(|joint| joint.name == own.name));
        body.map_or(Pose::identity(), |body| body.pose)
    }

    /// What holds a body on the one that carries it.
    fn joint(&mut self, own: &Joint) -> String {
        let (pose, robot) = (self.carried(own), self.robot);
        let Joint { name, kind, parent, child, axis, damping, .. } = own;
        let quoted_name = quoted(name);
        let between = format!("between = [{}, {}]\n", self.body_of(parent), self.body_of(child));
        let (point, direction) = (vector(pose.place), vector(pose.turn.rotate(*axis)));
        if own.friction > 0.0 {
            self.notes.add("dry friction is left out of joints", name);
        }
        if own.has_limits {
            self.notes.add("limits are left out, nothing stops the joints", name);
        }
        let held = match kind.as_str() {
            _ if own.turns() => format!("type = \"revolute\"\n{between}point = {point}\naxis = {direction}\n"),
            "prismatic" => format!("type = \"prismatic\"\n{between}point = {point}\naxis = {direction}\n"),
            "planar" => format!("type = \"planar\"\n{between}point = {point}\nnormal = {direction}\n"),
            "floating" => String::new(),
            other => {
                self.notes.add(format!("links move freely, as the type {} is not known, of joints", quoted(other)), name);
                String::new()
            }
        };
        let mut text = String::new();
        if !held.is_empty() {
            text += &format!("\n[[joint]]\nname = {quoted_name}\n{held}");
        }
        if own.turns() && self.is_measured(own) {
            text += &format!("\n[[joint_angle]]\nname = {}\n{between}axis = {direction}\n", angle_name(name));
        }
        let damper = quoted(&format!("{name} damping"));
        if *damping > 0.0 && own.turns() {
            // of two that a hinge holds, the angular velocity of one against the other is about its axis
            let rate =
                |of: &str, by: &str| format!("\"{} * ({by}.angular_velocity - {of}.angular_velocity)\"", shortest(*damping));
            let nodes = format!("{{ a = {}, b = {} }}", self.body_of(parent), self.body_of(child));
            let moment = format!("{{ a = {}, b = {} }}", rate("a", "b"), rate("b", "a"));
            text += &format!("\n[[element]]\nname = {damper}\nnodes = {nodes}\nmoment = {moment}\n");
        } else if *damping > 0.0 && own.slides() {
            let slide = format!("{between}origin = {point}\npoint = {point}\naxis = {direction}\n");
            let rates = format!("stiffness = 0\ndamping = {}\n", shortest(*damping));
            text += &format!("\n[[spring]]\nname = {damper}\ntype = \"slide\"\n{slide}{rates}");
        } else if *damping > 0.0 {
            self.notes.add("damping is left out of joints that neither turn nor slide", name);
        }
        let follows = matches!(robot.leader(own), Some(Ok(_)));
        if (own.turns() || own.slides()) && !follows && robot.moves_nothing(own) {
            let motion = match own.turns() {
                true => format!("type = \"rotation\"\n{between}axis = {direction}\nangle = 0\n"),
                false => format!(
                    "type = \"translation\"\n{between}origin = {point}\npoint = {point}\naxis = {direction}\ndisplacement = 0\n"
                ),
            };
            text += &format!("\n[[driver]]\nname = {}\n{motion}", quoted(&format!("{name} held")));
            self.notes
                .add("drivers hold joints that move nothing with inertia, so that no equation says how they move", name);
        }
        match robot.leader(own) {
            None => {}
            Some(Err(why)) => {
                let followed = own.mimic.as_ref().map_or("", |mimic| &mimic.joint);
                self.notes.add(format!("joints are left free that should follow {}, {why}", quoted(followed)), name);
            }
            Some(Ok((leader, mimic))) => {
                let of_leader = self.moved(leader, self.carried(leader), "leader");
                let of_follower = self.moved(own, pose, "follower");
                let nodes = format!("nodes = {{ {}, {} }}", of_leader.0, of_follower.0);
                let equation = format!("{} - {} * {}", of_follower.1, shortest(mimic.multiplier), of_leader.1);
                let following = quoted(&format!("{name} follows {}", leader.name));
                text += &format!(
                    "\n[[joint]]\nname = {following}\ntype = \"formula\"\n{nodes}\nequations = [{}]\n",
                    quoted(&equation)
                );
            }
        }
        text
    }

    /// Whether something follows the angle of a joint, or it follows something.
    fn is_measured(&self, own: &Joint) -> bool {
        let pairs = self.robot.joints.iter().filter_map(|joint| Some((joint, self.robot.leader(joint)?.ok()?.0)));
        pairs.into_iter().any(|(follower, leader)| [follower, leader].iter().any(|joint| joint.name == own.name))
    }
}

fn angle_name(joint: &str) -> String {
    quoted(&format!("{joint} angle"))
}

/// The text of a scene, and what it leaves out or changes.
pub fn write(robot: &Robot, file: &Path, target: &Path, free: bool) -> Result<(String, Vec<String>), String> {
    let folder = |path: &Path| {
        let own = path.parent().filter(|own| !own.as_os_str().is_empty()).unwrap_or(Path::new("."));
        own.canonicalize().map_err(|error| format!("{}: {error}", own.display()))
    };
    let folders = Folders { of_robot: folder(file)?, of_scene: folder(target)? };
    let bodies = robot.bodies();
    let is_link = |name: &str| robot.links.iter().any(|link| link.name == name);
    let name = |body: &WeldedBody| match &*body.links[0].0.name {
        "ground" => free_name("ground_link", is_link),
        own => own.to_string(),
    };
    let names = bodies.iter().map(name).collect();
    let mut writer = Writer { robot, folders, bodies, names, notes: Notes::default() };
    let source = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().replace(['\n', '\r'], " "));
    let mut text = format!(
        "# From {source}: it stands as if all joints were at zero, and those that follow others where these take them. A motor is a [[driver]] of\n\
         # type rotation or translation between the bodies of a joint, or a [[torque]]; what is measured is a [[functional]].\n\
         version = 1\nname = {}\ngravity = [0, 0, -9.81]\n{}\n[settings]\nend = 1\nsteps = 200\n",
        quoted(&folder_name(&robot.name)),
        writer.frames()
    );
    for place in 0..writer.bodies.len() {
        text += &writer.body(place);
        let (name, carrier) = (&writer.names[place], writer.bodies[place].carrier);
        if name != &writer.bodies[place].links[0].0.name {
            writer.notes.add("a link is called \"ground\", which names what never moves; its body is", &name.clone());
        }
        match carrier {
            Some(own) => text += &writer.joint(own),
            None if free => {}
            None => {
                let stand = free_name("stand", |name| robot.joints.iter().any(|joint| joint.name == name));
                let between = format!("between = [\"ground\", {}]", quoted(&writer.names[place]));
                text += &format!("\n[[joint]]\nname = {}\ntype = \"fixed\"\n{between}\n", quoted(&stand));
            }
        }
    }
    let notes = writer.notes.0.into_iter().map(|(what, names)| format!("{what}: {}", names.join(", ")));
    Ok((text, notes.collect()))
}
