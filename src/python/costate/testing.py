"""Checks for parts of one's own, which the library's pass too: what is derived from the recording of a formula is held
against the formula in other numbers and by complex steps, at random states, to 1e-12."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _costate
from .errors import InputError
from .numbers import finite
from .parts import Constraint, Element, Quantity, describe


def check_element(part: Element | type[Element], parameters: Any, count: int = 12) -> None:
    """Holds residual, energies and the products of the adjoint of an element against other numbers.

    * ``parameters``: their values, in order or by name
    * ``count``: of states

    Raises ``CheckError`` with the first disagreement: what, where, and both numbers.
    """
    _check(part, Element, parameters, count)


def check_constraint(part: Constraint | type[Constraint], parameters: Any, count: int = 12) -> None:
    """The same for a joint: motion, reaction and curvature."""
    _check(part, Constraint, parameters, count)


def check_quantity(part: Quantity | type[Quantity], parameters: Any, count: int = 12) -> None:
    """The same for a quantity: value and gradient."""
    _check(part, Quantity, parameters, count)


def _check(part: Any, kind: type[Any], parameters: Any, count: int) -> None:
    own: Any = part if isinstance(part, type) else type(part)
    if not issubclass(own, kind):
        raise InputError(f"{own.__name__} is no costate.{kind.__name__}")
    described, names = describe(part), own._number_names()
    if isinstance(parameters, dict):
        given = [number for name in own.parameters for number in np.ravel(parameters[name])]
    else:
        given = list(np.atleast_1d(parameters))
    if len(given) != len(names):
        raise InputError(f"{own.__name__} has {len(names)} parameters, {', '.join(names)}, and {len(given)} are given")
    _costate.check_part(described, [finite(value, "a parameter") for value in given], count)
