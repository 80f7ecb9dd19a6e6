"""The geometrically exact beam of the library, written in Python: the same bits."""

import numpy as np
import pytest
from conftest import same_bits

import costate

TWO = [-0.5773502691896258, 0.5773502691896258]
THREE = [-0.7745966692414834, 0.0, 0.7745966692414834]
WEIGHTS = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0]


def values(xi):
    """Shape functions of three nodes at -1, 0 and 1."""
    return [0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)]


def slopes(xi):
    return [xi - 0.5, -2.0 * xi, xi + 0.5]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def norm_squared(e):
    return e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def numbers_at(xi, *shares):
    """Interpolated numbers: coordinates of the nodes, with the function that gives their weights."""
    return [(coordinate, function(xi)) for coordinates, function in shares for coordinate in coordinates]


PLACE, TURN = range(3), range(3, 7)


class Timoshenko(costate.Field):
    """A beam of three nodes with shear, torsion and large rotations, whose strains are tied at two points."""

    nodes = ["body"] * 3
    # dr/dxi, e, de/dxi at two tying points; r, e at three Gauss points
    points = [numbers_at(xi, (PLACE, slopes), (TURN, values), (TURN, slopes)) for xi in TWO]
    points += [numbers_at(xi, (PLACE, values), (TURN, values)) for xi in THREE]
    # of both tying points: metric, tangent and second axis in the frame of the nodes, stiffnesses
    parameters = {
        f"{name}_{point}": unit
        for point in (1, 2)
        for name, unit in [
            ("metric", "m"),
            *((f"{axis}_{x}", "-") for axis in ("tangent", "second") for x in "xyz"),
            *((name, "N") for name in ("axial", "shear_2", "shear_3")),
            *((name, "N m2") for name in ("torsion", "bending_2", "bending_3")),
        ]
    }
    # of the Gauss points: mass and inertia of their shares of the length
    parameters |= {
        f"{name}_{point}": unit
        for point in (1, 2, 3)
        for name, unit in [("mass", "kg"), *((f"inertia_{ij}", "kg m2") for ij in ("xx", "yy", "zz", "xy", "xz", "yz"))]
    }

    def kinetic(self, point, v, h, p):
        if point < 2:
            return 0.0
        mass, xx, yy, zz, xy, xz, yz = p[26 + 7 * (point - 2) :][:7]
        velocity, e = v[:3], h[3:]
        inverse = 1.0 / norm_squared(e)
        omega = costate.g_times(e, v[3:]) * (inverse + inverse)
        inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
        return (dot(velocity, velocity) * mass + dot(omega, [dot(row, omega) for row in inertia])) * 0.5

    def strains(self, point, h, p):
        """gamma = Lambda^T R^T dr/dS - (1, 0, 0) and kappa = Lambda^T 2 G(e) de/dS / |e|^2, Lambda = [t n2 n3]."""
        if point > 1:
            return []
        metric, tangent, second = p[13 * point], p[13 * point + 1 :][:3], p[13 * point + 4 :][:3]
        axes = [tangent, second, cross(tangent, second)]
        slope, e, turn = h[:3], h[3:7], h[7:]
        scale = 1.0 / (norm_squared(e) * metric)
        line = costate.rotate_back(e, slope) * scale
        gamma = [dot(axis, line) for axis in axes]
        turning = costate.g_times(e, turn) * (scale + scale)
        kappa = [dot(axis, turning) for axis in axes]
        return [gamma[0] - 1.0, *gamma[1:], *kappa]

    def stored(self, point, e, p):
        stresses, twice = e * p[13 * point + 7 :][:6], 0.0
        for strain, stress in zip(e, stresses):
            twice = twice + strain * stress
        return twice * p[13 * point] * 0.5

    def mass(self, p):
        return p.mass_1 + p.mass_2 + p.mass_3


