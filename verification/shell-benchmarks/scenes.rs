//! Shells with loads that grow with the load factor.

use costate::elements::flexible::{FaceKind, Laminate, Material, Ply};
use costate::elements::forces::LoadFrame;
use costate::elements::{NodeKind, TimeFunction};
use costate::internals::{AppliedForce, AppliedTorque};
use costate::prelude::*;
use costate::scenes::{Edge, NodeId, ShellMember, ShellMesh};
use std::f64::consts::PI;

/// A published problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Problem {
    /// Sze et al. (2004), 3.1: a cantilever under a shear force at its end.
    EndShear,
    /// Sze et al. (2004), 3.2: a cantilever under a moment at its end that rolls it up.
    EndMoment,
    /// Sze et al. (2004), 3.4: a hemisphere with a hole under alternating radial forces; a quarter of it.
    Hemisphere,
    /// Sze et al. (2004), a shallow cylindrical roof, hinged along its straight edges, under a force in its middle; a quarter of it.
    HingedRoof {
        /// Thickness [mm].
        thickness: f64,
    },
    /// The roof of Scordelis and Lo under its weight; a quarter of it.
    Roof,
    /// A cylinder between diaphragms, pinched; an eighth of it.
    PinchedCylinder,
    /// A tube of radius and length 1 under a pressure inside of E t, which widens it by its radius; free along its axis; an eighth of it.
    Tube {
        /// Thickness by radius.
        thickness: f64,
    },
    /// MacNeal and Harder (1985): a strip of 12 by 1.1, twisted by a right angle, clamped at one end, with a force at the other.
    TwistedBeam {
        /// Thickness.
        thickness: f64,
        /// The force lies in the surface at the end, or across it.
        in_plane: bool,
    },
    /// A square plate of length 1, clamped at its edges, under its weight.
    ClampedPlate {
        /// Thickness by length.
        thickness: f64,
    },
    /// A square plate of length 1, clamped at one edge, without load.
    CantileverPlate {
        /// Thickness by length.
        thickness: f64,
    },
}

/// A problem on a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Benchmark {
    pub problem: Problem,
    /// Of nine nodes.
    pub elements: [usize; 2],
    /// What stands in place of each.
    pub face: FaceKind,
    /// Share of the published load: small where the reference is linear.
    pub share: f64,
    /// Equal ones; those that Newton's method cannot make are halved.
    pub load_steps: usize,
}

fn vector<S: Scalar>(components: [f64; 3]) -> Vector3<S> {
    Vector3::from_f64(components)
}

fn material<S: Scalar>(young: f64, poisson: f64, density: f64) -> Material<S> {
    Material { young: S::from(young), poisson: S::from(poisson), density: S::from(density) }
}

/// A dead force or moment that grows with the load factor.
fn load<S: Scalar>(
    m: &mut MechanismBuilder<S>,
    (name, moment): (String, bool),
    node: NodeId,
    full: [f64; 3],
) -> Result<(), String> {
    let size = TimeFunction::table(&[0.0, 0.5, 1.0], Interpolant::Lines)?;
    let (on, frame) = (NodeKind::Body, LoadFrame::World);
    let growing = [0.0, 0.5, 1.0];
    if moment {
        m.element(
            &name,
            &[node],
            AppliedTorque { on, frame, size },
            &[full, growing].concat().iter().map(|&x| S::from(x)).collect::<Vec<_>>(),
        );
    } else {
        let p: Vec<S> = [full, [0.0; 3], growing].concat().iter().map(|&x| S::from(x)).collect();
        m.element(&name, &[node], AppliedForce { on, frame, size }, &p);
    }
    Ok(())
}

/// A load that is constant along an edge: shares of Simpson's rule.
fn edge_load<S: Scalar>(m: &mut MechanismBuilder<S>, moment: bool, edge: &[NodeId], full: [f64; 3]) -> Result<(), String> {
    let elements = edge.len() / 2;
    for (place, &node) in edge.iter().enumerate() {
        let weight = match place {
            _ if place % 2 == 1 => 4.0,
            _ if place == 0 || place == 2 * elements => 1.0,
            _ => 2.0,
        };
        let share = weight / (6.0 * elements as f64);
        load(m, (format!("load {place}"), moment), node, full.map(|own| own * share))?;
    }
    Ok(())
}

/// Holds a node in a plane of symmetry, with axis directions 0 to 2 for the normal.
fn symmetry<S: Scalar>(m: &mut MechanismBuilder<S>, node: NodeId, normal: usize) {
    let (ground, at) = (m.ground(), m.position(node));
    let name = format!("symmetry {normal} of {}", m.model.node(node).name);
    m.planar(&name, [ground, node], at, unit(normal));
}

/// Holds a node in two planes of symmetry: it slides along their common axis.
fn slide<S: Scalar>(m: &mut MechanismBuilder<S>, node: NodeId, axis: usize) {
    let (ground, at) = (m.ground(), m.position(node));
    let name = format!("slide of {}", m.model.node(node).name);
    m.prismatic(&name, [ground, node], at, unit(axis));
}

