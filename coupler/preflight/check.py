"""Pre-flight: model no more than a scene needs. The numbers of a scene, what the rules say, and the ladder of models.

`coupler check` prints it; every coupled run begins with it and keeps it in its result.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from coupler.preflight.bounds.error import error_bound
from coupler.preflight.cost import Cost, calibrate, predicted_cost
from coupler.preflight.finding import Finding
from coupler.preflight.ladder import Rung, ladder, near_miss, smallest
from coupler.preflight.measures.numbers import Numbers, scene_numbers
from coupler.preflight.measures.window import expected_window
from coupler.preflight.rules.findings import findings
from shared.contract import BadInput
from shared.schema.scene import Scene
from shared.streams import say

_ORDER = ("ok", "warn", "refuse")


@dataclass(frozen=True)
class Preflight:
    """All that is known of a scene before it runs. `slower`: this machine's time over the table's."""

    numbers: Numbers
    findings: list[Finding]
    ladder: list[Rung]
    error: float | None
    cost: Cost
    slower: float
    window: float | None

    @property
    def verdict(self) -> str:
        """The worst of all verdicts."""
        return max((f.verdict for f in self.findings), key=_ORDER.index, default="ok")

    @property
    def choice(self) -> Rung | None:
        """The smallest pair that meets the goal."""
        return smallest(self.ladder)

    @property
    def near_miss(self) -> Rung | None:
        """What just misses the goal for a tenth of the cost or less."""
        return near_miss(self.ladder)

    def as_dict(self) -> dict[str, Any]:
        """For result.json and `coupler check --json`."""
        return {
            "verdict": self.verdict,
            "findings": [asdict(finding) for finding in self.findings],
            "smallest": None if self.choice is None else _rung_dict(self.choice, self.slower),
            "near_miss": None if self.near_miss is None else _rung_dict(self.near_miss, self.slower),
            "ladder": [_rung_dict(rung, self.slower) for rung in self.ladder],
            "predicted": {
                "error_bound": self.error,
                **asdict(self.cost),
                "slower_than_table": self.slower,
                "window": self.window,
            },
        }


def preflight(scene: Scene) -> Preflight:
    """Pre-flight of a checked scene; takes up to a second or two, of which the calibration a fifth."""
    numbers = scene_numbers(scene)
    slower = calibrate()
    return Preflight(
        numbers=numbers,
        findings=findings(scene, numbers),
        ladder=ladder(scene),
        error=error_bound(scene, numbers),
        cost=predicted_cost(scene, numbers, slower),
        slower=slower,
        window=expected_window(scene, numbers),
    )


def stop_if_refused(report: Preflight) -> None:
    """Raise BadInput with every refusal of the report."""
    refused = [f for f in report.findings if f.verdict == "refuse"]
    if refused:
        lines = (f"  {f.rule} = {f.value:.4g}: {f.reason}; way out: {f.way_out}" for f in refused)
        raise BadInput("pre-flight refuses this scene; --force runs it all the same\n" + "\n".join(lines))


def warn_of(report: Preflight) -> None:
    """Print the warnings of the report, one line each, on standard error."""
    for f in report.findings:
        if f.verdict == "warn":
            say(f"warning: pre-flight: {f.rule} = {f.value:.4g}: {f.reason} → {f.way_out}")


def actual(result: dict[str, Any], scene: Scene) -> dict[str, Any]:
    """What a run found of what pre-flight predicts: core-seconds, and the goal's error against its first reference."""
    goal = scene.goal
    same = [
        row["error"]
        for row in result["references"]
        if goal is not None and (row["probe"], row["statistic"]) == (goal.probe, goal.statistic)
    ]
    error = abs(same[0]) if same and same[0] is not None else None
    return {"core_s": result["cost"]["core_s"], "error": error}


def _rung_dict(rung: Rung, slower: float) -> dict[str, Any]:
    finite = math.isfinite(rung.error)
    return {
        "models": rung.name,
        "standing": rung.standing,
        "reason": rung.reason,
        "sets": list(rung.sets),
        "error_bound": rung.error if finite else None,
        "core_s": None if rung.cost is None else rung.cost.core_s * slower,
    }
