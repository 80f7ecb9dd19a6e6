//! A shell of one element on the arm, curved and distorted, whose nodes start beside their reference.

use super::measures::Reach;
use costate::elements::TimeFunction;
use costate::elements::flexible::{FaceKind, Laminate, Material, Ply};
use costate::elements::forces::LoadFrame;
use costate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use costate::scenes::{MechanismBuilder, NodeId, ShellMember, ShellMesh, Signal};

/// What is tested of the shell.
#[derive(Clone, Debug)]
pub enum ShellSubject {
    /// One material.
    Isotropic,
    /// Plies of two directions, beside the reference surface.
    Laminate,
    /// One material that damps.
    Damped,
    /// One material, on other faces.
    Face(FaceKind),
    /// A pressure on it.
    Pressure(LoadFrame, TimeFunction),
}

use Reach::{Force, Inertia, Later, Mass, Stored};

/// E, nu and the density.
const MATERIAL: [f64; 3] = [900.0, 0.3, 8.0];

impl ShellSubject {
    /// Plies of two directions, beside the reference surface.
    pub fn laminate<S: Scalar>() -> Laminate<S> {
        let [young, poisson, density] = MATERIAL.map(S::from);
        let ply = |angle: f64, thickness: f64| Ply {
            thickness: S::from(thickness),
            angle: S::from(angle),
            young: [young, young * 0.4],
            poisson,
            shear: [300.0, 250.0, 200.0].map(S::from),
            density,
        };
        Laminate::new(vec![ply(0.4, 0.04), ply(-0.7, 0.06)]).offset(S::from(0.01))
    }

    /// The part whose parameters are tested.
    pub fn part(&self) -> &'static str {
        match self {
            ShellSubject::Pressure(..) => "pressure, element 1",
            ShellSubject::Face(_) => "shell, element 1, 1, part 1",
            _ => "shell, element 1, 1",
        }
    }

    /// What each of its numbers can reach.
    pub fn reaches(&self) -> Vec<Reach> {
        let face = if let ShellSubject::Face(face) = self { *face } else { FaceKind::Quad9 };
        let geometry = (0..face.shape().section()).map(|place| if place % 6 < 3 { Mass } else { Inertia });
        let section = match self {
            ShellSubject::Pressure(LoadFrame::World, _) => return [vec![Force; 27], vec![Force, Force, Later]].concat(),
            // the frequency shows from the second moment on
            ShellSubject::Pressure(LoadFrame::Body, _) => return vec![Force, Force, Later, Force],
            // thicknesses, two elastic constants, density
            ShellSubject::Isotropic | ShellSubject::Damped | ShellSubject::Face(_) => {
                [vec![Mass; face.shape().nodes], vec![Stored; 2], vec![Mass]].concat()
            }
            // stiffnesses, inertia, direction
            ShellSubject::Laminate => [vec![Stored; 21], vec![Mass], vec![Inertia; 2], vec![Stored; 3]].concat(),
        };
        let damping = matches!(self, ShellSubject::Damped).then_some(Force);
        // drilling and gravity
        geometry.chain(section).chain([Stored; 4]).chain(damping).collect()
    }

    /// Adds the shell, its first node that of the arm; it turns with the arm.
    pub fn add<S: Scalar>(
        &self,
        m: &mut MechanismBuilder<S>,
        arm: NodeId,
        turned: Quaternion<S>,
        function: &[S],
    ) -> ShellMember {
        let origin = m.position(arm);
        let mesh = ShellMesh::on([1, 1], |u, v| {
            let at = [0.6 * u + 0.1 * v * v, 0.5 * v + 0.05 * u * v, 0.12 * u * u - 0.1 * v + 0.15 * u * v];
            let normal = [-0.24 * u - 0.15 * v, 0.2 - 0.3 * u, 1.0];
            [origin + turned.rotate(Vector3::from_f64(at)), turned.rotate(Vector3::from_f64(normal))]
        });
        let mesh = mesh.with_node(0, 0, arm);
        let mesh = if matches!(self, ShellSubject::Damped) { mesh.damped(S::from(0.02)) } else { mesh };
        let mesh = if let ShellSubject::Face(face) = self { mesh.with_faces(*face) } else { mesh };
        let [young, poisson, density] = MATERIAL.map(S::from);
        let shell = match self {
            ShellSubject::Laminate => {
                m.laminate_shell("shell", mesh, &Self::laminate(), turned.rotate(Vector3::from_f64([1.0, 0.3, 0.2])))
            }
            _ => m.shell("shell", mesh, &Material { young, poisson, density }, S::from(0.1)),
        };
        if let ShellSubject::Pressure(frame, size) = self {
            m.pressure("pressure", &shell, *frame, Signal::of(size.clone(), function));
        }
        for (place, &node) in shell.nodes.iter().enumerate().skip(1) {
            let phase = place as f64;
            let shift = [0.01 * phase.sin(), 0.01 * (1.7 * phase).cos(), 0.02 * (2.3 * phase).sin()];
            let first = m.model.node(node).dofs.start;
            let shift = turned.rotate(Vector3::from_f64(shift));
            (0..3).for_each(|i| m.numbers.q[first + i] += shift[i]);
        }
        shell
    }
}
