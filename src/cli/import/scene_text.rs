//! Robots as texts of scene files.

use super::robot::{Inertial, Joint, Link, Looks, Pose, Robot};
use crate::design::shortest;
use crate::scalar::{Quaternion, SpatialVector, Vector3};
use crate::scenes::folder_name;
use std::path::{Path, PathBuf};

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
    if (values[0].abs() - 1.0).abs() < 1e-15 {
        return String::new();
    }
    format!("{before}orientation = {{ type = \"euler_parameters\", values = {} }}", list(&values))
}

/// R J R^T of a tensor (xx, yy, zz, xy, xz, yz).
fn turned([xx, yy, zz, xy, xz, yz]: [f64; 6], turn: Quaternion<f64>) -> [f64; 6] {
    let axes = turn.columns();
    let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let entry = |i: usize, j: usize| -> f64 {
        (0..3).map(|k| (0..3).map(|l| axes[k][i] * rows[k][l] * axes[l][j]).sum::<f64>()).sum()
    };
    [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]].map(|[i, j]| entry(i, j))
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

/// The body of a link that stands somewhere.
fn body(link: &Link, pose: Pose, folders: &Folders, notes: &mut Vec<String>) -> String {
    let name = quoted(&link.name);
    let mut text = format!("\n[[body]]\nname = {name}\nposition = {}{}\n", vector(pose.place), orientation("\n", pose.turn));
    match &link.inertial {
        Some(Inertial { mass, pose, tensor }) if *mass > 0.0 => {
            let (centre, inertia) = (vector(pose.place), list(&turned(*tensor, pose.turn)));
            text += &format!("mass = {}\nmass_centre = {centre}\ninertia = {inertia}\n", shortest(*mass));
        }
        Some(_) => notes.push(format!("the link {name} has no positive mass, and the body none")),
        None => {}
    }
    let mut solids = Vec::new();
    for (own, looks) in &link.visuals {
        match solid(looks, pose.then(*own), folders) {
            Ok(own) => solids.push(own),
            Err(why) => notes.push(format!("a shape of the link {name} is left out: {why}")),
        }
    }
    if !solids.is_empty() {
        text += &format!("solids = [\n    {},\n]\n", solids.join(",\n    "));
    }
    text
}

/// Name of the joint angle of a joint.
fn angle_name(joint: &str) -> String {
    quoted(&format!("{joint} angle"))
}

/// What holds a child that stands somewhere on its parent; axes are given in the frame of the child.
fn joint(own: &Joint, pose: Pose, robot: &Robot, notes: &mut Vec<String>) -> String {
    let Joint { name, kind, parent, child, axis, damping, friction, has_limits, mimic, .. } = own;
    let (name, quoted_name) = (name.as_str(), quoted(name));
    let turns = |kind: &str| matches!(kind, "revolute" | "continuous");
    let between = format!("between = [{}, {}]\n", quoted(parent), quoted(child));
    let (point, axis) = (vector(pose.place), vector(pose.turn.rotate(*axis)));
    let of_type = match kind.as_str() {
        kind if turns(kind) => "revolute",
        "prismatic" | "planar" | "fixed" => kind,
        "floating" => return String::new(),
        other => {
            notes.push(format!("the joint {quoted_name} is of type \"{other}\", which is not known: its link moves freely"));
            return String::new();
        }
    };
    let along = match of_type {
        "fixed" => String::new(),
        "planar" => format!("normal = {axis}\n"),
        _ => format!("axis = {axis}\n"),
    };
    let mut text = format!("\n[[joint]]\nname = {quoted_name}\ntype = \"{of_type}\"\n{between}point = {point}\n{along}");
    if of_type == "revolute" {
        text += &format!("\n[[joint_angle]]\nname = {}\n{between}axis = {axis}\n", angle_name(name));
    }
    if *damping > 0.0 {
        let spring = format!("\n[[spring]]\nname = {}\n", quoted(&format!("{name} damping")));
        let rates = format!("stiffness = 0\ndamping = {}\n", shortest(*damping));
        text += &match of_type {
            "revolute" => format!("{spring}type = \"angle\"\non = {}\n{rates}", angle_name(name)),
            "prismatic" => {
                format!("{spring}type = \"slide\"\n{between}origin = {point}\npoint = {point}\naxis = {axis}\n{rates}")
            }
            _ => String::new(),
        };
    }
    if *friction > 0.0 {
        notes.push(format!("the dry friction of the joint {quoted_name} is left out"));
    }
    if *has_limits {
        notes.push(format!("the limits of the joint {quoted_name} are left out: nothing stops it"));
    }
    let leader = mimic.as_ref().and_then(|own| Some((own, robot.joints.iter().find(|joint| joint.name == own.joint)?)));
    if let Some((own, leader)) = leader {
        if of_type != "revolute" || !turns(&leader.kind) || own.offset != 0.0 {
            notes.push(format!(
                "the joint {quoted_name} follows \"{}\", which is said only of two that turn, without an offset: it is left free",
                leader.name
            ));
        } else {
            let nodes = format!("nodes = {{ leader = {}, follower = {} }}", angle_name(&leader.name), angle_name(name));
            let equation = format!("follower.value - {} * leader.value", shortest(own.multiplier));
            let following = quoted(&format!("{name} follows {}", leader.name));
            text += &format!(
                "\n[[joint]]\nname = {following}\ntype = \"formula\"\n{nodes}\nequations = [{}]\n",
                quoted(&equation)
            );
        }
    }
    text
}

/// The text of a scene, and what it leaves out.
///
/// # Errors
/// A path that cannot be found.
pub fn write(robot: &Robot, file: &Path, target: &Path, free: bool) -> Result<(String, Vec<String>), String> {
    let folder = |path: &Path| {
        let own = path.parent().filter(|own| !own.as_os_str().is_empty()).unwrap_or(Path::new("."));
        own.canonicalize().map_err(|error| format!("{}: {error}", own.display()))
    };
    let folders = Folders { of_robot: folder(file)?, of_scene: folder(target)? };
    let mut notes = Vec::new();
    let source = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().replace(['\n', '\r'], " "));
    let mut text = format!(
        "# From {source}: it stands as if all joints were at zero. A motor is a [[driver]] of type rotation or translation between the links of a\n\
         # joint, or a [[torque]]; what is measured is a [[functional]].\n\
         version = 1\nname = {}\ngravity = [0, 0, -9.81]\n\n[settings]\nend = 1\nsteps = 200\n",
        quoted(&folder_name(&robot.name))
    );
    for (link, pose, carrier) in robot.in_order() {
        text += &body(link, pose, &folders, &mut notes);
        match carrier {
            Some(own) => text += &joint(own, pose, robot, &mut notes),
            None if free => {}
            None => {
                let between = format!("between = [\"ground\", {}]", quoted(&link.name));
                text += &format!("\n[[joint]]\nname = \"stand\"\ntype = \"fixed\"\n{between}\n");
            }
        }
    }
    Ok((text, notes))
}
