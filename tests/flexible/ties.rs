//! Shells whose nodes do not meet, tied.

use costate::elements::flexible::{FaceKind, Material};
use costate::prelude::*;
use costate::scenes::{Edge, FreeMesh, ShellMember};
use std::collections::{HashMap, HashSet};

const STEEL: Material<f64> = Material { young: 210e9, poisson: 0.3, density: 7850.0 };

fn steel<S: Scalar>() -> Material<S> {
    Material { young: S::from(STEEL.young), poisson: S::from(STEEL.poisson), density: S::from(STEEL.density) }
}

/// A field of constant stress.
#[derive(Clone, Copy, Debug)]
enum Field {
    /// Of any stress in the plane, finite; the rim moves with it.
    Plane,
    /// Tension along x, finite; the sides are free.
    Tension,
    /// Moments in any direction, small; the rim moves with it.
    Moments,
    /// A moment that bends along x, small; the sides are free.
    Bending,
    /// Bending about y, small; the rim moves with it.
    Cylinder,
}

/// A unit square of two plates side by side, the line between which is inclined, one of which follows the other.
#[derive(Clone, Copy, Debug)]
struct Patch {
    kinds: [FaceKind; 2],
    counts: [[usize; 2]; 2],
    follows: usize,
    field: Field,
    /// By how much the line between them is inclined.
    slant: f64,
}

/// Curvature, so small that linear theory holds.
const CURVATURE: f64 = 1e-7;

impl Patch {
    fn size(&self) -> f64 {
        if matches!(self.field, Field::Plane | Field::Tension) { 1.0 } else { CURVATURE }
    }
    /// Position and rotation that the field gives to a place.
    fn at(&self, [x, y]: [f64; 2]) -> ([f64; 3], Quaternion<f64>) {
        let poisson = STEEL.poisson;
        let bent = |w: f64, [by_x, by_y]: [f64; 2]| {
            let axis = Vector3::new(CURVATURE * by_y, -CURVATURE * by_x, 0.0);
            let angle = axis.length().max(1e-300);
            ([x, y, CURVATURE * w], Quaternion::about(axis * angle.recip(), angle))
        };
        match self.field {
            Field::Plane => {
                let f = [[1.05, 0.02], [-0.03, 0.97]];
                let turn = f64::atan2(f[1][0] - f[0][1], f[0][0] + f[1][1]);
                let at = [f[0][0] * x + f[0][1] * y, f[1][0] * x + f[1][1] * y, 0.0];
                (at, Quaternion::about(Vector3::new(0.0, 0.0, 1.0), turn))
            }
            Field::Tension => {
                let strain = 0.05_f64;
                let [long, wide] = [2.0 * strain, -2.0 * poisson * strain].map(|own| (1.0 + own).sqrt());
                ([long * x, wide * y, 0.0], Quaternion::identity())
            }
            Field::Moments => bent(0.5 * x * x - 0.35 * y * y + 0.4 * x * y, [x + 0.4 * y, 0.4 * x - 0.7 * y]),
            Field::Cylinder => bent(0.5 * x * x, [x, 0.0]),
            Field::Bending => bent(0.5 * (x * x - poisson * y * y), [x, -poisson * y]),
        }
    }
    /// Edges of each plate that move with the field.
    fn driven(&self, plate: usize) -> Vec<Edge> {
        let outer = [Edge::FirstStart, Edge::FirstEnd][plate];
        match self.field {
            Field::Plane | Field::Moments | Field::Cylinder => vec![outer, Edge::SecondStart, Edge::SecondEnd],
            Field::Tension | Field::Bending => vec![outer],
        }
    }
    /// Largest distance of nodes from the field, as a share of its size, in what the field is about.
    fn error(&self) -> Result<f64, String> {
        let prepared = Prepared::new(self).map_err(|error| error.to_string())?;
        let q = prepared.equilibrium().map_err(|error| error.to_string())?.q;
        // places at the start of nodes that are not driven
        let mut still = MechanismBuilder::<f64>::default();
        self.plates(&mut still);
        let in_plane = matches!(self.field, Field::Plane | Field::Tension);
        let mut largest = 0.0_f64;
        for (own, start) in q.chunks_exact(7).zip(still.numbers.q.chunks_exact(7)) {
            let (x, turn) = self.at([start[0], start[1]]);
            let directors = [Quaternion::from_slice(&own[3..]), turn].map(|e| e.columns());
            let axis = if in_plane { 0 } else { 2 };
            let turned = (directors[0][axis] - directors[1][axis]).components();
            let moved = if in_plane { own[0] - x[0] } else { own[2] - x[2] };
            let along = if in_plane { own[1] - x[1] } else { 0.0 };
            for off in [moved, along, turned[0], turned[1]] {
                largest = largest.max(off.abs() / self.size());
            }
        }
        Ok(largest)
    }
    fn plates<S: Scalar>(&self, m: &mut MechanismBuilder<S>) -> Vec<ShellMember> {
        let plate = |(number, name): (usize, &str)| {
            let mesh = ShellMesh::on(self.counts[number], |u, v| {
                let between = 0.5 + self.slant * v;
                let x = if number == 0 { u * between } else { between + u * (1.0 - between) };
                [Vector3::from_f64([x, v, 0.0]), Vector3::from_f64([0.0, 0.0, 1.0])]
            });
            let mesh = mesh.with_faces(self.kinds[number]);
            let mesh = self.driven(number).into_iter().fold(mesh, |mesh, edge| mesh.clamped(edge));
            m.shell(name, mesh, &steel(), S::from(0.01))
        };
        ["left", "right"].into_iter().enumerate().map(plate).collect()
    }
}

