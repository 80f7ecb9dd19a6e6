//! Files for ParaView, read back by the rules of their format: what is written is what was computed.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use costate::elements::flexible::FaceKind;
use costate_cli::io::{Attribute, MeshCell, MeshSeries, UnstructuredMesh, read_csv};
use flate2::read::ZlibDecoder;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder of its own for one test, removed when dropped.
struct Folder(PathBuf);
impl Folder {
    fn new(name: &str) -> Self {
        Folder(std::env::temp_dir().join(format!("costate-meshes-{}-{name}", std::process::id())))
    }
}
impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The arrays of a file by section and name, by the rules of VTK's XML formats: compressed blocks behind the text, in base64, each array with
/// a header of its own (number of blocks, bytes of a block, bytes of a last one that is not full or 0, bytes of each when compressed).
///
/// Source: docs.vtk.org, VTKXMLFileFormats.
struct Arrays(HashMap<(String, String), (String, Vec<u8>)>);

impl Arrays {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("text");
        let document = roxmltree::Document::parse(&text).expect("XML");
        let root = document.root_element();
        let said =
            ["type", "byte_order", "header_type", "compressor"].map(|name| root.attribute(name).expect("an attribute"));
        assert_eq!(said, ["UnstructuredGrid", "LittleEndian", "UInt64", "vtkZLibDataCompressor"]);
        let appended = document.descendants().find(|node| node.has_tag_name("AppendedData")).expect("data");
        let letters = appended.text().expect("letters").trim().strip_prefix('_').expect("a mark before the data");
        let mut all = HashMap::new();
        for array in document.descendants().filter(|node| node.has_tag_name("DataArray")) {
            let said = |name: &str| array.attribute(name).expect("an attribute").to_string();
            let section = array.parent().expect("a section").tag_name().name().to_string();
            let place: usize = said("offset").parse().expect("a number");
            all.insert((section, said("Name")), (said("type"), unpacked(&letters[place..])));
        }
        Arrays(all)
    }
    fn of(&self, section: &str, name: &str, kind: &str) -> &[u8] {
        let found = self.0.get(&(section.to_string(), name.to_string()));
        let (own, bytes) = found.unwrap_or_else(|| panic!("no \"{name}\" in {section}"));
        assert_eq!(own, kind, "{name}");
        bytes
    }
    fn numbers(&self, section: &str, name: &str) -> Vec<f64> {
        words(self.of(section, name, "Float64")).map(f64::from_le_bytes).collect()
    }
    fn indices(&self, name: &str) -> Vec<i64> {
        words(self.of("Cells", name, "Int64")).map(i64::from_le_bytes).collect()
    }
}

fn words(bytes: &[u8]) -> impl Iterator<Item = [u8; 8]> {
    bytes.chunks(8).map(|word| word.try_into().expect("eight bytes"))
}

/// The bytes of an array at the start of some letters.
fn unpacked(letters: &str) -> Vec<u8> {
    // encoded on its own: as many letters as its bytes take, filled up to four
    let decoded = |from: usize, bytes: usize| {
        let own = &letters[from..from + bytes.div_ceil(3) * 4];
        (STANDARD.decode(own).expect("base64"), from + own.len())
    };
    let sizes = |count: usize| {
        let (bytes, end) = decoded(0, 8 * count);
        (words(&bytes).map(|word| u64::from_le_bytes(word) as usize).collect::<Vec<_>>(), end)
    };
    // three bytes are four letters: the first three numbers can be read alone
    let blocks = sizes(3).0[0];
    let (header, start) = sizes(3 + blocks);
    let (compressed, _) = decoded(start, header[3..].iter().sum());
    let (mut rest, mut all) = (&compressed[..], Vec::new());
    for (block, &size) in header[3..].iter().enumerate() {
        let (own, others) = rest.split_at(size);
        let before = all.len();
        ZlibDecoder::new(own).read_to_end(&mut all).expect("a compressed block");
        let full = block + 1 < blocks || header[2] == 0;
        assert_eq!(all.len() - before, if full { header[1] } else { header[2] });
        rest = others;
    }
    all
}

