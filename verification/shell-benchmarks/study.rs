mod patch;
mod scenes;
mod solve;

use crate::{Noise, Report, Study};
use costate::elements::flexible::FaceKind;
use costate::integrators::ArcLength;
use costate::prelude::*;
use patch::{Field, Patch, place};
use scenes::{Benchmark, Problem};
use solve::solve;

/// Shells against patches of constant strain, published benchmarks, and what must not change.
pub struct ShellBenchmarks;

impl Study for ShellBenchmarks {
    fn name(&self) -> &'static str {
        "shell-benchmarks"
    }
    fn summary(&self) -> &'static str {
        "shells against patches of constant strain, published static benchmarks, invariance, and vibrations of a plate"
    }
    fn run(&self, report: &mut Report) -> Result<(), String> {
        let parts: [(&str, Part); 12] = [
            ("patches", patches),
            ("thin limit", thin_limit),
            ("roof", roof),
            ("pinched cylinder", pinched_cylinder),
            ("hemisphere", hemisphere),
            ("twisted beam", twisted_beam),
            ("tube", tube),
            ("vibrations", vibrations),
            ("end shear", end_shear),
            ("roll-up", roll_up),
            ("hemisphere, large", large_hemisphere),
            ("hinged roof", hinged_roof),
        ];
        for (index, (title, part)) in parts.iter().enumerate() {
            eprintln!("[{}/{}] {title}", index + 1, parts.len());
            part(report).map_err(|error| format!("{title}: {error}"))?;
        }
        Ok(())
    }
}

/// Measures one problem.
type Part = fn(&mut Report) -> Result<(), String>;

/// Kinds of faces, with their names in figures.
const FACES: [(FaceKind, &str); 3] =
    [(FaceKind::Quad9, ""), (FaceKind::Quad4, "four nodes/"), (FaceKind::Triangle6, "triangles of six/")];

fn patches(report: &mut Report) -> Result<(), String> {
    let fields =
        [(Field::Membrane, "membrane"), (Field::Bending, "bending"), (Field::Twist, "twist"), (Field::Shear, "shear")];
    for ((face, of), (field, name)) in FACES.into_iter().flat_map(|face| fields.map(|field| (face, field))) {
        for thickness in [0.1, 0.001] {
            let size = field.size(thickness);
            let solved = solve(&Patch { field, face, thickness }, 1)
                .map_err(|why| format!("{of}{name}, thickness {thickness}: {why}"))?;
            let mut worst: f64 = 0.0;
            for (i, j) in (1..4).flat_map(|j| (1..4).map(move |i| (i, j))) {
                let own = solved.node(solved.last(), i, j)?;
                let (x, e) = field.at(size, place(face, i, j));
                let directors = [Quaternion::from_slice(&own[3..]), Quaternion(e)].map(|e| e.columns()[2]);
                // displacements along the plane and the director's normal component are of second order where the others are small
                let (places, turns) = if size < 1.0 { (2..3, 0..2) } else { (0..3, 0..3) };
                let places = places.map(|k| own[k] - x[k]);
                let turns = turns.map(|k| directors[0][k] - directors[1][k]);
                worst = places.chain(turns).fold(worst, |worst, error| worst.max(error.abs() / size));
            }
            report.at_most(format!("{of}patch/{name}/thickness {thickness}/largest error by the field"), worst, 1e-9);
        }
    }
    Ok(())
}

