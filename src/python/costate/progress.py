"""How far a run is, in a terminal or below a cell of a notebook."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO, TypeAlias

import numpy as np

#: Whether a bar is shown, where ``None`` is: in a terminal or notebook; or a function of the time that is reached and
#: the end of the run.
Progress: TypeAlias = bool | Callable[[float, float], object] | None

# a run that is done sooner needs no bar [s]
_PATIENCE = 1.0
_WIDTH = 30


class Bar:
    """A line of text that is written over itself."""

    def __init__(self, name: str, end: float, patience: float, stream: TextIO) -> None:
        self._name, self._end, self._patience, self._stream = name, end, patience, stream
        self._begun = time.monotonic()
        self._written = 0

    def __call__(self, t: float) -> None:
        """Shows that a time is reached."""
        elapsed = time.monotonic() - self._begun
        if elapsed < self._patience or not t > 0.0:
            return
        share = min(1.0, t / self._end)
        marks = int(_WIDTH * share)
        left = elapsed * (1.0 - share) / share if share > 0.0 else float("inf")
        bar = "#" * marks + "." * (_WIDTH - marks)
        self._write(f"{self._name} [{bar}] {100.0 * share:.0f} %, t = {t:.4g}, {left:.0f} s left")

    def close(self) -> None:
        """Wipes the line."""
        if self._written:
            self._write("")
            print("\r", end="", file=self._stream, flush=True)

    def _write(self, text: str) -> None:
        print(f"\r{text:<{self._written}}", end="", file=self._stream, flush=True)
        self._written = max(self._written, len(text))


def told(progress: Progress, name: str, end: float) -> Callable[[float], object] | None:
    """What a run calls with the time that it has reached; ``None`` where nobody wants to know."""
    if callable(progress):
        tell = progress
        return lambda t: tell(t, end)
    if progress is not None and not isinstance(progress, (bool, np.bool_)):
        raise TypeError(f"progress is {progress!r}: True, False or a function of time and end is wanted")
    is_notebook = _is_notebook()
    if progress or (progress is None and (is_notebook or (sys.stderr is not None and sys.stderr.isatty()))):
        # notebooks show the error stream as a failure
        stream = sys.stdout if is_notebook else sys.stderr
        return Bar(name, end, 0.0 if progress else _PATIENCE, stream)
    return None


def _is_notebook() -> bool:
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and hasattr(shell, "kernel")
