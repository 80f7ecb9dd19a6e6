//! Links that fixed joints weld together, as one body.

use super::robot::{Inertial, Joint, Link, Pose, Robot};
use costate::elements::bodies::inertia_tensor;
use costate::scalar::{Quaternion, SpatialVector, Vector3};

/// A link and all that fixed joints weld to it.
pub struct WeldedBody<'r> {
    /// Its frame in the world at the start, which is that of its first link.
    pub pose: Pose,
    /// The joint that carries it, of which the first link is the child; none of the root.
    pub carrier: Option<&'r Joint>,
    /// Its links with their frames in its own, parents first.
    pub links: Vec<(&'r Link, Pose)>,
}

/// Mass \[kg\], its centre \[m\], and the tensor there (xx, yy, zz, xy, xz, yz) [kg m2], in the axes of a body.
#[derive(Clone, Copy)]
pub struct BodyInertia {
    pub mass: f64,
    pub centre: Vector3<f64>,
    pub tensor: [f64; 6],
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

impl BodyInertia {
    fn of(own: &Inertial, link: Pose) -> Self {
        let pose = link.then(own.pose);
        BodyInertia { mass: own.mass, centre: pose.place, tensor: turned(own.tensor, pose.turn) }
    }
    /// What it is where a body can have it, and the nearest that one can have elsewhere.
    fn nearest(self) -> Option<Self> {
        let checked = inertia_tensor::check(self.mass, self.centre, self.tensor);
        checked.err().map(|why| BodyInertia { tensor: why.nearest, ..self })
    }
}

impl WeldedBody<'_> {
    /// Inertia of all its links; none where none of them has mass or a tensor. A negative mass counts for nothing.
    ///
    /// c = sum of m_i c_i / m, J = sum of J_i + m_i (|d_i|^2 1 - d_i d_i^T) with d_i = c_i - c: the parallel-axis theorem.
    pub fn inertia(&self) -> Option<BodyInertia> {
        let all: Vec<BodyInertia> = self.parts().map(|(_, own)| own).filter(|own| own.mass >= 0.0).collect();
        let mass: f64 = all.iter().map(|own| own.mass).sum();
        // from the first centre on, so that a single one stays as it is given
        let first = all.iter().find(|own| own.mass > 0.0).map_or(Vector3::zeros(), |own| own.centre);
        let heavy = all.iter().filter(|own| own.mass > 0.0);
        let centre = heavy.fold(first, |sum, own| sum + (own.centre - first) * (own.mass / mass));
        let mut tensor = [0.0; 6];
        for own in &all {
            let [x, y, z] = (own.centre - centre).components();
            let steiner = [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z];
            (0..6).for_each(|k| tensor[k] += own.tensor[k] + own.mass * steiner[k]);
        }
        (mass > 0.0 || tensor != [0.0; 6]).then_some(BodyInertia { mass, centre, tensor })
    }

    /// Its inertia as a body can have it, and if this is not as it is given, the links that make it so and what is given.
    pub fn admissible_inertia(&self) -> (Option<BodyInertia>, Option<(Vec<&str>, BodyInertia)>) {
        let given = self.inertia();
        let Some((own, nearest)) = given.and_then(|own| Some((own, own.nearest()?))) else { return (given, None) };
        let links = self.parts().filter(|(_, part)| part.mass >= 0.0 && part.nearest().is_some());
        (Some(nearest), Some((links.map(|(link, _)| &*link.name).collect(), own)))
    }

    fn parts(&self) -> impl Iterator<Item = (&Link, BodyInertia)> {
        self.links.iter().filter_map(|(link, pose)| Some((*link, BodyInertia::of(link.inertial.as_ref()?, *pose))))
    }
}

