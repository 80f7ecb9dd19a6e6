"""Exceptions: the sentences of the library, which say where, what, how much, and what to try."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

# of what lies between the code of a user and the number that it asks
_BETWEEN = tuple(str(Path(file).parent) for file in (__file__, np.__file__))


class Error(Exception):
    """Anything that costate says."""


class InputError(Error, ValueError):
    """An argument, a design or a scene that makes no sense, found before the first step of a run."""


class SceneError(InputError):
    """What is wrong in a scene, a line for each mistake: file, line, key, value, what is allowed."""


class RecordingError(Error, TypeError):
    """A formula that asks for the value of a number while it is recorded; names the line that does."""


class CheckError(Error, AssertionError):
    """A part whose derivatives disagree with what they are held against."""


class RunError(Error, RuntimeError):
    """A run that cannot go on: where it was, what failed, and what to try."""


class RunWarning(UserWarning):
    """A reason to doubt a run or its gradients: steps that hardly resolve it, a leap, a jump, an unstable
    equilibrium."""


class InternalError(Error, RuntimeError):
    """A mistake of the library itself: please report it."""


def user_level() -> int:
    """How many calls up that code is, as ``warnings.warn`` counts them for the function that asks."""
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_BETWEEN):
        frame, level = frame.f_back, level + 1
    return level


def user_line() -> tuple[str, int]:
    """File and line of the code that called this package, whatever lies between."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_BETWEEN):
        frame = frame.f_back
    return frame.f_code.co_filename, frame.f_lineno
