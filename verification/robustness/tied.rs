//! Shells joined and tied, drawn by lot: sheets of several panels in states of constant stress, whose places, rotations and energies are known.

use crate::Lots;
use crate::Report;
use costate::elements::flexible::{FaceKind, Material};
use costate::integrators::Verdict;
use costate::prelude::*;
use costate::scenes::{Edge, ShellMember};
use std::collections::HashSet;

/// Sheets in the short form; ten times as many in the long one.
const DRAWN: u64 = 40;
/// Distance of nodes from their places \[m\] and of their frames from their rotations, of a sheet of size 1.
const OFF: f64 = 1e-9;
/// Distance of the energy from that of the field, as a share of it, and beside the energy of a strain of 1.
const ENERGY: [f64; 2] = [1e-9, 1e-16];
const YOUNG: f64 = 2.1e11;
const POISSON: f64 = 0.3;
const THICKNESS: f64 = 0.01;

/// A sheet between x = 0 and 1 and y = 0 and 1 of panels side by side, the rim of which moves with a field.
#[derive(Clone, Debug)]
struct Sheet {
    kinds: Vec<FaceKind>,
    /// Elements of each panel along and across.
    counts: Vec<[usize; 2]>,
    /// Which side of each seam follows where it is tied: that before it, or that behind it.
    follows: Vec<usize>,
    /// By how much each seam is inclined.
    slants: Vec<f64>,
    /// Deformation in the plane of the sheet, and the rotation of all of it.
    stretch: [[f64; 2]; 2],
    turn: [f64; 4],
    /// Energy per area \[J/m2\].
    energy: f64,
}

impl Sheet {
    fn draw(seed: u64) -> Self {
        let mut lots = Lots::new(seed, 41);
        let panels = 2 + lots.below(2);
        let mixed = lots.happens(0.5);
        let first = lots.pick(&FaceKind::ALL);
        let kinds: Vec<FaceKind> = (0..panels).map(|_| if mixed { lots.pick(&FaceKind::ALL) } else { first }).collect();
        let across = 1 + lots.below(4);
        // some seams fit, and are joined
        let counts =
            (0..panels).map(|_| [1 + lots.below(2), if lots.happens(0.4) { across } else { 1 + lots.below(5) }]).collect();
        let follows = (1..panels).map(|_| lots.below(2)).collect();
        let is_straight = kinds.contains(&FaceKind::Triangle6) || lots.happens(0.3);
        let slants = (1..panels).map(|_| if is_straight { 0.0 } else { lots.number(-0.1, 0.1) }).collect();
        let is_rigid = lots.happens(0.3);
        let size = if is_rigid { 0.0 } else { lots.size(1e-6, 5e-2) };
        // stretched in both directions, so that the sheet is stable
        let [long, wide, shear] =
            [lots.number(0.5, 1.0), lots.number(0.5, 1.0), lots.number(-0.3, 0.3)].map(|own| own * size);
        let stretch = [[1.0 + long, shear], [shear, 1.0 + wide]];
        let green = |i: usize, j: usize| {
            0.5 * (stretch[0][i] * stretch[0][j] + stretch[1][i] * stretch[1][j] - if i == j { 1.0 } else { 0.0 })
        };
        let [a, b, c] = [green(0, 0), green(1, 1), green(0, 1)];
        let energy = 0.5 * THICKNESS * YOUNG / (1.0 - POISSON * POISSON)
            * (a * a + b * b + 2.0 * POISSON * a * b + 2.0 * (1.0 - POISSON) * c * c);
        let turn = if lots.happens(0.3) { Quaternion::identity() } else { lots.rotation::<f64>() };
        Sheet { kinds, counts, follows, slants, stretch, turn: turn.0, energy }
    }
    fn seam(&self, number: usize, v: f64) -> f64 {
        let panels = self.kinds.len();
        let slant = if number == 0 || number == panels { 0.0 } else { self.slants[number - 1] };
        number as f64 / panels as f64 + slant * v
    }
    /// Where the field moves a place to; all of it begins there but for what is off.
    fn moved(&self, [x, y]: [f64; 2]) -> Vector3<f64> {
        let [[a, b], [c, d]] = self.stretch;
        Quaternion(self.turn).rotate(Vector3::new(a * x + b * y, c * x + d * y, 0.0))
    }
    fn outer(&self, panel: usize) -> Vec<Edge> {
        let mut edges = vec![Edge::SecondStart, Edge::SecondEnd];
        if panel == 0 {
            edges.push(Edge::FirstStart);
        }
        if panel + 1 == self.kinds.len() {
            edges.push(Edge::FirstEnd);
        }
        edges
    }
    fn panels<S: Scalar>(&self, m: &mut MechanismBuilder<S>) -> Vec<ShellMember> {
        let material = Material { young: S::from(YOUNG), poisson: S::from(POISSON), density: S::from(7850.0) };
        let mut panels: Vec<ShellMember> = Vec::new();
        for (number, (&kind, &counts)) in self.kinds.iter().zip(&self.counts).enumerate() {
            let mesh = ShellMesh::on(counts, |u, v| {
                let [start, end] = [self.seam(number, v), self.seam(number + 1, v)];
                [Vector3::from_f64([start + u * (end - start), v, 0.0]), Vector3::from_f64([0.0, 0.0, 1.0])]
            });
            let mesh = self.outer(number).into_iter().fold(mesh.with_faces(kind), |mesh, edge| mesh.clamped(edge));
            let fits = number > 0 && self.fits(number);
            let mesh = match panels.last() {
                Some(before) if fits => m.joined(mesh, &[before]),
                _ => mesh,
            };
            panels.push(m.shell(&format!("panel {}", number + 1), mesh, &material, S::from(THICKNESS)));
        }
        panels
    }
    /// Whether a panel has the nodes of the one before it.
    fn fits(&self, number: usize) -> bool {
        self.kinds[number] == self.kinds[number - 1] && self.counts[number][1] == self.counts[number - 1][1]
    }
    /// What is off: places and rotations, and the energy as a share of its limit.
    fn error(&self) -> Result<[f64; 2], String> {
        let prepared = Prepared::new(self).map_err(|error| error.to_string())?;
        let forward = prepared.analysis().forward(&[]).map_err(|error| error.to_string())?;
        let q = prepared.equilibrium().map_err(|error| error.to_string())?.q;
        if forward.stability.map(|course| course.end.verdict()) != Some(Verdict::Stable) {
            return Err(format!("a stretched sheet is said to be {:?}", forward.stability));
        }
        let mut still = MechanismBuilder::<f64>::default();
        self.panels(&mut still);
        let mut largest = 0.0_f64;
        let axes = Quaternion(self.turn).columns();
        for (own, start) in q.chunks_exact(7).zip(still.numbers.q.chunks_exact(7)) {
            let place = self.moved([start[0], start[1]]).components();
            let turned = Quaternion::from_slice(&own[3..]).columns();
            for axis in 0..3 {
                largest = largest.max((own[axis] - place[axis]).abs());
                largest =
                    largest.max((turned[axis] - axes[axis]).components().iter().fold(0.0, |most, x| most.max(x.abs())));
            }
        }
        let limit = ENERGY[0] * self.energy + ENERGY[1] * THICKNESS * YOUNG;
        Ok([largest, (forward.values[0] - self.energy).abs() / limit])
    }
}

