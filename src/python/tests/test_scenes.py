"""Scenes: designs of any form, values, gradients and products with them, and what is said of wrong arguments."""

import pickle

import numpy as np
import pytest
from conftest import PENDULUM, SCENES, same_bits

import costate


@pytest.mark.parametrize(
    "x",
    [
        None,
        [1.0, 2.0],
        (1, 2),
        np.array([1.0, 2.0]),
        np.array([1, 2]),
        np.array([1, 2], dtype=np.int32),
        np.array([1, 2], dtype=np.float32),
        np.array([[9.0, 1.0], [9.0, 2.0]])[:, 1],
        {},
        {"length": 1.0},
        {"mass": 2, "length": np.float64(1.0)},
        {"length": np.array(1.0)},
        {"length": np.array([1.0])},
    ],
)
def test_a_design_may_be_given_in_many_ways(pendulum, x):
    values, rows = pendulum.value_and_grad(x)
    own, derivatives = pendulum.value_and_grad()
    assert same_bits(values, own) and same_bits(rows, derivatives)


@pytest.mark.parametrize(
    ("x", "said"),
    [
        ([1.0], ["shape (1,)", "2 design variables", "shape (2,)"]),
        ([[1.0, 2.0]], ["shape (1, 2)"]),
        (1.0, ["shape ()"]),
        (np.array([1j, 2]), ["complex128", "real numbers"]),
        (["a", "b"], ["real numbers"]),
        (np.array([None, 1.0]), ["object", "real numbers"]),
        ({"lenght": 1.0}, ['"lenght"', "length, mass"]),
        ({"length": [1.0, 2.0]}, ['"length"', "2 values"]),
        ({"length": "1"}, ["real numbers"]),
        ([1.0, 20.0], ['"mass"', "20", "10"]),
        ([np.nan, 1.0], ['"length"', "NaN"]),
        ([np.inf, 1.0], ['"length"']),
    ],
)
def test_wrong_designs_are_refused_with_numbers(pendulum, x, said):
    with pytest.raises(costate.InputError) as error:
        pendulum.run(x)
    assert isinstance(error.value, ValueError)
    assert all(word in str(error.value) for word in said), error.value


@pytest.mark.parametrize(
    ("functionals", "values", "rows"),
    [
        (None, (2,), (2, 2)),
        ("height", (), (2,)),
        (["force"], (1,), (1, 2)),
        (("force", "height"), (2,), (2, 2)),
        ([], (0,), (0, 2)),
    ],
)
def test_shapes_follow_the_functionals_that_are_asked_for(pendulum, functionals, values, rows):
    own, derivatives = pendulum.value_and_grad(functionals=functionals)
    assert np.shape(own) == values and derivatives.shape == rows
    assert derivatives.dtype == np.float64


def test_rows_of_some_functionals_are_those_of_all(pendulum):
    values, rows = pendulum.value_and_grad()
    swapped, other = pendulum.value_and_grad(functionals=["force", "height"])
    assert same_bits(swapped, values[::-1].copy())
    np.testing.assert_allclose(other, rows[::-1], rtol=1e-14)


@pytest.mark.parametrize("ask", ["run", "gradient", "history"])
def test_unknown_functionals_are_refused_with_the_known_ones(pendulum, ask):
    calls = {
        "run": lambda: pendulum.run()["hight"],
        "gradient": lambda: pendulum.value_and_grad(functionals="hight"),
        "history": lambda: pendulum.run().history("hight"),
    }
    with pytest.raises(costate.InputError, match="height"):
        calls[ask]()


@pytest.mark.parametrize("name", ["pendulum", "five-bar", "slider-crank", "heavy-top", "screw"])
def test_gradients_agree_with_complex_steps_and_tangents(name):
    run = costate.built_in(name).run(steps=40, end=0.2)
    rows = run.gradient().rows
    for other in (run.complex_step(), run.tangent()):
        assert np.all(np.abs(rows - other) <= 1e-12 * np.abs(other).max(axis=1, keepdims=True) + 1e-14)


def test_products_with_derivatives_agree(five_bar):
    values, rows = five_bar.value_and_grad()
    direction = np.array([1.0, -2.0, 3.0, 0.5, 1.0])
    own, change = five_bar.jvp(None, direction)
    assert same_bits(own, values)
    np.testing.assert_allclose(change, rows @ direction, rtol=1e-15)
    own, pull = five_bar.vjp(None, "psi")
    assert own == values[0]
    np.testing.assert_allclose(pull(2.0), 2.0 * rows[0], rtol=1e-15)
    assert abs(pull(1.0) @ direction - change[0]) <= 1e-12 * abs(change[0])


