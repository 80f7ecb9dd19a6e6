"""Parts in Python: the same bits as parts of the library, all derivatives, and what is said of wrong ones."""

import pickle

import numpy as np
import pytest
from conftest import SCENES, Duffing, same_bits

import costate


class CoordinateSpring(costate.Element):
    """On a coordinate, as the spring of type angle."""

    nodes = ["coordinate"]
    parameters = {"stiffness": costate.non_negative("N/m"), "damping": costate.non_negative("N s/m"), "rest": "m"}

    def strain_energy(self, q, p):
        stretch = q[0] - p.rest
        return p.stiffness * stretch * stretch * 0.5

    def force(self, v, q, p, t):
        return [0.0 - p.damping * v[0]]


class LineSpring(costate.Element):
    """Between two points, as the spring of type line."""

    nodes = ["point", "point"]
    parameters = {"stiffness": costate.non_negative("N/m"), "rest_length": costate.non_negative("m")}

    def strains(self, q, p, t):
        line = q[3:] - q[:3]
        return [np.sqrt(line[0] * line[0] + line[1] * line[1] + line[2] * line[2])]

    def stored(self, e, p):
        stretch = e[0] - p.rest_length
        return stretch * stretch * p.stiffness * 0.5


class Wire(costate.Constraint):
    """A bead on a parabolic wire, z = k x^2 / 2."""

    nodes = ["point"]
    parameters = {"curvature": "1/m"}

    def g(self, q, p, t):
        return [q[2] - p.curvature * q[0] ** 2 * 0.5, q[1]]


class Speed(costate.Quantity):
    """Square of the speed of a point."""

    nodes = ["point"]
    unit = "m2/s2"

    def value(self, s, p, t):
        return s.v @ s.v


def duffing(spring=None):
    m = costate.Model("duffing")
    m.settings(end=10.0, steps=400)
    x = [
        m.variable(name, value, (0, 10), unit)
        for name, value, unit in [("m", 1.0, "kg"), ("k", 2.0, "N/m"), ("k3", 0.5, "N/m3"), ("q0", 1.5, "m")]
    ]
    m.coordinate("oscillator", initial=x[3])
    m.add(Duffing, "mass and spring", on="oscillator", mass=x[0], stiffness=x[1], cubic=x[2])
    if spring is not None:
        spring(m)
    m.functional.coordinate("integral of q", on="oscillator", over="integral")
    return m.scene()


def test_the_oscillator_of_the_readme_gives_its_numbers():
    value, row = duffing().value_and_grad(functionals="integral of q")
    assert f"{value:.12f}" == "-0.792871662584"
    assert [f"{entry:.12f}" for entry in row] == [
        "2.711078308610",
        "-0.964325821041",
        "-1.564853333054",
        "-1.571816663759",
    ]


def test_a_spring_in_python_gives_the_bits_of_the_built_in_one():
    keys = {"on": "oscillator", "stiffness": 3.0, "damping": 0.2}
    own = duffing(lambda m: m.add(CoordinateSpring, "spring", rest=0.1, **keys))
    built_in = duffing(lambda m: m.spring.angle("spring", rest_angle=0.1, **keys))
    values, rows = own.value_and_grad()
    others, derivatives = built_in.value_and_grad()
    assert same_bits(values, others) and same_bits(rows, derivatives)


def chain(add):
    m = costate.Model("chain", gravity=[0, -9.81, 0])
    m.settings(end=0.5, steps=50)
    k = m.variable("k", 400.0, (1, 1e4), "N/m")
    for i in range(5):
        m.point(f"p{i}", position=[0.1 * (i + 1), 0, 0], mass=0.1)
    m.point("end", position=[0, 0, 0], mass=1.0)
    m.spring.line("held", between=["ground", "end"], points=[[0, 1, 0], [0, 0, 0]], stiffness=1e3)
    for i, (a, b) in enumerate(zip(["end", "p0", "p1", "p2", "p3"], ["p0", "p1", "p2", "p3", "p4"])):
        add(m, f"spring {i}", between=[a, b], stiffness=k * (i + 1), rest_length=0.09)
    m.functional.position("tip", on="p4", direction=[0, 1, 0], over="terminal")
    return m.scene()


