"""The vocabulary of a stability map: a TOML file that names a case, two axes, a criterion, and methods to compare.

At every value of x, for every method, the value of y is sought from which on the criterion is broken. A value v of an
axis goes into the scene as factor × v^power under each of the axis's keys. `reference.py` makes
cases/maps/README.md of it.
"""

from __future__ import annotations

import math
from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import Field, ValidationError, model_validator

from coupler.stability.theory import THEORIES
from shared.contract import BadInput
from shared.scene.errors import explain, strict
from shared.scene.fields import suggest
from shared.scene.reading import read_toml, shipped_cases
from shared.schema.base import Name, Positive, Table, key
from shared.schema.probes import Statistic

VOCABULARY = "cases/maps/README.md"


class Scale(Table):
    """A key of the scene that follows an axis."""

    path: str = key(about="path.to.key in the scene")
    factor: float = key(1.0, about="times the value")
    power: float = key(1.0, about="to this power")

    def setting(self, value: float) -> str:
        """The change of the scene for a value of the axis, as after --set."""
        try:
            return f"{self.path}={self.factor * value**self.power!r}"
        except OverflowError:
            return f"{self.path}={math.inf}"  # which no scene takes


class Across(Table):
    """The axis along."""

    name: str = key(about="what the axis shows")
    values: list[Positive] = key(about="values at which a boundary is sought", min_length=1)
    scales: list[Scale] = key(about="keys that follow the axis", min_length=1)


class Upward(Table):
    """The axis on which the boundary is sought."""

    name: str = key(about="what the axis shows")
    range: tuple[Positive, Positive] = key(
        about="where the search begins, on the side where runs are good, and how far it goes; first may be the larger. "
        "Where runs are bad at its beginning already, that is given as the boundary, with a word"
    )
    tolerance: Positive = key(0.01, about="relative width to which the boundary is bracketed")
    values: list[Positive] = key([], about="values that are run besides, to colour the map")
    scales: list[Scale] = key(about="keys that follow the axis", min_length=1)

    @model_validator(mode="after")
    def _wide(self):
        if self.range[0] == self.range[1]:
            raise ValueError(f"range = {list(self.range)}: both ends are the same; nothing can be sought in between")
        return self


class Criterion(Table):
    """What makes a run bad: its measure past `limit`. A run that ends by a diagnosis is bad in any case.

    growth: of the probe's amplitude per row of probes, the probe going as its square (so never negative): at the run's
    end, or up to where it saturated; iterations: of the window that takes most; rise: largest rise of the probe above
    an earlier value of its own, over its largest size; deviation: of the probe's statistic from `value`, or from what
    it is in the run at y = `reference`, relative.
    """

    measure: Literal["growth", "iterations", "rise", "deviation"] = key(about="what is looked at")
    limit: float = key(
        0.0, about="largest measure of a good run; above 0 for rise and deviation, above 1 for iterations"
    )
    probe: Name | None = key(None, about="probe that is looked at; not of iterations")
    statistic: Statistic = key("mean", about="statistic of the probe, of deviation")
    value: float | None = key(None, about="what the statistic should be, of deviation; not 0")
    reference: Positive | None = key(None, about="y of the run whose statistic it should be, of deviation")

    @model_validator(mode="after")
    def _complete(self):
        if (self.probe is None) != (self.measure == "iterations"):
            raise ValueError("a probe belongs to every measure but iterations")
        if ((self.value is None) == (self.reference is None)) == (self.measure == "deviation"):
            raise ValueError("either value or reference belongs to the measure deviation, neither to others")
        if self.value == 0.0:
            raise ValueError("value = 0: nothing is a relative deviation from zero; take another probe or measure")
        least = {"growth": -math.inf, "iterations": 1.0}.get(self.measure, 0.0)
        if self.limit <= least:
            raise ValueError(f"limit = {self.limit:g}: must be above {least:g} for the measure {self.measure}")
        return self


class Method(Table):
    """One of what is compared, a panel of the map."""

    name: str = key(about="what its panel is called")
    sets: list[str] = key([], about="path.to.key=value, as after --set")
    theory: str | None = key(None, about="theory of this method, where it is not the map's; none: no line")


class StabilityMap(Table):
    """A whole map."""

    schema_version: Literal[1] = key(about="version of this vocabulary: 1", alias="schema")
    title: str = key(about="one line")
    description: str = key("", about="what the map shows")
    case: str = key(about="scene file, its path relative to the map's, or name of a shipped case")
    criterion: Criterion = key(about="what is looked for")
    theory: str | None = key(None, about="boundary drawn over the runs: " + ", ".join(THEORIES))
    agreement: Positive | None = key(None, about="how near theory's boundary that of the runs should lie, relative")
    rule: str | None = key(None, about="rule of pre-flight: drawn is where along y it begins to warn")
    sets: list[str] = key([], about="changes of the scene in all runs, as after --set")
    x: Across = key(about="the axis along")
    y: Upward = key(about="the axis on which the boundary is sought")
    methods: list[Method] = Field(min_length=1, description="panels of the map")

    @model_validator(mode="after")
    def _known_theories(self):
        for name in (self.theory, *(method.theory for method in self.methods)):
            if name not in (None, "none", *THEORIES):
                raise ValueError(f"no theory is called {name!r}{suggest(name, THEORIES)}")
        return self

    def theory_of(self, method: Method) -> str | None:
        """Name of the theory drawn over a method's runs."""
        name = method.theory or self.theory
        return None if name == "none" else name


def shipped_maps() -> dict[str, Path]:
    """Name and file of the maps that ship."""
    return {path.stem: path for path in sorted(maps_folder().glob("*.toml"))}


def maps_folder() -> Path:
    """The folder of the maps that ship."""
    return Path(str(files("cases"))) / "maps"


def load_map(name: str) -> StabilityMap:
    """The map of a TOML file or of a shipped map's name, its case beside it. Raises BadInput with every mistake."""
    path = Path(name) if Path(name).is_file() else shipped_maps().get(name)
    if path is None:
        raise BadInput(f"{name}: no such file or shipped map{suggest(name, shipped_maps())}")
    data = read_toml(path)
    try:
        given = strict(StabilityMap, data)
    except ValidationError as error:
        lines = explain(error.errors(), data, StabilityMap)
        count = "1 mistake" if len(lines) == 1 else f"{len(lines)} mistakes"
        raise BadInput("\n  ".join([f"{path}: {count}", *lines]) + f"\n{VOCABULARY} documents every key") from None
    beside = path.resolve().parent / given.case
    named = given.case in shipped_cases() and not beside.is_file()
    return given if named else given.model_copy(update={"case": str(beside)})
