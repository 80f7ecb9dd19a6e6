//! Robots as URDF describes them.
//!
//! Source: the XML specification of the Unified Robot Description Format (links, joints, inertials, visuals).

use costate::scalar::{Quaternion, SpatialVector, Vector3};
use roxmltree::{Document, Node};

/// A frame in another one.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// Place of its origin \[m\].
    pub place: Vector3<f64>,
    pub turn: Quaternion<f64>,
}

impl Pose {
    pub fn identity() -> Self {
        Pose { place: Vector3::zeros(), turn: Quaternion::identity() }
    }
    /// A frame that stands in this one, in the frame that this one stands in.
    pub fn then(self, inner: Pose) -> Pose {
        Pose { place: self.place + self.turn.rotate(inner.place), turn: self.turn.times(inner.turn) }
    }
}

/// Mass \[kg\], the frame of its centre in that of the link, and its tensor there (xx, yy, zz, xy, xz, yz) [kg m2].
pub struct Inertial {
    pub mass: f64,
    pub pose: Pose,
    pub tensor: [f64; 6],
}

/// What a link looks like.
pub enum Looks {
    Box([f64; 3]),
    Cylinder { radius: f64, length: f64 },
    Sphere { radius: f64 },
    Mesh { file: String, scale: [f64; 3] },
}

pub struct Link {
    pub name: String,
    pub inertial: Option<Inertial>,
    /// Shapes with their frames in that of the link.
    pub visuals: Vec<(Pose, Looks)>,
}

/// That a joint follows another: position = multiplier x that of the other + offset.
pub struct Mimic {
    pub joint: String,
    pub multiplier: f64,
    pub offset: f64,
}

pub struct Joint {
    pub name: String,
    pub kind: String,
    pub parent: String,
    pub child: String,
    /// The frame of the child in that of the parent while the position of the joint is zero.
    pub pose: Pose,
    /// In the frame of the child, of length one; zero where none is given.
    pub axis: Vector3<f64>,
    pub damping: f64,
    pub friction: f64,
    pub has_limits: bool,
    pub mimic: Option<Mimic>,
}

impl Joint {
    pub fn turns(&self) -> bool {
        matches!(&*self.kind, "revolute" | "continuous")
    }
    pub fn slides(&self) -> bool {
        self.kind == "prismatic"
    }
}

pub struct Robot {
    pub name: String,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

/// Where something stands, for messages.
fn place(node: Node) -> String {
    format!("line {}", node.document().text_pos_at(node.range().start).row)
}

fn needed<'a>(node: Node<'a, '_>, key: &str) -> Result<&'a str, String> {
    let tag = node.tag_name().name();
    node.attribute(key).ok_or_else(|| format!("{}: <{tag}> has no {key}", place(node)))
}

/// Numbers of an attribute.
fn numbers<const N: usize>(node: Node, key: &str, default: Option<[f64; N]>) -> Result<[f64; N], String> {
    let text = match (node.attribute(key), default) {
        (None, Some(default)) => return Ok(default),
        _ => needed(node, key)?,
    };
    let all: Option<Vec<f64>> =
        text.split_whitespace().map(|word| word.parse().ok().filter(|x: &f64| x.is_finite())).collect();
    let told = || format!("{}: {key} is \"{text}\"; it must be {N} numbers", place(node));
    all.and_then(|all| all.try_into().ok()).ok_or_else(told)
}

fn number(node: Node, key: &str, default: Option<f64>) -> Result<f64, String> {
    Ok(numbers(node, key, default.map(|own| [own]))?[0])
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|own| own.has_tag_name(name))
}

/// The frame of `<origin xyz rpy>`: turns about the fixed x, y and z axes, in this order.
fn pose(node: Node) -> Result<Pose, String> {
    let Some(origin) = child(node, "origin") else { return Ok(Pose::identity()) };
    let (xyz, rpy) = (numbers(origin, "xyz", Some([0.0; 3]))?, numbers(origin, "rpy", Some([0.0; 3]))?);
    let about = |axis: [f64; 3], angle| Quaternion::about(Vector3::from_f64(axis), angle);
    let [roll, pitch, yaw] = rpy;
    let turn = about([0.0, 0.0, 1.0], yaw).times(about([0.0, 1.0, 0.0], pitch)).times(about([1.0, 0.0, 0.0], roll));
    Ok(Pose { place: Vector3::from_f64(xyz), turn })
}

fn looks(visual: Node) -> Result<Option<Looks>, String> {
    let Some(geometry) = child(visual, "geometry") else { return Ok(None) };
    let Some(own) = geometry.children().find(Node::is_element) else { return Ok(None) };
    Ok(Some(match own.tag_name().name() {
        "box" => Looks::Box(numbers(own, "size", None)?),
        "cylinder" => Looks::Cylinder { radius: number(own, "radius", None)?, length: number(own, "length", None)? },
        "sphere" => Looks::Sphere { radius: number(own, "radius", None)? },
        "mesh" => Looks::Mesh { file: needed(own, "filename")?.into(), scale: numbers(own, "scale", Some([1.0; 3]))? },
        _ => return Ok(None),
    }))
}