/// VTK's numbers of cells.
const VERTEX: u8 = 1;
const POLY_LINE: u8 = 4;
const QUAD: u8 = 9;
const QUADRATIC_TRIANGLE: u8 = 22;
const BIQUADRATIC_QUAD: u8 = 28;

#[test]
fn a_mesh_is_read_as_it_was_written() {
    let folder = Folder::new("mesh");
    let place = |i: usize| [(i % 3) as f64, (i / 3) as f64, 0.1 * i as f64];
    let points: Vec<[f64; 3]> = (0..10).map(place).collect();
    let cells = vec![
        MeshCell::Face(FaceKind::Quad9, (0..9).collect()),
        MeshCell::Face(FaceKind::Quad4, vec![1, 2, 4, 5]),
        MeshCell::Face(FaceKind::Triangle6, vec![0, 2, 8, 1, 5, 4]),
        MeshCell::PolyLine(vec![0, 4, 9]),
        MeshCell::Vertex(7),
    ];
    let values: Vec<f64> = (0..30).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let point_data = vec![Attribute { name: "displacement [m]".into(), components: 3, values: values.clone() }];
    let cell_data =
        vec![Attribute { name: "a < \"b\" & c".into(), components: 1, values: vec![1.5, -2.0, 1e300, 0.0, 7.0] }];
    let mesh = UnstructuredMesh { points: points.clone(), cells, point_data, cell_data };
    let mut series = MeshSeries::new(&folder.0, "fields");
    series.add(0.25, &mesh).expect("written");
    let pvd = std::fs::read_to_string(series.finish().expect("written")).expect("text");
    assert!(pvd.contains("timestep=\"0.25\" part=\"0\" file=\"fields-000000.vtu\""), "{pvd}");
    let arrays = Arrays::read(&folder.0.join("fields-000000.vtu"));
    assert_eq!(arrays.numbers("Points", "points"), points.concat());
    assert_eq!(arrays.of("Cells", "types", "UInt8"), [BIQUADRATIC_QUAD, QUAD, QUADRATIC_TRIANGLE, POLY_LINE, VERTEX]);
    // corners of each element, middles of its edges, its centre
    let elements = [0, 2, 8, 6, 1, 5, 7, 3, 4, 1, 2, 5, 4, 0, 2, 8, 1, 5, 4];
    assert_eq!(arrays.indices("connectivity"), [&elements[..], &[0, 4, 9, 7]].concat());
    assert_eq!(arrays.indices("offsets"), [9, 13, 19, 22, 23]);
    assert_eq!(arrays.numbers("PointData", "displacement [m]"), values);
    assert_eq!(arrays.numbers("CellData", "a < \"b\" & c"), [1.5, -2.0, 1e300, 0.0, 7.0]);
    // more than one block
    let many: Vec<[f64; 3]> = (0..100_000).map(|i| [f64::from(i).sin(), f64::from(i), 0.0]).collect();
    let cloud = UnstructuredMesh { points: many.clone(), ..UnstructuredMesh::default() };
    cloud.write(&folder.0.join("cloud.vtu")).expect("written");
    assert_eq!(Arrays::read(&folder.0.join("cloud.vtu")).numbers("Points", "points"), many.concat());
    let short = Attribute { name: "short".into(), components: 3, values: vec![0.0; 4] };
    let error = UnstructuredMesh { point_data: vec![short], ..mesh }.write(&folder.0.join("x.vtu")).expect_err("refused");
    assert!(error.to_string().contains("\"short\" has 4 values for 10 points with 3 components each"), "{error}");
}

