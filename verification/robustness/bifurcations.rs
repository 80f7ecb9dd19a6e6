//! Equilibria next to their bifurcations, drawn by lot: columns, chains of links, trusses and arches, and what is said of their stability.

use super::dense_count::{Told, compare};
use super::equilibria::chain;
use crate::Lots;
use crate::Report;
use costate::elements::flexible::Section;
use costate::integrators::{ArcLength, Verdict};
use costate::prelude::*;
use costate::scenes::{BeamLine, FileScene};
use std::f64::consts::PI;

/// Of each kind in the short form; so many times as many in the long one.
const DRAWN: [usize; 4] = [24, 60, 60, 24];
const LONG: usize = 10;
/// Share of signs that may be said to be not known.
const UNKNOWN: f64 = 0.05;
/// Distance from the critical load, as a share of it, within which its sign may be unknown: what its closed form is off by.
const NOTHING: f64 = 1e-12;
/// The same of a stiffness beside those of its bars.
const NO_STIFFNESS: f64 = 1e-12;

#[derive(Default)]
struct Outcomes {
    right: usize,
    unknown: usize,
    errors: usize,
    wrong: usize,
}

impl Outcomes {
    fn report(&self, report: &mut Report, name: &str, unknown: f64) {
        report.inform(format!("bifurcations/{name}/right"), self.right as f64);
        report.inform(format!("bifurcations/{name}/errors"), self.errors as f64);
        report.at_most(format!("bifurcations/{name}/said to be not known"), self.unknown as f64, unknown);
        report.at_most(format!("bifurcations/{name}/wrong"), self.wrong as f64, 0.0);
    }
    fn note(&mut self, told: &Told) {
        match told {
            Told::Right | Told::Open => self.right += 1,
            Told::Unknown => self.unknown += 1,
            Told::Wrong(_) => self.wrong += 1,
        }
    }
}

/// All of them.
pub fn count(report: &mut Report) -> Result<(), String> {
    let times = if report.is_long() { LONG } else { 1 };
    let [columns_drawn, chains_drawn, trusses_drawn, arches_drawn] = DRAWN.map(|count| count * times);
    columns(report, columns_drawn)?;
    chains(report, chains_drawn)?;
    trusses(report, trusses_drawn);
    arches(report, arches_drawn);
    published_arch(report)
}

/// A share of a critical load: away from it by any order of magnitude between two, on either side.
fn beside(lots: &mut Lots, nearest: f64) -> f64 {
    1.0 + lots.pick(&[-1.0, 1.0]) * lots.size(nearest, 0.3)
}

/// Straight columns on 8 elements under their critical load and beside it, against the dense count, and against Euler where their mesh can tell.
fn columns(report: &mut Report, count: usize) -> Result<(), String> {
    /// Share of the critical load that 8 elements and a short column are off by.
    const MESH: f64 = 1e-3;
    let mut outcomes = Outcomes::default();
    for number in 0..count {
        let mut lots = Lots::new(number as u64, 31);
        let share = beside(&mut lots, 1e-8);
        let text = include_str!("column.toml").replace("LOAD", &format!("{}", 0.25 * PI * PI * share)).replace("SIDE", "0");
        let scene = FileScene::parse("column.toml", &text)?;
        let settings = Settings::statics(1 + lots.below(6));
        let method = Prepared::method_of(&settings).map_err(|error| error.to_string())?;
        let prepared = Prepared::with(&scene, &[], method, settings).map_err(|error| error.to_string())?;
        let Ok(forward) = prepared.analysis().forward(&[]) else {
            outcomes.errors += 1;
            continue;
        };
        let told = compare(&prepared, &forward)?;
        let verdict = forward.stability.map(|course| course.end.verdict());
        let expected = if share < 1.0 { Verdict::Stable } else { Verdict::Unstable };
        let is_straight = forward.values[1].abs() < 1e-9;
        if is_straight && (share - 1.0).abs() > MESH && verdict != Some(expected) {
            report.note(format!("a straight column under {share} of its critical load is said to be {verdict:?}"));
            outcomes.wrong += 1;
            continue;
        }
        if let Told::Wrong(numbers) = told {
            report.note(format!("a column under {share} of its critical load: {numbers:?} told, not known, counted"));
        }
        outcomes.note(&told);
    }
    outcomes.report(report, "columns", 0.0);
    Ok(())
}