fn thin_limit(report: &mut Report) -> Result<(), String> {
    // Timoshenko and Woinowsky-Krieger, clamped square plate: w = 0.00126532 q a^4 / D
    let reference = 0.001_265_32;
    for (face, of) in FACES {
        for thickness in [1e-2, 1e-3, 1e-4] {
            // a hundredth of the thickness
            let share = 0.01 * thickness / reference;
            for elements in [4, 8] {
                let plate = Benchmark::linear(Problem::ClampedPlate { thickness }, [elements; 2], share);
                let solved = solve(&Benchmark { face, ..plate }, 1)?;
                let w = -solved.displacement(solved.last(), elements, elements)?[2] / share;
                let name = format!("{of}thin limit/t by a {thickness}/{elements} x {elements} elements/deflection");
                if elements == 8 && thickness < 5e-3 {
                    let tolerance = if face == FaceKind::Quad9 { 0.002 } else { 0.01 };
                    report.compare(name, w / reference, 1.0, tolerance);
                } else {
                    report.inform(name, w / reference);
                }
            }
        }
    }
    Ok(())
}

/// Deflections of linear theory on finer and finer meshes, of all kinds of faces on the same nodes: the finest ones.
fn converging(
    report: &mut Report,
    name: &str,
    problem: Problem,
    (meshes, share): (&[usize], f64),
    deflection: impl Fn(&solve::Solved, usize) -> Result<f64, String>,
) -> Result<[f64; 3], String> {
    let mut finest = [0.0; 3];
    for ((face, of), finest) in FACES.into_iter().zip(&mut finest) {
        for &elements in meshes {
            let problem = Benchmark { face, ..Benchmark::linear(problem, [elements; 2], share) };
            let solved = solve(&problem, 1)?;
            *finest = deflection(&solved, elements)? / share;
            report.inform(format!("{of}{name}/{elements} x {elements} elements"), *finest);
        }
    }
    Ok(finest)
}

fn roof(report: &mut Report) -> Result<(), String> {
    let edge = |solved: &solve::Solved, elements: usize| Ok(-solved.displacement(solved.last(), 2 * elements, 0)?[2]);
    let all = converging(report, "roof/deflection of the free edge", Problem::Roof, (&[2, 4, 8], 1e-5), edge)?;
    report.compare("roof/8 x 8 elements/deflection by that of thin shells", all[0] / 0.3024, 1.0, 0.01);
    report.compare("roof/8 x 8 elements/deflection by that with shear", all[0] / 0.3006, 1.0, 0.003);
    report.compare("four nodes/roof/8 x 8 elements/deflection by that with shear", all[1] / 0.3006, 1.0, 0.02);
    report.compare("triangles of six/roof/8 x 8 elements/deflection by that with shear", all[2] / 0.3006, 1.0, 0.01);
    Ok(())
}

fn pinched_cylinder(report: &mut Report) -> Result<(), String> {
    let crown = |solved: &solve::Solved, _| Ok(-solved.displacement(solved.last(), 0, 0)?[2]);
    let meshes = (&[4, 8, 16][..], 1.0);
    let all = converging(report, "pinched cylinder/deflection", Problem::PinchedCylinder, meshes, crown)?;
    for (((_, of), own), tolerance) in FACES.into_iter().zip(all).zip([0.01, 0.03, 0.1]) {
        report.compare(format!("{of}pinched cylinder/16 x 16 elements/deflection"), own / 1.8248e-5, 1.0, tolerance);
    }
    Ok(())
}

fn hemisphere(report: &mut Report) -> Result<(), String> {
    let inwards = |solved: &solve::Solved, _| Ok(-solved.displacement(solved.last(), 0, 0)?[0] * 0.005);
    let meshes = (&[4, 8, 16][..], 1e-5);
    let all = converging(report, "hemisphere/deflection under a force of 2", Problem::Hemisphere, meshes, inwards)?;
    for (((_, of), own), tolerance) in FACES.into_iter().zip(all).zip([0.0005, 0.001, 0.001]) {
        let name = format!("{of}hemisphere/16 x 16 elements/deflection under a force of 2");
        report.compare(name, own, 0.0935, tolerance);
    }
    Ok(())
}

