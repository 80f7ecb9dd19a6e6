"""Elements, joints and quantities of one's own: a class with one formula, recorded once, which then runs as the machine
code of the library.

Jacobians, adjoint products, design derivatives and complex-step checks are made of the recording, as for the library's
own parts.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from .errors import InputError
from .numbers import Number, Numbers, argument, tape

#: Coordinates of each kind of node: place of a point; place and Euler parameters of a body; place and axes of a body in
#: natural coordinates; place and slope of a node of a cable; one number.
NODES = {"point": 3, "body": 7, "natural": 12, "cable": 6, "coordinate": 1}


@dataclass(frozen=True)
class Parameter:
    """A physical number of a part: its unit, which values it may have, what it is."""

    unit: str = "-"
    range: str = "any"
    doc: str = ""
    #: One by which a part is made stronger or heavier: reports colour the part by what a change of it does.
    is_size: bool = False
    #: Of a point: the node in whose frame it stays.
    point_of: int | None = None


def point(node: int = 0, doc: str = "") -> Parameter:
    """A point of a node, counted from 0: given by its place in the world at the start, and for formulas three numbers
    in the frame of the node."""
    return Parameter("m", "any", doc, point_of=node)


def number(unit: str = "-", doc: str = "", *, is_size: bool = False) -> Parameter:
    """Any finite number."""
    return Parameter(unit, "any", doc, is_size)


def positive(unit: str = "-", doc: str = "", *, is_size: bool = False) -> Parameter:
    """A number greater than 0."""
    return Parameter(unit, "positive", doc, is_size)


def non_negative(unit: str = "-", doc: str = "", *, is_size: bool = False) -> Parameter:
    """A number that is 0 or greater."""
    return Parameter(unit, "at_least_zero", doc, is_size)


@dataclass(frozen=True)
class State:
    """Accelerations, velocities and coordinates of the nodes of a part, one node after the other."""

    a: Any
    v: Any
    q: Any


class Part:
    """What all parts have. Attributes of an instance are its options: whole numbers, words, whatever does not depend on
    a design."""

    #: Kinds of its nodes, of ``NODES``, in the order in which their coordinates stand.
    nodes: ClassVar[Sequence[str]] = ()
    #: Its physical numbers: names with units, or with ``positive(unit)`` and the like.
    parameters: ClassVar[dict[str, str | Parameter]] = {}

    _kind: ClassVar[str]
    _recorded: ClassVar[dict[Any, str]] = {}

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
        raise NotImplementedError

    @classmethod
    def _number_names(cls) -> list[str]:
        """Names of the numbers that its parameters are."""
        points = {
            name for name, own in cls.parameters.items() if isinstance(own, Parameter) and own.point_of is not None
        }
        return [
            own for name in cls.parameters for own in ([f"{name} {x}" for x in "xyz"] if name in points else [name])
        ]


class Element(Part):
    """An element: give ``residual``, or any of the others, from which it is made.

    Every number that a method gets is recorded; it returns a number, or a list of them.

    * ``residual(s, p, t)``: inertia + internal - applied, a number for each coordinate
    * ``kinetic(v, q, p)``, ``potential(q, p)``, ``strain_energy(q, p)`` [J]
    * ``force(v, q, p, t)``: the generalized non-conservative force, a number for each coordinate
    * ``strains(q, p, t)`` with ``stored(e, p)`` [J], ``damping(e, rate, p, t)``, ``dissipation(e, rate, p)`` [W]
    * ``mass(p)`` [kg]
    """

    _kind = "element"

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
        return _of_element(self, recorder)


def _of_element(part: object, recorder: _Recorder) -> dict[str, Any]:
    """Tapes of the formulas of an element."""
    a, v, q, p, t = recorder.state_and_more()
    n = len(q)
    known: dict[str, tuple[list[Any], int | None]] = {
        "residual": ([State(a, v, q), p, t], n),
        "kinetic": ([v, q, p], 1),
        "potential": ([q, p], 1),
        "strain_energy": ([q, p], 1),
        "force": ([v, q, p, t], n),
        "mass": ([p], 1),
        "strains": ([q, p, t], None),
    }
    formulas = recorder.recorded(part, known)
    strains = len(formulas["strains"]["results"]) if "strains" in formulas else 0
    e, rate = recorder.arguments("e", strains), recorder.arguments("rate", strains)
    of_strains = recorder.recorded(
        part, {"stored": ([e, p], 1), "damping": ([e, rate, p, t], strains), "dissipation": ([e, rate, p], 1)}
    )
    if of_strains and not strains:
        raise InputError(f"{recorder.name} has {', '.join(of_strains)}, but no strains(q, p, t)")
    formulas |= of_strains
    if not formulas:
        raise InputError(f"{recorder.name} has no formula: give it residual, or energies and forces")
    return {"formulas": formulas, "strains": strains}


class Field(Element):
    """A flexible element, by formulas at points of numbers that are interpolated between its nodes.

    All nodes are of one kind. At a point, h are sums of constant weights times coordinates of the nodes, v and a the
    same sums of their rates; the element is the sum over all points. What a point does not have is 0, or an empty list.

    * ``residual(point, s, p, t)``: conjugate to h, with the state s of the interpolated numbers
    * ``kinetic(point, v, h, p)``, ``potential(point, h, p)``, ``strain_energy(point, h, p)`` [J]
    * ``force(point, v, h, p, t)``: conjugate to h
    * ``strains(point, h, p)`` with ``stored(point, e, p)`` [J], ``damping(point, e, rate, p)``
    * ``mass(p)`` [kg] as of an element
    """

    #: Interpolated numbers of each point: which coordinate of each node, and a weight for each node.
    points: ClassVar[Sequence[Sequence[tuple[int, Sequence[float]]]]] = ()

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
        _check_points(self, recorder.name)
        at_points = _AtPoints(self, recorder)
        described = _of_element(at_points, recorder)
        if "residual" not in described["formulas"]:
            a, v, q, _, _ = recorder.state_and_more()
            known: dict[str, tuple[list[Any], int | None]] = {"interpolated": ([State(a, v, q)], None)}
            described["formulas"] |= recorder.recorded(at_points, known)
        return described


def _check_points(field: Field, word: str) -> None:
    if hasattr(field, "dissipation"):
        raise InputError(f"{word} has dissipation, which a field has not: give it damping(point, e, rate, p)")
    if not hasattr(field, "strains") and (of_strains := [own for own in ("stored", "damping") if hasattr(field, own)]):
        raise InputError(f"{word} has {', '.join(of_strains)}, but no strains(point, h, p)")
    if not field.points:
        raise InputError(
            f"{word} has no points: give it the attribute points, for each point a list of (coordinate, weights)"
        )
    if len(set(field.nodes)) > 1:
        raise InputError(f"{word} has nodes of several kinds, {', '.join(field.nodes)}: those of a field are all alike")
    size = NODES[field.nodes[0]]
    for place, rows in enumerate(field.points):
        for component, weights in rows:
            if not 0 <= component < size:
                raise InputError(
                    f"point {place} of {word} takes coordinate {component}; a node has {size}, counted from 0"
                )
            if len(weights) != len(field.nodes):
                raise InputError(
                    f"point {place} of {word} has {len(weights)} weights for coordinate {component}, and "
                    f"{len(field.nodes)} nodes"
                )


class _AtPoints:
    """A field as an element: sums over its points, in the order in which the library takes them."""

    def __init__(self, field: Field, recorder: _Recorder) -> None:
        self._field = field
        self._recorder = recorder
        self._size = recorder.coordinates // len(field.nodes)
        #: How many strains each point has.
        self._counts: list[int] = []

    def __getattr__(self, name: str) -> Any:
        """Formulas that the field has."""
        made: dict[str, Callable[..., Any]] = {
            "residual": self._residual,
            "kinetic": self._sum_of_moving,
            "potential": self._sum,
            "strain_energy": self._sum,
            "force": self._force,
            "strains": self._strains,
            "stored": self._stored,
            "damping": self._damping,
        }
        own = getattr(self._field, name)
        if name == "mass":
            return own
        if name not in made:
            raise AttributeError(name)
        return lambda *arguments: made[name](name, own, *arguments)

    def interpolated(self, s: State) -> list[Any]:
        """All interpolated numbers."""
        return [own for rows in self._field.points for x in (s.a, s.v, s.q) for own in self._at(rows, x)]

    def _at(self, rows: Sequence[tuple[int, Sequence[float]]], x: Any) -> Any:
        made = np.empty(len(rows), dtype=object)
        for place, (component, weights) in enumerate(rows):
            total = x[component] * weights[0]
            for node, weight in enumerate(weights[1:], 1):
                total = total + x[node * self._size + component] * weight
            made[place] = total
        return made

    def _results(self, point: int, name: str, made: Any, count: int | None) -> list[Any]:
        return _results(f"{name} of {self._recorder.name} at point {point}", made, count)

    def _spread(self, rows: Sequence[tuple[int, Sequence[float]]], numbers: Sequence[Any], total: list[Any]) -> None:
        """Adds what is conjugate to interpolated numbers to what is conjugate to coordinates."""
        for (component, weights), own in zip(rows, numbers):
            for node, weight in enumerate(weights):
                place = node * self._size + component
                total[place] = total[place] + own * weight

    def _residual(self, name: str, own: Any, s: State, p: Any, t: Any) -> list[Any]:
        total: list[Any] = [0.0] * self._recorder.coordinates
        for point, rows in enumerate(self._field.points):
            state = State(*(self._at(rows, x) for x in (s.a, s.v, s.q)))
            self._spread(rows, self._results(point, name, own(point, state, p, t), len(rows)), total)
        return total

    def _sum_of_moving(self, name: str, own: Any, v: Any, q: Any, p: Any) -> Any:
        total: Any = 0.0
        for point, rows in enumerate(self._field.points):
            rates, h = self._at(rows, v), self._at(rows, q)
            total = total + self._results(point, name, own(point, rates, h, p), 1)[0]
        return total

    def _sum(self, name: str, own: Any, q: Any, p: Any) -> Any:
        total: Any = 0.0
        for point, rows in enumerate(self._field.points):
            total = total + self._results(point, name, own(point, self._at(rows, q), p), 1)[0]
        return total

    def _force(self, name: str, own: Any, v: Any, q: Any, p: Any, t: Any) -> list[Any]:
        total: list[Any] = [0.0] * self._recorder.coordinates
        for point, rows in enumerate(self._field.points):
            made = own(point, self._at(rows, v), self._at(rows, q), p, t)
            self._spread(rows, self._results(point, name, made, len(rows)), total)
        return total

    def _strains(self, name: str, own: Any, q: Any, p: Any, t: Any) -> list[Any]:
        made = [
            self._results(point, name, own(point, self._at(rows, q), p), None)
            for point, rows in enumerate(self._field.points)
        ]
        self._counts = [len(strains) for strains in made]
        return [strain for strains in made for strain in strains]

    def _of_each(self, e: Any) -> list[Any]:
        """Strains, or their rates, point by point."""
        ends = np.cumsum(self._counts)
        return [e[end - count : end] for end, count in zip(ends, self._counts)]

    def _stored(self, name: str, own: Any, e: Any, p: Any) -> Any:
        total: Any = 0.0
        for point, strains in enumerate(self._of_each(e)):
            if len(strains):
                total = total + self._results(point, name, own(point, strains, p), 1)[0]
        return total

    def _damping(self, name: str, own: Any, e: Any, rate: Any, p: Any, t: Any) -> list[Any]:
        made: list[Any] = []
        for point, (strains, rates) in enumerate(zip(self._of_each(e), self._of_each(rate))):
            if len(strains):
                made += self._results(point, name, own(point, strains, rates, p), len(strains))
        return made


class Constraint(Part):
    """A joint: ``g(q, p, t)`` gives the equations g = 0, scaled so that they are lengths or angles."""

    _kind = "constraint"

    def g(self, q: Any, p: Any, t: Any) -> Any:
        """The equations."""
        raise InputError(f"{type(self).__name__} has no equations: give it g(q, p, t)")

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
        _, _, q, p, t = recorder.state_and_more()
        formulas = recorder.recorded(self, {"g": ([q, p, t], None)})
        return {"formulas": formulas, "equations": len(formulas["g"]["results"])}


class Quantity(Part):
    """A number that is measured: ``value(s, p, t)``, with the attribute ``unit``."""

    _kind = "quantity"
    #: Its unit.
    unit: ClassVar[str] = "-"

    def value(self, s: State, p: Any, t: Any) -> Any:
        """The number at a state."""
        raise InputError(f"{type(self).__name__} has no formula: give it value(s, p, t)")

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
        a, v, q, p, t = recorder.state_and_more()
        return {"formulas": recorder.recorded(self, {"value": ([State(a, v, q), p, t], 1)}), "unit": self.unit}


class _Recorder:
    """Runs the formulas of a part with numbers that record."""

    def __init__(self, name: str, coordinates: int, parameters: Mapping[str, Parameter]) -> None:
        self.name = name
        self.coordinates = coordinates
        self.parameters = parameters

    def arguments(self, name: str, count: int) -> Any:
        own = np.empty(count, dtype=object)
        own[:] = [argument(f"{name}[{place}]") for place in range(count)]
        return own

    def state_and_more(self) -> tuple[Any, Any, Any, Any, Number]:
        p: list[Number] = []
        names: dict[str, Any] = {}
        for name, own in self.parameters.items():
            numbers = self.arguments(name, 3) if own.point_of is not None else [argument(name)]
            names[name] = numbers if own.point_of is not None else numbers[0]
            p.extend(numbers)
        state = [self.arguments(name, self.coordinates) for name in "avq"]
        return state[0], state[1], state[2], Numbers(p, names), argument("t")

    def recorded(self, part: object, known: Mapping[str, tuple[list[Any], int | None]]) -> dict[str, Any]:
        """Tapes of the methods that a part has, of those that are known with what they get and how much they return."""
        given = {name: own for name, own in known.items() if hasattr(part, name)}
        return {name: self._tape(part, name, arguments, count) for name, (arguments, count) in given.items()}

    def _tape(self, part: object, name: str, arguments: Sequence[Any], count: int | None) -> dict[str, Any]:
        results = _results(f"{name} of {self.name}", getattr(part, name)(*arguments), count)
        flat: list[Number] = []
        for own in arguments:
            lists = [own.a, own.v, own.q] if isinstance(own, State) else [np.atleast_1d(np.array(own, dtype=object))]
            flat.extend(number for numbers in lists for number in numbers)
        return tape(flat, results)


def _results(what: str, made: Any, count: int | None) -> list[Any]:
    """Numbers that a formula returns, as many as are wanted."""
    if made is None:
        raise InputError(f"{what} returns nothing: return {'a number' if count == 1 else 'a list of numbers'}")
    results = list(np.ravel(np.array(made, dtype=object)))
    if count is not None and len(results) != count:
        raise InputError(f"{what} returns {len(results)} numbers, and {count} are wanted")
    return results


def snake(name: str) -> str:
    """``DuffingSpring`` as ``duffing_spring``."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def describe(part: Part | type[Part]) -> str:
    """A part as the library takes it: name, sentence, nodes, parameters, tapes. Each type is recorded once for its
    options."""
    own = part() if isinstance(part, type) else part
    if not isinstance(own, Part):
        raise InputError(f"{part!r} is no part: derive it from costate.Element, costate.Constraint or costate.Quantity")
    key = (type(own), repr(sorted(vars(own).items())))
    if key not in Part._recorded:
        Part._recorded[key] = json.dumps(_description(own))
    return Part._recorded[key]