impl Scene for Sheet {
    fn name(&self) -> String {
        "sheet".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(1).projecting_start()
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let panels = self.panels(m);
        for (number, pair) in panels.windows(2).enumerate().filter(|(number, _)| !self.fits(number + 1)) {
            let edges = [pair[0].edge(Edge::FirstEnd), pair[1].edge(Edge::FirstStart)];
            m.tie(&format!("seam {number}"), &edges[self.follows[number]], &[&pair[1 - self.follows[number]]]);
        }
        let rim: HashSet<NodeId> = panels
            .iter()
            .enumerate()
            .flat_map(|(number, panel)| self.outer(number).into_iter().flat_map(|edge| panel.edge(edge)))
            .collect();
        let all: HashSet<NodeId> = panels.iter().flat_map(|panel| panel.nodes.iter().copied()).collect();
        for node in all {
            let place = m.position(node).map(|own| own.value());
            // in the plane: others may leave it
            let off = if rim.contains(&node) { 0.0 } else { 1e-3 };
            let at = self.moved([place[0] + off * (40.0 * place[1]).sin(), place[1] + off * (30.0 * place[0]).cos()]);
            let first = m.model.node(node).dofs.start;
            let numbers = at.components().into_iter().chain(self.turn);
            numbers.enumerate().for_each(|(k, own)| m.numbers.q[first + k] = S::from(own));
        }
        m.energy_functional("energy", Over::Terminal);
        Ok(())
    }
}

/// Draws sheets and counts what becomes of them.
pub fn count(report: &mut Report) {
    let [mut right, mut errors, mut wrong] = [0.0; 3];
    for seed in 1..=DRAWN * if report.is_long() { 10 } else { 1 } {
        let sheet = Sheet::draw(seed);
        match sheet.error() {
            // written so that a NaN is wrong
            Ok([places, energy]) if places <= OFF && energy <= 1.0 => right += 1.0,
            Ok(off) => {
                report.note(format!("sheet {seed} is off by {off:?}: {sheet:?}"));
                wrong += 1.0;
            }
            Err(why) => {
                report.note(format!("sheet {seed}: {why}: {sheet:?}"));
                errors += 1.0;
            }
        }
    }
    report.inform("sheets joined and tied/right in places, rotations and energy", right);
    report.at_most("sheets joined and tied/ended by an error", errors, 0.0);
    report.at_most("sheets joined and tied/wrong", wrong, 0.0);
}
