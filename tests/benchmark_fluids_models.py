"""Model against model: particle disorder, noise of the pressure and cost of ctvf and wcsph on the same cases."""

from __future__ import annotations

from collections.abc import Callable

from shared.run.drawing import FONT_PT, axes_at, new_figure, save
from tests.benchmark_fluids_measures import Found, cost, disorder, pressure_noise
from tests.benchmark_fluids_rows import Job, Row, job
from tests.benchmark_table import RESULTS

MODELS = ("ctvf", "wcsph")
CASES = {
    "still_tank": ("end_time=5", "output.average_from=2"),
    "standing_wave": (),
    "taylor_green": (),
    "dam_break": ("fluid.dx=4e-3",),
    "dam_break_wall": ("fluid.dx=4e-3",),
}
SCALE = {
    "still_tank": 4905.0,
    "standing_wave": 9810.0,
    "taylor_green": 500.0,
    "dam_break": 2865.0,
    "dam_break_wall": 2865.0,
}
"""Pressure [Pa] that a case lives by: ρgH, or ρU²/2."""


def _jobs(case: str) -> tuple[Job, Job]:
    return tuple(job(case, f"fluid.model={model}", *CASES[case]) for model in MODELS)


def _noise(case: str) -> Callable[[Found], float]:
    return lambda found: pressure_noise(found) / SCALE[case]


def model_rows() -> list[Row]:
    """Rows of disorder, noise and cost of every case and model."""
    rows = []
    for case in CASES:
        for model, run in zip(MODELS, _jobs(case), strict=True):
            rows.append(Row(f"{case}, particle disorder at the end, {model}", (run,), disorder))
            rows.append(Row(f"{case}, pressure noise over the case's pressure, {model}", (run,), _noise(case)))
            rows.append(Row(f"{case}, core-seconds per second, {model}", (run,), cost, unit="s/s"))
    return rows


def draw(found_of: Callable[[Job], Found], only_some: bool) -> None:
    """The chart cases/results/fluids_models.png; nothing where only some rows were asked for."""
    if only_some:
        return
    figure = new_figure(8.0, 2.9)
    panels = {
        "particle disorder": lambda case: disorder,
        "pressure noise": _noise,
        "core-s per s": lambda case: cost,
    }
    for k, (title, measure) in enumerate(panels.items()):
        axes = axes_at(figure, 1.35 + 2.2 * k, 0.4, 1.95, 2.1)
        for model, marker in zip(MODELS, "os", strict=True):
            values = [measure(case)(found_of(_jobs(case)[MODELS.index(model)])) for case in CASES]
            axes.plot(values, range(len(CASES)), marker, label=model, markersize=5, fillstyle="none")
        axes.set_xscale("log")
        axes.set_title(title, fontsize=FONT_PT)
        axes.set_yticks(range(len(CASES)), list(CASES) if k == 0 else [""] * len(CASES))
        axes.grid(alpha=0.3)
        axes.invert_yaxis()
        if k == 0:
            axes.legend(fontsize=FONT_PT - 1, frameon=False)
    save(figure, RESULTS / "fluids_models.png")
