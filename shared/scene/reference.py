"""The key-by-key part of `cases/SCENE.md`, made from the vocabulary.

`python -m shared.scene.reference` rewrites it; what stands above the marker line is written by hand and kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

from shared.scene.fields import allowed, is_list, keys_of, table_in
from shared.schema.base import Table
from shared.schema.geometry import Shape
from shared.schema.scene import Scene

MARKER = "<!-- Below: made from the vocabulary by `python -m shared.scene.reference` -->"


def reference_file() -> Path:
    """The file that holds the reference."""
    return Path(str(files("cases"))) / "SCENE.md"


def render(text: str, marker: str = MARKER, top: type[Table] = Scene) -> str:
    """`text` of the file with everything below the marker renewed; `top`: the table that is the whole file."""
    by_hand = text.split(marker)[0]
    return by_hand + marker + "\n\n" + "\n".join(_sections(top)) + "\n"


def _sections(top: type[Table]) -> Iterator[str]:
    seen: set[type[Table]] = set()
    waiting: list[tuple[str, type[Table]]] = [("Top of the file", top)]
    while waiting:
        title, table = waiting.pop(0)
        if table in seen:
            continue
        seen.add(table)
        yield from _section(title, table, table is top)
        prefix = "" if table is top else title.strip("`[]") + "."
        keys: dict[type[Table], list[str]] = {}
        for key, field in keys_of(table).items():
            inner = table_in(field.annotation)
            if inner is not None and inner not in seen:
                keys.setdefault(inner, []).append(_title(prefix, key, field, issubclass(table, Shape)))
        waiting = [(", ".join(titles), inner) for inner, titles in keys.items()] + waiting


def _title(prefix: str, key: str, field: Any, of_shape: bool) -> str:
    """A table's heading as in the file; parts of a shape stand in braces, wherever the shape is."""
    if of_shape:
        return f"`{key}` of a shape"
    return f"`[[{prefix}{key}]]`" if is_list(field.annotation) else f"`[{prefix}{key}]`"


def _section(title: str, table: type[Table], whole: bool) -> Iterator[str]:
    yield f"## {title}"
    yield ""
    if not whole and table.__doc__ and table.__doc__ != Table.__doc__:
        yield " ".join(table.__doc__.split())
        yield ""
    yield "| key | unit | default | values | meaning |"
    yield "|---|---|---|---|---|"
    for key, field in keys_of(table).items():
        unit = (field.json_schema_extra or {}).get("unit", "")
        yield f"| `{key}` | {unit} | {_default(field)} | {_values(field)} | {field.description} |".replace("  ", " ")
    yield ""


def _values(field: Any) -> str:
    inner = table_in(field.annotation)
    if inner is None:
        return allowed(field)
    return (
        "tables, see there"
        if is_list(field.annotation)
        else "table" + (' or "auto"' if "auto" in allowed(field) else "")
    )


def _default(field: Any) -> str:
    if field.is_required():
        return "**required**"
    default = field.get_default(call_default_factory=True)
    if default is None:
        return "absent"
    if isinstance(default, Table):
        return "all defaults"
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, tuple):
        return str(list(default))
    return f'"{default}"' if isinstance(default, str) else f"{default}"


if __name__ == "__main__":
    path = reference_file()
    path.write_text(render(path.read_text(encoding="utf-8")), encoding="utf-8")
