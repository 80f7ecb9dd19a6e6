//! Files for ParaView, read back by another library: what is written is what was computed.

use costate::io::{Attribute, MeshCell, MeshSeries, UnstructuredMesh, read_csv};
use std::path::PathBuf;
use std::process::Command;
use vtkio::Vtk;
use vtkio::model::{Attribute as ReadAttribute, Attributes, CellType, DataSet, IOBuffer, UnstructuredGridPiece};

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

fn read(path: &std::path::Path) -> UnstructuredGridPiece {
    let vtk = Vtk::import(path).unwrap_or_else(|error| panic!("{}: {error:?}", path.display()));
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { panic!("no unstructured grid") };
    pieces.into_iter().next().expect("a piece").into_loaded_piece_data(None).expect("data")
}

fn numbers(buffer: &IOBuffer) -> Vec<f64> {
    buffer.clone().cast_into().expect("numbers")
}

fn named(attributes: &[ReadAttribute], wanted: &str) -> Vec<f64> {
    let found = attributes.iter().find_map(|attribute| match attribute {
        ReadAttribute::DataArray(array) if array.name == wanted => Some(numbers(&array.data)),
        _ => None,
    });
    found.unwrap_or_else(|| panic!("no \"{wanted}\""))
}

#[test]
fn a_mesh_is_read_as_it_was_written() {
    let folder = Folder::new("mesh");
    let place = |i: usize| [(i % 3) as f64, (i / 3) as f64, 0.1 * i as f64];
    let points: Vec<[f64; 3]> = (0..10).map(place).collect();
    let cells =
        vec![MeshCell::BiquadraticQuad(std::array::from_fn(|i| i)), MeshCell::PolyLine(vec![0, 4, 9]), MeshCell::Vertex(7)];
    let values: Vec<f64> = (0..30).map(|i| (f64::from(i) * 0.7).sin()).collect();
    let point_data = vec![Attribute { name: "displacement [m]".into(), components: 3, values: values.clone() }];
    let cell_data = vec![Attribute { name: "a < \"b\" & c".into(), components: 1, values: vec![1.5, -2.0, 1e300] }];
    let mesh = UnstructuredMesh { points: points.clone(), cells, point_data, cell_data };
    let mut series = MeshSeries::new(&folder.0, "fields");
    series.add(0.25, &mesh).expect("written");
    let pvd = std::fs::read_to_string(series.finish().expect("written")).expect("text");
    assert!(pvd.contains("timestep=\"0.25\" part=\"0\" file=\"fields-000000.vtu\""), "{pvd}");
    let UnstructuredGridPiece { points: own, cells, data } = read(&folder.0.join("fields-000000.vtu"));
    assert_eq!(numbers(&own), points.concat());
    // corners of the element, middles of its edges, its centre
    let (types, (connectivity, offsets)) = (cells.types.clone(), cells.cell_verts.into_xml());
    assert_eq!(types, [CellType::BiquadraticQuad, CellType::PolyLine, CellType::Vertex]);
    assert_eq!(connectivity, [0, 2, 8, 6, 1, 5, 7, 3, 4, 0, 4, 9, 7]);
    assert_eq!(offsets, [9, 12, 13]);
    let Attributes { point, cell } = data;
    assert_eq!(named(&point, "displacement [m]"), values);
    assert_eq!(named(&cell, "a < \"b\" & c"), [1.5, -2.0, 1e300]);
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
    let UnstructuredGridPiece { points, data, cells } = read(&folder.0.join("fields-000003.vtu"));
    assert!(!folder.0.join("fields-000004.vtu").exists());
    let (points, displacements) = (numbers(&points), named(&data.point, "displacement [m]"));
    // the corner beside the tip
    let corner = points
        .chunks_exact(3)
        .zip(displacements.chunks_exact(3))
        .position(|(x, u)| (x[0] - u[0] - 0.25).abs() + (x[1] - u[1]).abs() < 1e-12)
        .expect("the corner");
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        assert_eq!(points[3 * corner + k], column(&format!("plate, node 10, 0.{axis} [m]")), "{axis}");
    }
    let rotation = &named(&data.point, "rotation [rad]")[3 * corner..3 * corner + 3];
    let (real, about_y) = (column("plate, node 10, 0.e0 [-]"), column("plate, node 10, 0.e2 [-]"));
    // it turns about y, downwards
    assert!((rotation[1] - 2.0 * f64::atan2(about_y, real)).abs() < 1e-6 && rotation[1] > 1e-3, "{rotation:?}");
    let shells = cells.types.iter().filter(|own| **own == CellType::BiquadraticQuad).count();
    assert_eq!(shells, 5);
    let thickness = named(&data.cell, "thickness [m]");
    assert!(thickness[..5].iter().zip([0.01, 0.02, 0.01, 0.01, 0.01]).all(|(own, given)| (own - given).abs() < 1e-15));
    let stress = named(&data.cell, "von Mises stress [N/m2]");
    // weight bends and pulls it, in kilopascals or megapascals
    assert!(stress[..5].iter().all(|stress| (1e3..1e8).contains(stress)), "{stress:?}");
}
