"""Results: arrays, tables, pictures of notebooks, pickles."""

import pickle

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


def test_a_table_has_all_histories(run):
    table = run.to_pandas()
    assert table.shape[0] == 51 and table.index.name == "t [s]"
    assert same_bits(table["bar 2.x [m]"].to_numpy().copy(), run.node("bar 2").positions[:, 0].copy())
    assert same_bits(table["A.force_y [N]"].to_numpy().copy(), run.joint("A").forces[:, 1].copy())
    assert "measured for psi [m2]" in table.columns


def test_gradients_have_names(run):
    own = run.gradient()
    assert own["psi", "k1"] == own.rows[0, 2]
    assert own.to_pandas().loc["psi", "k1"] == own.rows[0, 2]
    assert same_bits(np.asarray(own), own.rows)
    with pytest.raises(costate.InputError, match="k1, k2"):
        own["psi", "k3"]


def test_notebooks_show_tables(run, five_bar):
    assert "psi" in run._repr_html_() and "<table>" in run._repr_html_()
    assert "L01 [m]" in run.gradient()._repr_html_()
    assert "psi" in repr(run) and "five-bar" in repr(five_bar)


def test_a_pickled_run_keeps_its_arrays_and_says_what_it_cannot_do(run):
    again = pickle.loads(pickle.dumps(run))
    for name in run.nodes:
        assert same_bits(again.node(name).positions, run.node(name).positions)
    for name in run.joints:
        assert same_bits(again.joint(name).forces, run.joint(name).forces)
    assert same_bits(again.history("psi").values, run.history("psi").values)
    assert same_bits(again.values, run.values) and again.work == run.work
    with pytest.raises(costate.InputError, match="run the scene again"):
        again.gradient()
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
    m.settings(end=1.0, steps=20)
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
