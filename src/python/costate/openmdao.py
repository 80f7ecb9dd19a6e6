"""Scenes in OpenMDAO: an explicit component whose inputs are design variables and whose outputs are functionals."""

from __future__ import annotations

import re
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import openmdao.api as om

from .scenes import Scene


def _word(name: str) -> str:
    """A name as OpenMDAO allows it."""
    return re.sub(r"\W+", "_", name).strip("_")


def _complex_values(scene: Scene, x: np.ndarray) -> np.ndarray:
    """Values at a design that a complex step has left by a part too small to change them."""
    run = scene._run(x.real)
    return np.asarray(run.values + 1j * (run.complex_step() @ x.imag))


class Component(om.ExplicitComponent):
    """A transient of a scene, with exact total derivatives of its functionals by the discrete adjoint.

    * inputs: the design variables, scalars by their names; outputs: functionals by theirs, letters that OpenMDAO does
      not allow as ``_``
    * ``functionals``: names of those that are wanted; all
    * a scene with scenarios is run in all of them, several at once, and its outputs are ``NAME_SCENARIO``

    Units are those of the scene; they are not declared, as OpenMDAO knows others. Under complex steps, as
    ``check_partials(method="cs")`` takes them of a problem with ``force_alloc_complex``, derivatives are those of runs
    in complex numbers, which know nothing of the adjoint.
    """

    def __init__(self, scene: Scene, functionals: Sequence[str] | None = None, **options: Any) -> None:
        super().__init__(**options)
        self._scene = scene
        runs = scene.scenarios or {"": scene}
        self._runs = [
            (name, own, [f.name for f in own.functionals if functionals is None or f.name in functionals])
            for name, own in runs.items()
        ]

    def setup(self) -> None:
        for own in self._scene.variables:
            self.add_input(_word(own.name), val=own.initial, desc=f"[{own.unit}]")
        for name, scene, wanted in self._runs:
            units = {own.name: own.unit for own in scene.functionals}
            for functional in wanted:
                self.add_output(self._output(functional, name), desc=f"[{units[functional]}]")
        self.declare_partials("*", "*")

    @staticmethod
    def _output(functional: str, scenario: str) -> str:
        return _word(f"{functional} {scenario}")

    def _design(self, inputs: Any) -> np.ndarray:
        return np.array([np.ravel(inputs[_word(own.name)])[0] for own in self._scene.variables])

    def _each(self, work: Any) -> list[Any]:
        if len(self._runs) == 1:
            return [work(self._runs[0])]
        with ThreadPoolExecutor(len(self._runs)) as threads:
            return list(threads.map(work, self._runs))

    def compute(self, inputs: Any, outputs: Any, *_: Any) -> None:
        x = self._design(inputs)
        values_of = _complex_values if np.iscomplexobj(x) else Scene.values
        for (name, scene, wanted), values in zip(self._runs, self._each(lambda run: values_of(run[1], x))):
            for functional, place in zip(wanted, scene._places(wanted)):
                outputs[self._output(functional, name)] = values[place]

    def compute_partials(self, inputs: Any, partials: Any, *_: Any) -> None:
        x = self._design(inputs)
        all_rows = self._each(lambda run: run[1].value_and_grad(x, run[2])[1])
        for (name, _scene, wanted), rows in zip(self._runs, all_rows):
            for functional, row in zip(wanted, rows):
                for variable, entry in zip(self._scene.variables, row):
                    partials[self._output(functional, name), _word(variable.name)] = entry