impl Robot {
    /// Its bodies, parents first.
    pub fn bodies(&self) -> Vec<WeldedBody<'_>> {
        let root = |link| WeldedBody { pose: Pose::identity(), carrier: None, links: vec![(link, Pose::identity())] };
        let mut bodies: Vec<WeldedBody> = self.roots().into_iter().map(root).collect();
        // links with the places of their bodies and their frames in these
        let mut found: Vec<(&Link, usize, Pose)> =
            bodies.iter().enumerate().map(|(place, body)| (body.links[0].0, place, Pose::identity())).collect();
        let mut next = 0;
        while next < found.len() {
            let (link, place, inner) = found[next];
            for joint in self.joints.iter().filter(|joint| joint.parent == link.name) {
                let Some(child) = self.links.iter().find(|own| own.name == joint.child) else { continue };
                let pose = inner.then(joint.pose).then(self.displacement_at_start(joint));
                if joint.kind == "fixed" {
                    bodies[place].links.push((child, pose));
                    found.push((child, place, pose));
                } else {
                    let (pose, links) = (bodies[place].pose.then(pose), vec![(child, Pose::identity())]);
                    found.push((child, bodies.len(), Pose::identity()));
                    bodies.push(WeldedBody { pose, carrier: Some(joint), links });
                }
            }
            next += 1;
        }
        bodies
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot(text: &str) -> Robot {
        Robot::parse(&format!("<robot name=\"r\">{text}</robot>")).unwrap()
    }

    #[test]
    fn frames_follow_each_other() {
        let robot = robot(
            r#"<link name="a"/><link name="b"/><joint name="j" type="fixed"><parent link="a"/><child link="b"/>
            <origin xyz="1 2 3" rpy="0.3 0 1.5707963267948966"/></joint>"#,
        );
        let (_, pose) = robot.bodies()[0].links[1];
        assert!((pose.place - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-15);
        // first about x, then about z
        let [x, y] = [Vector3::x(), Vector3::y()].map(|own| pose.turn.rotate(own));
        assert!((x - Vector3::y()).norm() < 1e-15, "{x}");
        assert!((y - Vector3::new(-0.3_f64.cos(), 0.0, 0.3_f64.sin())).norm() < 1e-15, "{y}");
    }

    /// A cuboid of eight cuboids welded to each other in a row is the whole one, wherever their frames stand.
    #[test]
    fn halves_welded_together_are_the_whole() {
        let cuboid =
            |mass: f64, [x, y, z]: [f64; 3]| [y * y + z * z, x * x + z * z, x * x + y * y].map(|own| mass * own / 12.0);
        let [xx, yy, zz] = cuboid(3.0, [0.1, 0.2, 0.3]);
        let link = |k: usize| {
            // its centre 0.1 away from its frame, which is turned by a quarter about y: x is -z, z is x there
            format!(
                "<link name=\"{k}\"><inertial><origin xyz=\"0 0 0.1\" rpy=\"0 1.5707963267948966 0\"/><mass value=\"3\"/>
                <inertia ixx=\"{zz}\" iyy=\"{yy}\" izz=\"{xx}\"/></inertial></link>"
            )
        };
        let weld = |k: usize| {
            let to = k + 1;
            format!(
                "<joint name=\"{k}\" type=\"fixed\"><parent link=\"{k}\"/><child link=\"{to}\"/><origin xyz=\"0.1 0 0\"/></joint>"
            )
        };
        let text: String = (0..8).map(link).chain((0..7).map(weld)).collect();
        let robot = robot(&text);
        let [body] = &robot.bodies()[..] else { panic!("one body") };
        let BodyInertia { mass, centre, tensor } = body.inertia().unwrap();
        assert!((mass - 24.0).abs() < 1e-13 && (centre - Vector3::new(0.35, 0.0, 0.1)).norm() < 1e-14, "{centre}");
        let expected = [&cuboid(24.0, [0.8, 0.2, 0.3])[..], &[0.0; 3]].concat();
        assert!((0..6).all(|k| (tensor[k] - expected[k]).abs() < 1e-14), "{tensor:?} for {expected:?}");
    }
}
