"""Scenes as functions of their design variables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import InputError
from .model import Model
from .numbers import Numbers
from .scenes import Scene


@dataclass(frozen=True)
class Variable:
    """A design variable, or several of one kind where ``initial`` is a list: initial values and bounds in the unit."""

    initial: float | Sequence[float]
    bounds: tuple[float, float]
    unit: str = "-"


def variable(initial: float | Sequence[float], bounds: tuple[float, float], unit: str = "-") -> Variable:
    """A design variable of a scene that is a function."""
    return Variable(initial, bounds, unit)


def scene(*bare: Any, **variables: Variable) -> Callable[[Callable[[Any, Model], Any]], Scene]:
    """Makes a scene of a function ``(x, m)`` of its variables and of a builder, which is run once.

    ``x`` is an array of numbers that record what becomes of them: ``x[0]``, ``x["length"]``, ``x.length``,
    ``np.sin(x)``, ``A @ x``, slices. What exists must not depend on them; numbers may, and the map from them has exact
    derivatives.
    """
    if bare:
        raise InputError(
            "scene takes design variables by their names: @costate.scene(length=costate.variable(1.0, (0, 2)))"
        )
    for name, own in variables.items():
        if not isinstance(own, Variable):
            raise InputError(f"{name} is {own!r}: give a design variable, costate.variable(initial, bounds, unit)")

    def record(function: Callable[[Any, Model], Any]) -> Scene:
        model = Model(function.__name__.replace("_", "-"), summary=_first_line(function.__doc__))
        names: dict[str, Any] = {}
        numbers: list[Any] = []
        for name, own in variables.items():
            names[name] = model.variable(name, own.initial, own.bounds, own.unit)
            numbers.extend(np.ravel(np.array(names[name], dtype=object)))
        function(Numbers(numbers, names), model)
        return model.scene()

    return record


def _first_line(doc: str | None) -> str | None:
    return doc.strip().split("\n")[0] if doc else None