/// Chains of links under loads beside one of their critical loads.
fn chains(report: &mut Report, count: usize) -> Result<(), String> {
    let mut outcomes = Outcomes::default();
    for number in 0..count {
        let mut lots = Lots::new(number as u64, 32);
        let links = 1 + lots.below(8);
        let (stiffness, length) = (lots.size(1e-3, 1e3), lots.size(0.1, 10.0));
        let critical =
            |j: usize| 4.0 * stiffness * ((2 * j - 1) as f64 * PI / (4 * links + 2) as f64).sin().powi(2) / length;
        let share = beside(&mut lots, 1e-13);
        let load = critical(1 + lots.below(links)) * share;
        let expected = (1..=links).filter(|&j| critical(j) < load).count();
        let scene = FileScene::parse("chain.toml", &chain(links, stiffness, length, load))?;
        let prepared = Prepared::new(&scene).map_err(|error| error.to_string())?;
        let Ok(found) = prepared.equilibrium() else {
            outcomes.errors += 1;
            continue;
        };
        match found.stability.map(|course| course.end) {
            Some(end) if end.determinant.is_none() && end.neutral == 0 && end.negative == expected => outcomes.right += 1,
            // what round-off may be is said
            Some(end) if end.neutral > 0 && (end.negative..=end.negative + end.neutral).contains(&expected) => {
                if (share - 1.0).abs() < NOTHING { outcomes.right += 1 } else { outcomes.unknown += 1 }
            }
            Some(_) if (share - 1.0).abs() < NOTHING => outcomes.right += 1,
            other => {
                report.note(format!(
                    "a chain of {links} links under {share} of a critical load: {other:?}, {expected} expected"
                ));
                outcomes.wrong += 1;
            }
        }
    }
    outcomes.report(report, "chains of links", UNKNOWN * count as f64);
    Ok(())
}

/// Two bars between walls at a distance of two, under a load on the point between them: it snaps through, or goes sideways first where they are steep.
struct Truss {
    height: f64,
    stiffness: f64,
    load: f64,
    sideways: f64,
    steps: usize,
}

impl Truss {
    fn draw(lots: &mut Lots) -> Self {
        let (height, stiffness) = (lots.size(0.1, 5.0), lots.size(1.0, 1e6));
        let mut truss = Truss { height, stiffness, load: 0.0, sideways: 0.0, steps: 1 + lots.below(30) };
        // the first of both critical points on the way down
        let least = |y: f64| truss.stiffnesses([0.0, y]).into_iter().fold(f64::INFINITY, f64::min);
        let ways = (0..=1000).map(|k| height * (1.0 - k as f64 / 1000.0));
        let after = ways.into_iter().find(|&y| least(y) < 0.0).unwrap_or(0.0);
        let (mut low, mut high) = (after, after + height / 1000.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if least(middle) < 0.0 { low = middle } else { high = middle }
        }
        let rest = 1f64.hypot(height);
        truss.load = 2.0 * stiffness * (rest - 1f64.hypot(high)) * high / 1f64.hypot(high) * beside(lots, 1e-10);
        truss.sideways = if lots.happens(0.5) { 0.0 } else { truss.load * lots.size(1e-9, 1e-2) };
        truss
    }
    /// Eigenvalues of the stiffness of the point at (x, y).
    fn stiffnesses(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let rest = 1f64.hypot(self.height);
        let [mut a, mut b, mut c] = [0.0; 3];
        for wall in [-1.0, 1.0] {
            let length = (x - wall).hypot(y);
            let [u, v] = [(x - wall) / length, y / length];
            let across = 1.0 - rest / length;
            a += self.stiffness * (u * u + across * v * v);
            b += self.stiffness * (1.0 - across) * u * v;
            c += self.stiffness * (v * v + across * u * u);
        }
        let (mean, radius) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        [mean - radius, mean + radius]
    }
}