def test_springs_with_strains_do_too():
    own = chain(lambda m, name, **keys: m.add(LineSpring, name, **keys))
    built_in = chain(lambda m, name, **keys: m.spring.line(name, **keys))
    values, rows = own.value_and_grad()
    others, derivatives = built_in.value_and_grad()
    assert same_bits(values, others) and same_bits(rows, derivatives)


def hermite(point):
    """Weights of (r_1, r_1x, r_2, r_2x) in the first and second derivative of a cubic."""
    square = point * point
    slopes = [6.0 * square - 6.0 * point, 1.0 - 4.0 * point + 3.0 * square, 6.0 * point - 6.0 * square,
              3.0 * square - 2.0 * point]  # fmt: skip
    return slopes, [12.0 * point - 6.0, 6.0 * point - 4.0, 6.0 - 12.0 * point, 6.0 * point - 2.0]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


class Strand(costate.Element):
    """A beam without torsion and shear in absolute nodal coordinates, as the elements of a cable."""

    nodes = ["cable", "cable"]
    parameters = {"length": costate.positive("m"), "axial": costate.non_negative("N")}
    parameters |= {"bending": costate.non_negative("N m2"), "mass_per_length": costate.positive("kg/m")}
    parameters |= {"gravity_x": "m/s2", "gravity_y": "m/s2", "gravity_z": "m/s2"}
    points = [0.1127016653792583, 0.5, 0.8872983346207417]
    weights = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0]
    products = [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0],
                [-13.0, -3.0, -22.0, 4.0]]  # fmt: skip

    def line(self, q, p):
        inverse = 1.0 / p.length
        chord = q[6:9] - q[:3]
        return [chord * inverse, q[3:6], q[9:]], inverse

    def derivatives(self, line, point, inverse):
        chord, start, end = line
        (_, a, b, c), (_, d, e, f) = hermite(point)
        first = [chord[i] * b + start[i] * a + end[i] * c for i in range(3)]
        second = [chord[i] * e + start[i] * d + end[i] * f for i in range(3)]
        return first, [own * inverse for own in second]

    def kinetic(self, v, q, p):
        share = p.length * p.mass_per_length / 420.0
        factors, twice = [1.0, p.length, 1.0, p.length], 0.0
        for i in range(4):
            for j in range(4):
                entry = share * factors[i] * factors[j] * self.products[i][j]
                twice = twice + entry * dot(v[3 * i : 3 * i + 3], v[3 * j : 3 * j + 3])
        return twice * 0.5

    def potential(self, q, p):
        middle = (q[:3] + q[6:9]) * 0.5 + (q[3:6] - q[9:]) * (p.length / 12.0)
        return -p.length * p.mass_per_length * dot(middle, [p.gravity_x, p.gravity_y, p.gravity_z])

    def strain_energy(self, q, p):
        energy, (line, inverse) = 0.0, self.line(q, p)
        for point, weight in zip(self.points, self.weights):
            (a, b, c), (d, e, f) = self.derivatives(line, point, inverse)
            normal, square = [b * f - c * e, c * d - a * f, a * e - b * d], dot([a, b, c], [a, b, c])
            curvature = dot(normal, normal) / (square * square * square)
            energy = energy + curvature * p.bending * p.length * (0.5 * weight)
        return energy

    def strains(self, q, p, t):
        line, inverse = self.line(q, p)
        firsts = [self.derivatives(line, point, inverse)[0] for point in self.points]
        return [(dot(first, first) - 1.0) * 0.5 for first in firsts]

    def stored(self, e, p):
        energy = 0.0
        for strain, weight in zip(e, self.weights):
            energy = energy + strain * strain * p.axial * p.length * (0.5 * weight)
        return energy

    def mass(self, p):
        return p.length * p.mass_per_length


def rope(elements, add, steps=10):
    """Two strands side by side: a cable for small strains, and elements of ``add`` between its nodes."""
    m = costate.Model("rope")
    m.settings(end=0.001 * steps, steps=steps)
    stiffness = {"axial": 2e3, "bending": 0.3}
    axial = m.variable("axial", 2e3, (1, 1e5), "N")
    m.section.cable("one", **stiffness, mass=0.1)
    # whole places of the binary system: lengths have no rounding
    end = [elements / 128, 0, 0]
    m.cable("one", from_=[0, 0, 0], to=end, elements=elements, section="one", strains="small", clamped="start",
            motion={"angular_velocity": [0, 0, 2.0]})  # fmt: skip
    names = ["one.start", *(f"one[{i}]" for i in range(1, elements)), "one.end"]
    add(m, axial, list(zip(names, names[1:])))
    m.functional.position("x", on="one[20]", direction=[1, 0, 0], over="terminal")
    return m.scene()