impl Scene for Patch {
    fn name(&self) -> String {
        "tied patch".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1).projecting_start()
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let plates = self.plates(m);
        let edges = [plates[0].edge(Edge::FirstEnd), plates[1].edge(Edge::FirstStart)];
        m.tie("seam", &edges[self.follows], &[&plates[1 - self.follows]]);
        let finite = matches!(self.field, Field::Plane | Field::Tension);
        for (number, plate) in plates.iter().enumerate() {
            let driven: HashSet<NodeId> = self.driven(number).into_iter().flat_map(|edge| plate.edge(edge)).collect();
            // finite fields begin near their end, beside which there are others
            for &node in
                plate.nodes.iter().collect::<HashSet<_>>().into_iter().filter(|node| finite || driven.contains(node))
            {
                let place = m.position(node).map(|own| own.value());
                let off = if driven.contains(&node) { 0.0 } else { 1e-3 };
                let (x, turn) =
                    self.at([place[0] + off * (40.0 * place[1]).sin(), place[1] + off * (30.0 * place[0]).cos()]);
                let first = m.model.node(node).dofs.start;
                x.into_iter().chain(turn.0).enumerate().for_each(|(k, own)| m.numbers.q[first + k] = S::from(own));
            }
        }
        Ok(())
    }
}

#[test]
fn constant_stresses_pass_exactly_across_ties_whatever_the_divisions() {
    use FaceKind::{Quad4, Quad9, Triangle6};
    use Field::{Bending, Cylinder, Moments, Plane, Tension};
    // halves of quadrilaterals that are no parallelograms have curved edges; edges of four-node faces are straight, so that they cannot follow
    // a curve along the tie
    let cases: [([FaceKind; 2], f64, &[Field]); 6] = [
        ([Quad9, Quad9], 0.1, &[Plane, Tension, Moments, Bending]),
        ([Quad4, Quad4], 0.1, &[Plane, Tension]),
        ([Quad4, Quad4], 0.0, &[Cylinder]),
        ([Quad9, Quad4], 0.1, &[Plane, Tension]),
        ([Triangle6, Quad9], 0.0, &[Plane, Moments]),
        ([Triangle6, Triangle6], 0.0, &[Tension, Bending]),
    ];
    for (kinds, slant, fields) in cases {
        for &field in fields {
            for counts in [[[2, 2], [1, 3]], [[1, 1], [2, 4]], [[1, 5], [1, 3]]] {
                for follows in [0, 1] {
                    let patch = Patch { kinds, counts, follows, field, slant };
                    let error = patch.error().unwrap_or_else(|why| panic!("{patch:?}: {why}"));
                    assert!(error < 1e-9, "{patch:?}: {error:e}");
                }
            }
        }
    }
}