SHEAR, TORSION, BENDING_3 = [4e4, 3e4], 12.0, 15.0
MASS, INERTIA = 0.3, [2e-5, 3e-5]


def frame(points, xi):
    """Metric and axes of a straight element with section axis 2 near y."""
    slope = np.zeros(3)
    for point, weight in zip(points, slopes(xi)):
        slope = slope + point * weight
    second = np.zeros(3)
    for weight in values(xi):
        second = second + np.array([0.0, 1.0, 0.0]) * weight
    tangent = slope * (1.0 / np.sqrt(dot(slope, slope)))
    second = second - tangent * dot(tangent, second)
    second = second * (1.0 / np.sqrt(dot(second, second)))
    return np.sqrt(dot(slope, slope)), [tangent, second, cross(tangent, second)]


def numbers_of_element(points, axial, bending):
    """Parameters of an element between three places."""
    p = []
    for xi in TWO:
        metric, (tangent, second, _) = frame(points, xi)
        p += [metric, *tangent, *second, axial, *SHEAR, TORSION, bending, BENDING_3]
    for xi, weight in zip(THREE, WEIGHTS):
        metric, axes = frame(points, xi)
        entries = [(0, INERTIA[0] + INERTIA[1]), (1, INERTIA[0]), (2, INERTIA[1])]
        own = [sum(axes[k][i] * axes[k][j] * value for k, value in entries)
               for i, j in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]]  # fmt: skip
        p += [number * metric * weight for number in [MASS, *own]]
    return dict(zip(Timoshenko.parameters, p))


def own_beam(m, elements, length, axial, bending):
    """Nodes and elements in Python; returns the names of both ends."""
    places = [np.array([length * (i / (2 * elements)), 0.0, 0.0]) for i in range(2 * elements + 1)]
    nodes = [m.body(f"node {i}", position=place) for i, place in enumerate(places)]
    for i in range(0, 2 * elements, 2):
        keys = numbers_of_element(places[i : i + 3], axial, bending)
        m.add(Timoshenko, f"element {i // 2 + 1}", between=nodes[i : i + 3], **keys)
    return nodes[0], nodes[-1]


def built_in_beam(m, elements, length, axial, bending):
    m.section.beam("section", axial=axial, shear=SHEAR, torsion=TORSION, bending=[bending, BENDING_3], mass=MASS,
                   inertia=INERTIA)  # fmt: skip
    m.beam("beam", from_=[0, 0, 0], to=[length, 0, 0], elements=elements, section="section", second_axis=[0, 1, 0])
    return "beam.start", "beam.end"


def cantilever(elements, add, steps=10):
    """A clamped beam that a force at its end bends sideways and twists."""
    m = costate.Model("cantilever")
    m.settings(end=5e-4 * steps, steps=steps)
    axial, bending = m.variable("axial", 1e5, (1, 1e7), "N"), m.variable("bending", 20.0, (1, 1e3), "N m2")
    start, end = add(m, elements, 2.0, axial, bending)
    m.joint.fixed("wall", between=["ground", start])
    m.force("load", on=end, point=[2.0, 0.0, 0.1], direction=[0.0, 1.0, -0.5], size=5.0)
    for axis, direction in zip("xyz", np.eye(3)):
        m.functional.position(axis, on=end, direction=list(direction), over="terminal")
    return m.scene()


def test_the_beam_passes_the_checks_of_the_library():
    points = [np.array([x, 0.0, 0.0]) for x in (0.0, 0.3, 0.6)]
    costate.testing.check_element(Timoshenko, numbers_of_element(points, 1e5, 20.0))


@pytest.mark.parametrize("elements", [1, 12, 1000])
def test_a_beam_with_rotations_gives_the_bits_of_the_built_in_one(elements):
    own, built_in = cantilever(elements, own_beam).run(), cantilever(elements, built_in_beam).run()
    assert abs(own["z"]) > 1e-4
    assert same_bits(own.values, built_in.values) and same_bits(own.gradient().rows, built_in.gradient().rows)
    assert same_bits(own.node(f"node {2 * elements}").coordinates, built_in.node("beam.end").coordinates)
    assert own.work == built_in.work


