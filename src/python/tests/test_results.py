"""Results: arrays, tables, pictures of notebooks, pickles."""

import html
import json
import pickle
import subprocess

import numpy as np
import pytest
from conftest import same_bits

import costate


@pytest.fixture(scope="module")
def run(five_bar):
    return five_bar.run(steps=50, end=0.5)


def test_histories_of_nodes_have_their_shapes(run):
    assert run.nodes == ["bar 1", "bar 2", "bar 3", "bar 4"]
    for name in run.nodes:
        own = run.node(name)
        shapes = {key: getattr(own, key).shape for key in own.__dataclass_fields__}
        assert shapes == {
            "times": (51,),
            "coordinates": (51, 7),
            "rates": (51, 7),
            "positions": (51, 3),
            "velocities": (51, 3),
            "accelerations": (51, 3),
            "angular_velocities": (51, 3),
            "axes": (51, 3, 3),
        }
        assert all(getattr(own, key).dtype == np.float64 for key in shapes)
        assert np.allclose(own.axes @ own.axes.transpose(0, 2, 1), np.eye(3), atol=1e-12)
        assert same_bits(own.positions, own.coordinates[:, :3])


def test_axes_are_the_columns_of_the_rotation(run):
    own = run.node("bar 2")
    for q, axes in zip(own.coordinates, own.axes):
        np.testing.assert_allclose(costate.rotation(q[3:]).T, axes, atol=1e-15)


def test_histories_of_joints_and_functionals(run):
    assert run.joints[:2] == ["A", "P1"]
    own = run.joint("A")
    assert own.forces.shape == own.moments.shape == (51, 3) and own.multipliers.shape == (51, 5)
    psi = run.history("psi")
    assert psi.times.shape == psi.values.shape == (51,) and psi.unit == "m2"
    assert same_bits(run.times, psi.times)


def test_velocities_are_the_rates_of_positions(five_bar):
    own = five_bar.run(steps=400, end=0.4).node("bar 2")
    slope = (own.positions[2:] - own.positions[:-2]) / (own.times[2:] - own.times[:-2])[:, None]
    assert np.abs(slope - own.velocities[1:-1]).max() < 1e-4


@pytest.mark.parametrize(("kind", "known"), [("node", "bar 1"), ("joint", "P1"), ("history", "psi")])
def test_unknown_names_are_refused(run, kind, known):
    with pytest.raises(costate.InputError, match=known):
        getattr(run, kind)("bar one")


def test_a_node_of_a_coordinate_has_no_place():
    from test_parts import duffing

    own = duffing().run(steps=10)
    history = own.node("oscillator")
    assert history.positions.shape == (0, 3) and history.axes.shape == (0, 3, 3)
    assert history.coordinates.shape == (11, 1)
    assert "oscillator.q0" in own.to_pandas().columns


def test_ends_of_beams_and_cables_are_nodes():
    scene = costate.loads(BEAM)
    run = scene.run()
    for end, node in [("start", "arm[0]"), ("end", "arm[4]")]:
        assert same_bits(run.node(f"arm.{end}").coordinates, run.node(node).coordinates)
    with pytest.raises(costate.InputError, match="arm.middle"):
        run.node("arm.middle")


BEAM = """
version = 1
gravity = [0, 0, -9.81]
settings = { end = 0.01, steps = 5 }
section.bar = { type = "rectangle", width = 0.02, height = 0.02, material = "steel" }
material.steel = { young = 2e11, poisson = 0.3, density = 7800 }
beam = [{ name = "arm", from = [0, 0, 0], to = [1, 0, 0], elements = 2, section = "bar", second_axis = [0, 1, 0] }]
"""


def test_a_table_has_all_histories(run):
    table = run.to_pandas()
    assert table.shape[0] == 51 and table.index.name == "t [s]"
    assert same_bits(table["bar 2.x [m]"].to_numpy().copy(), run.node("bar 2").positions[:, 0].copy())
    assert same_bits(table["A.force_y [N]"].to_numpy().copy(), run.joint("A").forces[:, 1].copy())
    assert "measured for psi [m2]" in table.columns


def test_a_table_of_arrow_has_the_same_columns_behind_the_times(run):
    pytest.importorskip("pyarrow")
    table, other = run.to_arrow(), run.to_pandas()
    assert table.column_names == ["t [s]", *other.columns] and table.num_rows == 51
    for name in ("bar 2.x [m]", "A.force_y [N]", "measured for psi [m2]"):
        assert same_bits(table[name].to_numpy(), other[name].to_numpy().copy())


def test_a_dataset_has_all_histories_with_units(run):
    pytest.importorskip("xarray")
    data = run.to_xarray()
    assert dict(data.sizes) == {"t": 51, "axis": 3} and data.attrs == {"scene": "five-bar"}
    assert same_bits(data["bar 2 velocity"].to_numpy(), run.node("bar 2").velocities)
    assert same_bits(data["A force"].sel(axis="y").to_numpy().copy(), run.joint("A").forces[:, 1].copy())
    assert data["psi"].attrs == {"units": "m2"} and same_bits(data["psi"].to_numpy(), run.history("psi").values)
    assert data["t"].attrs == {"units": "s"} and same_bits(data["t"].to_numpy(), run.times)


def test_a_dataset_has_coordinates_without_a_place():
    pytest.importorskip("xarray")
    from test_parts import duffing

    data = duffing().run(steps=40).to_xarray()
    assert data["oscillator coordinates"].shape == (41, 1) and "oscillator position" not in data