/// A strip along x, clamped at its start and loaded at its end, of two panels with divisions of their own; of one where the second has none.
#[derive(Clone, Copy, Debug)]
struct Strip {
    kind: FaceKind,
    counts: [[usize; 2]; 2],
    follows: usize,
    method: &'static str,
    force: f64,
    /// Thickness of the second panel, as a share of that of the first.
    thinner: f64,
}

const FORCE: f64 = 3.0;

impl Strip {
    fn of(kind: FaceKind, counts: [[usize; 2]; 2], follows: usize) -> Self {
        Strip { kind, counts, follows, method: "static", force: FORCE, thinner: 1.0 }
    }
    fn prepared(&self) -> Prepared<'_> {
        Prepared::new(self).unwrap_or_else(|why| panic!("{self:?}: {why}"))
    }
    fn tip(&self) -> f64 {
        let prepared = self.prepared();
        prepared.analysis().values(&prepared.x).unwrap_or_else(|why| panic!("{self:?}: {why}"))[0]
    }
}

impl Scene for Strip {
    fn name(&self) -> String {
        "strip".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        [("seam", 0.31), ("divisions", 0.2), ("width", 0.2), ("thickness", 0.01)]
            .map(|(name, value)| DesignVariable::new(name, value, (0.5 * value, 1.5 * value), "m"))
            .to_vec()
    }
    fn settings(&self) -> Settings {
        match self.method {
            "static" => Settings::statics(1),
            method => Settings::new(2e-3, 6).with_method(method),
        }
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let &[seam, divisions, width, thickness] = x else { return Err("four variables".into()) };
        let vector = |components| Vector3::<S>::from_f64(components);
        let is_one = self.counts[1] == [0, 0];
        let ends = [S::zero(), if is_one { S::from(0.6) } else { seam }, S::from(0.6)];
        let mut panels: Vec<ShellMember> = Vec::new();
        for number in 0..if is_one { 1 } else { 2 } {
            let bow = if number == 0 { S::zero() } else { divisions };
            let mesh = ShellMesh::on(self.counts[number], |u, v| {
                let x = ends[number] + (ends[number + 1] - ends[number]) * u;
                // divisions of the second one are wider on one side
                let y = width * (bow * (v * (1.0 - v)) + v);
                [Vector3::new(x, y, S::zero()), vector([0.0, 0.0, 1.0])]
            });
            let mesh = if number == 0 { mesh.clamped(Edge::FirstStart) } else { mesh };
            let own = if number == 0 { thickness } else { thickness * self.thinner };
            panels.push(m.shell(["left", "right"][number], mesh.with_faces(self.kind), &steel(), own));
        }
        if let [left, right] = &panels[..] {
            let (edges, others) = ([left.edge(Edge::FirstEnd), right.edge(Edge::FirstStart)], [right, left]);
            m.tie("seam", &edges[self.follows], &[others[self.follows]]);
        }
        let last = &panels[panels.len() - 1];
        let node = last.edge(Edge::FirstEnd)[0];
        let (point, direction) = (m.position(node), vector([0.0, 0.3, 1.0]));
        let size = match self.method {
            "static" => Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(self.force)]),
            _ => Signal::Constant(S::from(self.force)),
        };
        m.force("pull", Force { on: node, point, direction, frame: LoadFrame::World, size });
        m.position_functional("tip", Over::Terminal, node, point, direction);
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}

