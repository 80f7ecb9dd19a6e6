"""Results of runs as arrays of numpy."""

from __future__ import annotations

import html
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

if TYPE_CHECKING:
    import pandas
    import pyarrow
    import xarray

    from . import _costate

Array: TypeAlias = NDArray[np.float64]


class _Arrays:
    """What is shown of a dataclass of arrays: their shapes."""

    def __repr__(self) -> str:
        shapes = ", ".join(
            f"{name} {own.shape}" if isinstance(own, np.ndarray) else f"{name} {own!r}"
            for name, own in vars(self).items()
        )
        return f"<{type(self).__name__}: {shapes}>"


@dataclass(frozen=True, eq=False, repr=False)
class NodeHistory(_Arrays):
    """The motion of a node, at the start and at the end of each step."""

    #: [s]
    times: Array
    #: Coordinates q ``(times, coordinates)``: place and Euler parameters of a body, the value of a coordinate.
    coordinates: Array
    #: dq/dt.
    rates: Array
    #: Place of the node's frame in the world ``(times, 3)`` [m]; without rows where it has none, as are the others.
    positions: Array
    #: [m/s]
    velocities: Array
    #: [m/s2]
    accelerations: Array
    #: In the world [rad/s].
    angular_velocities: Array
    #: Axes x, y, z of the node's frame in the world ``(times, 3, 3)``, a row for each axis.
    axes: Array


@dataclass(frozen=True, eq=False)
class Mode:
    """A small vibration: the real part of a shape times exp((growth + i frequency) t)."""

    #: omega [rad/s]; 0 for a rigid motion.
    frequency: float
    #: [1/s]; negative for one that fades.
    growth: float
    #: Of a steady turn: from 1, circles with its sense, to -1, circles against it; ``None`` elsewhere.
    whirl: float | None
    #: d omega / dx for each design variable, if derivatives were asked for; ``None`` for a rigid motion.
    frequency_gradient: Array | None
    #: d growth / dx.
    growth_gradient: Array | None
    #: How many modes have this value: of several each variable alone parts the values as the derivatives say, the
    #: lowest omega first; they do not add up. ``None`` without derivatives.
    equal: int | None

    @property
    def damping_ratio(self) -> float:
        """Share of the critical damping."""
        size = float(np.hypot(self.growth, self.frequency))
        return -self.growth / size if size > 0 else 0.0


@dataclass(frozen=True, eq=False, repr=False)
class FittedCurve(_Arrays):
    """A measurement beside what the fitted scene says."""

    #: When was measured [s].
    times: Array
    #: What the scene has then.
    values: Array
    #: These less what was measured, by the deviations of the measurement where it has some.
    residuals: Array