/// Deflections by those of the references; the penalty on drilling rotations must not lock what is thin and twisted.
fn twisted_beam(report: &mut Report) -> Result<(), String> {
    let problems =
        [(0.32, true, 0.005_424), (0.32, false, 0.001_754), (0.0032, true, 0.005_256), (0.0032, false, 0.001_294)];
    for ((face, of), (thickness, in_plane, reference)) in
        FACES.into_iter().flat_map(|face| problems.map(|problem| (face, problem)))
    {
        for elements in [[6, 1], [12, 2], [24, 4]] {
            let problem = Benchmark::linear(Problem::TwistedBeam { thickness, in_plane }, elements, 1.0);
            let solved = solve(&Benchmark { face, ..problem }, 1)?;
            let u = solved.displacement(solved.last(), 2 * elements[0], elements[1])?[if in_plane { 2 } else { 1 }];
            let (way, [along, across]) = (if in_plane { "in plane" } else { "out of plane" }, elements);
            let name = format!("{of}twisted beam/t {thickness}/{way}/{along} x {across} elements/deflection");
            let tolerance = match face {
                FaceKind::Quad9 => Some(0.006),
                FaceKind::Quad4 => (along == 24).then_some(0.01),
                FaceKind::Triangle6 => Some(match along {
                    24 if thickness == 0.32 => 0.003,
                    24 => 0.005,
                    _ => 0.02,
                }),
            };
            match tolerance {
                Some(tolerance) => report.compare(name, u / reference, 1.0, tolerance),
                None => report.inform(name, u / reference),
            }
        }
    }
    Ok(())
}

/// Radial displacements of a thin tube under pressure: what bends it, and what stretches it beside the pressure, must not widen it.
fn tube(report: &mut Report) -> Result<(), String> {
    let share = 1e-6;
    for ((face, of), thickness) in FACES.into_iter().flat_map(|face| [0.01, 0.001].map(|thickness| (face, thickness))) {
        for elements in [2, 4, 8] {
            let problem = Benchmark::linear(Problem::Tube { thickness }, [elements; 2], share);
            let solved = solve(&Benchmark { face, ..problem }, 1)?;
            // four nodes stand at those of the finer mesh
            let places = (0..=2 * elements).flat_map(|i| (0..=2 * elements).map(move |j| (i, j)));
            let mut widening = Vec::new();
            for (i, j) in places {
                let [x, _, z] = solved.displacement(solved.last(), i, j)?;
                let (sin, cos) = (0.25 * std::f64::consts::PI * i as f64 / elements as f64).sin_cos();
                widening.push((x * sin + z * cos) / share);
            }
            let mean = widening.iter().sum::<f64>() / widening.len() as f64;
            let worst = widening.iter().fold(0.0, |worst: f64, own| worst.max((own - 1.0).abs()));
            let name = |what: &str| format!("{of}tube/t by R {thickness}/{elements} x {elements} elements/{what}");
            let [all, one] = ["widening, mean of the nodes", "widening, largest error of a node"].map(name);
            if elements == 8 {
                report.compare(all, mean, 1.0, 0.005);
                report.at_most(one, worst, 0.05);
            } else {
                report.inform(all, mean);
                report.inform(one, worst);
            }
        }
    }
    Ok(())
}

