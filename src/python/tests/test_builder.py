"""The builder that is made of the description of scene files, and scenes that are functions."""

import importlib.util
import inspect
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import SCENES, same_bits

import costate
from costate import description
from costate.numbers import Formulas

PACKAGE = Path(costate.__file__).parent
SECTIONS = [own for own in description.sections() if own.name != "variable"]
METHODS = [(section, form) for section in SECTIONS for form in section.forms]


def pendulum_by(length, m):
    m.gravity = [0, -9.81, 0]
    m.settings(end=1.0, steps=50)
    m.point("bob", position=[-length, 0, 0], mass=2.0)
    m.joint.distance("rod", between=["ground", "bob"])
    m.functional.position("height", on="bob", direction=[0, 1, 0], over="terminal")


def model():
    m = costate.Model("pendulum")
    pendulum_by(m.variable("length", 1.0, (0.1, 10), "m"), m)
    return m


def test_what_is_built_gives_the_bits_of_the_file(pendulum):
    assert same_bits(
        model().scene().value_and_grad(functionals="height")[1], pendulum.value_and_grad(functionals="height")[1][:1]
    )


@pytest.mark.parametrize(("section", "form"), METHODS, ids=lambda own: own.name or "only")
def test_help_says_what_the_reference_says(section, form):
    m = costate.Model()
    method = getattr(getattr(m, section.name), form.name) if len(section.forms) > 1 else getattr(m, section.name)
    page, arguments = inspect.getdoc(method), inspect.signature(method).parameters
    assert section.doc.split("\n")[0][:40] in page
    for key in form.keys:
        assert key.argument in arguments and f"``{key.argument}``" in page and key.doc in page
        if key.name != "name":
            assert (arguments[key.argument].default is inspect.Parameter.empty) == key.is_needed


def test_units_stand_in_the_help():
    assert "mass; none [kg]" in costate.Model.body.__doc__
    assert "stiffness [N/m]" in costate.Model().spring.line.__doc__


def test_stubs_are_made_of_the_same_description():
    place = importlib.util.spec_from_file_location("stubs", Path(__file__).parents[1] / "stubs.py")
    stubs = importlib.util.module_from_spec(place)
    place.loader.exec_module(stubs)
    assert (PACKAGE / "model.pyi").read_text(encoding="utf-8") == stubs.text(), "python stubs.py writes it"


def test_stubs_pass_the_strictest_check_of_types(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "user.py").write_text(
        "import costate\n"
        "m = costate.Model('arm', gravity=[0, 0, -9.81])\n"
        "length = m.variable('length', 1.0, (0.1, 2.0), 'm')\n"
        "bob: str = m.point('bob', position=[length, 0, 0], mass=2.0)\n"
        "m.joint.revolute('hinge', between=['ground', bob], axis=[0, 0, 1])\n"
        "row: object = m.scene().value_and_grad()[1]\n"
    )
    (tmp_path / "wrong.py").write_text("import costate\ncostate.Model().point('bob', place=[0, 0, 0])\n")

    def check(*files):
        line = [
            sys.executable,
            "-m",
            "mypy",
            "--strict",
            "--config-file",
            str(Path(__file__).parents[1] / "pyproject.toml"),
            *files,
        ]
        return subprocess.run(line, capture_output=True, text=True, cwd=tmp_path)

    right = check("user.py")
    assert right.returncode == 0, right.stdout
    wrong = check("wrong.py")
    assert wrong.returncode == 1 and '"place"' in wrong.stdout, wrong.stdout