class Line(costate.Field):
    """A bar of two points: what stretches it, and its middle."""

    nodes = ["point", "point"]
    points = [[(axis, [-1.0, 1.0]) for axis in range(3)], [(axis, [0.5, 0.5]) for axis in range(3)]]
    parameters = {"stiffness": "N/m", "mass": costate.positive("kg"), "load": "N", "viscosity": "N s/m"}

    def kinetic(self, point, v, h, p):
        return dot(v, v) * p.mass * 0.5 if point == 1 else 0.0

    def potential(self, point, h, p):
        return h[2] * p.mass * 9.81 if point == 1 else 0.0

    def strain_energy(self, point, h, p):
        return dot(h, h) * 0.25 * p.stiffness if point == 0 else 0.0

    def strains(self, point, h, p):
        return [dot(h, h)] if point == 0 else []

    def stored(self, point, e, p):
        return e[0] * e[0] * p.stiffness

    def damping(self, point, e, rate, p):
        return [rate[0] * p.viscosity]

    def force(self, point, v, h, p, t):
        return [p.load * t, 0.0, -v[2]] if point == 1 else [0.0] * 3


class Written(Line):
    """Another one, by its residual."""

    kinetic = potential = strain_energy = strains = stored = damping = force = property()

    def residual(self, point, s, p, t):
        return [p.mass * a - p.load for a in s.a] if point == 1 else [p.stiffness * h for h in s.q]


@pytest.mark.parametrize("field", [Line, Written])
def test_fields_pass_the_checks_of_the_library(field):
    costate.testing.check_element(field, [3.0, 1.5, 2.0, 0.2])


def changed(**attributes):
    return type("Own", (Line,), attributes)


@pytest.mark.parametrize(
    ("field", "said"),
    [
        (changed(points=[]), "Own has no points"),
        (changed(points=[[(3, [1.0, 1.0])]]), "point 0 of Own takes coordinate 3; a node has 3"),
        (changed(points=[[(0, [1.0])]]), "point 0 of Own has 1 weights for coordinate 0, and 2 nodes"),
        (changed(nodes=["point", "body"]), "nodes of several kinds, point, body"),
        (changed(stored=lambda self, point, e, p: None), "stored of Own at point 0 returns nothing"),
        (changed(force=lambda self, point, v, h, p, t: [1.0]), "force of Own at point 0 returns 1 numbers, and 3"),
        (changed(dissipation=lambda self, e, rate, p: 0.0), "Own has dissipation, which a field has not"),
        (changed(strains=property()), "Own has stored, damping, but no strains(point, h, p)"),
    ],
)
def test_fields_that_make_no_sense_are_refused(field, said):
    with pytest.raises(costate.InputError) as error:
        costate.testing.check_element(field, [3.0, 1.5, 2.0, 0.2])
    assert said in str(error.value)


def test_operations_of_euler_parameters_are_those_of_the_matrix():
    random = np.random.default_rng(3)
    e, rate, s = random.normal(size=4), random.normal(size=4), random.normal(size=3)
    e /= np.linalg.norm(e)
    rate -= e * (e @ rate)
    matrix = costate.rotation(e)
    np.testing.assert_allclose(costate.rotate(e, s), matrix @ s, rtol=1e-13)
    np.testing.assert_allclose(costate.rotate_back(e, s), matrix.T @ s, rtol=1e-13)
    # dR/dt = R omega~, by a complex step
    spin = matrix.T @ np.imag(costate.rotation(e + 1e-30j * rate)) / 1e-30
    np.testing.assert_allclose(2.0 * costate.g_times(e, rate), [spin[2, 1], spin[0, 2], spin[1, 0]], rtol=1e-13)