#[test]
fn a_run_writes_where_its_shell_stands_and_how_it_is_stressed() {
    let folder = Folder::new("run");
    let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
    command.args(["run", "plate-pendulum", "--steps", "3", "--end", "0.03", "--set", "thickness 2=0.02", "--vtk", "--out"]);
    let output = command.arg(&folder.0).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("fields.pvd"), "{}", String::from_utf8_lossy(&output.stdout));
    let (header, rows) = read_csv(&folder.0.join("histories.csv")).expect("histories");
    let last = rows.last().expect("rows");
    let column = |name: &str| last[header.iter().position(|own| own == name).unwrap_or_else(|| panic!("{name}"))];
    let arrays = Arrays::read(&folder.0.join("fields-000003.vtu"));
    assert!(!folder.0.join("fields-000004.vtu").exists());
    let (points, displacements) = (arrays.numbers("Points", "points"), arrays.numbers("PointData", "displacement [m]"));
    // the corner beside the tip
    let corner = points
        .chunks_exact(3)
        .zip(displacements.chunks_exact(3))
        .position(|(x, _)| (x[0] - 0.25).abs() + x[1].abs() < 1e-12)
        .expect("the corner");
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let place = points[3 * corner + k] + displacements[3 * corner + k];
        assert!((place - column(&format!("plate[10,0].{axis} [m]"))).abs() < 1e-15, "{axis}");
    }
    let rotation = &arrays.numbers("PointData", "rotation [rad]")[3 * corner..3 * corner + 3];
    let (real, about_y) = (column("plate[10,0].e0 [-]"), column("plate[10,0].e2 [-]"));
    // it turns about y, downwards
    assert!((rotation[1] - 2.0 * f64::atan2(about_y, real)).abs() < 1e-6 && rotation[1] > 1e-3, "{rotation:?}");
    let shells = arrays.of("Cells", "types", "UInt8").iter().filter(|own| **own == BIQUADRATIC_QUAD).count();
    assert_eq!(shells, 5);
    let thickness = arrays.numbers("CellData", "thickness [m]");
    assert!(thickness[..5].iter().zip([0.01, 0.02, 0.01, 0.01, 0.01]).all(|(own, given)| (own - given).abs() < 1e-15));
    let stress = arrays.numbers("CellData", "von Mises stress [N/m2]");
    // weight bends and pulls it, in kilopascals or megapascals
    assert!(stress[..5].iter().all(|stress| (1e3..1e8).contains(stress)), "{stress:?}");
    let ratios = arrays.numbers("CellData", "measured for failure ratio, smooth maximum [-]");
    let yields = |(stress, ratio): (&f64, &f64)| (stress / 276e6 / ratio - 1.0).abs() < 1e-12;
    assert!(stress[..5].iter().zip(&ratios).all(yields) && ratios[5..].iter().all(|ratio| ratio.is_nan()), "{ratios:?}");
}

#[test]
fn a_gradient_writes_how_each_element_of_a_shell_changes_it_by_its_thickness() {
    let folder = Folder::new("gradient");
    let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
    command.args(["gradient", "plate-pendulum", "--steps", "3", "--end", "0.003", "--vtk", "--json", "--out"]);
    let output = command.arg(&folder.0).output().expect("runs");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("gradients.vtu"), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let said: serde_json::Value = serde_json::from_str(text.lines().last().expect("a line")).expect("JSON");
    let arrays = Arrays::read(&folder.0.join("gradients.vtu"));
    let functionals = said["functionals"].as_array().expect("functionals");
    assert_eq!(functionals.len(), 5);
    for functional in functionals {
        let word = |key: &str| functional[key].as_str().expect("a word").to_string();
        let name = format!("gradient of {} by thickness [{}/m]", word("name"), word("unit"));
        let own = arrays.numbers("CellData", &name);
        assert!(own.len() >= 5 && own[5..].iter().all(|value| value.is_nan()), "{own:?}");
        // each of the five elements is a strip, whose thickness is a variable
        let strips: Vec<f64> =
            (1..=5).map(|strip| functional["gradient"][format!("thickness {strip}")].as_f64().expect("a number")).collect();
        let largest = strips.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
        assert!(
            largest > 0.0 && own.iter().zip(&strips).all(|(own, strip)| (own - strip).abs() < 1e-12 * largest),
            "{name}"
        );
    }
}