def built_in_strand(m, axial, pairs):
    m.section.cable("other", axial=axial, bending=0.3, mass=0.1)
    for i, (a, b) in enumerate(pairs):
        m.cable(f"other {i}", from_=[i / 128, 0, 0], to=[(i + 1) / 128, 0, 0], elements=1, section="other",
                start_node=a, end_node=b)  # fmt: skip


def own_strand(m, axial, pairs):
    for i, pair in enumerate(pairs):
        m.add(Strand, f"other {i}", between=pair, length=1 / 128, axial=axial, bending=0.3, mass_per_length=0.1,
              gravity_x=0, gravity_y=0, gravity_z=0)  # fmt: skip


def test_a_beam_of_1000_elements_gives_the_bits_of_the_built_in_one():
    costate.testing.check_element(Strand, [0.5, 2e3, 0.3, 0.1, 0.0, 0.0, -9.81])
    own, built_in = rope(1000, own_strand).run(), rope(1000, built_in_strand).run()
    assert same_bits(own.values, built_in.values) and same_bits(own.gradient().rows, built_in.gradient().rows)
    assert same_bits(own.node("one[1000]").coordinates, built_in.node("one[1000]").coordinates)
    assert own.work == built_in.work


def wire(curvature=0.8):
    m = costate.Model("wire", gravity=[0, 0, -9.81])
    m.settings(end=1.0, steps=100)
    k = m.variable("curvature", curvature, (0.1, 5), "1/m")
    m.point("bead", position=[0.5, 0, 0.125 * k], mass=1.0)
    m.add(Wire, "wire", on="bead", curvature=k)
    m.add(Speed, "speed", on="bead", over="terminal")
    m.functional.reaction("push", joint="wire", weights=[1, 0], over="integral")
    return m.scene()


class BodySpring(costate.Element):
    """Between points of two bodies, as the spring of type line."""

    nodes = ["body", "body"]
    parameters = {"stiffness": costate.non_negative("N/m"), "rest_length": costate.non_negative("m")}
    parameters |= {"a": costate.point(0), "b": costate.point(1)}

    def strains(self, q, p, t):
        b, a = q[7:10] + costate.rotate(q[10:], p.b), q[:3] + costate.rotate(q[3:7], p.a)
        return [np.sqrt(dot(b - a, b - a))]

    def stored(self, e, p):
        stretch = e[0] - p.rest_length
        return stretch * stretch * p.stiffness * 0.5


def with_body_springs(text):
    """The file of the five-bar mechanism with springs of Python."""
    for spring in "AB":
        old = f'name = "spring {spring}"\ntype = "line"\nbetween = ["ground", "bar 2"]\npoints = ["{spring}", "P2"]'
        assert old in text
        new = f'name = "spring {spring}"\ntype = "body_spring"\nbetween = ["ground", "bar 2"]\na = "{spring}"\nb = "P2"'
        text = text.replace(old, new)
    return text


def test_springs_of_the_five_bar_mechanism_in_python_give_the_bits_of_the_built_in_ones():
    text = (SCENES / "five-bar.toml").read_text(encoding="utf-8")
    scene = costate.loads(with_body_springs(text), "five-bar.toml", parts=[BodySpring])
    run, built_in = scene.run(), costate.loads(text, "five-bar.toml").run()
    assert same_bits(run.values, built_in.values) and same_bits(run.gradient().rows, built_in.gradient().rows)
    np.testing.assert_allclose(run.gradient().rows, run.complex_step(), rtol=1e-11)
    assert same_bits(pickle.loads(pickle.dumps(scene)).values(), run.values)