/// Holds the position of a node along an axis.
fn hold<S: Scalar>(m: &mut MechanismBuilder<S>, node: NodeId, axis: usize) {
    let (ground, at) = (m.ground(), m.position(node));
    let name = format!("hold {axis} of {}", m.model.node(node).name);
    m.point_in_plane(&name, [ground, node], at, unit(axis));
}

fn unit<S: Scalar>(axis: usize) -> Vector3<S> {
    let mut components = [0.0; 3];
    components[axis] = 1.0;
    vector(components)
}

/// Ends of cylinders are held by diaphragms: free along y. Nodes at both ends of the edge lie in planes of symmetry or are free.
fn diaphragm<S: Scalar>(m: &mut MechanismBuilder<S>, edge: &[NodeId]) {
    for &node in edge {
        hold(m, node, 0);
        hold(m, node, 2);
    }
}

/// Planes of symmetry of an eighth of a cylinder along y; its crown in the middle.
fn eighth<S: Scalar>(m: &mut MechanismBuilder<S>, shell: &ShellMember) -> NodeId {
    let (crown, side) = (shell.edge(Edge::FirstStart), shell.edge(Edge::FirstEnd));
    crown[1..].iter().for_each(|&node| symmetry(m, node, 0));
    side[1..].iter().for_each(|&node| symmetry(m, node, 2));
    let middle = shell.edge(Edge::SecondStart);
    middle[1..middle.len() - 1].iter().for_each(|&node| symmetry(m, node, 1));
    slide(m, crown[0], 2);
    slide(m, side[0], 0);
    crown[0]
}

impl Benchmark {
    pub fn new(problem: Problem, elements: [usize; 2]) -> Self {
        Benchmark { problem, elements, face: FaceKind::Quad9, share: 1.0, load_steps: 20 }
    }

    /// With a load so small that the answer is that of linear theory.
    pub fn linear(problem: Problem, elements: [usize; 2], share: f64) -> Self {
        Benchmark { share, load_steps: 1, ..Benchmark::new(problem, elements) }
    }

    /// A cantilever along x.
    fn cantilever<S: Scalar>(&self, m: &mut MechanismBuilder<S>, length: f64) -> ShellMember {
        let edges = [vector([length, 0.0, 0.0]), vector([0.0, 1.0, 0.0])];
        let mesh = ShellMesh::plate(Vector3::zeros(), edges, self.elements).clamped(Edge::FirstStart).with_faces(self.face);
        m.shell("shell", mesh, &material(1.2e6, 0.0, 0.0), S::from(0.1))
    }

    /// Part of a cylinder along y that starts at its crown.
    fn cylinder<S: Scalar>(&self, [radius, length]: [f64; 2], angle: f64) -> ShellMesh<S> {
        ShellMesh::cylinder(
            [vector([0.0, 0.0, radius]), vector([0.0, length, 0.0])],
            [Vector3::zeros(), unit(1)],
            S::from(angle),
            self.elements,
        )
        .with_faces(self.face)
    }

    fn square<S: Scalar>(&self) -> ShellMesh<S> {
        ShellMesh::plate(Vector3::zeros(), [unit(0), unit(1)], self.elements).with_faces(self.face)
    }
}