fn link(node: Node) -> Result<Link, String> {
    let inertial = child(node, "inertial").map(|own| {
        let of = |name: &str| child(own, name).ok_or_else(|| format!("{}: <inertial> has no <{name}>", place(own)));
        let (mass, inertia) = (number(of("mass")?, "value", None)?, of("inertia")?);
        let [xx, yy, zz] = ["ixx", "iyy", "izz"].map(|key| number(inertia, key, None));
        let [xy, xz, yz] = ["ixy", "ixz", "iyz"].map(|key| number(inertia, key, Some(0.0)));
        Ok::<_, String>(Inertial { mass, pose: pose(own)?, tensor: [xx?, yy?, zz?, xy?, xz?, yz?] })
    });
    let mut visuals = Vec::new();
    for visual in node.children().filter(|own| own.has_tag_name("visual")) {
        visuals.extend(looks(visual)?.map(|looks| pose(visual).map(|pose| (pose, looks))).transpose()?);
    }
    Ok(Link { name: needed(node, "name")?.into(), inertial: inertial.transpose()?, visuals })
}

fn joint(node: Node) -> Result<Joint, String> {
    let end = |name: &str| -> Result<String, String> {
        let own = child(node, name).ok_or_else(|| format!("{}: <joint> has no <{name}>", place(node)))?;
        Ok(needed(own, "link")?.into())
    };
    let axis = child(node, "axis").map_or(Ok([1.0, 0.0, 0.0]), |own| numbers(own, "xyz", None))?;
    let axis = Vector3::from_f64(axis);
    let dynamics = |key: &str| child(node, "dynamics").map_or(Ok(0.0), |own| number(own, key, Some(0.0)));
    let mimic = child(node, "mimic").map(|own| {
        Ok::<_, String>(Mimic {
            joint: needed(own, "joint")?.into(),
            multiplier: number(own, "multiplier", Some(1.0))?,
            offset: number(own, "offset", Some(0.0))?,
        })
    });
    Ok(Joint {
        name: needed(node, "name")?.into(),
        kind: needed(node, "type")?.into(),
        parent: end("parent")?,
        child: end("child")?,
        pose: pose(node)?,
        axis: axis.try_normalize(0.0).unwrap_or(axis),
        damping: dynamics("damping")?,
        friction: dynamics("friction")?,
        has_limits: child(node, "limit").is_some_and(|own| own.has_attribute("lower") || own.has_attribute("upper")),
        mimic: mimic.transpose()?,
    })
}

impl Robot {
    pub fn parse(text: &str) -> Result<Self, String> {
        let document = Document::parse(text).map_err(|why| format!("it is no XML: {why}"))?;
        let root = document.root_element();
        if !root.has_tag_name("robot") {
            let name = root.tag_name().name();
            return Err(format!("its root is <{name}>, and that of a URDF is <robot>; files of xacro are expanded first"));
        }
        let all = |name: &'static str| root.children().filter(move |own| own.has_tag_name(name));
        let robot = Robot {
            name: root.attribute("name").unwrap_or("robot").into(),
            links: all("link").map(link).collect::<Result<_, _>>()?,
            joints: all("joint").map(joint).collect::<Result<_, _>>()?,
        };
        robot.check()?;
        Ok(robot)
    }

    /// Names are different and known, and joints make a tree.
    fn check(&self) -> Result<(), String> {
        let names: Vec<&str> = self.links.iter().map(|link| &*link.name).collect();
        let joints: Vec<&str> = self.joints.iter().map(|joint| &*joint.name).collect();
        for (what, names) in [("links", &names), ("joints", &joints)] {
            if let Some(twice) = costate::design::repeated(names.iter().copied()) {
                return Err(format!("two {what} are named \"{twice}\""));
            }
        }
        for Joint { name, parent, child, .. } in &self.joints {
            if let Some(end) = [parent, child].into_iter().find(|end| !names.contains(&end.as_str())) {
                return Err(format!("the joint \"{name}\" is on the link \"{end}\", which is not there"));
            }
        }
        match self.roots().len() {
            _ if costate::design::repeated(self.joints.iter().map(|joint| &*joint.child)).is_some() => {
                Err("a link is the child of two joints; a URDF is a tree".into())
            }
            0 => Err("every link is the child of a joint; a URDF is a tree with a root".into()),
            1 if self.bodies().iter().map(|body| body.links.len()).sum::<usize>() == self.links.len() => Ok(()),
            1 => Err("joints make a ring; a URDF is a tree".into()),
            count => {
                let names: Vec<&str> = self.roots().iter().map(|link| &*link.name).collect();
                Err(format!("{count} links are the child of no joint: {}; a URDF has one root", names.join(", ")))
            }
        }
    }

