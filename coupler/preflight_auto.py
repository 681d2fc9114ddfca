"""`--models auto`: the run takes the smallest pair that meets the goal."""

from __future__ import annotations

from coupler.preflight import Preflight
from shared.contract import BadInput
from shared.schema import Scene


def chosen(report: Preflight) -> Scene:
    """The scene of the smallest pair. Raises BadInput where there is none, with what was in the way."""
    if report.choice is not None:
        return report.choice.scene
    if not report.ladder:
        raise BadInput("--models auto needs a [goal] (probe, statistic, error) to choose by; add one to the scene")
    reasons = "\n".join(f"  {rung.name}: {rung.reason}" for rung in report.ladder if rung.standing == "not enough")
    raise BadInput(f"--models auto: no pair of models is known to meet the goal\n{reasons}")