impl Scene for Truss {
    fn name(&self) -> String {
        "truss".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(self.steps)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let (ground, top) = (m.ground(), at([0.0, self.height, 0.0]));
        let point = m.point("point", top);
        m.point_in_plane("plane", [ground, point], top, at([0.0, 0.0, 1.0]));
        let rest = S::from(1f64.hypot(self.height));
        for (name, wall) in [("left", -1.0), ("right", 1.0)] {
            m.line_spring(name, [ground, point], [at([wall, 0.0, 0.0]), top], S::from(self.stiffness), rest);
        }
        for (name, direction, load) in [("down", [0.0, -1.0, 0.0], self.load), ("sideways", [1.0, 0.0, 0.0], self.sideways)]
        {
            let size = Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(load)]);
            m.force(name, Force { on: point, point: top, direction: at(direction), frame: LoadFrame::World, size });
        }
        m.position_functional("x", Over::Terminal, point, top, at([1.0, 0.0, 0.0]));
        m.position_functional("y", Over::Terminal, point, top, at([0.0, 1.0, 0.0]));
        Ok(())
    }
}

/// Trusses, whose stiffness is known where they end, whatever branch that is on; and the dense count.
fn trusses(report: &mut Report, count: usize) {
    let mut outcomes = Outcomes::default();
    for number in 0..count {
        let truss = Truss::draw(&mut Lots::new(number as u64, 33));
        let ended = Prepared::new(&truss).and_then(|prepared| {
            let forward = prepared.analysis().forward(&[])?;
            let told = compare(&prepared, &forward).map_err(RunError::Input)?;
            Ok((forward, told))
        });
        let Ok((forward, told)) = ended else {
            outcomes.errors += 1;
            continue;
        };
        let stiffnesses = truss.stiffnesses([forward.values[0], forward.values[1]]);
        let open = NO_STIFFNESS * truss.stiffness;
        let [surely, possibly] = [-open, open].map(|bound| stiffnesses.iter().filter(|own| **own < bound).count());
        let end = forward.stability.map(|course| course.end).unwrap_or_default();
        let is_wrong = end.negative > possibly || end.negative + end.neutral < surely || end.determinant.is_some();
        if is_wrong || matches!(told, Told::Wrong(_)) {
            report.note(format!("truss {number}: {end:?}, {told:?} by the dense count, stiffnesses {stiffnesses:?}"));
            outcomes.wrong += 1;
        } else {
            outcomes.note(&told);
        }
    }
    outcomes.report(report, "trusses", UNKNOWN * count as f64);
}

/// An arch of a circle with EI = R = 1 in its plane as a curved beam, under a dead load on its crown.
struct Arch {
    /// Of the whole arch.
    angle: f64,
    axial: f64,
    /// Stiffness against torsion, and against bending out of the plane.
    out_of_plane: [f64; 2],
    /// Which end is clamped; others stand on hinges.
    clamped: [bool; 2],
    half: usize,
    /// Beside the load, as a share of it: in the plane and out of it.
    aside: [f64; 2],
    load: f64,
    steps: usize,
}

impl Arch {
    fn draw(lots: &mut Lots) -> Self {
        let aside = [(); 2].map(|()| if lots.happens(0.5) { 0.0 } else { lots.size(1e-9, 1e-2) });
        let mut arch = Arch {
            angle: lots.number(0.6, 4.5),
            axial: lots.size(1e3, 1e6),
            out_of_plane: [(); 2].map(|()| lots.size(0.1, 10.0)),
            clamped: [(); 2].map(|()| lots.happens(0.5)),
            half: 1 + lots.below(4),
            aside,
            load: 0.0,
            steps: 1 + lots.below(20),
        };
        // beyond the load under which an arch on hinges goes sideways
        let beyond = 60.0 / (arch.angle * arch.angle).min(1.0);
        let (mut low, mut high) = (0.0, beyond);
        for _ in 0..30 {
            arch.load = 0.5 * (low + high);
            let ended = Prepared::new(&arch).and_then(|prepared| prepared.analysis().forward(&[]));
            let stands = ended.is_ok_and(|forward| {
                forward.stability.is_some_and(|course| course.lost.is_none() && course.end.verdict() == Verdict::Stable)
            });
            if stands { low = arch.load } else { high = arch.load }
        }
        arch.load = low * beside(lots, 1e-8);
        arch
    }
}

