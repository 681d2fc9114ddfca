"""`coupler stability`: boundaries of growth found by runs, with theory's line over them."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupler.stability_map import Method, StabilityMap
from coupler.stability_runs import boundary, cell_scene, growth_rate
from coupler.stability_theory import lagged_column
from shared.drawing import FONT_PT, INK, axes_at, new_figure, save

COLUMNS = ("method", "x", "boundary", "theory", "difference", "runs")
_GROWING = 0.0  # growth per window past which a run is unstable
_WIDTH_IN, _HEIGHT_IN = 7.0, 4.2
_LEFT_IN, _BOTTOM_IN, _TOP_IN, _LEGEND_IN = 0.75, 0.55, 0.4, 1.7
_COLOURS = ("#0b4f8a", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")


@dataclass(frozen=True)
class Boundary:
    """Where growth begins for a `method` at `x`: by `runs` runs, and by theory (None: not known, or never)."""

    method: str
    x: float
    found: float | None
    theory: float | None
    tried: tuple[tuple[float, float], ...]  # y and growth per window of every run

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
    tried: list[tuple[float, float]] = []

    def grows(y: float) -> bool:
        rate = growth_rate(cell_scene(stability, method, x, y), stability.probe)
        tried.append((y, rate))
        return rate > _GROWING

    found = boundary(grows, *stability.y.range, stability.y.tolerance)
    return Boundary(method.name, x, found, _theory(stability, method, x), tuple(tried))


def _theory(stability: StabilityMap, method: Method, x: float) -> float | None:
    if stability.theory is None:
        return None
    coupling = cell_scene(stability, method, x, stability.y.range[0])
    return lagged_column(x, coupling.coupling.predictor, coupling.fluid.column.reflection)


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
        writer.writerow(("method", "x", "y", "growth_per_window"))
        writer.writerows((b.method, f"{b.x:.5g}", f"{y:.5g}", f"{rate:.4g}") for b in found for y, rate in b.tried)
    draw_map(stability, found, paths[2])
    return paths


def draw_map(stability: StabilityMap, found: list[Boundary], path: Path) -> Path:
    """Draw the boundaries found as points, theory's as lines; unstable is above."""
    figure = new_figure(_WIDTH_IN, _HEIGHT_IN)
    size = _WIDTH_IN - _LEFT_IN - _LEGEND_IN, _HEIGHT_IN - _BOTTOM_IN - _TOP_IN
    axes = axes_at(figure, _LEFT_IN, _BOTTOM_IN, *size)
    for k, method in enumerate(stability.methods):
        own = [b for b in found if b.method == method.name]
        colour = _COLOURS[k % len(_COLOURS)]
        points = np.array([(b.x, b.found) for b in own if b.found is not None]).reshape(-1, 2)
        axes.plot(*points.T, linestyle="", marker="osD^vP"[k % 6], markersize=4.5, color=colour, label=method.name)
        line = np.array([(b.x, b.theory) for b in own if b.theory is not None]).reshape(-1, 2)
        axes.plot(*line.T, linewidth=0.9, color=colour, alpha=0.8)
    axes.plot([], [], linewidth=0.9, color=INK, label="theory")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(stability.x.name, fontsize=FONT_PT, color=INK)
    axes.set_ylabel(f"largest stable {stability.y.name}", fontsize=FONT_PT, color=INK)
    axes.set_title(stability.title, loc="left", fontsize=FONT_PT + 1, color=INK)
    axes.grid(color="0.9", linewidth=0.5, which="both", zorder=0.5)
    axes.legend(fontsize=FONT_PT - 2.0, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.02), labelcolor=INK)
    return save(figure, path)
