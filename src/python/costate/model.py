"""A builder of scenes, made of the description of scene files: every section is a method, every key an argument.

What it builds is the text of a scene file, so that a run gives the same bits as the command line. ``help(Model.body)``
shows the keys with units and meanings; ``model.py`` has no list of them.
"""

from __future__ import annotations

import html
import json
import keyword
import re
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter as Argument
from inspect import Signature
from typing import Any

import numpy as np

from . import description
from .errors import InputError, SceneError, user_line
from .numbers import Formulas, Number, Numbers, argument, literal
from .parts import Constraint, Element, Quantity, describe
from .scenes import Scene


class Model:
    """A scene that is being built.

    Every number may be a float, a formula in a text, or a number that ``variable`` or ``define`` gave, with what Python
    makes of it; a vector is a list of three, or an array. ``scene()`` checks all of it and gives what can be run.
    """

    def __init__(self, name: str = "model", *, gravity: Any = None, summary: str | None = None) -> None:
        self.name = name
        self.summary = summary
        #: Acceleration by weight [m/s2].
        self.gravity = gravity
        self._entries: list[tuple[str, str | None, dict[str, Any], tuple[str, int]]] = []
        self._definitions: dict[str, Any] = {}
        self._defined_at: dict[str, tuple[str, int]] = {}
        self._parts: dict[str, str] = {}

    def variable(
        self, name: str, initial: Any, bounds: Sequence[float], unit: str = "-", *, count: int | None = None
    ) -> Any:
        """A design variable: a number for formulas, or an array of them with ``count`` or several initial values.

        * ``initial``: value of the initial design, or one for each [unit]
        * ``bounds``: least and largest value [unit]
        * ``unit``: for tables and charts
        """
        if not name.isidentifier():
            raise InputError(
                f'a design variable "{name}" cannot be used in formulas: take a name of letters, numbers and _'
            )
        if count is None and np.ndim(initial) == 1:
            count = len(initial)
        self._add("variable", name, {"initial": initial, "bounds": bounds, "unit": unit, "count": count})
        if count is None:
            return argument(name)
        numbers = [argument(f"{name}[{place}]") for place in range(count)]
        return Numbers(numbers)

    def define(self, name: str, value: Any) -> Any:
        """A named number or vector, which formulas know by its name."""
        self._definitions[name] = value
        self._defined_at[name] = user_line()
        if np.ndim(np.array(value, dtype=object)) == 0:
            return argument(name)
        return Numbers([argument(f"{name}.{axis}") for axis in "xyz"])

    def add(self, part: Element | Constraint | Quantity | type, name: str, **keys: Any) -> str:
        """Adds a part of one's own: its nodes by ``on`` or ``between``, its parameters by their names, of a quantity
        ``over``."""
        own = describe(part)
        read = json.loads(own)
        word = read["name"]
        others = (f"{word}_{place}" for place in range(2, len(self._parts) + 3))
        while self._parts.get(word, own) != own:
            # the same class with other options
            word = next(others)
        self._parts[word] = own
        section = {"element": "spring", "constraint": "joint", "quantity": "functional"}[read["kind"]]
        return self._add(section, None, {"name": name, "type": word, **keys})

    def scenario(self, name: str, **changes: Any) -> str:
        """Circumstances in which the scene is run: what is different there, ``settings={"end": 2}, force={"push":
        {"size": 5}}``."""
        return self._add("scenario", None, {"name": name, **changes})

    def _add(self, section: str, name: str | None, keys: dict[str, Any]) -> str:
        own = {_key(argument): value for argument, value in keys.items() if value is not None}
        self._entries.append((section, name, own, user_line()))
        return name if name is not None else str(own.get("name", ""))

    def text(self) -> str:
        """The scene file."""
        return "\n".join(self._lines()[0]) + "\n"

    def _lines(self) -> tuple[list[str], dict[int, tuple[str, int]]]:
        """Lines of the scene file, and where in Python those of an entry come from."""
        top = {"version": 1, "name": self.name, "summary": self.summary, "gravity": self.gravity}
        given = [top, self._definitions, *(own for _, _, own, _ in self._entries)]
        formulas = Formulas(number for own in given for number in _numbers_in(own))
        lines = [f"{key} = {_toml(value, formulas)}" for key, value in top.items() if value is not None]
        # definitions lead from one to the next, whatever they are used by
        named = {**{key: _toml(value, formulas) for key, value in self._definitions.items()}}
        named |= {key: json.dumps(text) for key, text in formulas.definitions.items()}
        places: dict[int, tuple[str, int]] = {}
        if named:
            lines += ["", "[define]"]
            for key, text in named.items():
                lines.append(f"{_toml_key(key)} = {text}")
                if key in self._defined_at:
                    places[len(lines)] = self._defined_at[key]
        shapes = {own.name: own.shape for own in description.sections()} | {"scenario": "listed"}
        for section, name, own, place in self._entries:
            header = f"[[{section}]]" if shapes[section] == "listed" else f"[{section}]"
            if name is not None:
                header = f"[{section}.{_toml_key(name)}]"
            written = _written(section, name, own, place, formulas)
            for line in range(len(lines) + 2, len(lines) + 3 + len(written)):
                places[line] = place
            lines += ["", header, *written]
        return lines, places

    def scene(self) -> Scene:
        """What can be run.

        Raises ``SceneError`` with all mistakes: line of the Python code, key, value, what is allowed.
        """
        lines, places = self._lines()
        text, parts = "\n".join(lines) + "\n", [self._named_part(word, own) for word, own in self._parts.items()]
        return Scene._parsed(f"{self.name}.toml", text, parts, places)

    @staticmethod
    def _named_part(word: str, part: str) -> str:
        own = json.loads(part)
        return part if own["name"] == word else json.dumps({**own, "name": word})

    def __repr__(self) -> str:
        return f"<model {self.name!r} with {len(self._entries)} entries>"

    def _repr_html_(self) -> str:
        counts: dict[str, list[str]] = {}
        for section, name, own, _ in self._entries:
            counts.setdefault(section, []).append(name or str(own.get("name", "")))
        rows = "".join(
            f"<tr><td>{section}</td><td>{len(names)}</td>"
            f"<td>{html.escape(', '.join(filter(None, names[:12])))}</td></tr>"
            for section, names in counts.items()
        )
        head = "<tr><th>section</th><th>entries</th><th>names</th></tr>"
        return f"<b>{html.escape(self.name)}</b><table>{head}{rows}</table>"


