"""Scenes: mechanisms as functions of their design variables, which can be run and differentiated."""

from __future__ import annotations

import html
import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from numbers import Integral, Real
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _costate
from .errors import InputError, RunWarning, user_level
from .parts import Part, describe
from .progress import Bar, Progress, told
from .results import Array, Fitted, FittedCurve, Gradient, Mode, Run

class DesignVariable(NamedTuple):
    """A design variable: its initial value and bounds in its unit."""

    name: str
    initial: float
    bounds: tuple[float, float]
    unit: str


class Functional(NamedTuple):
    """A number that a run gives."""

    name: str
    unit: str


class Scene:
    """A mechanism as a function of its design variables: ``load``, ``loads``, ``built_in``, ``Model`` and ``scene``
    give one.

    A design is an array in the order of ``variables``, or a table of some of them by name, the others as they are at
    first; without one it is the initial design. Calls release the lock of the interpreter, so that several threads run
    at once, and end with ``KeyboardInterrupt`` after the step in hand when Ctrl-C is pressed.
    """

    def __init__(self, native: _costate.Scene, made_by: tuple[Any, ...]) -> None:
        self._native = native
        self._made_by = made_by

    @staticmethod
    def _parsed(file: str, text: str, parts: Sequence[str]) -> Scene:
        return Scene(_costate.Scene.parse(file, text, list(parts)), ("parsed", file, text, tuple(parts)))

    @staticmethod
    def _built(file: str, entries: str, parts: Sequence[str]) -> Scene:
        return Scene(_costate.Scene.build(file, entries, list(parts)), ("built", file, entries, tuple(parts)))

    @property
    def name(self) -> str:
        """Its name."""
        return self._native.name()

    @property
    def summary(self) -> str:
        """What it is, in a sentence."""
        return self._native.summary()

    @property
    def text(self) -> str | None:
        """The text of its file; ``None`` for a built-in scene."""
        if self._made_by[0] == "built":
            return _costate.Scene.written(self._made_by[2])
        return str(self._made_by[2]) if self._made_by[0] == "parsed" else None

    @property
    def end(self) -> float:
        """Duration of a run [s]; of statics the last load factor."""
        return self._native.settings()[0]

    @property
    def steps(self) -> int:
        """Steps of a run; without meaning where they are chosen by their error."""
        return self._native.settings()[1]

    @cached_property
    def variables(self) -> tuple[DesignVariable, ...]:
        """Design variables, in the order of a design."""
        return tuple(DesignVariable(*own) for own in self._native.variables())

    @cached_property
    def functionals(self) -> tuple[Functional, ...]:
        """What a run gives, in the order of ``values``."""
        return tuple(Functional(*own) for own in self._native.functionals())

    @property
    def initial(self) -> Array:
        """The initial design."""
        return np.array([own.initial for own in self.variables])

    @property
    def scenarios(self) -> dict[str, Scene]:
        """The circumstances in which it is run, by their names; none for most scenes."""
        return {name: Scene(own, ("scenario", self, name)) for name, own in self._native.scenarios()}

    def design(self, x: Any = None) -> Array:
        """A design as an array of floats."""
        if x is None:
            return self.initial
        if isinstance(x, Mapping):
            own, places = self.initial, {variable.name: place for place, variable in enumerate(self.variables)}
            for name, value in x.items():
                if name not in places:
                    raise InputError(f'scene "{self.name}" has no design variable "{name}"; it has {", ".join(places)}')
                own[places[name]] = _real(value, f'design variable "{name}"')
            return own
        return self._vector(_reals(x, "a design"), "a design")

    def _vector(self, own: Array, what: str) -> Array:
        if own.shape != (len(self.variables),):
            raise InputError(
                f'{what} of shape {own.shape} for scene "{self.name}", which has {len(self.variables)} design '
                f"variables: shape ({len(self.variables)},) is wanted"
            )
        return own

    def _places(self, functionals: str | Sequence[str] | None) -> list[int]:
        names = [own.name for own in self.functionals]
        if functionals is not None and not isinstance(functionals, (str, Iterable)):
            raise TypeError(f"functionals is {functionals!r}: a name, or a list of names, is wanted")
        if functionals is None:
            return list(range(len(names)))
        wanted = [functionals] if isinstance(functionals, str) else list(functionals)
        for name in wanted:
            if name not in names:
                raise InputError(f'scene "{self.name}" has no functional "{name}"; it has {", ".join(names)}')
        return [names.index(name) for name in wanted]

    def run(
        self,
        x: Any = None,
        *,
        end: float | None = None,
        steps: int | None = None,
        method: str | None = None,
        progress: Progress = None,
    ) -> Run:
        """Simulates a design.

        * ``end``: duration [s], instead of the scene's own
        * ``steps``: steps of equal size, instead of the scene's own
        * ``method``: integrator, as for ``--method`` of the command line
        * ``progress``: whether a bar shows how far the run is, by default in terminals and notebooks after a second; or
          a function of the time that is reached and of the end, called several times a second

        Raises ``InputError`` and ``RunError``; ``KeyboardInterrupt`` whose attribute ``run`` has the finished steps.
        """
        _check_options(end, steps, method)
        design, tell = self.design(x), told(progress, self.name, self.end if end is None else end)
        try:
            return self._run(design, end=end, steps=steps, method=method, progress=tell)
        finally:
            if isinstance(tell, Bar):
                tell.close()

    def modes(
        self,
        x: Any = None,
        *,
        count: int = 6,
        damped: bool = False,
        static: bool = False,
        periodic: bool = False,
        gradients: bool = False,
    ) -> list[Mode]:
        """Small vibrations about the equilibrium of a design: up to ``count`` whose omega^2 are nearest to zero.

        * ``damped``: with dampers, states of first order and what else depends on velocities, as always about a steady
          turn
        * ``static``: about the equilibrium after the scene's load steps instead of its start
        * ``periodic``: about the motion of a run that is one period long and ends as it began (Floquet), those first that
          grow fastest; their frequencies are known up to multiples of 2 pi by the period, and are the least of these
        * ``gradients``: with derivatives by all design variables, exact to round-off, through the equilibrium

        Raises ``InputError`` and ``RunError``.
        """
        if not isinstance(count, Integral) or isinstance(count, bool) or count < 1:
            raise InputError(f"count of modes: {count!r}; it must be a whole number from 1 on")
        if periodic and (damped or static or gradients):
            raise InputError(
                "modes about a periodic motion have dampers anyway, no equilibrium and no derivatives: leave the others out"
            )
        about = (bool(damped), bool(periodic))
        found = self._native.modes(self._still(x, static), int(count), about, bool(gradients))
        modes = []
        for frequency, growth, whirl, derivatives in found:
            by_frequency, by_growth, equal = derivatives if derivatives is not None else (None, None, None)
            rows = [None if own is None else np.array(own) for own in (by_frequency, by_growth)]
            modes.append(Mode(frequency, growth, whirl, rows[0], rows[1], equal))
        return modes

    def fit(self, x: Any = None) -> Fitted:
        """Fits the scene to its measurements from a design: least squares within the bounds, as ``costate fit``.

        Raises ``InputError`` and ``RunError``.
        """
        design, covariance, estimated, (total, degrees, is_optimum), curves = self._native.fit(self.design(x).tolist())
        matrix = np.array(covariance, dtype=float).reshape(len(estimated), len(estimated))
        own = {name: FittedCurve(*map(np.array, arrays)) for name, *arrays in curves}
        return Fitted(np.array(design), np.array(estimated, dtype=int), matrix, total, degrees, is_optimum, own)

    def response(self, by: str, rates: Any, x: Any = None, *, static: bool = False) -> NDArray[np.complex128]:
        """Complex amplitudes of all functionals, by the design variable ``by``, where it varies by a small
        d cos(omega t) about the equilibrium of ``modes``: an array ``(rates, functionals)`` for rates omega [rad/s].

        Raises ``InputError`` and ``RunError``.
        """
        own = np.atleast_1d(_reals(rates, "rates"))
        if own.ndim != 1:
            raise InputError(f"rates of shape {own.shape}: a list of numbers is wanted")
        parts = self._native.response(self._still(x, static), by, own.tolist())
        numbers = np.array(parts, dtype=float).reshape(len(own), len(self.functionals), 2)
        return np.asarray(numbers[..., 0] + 1j * numbers[..., 1])

    def _still(self, x: Any, static: bool) -> tuple[list[float], dict[str, Any]]:
        method = "static" if static else None
        return self.design(x).tolist(), {**_OPTIONS, "keep_steps": False, "method": method, "progress": None}

    def _run(self, x: Array, *, keep_steps: bool = True, **options: Any) -> Run:
        native, stopped = self._native.run(x.tolist(), {**_OPTIONS, **options, "keep_steps": keep_steps})
        run = Run(native, self.name, self.variables)
        if stopped is not None:
            stopped.run = run  # type: ignore[attr-defined]
            raise stopped
        for doubt in run.doubts:
            warnings.warn(doubt, RunWarning, stacklevel=user_level())
        return run

    def values(self, x: Any = None) -> Array:
        """Values of all functionals at a design; no step is kept."""
        return self._run(self.design(x), keep_steps=False).values

    def value_and_grad(self, x: Any = None, functionals: str | Sequence[str] | None = None) -> tuple[Any, Array]:
        """Values of functionals and their derivatives by all design variables.

        Of one functional by its name a float and an array ``(variables,)``; of several, or of all, arrays
        ``(functionals,)`` and ``(functionals, variables)``.
        """
        places = self._places(functionals)
        run = self._run(self.design(x))
        rows = run._rows(places)
        if isinstance(functionals, str):
            return float(run.values[places[0]]), rows[0]
        return run.values[places], rows

    def gradient(self, x: Any = None, functionals: str | Sequence[str] | None = None) -> Gradient:
        """The same as a table with names."""
        return self.run(x).gradient(functionals)

    def jvp(self, x: Any, tangent: Any, functionals: str | Sequence[str] | None = None) -> tuple[Any, Any]:
        """Values of functionals and what they change by along a direction of the design."""
        direction = self._direction(tangent)
        values, rows = self.value_and_grad(x, functionals)
        return values, rows @ direction

    def vjp(self, x: Any, functionals: str | Sequence[str] | None = None) -> tuple[Any, Callable[[Any], Array]]:
        """Values of functionals, and a function that takes a weight for each and gives the derivative of their weighted
        sum by all design variables: one sweep backwards for the functionals whose weights are not 0, when it is
        called."""
        places = self._places(functionals)
        run = self._run(self.design(x))

        def pull(weights: Any) -> Array:
            own = np.atleast_1d(_reals(weights, "weights of functionals"))
            if own.shape != (len(places),):
                raise InputError(
                    f"weights of shape {own.shape} for {len(places)} functionals: shape ({len(places)},) is wanted"
                )
            counted = np.flatnonzero(own)
            if not counted.size:
                return np.zeros(len(self.variables))
            return np.asarray(own[counted] @ run._rows([places[place] for place in counted]))

        values = run.values[places]
        return (float(values[0]) if isinstance(functionals, str) else values), pull

    def _direction(self, tangent: Any) -> Array:
        if isinstance(tangent, Mapping):
            given = np.array([own.name in tangent for own in self.variables])
            return np.where(given, self.design(tangent), 0.0)
        return self._vector(_reals(tangent, "a direction"), "a direction")

    def apply(self, inputs: Mapping[str, float]) -> dict[str, float]:
        """Values of functionals by their names for design variables by theirs: the entry that couplings of solvers ask
        for."""
        return {own.name: float(value) for own, value in zip(self.functionals, self.values(inputs))}

    def vector_jacobian_product(self, inputs: Mapping[str, float], cotangents: Mapping[str, float]) -> dict[str, float]:
        """Derivatives of a weighted sum of functionals by the design variables that ``inputs`` has, by name."""
        _, pull = self.vjp(inputs, list(cotangents))
        row = pull([_real(own, f'weight of "{name}"') for name, own in cotangents.items()])
        return {own.name: float(entry) for own, entry in zip(self.variables, row) if own.name in inputs}

    def __reduce__(self) -> tuple[Any, ...]:
        return _made_again, self._made_by

    def __repr__(self) -> str:
        return f"<scene {self.name!r} with {len(self.variables)} design variables>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(own.name)}</td><td>{own.initial:g}</td><td>{own.bounds[0]:g}</td><td>{own.bounds[1]:g}</td>"
            f"<td>{html.escape(own.unit)}</td></tr>"
            for own in self.variables
        )
        head = "<tr><th>variable</th><th>initial</th><th>least</th><th>largest</th><th>unit</th></tr>"
        return f"<b>{html.escape(self.name)}</b> {html.escape(self.summary)}<table>{head}{rows}</table>"