#[test]
fn a_cantilever_of_tied_panels_bends_as_one_shell_does() {
    // the matching shells with the divisions of either panel: what lies between them is the error of the divisions, not of the tie
    for (kind, limit) in [(FaceKind::Quad9, 2e-3), (FaceKind::Triangle6, 6e-3), (FaceKind::Quad4, 2e-2)] {
        for counts in [[[3, 2], [3, 3]], [[3, 3], [3, 4]], [[3, 4], [3, 1]]] {
            let matching = counts.map(|[_, across]| Strip::of(kind, [[6, across], [0, 0]], 0).tip());
            let [least, most] = [f64::min, f64::max].map(|pick| pick(matching[0], matching[1]));
            for follows in [0, 1] {
                let strip = Strip::of(kind, counts, follows);
                let own = strip.tip();
                let off = ((least - own) / least).max((own - most) / most);
                assert!(off < limit, "{strip:?}: {own:e}, {matching:?}");
            }
        }
    }
}

#[test]
fn what_a_tie_transmits_is_the_load() {
    let strip = Strip::of(FaceKind::Quad9, [[2, 2], [2, 3]], 1);
    let prepared = strip.prepared();
    let mu = prepared.equilibrium().expect("an equilibrium").mu;
    let seam = prepared.model().constraints.iter().filter(|joint| joint.name.starts_with("seam, "));
    let sum = seam.fold([0.0; 3], |sum, joint| [0, 1, 2].map(|axis| sum[axis] + mu[joint.equations.start + axis]));
    for (own, wanted) in sum.into_iter().zip([0.0, 0.3 * FORCE, FORCE]) {
        assert!((own - wanted).abs() < 1e-9 * FORCE, "{sum:?}");
    }
}

