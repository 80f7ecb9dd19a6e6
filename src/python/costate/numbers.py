"""Numbers of formulas: what Python does with them is recorded, and the recording is what runs.

Operators, ``numpy`` functions and arrays of them work as with floats; ``where``, ``less``, ``minimum``, ``maximum`` and
``sign`` choose.
"""

from __future__ import annotations

import itertools
import math
import operator
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from numbers import Real
from typing import Any, NoReturn

import numpy as np

from .errors import InputError, RecordingError, user_line

_made = itertools.count()
# how deep formulas of a file may lie in each other, with some room
_DEEPEST = 25


class Number:
    """A number of a formula that is being recorded. It has no value yet: what holds for it must hold for all values."""

    __slots__ = ("function", "of", "place")

    def __init__(self, function: str, of: tuple[Any, ...]) -> None:
        self.function = function
        self.of = of
        #: How many were made before it.
        self.place = next(_made)

    def __add__(self, other: Any) -> Any:
        return _binary("add", self, other)

    def __radd__(self, other: Any) -> Any:
        # sums begin with 0
        return self if isinstance(other, Real) and other == 0 else _binary("add", other, self)

    def __sub__(self, other: Any) -> Any:
        return _binary("sub", self, other)

    def __rsub__(self, other: Any) -> Any:
        return _binary("sub", other, self)

    def __mul__(self, other: Any) -> Any:
        return _binary("mul", self, other)

    def __rmul__(self, other: Any) -> Any:
        return _binary("mul", other, self)

    def __truediv__(self, other: Any) -> Any:
        return _binary("div", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return _binary("div", other, self)

    def __pow__(self, exponent: Any) -> Any:
        if isinstance(exponent, Number):
            return (exponent * self.log()).exp()
        if not isinstance(exponent, Real):
            return NotImplemented
        if float(exponent).is_integer():
            return Number("powi", (self, int(float(exponent))))
        return Number("powf", (self, float(exponent)))

    def __rpow__(self, base: Any) -> Any:
        return (self * math.log(base)).exp() if isinstance(base, Real) else NotImplemented

    def __neg__(self) -> Number:
        return Number("neg", (self,))

    def __pos__(self) -> Number:
        return self

    def __abs__(self) -> Number:
        return Number("abs", (self,))

    def __lt__(self, other: Any) -> Any:
        return _binary("less", self, other)

    def __gt__(self, other: Any) -> Any:
        return _binary("less", other, self)

    def __le__(self, other: Any) -> Any:
        return 1.0 - _binary("less", other, self)

    def __ge__(self, other: Any) -> Any:
        return 1.0 - _binary("less", self, other)

    def __eq__(self, other: object) -> bool:
        _refuse("compares a number for equality")

    def __ne__(self, other: object) -> bool:
        _refuse("compares a number for equality")

    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        _refuse("branches on a number")

    def __float__(self) -> float:
        _refuse("asks for the value of a number")

    def __int__(self) -> int:
        _refuse("asks for the value of a number")

    def __index__(self) -> int:
        _refuse("counts with a number")

    def __repr__(self) -> str:
        return f"<number of a formula: {self.of[0] if self.function in ('argument', 'constant') else self.function}>"

    def sqrt(self) -> Number:
        return Number("sqrt", (self,))

    def exp(self) -> Number:
        return Number("exp", (self,))

    def log(self) -> Number:
        return Number("log", (self,))

    def sin(self) -> Number:
        return Number("sin", (self,))

    def cos(self) -> Number:
        return Number("cos", (self,))

    def tan(self) -> Number:
        return Number("tan", (self,))

    def arcsin(self) -> Number:
        return Number("asin", (self,))

    def arccos(self) -> Number:
        return Number("acos", (self,))

    def arctan(self) -> Number:
        return Number("atan", (self,))

    def sinh(self) -> Number:
        return Number("sinh", (self,))

    def cosh(self) -> Number:
        return Number("cosh", (self,))

    def tanh(self) -> Number:
        return Number("tanh", (self,))

    def arctan2(self, other: Any) -> Any:
        return _binary("atan2", self, other)

    def hypot(self, other: Any) -> Any:
        return (self * self + other * other).sqrt()

    def square(self) -> Any:
        return self * self

    def reciprocal(self) -> Any:
        return 1.0 / self

    def fabs(self) -> Number:
        return abs(self)

    def log2(self) -> Any:
        return self.log() / math.log(2.0)

    def log10(self) -> Any:
        return self.log() / math.log(10.0)

    def deg2rad(self) -> Any:
        return self * (math.pi / 180.0)

    radians = deg2rad

    def rad2deg(self) -> Any:
        return self * (180.0 / math.pi)

    degrees = rad2deg

    def conjugate(self) -> Number:
        return self


def _refuse(what: str) -> NoReturn:
    file, line = user_line()
    raise RecordingError(
        f"{file}, line {line}: {what} that has no value yet, since the formula is recorded once for all values; choose "
        "by costate.where, less, minimum, maximum, sign or abs, take functions of numpy instead of those of math, and "
        "arrays with dtype=object"
    )


def argument(name: str) -> Number:
    """A number that a formula starts from."""
    return Number("argument", (name,))


def constant(value: Any) -> Number:
    """A number that is known."""
    return value if isinstance(value, Number) else Number("constant", (float(value),))


def _binary(function: str, a: Any, b: Any) -> Any:
    if not (isinstance(a, (Number, Real)) and isinstance(b, (Number, Real))):
        return NotImplemented
    return Number(function, (constant(a), constant(b)))


def _choose(function: str, of_floats: Callable[..., Any], *given: Any) -> Any:
    """Of numbers, or of arrays of them element by element; floats have values."""
    is_recorded = any(isinstance(own, Number) for part in given for own in np.array(part, dtype=object).flat)
    if not is_recorded:
        return of_floats(*given)

    def record(*given: Any) -> Number:
        return Number(function, tuple(constant(own) for own in given))

    is_array = any(np.ndim(np.array(own, dtype=object)) for own in given)
    return np.frompyfunc(record, len(given), 1)(*given) if is_array else record(*given)


def less(a: Any, b: Any) -> Any:
    """1 where a is less than b, otherwise 0: a mask for ``where``."""
    return _choose("less", lambda a, b: np.less(a, b) * 1.0, a, b)


def where(mask: Any, then: Any, otherwise: Any) -> Any:
    """``then`` where the mask is not 0, otherwise ``otherwise``; what is not taken leaves no trace in any
    derivative."""
    return _choose("select", np.where, mask, then, otherwise)


def minimum(a: Any, b: Any) -> Any:
    """The smaller of two numbers, the first where they are equal."""
    return _choose("min", np.minimum, a, b)


def maximum(a: Any, b: Any) -> Any:
    """The larger of two numbers, the first where they are equal."""
    return _choose("max", np.maximum, a, b)


def sign(x: Any) -> Any:
    """-1, 0 or 1."""
    return _choose("sign", np.sign, x)


def floor(x: Any) -> Any:
    """The largest whole number that is not above x; its derivative is zero. For formulas of own parts."""
    return _choose("floor", np.floor, x)


def rotation(e: Any) -> Any:
    """The matrix R(e) of Euler parameters ``e``, coordinates 3 to 6 of a body: it takes components in the body's frame
    to the world."""
    a, x, y, z = e
    return np.array(
        [
            [a * a + x * x - y * y - z * z, 2.0 * (x * y - a * z), 2.0 * (x * z + a * y)],
            [2.0 * (x * y + a * z), a * a - z * z - (x * x - y * y), 2.0 * (y * z - a * x)],
            [2.0 * (x * z - a * y), 2.0 * (y * z + a * x), a * a + z * z - x * x - y * y],
        ]
    )


def _dot(a: Any, b: Any) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Any, b: Any) -> Any:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _rotated(scalar: Any, vector: Any, s: Any) -> Any:
    return (
        s * (scalar * scalar - _dot(vector, vector))
        + vector * (_dot(vector, s) * 2.0)
        + _cross(vector, s) * (scalar * 2.0)
    )