fn vibrations(report: &mut Report) -> Result<(), String> {
    // omega a^2 sqrt(rho h / D), thin plate
    let reference = [3.4710, 8.5065, 21.2846, 27.1988, 30.9555];
    let thickness = 0.002;
    let bending = thickness * (1.0_f64 / (12.0 * (1.0 - 0.09))).sqrt();
    for ((face, of), tolerance) in FACES.into_iter().zip([0.003, 0.01, 0.01]) {
        let mut coarse = Vec::new();
        for elements in [4, 8] {
            let plate = Benchmark::new(Problem::CantileverPlate { thickness }, [elements; 2]);
            let plate = Benchmark { face, ..plate };
            let prepared = Prepared::with(&plate, &[], Prepared::default_method(), Settings::new(1.0, 1))
                .map_err(|error| error.to_string())?;
            let modes = prepared.modes(10).map_err(|error| error.to_string())?;
            // a mode of drilling rotations would follow the length of the elements
            for (number, (fine, coarse)) in modes.iter().zip(&coarse).enumerate().skip(reference.len()) {
                let name = format!("{of}cantilever plate/frequency {} by that of 4 x 4 elements", number + 1);
                report.compare(name, fine.frequency / coarse, 1.0, 0.1);
            }
            coarse = modes.iter().map(|mode| mode.frequency).collect();
            for (number, (mode, reference)) in modes.iter().zip(reference).enumerate() {
                let name = format!("{of}cantilever plate/{elements} x {elements} elements/frequency {}", number + 1);
                let ratio = mode.frequency / bending / reference;
                if elements == 8 { report.compare(name, ratio, 1.0, tolerance) } else { report.inform(name, ratio) }
            }
        }
    }
    Ok(())
}

/// Rows of a table.
fn rows(table: &'static str) -> Result<Vec<Vec<f64>>, String> {
    let parse =
        |line: &'static str| line.split(',').map(|field| field.trim().parse::<f64>().ok()).collect::<Option<Vec<f64>>>();
    let rows = table.lines().skip(1).filter(|line| !line.is_empty());
    rows.map(|line| parse(line).ok_or_else(|| format!("the row \"{line}\" is no row of numbers"))).collect()
}

/// Largest difference of displacements from columns of a table, by the largest displacement in it.
fn against(
    table: &'static str,
    columns: [usize; 2],
    equilibria: &[Vec<f64>],
    own: impl Fn(&[f64]) -> Result<[f64; 2], String>,
) -> Result<f64, String> {
    let rows: Vec<Vec<f64>> = rows(table)?.into_iter().filter(|row| row[0] > 0.0).collect();
    if rows.len() != equilibria.len() {
        return Err(format!("{} rows, but {} equilibria", rows.len(), equilibria.len()));
    }
    let mut worst: f64 = 0.0;
    for (k, column) in columns.into_iter().enumerate() {
        let largest = rows.iter().fold(0.0, |largest: f64, row| largest.max(row[column].abs()));
        for (row, q) in rows.iter().zip(equilibria) {
            worst = worst.max((own(q)?[k] - row[column]).abs() / largest);
        }
    }
    Ok(worst)
}

fn end_shear(report: &mut Report) -> Result<(), String> {
    for elements in [4, 8, 16] {
        let solved = solve(&Benchmark::new(Problem::EndShear, [elements, 1]), 20)?;
        let tip = |q: &[f64]| {
            let [u, _, w] = solved.displacement(q, 2 * elements, 1)?;
            Ok([-u, w])
        };
        let worst = against(include_str!("sze31_cantilever_end_shear.csv"), [1, 2], &solved.equilibria, tip)?;
        let name = format!("end shear/{elements} x 1 elements/largest error by the largest displacement");
        if elements == 16 { report.at_most(name, worst, 0.005) } else { report.inform(name, worst) }
    }
    Ok(())
}

fn roll_up(report: &mut Report) -> Result<(), String> {
    for elements in [8, 16] {
        let bar = Benchmark { load_steps: 100, ..Benchmark::new(Problem::EndMoment, [elements, 1]) };
        let solved = solve(&bar, 20)?;
        let tip = |q: &[f64]| {
            let [u, _, w] = solved.displacement(q, 2 * elements, 1)?;
            Ok([-u, w])
        };
        let worst = against(include_str!("sze32_cantilever_end_moment.csv"), [2, 4], &solved.equilibria, tip)?;
        let [u, _, w] = solved.displacement(solved.last(), 2 * elements, 1)?;
        let gap = (u + 12.0).hypot(w) / 12.0;
        let names = ["largest error by the largest displacement", "gap of the circle by L"];
        let [error, gap_name] = names.map(|name| format!("roll-up/{elements} x 1 elements/{name}"));
        if elements == 16 {
            report.at_most(error, worst, 0.005);
            report.at_most(gap_name, gap, 0.002);
        } else {
            report.inform(error, worst);
            report.inform(gap_name, gap);
        }
    }
    Ok(())
}

