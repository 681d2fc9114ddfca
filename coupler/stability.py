"""`coupler stability`: boundaries found by runs, with theory's line over them."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from coupler.stability_map import Method, StabilityMap
from coupler.stability_picture import draw_map
from coupler.stability_runs import boundary, cell_scene, measure
from coupler.stability_theory import THEORIES

COLUMNS = ("method", "x", "boundary", "theory", "difference", "runs")


@dataclass(frozen=True)
class Boundary:
    """Where runs of a `method` at `x` begin to be bad: by runs, and by theory (None: not known, or never).

    `tried`: y and measure of every run.
    """

    method: str
    x: float
    found: float | None
    theory: float | None
    tried: tuple[tuple[float, float], ...]

    @property
    def difference(self) -> float | None:
        """(found − theory)/theory."""
        return None if self.found is None or self.theory is None else self.found / self.theory - 1.0


def find_boundaries(stability: StabilityMap, say: Callable[[str], None]) -> list[Boundary]:
    """All boundaries of a map, by runs."""
    found = []
    for method in stability.methods:
        for x in stability.x.values:
            one = _boundary(stability, method, x)
            where = "none" if one.found is None else f"{one.found:.4g}"
            beside = "" if one.theory is None else f", theory {one.theory:.4g}"
            say(f"{method.name}, {stability.x.name} = {x:.4g}: {where}{beside} ({len(one.tried)} runs)")
            found.append(one)
    return found


def _boundary(stability: StabilityMap, method: Method, x: float) -> Boundary:
    tried: dict[float, float] = {}

    def bad(y: float) -> bool:
        if y not in tried:
            tried[y] = measure(cell_scene(stability, method, x, y), stability.criterion)
        return not tried[y] <= stability.criterion.limit

    found = boundary(bad, *stability.y.range, stability.y.tolerance)
    for y in stability.y.values:
        bad(y)
    return Boundary(method.name, x, found, _theory(stability, method, x), tuple(sorted(tried.items())))


def _theory(stability: StabilityMap, method: Method, x: float) -> float | None:
    name = stability.theory_of(method)
    return None if name is None else THEORIES[name](cell_scene(stability, method, x, stability.y.range[0]), x)


def write_map(stability: StabilityMap, found: list[Boundary], folder: Path) -> list[Path]:
    """Write map.csv (boundaries), cells.csv (every run) and map.png into `folder`; their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / name for name in ("map.csv", "cells.csv", "map.png")]
    with paths[0].open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for b in found:
            numbers = ("" if v is None else f"{v:.5g}" for v in (b.x, b.found, b.theory, b.difference))
            writer.writerow([b.method, *numbers, len(b.tried)])
    with paths[1].open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("method", "x", "y", stability.criterion.measure))
        writer.writerows((b.method, f"{b.x:.5g}", f"{y:.5g}", f"{value:.4g}") for b in found for y, value in b.tried)
    draw_map(stability, found, paths[2])
    return paths
