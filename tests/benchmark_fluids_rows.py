"""The rows of the fluids' benchmark: demand, runs of cases, what is measured, and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np

from shared.fluid_step import COURANT
from tests.benchmark_fluids_measures import (
    centre_off,
    energy_rise,
    front_gap,
    impulse,
    kinetic_share,
    level_off,
    of_probe,
    peak,
    pressure_error,
    worst_reference,
)

Job = tuple[str, tuple[str, ...]]  # a shipped case and its settings
WAVE = {250: (0.818009, 0.808048, "1.25283678e-2"), 500: (0.806583, 0.431545, "6.2641839e-3")}
"""Period [s], decay rate [1/s] and viscosity [m²/s] of the standing wave by Reynolds number: exact roots."""
DECAY = 16.0 * math.pi**2 / 100.0  # 1/s, of the vortices' kinetic energy
FRONT = {"2.25 in": 2.32013, "1.125 in": 2.30296}
"""Front's speed [m/s] between T = 1.5 and 4 of Martin & Moyce's clock, by column (least-squares lines)."""
DAM_DX = (8e-3, 4e-3, 2e-3)  # m
REPEATS = 5  # runs of which a chaotic figure is the mean


@dataclass(frozen=True)
class Row:
    """`measure` of the runs `jobs` against `truth` (relative error `allowed`, absolute where the truth is 0), or bounds
    on the figure itself."""

    demand: str
    jobs: tuple[Job, ...]
    measure: Callable[..., float]
    truth: float | None = None
    allowed: float | None = None
    least: float | None = None
    most: float | None = None
    unit: str = ""


def job(case: str, *sets: str) -> Job:
    return case, sets


def order(truth: float, measure: Callable[..., float]) -> Callable[..., float]:
    """Order of convergence from a coarse to a run twice as fine: log2 of the ratio of their errors."""

    def between(coarse, fine) -> float:
        return math.log2(abs(measure(coarse) - truth) / abs(measure(fine) - truth))

    return between


def _rest() -> list[Row]:
    rows = []
    for across, dx, allowed in ((2, "0.01", 0.05), (3, "6.6666667e-3", 0.05), (4, "5e-3", 0.05)):
        for model in ("ctvf", "wcsph"):
            run = job("two_reservoirs", f"fluid.model={model}", f"fluid.dx={dx}")
            name = f"plate {across} dx thick between two waters, net load, {model}"
            rows.append(Row(name, (run,), of_probe("net_force", "mean"), 245.25, allowed))
    run = job("two_reservoirs", "fluid.dx=0.02")
    rows.append(
        Row("plate 1 dx thick between two waters, refused", (run,), of_probe("net_force", "mean"), 245.25, 0.05)
    )
    for across, dx in ((2, "0.02"), (4, "0.01"), (8, "5e-3")):
        for model in ("ctvf", "wcsph"):
            run = job("submerged_block", f"fluid.model={model}", f"fluid.dx={dx}")
            name = f"block {across} dx thick under water, lift, {model}"
            rows.append(Row(name, (run,), of_probe("lift", "mean"), 78.48, 0.01))
    return rows


def _still(model: str) -> list[Row]:
    run = (job("still_tank", "end_time=20", "output.average_from=2", "output.frames=40", f"fluid.model={model}"),)
    name = f"still_tank, 20 s, {model}"
    return [
        Row(f"{name}, L2 error of pressure", run, pressure_error, most=0.01),
        Row(f"{name}, bottom pressure", run, of_probe("bottom_pressure", "mean"), 4905.0, 0.001),
        Row(f"{name}, level off the settled column's", run, level_off, 0.0, 0.25, unit="dx"),
        Row(f"{name}, centre of mass off the settled column's", run, centre_off, 0.0, 0.25, unit="dx"),
        Row(f"{name}, kinetic over potential energy after 2 s", run, kinetic_share, most=1e-6),
        Row(f"{name}, leaked", run, of_probe("leaked", "max"), 0.0, 0.0),
    ]


def _viscous() -> list[Row]:
    decay, rows = of_probe("kinetic_energy", "decay"), []
    green = {n: job("taylor_green", f"fluid.dx={1 / n:g}") for n in (25, 50, 100)}
    for n, allowed in ((25, None), (50, 0.02), (100, None)):
        rows.append(Row(f"taylor_green, {n} × {n}, decay", (green[n],), decay, DECAY, allowed))
    rows.append(Row("taylor_green, order from 25 to 50", (green[25], green[50]), order(DECAY, decay)))
    rows.append(Row("taylor_green, order from 50 to 100", (green[50], green[100]), order(DECAY, decay), least=1.0))
    rows.append(Row("lid_cavity, worst of 30 velocities", (job("lid_cavity"),), worst_reference, most=0.03))
    return rows


def _waves() -> list[Row]:
    rows = []
    for reynolds, (period, rate, viscosity) in WAVE.items():
        runs = {n: job("standing_wave", f"fluid.viscosity={viscosity}", f"fluid.dx={1 / n:g}") for n in (25, 50, 100)}
        for n in runs:
            least = n == 50
            name = f"standing_wave, Re {reynolds}, {n} deep"
            swing, fade = of_probe("crest", "wave-period"), of_probe("crest", "wave-decay")
            rows.append(Row(f"{name}, period", (runs[n],), swing, period, 0.005 if least else None))
            rows.append(Row(f"{name}, decay", (runs[n],), fade, rate, 0.15 if least else None))
        for what, truth in (("period", period), ("decay", rate)):
            for coarse, fine in pairwise(runs):
                name = f"standing_wave, Re {reynolds}, order of the {what} from {coarse} to {fine}"
                rows.append(Row(name, (runs[coarse], runs[fine]), order(truth, of_probe("crest", f"wave-{what}"))))
    return rows


def _dam_break(model: str) -> list[Row]:
    rows = []
    runs = [job("dam_break", f"fluid.model={model}", f"fluid.dx={dx:g}") for dx in DAM_DX]
    slope = of_probe("front_x", "slope", (0.1061, 0.3218))
    for run, dx in zip(runs, DAM_DX, strict=True):
        name = f"dam_break, {model}, dx {dx:g}"
        for column, speed in FRONT.items():
            rows.append(Row(f"{name}, front's speed, column of {column}", (run,), slope, speed, 0.05, unit="m/s"))
        rows.append(Row(f"{name}, leaked", (run,), of_probe("leaked", "max"), 0.0, 0.0))
        rows.append(Row(f"{name}, largest rise of energy between frames", (run,), energy_rise, most=0.005))

    def shrinks(coarse, middle, finest) -> float:
        return front_gap(middle, finest) / front_gap(coarse, finest)

    for run, dx in zip(runs[:2], DAM_DX[:2], strict=True):
        rows.append(
            Row(
                f"dam_break, {model}, front at dx {dx:g} off that at {DAM_DX[2]:g}", (run, runs[2]), front_gap, unit="m"
            )
        )
    rows.append(Row(f"dam_break, {model}, that distance, middle over coarse", tuple(runs), shrinks, most=0.8))
    return rows


def _impact(model: str) -> list[Row]:
    rows = []
    runs = [job("dam_break_wall", f"fluid.model={model}", f"fluid.dx={dx:g}") for dx in DAM_DX]
    pushed, read, point = impulse(0.4), peak("wall_pressure", 0.01), of_probe("wall_pressure", "max")
    push = peak("wall_force", 0.01)
    for run, dx in zip(runs, DAM_DX, strict=True):
        name = f"dam_break_wall, {model}, dx {dx:g}"
        rows.append(Row(f"{name}, impulse on the far wall to 0.4 s", (run,), pushed, unit="N s/m"))
        group = (run, *_others(run, model))
        sensor = f"{name}, sensor of 2 cm, highest mean over 10 ms"
        rows.append(Row(f"{sensor}, mean of {REPEATS}", group, mean(read), unit="Pa"))
        rows.append(Row(f"{sensor}, standard deviation", group, scatter(read), unit="Pa"))
        rows.append(Row(f"{name}, force on the far wall, highest mean over 10 ms", (run,), push, unit="N/m"))
        rows.append(Row(f"{name}, the same sensor, highest reading", (run,), point, unit="Pa"))
        rows.append(Row(f"{name}, leaked", (run,), of_probe("leaked", "max"), 0.0, 0.0))
        rows.append(Row(f"{name}, largest rise of energy between frames", (run,), energy_rise, most=0.005))
    for what, measure, most in (("impulse", pushed, 0.05), ("push over 10 ms", push, 0.05), ("sensor", read, None)):
        groups = [(run, *(_others(run, model) if what == "sensor" else ())) for run in runs]
        name = f"dam_break_wall, {model}, {what}, last change"
        if what != "push over 10 ms":  # at 8 mm it is within a hundredth already
            rows.append(Row(f"{name} over the one before", tuple(chain(*groups)), _shrinks(mean(measure)), most=1.0))
        rows.append(Row(name, tuple(chain(*groups[1:])), _last(mean(measure)), most=most))
    return rows


def _shrinks(measure):
    """Change of a measure of as many runs each at three spacings: the last over the one before."""

    def over(*found) -> float:
        size = len(found) // 3
        coarse, middle, fine = (measure(*found[k : k + size]) for k in range(0, len(found), size))
        return abs(fine - middle) / abs(middle - coarse)

    return over


def _last(measure):
    """Relative change of a measure of as many runs each at two spacings."""

    def between(*found) -> float:
        middle, fine = found[: len(found) // 2], found[len(found) // 2 :]
        return abs(measure(*fine) / measure(*middle) - 1.0)

    return between


def _others(run, model: str) -> tuple:
    """The same at slightly shorter steps. What a sensor of a few particles reads of a splash is chaotic: rounding alone
    changes it by a tenth, and one run of each dx shows no order."""
    case, sets = run
    return tuple(job(case, *sets, f"fluid.courant={COURANT[model] * (1.0 - 0.02 * k):g}") for k in range(1, REPEATS))


def mean(measure):
    """The mean of a measure over runs."""
    return lambda *found: float(np.mean([measure(one) for one in found]))


def scatter(measure):
    """The standard deviation of a measure over runs."""
    return lambda *found: float(np.std([measure(one) for one in found], ddof=1))


def _step(model: str) -> list[Row]:
    """Answers at the automatic step beside those at a quarter of it, until after the impact."""
    sets = (f"fluid.model={model}", "fluid.dx=4e-3", "end_time=0.5")
    runs = job("dam_break_wall", *sets, f"fluid.courant={COURANT[model] / 4:g}"), job("dam_break_wall", *sets)
    figures = {
        "front at 0.19 s": (of_probe("front_x", "mean", (0.1899, 0.19)), 0.005),
        "impulse on the far wall to 0.5 s": (impulse(0.5), 0.02),
        "total energy at 0.5 s": (of_probe("total_energy", "final"), 0.01),
    }
    rows = []
    for what, (measure, most) in figures.items():

        def change(small, large, measure=measure) -> float:
            return abs(measure(large) / measure(small) - 1.0)

        rows.append(Row(f"{what}, {model}, change from a quarter of the step", runs, change, most=most))
    return rows


def rows() -> list[Row]:
    """All rows that are runs of cases, cheap ones first."""
    parts = [_rest(), _viscous(), _still("ctvf"), _dam_break("wcsph"), _dam_break("ctvf"), _waves()]
    parts += [_step("wcsph"), _step("ctvf"), _impact("wcsph"), _impact("ctvf")]
    return [row for part in parts for row in part]