fn large_hemisphere(report: &mut Report) -> Result<(), String> {
    for elements in [4, 8, 16] {
        let solved = solve(&Benchmark::new(Problem::Hemisphere, [elements; 2]), 20)?;
        let ends = |q: &[f64]| {
            let out = solved.displacement(q, 2 * elements, 0)?;
            let inwards = solved.displacement(q, 0, 0)?;
            Ok([out[1], -inwards[0]])
        };
        let worst = against(include_str!("sze34_hemisphere_hole.csv"), [1, 2], &solved.equilibria, ends)?;
        let name = format!("hemisphere, large/{elements} x {elements} elements/largest error by the largest displacement");
        if elements == 16 {
            report.at_most(name, worst, 0.01)
        } else {
            report.inform(name, worst)
        }
        if elements == 4 {
            invariance(report, &solved);
        }
    }
    Ok(())
}

/// Snap-through of a shallow roof: the largest load before it, along the path by its arc length.
fn hinged_roof(report: &mut Report) -> Result<(), String> {
    // limit of the load [N], of a published curve to two digits
    for (thickness, limit) in [(12.7, 2200.0)] {
        for elements in [4, 8] {
            let roof = Benchmark::new(Problem::HingedRoof { thickness }, [elements; 2]);
            let prepared = Prepared::new(&roof).map_err(|error| error.to_string())?;
            let crown = prepared.model().nodes.iter().find(|node| node.name == "shell[0,0]");
            let height = crown.ok_or("no node at the crown")?.dofs.start + 2;
            let start = prepared.problem().start.q[height];
            // 24 mm down the roof has snapped through, and less than the whole load holds it there
            let arc = ArcLength::new(0.1).up_to_coordinate(height, start - 24.0);
            let path = prepared.path(&arc).map_err(|error| error.to_string())?;
            let Some(first) = path.limits.first() else { return Err("the load has no limit".into()) };
            let name = |what: &str| format!("hinged roof/{thickness} mm/{elements} x {elements} elements/{what}");
            let share = 3000.0 * first.load / limit;
            if elements == 8 {
                report.compare(name("limit load by the published one"), share, 1.0, 0.03);
            } else {
                report.inform(name("limit load by the published one"), share);
            }
            report.inform(name("deflection there [mm]"), start - first.q[height]);
            let least = path
                .points
                .iter()
                .fold(f64::INFINITY, |least, point| least.min(if point.q[height] < start { point.load } else { least }));
            report.inform(name("least load of the path [N]"), 3000.0 * least);
        }
    }
    Ok(())
}

/// The strain energy of a shell under rigid motions of its nodes.
fn invariance(report: &mut Report, solved: &solve::Solved) {
    let (q, mut random) = (solved.last(), Noise::new(1));
    let energy = solved.energy(q);
    let mut worst: f64 = 0.0;
    for _ in 0..1000 {
        let turn = Quaternion(std::array::from_fn(|_| random.next()));
        let norm = turn.norm_squared().sqrt();
        let turn = Quaternion(turn.0.map(|e| e / norm));
        let shift = Vector3::from(std::array::from_fn(|_| random.next()));
        let moved: Vec<f64> = q
            .chunks_exact(7)
            .flat_map(|node| {
                let place = turn.rotate(Vector3::first_three(node)) + shift;
                place.components().into_iter().chain(turn.times(Quaternion::from_slice(&node[3..])).0)
            })
            .collect();
        worst = worst.max((solved.energy(&moved) / energy - 1.0).abs());
    }
    report.at_most("invariance/strain energy under 1000 rigid motions, relative change", worst, 1e-12);
}
