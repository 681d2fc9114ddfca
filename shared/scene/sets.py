"""`--set path.to.key=value`: changes to a scene's data before it is checked."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from typing import Any

from shared.scene.fields import suggest

_PART = re.compile(r'"(?P<quoted>[^"]*)"|\[(?P<index>\d+)\]|(?P<bare>[^.\[\]"]+)')
_NAME = r'(?:"[^"]*"|\s*[^.\[\]"\s][^.\[\]"]*)'
_PATH = re.compile(rf"{_NAME}(?:\.{_NAME}|\.?\[\d+\])*\s*")


def apply_sets(data: dict[str, Any], sets: Sequence[str]) -> list[str]:
    """Carry out `sets` on `data` in place; return the mistakes found.

    A part of the path is a key, the index of a list item, or the item's `name`; "…" quotes a name with dots.
    Tables that are not there yet are made. The value is TOML; a bare word is text.
    """
    mistakes = []
    for text in sets:
        path, equals, value = text.partition("=")
        parts = [_part(m) for m in _PART.finditer(path) if m.group().strip()]
        if not equals or not _PATH.fullmatch(path):
            mistakes.append(f"--set {text}: write path.to.key=value")
            continue
        problem = _assign(data, parts, parse_value(value))
        if problem:
            mistakes.append(f"--set {text}: {problem}")
    return mistakes


def _part(match: re.Match) -> str:
    """A part of a path without what marks its kind; a name in quotes may be empty."""
    kind = match.lastgroup
    return match[kind].strip() if kind == "bare" else match[kind]


def parse_value(text: str) -> Any:
    """A TOML value, or the text itself if it is not just one."""
    try:
        found = tomllib.loads(f"value = {text.strip()}")
    except (ValueError, RecursionError):  # not TOML, a number of thousands of digits, thousands of brackets
        found = {}
    return found["value"] if len(found) == 1 else text.strip()


def _assign(data: dict[str, Any], parts: list[str], value: Any) -> str | None:
    """Put `value` at `parts`; the reason if that cannot be done."""
    place: Any = data
    for depth, part in enumerate(parts):
        if isinstance(place, list):
            part, problem = _item(place, part)
            if problem:
                return problem
        elif not isinstance(place, dict):
            return f"{'.'.join(parts[:depth])} is a value, not a table"
        if depth == len(parts) - 1:
            place[part] = value
        elif isinstance(place, dict):
            place = place.setdefault(part, {})
        else:
            place = place[part]
    return None


def _item(items: list[Any], part: str) -> tuple[int, str | None]:
    """Index of the list item that `part` means, by number or by name."""
    names = [item.get("name", "") if isinstance(item, dict) else "" for item in items]
    if part in names:
        return names.index(part), None
    if part.isdecimal():
        number = int(part)
        return number, None if number < len(items) else f"item {number} of {len(items)}: numbers start at 0"
    return 0, f"no item named '{part}'" + suggest(part, [name for name in names if name])