def test_points_of_parts_are_checked():
    class Outside(BodySpring):
        parameters = {**BodySpring.parameters, "b": costate.point(2)}

    costate.testing.check_element(BodySpring, {"stiffness": 3.0, "rest_length": 0.5, "a": [0, 1, 0.2], "b": [1, 0, 0]})
    with pytest.raises(costate.InputError, match='b of "outside" is a point of a node that it has not'):
        costate.testing.check_element(Outside, [3.0, 0.5, 0, 1, 0.2, 1, 0, 0])
    with pytest.raises(costate.InputError, match="8 parameters, stiffness, rest_length, a x, a y"):
        costate.testing.check_element(BodySpring, [3.0, 0.5])


class Ball(costate.Constraint):
    """A point of the ground, on the z axis of a body."""

    nodes = ["body", "body"]
    parameters = {"height": "m"}

    def g(self, q, p, t):
        tip = np.array([0, 0, p.height], dtype=object)
        return q[7:10] + costate.rotation(q[10:]) @ tip - q[:3] - costate.rotation(q[3:7]) @ np.array([0.0, 0, 0])


def top(add):
    m = costate.Model("top", gravity=[0, 0, -9.81])
    m.settings(end=0.5, steps=100)
    mass = m.variable("mass", 2.0, (1, 3), "kg")
    turned = {"type": "angle", "axis": [1, 0, 0], "angle": 0.3}
    place = np.array([0.0, -np.sin(0.3), np.cos(0.3)])
    m.body(
        "top", position=place, orientation=turned, mass=mass, inertia=[0.1, 0.1, 0.05], angular_velocity=80.0 * place
    )
    add(m)
    m.functional.position("x", on="top", direction=[1, 0, 0], over="terminal")
    return m.scene()


def test_joints_of_bodies_do_what_the_built_in_ones_do():
    # their velocities must fit the joint: the top turns about its own axis, through the ball
    own = top(lambda m: m.add(Ball, "ball", between=["ground", "top"], height=-1.0))
    built_in = top(lambda m: m.joint.spherical("ball", between=["ground", "top"], point=[0, 0, 0]))
    values, rows = own.value_and_grad()
    others, derivatives = built_in.value_and_grad()
    np.testing.assert_allclose(values, others, rtol=1e-10)
    np.testing.assert_allclose(rows, derivatives, rtol=1e-9)
    np.testing.assert_allclose(rows, own.run().complex_step(), rtol=1e-11)
    costate.testing.check_constraint(Ball, [-1.0])


def test_joints_and_quantities_are_used_by_name():
    run = wire().run()
    assert run.joints == ["wire"] and run.functionals == ["speed", "push"]
    bead = run.node("bead")
    assert np.abs(bead.positions[:, 2] - 0.4 * bead.positions[:, 0] ** 2).max() < 1e-9
    # the energy of the fall
    fall = 9.81 * (bead.positions[0, 2] - bead.positions[-1, 2])
    assert abs(run["speed"] - 2.0 * fall) < 1e-6
    assert run.history("speed").unit == "m2/s2"
    rows, check = run.gradient().rows, run.complex_step()
    np.testing.assert_allclose(rows, check, rtol=1e-12)


@pytest.mark.parametrize(
    ("check", "part", "parameters"),
    [
        (costate.testing.check_element, Duffing, [1.0, 2.0, 0.5]),
        (costate.testing.check_element, Duffing, {"cubic": 0.5, "mass": 1.0, "stiffness": 2.0}),
        (costate.testing.check_element, CoordinateSpring, [1.0, 2.0, 0.5]),
        (costate.testing.check_element, LineSpring, [3.0, 0.5]),
        (costate.testing.check_constraint, Wire, [1.2]),
        (costate.testing.check_quantity, Speed, []),
    ],
)
def test_parts_pass_the_checks_of_the_library(check, part, parameters):
    check(part, parameters)