class _Section:
    """The types of a section, each a method: ``m.joint.revolute(...)``."""

    def __init__(self, model: Model) -> None:
        self._model = model


def _key(argument: str) -> str:
    """The key that an argument is: ``from`` for ``from_``."""
    return argument[:-1] if argument.endswith("_") and keyword.iskeyword(argument[:-1]) else argument


def _numbers_in(value: Any) -> list[Number]:
    """Numbers of formulas in lists and tables."""
    if isinstance(value, Number):
        return [value]
    if isinstance(value, (np.ndarray, Numbers)):
        return _numbers_in(value.tolist())
    if isinstance(value, Mapping):
        return [own for part in value.values() for own in _numbers_in(part)]
    if isinstance(value, (list, tuple)):
        return [own for part in value for own in _numbers_in(part)]
    return []


def _toml_key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key, ensure_ascii=False)


def _written(
    section: str, name: str | None, own: Mapping[str, Any], place: tuple[str, int], formulas: Formulas
) -> list[str]:
    """Lines of the keys of an entry."""
    lines = []
    for key, value in own.items():
        try:
            lines.append(f"{_toml_key(key)} = {_toml(value, formulas)}")
        except InputError as error:
            file, line = place
            entry = f"[{section}.{name}]" if name is not None else f'[[{section}]] "{own.get("name", "")}"'
            raise SceneError(f"{file}, line {line}: {key} of {entry}: {error}") from None
    return lines


def _toml(value: Any, formulas: Formulas) -> str:
    """A value as a file writes it."""
    if isinstance(value, Number):
        return json.dumps(formulas.text(value))
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return literal(float(value)).strip("()")
    if isinstance(value, (np.ndarray, Numbers)):
        return _toml(value.tolist(), formulas)
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_toml(own, formulas) for own in value)}]"
    if isinstance(value, Mapping):
        inner = (f"{_toml_key(str(key))} = {_toml(own, formulas)}" for key, own in value.items() if own is not None)
        return f"{{ {', '.join(inner)} }}"
    raise InputError(f"{value!r} cannot stand in a scene: give a number, a text, a list, an array or a table")


def _method(section: description.Section, form: description.Form) -> Callable[..., str]:
    """The method that adds an entry, with its signature and its page."""
    is_named = section.shape == "named" or form.has_name

    def add(self: Any, *names: str, **keys: Any) -> str:
        model = self if isinstance(self, Model) else self._model
        if len(names) > is_named:
            raise InputError(
                f"{section.name} takes {'its name' if is_named else 'nothing'} without a key, and all else by keys"
            )
        own: dict[str, Any] = {"type": form.name} if form.name else {}
        if section.shape == "named":
            if not names:
                raise InputError(f"{section.name} needs a name")
            return model._add(section.name, names[0], own | keys)
        own = {"name": names[0], **own} if names else own
        return model._add(section.name, None, own | keys)

    arguments = [Argument("self", Argument.POSITIONAL_ONLY)]
    if is_named:
        arguments.append(Argument("name", Argument.POSITIONAL_ONLY, annotation="str"))
    for key in form.keys:
        if key.name != "name":
            default = Argument.empty if key.is_needed else None
            arguments.append(Argument(key.argument, Argument.KEYWORD_ONLY, default=default, annotation=key.takes))
    add.__signature__ = Signature(arguments, return_annotation="str")  # type: ignore[attr-defined]
    add.__name__ = form.name or section.name
    add.__qualname__ = f"Model.{section.name}.{form.name}" if form.name else f"Model.{section.name}"
    add.__doc__ = description.documentation(section, form)
    return add


def _build() -> None:
    """Gives the builder a method for each section, and for each type of a section that has some."""
    for section in description.sections():
        if section.name == "variable":
            continue
        if len(section.forms) == 1:
            setattr(Model, section.name, _method(section, section.forms[0]))
            continue
        methods = {form.name: _method(section, form) for form in section.forms}
        space = type(f"Model.{section.name}", (_Section,), {**methods, "__doc__": section.doc})
        setattr(Model, section.name, property(space, doc=section.doc))


_build()
