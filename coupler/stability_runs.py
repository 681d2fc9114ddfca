"""The runs behind a stability map: does a cell grow, and where does growth begin."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from coupler.inprocess import inprocess_sides
from coupler.run import couple
from coupler.stability_map import Method, StabilityMap
from shared.contract import ShearwaterError
from shared.scene import load_scene
from shared.schema import Scene

_STRIDE = 2.0  # factor between the values of y tried on the way up to the first that grows
_FAILED = math.inf  # growth of a run that a limit or a non-finite state ended
_DIED_OUT = -math.inf  # growth of a run whose probe has sunk into rounding
_ROUNDING = (
    1e-16  # of the largest value, a square; places are known to 1e-16 of their size, speeds by their differences
)


class Watched:
    """What a coupled run writes into, without files: its probes' rows."""

    def __init__(self, run_dir: Path):
        self.run_dir = run_dir
        self.cost: dict[str, Any] = {}
        self.ledger: dict[str, float] = {}
        self.preflight: dict[str, Any] = {}
        self.rows: list[dict[str, float]] = []

    def at(self, now: float, probes: dict[str, float] | None) -> None:
        """The run has reached `now` [s]."""
        if probes is not None:
            self.rows.append(probes)


def cell_scene(stability: StabilityMap, method: Method, x: float, y: float) -> Scene:
    """The scene of one cell."""
    along = [scale.setting(x) for scale in stability.x.scales]
    upward = [scale.setting(y) for scale in stability.y.scales]
    return load_scene(stability.case, [*stability.sets, *method.sets, *along, *upward])


def growth_rate(scene: Scene, probe: str) -> float:
    """Growth per window of the amplitude whose square the probe is like, over the last half of a run.

    Infinite for a run that failed: then it grew until something said so; minus infinite where all has died out.
    """
    with tempfile.TemporaryDirectory() as folder:
        watched = Watched(Path(folder))
        try:
            with inprocess_sides(scene, {"fluid": 1, "solid": 1}, "cell", watched.run_dir) as sides:
                couple(scene, sides["fluid"], sides["solid"], watched)
        except ShearwaterError:
            return _FAILED
    return rate_of([row[probe] for row in watched.rows])


def rate_of(values: Sequence[float]) -> float:
    """Growth per row of the amplitude in `values`, which go as its square: last quarter against the one before."""
    quarter = len(values) // 4
    before, after = np.max(values[2 * quarter : 3 * quarter]), np.max(values[3 * quarter : 4 * quarter])
    if not math.isfinite(after):
        return _FAILED
    if after <= _ROUNDING * np.max(values):
        return _DIED_OUT
    return 0.5 * math.log(after / before) / quarter


def boundary(grows: Callable[[float], bool], low: float, high: float, tolerance: float) -> float | None:
    """The least y in [low, high] that grows, to `tolerance`, coming from below; None where nothing grows.

    `low` itself where that grows already.
    """
    if grows(low):
        return low
    stable, tried = low, low
    while tried < high:
        tried = min(tried * _STRIDE, high)
        if grows(tried):
            break
        stable = tried
    else:
        return None
    while tried / stable > 1.0 + tolerance:
        middle = math.sqrt(stable * tried)
        if grows(middle):
            tried = middle
        else:
            stable = middle
    return math.sqrt(stable * tried)
