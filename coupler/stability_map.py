"""The vocabulary of a stability map: a TOML file that names a case, two axes, and methods to compare.

At every value of x, for every method, the value of y is sought at which runs begin to grow. A value v of an axis goes
into the scene as factor × v^power under each of the axis's keys.
"""

from __future__ import annotations

import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import ValidationError

from shared.contract import BadInput
from shared.scene_fields import suggest
from shared.schema import Name, Positive, Table, key


class Scale(Table):
    path: str = key(about="path.to.key in the scene")
    factor: float = key(1.0, about="times the value")
    power: float = key(1.0, about="to this power")

    def setting(self, value: float) -> str:
        """The change of the scene for a value of the axis, as after --set."""
        return f"{self.path}={self.factor * value**self.power!r}"


class Across(Table):
    name: str = key(about="what the axis shows")
    values: list[Positive] = key(about="values at which a boundary is sought", min_length=1)
    scales: list[Scale] = key(about="keys that follow the axis", min_length=1)


class Upward(Table):
    name: str = key(about="what the axis shows")
    range: tuple[Positive, Positive] = key(about="least and largest value tried")
    tolerance: Positive = key(0.01, about="relative width to which the boundary is bracketed")
    scales: list[Scale] = key(about="keys that follow the axis", min_length=1)


class Method(Table):
    name: str = key(about="what the line is called")
    sets: list[str] = key([], about="path.to.key=value, as after --set")


class StabilityMap(Table):
    """A whole map."""

    schema_version: Literal[1] = key(about="version of this vocabulary: 1", alias="schema")
    title: str = key(about="one line")
    description: str = key("", about="what the map shows")
    case: str = key(about="scene file, or name of a shipped case")
    probe: Name = key(about="probe that must not grow; one that is never negative")
    theory: Literal["lagged-column"] | None = key(None, about="boundary drawn over the runs")
    sets: list[str] = key([], about="changes of the scene in all runs, as after --set")
    x: Across = key(about="the axis along")
    y: Upward = key(about="the axis on which the boundary is sought")
    methods: list[Method] = key(about="lines of the map", min_length=1)


def shipped_maps() -> dict[str, Path]:
    """Name and file of the maps that ship."""
    return {path.stem: path for path in sorted((Path(str(files("cases"))) / "maps").glob("*.toml"))}


def load_map(name: str) -> StabilityMap:
    """The map of a TOML file or of a shipped map's name. Raises BadInput with every mistake."""
    path = Path(name) if Path(name).is_file() else shipped_maps().get(name)
    if path is None:
        raise BadInput(f"{name}: no such file or shipped map{suggest(name, shipped_maps())}")
    try:
        return StabilityMap.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except tomllib.TOMLDecodeError as error:
        raise BadInput(f"{path}: not TOML: {error}") from None
    except ValidationError as error:
        lines = (f"  {'.'.join(map(str, e['loc']))} = {e['input']!r}: {e['msg']}" for e in error.errors())
        raise BadInput(f"{path}: {error.error_count()} mistakes\n" + "\n".join(lines)) from None
