"""`--models auto`: the run takes the smallest pair that meets the goal, unless that is dearer than anyone asked for."""

from __future__ import annotations

from coupler.preflight.check import Preflight
from coupler.preflight.ladder import LONGEST
from coupler.preflight.table import near_miss_line
from shared.contract import BadInput
from shared.schema.scene import Scene


def chosen(report: Preflight, force: bool) -> Scene:
    """The scene of the smallest pair. Raises BadInput where there is none, with what was in the way, and unless
    `force`d where it takes more than an hour of core time and more than the scene as it stands."""
    choice = report.choice
    if choice is not None:
        if choice.cost.core_s > max(LONGEST, report.cost.core_s / report.slower) and not force:
            dear = f"{choice.name} would take {report.slower * choice.cost.core_s / 3600.0:.3g} core-hours"
            near = "" if report.near_miss is None else f"\n  {near_miss_line(report)}"
            raise BadInput(
                f"--models auto: {dear}, more than one and more than the scene as it stands; --force runs it, a larger "
                f"goal.error may need less{near}"
            )
        return choice.scene
    if not report.ladder:
        raise BadInput("--models auto needs a [goal] (probe, statistic, error) to choose by; add one to the scene")
    reasons = "\n".join(f"  {rung.name}: {rung.reason}" for rung in report.ladder if rung.standing == "not enough")
    raise BadInput(f"--models auto: no pair of models is known to meet the goal\n{reasons}")