#[test]
fn gradients_by_what_moves_the_nodes_of_a_tie_are_those_of_complex_steps_and_of_whole_runs() {
    for (kind, follows) in [(FaceKind::Quad9, 0), (FaceKind::Quad4, 1)] {
        for method in ["static", "esdirk4", "generalized-alpha"] {
            let strip = Strip { method, thinner: 0.7, ..Strip::of(kind, [[2, 2], [1, 3]], follows) };
            let prepared = strip.prepared();
            let analysis = prepared.analysis();
            let forward = analysis.forward(&prepared.x).expect("runs");
            let adjoint = analysis.adjoint(&prepared.x, &forward).expect("runs");
            let reference = analysis.complex_step(&prepared.x, &forward).expect("runs");
            // equilibria of thin shells have so much round-off, a shell alone 3e-11
            let limit = if method == "static" { 2e-10 } else { 1e-11 };
            for (k, (own, complex)) in adjoint.rows.iter().zip(&reference.rows).enumerate() {
                let off = costate::sensitivity::largest_difference(complex, own);
                assert!(off < limit, "{strip:?}, functional {k}: {off:e}");
                let size = own.iter().zip(&prepared.x).fold(0.0_f64, |size, (own, x)| size.max((own * x).abs()));
                for variable in 0..prepared.x.len() {
                    let mut direction = vec![0.0; prepared.x.len()];
                    direction[variable] = prepared.x[variable];
                    let quotient = analysis.central_difference(&prepared.x, &direction, 1e-4).expect("runs")[k];
                    let own = own[variable] * prepared.x[variable];
                    // with what round-off makes of quotients
                    let limit = 1e-5 * own.abs() + 1e-7 * size;
                    assert!(
                        (quotient - own).abs() < limit,
                        "{strip:?}, functional {k}, variable {variable}: {quotient:e}, {own:e} of {size:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn tied_panels_vibrate_as_one_shell_does() {
    let modes = |strip: Strip| -> Vec<f64> {
        let scene = Strip { method: "esdirk4", force: 0.0, ..strip };
        scene.prepared().modes(4).expect("modes").iter().map(|mode| mode.frequency).collect()
    };
    let one = modes(Strip::of(FaceKind::Quad9, [[6, 4], [0, 0]], 0));
    let tied = modes(Strip::of(FaceKind::Quad9, [[3, 2], [3, 3]], 1));
    for (own, other) in tied.iter().zip(&one) {
        assert!((own / other - 1.0).abs() < 3e-3, "{tied:?} {one:?}");
    }
}

/// A strip of a free mesh of faces of four or nine nodes: one across in its first half, two in its second, as one mesh whose faces do not fit.
struct Hanging {
    nine: bool,
    /// Two across everywhere, without a tie.
    fine: bool,
}

impl Hanging {
    fn mesh<S: Scalar>(&self) -> FreeMesh<S> {
        let (mut points, mut numbers) = (Vec::<Vector3<S>>::new(), HashMap::new());
        let mut faces = Vec::new();
        let mut seam = Vec::new();
        for column in 0..8 {
            let across = if self.fine || column >= 4 { 2 } else { 1 };
            for row in 0..across {
                let [step, high] = [2, 4 / across];
                let corner = [step * column, high * row];
                let cyclic = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]];
                let count = if self.nine { 9 } else { 4 };
                let face: Vec<usize> = cyclic[..count]
                    .iter()
                    .map(|[a, b]| {
                        let at = [corner[0] + step * a / 2, corner[1] + high * b / 2];
                        // corners of nine-node faces cannot meet middles: all nodes of the line are there twice
                        let side = self.nine && !self.fine && at[0] == 8 && column >= 4;
                        let new = points.len();
                        let number = *numbers.entry((at, side)).or_insert(new);
                        if number == new {
                            points.push(Vector3::from_f64([0.05 * at[0] as f64, 0.05 * at[1] as f64, 0.0]));
                        }
                        if at[0] == 8 && column >= 4 && !seam.contains(&number) {
                            seam.push(number);
                        }
                        number
                    })
                    .collect();
                faces.push(face);
            }
        }
        let at =
            |x: f64| -> Vec<usize> { (0..points.len()).filter(|&point: &usize| points[point][0].value() == x).collect() };
        let (root, tip): (Vec<usize>, Vec<usize>) = (at(0.0), at(0.05 * 16.0));
        let mesh = FreeMesh::new(points, faces).clamped(root).node_set("tip", tip).node_set("seam", seam);
        if self.fine { mesh } else { mesh.with_coincident_points() }
    }
}

impl Scene for Hanging {
    fn name(&self) -> String {
        "hanging nodes".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let sheet = m.shell("sheet", self.mesh(), &steel(), S::from(0.01));
        if !self.fine {
            m.tie("seam", &sheet.node_set("seam")?, &[&sheet]);
        }
        let node = sheet.node_set("tip")?[0];
        let (point, direction) = (m.position(node), Vector3::from_f64([0.0, 0.3, 1.0]));
        let size = Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(FORCE)]);
        m.force("pull", Force { on: node, point, direction, frame: LoadFrame::World, size });
        m.position_functional("tip", Over::Terminal, node, point, Vector3::from_f64([0.0, 0.0, 1.0]));
        Ok(())
    }
}

#[test]
fn a_tie_closes_a_mesh_whose_nodes_hang() {
    let tip = |nine, fine| {
        let scene = Hanging { nine, fine };
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        prepared.analysis().values(&prepared.x).expect("an equilibrium")[0]
    };
    for (nine, limit) in [(true, 5e-3), (false, 1e-2)] {
        let off = tip(nine, false) / tip(nine, true) - 1.0;
        assert!(off.abs() < limit, "{nine}: {off:e}");
    }
}

/// A flange with a web, which stands along a line of nodes of the flange or between them, from a wall.
struct Tee {
    across: usize,
    tied: bool,
}

impl Scene for Tee {
    fn name(&self) -> String {
        "tee".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let vector = |components| Vector3::<S>::from_f64(components);
        let plate = |corner, second, counts| {
            ShellMesh::plate(vector(corner), [vector([0.6, 0.0, 0.0]), vector(second)], counts).clamped(Edge::FirstStart)
        };
        let flange = m.shell("flange", plate([0.0; 3], [0.0, 0.2, 0.0], [4, self.across]), &steel(), S::from(0.004));
        let web = plate([0.0, 0.1, 0.0], [0.0, 0.0, 0.1], [if self.tied { 5 } else { 4 }, 1]);
        if self.tied {
            let web = m.shell("web", web, &steel(), S::from(0.004));
            m.tie("weld", &web.edge(Edge::SecondStart), &[&flange]);
        } else {
            let nodes = flange.edge(Edge::FirstStart);
            let fixed =
                ShellMesh::plate(vector([0.0, 0.1, 0.0]), [vector([0.6, 0.0, 0.0]), vector([0.0, 0.0, 0.1])], [4, 1]);
            let web = m.joined(fixed.with_node(0, 0, nodes[self.across]), &[&flange]);
            let web = m.shell("web", web, &steel(), S::from(0.004));
            // the rest of its root
            let ground = m.ground();
            for (place, node) in web.edge(Edge::FirstStart).into_iter().enumerate().skip(1) {
                m.rigid_link(&format!("root {place}"), [ground, node]);
            }
        }
        let node = flange.node(8, 0);
        let (point, direction) = (m.position(node), vector([0.0, 0.0, 1.0]));
        let size = Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(FORCE)]);
        m.force("pull", Force { on: node, point, direction, frame: LoadFrame::World, size });
        m.position_functional("tip", Over::Terminal, node, point, direction);
        Ok(())
    }
}

