"""What scene files know, read off the JSON schema that the library makes of the tables of its reader."""

from __future__ import annotations

import json
import keyword
from dataclasses import dataclass
from functools import cache
from typing import Any

from . import _costate


@dataclass(frozen=True)
class Key:
    """A key of an entry."""

    name: str
    #: What Python takes for it, as a type.
    takes: str
    #: The same in words.
    words: str
    is_needed: bool
    #: What it is, what it is without being given, and its unit.
    doc: str

    @property
    def argument(self) -> str:
        """As Python spells it: ``from_`` for ``from``."""
        return f"{self.name}_" if keyword.iskeyword(self.name) else self.name


@dataclass(frozen=True)
class Form:
    """One of the types of an entry; the only one has no name."""

    name: str
    doc: str
    keys: tuple[Key, ...]

    @property
    def has_name(self) -> bool:
        """Whether others refer to its entries by a name."""
        return any(key.name == "name" for key in self.keys)


@dataclass(frozen=True)
class Section:
    """A section of a file: entries of a list, by their names, or one alone."""

    name: str
    shape: str
    doc: str
    forms: tuple[Form, ...]


#: Tables of the top level that the builder has other ways for.
_BY_HAND = ("version", "name", "summary", "gravity", "define", "scenario")


@cache
def sections() -> tuple[Section, ...]:
    """All sections."""
    schema = json.loads(_costate.schema())
    # a whole file, and not what changes another
    properties = schema["oneOf"][0]["properties"]
    return tuple(
        _section(name, own, schema["$defs"]) for name, own in properties.items() if name not in _BY_HAND
    )


def _section(name: str, own: dict[str, Any], tables: dict[str, Any]) -> Section:
    if own.get("type") == "array":
        shape, entry = "listed", own["items"]
    elif isinstance(own.get("additionalProperties"), dict):
        shape, entry = "named", own["additionalProperties"]
    else:
        shape, entry = "once", own
    forms = tuple(_form(form, tables) for form in entry.get("oneOf", [entry]))
    return Section(name, shape, own.get("description", ""), forms)


def _form(own: dict[str, Any], tables: dict[str, Any]) -> Form:
    properties = own["properties"]
    kind = properties.get("type", {})
    keys = tuple(
        Key(name, *_type(key, tables), name in own.get("required", ()), key.get("description", ""))
        for name, key in properties.items()
        if name != "for" and "const" not in key
    )
    return Form(kind.get("const", ""), kind.get("description", ""), keys)


def _type(own: dict[str, Any], tables: dict[str, Any]) -> tuple[str, str]:
    """What Python takes, as a type and in words."""
    if "$ref" in own:
        name = own["$ref"].rsplit("/", 1)[1]
        known = {"formula": ("Scalar", "number or formula"), "vector": ("Vector", "vector")}
        return known.get(name) or ("Table", f"table {_choices(name, tables)}")
    if "enum" in own:
        return f"Literal[{', '.join(map(repr, own['enum']))}]", " or ".join(f'"{word}"' for word in own["enum"])
    if "anyOf" in own:
        parts = [_type(part, tables) for part in own["anyOf"]]
        types, each = dict.fromkeys(part[0] for part in parts), dict.fromkeys(part[1] for part in parts)
        if set(types) == {"float", "str"}:
            return "Scalar", "number or formula"
        if set(types) == {"int", "str"}:
            return "int | str", "whole number"
        return " | ".join(types), ", or ".join(each)
    match own.get("type"):
        case "number":
            return "float", "number"
        case "integer":
            return "int", "whole number"
        case "boolean":
            return "bool", "True or False"
        case "string":
            return "str", "text"
        case "array":
            inner, words = _type(own["items"], tables)
            least, most = own.get("minItems", 0), own.get("maxItems")
            count = f"{least} times " if least == most else ""
            return f"Sequence[{inner}]", f"list of {count}{words}"
        case "object":
            return "Table", "table"
    return "Any", "anything"


def _choices(name: str, tables: dict[str, Any]) -> str:
    """What a table is, with its types or keys."""
    own = tables[name]
    forms = own.get("oneOf", [own])
    words = [form["properties"].get("type", {}).get("const") for form in forms]
    return f"{name} of type {', '.join(words)}" if all(words) else f"{name} with {', '.join(own.get('properties', {}))}"


def documentation(section: Section, form: Form) -> str:
    """The page of an entry: its sentence, and a line for each key."""
    sentence = form.doc[:1].upper() + form.doc[1:] if form.doc else section.doc
    lines = [sentence if sentence.endswith(".") else f"{sentence}.", ""]
    if form.doc:
        lines = [lines[0], section.doc, ""]
    for key in form.keys:
        needed = "" if key.is_needed else ", optional"
        lines.append(f"* ``{key.argument}`` ({key.words}{needed}): {key.doc}")
    return "\n".join(lines)
