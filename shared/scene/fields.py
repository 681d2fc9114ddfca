"""What the vocabulary says about its own keys: allowed ranges in words, nested tables, keys close to a
misspelt one.

Error messages, the lenient reading of a faulty scene and the key-by-key reference are all made with these.
"""

from __future__ import annotations

import difflib
import types
from collections.abc import Iterable
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from shared.schema.base import Table


def closest(word: str, options: Iterable[str]) -> str | None:
    """The option that `word` is probably a misspelling of."""
    return next(iter(difflib.get_close_matches(word, list(options), n=1, cutoff=0.55)), None)


def suggest(word: str, options: Iterable[str]) -> str:
    """`; did you mean 'x'?` for the option closest to `word`, or else the list of options."""
    options = [option for option in options if option]  # nameless where the name could not be read
    close = closest(word, options)
    if close:
        return f"; did you mean '{close}'?"
    return f"; there is {', '.join(options)}" if options else "; there is none"


def keys_of(table: type[Table]) -> dict[str, FieldInfo]:
    """A table's keys as written in the file."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def table_in(annotation: Any) -> type[Table] | None:
    """The table class that a key holds, alone, optionally or in a list; None for plain values."""
    if isinstance(annotation, type):
        return annotation if issubclass(annotation, Table) else None
    found = (table_in(part) for part in get_args(annotation))
    return next((table for table in found if table is not None), None)


def is_list(annotation: Any) -> bool:
    """Whether a key holds a list of tables."""
    if get_origin(annotation) is list:
        return table_in(annotation) is not None
    return any(is_list(part) for part in get_args(annotation) if part is not type(None))


def allowed(field: FieldInfo) -> str:
    """The values that a key takes, in words."""
    return _allowed(field.annotation, field.metadata)


def _allowed(annotation: Any, metadata: Iterable[Any]) -> str:
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        inner = [m for extra in parts[1:] for m in getattr(extra, "metadata", [extra])]
        return _allowed(parts[0], inner)
    if origin in (Union, types.UnionType):
        return " or ".join(_allowed(part, metadata) for part in parts if part is not type(None))
    if origin is Literal:
        return " or ".join(f'"{part}"' if isinstance(part, str) else str(part) for part in parts)
    if origin is tuple:
        return _NUMBERS[len(parts)] + _allowed(parts[0], []).removeprefix("number")
    if origin is list:
        least = next((m.min_length for m in metadata if hasattr(m, "min_length")), 0)
        return f"list of {_allowed(parts[0], [])}" + (f", at least {least}" if least else "")
    if origin is dict:
        return "table"
    if table_in(annotation):
        return "{ " + ", ".join(keys_of(annotation)) + " }"
    if annotation is bool:
        return "true or false"
    if annotation is str:
        named = any(hasattr(m, "pattern") for m in metadata)
        return "a letter, then up to 99 letters, digits, _ or -" if named else "text"
    return _range("whole number" if annotation is int else "number", metadata)


_NUMBERS = {2: "two numbers", 3: "three numbers", 4: "four numbers"}


def _range(kind: str, metadata: Iterable[Any]) -> str:
    signs = (("gt", ">"), ("ge", "≥"), ("lt", "<"), ("le", "≤"))
    limits = [f"{sign} {getattr(m, name):g}" for m in metadata for name, sign in signs if hasattr(m, name)]
    return " ".join([kind, " and ".join(limits)]).strip()
