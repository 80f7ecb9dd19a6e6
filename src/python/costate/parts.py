"""Elements, joints and quantities of one's own: a class with one formula, recorded once, which then runs as the machine
code of the library.

Jacobians, adjoint products, design derivatives and complex-step checks are made of the recording, as for the library's
own parts.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
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


class Element(Part):
    """An element: give ``residual``, or any of the others, from which it is made.

    Every number that a method gets is recorded; it returns a number, or a list of them.

    * ``residual(s, p, t)``: inertia + internal - applied, a number for each coordinate
    * ``kinetic(v, q, p)``, ``potential(q, p)``, ``strain_energy(q, p)`` [J]
    * ``force(v, q, p, t)``: the generalized non-conservative force, a number for each coordinate
    * ``strains(q, p, t)`` with ``stored(e, p)`` [J], ``damping(e, rate, p, t)``, ``dissipation(e, rate, p)`` [W]
    * ``mass(p)`` [kg]
    * ``breakpoints(p)``: times at which a load jumps [s]; steps end there
    """

    _kind = "element"

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
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
            "breakpoints": ([p], None),
        }
        formulas = recorder.recorded(self, known)
        strains = len(formulas["strains"]["results"]) if "strains" in formulas else 0
        e, rate = recorder.arguments("e", strains), recorder.arguments("rate", strains)
        of_strains = recorder.recorded(
            self, {"stored": ([e, p], 1), "damping": ([e, rate, p, t], strains), "dissipation": ([e, rate, p], 1)}
        )
        if of_strains and not strains:
            raise InputError(f"{type(self).__name__} has {', '.join(of_strains)}, but no strains(q, p, t)")
        formulas |= of_strains
        if not formulas:
            raise InputError(f"{type(self).__name__} has no formula: give it residual, or energies and forces")
        return {"formulas": formulas, "strains": strains}


class Constraint(Part):
    """A joint: ``g(q, p, t)`` gives the equations g = 0, scaled so that they are lengths or angles; ``breakpoints(p)``
    the times [s] at which the motion that it prescribes is not smooth."""

    _kind = "constraint"

    def g(self, q: Any, p: Any, t: Any) -> Any:
        """The equations."""
        raise InputError(f"{type(self).__name__} has no equations: give it g(q, p, t)")

    def _formulas(self, recorder: _Recorder) -> dict[str, Any]:
        _, _, q, p, t = recorder.state_and_more()
        formulas = recorder.recorded(self, {"g": ([q, p, t], None), "breakpoints": ([p], None)})
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

    def __init__(self, coordinates: int, parameters: Sequence[str]) -> None:
        self.coordinates = coordinates
        self.parameters = parameters

    def arguments(self, name: str, count: int) -> Any:
        own = np.empty(count, dtype=object)
        own[:] = [argument(f"{name}[{place}]") for place in range(count)]
        return own

    def state_and_more(self) -> tuple[Any, Any, Any, Any, Number]:
        p = [argument(name) for name in self.parameters]
        state = [self.arguments(name, self.coordinates) for name in "avq"]
        return state[0], state[1], state[2], Numbers(p, dict(zip(self.parameters, p))), argument("t")

    def recorded(self, part: Part, known: Mapping[str, tuple[list[Any], int | None]]) -> dict[str, Any]:
        """Tapes of the methods that a part has, of those that are known with what they get and how much they return."""
        given = {name: own for name, own in known.items() if hasattr(part, name)}
        return {name: self._tape(part, name, arguments, count) for name, (arguments, count) in given.items()}

    def _tape(self, part: Part, name: str, arguments: Sequence[Any], count: int | None) -> dict[str, Any]:
        what, made = f"{name} of {type(part).__name__}", getattr(part, name)(*arguments)
        if made is None:
            raise InputError(f"{what} returns nothing: return {'a number' if count == 1 else 'a list of numbers'}")
        results = list(np.ravel(np.array(made, dtype=object)))
        if count is not None and len(results) != count:
            raise InputError(f"{what} returns {len(results)} numbers, and {count} are wanted")
        flat: list[Number] = []
        for own in arguments:
            lists = [own.a, own.v, own.q] if isinstance(own, State) else [np.atleast_1d(np.array(own, dtype=object))]
            flat.extend(number for numbers in lists for number in numbers)
        return tape(flat, results)


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


def _description(own: Part) -> dict[str, Any]:
    word = type(own).__name__
    if unknown := [kind for kind in own.nodes if kind not in NODES]:
        raise InputError(f'{word} has a node "{unknown[0]}"; there are {", ".join(NODES)}')
    if not own.nodes:
        raise InputError(f"{word} has no nodes: give it the attribute nodes, a list of {', '.join(NODES)}")
    parameters = {
        name: given if isinstance(given, Parameter) else Parameter(given) for name, given in own.parameters.items()
    }
    if bad := [
        name
        for name in parameters
        if not name.isidentifier() or name in ("name", "type", "on", "between", "over", "for")
    ]:
        raise InputError(f'{word} has a parameter "{bad[0]}": take another name, of letters, numbers and _')
    recorder = _Recorder(sum(NODES[kind] for kind in own.nodes), list(parameters))
    doc = (type(own).__doc__ or word).strip().split("\n")[0].rstrip(".")
    return {
        "kind": own._kind,
        "name": snake(word),
        "doc": doc,
        "nodes": list(own.nodes),
        "parameters": [
            {"name": name, "unit": given.unit, "doc": given.doc or name, "range": given.range, "is_size": given.is_size}
            for name, given in parameters.items()
        ],
        **own._formulas(recorder),
    }
