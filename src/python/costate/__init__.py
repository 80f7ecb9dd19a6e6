"""Flexible multibody dynamics with exact gradients.

A mechanism is a function of its design variables: ``load`` reads it from a scene file, ``Model`` and ``scene`` build it
in Python. ``Scene.run`` simulates it, ``Scene.value_and_grad`` differentiates what it measures, exactly. ``Element``,
``Constraint`` and ``Quantity`` are parts of one's own, each one formula.
"""

from . import errors, testing
from ._costate import __version__
from .errors import CheckError, Error, InputError, InternalError, RecordingError, RunError, RunWarning, SceneError
from .model import Model
from .numbers import floor, g_times, less, maximum, minimum, rotate, rotate_back, rotation, sign, where
from .parts import Constraint, Element, Field, Parameter, Quantity, State, non_negative, number, point, positive
from .results import Fitted, FittedCurve, Gradient, History, JointHistory, Mode, NodeHistory, Report, Run
from .scene_function import Variable, scene, variable
from .scenes import DesignVariable, Functional, Scene, built_in, built_in_names, load, loads, value_and_grad

__all__ = [
    "CheckError",
    "Constraint",
    "DesignVariable",
    "Element",
    "Error",
    "Field",
    "Fitted",
    "FittedCurve",
    "Functional",
    "Gradient",
    "History",
    "InputError",
    "InternalError",
    "JointHistory",
    "Mode",
    "Model",
    "NodeHistory",
    "Parameter",
    "Quantity",
    "RecordingError",
    "Report",
    "Run",
    "RunError",
    "RunWarning",
    "Scene",
    "SceneError",
    "State",
    "Variable",
    "__version__",
    "built_in",
    "built_in_names",
    "errors",
    "floor",
    "g_times",
    "less",
    "load",
    "loads",
    "maximum",
    "minimum",
    "non_negative",
    "number",
    "point",
    "positive",
    "rotate",
    "rotate_back",
    "rotation",
    "scene",
    "sign",
    "testing",
    "value_and_grad",
    "variable",
    "where",
]