def test_units_of_values_and_of_histories_differ_where_a_functional_is_an_integral(run, five_bar):
    assert five_bar.functionals[0].unit == "m2 s" and run.gradient().units == ["m2 s"]
    assert "<td>m2 s</td>" in run._repr_html_() and "psi [m2 s]" in run.gradient()._repr_html_()
    assert run.history("psi").unit == "m2"


def data_of(report):
    data = report.html.split('id="data">')[1].split("</script>")[0]
    return json.loads(data.replace("<\\/", "</"))


def test_a_report_is_the_page_of_the_command_line(run, tmp_path):
    plain, coloured = data_of(run.report()), data_of(run.report(gradient=True))
    assert plain["title"] == "five-bar" and "command" not in plain and plain["clips"]
    tables = {own["heading"]: own for own in coloured["tables"]}
    assert tables["Functionals"]["rows"] == [["psi", f"{run['psi']:.12e}", "m2 s"]]
    rows = tables["Gradient of psi [m2 s / unit of the variable]"]["rows"]
    assert [row[0] for row in rows] == [own.name for own in run.variables]
    for row, entry in zip(rows, run.gradient().rows[0]):
        # thirteen digits; the sweep by all parameters sums in another order
        assert float(row[3]) == pytest.approx(entry, rel=1e-11)
    assert coloured["colourings"] and "colourings" not in plain
    path = run.report().save(tmp_path / "five-bar.html")
    assert path.read_text(encoding="utf-8") == run.report().html
    with pytest.raises(OSError):
        run.report().save(tmp_path / "nowhere" / "five-bar.html")


def test_a_report_has_the_tables_of_the_command_line(command_line, tmp_path):
    subprocess.run([command_line, "run", "five-bar", "--out", str(tmp_path)], check=True, capture_output=True)
    page = costate.results.Report("five-bar", (tmp_path / "report.html").read_text(encoding="utf-8"))
    theirs, ours = data_of(page), data_of(costate.built_in("five-bar").run().report())
    # the balance of energies is added up while a command runs
    theirs["facts"] = [fact for fact in theirs["facts"] if fact[0] != "balance"]
    for part in ("title", "summary", "what", "facts", "tables", "charts", "clips", "space"):
        assert ours[part] == theirs[part], part


def test_a_report_stands_in_a_frame_of_a_notebook(run):
    shown = run.report()._repr_html_()
    assert shown.startswith("<iframe ") and shown.endswith("</iframe>")
    assert html.unescape(shown.split('srcdoc="')[1].split('"')[0]) == run.report().html
    assert "five-bar" in repr(run.report())


def test_gradients_have_names(run):
    own = run.gradient()
    assert own["psi", "k1"] == own.rows[0, 2]
    assert own.to_pandas().loc["psi", "k1"] == own.rows[0, 2]
    assert same_bits(np.asarray(own), own.rows)
    assert same_bits(own["psi"], own.rows[0])
    for names in (("psi", "k3"), "phi"):
        with pytest.raises(costate.InputError, match="k1, k2"):
            own[names]


def test_notebooks_show_tables(run, five_bar):
    assert "psi" in run._repr_html_() and "<table>" in run._repr_html_()
    assert "L01 [m]" in run.gradient()._repr_html_()
    assert "psi" in repr(run) and "five-bar" in repr(five_bar)
    assert repr(run.gradient()).startswith("psi = ") and "by k1 [N/m]: " in repr(run.gradient())
    assert "positions (51, 3)" in repr(run.node("bar 1")) and "unit 'm2'" in repr(run.history("psi"))


def test_a_pickled_run_keeps_its_arrays_and_says_what_it_cannot_do(run):
    again = pickle.loads(pickle.dumps(run))
    for name in run.nodes:
        assert same_bits(again.node(name).positions, run.node(name).positions)
    for name in run.joints:
        assert same_bits(again.joint(name).forces, run.joint(name).forces)
    assert same_bits(again.history("psi").values, run.history("psi").values)
    assert same_bits(again.values, run.values) and again.work == run.work
    for ask in (again.gradient, again.report):
        with pytest.raises(costate.InputError, match="run the scene again"):
            ask()
    gradient = pickle.loads(pickle.dumps(run.gradient()))
    assert same_bits(gradient.rows, run.gradient().rows)


def test_arrays_belong_to_whoever_got_them(five_bar):
    run = five_bar.run(steps=5, end=0.05)
    positions = run.node("bar 1").positions
    del run
    positions[0, 0] = 7.0
    assert positions[0, 0] == 7.0


def test_what_speaks_against_a_run_is_a_warning():
    m = costate.Model("falls")
    m.settings(end=1.0, steps=20, locate=False)
    m.point("ball", position=[0, 0.5, 0], velocity=[0, -1, 0], mass=1.0)
    height = {"ball": "ball"}
    m.element("floor", nodes=height, force={"ball": ["0", "if_less(ball.position.y, 0, 5, 0)", "0"]}, breakpoints=[])
    m.variable("unused", 1.0, (0, 2))
    m.functional.position("height", on="ball", direction=[0, 1, 0], over="terminal")
    scene = m.scene()
    with pytest.warns(costate.RunWarning, match='the formula of "floor" jumps'):
        run = scene.run()
    assert len(run.doubts) == 1 and pickle.loads(pickle.dumps(run)).doubts == run.doubts


def test_values_without_steps_are_those_of_a_run(five_bar):
    assert same_bits(five_bar.values(), five_bar.run().values)