    pub fn roots(&self) -> Vec<&Link> {
        self.links.iter().filter(|link| self.joints.iter().all(|joint| joint.child != link.name)).collect()
    }

    /// The joint that another follows and how, or why it can follow none.
    pub fn leader<'r>(&'r self, own: &'r Joint) -> Option<Result<(&'r Joint, &'r Mimic), &'static str>> {
        let followed = |own: &'r Joint| {
            let mimic = own.mimic.as_ref()?;
            Some((self.joints.iter().find(|other| other.name == mimic.joint), mimic))
        };
        let (leader, mimic) = followed(own)?;
        let Some(leader) = leader else { return Some(Err("which is not there")) };
        if ![own, leader].iter().all(|joint| joint.turns() || joint.slides()) {
            return Some(Err("and one of the two neither turns nor slides"));
        }
        let chain = std::iter::successors(Some(leader), |next| followed(next)?.0).take(self.joints.len());
        let is_ring = chain.into_iter().any(|next| next.name == own.name);
        Some(if is_ring { Err("which follows it in turn") } else { Ok((leader, mimic)) })
    }

    /// Whether a joint, those that it follows and those that follow it move nothing that has inertia, so that no equation says how.
    pub fn moves_nothing(&self, own: &Joint) -> bool {
        let mut together = vec![own];
        let mut next = 0;
        while next < together.len() {
            if self.has_inertia(&together[next].child) {
                return false;
            }
            for other in &self.joints {
                let follows =
                    |one: &Joint, two: &Joint| matches!(self.leader(one), Some(Ok((own, _))) if own.name == two.name);
                let is_new = together.iter().all(|known| known.name != other.name);
                if is_new && (follows(other, together[next]) || follows(together[next], other)) {
                    together.push(other);
                }
            }
            next += 1;
        }
        true
    }

    /// Whether a link or what it carries has mass or a tensor.
    fn has_inertia(&self, name: &str) -> bool {
        let is_heavy = |own: &Inertial| own.mass > 0.0 || own.mass == 0.0 && own.tensor != [0.0; 6];
        self.links.iter().any(|link| link.name == name && link.inertial.as_ref().is_some_and(is_heavy))
            || self.joints.iter().any(|joint| joint.parent == name && self.has_inertia(&joint.child))
    }

    /// Where a joint stands at the start \[rad, m\]: at zero, or where it follows one that does.
    fn position_at_start(&self, own: &Joint) -> f64 {
        match self.leader(own) {
            Some(Ok((leader, mimic))) => mimic.multiplier * self.position_at_start(leader) + mimic.offset,
            _ => 0.0,
        }
    }

    /// The frame that a joint moves in that where it is at zero, at the start.
    pub fn displacement_at_start(&self, own: &Joint) -> Pose {
        let position = self.position_at_start(own);
        let (place, turn) = match own.slides() {
            true => (own.axis * position, Quaternion::identity()),
            false => (Vector3::zeros(), Quaternion::about(own.axis, position)),
        };
        Pose { place, turn }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let link = |name: &str| format!("<link name=\"{name}\"/>");
        let joint = |name: &str, parent: &str, child: &str| {
            format!("<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>")
        };
        let [a, b] = ["a", "b"].map(link);
        for (body, words) in [
            (format!("{a}{a}"), "two links are named \"a\""),
            (format!("{a}{}", joint("j", "a", "b")), "\"b\", which is not there"),
            (format!("{a}{b}"), "2 links are the child of no joint: a, b"),
            (format!("{a}{b}{}{}", joint("j", "a", "b"), joint("k", "b", "a")), "every link is the child"),
            (format!("{a}{b}{}{}", joint("j", "a", "b"), joint("k", "a", "b")), "child of two joints"),
            (format!("{a}\n<joint name=\"j\" type=\"fixed\"/>"), "line 2: <joint> has no <parent>"),
            ("<link/>".into(), "line 1: <link> has no name"),
            (
                "\n<link name=\"a\"><inertial><mass value=\"x\"/><inertia/></inertial></link>".into(),
                "line 2: value is \"x\"",
            ),
            ("<link name=\"a\"><inertial><mass value=\"1\"/></inertial></link>".into(), "has no <inertia>"),
            (String::new(), "every link"),
        ] {
            let why = Robot::parse(&format!("<robot name=\"r\">{body}</robot>")).err().unwrap_or_default();
            assert!(why.contains(words), "{body}: {why}");
        }
        assert!(Robot::parse("<sdf/>").err().unwrap().contains("<robot>"));
        assert!(Robot::parse("hello").err().unwrap().contains("no XML"));
    }
}