@pytest.mark.parametrize(
    ("add", "said"),
    [
        (lambda m: m.point("p", position=[1, 2]), "position of [[point]]"),
        (lambda m: m.point("p", position=[0, 0, 0], mas=1), 'did you mean "mass"'),
        (lambda m: m.point("bob", position=[0, 0, 0]), '"bob"'),
        (lambda m: m.point("p"), "position"),
        (lambda m: m.joint.revolute("h", between=["ground"], axis=[0, 0, 1]), "between"),
        (lambda m: m.joint.revolute("h", between=["ground", "nobody"], axis=[0, 0, 1]), '"nobody"'),
        (lambda m: m.force("f", on="bob", direction=[0, 1, 0], size={"type": "sinus"}), '"sinus"'),
        (lambda m: m.point("p", position=[0, 0, 0], mass="lenght"), '"lenght"'),
        (lambda m: m.body("b", coordinates="quaternions"), "euler_parameters"),
        (lambda m: m.define("half", "lenght / 2"), '"lenght"'),
    ],
)
def test_mistakes_are_the_readers_with_lines_of_python(add, said):
    m = model()
    add(m)
    with pytest.raises(costate.SceneError) as error:
        m.scene()
    line = add.__code__.co_firstlineno
    assert f"test_builder.py, line {line}: " in str(error.value) and said in str(error.value), error.value


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda m: m.point("p", "q"), "its name"),
        (lambda m: m.settings("fast"), "nothing without a key"),
        (lambda m: m.material(young=1.0), "needs a name"),
        (lambda m: m.variable("rest length", 1.0, (0, 2)), '"rest length"'),
    ],
)
def test_calls_that_make_no_sense_are_refused_at_once(call, said):
    with pytest.raises(costate.InputError, match=said):
        call(model())


def test_values_that_no_file_can_hold_are_refused():
    m = model()
    m.point("p", position=object())
    with pytest.raises(costate.InputError, match="cannot stand in a scene"):
        m.text()


def test_names_of_any_letters_and_words_of_python():
    m = model()
    m.material('st eel "7"', young=2e11, poisson=0.3, density=7800)
    m.section.rectangle("bar", width=0.02, height=0.02, material='st eel "7"')
    m.beam("arm", from_=[0, 0, 1], to=[1, 0, 1], elements=2, section="bar", second_axis=[0, 1, 0], clamped=["start"])
    assert m.scene().run(steps=2, end=0.01).nodes


@pytest.mark.parametrize(
    "value", [1e-300, -2.5e-7, 1 / 3, 1e22, -0.0, 123456789.123456789, np.float32(0.1), np.int64(3), True]
)
def test_numbers_keep_every_bit(value):
    m = model()
    m.force("f", on="bob", direction=[1, 0, 0], size=float(value))
    m.define("own", value if not isinstance(value, bool) else 1.0)
    again = costate.loads(m.text())
    assert again.values().shape == (1,)
    line = next(line for line in m.text().split("\n") if line.startswith("size = "))
    assert same_bits(float(line[7:]), float(value))


def test_tables_lists_and_arrays():
    m = model()
    m.force(
        "f",
        on="bob",
        direction=np.array([1, 0, 0]),
        size={"type": "sine", "amplitude": 2, "angular_frequency": np.float64(3.5)},
    )
    m.drawing(points=np.eye(3))
    m.optimization(minimize="height", constraint=[{"functional": "height", "at_most": 3.0}])
    assert m.scene().run().values.shape == (1,)
    assert "force" in m._repr_html_() and "pendulum" in repr(m)


def test_definitions_and_variables_of_many_numbers():
    m = costate.Model("many", gravity=[0, 0, -1])
    m.settings(end=0.1, steps=10)
    masses = m.variable("masses", [1.0, 2.0, 3.0], (0.1, 10), "kg")
    place = m.define("place", [0.5, "2 * masses[0]", 0])
    half = m.define("half", masses[1] / 2)
    m.point("a", position=place, mass=masses.sum())
    m.point("b", position=[place[0] + half, 1, 0], mass=half * masses[2])
    m.functional.position("x", on="b", direction=[1, 1, 0], over="terminal")
    scene = m.scene()
    assert [own.name for own in scene.variables] == ["masses[0]", "masses[1]", "masses[2]"]
    _, row = scene.value_and_grad(functionals="x")
    np.testing.assert_allclose(row, [0.0, 0.5, 0.0], atol=1e-14)