class Functions(costate.Element):
    """Every function that a formula may have."""

    nodes = ["coordinate", "coordinate"]
    parameters = {"mass": costate.positive("kg")}

    def residual(self, s, p, t):
        x, y = s.q[0] * 0.3, s.q[1] * 0.2
        sum_ = np.sin(x) + np.cos(y) + np.tan(x) + np.arcsin(y) + np.arccos(x) + np.arctan(y) + np.sinh(x) + np.cosh(y)
        sum_ = sum_ + np.tanh(x) + np.exp(y) + np.log(2.0 + x) + np.sqrt(2.0 + y) + np.arctan2(x, 2.0 + y) + abs(x)
        sum_ += x**3 + (2.0 + y) ** 0.5 + 2.0**x + (2.0 + x) ** y + np.hypot(x, 1.0) + x**-2.0 * 1e-3 + np.square(y)
        chosen = costate.where(costate.less(x, y), x * x, y) + costate.minimum(x, 0.1) + costate.maximum(y, x)
        return [p.mass * s.a[0] + sum_, p.mass * s.a[1] - (-y) * chosen + (x < y) * x + costate.sign(x) * y + t]


def test_every_function_is_recorded_with_its_derivatives():
    costate.testing.check_element(Functions, [1.5])


class Push(costate.Element):
    """A load that begins at a time."""

    nodes = ["coordinate"]
    parameters = {"size": "N", "start": "s"}

    def force(self, v, q, p, t):
        return [costate.where(costate.less(t, p.start), 0.0, p.size)]


def test_steps_end_where_a_load_begins():
    class Free(costate.Element):
        """A mass."""

        nodes = ["coordinate"]
        parameters = {"mass": costate.positive("kg")}

        def kinetic(self, v, q, p):
            return 0.5 * p.mass * v[0] * v[0]

    m = costate.Model("push")
    m.settings(end=1.0, steps=7)
    start = m.variable("start", 0.3, (0.1, 0.9), "s")
    m.coordinate("x")
    m.add(Free, "mass", on="x", mass=2.0)
    m.add(Push, "push", on="x", size=3.0, start=start)
    m.functional.coordinate("x", on="x", over="terminal")
    value, row = m.scene().value_and_grad(functionals="x")
    assert abs(value - 0.5 * 1.5 * 0.7**2) < 1e-13 and abs(row[0] + 1.5 * 0.7) < 1e-12


class Power(costate.Element):
    """A spring with an exponent, which is an option."""

    nodes = ["coordinate"]
    parameters = {"stiffness": "N/m"}

    def __init__(self, exponent=2):
        self.exponent = exponent

    def potential(self, q, p):
        return p.stiffness * q[0] ** self.exponent


def test_options_make_parts_of_their_own():
    def both(m):
        m.add(Power(2), "two", on="oscillator", stiffness=0.1)
        m.add(Power(exponent=4), "four", on="oscillator", stiffness=0.2)
        m.add(Power, "two again", on="oscillator", stiffness=0.3)

    scene = duffing(both)
    assert scene.text.count('type = "power"') == 2 and scene.text.count('type = "power_2"') == 1
    run = scene.run()
    np.testing.assert_allclose(run.gradient().rows, run.complex_step(), rtol=1e-11)
    again = pickle.loads(pickle.dumps(scene))
    assert same_bits(again.values(), run.values)


def branching(body):
    class Branching(costate.Element):
        nodes = ["coordinate"]
        parameters = {"k": "N/m"}

        def residual(self, s, p, t):
            return body(s, p, t)

    return Branching


def of_numpy_array(s, p, t):
    results = np.zeros(1)
    results[0] = s.q[0]
    return results