def _parameter(name: str, given: Any, word: str) -> Parameter:
    if isinstance(given, Parameter):
        return given
    if not isinstance(given, str):
        raise InputError(f'parameter "{name}" of {word} is {given!r}: give its unit, "N/m", or costate.positive("N/m")')
    return Parameter(given)


def _usual_doc(name: str, own: Parameter) -> str:
    return name if own.point_of is None else f"point of node {own.point_of + 1}, in the world at the start"


def _description(own: Part) -> dict[str, Any]:
    word = type(own).__name__
    if isinstance(own.nodes, str):
        raise InputError(f'nodes of {word} is a text: give a list, ["{own.nodes}"]')
    if unknown := [kind for kind in own.nodes if kind not in NODES]:
        raise InputError(f'{word} has a node "{unknown[0]}"; there are {", ".join(NODES)}')
    if not own.nodes:
        raise InputError(f"{word} has no nodes: give it the attribute nodes, a list of {', '.join(NODES)}")
    parameters = {name: _parameter(name, given, word) for name, given in own.parameters.items()}
    if bad := [
        name
        for name in parameters
        if not name.isidentifier() or name in ("name", "type", "on", "between", "over", "for")
    ]:
        raise InputError(f'{word} has a parameter "{bad[0]}": take another name, of letters, numbers and _')
    recorder = _Recorder(word, sum(NODES[kind] for kind in own.nodes), parameters)
    doc = (type(own).__doc__ or word).strip().split("\n")[0].rstrip(".")
    return {
        "kind": own._kind,
        "name": snake(word),
        "doc": doc,
        "nodes": list(own.nodes),
        "parameters": [
            {
                "name": name,
                "unit": given.unit,
                "doc": given.doc or _usual_doc(name, given),
                "range": given.range,
                "is_size": given.is_size,
                "point_of": given.point_of,
            }
            for name, given in parameters.items()
        ],
        **own._formulas(recorder),
    }