#[test]
fn a_run_writes_section_forces_and_stresses_of_each_element_of_a_beam_and_a_cable() {
    let folder = Folder::new("beams");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let scene = folder.0.join("beams.toml");
    let text = r#"
        version = 1
        settings = { method = "static", steps = 1 }
        variable = { d = { initial = 0.04, bounds = [0.01, 0.1], unit = "m" } }
        material = { steel = { young = 210e9, poisson = 0.3, density = 7850 } }
        section.round = { type = "circle", material = "steel", diameter = "d" }
        section.stiff = { type = "beam", axial = 1e8, shear = [1e8, 1e8], torsion = 1e5, bending = [1e5, 1e5] }
        beam = [
            { name = "round", from = [0, 0, 0], to = [1, 0, 0], second_axis = [0, 1, 0], elements = 2, section = "round", clamped = "start" },
            { name = "stiff", from = [1, 0, 0], to = [2, 0, 0], second_axis = [0, 1, 0], elements = 1, section = "stiff", start_node = "round.end" },
        ]
        cable = [{ name = "rope", from = [0, 1, 0], to = [1, 1, 0], elements = 8, section = "round", clamped = "start" }]
        force = [
            { name = "tip", on = "stiff.end", direction = [0, 0, 1], size = { type = "constant", value = -20 } },
            { name = "pull", on = "rope.end", direction = [1, 0, 0], size = { type = "constant", value = 3e4 } },
        ]
        functional = [
            { name = "ratio", type = "von_mises", of = ["round", "rope"], yield_stress = 1e6, over = { aggregate = "upper_maximum", sharpness = 100 } },
        ]
    "#;
    std::fs::write(&scene, text).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
    let output = command.arg("run").arg(&scene).args(["--vtk", "--out"]).arg(folder.0.join("out")).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let arrays = Arrays::read(&folder.0.join("out/fields-000001.vtu"));
    // each element of a beam and the cable is a cell, and no line is drawn twice
    let types = arrays.of("Cells", "types", "UInt8");
    assert_eq!(types.iter().filter(|own| **own == POLY_LINE).count(), 11, "{types:?}");
    let (forces, moments) =
        (arrays.numbers("CellData", "section force [N]"), arrays.numbers("CellData", "section moment [N m]"));
    // what is turned by a few 1e-4 rad
    let near = |own: f64, expected: f64| (own - expected).abs() <= 1e-5 * expected.abs();
    for (element, arm) in [1.75, 1.25, 0.5].into_iter().enumerate() {
        assert!(near(forces[3 * element + 2], -20.0), "{forces:?}");
        assert!(near(moments[3 * element + 1], 20.0 * arm), "{moments:?}");
    }
    // away from the clamp, which holds the slope and so the strain; EA eps is force by stretch
    let far = 3 + 6;
    assert!((forces[3 * far] / 3e4 - 1.0).abs() < 1e-3, "{forces:?}");
    let stress = arrays.numbers("CellData", "von Mises stress [N/m2]");
    let modulus = std::f64::consts::PI * f64::powi(0.04, 3) / 32.0;
    assert!(near(stress[0], 40.0 / modulus) && near(stress[1], 30.0 / modulus) && stress[2].is_nan(), "{stress:?}");
    // Green's strain of the element, 3e4 N / EA = 1.1e-4 to first order
    assert!((stress[far] / (3e4 / (8.0 * modulus / 0.04)) - 1.0).abs() < 1e-3, "{stress:?}");
    let ratios = arrays.numbers("CellData", "measured for ratio [-]");
    for element in [0, 1, far] {
        assert!((ratios[element] * 1e6 / stress[element] - 1.0).abs() < 1e-12, "{ratios:?} of {stress:?}");
    }
    assert!(ratios[2].is_nan(), "{ratios:?}");
}