def rotate(e: Any, s: Any) -> Any:
    """R(e) s: components in the frame of a body with the Euler parameters ``e``, taken to the world."""
    return _rotated(e[0], np.array([e[1], e[2], e[3]]), np.asarray(s))


def rotate_back(e: Any, s: Any) -> Any:
    """R(e)^T s: components in the world, taken to the frame of a body with the Euler parameters ``e``."""
    return _rotated(e[0], np.array([-e[1], -e[2], -e[3]]), np.asarray(s))


def g_times(e: Any, rate: Any) -> Any:
    """G(e) de for Euler parameters ``e`` and their rate: half of the angular velocity in the body's frame; of changes
    along a line half of its curvature."""
    u, w = np.array([e[1], e[2], e[3]]), np.array([rate[1], rate[2], rate[3]])
    return w * e[0] - u * rate[0] - _cross(u, w)


class Numbers(np.lib.mixins.NDArrayOperatorsMixin):
    """An array of numbers, which also have names: ``x[0]``, ``x["length"]``, ``x.length``. Whatever else is asked of it
    is asked of the array; a name comes first, as ``size`` of a part whose parameter that is."""

    def __init__(self, numbers: Sequence[Any], names: Mapping[str, Any] | None = None) -> None:
        self._array = np.empty(len(numbers), dtype=object)
        self._array[:] = numbers
        self._names = dict(names or {})

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray[Any, Any]:
        return np.array(self._array, dtype=dtype)

    def __array_ufunc__(self, function: np.ufunc, method: str, *given: Any, **options: Any) -> Any:
        return getattr(function, method)(*(own._array if isinstance(own, Numbers) else own for own in given), **options)

    def __len__(self) -> int:
        return len(self._array)

    def __iter__(self) -> Iterator[Any]:
        return iter(self._array)

    def __getitem__(self, key: Any) -> Any:
        if not isinstance(key, str):
            return self._array[key]
        if key not in self._names:
            raise InputError(
                f'there is no number "{key}" here; there are {", ".join(self._names) or "none with names"}'
            )
        return self._names[key]

    def __getattr__(self, name: str) -> Any:
        # what copies an object asks before there is anything
        names, array = self.__dict__.get("_names", {}), self.__dict__.get("_array")
        if name in names:
            return names[name]
        if hasattr(array, name) and not name.startswith("_"):
            return getattr(array, name)
        raise AttributeError(f'there is no number "{name}" here; there are {", ".join(names) or "none with names"}')

    def __repr__(self) -> str:
        return f"<{len(self)} numbers of a formula: {', '.join(self._names)}>"