@pytest.mark.parametrize(
    "body",
    [
        lambda s, p, t: [s.q[0] if s.q[0] > 0 else -s.q[0]],
        lambda s, p, t: [float(s.q[0])],
        lambda s, p, t: [__import__("math").sin(s.q[0])],
        lambda s, p, t: [s.q[0] == 1.0],
        lambda s, p, t: [s.q[0] != 1.0],
        lambda s, p, t: [int(s.q[0])],
        lambda s, p, t: list(range(p.k)),
        lambda s, p, t: [max(s.q[0], p.k)],
        lambda s, p, t: [np.maximum(s.q[0], p.k)],
        of_numpy_array,
    ],
)
def test_a_branch_on_a_value_names_its_line(body):
    with pytest.raises(costate.RecordingError) as error:
        costate.testing.check_element(branching(body), [1.0])
    line = body.__code__.co_firstlineno
    assert any(f"test_parts.py, line {own}:" in str(error.value) for own in (line, line + 2)), error.value
    assert isinstance(error.value, TypeError)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (lambda s, p, t: [1.0, 2.0], "returns 2 numbers, and 1 are wanted"),
        (lambda s, p, t: None, "returns nothing"),
        (lambda s, p, t: [], "returns 0 numbers"),
        (lambda s, p, t: [s.q[0] * float("inf")], "inf"),
        (lambda s, p, t: [costate.Model().variable("L", 1.0, (0, 2)) * s.q[0]], "L is a number of something else"),
        (lambda s, p, t: [p["kk"]], '"kk"'),
    ],
)
def test_formulas_that_make_no_sense_are_refused(body, said):
    with pytest.raises(costate.InputError) as error:
        costate.testing.check_element(branching(body), [1.0])
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("attributes", "said"),
    [
        ({}, "no nodes"),
        ({"nodes": ["corner"]}, '"corner"'),
        ({"nodes": ["point"]}, "no formula"),
        ({"nodes": ["point"], "parameters": {"a b": "m"}}, '"a b"'),
        ({"nodes": "point"}, 'nodes of Own is a text: give a list, ["point"]'),
        ({"nodes": ["point"], "parameters": {"k": 3}}, 'parameter "k" of Own is 3: give its unit'),
        ({"nodes": ["point"], "parameters": {"on": "m"}}, '"on"'),
        ({"nodes": ["point"], "stored": lambda self, e, p: 1.0}, "no strains(q, p, t)"),
    ],
)
def test_parts_without_what_they_need_are_refused(attributes, said):
    own = type("Own", (costate.Element,), attributes)
    with pytest.raises(costate.InputError) as error:
        costate.testing.check_element(own, [])
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [([1.0], "3 parameters"), ([1.0, 2.0, 3.0, 4.0], "4 are given")],
)
def test_checks_want_all_parameters(parameters, said):
    with pytest.raises(costate.InputError, match=said):
        costate.testing.check_element(Duffing, parameters)


def test_checks_want_a_part_of_their_kind():
    with pytest.raises(costate.InputError, match="Duffing is no costate.Constraint"):
        costate.testing.check_constraint(Duffing, [1.0, 2.0, 0.5])


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"on": "oscillator", "mass": -1.0, "stiffness": 1.0, "cubic": 1.0}, ["mass", "greater than 0", "-1"]),
        ({"on": "oscillator", "stiffness": 1.0, "cubic": 1.0}, ["mass"]),
        ({"on": "oscilator", "mass": 1.0, "stiffness": 1.0, "cubic": 1.0}, ['"oscilator"', "oscillator"]),
        ({"on": "oscillator", "mass": 1.0, "stiffness": 1.0, "cubic": 1.0, "quintic": 1.0}, ['"quintic"']),
        ({"between": ["oscillator", "ground"], "mass": 1.0, "stiffness": 1.0, "cubic": 1.0}, ["between"]),
    ],
)
def test_keys_of_parts_are_checked_by_the_reader(keys, said):
    with pytest.raises(costate.SceneError) as error:
        duffing(lambda m: m.add(Duffing, "other", **keys))
    assert "test_parts.py, line" in str(error.value)
    assert all(word in str(error.value) for word in said), error.value


def test_nodes_must_be_of_the_kind_that_was_recorded():
    m = costate.Model("wrong")
    m.settings(end=1.0, steps=10)
    m.body("bar", mass=1.0, inertia=[1.0, 1.0, 1.0])
    m.add(Wire, "wire", on="bar", curvature=1.0)
    scene = m.scene()
    with pytest.raises(
        costate.InputError, match='test_parts.py, line .*"wire" needs a point as its node 1, and "bar" is a body'
    ):
        scene.run()


def test_parts_may_have_many_nodes():
    class Mean(costate.Quantity):
        """Mean of four coordinates."""

        nodes = ["coordinate"] * 4

        def value(self, s, p, t):
            return s.q.sum() / 4.0

    m = costate.Model("four")
    m.settings(end=1.0, steps=10)
    names = [m.coordinate(f"c{i}", initial=float(i)) for i in range(4)]
    for name in names:
        m.add(Duffing, f"spring of {name}", on=name, mass=1.0, stiffness=0.0, cubic=0.0)
    m.add(Mean, "mean", between=names, over="terminal")
    assert m.scene().run()["mean"] == 1.5