def test_scenarios_of_a_model():
    m = model()
    m.scenario("long", settings={"end": 2.0})
    m.scenario("short", settings={"end": 0.5})
    scene = m.scene()
    assert {name: own.run().times[-1] for name, own in scene.scenarios.items()} == {"long": 2.0, "short": 0.5}


def make(formula):
    @costate.scene(x=costate.variable(0.7, (0.1, 5), "m"), y=costate.variable(1.3, (0.1, 5), "m"))
    def own(x, m):
        """A scene whose place is a formula."""
        m.settings(end=0.1, steps=2)
        m.point("p", position=[formula(x), 0, 0], mass=1.0)
        m.functional.position("f", on="p", direction=[1, 0, 0], over="initial")

    return own


FORMULAS = [
    lambda x: x[0] + x[1],
    lambda x: x[0] - 2 * x[1] + 1,
    lambda x: 1 - x.x * x["y"],
    lambda x: x[0] / x[1] + 2 / x[0],
    lambda x: -(x[0] ** 3) + x[1] ** -2,
    lambda x: x[0] ** 0.5 + x[1] ** 1.5,
    lambda x: 2.0 ** x[0] + x[0] ** x[1],
    lambda x: np.sin(x).sum() + np.cos(x[0]),
    lambda x: np.tan(x[0]) + np.arcsin(x[0] / 2) + np.arccos(x[1] / 3) + np.arctan(x[1]),
    lambda x: np.sinh(x[0]) + np.cosh(x[1]) + np.tanh(x[0] * x[1]),
    lambda x: np.exp(-x[0]) + np.log(x[1]) + np.sqrt(x[0] * x[1]),
    lambda x: np.arctan2(x[0], x[1]) + np.hypot(x[0], x[1]),
    lambda x: (np.array([[1.0, 2.0], [3.0, 4.0]]) @ x)[1],
    lambda x: x @ x + np.dot(x, [1.0, 2.0]),
    lambda x: np.linalg.norm(np.array([x[0], x[1], 1.0], dtype=object)),
    lambda x: np.cross(np.array([x[0], x[1], 0], dtype=object), np.array([0, 1.0, 2.0], dtype=object))[2],
    lambda x: np.sum(x[::-1] * [1.0, 10.0]) + x[-1] + x[:1].sum(),
    lambda x: np.float64(2.0) * x[0] + x[1] * np.float32(0.5),
    lambda x: abs(x[0] - x[1]) + np.abs(x[0]),
    lambda x: costate.minimum(x[0], x[1]) + 2 * costate.maximum(x[0], x[1]),
    lambda x: costate.where(x[0] < x[1], x[0] ** 2, x[1]),
    lambda x: costate.where(costate.less(x[1], x[0]), 1.0, x[0]) + costate.sign(x[0]) * x[1],
    lambda x: (x[0] > x[1]) * x[0] + (x[0] <= x[1]) * x[1],
    lambda x: sum(x[0] ** k for k in range(1, 6)),
    lambda x: np.mean(x) + np.prod(x) + np.square(x[0]),
    lambda x: np.outer(x, x).trace(),
    lambda x: np.deg2rad(x[0]) + np.radians(x[1]) * np.rad2deg(x[0]) + np.degrees(x[1]),
    lambda x: np.log2(x[0]) + np.log10(x[1]) + np.fabs(-x[0]) + np.reciprocal(x[1]),
]


class Plain(np.ndarray):
    """Floats with the names of variables."""

    x = property(lambda self: float(self[0]))
    y = property(lambda self: float(self[1]))

    def __getitem__(self, key):
        return np.asarray(self)["xy".index(key) if isinstance(key, str) else key]


