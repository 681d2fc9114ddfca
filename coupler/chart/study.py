"""`coupler chart`: error against cost over the variants of a case's study.

Error: of the goal's statistic of the goal's probe, against the study's truth. Cost: processor seconds of stepping, both
sides together; loading, compiling and output are left out. The Pareto front holds the variants that no other beats in
both.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupler.chart.outcome import missing, of_other_code
from coupler.chart.runs import run_variants, was_alone
from coupler.chart.truth import charted_value, find_truth, known_truth, spread
from coupler.chart.variants import Variant, study_variants
from coupler.preflight.bounds.error import error_bound
from coupler.preflight.cost import Cost, calibrate, predicted_cost
from coupler.preflight.measures.numbers import scene_numbers
from shared.contract import BadInput
from shared.run.results import output_folder
from shared.run.statistics import relative_error
from shared.schema.scene import Scene

_LEAST_ERROR = 1e-6  # smaller ones are drawn here; no truth is known better


@dataclass(frozen=True)
class Point:
    """A variant as it came out. `error` and `cost` [core-s] are None where it failed, `error` also of the run that is
    the truth; `bound`, `expected`: what pre-flight had said; `alone`: nothing of the chart ran beside it, so that its
    cost means something."""

    variant: Variant
    status: str
    value: float | None
    error: float | None
    cost: float | None
    core_s: float | None
    bound: float | None
    expected: Cost
    alone: bool


@dataclass(frozen=True)
class Slope:
    """Least squares through the logarithms of a series: error ~ cost^slope, error ~ dx^order; `at`: cost by that line
    at the error of the chart's smallest variant, or at the least error where none is enough."""

    series: str
    slope: float
    order: float
    at: float


@dataclass(frozen=True)
class Chart:
    """All that a chart shows. `spread`: relative deviations from the truth of the other references; `notes`: what its
    reader has to know of the runs."""

    case: str
    scene: Scene
    truth: str
    truth_value: float
    points: list[Point]
    front: list[Point]
    smallest: Point | None
    slopes: list[Slope]
    spread: dict[str, float]
    notes: list[str]


def make_chart(
    case: str,
    sets: Sequence[str],
    folder: Path,
    jobs: int,
    say: Callable[[str], None],
    scheduler: str | None = None,
) -> Chart:
    """Run what is missing of the study into `folder`/runs, here or on the cluster of `scheduler`, and weigh it."""
    variants = study_variants(case, sets)
    scene, runs = variants[0].scene, output_folder(folder) / "runs"
    known_truth(scene)
    results = run_variants(case, variants, runs, jobs, say, scheduler)
    values = [charted_value(v, r, runs / v.folder) for v, r in zip(variants, results, strict=True)]
    absent = missing(variants, results, values, runs)
    if len(absent) == len(variants) and scene.study.truth is None:
        raise BadInput("no variant has a value, so there is nothing to chart\n" + "\n".join(f"  {a}" for a in absent))
    name, truth, finest = find_truth(scene, variants, values)
    slower = calibrate()
    points = [
        _point(variant, result, value, None if variant is finest else truth, slower)
        for variant, result, value in zip(variants, results, values, strict=True)
    ]
    judged = [p for p in points if p.error is not None]
    front = pareto(judged)
    wanted = [p for p in judged if p.error <= scene.goal.error]
    smallest = min(wanted, key=lambda p: p.cost, default=None)
    return Chart(
        case=case,
        scene=scene,
        truth=name,
        truth_value=truth,
        points=points,
        front=front,
        smallest=smallest,
        slopes=slopes(judged, None if smallest is None else smallest.error),
        spread=spread(scene, truth, name),
        notes=absent + of_other_code(results),
    )


def pareto(points: Sequence[Point]) -> list[Point]:
    """The points that no other beats in both error and cost, by cost."""
    front, best = [], math.inf
    for point in sorted(points, key=lambda p: (p.cost, p.error)):
        if point.error < best:
            front.append(point)
            best = point.error
    return front


def slopes(points: Sequence[Point], error: float | None = None) -> list[Slope]:
    """The slope of each series of two spacings or more, and its cost at `error` (default: the least of all)."""
    least = error or min((max(p.error, _LEAST_ERROR) for p in points), default=_LEAST_ERROR)
    found = []
    for series in dict.fromkeys(p.variant.series for p in points):
        own = [p for p in points if p.variant.series == series and p.error > _LEAST_ERROR and p.cost > 0.0]
        if len({p.variant.dx for p in own}) < 2:
            continue
        errors, cost, dx = np.log([(p.error, p.cost, p.variant.dx) for p in own]).T
        slope, start = np.polyfit(cost, errors, 1) if np.ptp(cost) > 0.0 else (math.nan, math.nan)
        order = np.polyfit(dx, errors, 1)[0]
        at = math.exp((math.log(least) - start) / slope) if slope < 0.0 else math.inf
        found.append(Slope(series, float(slope), float(order), at))
    return found


def stepping_core_s(result: dict[str, Any]) -> float | None:
    """Processor seconds [s] of both sides' stepping."""
    sides = [side for side in (result.get("cost", {}).get(name) for name in ("fluid", "solid")) if side]
    own = [side.get("stepping_core_s") for side in sides]
    return sum(own) if own and all(value is not None for value in own) else None


def _point(variant: Variant, result: dict[str, Any], value: float | None, truth: float | None, slower: float) -> Point:
    numbers = scene_numbers(variant.scene)
    bound = error_bound(variant.scene, numbers)
    cost = stepping_core_s(result)
    return Point(
        variant=variant,
        status=result["status"],
        value=value,
        error=None if None in (value, cost, truth) else abs(relative_error(value, truth)),
        cost=cost,
        core_s=result.get("cost", {}).get("core_s"),
        bound=bound if bound is not None and math.isfinite(bound) else None,
        expected=predicted_cost(variant.scene, numbers, slower),
        alone=was_alone(result),
    )
