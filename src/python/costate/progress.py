"""How far a run is, on the error stream of a terminal or below a cell of a notebook."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TypeAlias

#: Whether a bar is shown, where ``None`` is: in a terminal or notebook; or a function of the time that is reached and
#: the end of the run.
Progress: TypeAlias = bool | Callable[[float, float], object] | None

# a run that is done sooner needs no bar [s]
_PATIENCE = 1.0
_WIDTH = 30


class Bar:
    """A line of text that is written over itself."""

    def __init__(self, name: str, end: float, patience: float) -> None:
        self._name, self._end, self._patience = name, end, patience
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
            print("\r", end="", file=sys.stderr, flush=True)

    def _write(self, text: str) -> None:
        print(f"\r{text:<{self._written}}", end="", file=sys.stderr, flush=True)
        self._written = max(self._written, len(text))


def told(progress: Progress, name: str, end: float) -> Callable[[float], object] | None:
    """What a run calls with the time that it has reached; ``None`` where nobody wants to know."""
    if callable(progress):
        tell = progress
        return lambda t: tell(t, end)
    if progress or (progress is None and _is_watched()):
        return Bar(name, end, 0.0 if progress else _PATIENCE)
    return None


def _is_watched() -> bool:
    """Whether a person sees the error stream: in a terminal, or in a notebook."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return sys.stderr.isatty() or (shell is not None and hasattr(shell, "kernel"))
