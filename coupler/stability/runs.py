"""The runs behind a stability map: how bad is a cell, and where does badness begin."""

from __future__ import annotations

import contextlib
import io
import logging
import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from coupler.choice import make_taker
from coupler.inprocess import inprocess_sides, side_model
from coupler.mapping import build_mapping
from coupler.run import start
from coupler.schemes import probes
from coupler.stability.kept import Remembered
from coupler.stability.map import Criterion, Method, StabilityMap
from coupler.window import make_plan, mass_ratio
from shared.clock import Clock
from shared.contract import BadInput, Kinematics, ShearwaterError
from shared.participant import Participant
from shared.run.record import of_the_machine
from shared.run.statistics import relative_error, statistic
from shared.scene.reading import load_scene
from shared.scene.sides import probe_rows
from shared.schema.scene import Scene

FAILED = math.inf  # measure of a run that a limit or a non-finite state ended
DIED_OUT = -math.inf  # growth of a run whose probe has sunk into rounding
_STRIDE = 2.0  # factor between the values of y tried on the way to the first that is bad
_ROUNDING = 1e-16
"""Of the largest value, a square; places are known to 1e-16 of their size, speeds by their differences."""


class Watched:
    """What comes of a cell's run: its probes' rows, and the iterations of its windows. No files."""

    def __init__(self):
        self.times: list[float] = []
        self.rows: list[dict[str, float]] = []
        self.iterations: list[int] = []

    def at(self, now: float, probes: dict[str, float] | None) -> None:
        """The run has reached `now` [s]."""
        if probes is not None:
            self.times.append(now)
            self.rows.append(probes)

    def history(self, probe: str) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and values of a probe."""
        return np.array(self.times), np.array([row[probe] for row in self.rows])


def cell_scene(stability: StabilityMap, method: Method, x: float, y: float) -> Scene:
    """The scene of one cell."""
    along = [scale.setting(x) for scale in stability.x.scales]
    upward = [scale.setting(y) for scale in stability.y.scales]
    return load_scene(stability.case, [*stability.sets, *method.sets, *along, *upward])


def measure(scene: Scene, criterion: Criterion) -> float:
    """The criterion's measure of a run of `scene`; infinite for a run that ended by a diagnosis, not a number where
    there was nothing to measure. Raises ShearwaterError where the machine ended it, which says nothing of the cell."""
    try:
        watched = _watch(scene)
    except ShearwaterError as error:
        if of_the_machine(error):
            raise
        return FAILED
    return MEASURES[criterion.measure](watched, criterion, scene)


def with_reference(criterion: Criterion, cell: Callable[[float], Scene], given: Remembered) -> Criterion:
    """The criterion with the value that its reference's run gives, where it has one; `cell`: the scene of a y."""
    if criterion.reference is None:
        return criterion
    scene = cell(criterion.reference)
    where = f"criterion.reference = {criterion.reference:g}: in the run of {scene.title!r} there"
    try:
        value = given(reference_value, scene, criterion)
    except ShearwaterError as error:
        if of_the_machine(error):
            raise
        ended = f"{where}, which others are measured against, something failed: take one that is good"
        raise BadInput(f"{ended}. {error}") from error
    if not value:
        raise BadInput(
            f"{where} the "
            f"{criterion.statistic} of {criterion.probe} is {'zero' if value == 0.0 else 'not to be had'}, and nothing "
            "can be measured against it: make the run longer, or take another probe or statistic."
        )
    return criterion.model_copy(update={"value": value, "reference": None})


def reference_value(scene: Scene, criterion: Criterion) -> float | None:
    """The statistic that other runs are to have."""
    return _statistic(_watch(scene), criterion, scene)


def _watch(scene: Scene) -> Watched:
    """What comes of a run of `scene`. Raises ShearwaterError where it ends by a diagnosis."""
    watched = Watched()
    both = scene.fluid is not None and scene.solid is not None
    with _unheard():
        (_run_coupled if both else _run_alone)(scene, watched)
    return watched


def _run_coupled(scene: Scene, watched: Watched) -> None:
    """Both sides in this process; without a ledger, whose limits are there to end what a map looks for."""
    with (
        tempfile.TemporaryDirectory() as folder,
        inprocess_sides(scene, {"fluid": 1, "solid": 1}, "cell", Path(folder)) as sides,
    ):
        fluid, structure = sides["fluid"].describe(), sides["solid"].describe()
        plan = make_plan(scene.coupling, fluid, structure, mass_ratio(scene, structure))
        clock = Clock.fitting(scene.end_time, plan.window)
        c = start(
            scene, clock, build_mapping(structure, fluid, scene.gravity), sides["fluid"], sides["solid"], watched, None
        )
        take = make_taker(plan, scene.coupling)
        for window in map(clock.window, range(clock.count)):
            watched.iterations.append(len(take(c, window).changes))
            watched.at(window.t1, probes(c))