@pytest.mark.parametrize("place", range(len(FORMULAS)))
def test_numpy_works_with_numbers_of_a_scene(place):
    formula, at = FORMULAS[place], np.array([0.7, 1.3])
    value, row = make(formula).value_and_grad(functionals="f")
    assert abs(value - float(formula(at.view(Plain)))) <= 4e-15 * max(1.0, abs(value))
    for i in range(2):
        step = np.zeros(2)
        step[i] = 1e-6
        slope = (float(formula((at + step).view(Plain))) - float(formula((at - step).view(Plain)))) / 2e-6
        assert abs(slope - row[i]) < 1e-7 * max(1.0, abs(slope))


def test_long_formulas_get_names():
    def long(x):
        total = x[0]
        for k in range(200):
            total = np.sin(total) + 0.01 * k * x[1] * total
        return total

    scene = make(long)
    assert "[define]" in scene.text
    value, row = scene.value_and_grad(functionals="f")
    assert abs(value - long(np.array([0.7, 1.3]))) < 1e-12 * abs(value)
    assert np.all(np.isfinite(row))


def test_a_branch_of_a_scene_names_its_line():
    with pytest.raises(costate.RecordingError) as error:
        make(lambda x: x[0] if x[0] > x[1] else x[1])
    assert "test_builder.py, line" in str(error.value)


def test_a_scene_from_a_function_is_a_scene_with_its_name():
    own = make(lambda x: x[0])
    assert own.name == "own" and own.summary == "A scene whose place is a formula."
    assert same_bits(pickle.loads(pickle.dumps(own)).values(), own.values())


def test_variables_of_a_scene_are_design_variables():
    with pytest.raises(costate.InputError, match="give a design variable"):
        costate.scene(length=1.0)


@pytest.mark.parametrize("ask", [lambda x: x["z"], lambda x: x.z])
def test_unknown_names_of_numbers_are_refused(ask):
    with pytest.raises((costate.InputError, AttributeError), match='"z"'):
        make(ask)


def test_formulas_of_shared_numbers_are_written_once():
    m = costate.Model()
    x = m.variable("x", 1.0, (0, 2))
    shared = np.sin(x) * np.cos(x)
    formulas = Formulas([shared + 1.0, shared * shared])
    assert list(formulas.definitions.values()) == ["(sin(x) * cos(x))"]


@pytest.mark.parametrize("name", ["five-bar", "slider-crank", "rotor", "tyre", "quarter-car"])
def test_every_key_of_a_file_has_its_argument(name):
    tomllib = pytest.importorskip("tomllib")
    known = {own.name: {key.name for form in own.forms for key in form.keys} for own in description.sections()}
    for section, entries in tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8")).items():
        if section in known:
            shape = next(own.shape for own in description.sections() if own.name == section)
            listed = {
                "listed": entries,
                "named": entries.values() if isinstance(entries, dict) else (),
                "once": [entries],
            }[shape]
            for entry in listed:
                assert set(entry) - {"type", "for"} <= known[section]


def test_a_number_that_is_not_finite_is_told_with_its_entry_and_line():
    m = costate.Model("wrong")
    m.point("ball", position=[0, 0, float("nan")], mass=1.0)
    with pytest.raises(
        costate.SceneError, match=r'line \d+: position of \[\[point\]\] "ball": nan is no finite number'
    ):
        m.scene()


def test_what_is_wrong_with_three_numbers_at_once_is_told_once():
    m = costate.Model("wrong")
    m.settings(end=1.0, steps=10)
    m.point("ball", position=np.zeros((3, 3)), mass=1.0)
    with pytest.raises(costate.SceneError) as error:
        m.scene()
    assert str(error.value).count("position of") == 1


def test_a_scene_without_variables_says_how_they_are_given():
    with pytest.raises(costate.InputError, match="@costate.scene\\(length="):
        costate.scene(lambda x, m: None)