def _check_options(end: object, steps: object, method: object) -> None:
    for name, own, kind, words in [
        ("end", end, Real, "a number"),
        ("steps", steps, Integral, "a whole number"),
        ("method", method, str, "the name of a method"),
    ]:
        if own is not None and not isinstance(own, kind):
            raise TypeError(f"{name} is {own!r}: {words} is wanted")
    if isinstance(steps, Integral) and steps < 1:
        raise InputError(f"steps is {steps}: a run has one step at least")


_OPTIONS: dict[str, Any] = {"end": None, "steps": None, "method": None, "progress": None}


def _made_again(kind: str, *given: Any) -> Scene:
    if kind == "parsed":
        return Scene._parsed(*given)
    if kind == "built":
        return Scene._built(*given)
    if kind == "built_in":
        return built_in(*given)
    scene, name = given
    scenarios: dict[str, Scene] = scene.scenarios
    return scenarios[name]


def _reals(given: Any, what: str) -> Array:
    """Real numbers as an array of floats."""
    own = np.asarray(given)
    if own.dtype.kind not in "fiub":
        raise InputError(f"{what} has numbers of type {own.dtype}: real numbers are wanted")
    return own.astype(float)


def _real(given: Any, what: str) -> float:
    own = _reals(given, what)
    if own.size != 1:
        raise InputError(f"{what} has {own.size} values, and one is wanted")
    return float(own.reshape(()))


