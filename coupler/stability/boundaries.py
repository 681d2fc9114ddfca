"""`coupler stability`: boundaries found by runs, with theory's line and pre-flight's over them."""

from __future__ import annotations

import csv
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from coupler.preflight.measures.numbers import scene_numbers
from coupler.preflight.rules.findings import findings
from coupler.stability.check import check_map
from coupler.stability.kept import Remembered, remembered
from coupler.stability.map import Method, StabilityMap
from coupler.stability.runs import FAILED, NOTHING, boundary, cell_scene, measure, with_reference
from coupler.stability.theory import THEORIES
from shared.contract import BadInput
from shared.run.results import output_folder
from shared.schema.scene import Scene

_RULE_TOLERANCE = 1e-3  # to which the y is sought where pre-flight begins to warn


@dataclass(frozen=True)
class Boundary:
    """Where runs of a `method` at `x` begin to be bad: by runs, by theory, and by pre-flight's rule (None: not known,
    or nowhere on the axis).

    `tried`: y and measure of every run.
    """

    method: str
    x: float
    found: float | None
    theory: float | None
    warned: float | None
    tried: tuple[tuple[float, float], ...]

    @property
    def ratio(self) -> float | None:
        """found over theory."""
        return None if self.found is None or self.theory is None else self.found / self.theory


def find_boundaries(stability: StabilityMap, folder: Path, say: Callable[[str], None]) -> list[Boundary]:
    """All boundaries of a map, by runs; says each, and at last how well they agree with theory. What has been run is
    kept in `folder`, and not run again. Raises BadInput, where it can before the first run."""
    check_map(stability)
    given = remembered(output_folder(folder) / "runs.jsonl")
    found = []
    begun = time.process_time()
    for method in stability.methods:
        for x in stability.x.values:
            one = _boundary(stability, method, x, given)
            where = place_of(one.found, stability.y.range[0])
            beside = "" if one.theory is None else f", theory {one.theory:.4g}"
            say(f"{method.name}, {stability.x.name} = {x:.4g}: {where}{beside} ({len(one.tried)} runs)")
            found.append(one)
    say(f"{sum(len(b.tried) for b in found)} runs, {time.process_time() - begun:.0f} core-seconds this time")
    for line in agreement(stability, found):
        say(line)
    return found


def place_of(found: float | None, first: float) -> str:
    """Where a boundary was found by a search that began at `first`, in words."""
    if found == first:
        return f"{found:.4g} or before: runs are bad where the range begins; begin it where they are good"
    return "none" if found is None else f"{found:.4g}"


def agreement(stability: StabilityMap, found: list[Boundary]) -> list[str]:
    """How far the boundaries of runs are from theory's, and whether as near as the map asks for; nothing without
    theory."""
    low, high = sorted(stability.y.range)
    known = [b for b in found if b.theory is not None and (b.found is not None or low <= b.theory <= high)]
    if not known:
        return []
    worst = max(known, key=_off)
    least = "nowhere on the axis" if worst.found is None else f"{worst.found:.4g}, {100 * (worst.ratio - 1):+.1f} %"
    text = f"farthest from theory: {worst.method}, {stability.x.name} = {worst.x:.4g}: {least} of {worst.theory:.4g}"
    if stability.agreement is None:
        return [text]
    verdict = "met" if _off(worst) <= stability.agreement else "not met"
    return [f"{text}; within {100 * stability.agreement:g} %: {verdict}, {len(known)} boundaries"]


def _off(b: Boundary) -> float:
    """Deviation from theory, relative; infinite where runs know no boundary and theory does."""
    return math.inf if b.ratio is None else abs(b.ratio - 1.0)


def _boundary(stability: StabilityMap, method: Method, x: float, given: Remembered) -> Boundary:
    cell = partial(cell_scene, stability, method, x)
    criterion = with_reference(stability.criterion, cell, given)
    tried: dict[float, float] = {}

    def bad(y: float) -> bool:
        if y not in tried:
            value = given(measure, cell(y), criterion)
            if math.isnan(value) and y == stability.y.range[0]:
                raise BadInput(
                    f"criterion.measure = {criterion.measure!r}: nothing to measure in a run that should be good "
                    f"({method.name}, {stability.x.name} = {x:g}, {stability.y.name} = {y:g}): "
                    f"{NOTHING[criterion.measure]}."
                )
            tried[y] = FAILED if math.isnan(value) else value
        return not tried[y] <= criterion.limit

    found = boundary(bad, *stability.y.range, stability.y.tolerance)
    for y in stability.y.values:
        bad(y)
    theory, warned = _theory(stability, method, x), _warned(stability, cell)
    return Boundary(method.name, x, found, theory, warned, tuple(sorted(tried.items())))


def _theory(stability: StabilityMap, method: Method, x: float) -> float | None:
    name = stability.theory_of(method)
    return None if name is None else THEORIES[name](cell_scene(stability, method, x, stability.y.range[0]), x)


def _warned(stability: StabilityMap, cell: Callable[[float], Scene]) -> float | None:
    """The y from which on pre-flight's rule of the map says anything but ok."""
    if stability.rule is None:
        return None

    def warns(y: float) -> bool:
        scene = cell(y)
        return any(f.rule == stability.rule and f.verdict != "ok" for f in findings(scene, scene_numbers(scene)))

    return boundary(warns, *stability.y.range, _RULE_TOLERANCE)


def write_map(stability: StabilityMap, found: list[Boundary], folder: Path) -> list[Path]:
    """Write map.csv (boundaries), cells.csv (every run) and map.png into `folder`; their paths."""
    folder = output_folder(folder)
    paths = [folder / name for name in ("map.csv", "cells.csv", "map.png")]
    x, y = stability.x.name, stability.y.name
    with paths[0].open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("method", x, f"{y}, by runs", "by theory", "ratio", "pre-flight warns", "runs"))
        for b in found:
            numbers = ("" if v is None else f"{v:.5g}" for v in (b.x, b.found, b.theory, b.ratio, b.warned))
            writer.writerow([b.method, *numbers, len(b.tried)])
    with paths[1].open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("method", x, y, stability.criterion.measure))
        writer.writerows((b.method, f"{b.x:.5g}", f"{y:.5g}", f"{value:.4g}") for b in found for y, value in b.tried)
    from coupler.stability.picture import draw_map  # loads for half a second

    draw_map(stability, found, paths[2])
    return paths