impl Scene for Benchmark {
    fn name(&self) -> String {
        format!("{:?}", self.problem)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(self.load_steps).dividing_steps()
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        match self.problem {
            Problem::EndShear => {
                let shell = self.cantilever(m, 10.0);
                edge_load(m, false, &shell.edge(Edge::FirstEnd), [0.0, 0.0, 4.0 * self.share])?;
            }
            Problem::EndMoment => {
                let shell = self.cantilever(m, 12.0);
                edge_load(m, true, &shell.edge(Edge::FirstEnd), [0.0, -50.0 / 3.0 * PI * self.share, 0.0])?;
            }
            Problem::Hemisphere => {
                let (longitude, latitude) = ([0.0, 0.5 * PI].map(S::from), [0.0, 0.4 * PI].map(S::from));
                let mesh = ShellMesh::sphere(Vector3::zeros(), S::from(10.0), longitude, latitude, self.elements)
                    .with_faces(self.face);
                let shell = m.shell("shell", mesh, &material(6.825e7, 0.3, 0.0), S::from(0.04));
                shell.edge(Edge::FirstStart).into_iter().for_each(|node| symmetry(m, node, 1));
                shell.edge(Edge::FirstEnd).into_iter().for_each(|node| symmetry(m, node, 0));
                hold(m, shell.node(0, 0), 2);
                // half of each force on this quarter
                load(m, ("in".into(), false), shell.node(0, 0), [-200.0 * self.share, 0.0, 0.0])?;
                let last = 2 * self.elements[0];
                load(m, ("out".into(), false), shell.node(last, 0), [0.0, 200.0 * self.share, 0.0])?;
            }
            Problem::HingedRoof { thickness } => {
                // N and mm
                let mesh = self.cylinder([2540.0, 254.0], 0.1);
                let shell = m.shell("shell", mesh, &material(3102.75, 0.3, 0.0), S::from(thickness));
                let (crown, side) = (shell.edge(Edge::FirstStart), shell.edge(Edge::FirstEnd));
                crown[1..].iter().for_each(|&node| symmetry(m, node, 0));
                let middle = shell.edge(Edge::SecondStart);
                middle[1..middle.len() - 1].iter().for_each(|&node| symmetry(m, node, 1));
                slide(m, crown[0], 2);
                for (place, &node) in side.iter().enumerate() {
                    let (ground, at) = (m.ground(), m.position(node));
                    m.revolute(&format!("hinge {place}"), [ground, node], at, unit(1));
                }
                // a quarter of 3000 N
                load(m, ("force".into(), false), crown[0], [0.0, 0.0, -750.0 * self.share])?;
            }
            Problem::Roof => {
                let mesh = self.cylinder([25.0, 25.0], 40.0_f64.to_radians());
                // 90 for each area
                let shell = m.shell("shell", mesh, &material(4.32e8, 0.0, 360.0), S::from(0.25));
                m.gravity(vector([0.0, 0.0, -self.share]));
                let crown = shell.edge(Edge::FirstStart);
                crown[1..].iter().for_each(|&node| symmetry(m, node, 0));
                shell.edge(Edge::SecondStart)[1..].iter().for_each(|&node| symmetry(m, node, 1));
                slide(m, crown[0], 2);
                let end = shell.edge(Edge::SecondEnd);
                diaphragm(m, &end[1..]);
                hold(m, end[0], 2);
            }
            Problem::PinchedCylinder => {
                let mesh = self.cylinder([300.0, 300.0], 0.5 * PI);
                // under a single force a shell that shears goes down without limit: the reference is that of one that does not
                let plate = Laminate {
                    shear_factor: 1e3,
                    ..Laminate::new(vec![Ply::isotropic(&material(3e6, 0.3, 0.0), S::from(3.0))])
                };
                let shell = m.laminate_shell("shell", mesh, &plate, unit(1));
                let crown = eighth(m, &shell);
                let end = shell.edge(Edge::SecondEnd);
                diaphragm(m, &end[1..end.len() - 1]);
                hold(m, end[0], 2);
                hold(m, end[end.len() - 1], 0);
                load(m, ("pinch".into(), false), crown, [0.0, 0.0, -0.25 * self.share])?;
            }
            Problem::Tube { thickness } => {
                let shell =
                    m.shell("shell", self.cylinder([1.0, 1.0], 0.5 * PI), &material(1.0, 0.3, 0.0), S::from(thickness));
                eighth(m, &shell);
                let (size, full) = (TimeFunction::table(&[0.0, 1.0], Interpolant::Lines)?, S::from(thickness * self.share));
                m.pressure("pressure", &shell, LoadFrame::World, Signal::of(size, &[S::zero(), full]));
            }
            Problem::TwistedBeam { thickness, in_plane } => {
                let twist = S::from(0.5 * PI);
                let surface = |along: f64, across: f64| {
                    let (angle, w) = (twist * along, 1.1 * (across - 0.5));
                    let (cos, sin) = (angle.cos(), angle.sin());
                    let by_along = Vector3::new(S::from(12.0), -(sin * twist) * w, cos * twist * w);
                    let by_across = Vector3::new(S::zero(), cos, sin);
                    [Vector3::new(S::from(12.0 * along), cos * w, sin * w), by_along.cross(&by_across).unit()]
                };
                let mesh = ShellMesh::on(self.elements, surface).clamped(Edge::FirstStart).with_faces(self.face);
                let shell = m.shell("shell", mesh, &material(29e6, 0.22, 0.0), S::from(thickness));
                let force = (thickness / 0.32).powi(3) * self.share;
                let full = if in_plane { [0.0, 0.0, force] } else { [0.0, force, 0.0] };
                edge_load(m, false, &shell.edge(Edge::FirstEnd), full)?;
            }
            Problem::ClampedPlate { thickness } => {
                let mut mesh = self.square();
                for edge in [Edge::FirstStart, Edge::FirstEnd, Edge::SecondStart, Edge::SecondEnd] {
                    mesh = mesh.clamped(edge);
                }
                // a load for each area of q = D, for which the deflection is a pure number
                let density = thickness * thickness / (12.0 * (1.0 - 0.09));
                m.shell("shell", mesh, &material(1.0, 0.3, density), S::from(thickness));
                m.gravity(vector([0.0, 0.0, -self.share]));
            }
            Problem::CantileverPlate { thickness } => {
                let mesh = self.square().clamped(Edge::FirstStart);
                m.shell("shell", mesh, &material(1.0, 0.3, 1.0), S::from(thickness));
            }
        }
        Ok(())
    }
}