def _run_alone(scene: Scene, watched: Watched) -> None:
    """The one side that there is, in this process."""
    side = "solid" if scene.fluid is None else "fluid"
    participant = Participant(side_model(scene, side, False, 1), side)
    points = participant.describe().position
    still = Kinematics.at_rest(points) if side == "fluid" else None
    rows = probe_rows(scene)
    clock = Clock(scene.end_time, rows)
    _, first = participant.start(clock, np.arange(len(points)), still, probe_rows=rows)
    watched.at(0.0, first)
    for window in map(clock.window, range(clock.count)):
        participant.advance(window, still)
        watched.at(window.t1, participant.accept())


@contextlib.contextmanager
def _unheard() -> Iterator[None]:
    """What the models warn of in a cell is what the map is about."""
    log = logging.getLogger("shearwater")
    handler, before = logging.StreamHandler(io.StringIO()), log.propagate
    log.addHandler(handler)
    log.propagate = False
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.propagate = before


# ---- measures --------------------------------------------------------------------------------------------------------


def growth_of(values: Sequence[float]) -> float:
    """Growth per row of the amplitude in `values`, which go as its square: of the last quarter over the one before.

    Where it has come to its end, and the last three quarters hold more than the first value, the mean until then if
    that is more; a swing that starts from nothing has no such mean. Not a number of too few values, or negative ones.
    """
    quarter = len(values) // 4
    if quarter == 0 or np.min(values) < 0.0:
        return math.nan
    before, after = np.max(values[2 * quarter : 3 * quarter]), np.max(values[3 * quarter : 4 * quarter])
    largest = np.max(values[quarter:])
    if not math.isfinite(largest):
        return FAILED
    if after <= _ROUNDING * np.max(values):
        rate = DIED_OUT
    else:
        rate = 0.5 * math.log(after / before) / quarter if before > 0.0 else FAILED
    return max(rate, 0.5 * math.log(largest / values[0]) / len(values)) if largest > values[0] > 0.0 else rate


def rise_of(values: np.ndarray) -> float:
    """Largest rise above an earlier value, over the largest size; not a number where all are zero."""
    size = np.max(np.abs(values))
    return float(np.max(values - np.minimum.accumulate(values)) / size) if size != 0.0 else math.nan


def _growth(watched: Watched, criterion: Criterion, scene: Scene) -> float:
    return growth_of(watched.history(criterion.probe)[1])


def _iterations(watched: Watched, criterion: Criterion, scene: Scene) -> float:
    return float(np.max(watched.iterations))


def _rise(watched: Watched, criterion: Criterion, scene: Scene) -> float:
    return rise_of(watched.history(criterion.probe)[1])


def _deviation(watched: Watched, criterion: Criterion, scene: Scene) -> float:
    found = _statistic(watched, criterion, scene)
    return math.nan if found is None else abs(relative_error(found, criterion.value))


def _statistic(watched: Watched, criterion: Criterion, scene: Scene) -> float | None:
    between = (scene.output.average_from, watched.times[-1]) if criterion.statistic == "mean" else None
    return statistic(criterion.statistic, *watched.history(criterion.probe), between)


NOTHING = {
    "growth": "it takes four rows of probes or more, and a probe that is never negative: make the run longer, "
    "output.probe_interval shorter, or take a probe that goes as the square of a swing, like kinetic-energy",
    "rise": "the probe is zero throughout, or has rows without a value: take another one",
    "deviation": "the probe has no such statistic in this run: make it longer, or take another statistic",
}
"""Why a measure is not a number, and the way out."""

MEASURES: dict[str, Callable[[Watched, Criterion, Scene], float]] = {
    "growth": _growth,
    "iterations": _iterations,
    "rise": _rise,
    "deviation": _deviation,
}


# ---- the search ------------------------------------------------------------------------------------------------------


def boundary(bad: Callable[[float], bool], first: float, last: float, tolerance: float) -> float | None:
    """The y nearest to `first` from which on runs are bad, on the way to `last`, to `tolerance`; None if none is.

    `first` itself where that is bad already.
    """
    if bad(first):
        return first
    stride = _STRIDE if last > first else 1.0 / _STRIDE
    good = tried = first
    while tried != last:
        tried = min(tried * stride, last) if last > first else max(tried * stride, last)
        if bad(tried):
            break
        good = tried
    else:
        return None
    while abs(math.log(tried / good)) > math.log1p(tolerance):
        middle = math.sqrt(good * tried)
        if bad(middle):
            tried = middle
        else:
            good = middle
    return math.sqrt(good * tried)
