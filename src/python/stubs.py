"""Writes ``costate/model.pyi``, the signatures of the builder, from the description of scene files: ``python
stubs.py``."""

from pathlib import Path

from costate import description

FILE = Path(__file__).parent / "costate" / "model.pyi"

HEAD = '''# written by stubs.py from the description of scene files
# ruff: noqa
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from .numbers import Number
from .parts import Constraint, Element, Quantity
from .scenes import Scene

Scalar: TypeAlias = float | str | Number
Vector: TypeAlias = str | Sequence[Scalar] | np.ndarray[Any, Any]
Table: TypeAlias = Mapping[str, Any]

class Model:
    """A scene that is being built."""

    name: str
    summary: str | None
    gravity: Vector | None
    def __init__(self, name: str = "model", *, gravity: Vector | None = None, summary: str | None = None) -> None: ...
    def variable(
        self, name: str, initial: Any, bounds: Sequence[float], unit: str = "-", *, count: int | None = None
    ) -> Any:
        """A design variable: a number for formulas, or an array of them with ``count`` or several initial values."""
    def define(self, name: str, value: Any) -> Any:
        """A named number or vector, which formulas know by its name."""
    def add(
        self,
        part: Element | Constraint | Quantity | type[Element] | type[Constraint] | type[Quantity],
        name: str,
        **keys: Any,
    ) -> str:
        """Adds a part of one's own: its nodes by ``on`` or ``between``, its parameters by their names."""
    def scenario(self, name: str, **changes: Any) -> str:
        """Circumstances in which the scene is run: what is different there."""
    def text(self) -> str:
        """The scene file."""
    def scene(self) -> Scene:
        """What can be run."""
    def _repr_html_(self) -> str: ...
'''


def method(section: description.Section, form: description.Form) -> str:
    """The signature of the method that adds an entry, with its page."""
    arguments = ["self"]
    if section.shape == "named" or form.has_name:
        arguments += ["name: str", "/"]
    keys = [key for key in form.keys if key.name != "name"]
    if keys:
        arguments.append("*")
    arguments += [
        f"{key.argument}: {key.takes}" if key.is_needed else f"{key.argument}: {key.takes} | None = None"
        for key in keys
    ]
    lines = "".join(f"        {argument},\n" for argument in arguments)
    page = description.documentation(section, form).replace("\\", "\\\\").replace("\n", "\n        ")
    page = "\n".join(line.rstrip() for line in page.split("\n"))
    return f'    def {form.name or section.name}(\n{lines}    ) -> str:\n        """{page}\n        """\n'


def text() -> str:
    """All of the file."""
    model, classes = [HEAD], []
    for section in description.sections():
        if section.name == "variable":
            continue
        if len(section.forms) == 1:
            model.append(method(section, section.forms[0]))
            continue
        name = "_" + "".join(word.capitalize() for word in section.name.split("_"))
        model.append(f'    @property\n    def {section.name}(self) -> {name}:\n        """{section.doc}"""\n')
        classes.append(
            f'\nclass {name}:\n    """{section.doc}"""\n\n' + "".join(method(section, own) for own in section.forms)
        )
    return "".join(model + classes)


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