impl Scene for Arch {
    fn name(&self) -> String {
        "arch".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Vec::new()
    }
    fn settings(&self) -> Settings {
        Settings::statics(self.steps)
    }
    fn build<S: Scalar>(&self, _x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let at = |x: [f64; 3]| Vector3::<S>::from_f64(x);
        let (ground, axis) = (m.ground(), at([0.0, 0.0, 1.0]));
        let place = |angle: f64| at([angle.sin(), angle.cos(), 0.0]);
        let (left, right) = (place(-0.5 * self.angle), place(0.5 * self.angle));
        let mut line = BeamLine::arc(left, Vector3::zeros(), -axis, S::from(self.angle), 2 * self.half);
        if self.clamped[0] {
            line = line.clamped_start();
        }
        if self.clamped[1] {
            line = line.clamped_end();
        }
        // section axis 2 lies along the axis of the arch, so that bending in its plane is about it
        let [torsion, aside] = self.out_of_plane;
        let section = Section::new([self.axial, self.axial, self.axial, torsion, 1.0, aside].map(S::from));
        let section = section.with_inertia(S::one(), [S::from(1e-6); 2]);
        let arch = m.beam("arch", line, &section);
        for (end, (node, at)) in [(arch.start(), left), (arch.end(), right)].into_iter().enumerate() {
            if !self.clamped[end] {
                m.revolute(&format!("hinge {end}"), [ground, node], at, axis);
            }
        }
        let crown = arch.nodes[2 * self.half];
        let direction = at([self.aside[0], -1.0, self.aside[1]]);
        let size = Signal::of(TimeFunction::ConstantRate, &[S::zero(), S::from(self.load)]);
        m.force("load", Force { on: crown, point: place(0.0), direction, frame: LoadFrame::World, size });
        Ok(())
    }
}

/// Arches next to the load at which they lose their stability, against the dense count.
fn arches(report: &mut Report, count: usize) {
    let (mut outcomes, mut unstable) = (Outcomes::default(), 0);
    for number in 0..count {
        let arch = Arch::draw(&mut Lots::new(number as u64, 34));
        let ended = Prepared::new(&arch).and_then(|prepared| {
            let forward = prepared.analysis().forward(&[])?;
            let told = compare(&prepared, &forward).map_err(RunError::Input)?;
            Ok((forward, told))
        });
        let Ok((forward, told)) = ended else {
            outcomes.errors += 1;
            continue;
        };
        unstable += usize::from(forward.stability.is_some_and(|course| course.end.verdict() == Verdict::Unstable));
        if matches!(told, Told::Wrong(_)) {
            report.note(format!("arch {number}: {:?}, {told:?} by the dense count", forward.stability));
        }
        outcomes.note(&told);
    }
    outcomes.report(report, "arches", UNKNOWN * count as f64);
    report.inform("bifurcations/arches/unstable among them", unstable as f64);
}

/// An arch of 215 degrees, clamped at one end and on a hinge at the other, that snaps through: 8.97 EI/R2, DaDeppo & Schmidt (1975).
fn published_arch(report: &mut Report) -> Result<(), String> {
    let arch = Arch {
        angle: 215.0_f64.to_radians(),
        axial: 1e6,
        out_of_plane: [1e2; 2],
        clamped: [true, false],
        half: 8,
        aside: [0.0; 2],
        load: 10.0,
        steps: 20,
    };
    let prepared = Prepared::new(&arch).map_err(|error| error.to_string())?;
    let path = prepared.path(&ArcLength::new(0.05)).map_err(|error| error.to_string())?;
    let first = path.limits.first().ok_or("the load on the arch has no limit")?;
    report.compare("bifurcations/arch of 215 degrees/limit load by the published one", first.load * 10.0 / 8.97, 1.0, 0.005);
    let forward = prepared.analysis().forward(&[]);
    let stands = forward.is_ok_and(|forward| {
        forward.stability.is_some_and(|course| course.lost.is_none() && course.end.verdict() == Verdict::Stable)
    });
    report.at_most("bifurcations/arch of 215 degrees/said to stand all the way to beyond it", f64::from(stands), 0.0);
    Ok(())
}