#[test]
fn a_web_may_stand_anywhere_on_a_flange() {
    let tip = |across, tied| {
        let scene = Tee { across, tied };
        let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{why}"));
        prepared.analysis().values(&prepared.x).expect("an equilibrium")[0]
    };
    let welded = tip(4, false);
    for across in [2, 3, 4, 5] {
        let off = tip(across, true) / welded - 1.0;
        assert!(off.abs() < 1e-2, "{across}: {off:e}");
    }
}

/// A tube of two parts with other divisions around, its ends held, under pressure.
fn tube(around: [usize; 2], within: Option<f64>) -> Result<MechanismBuilder<f64>, String> {
    let mut m = MechanismBuilder::default();
    let at = |x: f64, z: f64| Vector3::new(x, 0.0, z);
    let part = |z: f64, around: usize| {
        let line = [at(0.1, z), at(0.0, 0.1)];
        ShellMesh::cylinder(line, [at(0.0, 0.0), at(0.0, 1.0)], std::f64::consts::TAU, [around, 2]).closed()
    };
    let lower = m.shell("lower", part(0.0, around[0]).clamped(Edge::SecondStart), &STEEL, 0.002);
    let upper = m.shell("upper", part(0.1, around[1]), &STEEL, 0.002);
    let edge = upper.edge(Edge::SecondStart);
    match within {
        Some(within) => m.tie_within("seam", &edge, &[&lower], within),
        None => m.tie("seam", &edge, &[&lower]),
    };
    m.finish()
}

#[test]
fn nodes_that_lie_on_no_face_are_refused_with_place_and_distance() {
    assert!(tube([8, 8], None).is_ok() && tube([8, 16], None).is_err() && tube([8, 12], Some(1e-3)).is_ok());
    let why = tube([8, 12], None).err().expect("refused");
    assert!(why.contains("tie \"seam\": ") && why.contains("lies on no face at (") && why.contains("(within)"), "{why}");
    let plate = |corner: [f64; 3], counts| {
        let [first, second] = [[0.4, 0.0, 0.0], [0.0, 0.2, 0.0]].map(Vector3::from_f64);
        ShellMesh::plate(Vector3::from_f64(corner), [first, second], counts)
    };
    let told = |gap: f64, shift: f64, twice: bool, back: bool| {
        let mut m = MechanismBuilder::<f64>::default();
        let left = m.shell("left", plate([0.0; 3], [2, 2]), &STEEL, 0.01);
        let right = m.shell("right", plate([0.4 + gap, shift, 0.0], [2, 3]), &STEEL, 0.01);
        let edge = right.edge(Edge::FirstStart);
        m.tie("seam", &edge, &[&left]);
        if twice {
            m.tie("again", &edge, &[&left]);
        }
        if back {
            m.tie("back", &left.edge(Edge::FirstEnd), &[&right]);
        }
        m.finish().err().unwrap_or_default()
    };
    assert_eq!(told(0.0, 0.0, false, false), "");
    assert_eq!(told(1e-8, 0.0, false, false), "");
    for (why, parts) in [
        (
            told(1e-3, 0.0, false, false),
            ["node \"right[0,0]\" lies on no face at (0.401, 0, 0) m", "of \"left\", is 1.000e-3 m away"],
        ),
        (told(0.0, 0.05, false, false), ["lies on no face at (0.4, 0.2", "let the other side follow"]),
        (told(0.0, 0.0, true, false), ["tie \"again\": ", "is tied by \"seam\" already"]),
        (told(0.0, 0.0, false, true), ["tie \"back\": ", "of two sides one follows, not both"]),
    ] {
        parts.iter().for_each(|part| assert!(why.contains(part), "{part}: {why}"));
    }
    // what cannot follow
    let mut m = MechanismBuilder::<f64>::default();
    let left = m.shell("left", plate([0.0; 3], [2, 2]), &STEEL, 0.01);
    let right = m.shell("right", plate([0.4, 0.0, 0.0], [2, 3]).clamped(Edge::FirstStart), &STEEL, 0.01);
    m.tie("seam", &right.edge(Edge::FirstStart), &[&left]);
    m.tie("nothing", &[], &[&left]);
    m.tie_within("far", &left.edge(Edge::FirstEnd), &[&right], f64::NAN);
    let why = m.finish().err().expect("refused");
    for part in [
        "tie \"seam\": none of the nodes can follow",
        "tie \"nothing\" has no nodes",
        "tie \"far\": nodes cannot lie within NaN m",
    ] {
        assert!(why.contains(part), "{part}: {why}");
    }
}