def test_directions_and_weights_have_names_too(pendulum):
    _, rows = pendulum.value_and_grad()
    _, change = pendulum.jvp(None, {"mass": 3.0})
    np.testing.assert_allclose(change, 3.0 * rows[:, 1], rtol=1e-14)
    outputs = pendulum.apply({"length": 1.5})
    assert outputs["height"] == pendulum.run({"length": 1.5})["height"]
    back = pendulum.vector_jacobian_product({"length": 1.0}, {"height": 1.0, "force": 2.0})
    assert list(back) == ["length"]
    assert abs(back["length"] - rows[0, 0] - 2.0 * rows[1, 0]) < 1e-12


@pytest.mark.parametrize(("weights", "said"), [([1.0], "shape (1,)"), ([1j, 2], "complex"), (["a", "b"], "real")])
def test_wrong_weights_are_refused(pendulum, weights, said):
    _, pull = pendulum.vjp(None)
    with pytest.raises(costate.InputError) as error:
        pull(weights)
    assert said in str(error.value)
    assert np.array_equal(pull([0.0, 0.0]), [0.0, 0.0])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"steps": 0}, "steps is 0: "),
        ({"steps": -1}, "steps is -1: "),
        ({"end": -1.0}, "-1"),
        ({"end": float("nan")}, "NaN"),
        ({"method": "euler-of-old"}, "euler-of-old"),
    ],
)
def test_wrong_options_are_refused(pendulum, options, said):
    with pytest.raises(costate.InputError) as error:
        pendulum.run(**options)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"steps": 1.5}, "steps is 1.5: a whole number is wanted"),
        ({"steps": "many"}, "steps is 'many': a whole number"),
        ({"end": "long"}, "end is 'long': a number is wanted"),
        ({"method": 4}, "method is 4: the name of a method"),
    ],
)
def test_options_of_wrong_types_are_errors_of_python(pendulum, options, said):
    with pytest.raises(TypeError, match=said):
        pendulum.run(**options)


def test_options_replace_the_settings(pendulum):
    run = pendulum.run(end=np.float32(0.5), steps=np.int64(10), method="sdirk2")
    assert run.times[-1] == 0.5 and len(run.times) == 11


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('mass = "mass"', 'mass = "mas"', ['"mas"', "mass"]),
        ('mass = "mass"', "masss = 1", ['"masss"', 'did you mean "mass"']),
        ('"ground", "bob"', '"ground", "bobb"', ['"bobb"', '"bob"']),
        ("steps = 50", "steps = 0", ["steps"]),
        ("version = 1", "version = ", ["toml", "2:"]),
        ('type = "distance"', 'type = "distanze"', ['"distanze"', "distance"]),
    ],
)
def test_mistakes_of_a_scene_are_told_with_their_places(old, new, said):
    with pytest.raises(costate.SceneError) as error:
        costate.loads(PENDULUM.replace(old, new), "pendulum.toml")
    assert "pendulum.toml:" in str(error.value)
    assert all(word in str(error.value) for word in said), error.value


def test_files_that_cannot_be_read():
    with pytest.raises(FileNotFoundError):
        costate.load("nowhere.toml")


def test_a_file_that_is_no_text(tmp_path):
    (tmp_path / "bytes.toml").write_bytes(b"version = 1 # \xff\n")
    with pytest.raises(costate.InputError, match="UTF-8"):
        costate.load(tmp_path / "bytes.toml")


def test_built_in_scenes_are_listed_and_refused_by_name():
    assert "five-bar" in costate.built_in_names() and len(costate.built_in_names()) >= 28
    with pytest.raises(costate.InputError, match="five-bar"):
        costate.built_in("six-bar")


@pytest.mark.parametrize("name", [path.stem for path in sorted(SCENES.glob("*.toml"))])
def test_every_scene_file_is_read_and_pickled(name):
    scene = costate.load(SCENES / f"{name}.toml")
    assert scene.functionals and scene.text.startswith(("#", "version", "\ufeff"))
    again = pickle.loads(pickle.dumps(scene))
    assert (again.name, again.variables, again.functionals) == (scene.name, scene.variables, scene.functionals)


@pytest.mark.parametrize("name", costate.built_in_names())
def test_every_built_in_scene_has_a_page_for_notebooks_and_is_pickled(name):
    scene = costate.built_in(name)
    assert f"<b>{scene.name}</b>" in scene._repr_html_()
    assert pickle.loads(pickle.dumps(scene)).variables == scene.variables


def test_scenarios_are_scenes():
    scene = costate.load(SCENES / "rotor-hub.toml")
    assert len(scene.scenarios) == 3
    for name, own in scene.scenarios.items():
        assert name in own.name and own.variables == scene.variables
        assert pickle.loads(pickle.dumps(own)).name == own.name


def test_a_run_that_cannot_go_on_says_where():
    # Newton's method cannot follow a stiff spring in one step
    text = PENDULUM.replace("steps = 50", "steps = 1").replace("end = 1.0", "end = 40.0")
    with pytest.raises(costate.RunError) as error:
        costate.loads(text).run()
    assert isinstance(error.value, RuntimeError) and "step" in str(error.value)