def in_order(results: Iterable[Number]) -> list[Number]:
    """The numbers of which some others are made, each once, in the order in which they were made: derivatives are sums
    in that order, and have the bits of the same formula in Rust."""
    stack, found = list(results), {}
    while stack:
        number = stack.pop()
        if number.place not in found:
            found[number.place] = number
            stack.extend(own for own in number.of if isinstance(own, Number))
    return [found[place] for place in sorted(found)]


def _key(number: Number, places: dict[int, int]) -> tuple[Any, ...]:
    """What tells numbers apart; -0.0 is not 0.0."""
    parts = (places[id(own)] if isinstance(own, Number) else own for own in number.of)
    if number.function == "constant":
        return ("constant", struct.pack("<d", number.of[0]))
    return (number.function, *parts)


def tape(arguments: Sequence[Number], results: Sequence[Any]) -> dict[str, Any]:
    """Operations of a formula in their order, for the library: arguments first, then a number for each operation."""
    numbers = [constant(own) for own in results]
    places = {id(own): place for place, own in enumerate(arguments)}
    known: dict[tuple[Any, ...], int] = {}
    operations: list[Any] = []
    for number in in_order(numbers):
        if id(number) in places:
            continue
        if number.function == "argument":
            raise InputError(f"{number.of[0]} is a number of something else: give it to the part as a parameter")
        key = _key(number, places)
        if key not in known:
            known[key] = len(arguments) + len(operations)
            operations.append(_operation(number, places))
        places[id(number)] = known[key]
    return {"arguments": len(arguments), "operations": operations, "results": [places[id(own)] for own in numbers]}