@dataclass(frozen=True, eq=False, repr=False)
class Fitted(_Arrays):
    """A scene fitted to its measurements."""

    #: All design variables.
    x: Array
    #: Places among them of those that were estimated: all that vary but those at a bound.
    estimated: Array
    #: Covariance of these; infinite for a variable that is not determined.
    covariance: Array
    #: Sum of the losses of all residuals: chi^2 with the linear loss.
    sum: float
    #: Number of residuals less that of the estimated variables.
    degrees: int
    #: Whether the sum is least nearby.
    is_optimum: bool
    #: The measurements, by their names.
    curves: dict[str, FittedCurve]

    @property
    def deviations(self) -> Array:
        """Standard deviations of the estimated variables."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))


@dataclass(frozen=True, eq=False, repr=False)
class JointHistory(_Arrays):
    """What a joint or driver does to the last of its nodes that moves, in the world, at the start and at the end of
    each step."""

    #: [s]
    times: Array
    #: ``(times, 3)`` [N]; without rows where the joint holds nothing in space.
    forces: Array
    #: About the point of the joint [N m]; without rows where the node cannot turn.
    moments: Array
    #: Multipliers of its equations ``(times, equations)``.
    multipliers: Array


@dataclass(frozen=True, eq=False, repr=False)
class History(_Arrays):
    """What a functional measures over time: of an integral what is integrated, of a largest value what is compared."""

    #: [s]
    times: Array
    values: Array
    unit: str


class Run:
    """A simulated scene. Arrays are read from the steps when they are asked for; a pickled run has all of them, but no
    gradients."""

    def __init__(self, native: _costate.Run | None, name: str, variables: tuple[Any, ...]) -> None:
        self._native = native
        self.name = name
        #: Design variables of the scene.
        self.variables = variables

    @cached_property
    def x(self) -> Array:
        """The design."""
        return self._of_steps("this").design()

    @cached_property
    def values(self) -> Array:
        """Values of the functionals."""
        return self._of_steps("this").values()

    @cached_property
    def functionals(self) -> list[str]:
        """Names of the functionals."""
        return [name for name, _ in self._units]

    #: Names of the functionals with the units of their values.
    @cached_property
    def _units(self) -> list[tuple[str, str]]:
        return self._of_steps("this").functionals()

    @cached_property
    def times(self) -> Array:
        """The start and the ends of the steps [s]."""
        return self._of_steps("this").times()

    @cached_property
    def nodes(self) -> list[str]:
        """Names of the nodes that move."""
        return self._of_steps("this").nodes()

    @cached_property
    def joints(self) -> list[str]:
        """Names of joints and drivers."""
        return self._of_steps("this").joints()

    @cached_property
    def events(self) -> list[tuple[str, float]]:
        """Events, stops and latches by their names with the times at which they happened [s]."""
        return self._of_steps("this").events()

    @cached_property
    def work(self) -> dict[str, int]:
        """Steps, systems solved, iterations of Newton's method, factorizations."""
        return self._of_steps("this").work()

    @cached_property
    def doubts(self) -> list[str]:
        """A sentence for each reason to doubt the run or its gradients, which are also given as warnings."""
        return self._of_steps("this").doubts()

    @cached_property
    def _nodes(self) -> dict[str, NodeHistory]:
        return {}

    @cached_property
    def _joints(self) -> dict[str, JointHistory]:
        return {}

    @cached_property
    def _measured(self) -> dict[str, History]:
        return {}

    def _of_steps(self, what: str) -> _costate.Run:
        if self._native is None:
            raise InputError(
                f"{what}: a run that was pickled has the arrays of its nodes, joints and functionals alone: run the "
                "scene again"
            )
        return self._native

    def node(self, name: str) -> NodeHistory:
        """The motion of a node by its name."""
        if name not in self._nodes:
            self._nodes[name] = NodeHistory(**self._of_steps(f'node "{name}"').node(name))
        return self._nodes[name]

    def joint(self, name: str) -> JointHistory:
        """Forces and moments of a joint or driver by its name."""
        if name not in self._joints:
            self._joints[name] = JointHistory(**self._of_steps(f'joint "{name}"').joint(name))
        return self._joints[name]

    def history(self, functional: str) -> History:
        """What a functional measures over time."""
        if functional not in self._measured:
            self._measured[functional] = History(*self._of_steps(f'functional "{functional}"').history(functional))
        return self._measured[functional]

    def __getitem__(self, functional: str) -> float:
        """The value of a functional."""
        if functional not in self.functionals:
            raise InputError(
                f'"{functional}" is no functional of "{self.name}"; there are {", ".join(self.functionals)}'
            )
        return float(self.values[self.functionals.index(functional)])

    def gradient(self, functionals: str | Sequence[str] | None = None) -> Gradient:
        """Derivatives of functionals by all design variables, by the discrete adjoint: one sweep for any number of
        variables."""
        wanted = (
            self.functionals
            if functionals is None
            else [functionals]
            if isinstance(functionals, str)
            else list(functionals)
        )
        values = np.array([self[name] for name in wanted])
        rows = self._rows([self.functionals.index(name) for name in wanted])
        units = dict(self._units)
        return Gradient(wanted, [units[name] for name in wanted], values, self.variables, self.x, rows)

    def _rows(self, places: list[int]) -> Array:
        return self._of_steps("a gradient").gradient(places)

    def complex_step(self) -> Array:
        """Derivatives of all functionals by all variables by complex-step runs of the whole simulation, for checks."""
        return self._of_steps("complex steps").complex_step()

    def tangent(self) -> Array:
        """The same by direct differentiation, eight variables at a time."""
        return self._of_steps("tangents").tangent()

    def to_pandas(self) -> pandas.DataFrame:
        """A table with a row for each time [s]: places, velocities and accelerations of nodes, forces and moments of
        joints, what functionals measure, with units in the heads of the columns as in ``histories.csv``."""
        import pandas

        return pandas.DataFrame(self._columns(), index=pandas.Index(self.times, name="t [s]"))

    def to_arrow(self) -> pyarrow.Table:
        """The same table, the times as its first column, for pyarrow, polars and Parquet files."""
        import pyarrow

        return pyarrow.table({"t [s]": self.times, **self._columns()})

    def to_xarray(self) -> xarray.Dataset:
        """Arrays over the coordinate ``t`` with units in their attributes: ``NODE position``, ``NODE velocity`` and so
        on over ``axis``, too, ``JOINT force`` and ``JOINT moment``, and what each functional measures by its name."""
        import xarray

        arrays: dict[str, Any] = {}

        def add(name: str, rows: Array, unit: str, *dimensions: str) -> None:
            if len(rows) == len(self.times):
                arrays[name] = (("t", *dimensions), rows, {"units": unit})

        for name in self.nodes:
            node = self.node(name)
            for what, rows, unit in [
                ("position", node.positions, "m"),
                ("velocity", node.velocities, "m/s"),
                ("acceleration", node.accelerations, "m/s2"),
                ("angular velocity", node.angular_velocities, "rad/s"),
            ]:
                add(f"{name} {what}", rows, unit, "axis")
            if not len(node.positions):
                count = f"coordinates of {name}"
                arrays[f"{name} coordinates"] = (("t", count), node.coordinates)
                arrays[f"{name} rates"] = (("t", count), node.rates)
        for name in self.joints:
            joint = self.joint(name)
            add(f"{name} force", joint.forces, "N", "axis")
            add(f"{name} moment", joint.moments, "N m", "axis")
        for name in self.functionals:
            own = self.history(name)
            add(name, own.values, own.unit)
        return xarray.Dataset(
            arrays, coords={"t": ("t", self.times, {"units": "s"}), "axis": list("xyz")}, attrs={"scene": self.name}
        )

    def _columns(self) -> dict[str, Array]:
        """Columns of a table with a row for each time, by their heads."""
        columns: dict[str, Array] = {}
        for name in self.nodes:
            node = self.node(name)
            for rows, head in [
                (node.positions, "{}.{} [m]"),
                (node.velocities, "{}.d{}/dt [m/s]"),
                (node.accelerations, "{}.d2{}/dt2 [m/s2]"),
                (node.angular_velocities, "{}.omega_{} [rad/s]"),
            ]:
                _add(columns, rows, lambda axis, head=head, name=name: head.format(name, axis))
            if not len(node.positions):
                for place in range(node.coordinates.shape[1]):
                    columns[f"{name}.q{place}"] = node.coordinates[:, place]
                    columns[f"{name}.dq{place}/dt"] = node.rates[:, place]
        for name in self.joints:
            joint = self.joint(name)
            _add(columns, joint.forces, lambda axis, name=name: f"{name}.force_{axis} [N]")
            _add(columns, joint.moments, lambda axis, name=name: f"{name}.moment_{axis} [N m]")
        for name in self.functionals:
            measured = self.history(name)
            if len(measured.values) == len(self.times):
                columns[f"measured for {name} [{measured.unit}]"] = measured.values
        return columns

    def report(self, *, gradient: bool = False) -> Report:
        """The interactive page that ``costate run`` writes: tables, the motion in space, histories; with ``gradient``
        also derivatives, and parts coloured by them, as ``costate gradient`` does. A notebook shows it."""
        return Report(self.name, self._of_steps("a report").report(gradient))

    def __getstate__(self) -> dict[str, Any]:
        if self._native is not None:
            _ = self.x, self.values, self.functionals, self.times, self.nodes, self.joints, self.work, self.doubts
            for name in self.nodes:
                self.node(name)
            for name in self.joints:
                self.joint(name)
            for name in self.functionals:
                self.history(name)
        return {**self.__dict__, "_native": None}

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.functionals, self.values))
        return f"<run of {self.name!r}: {values}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{value:.12g}</td><td>{html.escape(unit)}</td></tr>"
            for (name, unit), value in zip(self._units, self.values)
        )
        head = "<tr><th>functional</th><th>value</th><th>unit</th></tr>"
        work = ", ".join(f"{count} {what.replace('_', ' ')}" for what, count in self.work.items() if count)
        return f"<b>{html.escape(self.name)}</b>: {work}<table>{head}{rows}</table>"