#[test]
fn four_plates_meet_in_a_point() {
    // their common corner is tied once, whatever the order
    let mut m = MechanismBuilder::<f64>::default();
    let at = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    let mut plate = |name: &str, corner: Vector3<f64>, counts| {
        let mesh = ShellMesh::plate(corner, [at(1.0, 0.0), at(0.0, 1.0)], counts);
        m.shell(name, mesh, &STEEL, 0.01)
    };
    let (a, b) = (plate("a", at(0.0, 0.0), [2, 2]), plate("b", at(1.0, 0.0), [2, 3]));
    let (c, d) = (plate("c", at(0.0, 1.0), [3, 2]), plate("d", at(1.0, 1.0), [1, 1]));
    m.tie("b to a", &b.edge(Edge::FirstStart), &[&a]);
    m.tie("c to a", &c.edge(Edge::SecondStart), &[&a]);
    m.tie("d to c", &d.edge(Edge::FirstStart), &[&c]);
    m.tie("d to b", &d.edge(Edge::SecondStart), &[&b]);
    let m = m.finish().expect("sound");
    assert_eq!(m.model.constraints.len(), 7 + 7 + 3 + 2);
}

/// A strip of two panels bent or stretched by what follows from a closed form: a load on its end.
struct ByBeam {
    kind: FaceKind,
    counts: [[usize; 2]; 2],
    follows: usize,
    /// Distance of the second panel above the first, which the tie keeps \[m\].
    offset: f64,
    /// Along the strip, or across it.
    force: [f64; 3],
}

/// Length, width and thickness \[m\] of the strip, whose halves are one panel each.
const STRIP: [f64; 3] = [0.6, 0.1, 0.005];
const YOUNG: f64 = 210e9;