#[test]
fn a_bent_plate_is_stressed_above_and_below_and_not_in_the_middle() {
    let folder = Folder::new("bent");
    std::fs::create_dir_all(&folder.0).expect("a folder");
    let scene = folder.0.join("bent.toml");
    // so little that forces act where they start
    let text = r#"
        version = 1
        settings = { method = "static", steps = 1 }
        variable = { h = { initial = 0.01, bounds = [0.001, 0.1], unit = "m" } }
        material = { stiff = { young = 2e11, poisson = 0, density = 7850 } }
        [laminate.layers]
        plies = [{ for = { k = ["lower", "upper"] }, thickness = "h / 2", young = [2e11, 1e11], poisson = 0, shear = [1e11, 1e11, 1e11], density = 1600, tension = [1e4, 1e4], compression = [1e4, 1e4], shear_strength = 1e4 }]
        [[shell]]
        for = { k = { from = 0, to = 1 } }
        name = "plate {k}"
        type = "plate"
        corner = [0, "{k}", 0]
        first = [1, 0, 0]
        second = [0, 0.2, 0]
        elements = [3, 1]
        material = "stiff"
        thickness = "h"
        clamped = ["first_start"]
        [[shell]]
        name = "plate 2"
        type = "plate"
        corner = [0, 2, 0]
        first = [1, 0, 0]
        second = [0, 0.2, 0]
        elements = [3, 1]
        laminate = "layers"
        direction = [1, 0, 0]
        clamped = ["first_start"]
        [[body]]
        for = { k = { from = 0, to = 2 } }
        name = "end {k}"
        position = [1, "{k} + 0.1", 0]
        [[rigid_interface]]
        for = { k = { from = 0, to = 2 } }
        name = "edge {k}"
        body = "end {k}"
        nodes = ["plate {k}.first_end"]
        [[torque]]
        for = { k = { from = 0, to = 2 } }
        name = "bending {k}"
        on = "end {k}"
        axis = [0, 1, 0]
        size = 0.001
        [[force]]
        name = "pull"
        on = "end 1"
        direction = [1, 0, 0]
        size = 0.1
        [[functional]]
        name = "yield"
        type = "von_mises"
        of = ["plate 0"]
        yield_stress = 1e2
        over = { aggregate = "upper_maximum", sharpness = 100 }
        [[functional]]
        name = "failure"
        type = "tsai_wu"
        of = ["plate 2"]
        laminate = "layers"
        over = { aggregate = "upper_maximum", sharpness = 100 }
    "#;
    std::fs::write(&scene, text).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_costate"));
    let output = command.arg("run").arg(&scene).args(["--vtk", "--out"]).arg(folder.0.join("out")).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let arrays = Arrays::read(&folder.0.join("out/fields-000001.vtu"));
    // M is for each width, s = N / t + 12 M z / t^3
    let (bent, pulled): (f64, f64) = (6.0 * 0.001 / 0.2 / 1e-4, 0.1 / 0.2 / 0.01);
    let points = arrays.numbers("Points", "points");
    for (layer, turned) in [("bottom", -1.0), ("middle", 0.0), ("top", 1.0)] {
        let expected = [turned * bent, pulled + turned * bent].map(f64::abs);
        let cells = arrays.numbers("CellData", &format!("von Mises stress, {layer} [N/m2]"));
        for (cell, own) in cells[..6].iter().enumerate() {
            assert!((own - expected[cell / 3]).abs() < 1e-4 * bent, "{layer}: {cells:?} for {expected:?}");
        }
        assert!(cells[6..].iter().all(|own| own.is_nan()), "{cells:?}");
        let nodal = arrays.numbers("PointData", &format!("von Mises stress, {layer}, nodal mean [N/m2]"));
        let at_nodes = nodal.iter().zip(points.chunks_exact(3)).filter(|(own, _)| !own.is_nan());
        for (own, point) in at_nodes.clone() {
            let expected = expected[point[1] as usize];
            assert!((own - expected).abs() < 1e-4 * bent, "{layer}: {own} for {expected}");
        }
        assert_eq!(at_nodes.count(), 2 * 21);
    }
    let nodal = |name: &str| arrays.numbers("PointData", &format!("measured for {name}, nodal mean [-]"));
    let of_plate = |values: Vec<f64>, plate: f64| -> Vec<f64> {
        let there = |point: &[f64]| (plate..=plate + 0.2 + 1e-9).contains(&point[1]);
        let own = values.into_iter().zip(points.chunks_exact(3)).filter(|(own, point)| there(point) && !own.is_nan());
        own.map(|own| own.0).collect()
    };
    let (yields, fails) = (of_plate(nodal("yield"), 0.0), of_plate(nodal("failure"), 2.0));
    assert_eq!([yields.len(), fails.len()], [21, 21]);
    assert!(yields.iter().all(|own| (own / (bent / 1e2) - 1.0).abs() < 1e-4), "{yields:?}");
    // along the fibres, as strong in tension as in compression: the stress by the strength
    assert!(fails.iter().all(|own| (own / (bent / 1e4) - 1.0).abs() < 1e-4), "{fails:?}");
    assert!(of_plate(nodal("failure"), 0.0).is_empty());
}