def load(path: str | os.PathLike[str], *, parts: Sequence[Part | type[Part]] = ()) -> Scene:
    """Reads a scene file, which may use parts of one's own by their names: ``type = "duffing"`` is the class
    ``Duffing``.

    Raises ``SceneError`` with a line for each mistake, ``OSError`` where there is no such file.
    """
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: this is no text in UTF-8: {error}") from None
    return Scene._parsed(str(file.resolve()), text, [describe(part) for part in parts])


def loads(text: str, name: str = "scene.toml", *, parts: Sequence[Part | type[Part]] = ()) -> Scene:
    """Reads the text of a scene file; files that it names lie beside a file of that name."""
    return Scene._parsed(name, text, [describe(part) for part in parts])


def built_in(name: str) -> Scene:
    """A scene of the library: ``built_in_names()`` lists them."""
    native = _costate.Scene.built_in(name)
    if native is None:
        raise InputError(f'no built-in scene is named "{name}"; there are {", ".join(built_in_names())}')
    return Scene(native, ("built_in", name))


def built_in_names() -> list[str]:
    """Names of the scenes of the library."""
    return _costate.Scene.built_in_names()


def value_and_grad(scene: Scene, functional: str | Sequence[str] | None = None) -> Callable[..., tuple[Any, Array]]:
    """``scene.value_and_grad`` of some functionals as a function of a design alone, as optimizers take it."""
    return lambda x=None: scene.value_and_grad(x, functional)
