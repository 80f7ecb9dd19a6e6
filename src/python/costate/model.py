"""A builder of scenes, made of the description of scene files: every section is a method, every key an argument.

What it builds are the entries of a scene file, so that a run gives the same bits as the command line.
``help(Model.body)`` shows the keys with units and meanings; ``model.py`` has no list of them.
"""

from __future__ import annotations

import html
import json
import keyword
import math
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter as Argument
from inspect import Signature
from typing import Any

import numpy as np

from . import _costate, description
from .errors import InputError, SceneError, user_line
from .numbers import Formulas, Number, Numbers, argument
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
        return _costate.Scene.written(self._entries_with_places())

    def _entries_with_places(self) -> str:
        """All entries in JSON; the key "" of each says where in Python it comes from, by its number in a list of places."""
        top = {"version": 1, "name": self.name, "summary": self.summary, "gravity": self.gravity}
        formulas = Formulas(
            number
            for own in [top, self._definitions, *(own for _, _, own, _ in self._entries)]
            for number in _numbers_in(own)
        )
        places = [f"{self.name}.toml"]

        def placed(what: str, keys: Mapping[str, Any], place: tuple[str, int]) -> dict[str, Any]:
            places.append("{}, line {}".format(*place))
            own: dict[str, Any] = {"": len(places) - 1}
            for key, value in keys.items():
                try:
                    own[key] = _plain(value, formulas)
                except InputError as error:
                    raise SceneError(f"{places[-1]}: {key} of {what}: {error}") from None
            return own

        entries: dict[str, Any] = {key: _plain(value, formulas) for key, value in top.items() if value is not None}
        named = {key: placed("[define]", {"=": own}, self._defined_at[key]) for key, own in self._definitions.items()}
        # definitions lead from one to the next, whatever they are used by
        if define := named | formulas.definitions:
            entries["define"] = define
        shapes = {own.name: own.shape for own in description.sections()} | {"scenario": "listed"}
        for section, name, own, place in self._entries:
            if shapes[section] == "listed":
                what, into, key = f'[[{section}]] "{own.get("name", "")}"', entries.setdefault(section, []), None
            else:
                what = f"[{section}]" if name is None else f"[{section}.{name}]"
                into, key = (entries, section) if name is None else (entries.setdefault(section, {}), name)
            made = placed(what, own, place)
            if key is None:
                into.append(made)
            elif key in into:
                raise SceneError(f"{places[-1]}: there is {what} already")
            else:
                into[key] = made
        return json.dumps({"": places, **entries}, ensure_ascii=False)

    def scene(self) -> Scene:
        """What can be run.

        Raises ``SceneError`` with all mistakes: line of the Python code, key, value, what is allowed.
        """
        parts = [self._named_part(word, own) for word, own in self._parts.items()]
        return Scene._built(f"{self.name}.toml", self._entries_with_places(), parts)

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


def _plain(value: Any, formulas: Formulas) -> Any:
    """A value as a file has it."""
    if isinstance(value, Number):
        return formulas.text(value)
    if isinstance(value, (np.ndarray, np.generic, Numbers)):
        return _plain(value.tolist(), formulas)
    if isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise InputError(f"{value} is no finite number")
        return value
    if isinstance(value, (list, tuple)):
        return [_plain(own, formulas) for own in value]
    if isinstance(value, Mapping):
        return {str(key): _plain(own, formulas) for key, own in value.items() if own is not None}
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