def _operation(number: Number, places: dict[int, int]) -> Any:
    parts = [places[id(own)] if isinstance(own, Number) else own for own in number.of]
    function = number.function
    if function == "constant":
        if not math.isfinite(parts[0]):
            raise InputError(f"a formula has the number {parts[0]}: numbers of formulas are finite")
    return {"function": function, "of": parts}


_OPERATORS = {"add": "+", "sub": "-", "mul": "*", "div": "/"}


class Formulas:
    """Numbers as formulas of a scene file; what several of them share, or what would lie too deep, gets a name in
    ``[define]``."""

    def __init__(self, numbers: Iterable[Number]) -> None:
        self.definitions: dict[str, str] = {}
        self._texts: dict[int, str] = {}
        order = in_order(numbers)
        uses: dict[int, int] = {}
        for number in order:
            for own in number.of:
                if isinstance(own, Number):
                    uses[id(own)] = uses.get(id(own), 0) + 1
        depths: dict[int, int] = {}
        # numbers live as long as their texts are found by their places in memory
        self._numbers = order
        for number in order:
            text = self._written(number)
            depth = 1 + max((depths[id(own)] for own in number.of if isinstance(own, Number)), default=0)
            is_leaf = number.function in ("argument", "constant")
            if not is_leaf and (uses.get(id(number), 0) > 1 or depth > _DEEPEST):
                name = f"_{len(self.definitions) + 1}"
                self.definitions[name] = text
                text, depth = name, 0
            self._texts[id(number)] = text
            depths[id(number)] = 0 if is_leaf else depth

    def text(self, number: Number) -> str:
        """The formula of a number."""
        return self._texts[id(number)]

    def _written(self, number: Number) -> str:
        function, of = number.function, number.of
        if function == "argument":
            return str(of[0])
        if function == "constant":
            return literal(of[0])
        if function == "powi" or function == "powf":
            exponent = f"({of[1]})" if of[1] < 0 else f"{of[1]}"
            return f"({self.text(of[0])})^{exponent}"
        texts = [self.text(own) for own in of]
        if function in _OPERATORS:
            return f"({texts[0]} {_OPERATORS[function]} {texts[1]})"
        if function == "neg":
            return f"(-{texts[0]})"
        if function == "less":
            return f"if_less({texts[0]}, {texts[1]}, 1, 0)"
        if function == "select":
            mask = of[0]
            if mask.function == "less":
                return f"if_less({self.text(mask.of[0])}, {self.text(mask.of[1])}, {texts[1]}, {texts[2]})"
            return f"if_less(0, abs({texts[0]}), {texts[1]}, {texts[2]})"
        if function == "sign":
            return f"(if_less(0, {texts[0]}, 1, 0) - if_less({texts[0]}, 0, 1, 0))"
        if function == "floor":
            raise InputError("numbers of a scene cannot be rounded by floor; formulas of own parts can")
        return f"{function}({', '.join(texts)})"


def literal(value: float) -> str:
    """A number as formulas and files write it, to the last bit."""
    if not math.isfinite(value):
        raise InputError(f"{value} is no finite number")
    text = repr(float(value))
    return f"({text})" if value < 0 or text.startswith("-") else text


def finite(value: Any, what: str) -> float:
    """A float of anything that is a real number."""
    if isinstance(value, Number):
        raise InputError(f"{what} is a number of a formula, and a float is wanted")
    try:
        return operator.index(value) * 1.0
    except TypeError:
        return float(value)