impl Scene for ByBeam {
    fn name(&self) -> String {
        "strip".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        // without lateral contraction the strip is a beam
        let material = Material { young: S::from(YOUNG), poisson: S::zero(), density: S::from(7850.0) };
        let [length, width, thickness] = STRIP;
        let vector = |components| Vector3::<S>::from_f64(components);
        let mut panels = Vec::new();
        for (number, start) in [[0.0, 0.0, 0.0], [0.5 * length, 0.0, self.offset]].into_iter().enumerate() {
            let sides = [vector([0.5 * length, 0.0, 0.0]), vector([0.0, width, 0.0])];
            let mesh = ShellMesh::plate(vector(start), sides, self.counts[number]).with_faces(self.kind);
            let mesh = if number == 0 { mesh.clamped(Edge::FirstStart) } else { mesh };
            panels.push(m.shell(["left", "right"][number], mesh, &material, S::from(thickness)));
        }
        let edges = [panels[0].edge(Edge::FirstEnd), panels[1].edge(Edge::FirstStart)];
        m.tie_within("seam", &edges[self.follows], &[&panels[1 - self.follows]], self.offset + 1e-9);
        // a plate of this stiffness at the end takes the load
        let (at, end) = (vector([length, 0.5 * width, self.offset]), Quaternion::identity());
        let cap = m.body("cap", at, end);
        let interface = panels[1].edge(Edge::FirstEnd);
        m.rigid_interface("end", cap, &interface);
        for (name, axis) in [("x", 0), ("y", 1), ("z", 2)] {
            let mut direction = [0.0; 3];
            direction[axis] = 1.0;
            let size = Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(self.force[axis])]);
            m.force(name, Force { on: cap, point: at, direction: vector(direction), frame: LoadFrame::World, size });
            m.position_functional(name, Over::Terminal, cap, at, vector(direction));
        }
        Ok(())
    }
}

#[test]
fn tied_cantilevers_deflect_as_beams_do_also_where_the_tie_keeps_a_distance() {
    let [length, width, thickness] = STRIP;
    let (area, second) = (width * thickness, width * thickness.powi(3) / 12.0);
    // so small that linear theory holds, and along the strip so large that digits of places tell it
    let (load, pull) = (1e-4, 1e-2);
    for (kind, limit) in [(FaceKind::Quad9, 1e-4), (FaceKind::Triangle6, 3e-3), (FaceKind::Quad4, 2e-3)] {
        for follows in [0, 1] {
            for offset in [0.0, 0.02] {
                let strip = |force| ByBeam { kind, counts: [[6, 2], [6, 3]], follows, offset, force };
                let moved = |force: [f64; 3]| {
                    let scene = strip(force);
                    let prepared = Prepared::new(&scene).unwrap_or_else(|why| panic!("{kind:?}, {offset}: {why}"));
                    let values = prepared.analysis().values(&[]).expect("an equilibrium");
                    [values[0] - length, values[1] - 0.5 * width, values[2] - offset]
                };
                // P L3/3EI and 6/5 P L/GA across; along, P L/EA and, with the distance e, the moment P e of the first half
                let shear = 0.5 * YOUNG;
                let across = load * (length.powi(3) / (3.0 * YOUNG * second) + 1.2 * length / (shear * area));
                let own = moved([0.0, 0.0, load])[2];
                assert!((own / across - 1.0).abs() < limit, "{kind:?}, {follows}, {offset}: {own:e} {across:e}");
                let moment = pull * offset / (YOUNG * second);
                let [along, _, down] = moved([pull, 0.0, 0.0]);
                let wanted = pull * length / (YOUNG * area) + offset * moment * 0.5 * length;
                assert!((along / wanted - 1.0).abs() < limit, "{kind:?}, {follows}, {offset}: {along:e} {wanted:e}");
                // with the curvature M/EI up to the seam, from where the second half goes on straight
                let half = 0.5 * length;
                let wanted = -moment * (0.5 * half * half + half * half);
                let off = (down - wanted).abs();
                assert!(off < limit * wanted.abs() + 1e-16, "{kind:?}, {follows}, {offset}: {down:e} {wanted:e}");
            }
        }
    }
}

#[test]
fn curvature_along_a_tie_of_four_node_faces_is_found_as_they_are_divided() {
    let error = |fine: usize| {
        let counts = [[2 * fine, 2 * fine], [fine, 3 * fine]];
        let patch = Patch { kinds: [FaceKind::Quad4; 2], counts, follows: 1, field: Field::Moments, slant: 0.0 };
        patch.error().unwrap_or_else(|why| panic!("{patch:?}: {why}"))
    };
    let errors = [1, 2, 4].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 1.3, "{errors:?}");
    }
    // 3, 6 and 12 elements along the seam that follows
    assert!(errors[0] < 0.04 && errors[2] < 5e-3, "{errors:?}");
}