@dataclass(frozen=True, repr=False)
class Report:
    """A page about a run, whole in itself: it needs no network."""

    #: Name of the scene.
    name: str
    #: The page.
    html: str

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the page, into a folder that exists, and gives its path."""
        file = Path(path)
        file.write_text(self.html, encoding="utf-8")
        return file

    def __repr__(self) -> str:
        return f"<report of {self.name!r}: {len(self.html) / 1e6:.1f} MB of HTML; save(path) writes it>"

    def _repr_html_(self) -> str:
        page = html.escape(self.html)
        frame = 'width="100%" height="700" style="border:0" sandbox="allow-scripts"'
        return f'<iframe title="report of {html.escape(self.name)}" {frame} srcdoc="{page}"></iframe>'


def _add(columns: dict[str, Array], rows: Array, head: Any) -> None:
    for place, axis in enumerate("xyz"):
        if len(rows):
            columns[head(axis)] = rows[:, place]


@dataclass(frozen=True, eq=False, repr=False)
class Gradient:
    """Derivatives of functionals by design variables; ``np.asarray`` gives ``rows``."""

    functionals: list[str]
    units: list[str]
    values: Array
    variables: tuple[Any, ...]
    #: The design.
    x: Array
    #: ``(functionals, variables)``.
    rows: Array

    def __getitem__(self, names: str | tuple[str, str]) -> Any:
        """The derivative of a functional by a variable: ``gradient["psi", "length"]``; by all of them, in their order:
        ``gradient["psi"]``."""
        functional, variable = (names, None) if isinstance(names, str) else names
        known = [own.name for own in self.variables]
        if variable is None and functional in self.functionals:
            return self.rows[self.functionals.index(functional)]
        if functional not in self.functionals or variable not in known:
            asked = f'"{functional}"' if variable is None else f'"{functional}" by "{variable}"'
            raise InputError(f"no derivative of {asked}; there are {', '.join(self.functionals)} by {', '.join(known)}")
        return float(self.rows[self.functionals.index(functional), known.index(variable)])

    def __repr__(self) -> str:
        lines = []
        for name, unit, value, row in zip(self.functionals, self.units, self.values, self.rows):
            lines.append(f"{name} = {value:.9g} {unit}")
            for own, entry in zip(self.variables, row[:_COLUMNS]):
                lines.append(f"  by {own.name} [{own.unit}]: {entry:.9g}")
            if len(row) > _COLUMNS:
                lines.append(f"  and by {len(row) - _COLUMNS} more")
        return "\n".join(lines)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return np.array(self.rows, dtype=dtype)

    def to_pandas(self) -> pandas.DataFrame:
        """A table with a row for each functional and a column for each variable."""
        import pandas

        return pandas.DataFrame(self.rows, index=self.functionals, columns=[own.name for own in self.variables])

    def _repr_html_(self) -> str:
        head = "".join(
            f"<th>{html.escape(own.name)} [{html.escape(own.unit)}]</th>" for own in self.variables[:_COLUMNS]
        )
        more = f"<th>and {len(self.variables) - _COLUMNS} more</th>" if len(self.variables) > _COLUMNS else ""
        rows = "".join(
            f"<tr><td>{html.escape(name)} [{html.escape(unit)}]</td><td>{value:.9g}</td>"
            + "".join(f"<td>{entry:.9g}</td>" for entry in row[:_COLUMNS])
            + "</tr>"
            for name, unit, value, row in zip(self.functionals, self.units, self.values, self.rows)
        )
        return f"<table><tr><th>functional</th><th>value</th>{head}{more}</tr>{rows}</table>"


# variables that a table in a notebook shows
_COLUMNS = 12
