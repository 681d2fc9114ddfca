"""From a faulty scene (or another file of such tables) to sentences: one line per mistake, with path, offending value,
allowed range and a way out.

A scene that breaks the vocabulary is also read leniently, so that the checks between its tables can report in
the same go.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from typing import Annotated, Any

from pydantic import TypeAdapter, ValidationError

from shared.scene.fields import allowed, closest, is_list, keys_of, suggest, table_in
from shared.schema.base import Table
from shared.schema.geometry import SHAPE_KINDS, Shape
from shared.schema.scene import Scene

_QUOTED = re.compile('"([^"]+)"')
_LONGEST_VALUE = 60  # characters of an offending value that are shown


def validate(data: dict[str, Any]) -> tuple[Scene, list[str]]:
    """The scene in `data`, and all its breaches of the vocabulary. With any, the scene is the lenient
    reading.
    """
    try:
        return strict(Scene, data), []
    except ValidationError as error:
        return lenient(Scene, data), explain(error.errors(), data, Scene)


def explain(errors: Iterable[dict[str, Any]], data: dict[str, Any], root: type[Table]) -> list[str]:
    """pydantic's `errors` about `data`, a file whose table is `root`, in this project's words, each path once.

    A key that is missing because it is misspelt is one mistake, not two.
    """
    errors = [error for error in errors if not _other_member(error, data, root)]
    misspelt = {_meant(error, root) for error in errors if error["type"] == "extra_forbidden"}
    messages: dict[str, str] = {}
    for error in errors:
        if error["type"] != "missing" or error["loc"] not in misspelt:
            path, message = _explain_one(error, data, root)
            messages.setdefault(path, message)
    return [f"{path}{message}".removeprefix(": ") for path, message in messages.items()]


def lenient(table: type[Table], data: Any) -> Table:
    """What can be understood of `data`: keys that are missing or wrong are None or their default.

    A shape that is wrong in any way has none of its kinds; the checks pass over it.
    """
    try:
        return strict(table, data)
    except ValidationError as error:
        wrong = {mistake["loc"][0] for mistake in error.errors() if mistake["loc"]}
    values = {}
    for (written, field), name in zip(keys_of(table).items(), table.model_fields, strict=True):
        inner, raw = table_in(field.annotation), data.get(written) if isinstance(data, dict) else None
        default = None if field.is_required() else field.get_default(call_default_factory=True)
        if issubclass(table, Shape) and name in SHAPE_KINDS:
            values[name] = None
        elif is_list(field.annotation):
            values[name] = [lenient(inner, entry) for entry in raw] if isinstance(raw, list) else default or []
        elif inner and isinstance(raw, dict):
            values[name] = lenient(inner, raw)
        elif field.annotation is str and isinstance(raw, str):
            values[name] = raw
        else:
            values[name] = default if raw is None or written in wrong else _value_or(default, field, raw)
    return table.model_construct(**values)


def show_path(parts: Sequence[str | int]) -> str:
    """`solid.bodies[0].name` for ("solid", "bodies", 0, "name")."""
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text


def show(value: Any) -> str:
    """A value in short."""
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 1] + "…"


def strict(table: type[Table], data: Any) -> Any:
    """Validation without guesses: no text for numbers, no numbers for booleans (but whole numbers are
    numbers).
    """
    return table.model_validate_json(json.dumps(data, default=str), strict=True)


def _value_or(default: Any, field: Any, raw: Any) -> Any:
    adapter = TypeAdapter(Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation)
    try:
        return adapter.validate_json(json.dumps(raw, default=str), strict=True)
    except ValidationError:
        return default


def _other_member(error: dict[str, Any], data: dict[str, Any], root: type[Table]) -> bool:
    """Whether a table was given and pydantic also tells why it is not the word that could stand there instead."""
    parts, _, field = _locate(error["loc"], root)
    table_allowed = field is not None and table_in(field.annotation) is not None
    return error["type"] == "literal_error" and table_allowed and isinstance(_look_up(data, parts), dict)


def _meant(error: dict[str, Any], root: type[Table]) -> tuple[str | int, ...]:
    """Location of the key that an unknown one was probably meant to be."""
    parts, table, _ = _locate(error["loc"], root)
    return (*error["loc"][:-1], closest(str(parts[-1]), keys_of(table)) or "")


def _explain_one(error: dict[str, Any], data: Any, root: type[Table]) -> tuple[str, str]:
    parts, table, field = _locate(error["loc"], root)
    path = show_path(parts)
    kind = error["type"]
    if kind == "extra_forbidden":
        return path, ": unknown key" + suggest(str(parts[-1]), keys_of(table))
    if kind == "missing" and parts[-1] == error["loc"][-1]:
        return path, f": missing; {field.description} ({_with_unit(field)})"
    value = _look_up(data, parts)
    if kind == "value_error":
        message = error["msg"].removeprefix("Value error, ")
        return path, f": {message}" if isinstance(value, dict) else f" = {show(value)}: {message}"
    if field is not None and is_list(field.annotation) and isinstance(value, dict):
        return path, f": must be a list of tables; write [[{path}]]"
    if field is None:
        return path, f" = {show(value)}: must be a table with {', '.join(keys_of(table))}"
    choice = closest(value, _QUOTED.findall(allowed(field))) if isinstance(value, str) else None
    hint = f"; did you mean '{choice}'?" if choice else ""
    return path, f" = {show(value)}: must be {_with_unit(field)}{hint}"


def _with_unit(field: Any) -> str:
    unit = (field.json_schema_extra or {}).get("unit", "")
    article = "a " if allowed(field).startswith(("number", "whole", "list", "table")) else ""
    return article + allowed(field) + (f" [{unit}]" if unit not in ("", "-") else "")


def _locate(loc: Sequence[str | int], root: type[Table]) -> tuple[list[str | int], type[Table], Any]:
    """Path in the file, table and field (None: the table itself) of pydantic's location.

    Parts that are not in the file, like the name of a union's member, and places within a plain value are
    left off.
    """
    parts: list[str | int] = []
    table = root
    field = None
    for depth, part in enumerate(loc):
        if isinstance(part, int):
            if field is None or not is_list(field.annotation):
                break
            parts.append(part)
            table, field = table_in(field.annotation), None
            continue
        if field is not None:
            inner = table_in(field.annotation)
            if inner is None or is_list(field.annotation):
                break
            if part == inner.__name__:
                if depth == len(loc) - 1:
                    break
                table, field = inner, None
                continue
            if "[" in part:
                break
            table = inner
        field = keys_of(table).get(part)
        parts.append(part)
        if field is None:
            break
    return parts, table, field


def _look_up(data: Any, parts: Sequence[str | int]) -> Any:
    for part in parts:
        try:
            data = data[part]
        except (KeyError, IndexError, TypeError):
            return None
    return data
