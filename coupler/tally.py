"""What the windows of a run take: iterations, and time on the coupler's clock."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from coupler.remote import Remote, Working
from coupler.schemes import Outcome
from coupler.window import Plan
from shared.clock import Clock


class Tally:
    """Counts of a run's windows, of what went before its checkpoint too; the time runs from the start on."""

    def __init__(self, *sides: Remote):
        self._counts = {"iterations": 0, "unconverged": 0, "left": 0.0, "most": 0}
        self._marched, self._core = -time.perf_counter(), -time.process_time()
        self._working = Working(0.0, *sides)

    def go_on(self, earlier: Mapping[str, float]) -> None:
        """Count on from the `counts` that a checkpoint holds."""
        self._counts = {name: earlier.get(name, none) for name, none in self._counts.items()}
        self._marched += earlier["marched_s"]
        self._core += earlier["core_s"]
        self._working.seconds += earlier["worked_s"]

    def add(self, outcome: Outcome) -> None:
        """A window is taken."""
        self._working.note()
        self._counts["iterations"] += len(outcome.changes)
        self._counts["most"] = max(self._counts["most"], len(outcome.changes))
        if not outcome.converged:
            self._counts["unconverged"] += 1
            self._counts["left"] = max(self._counts["left"], outcome.changes[-1])

    def counts(self) -> dict[str, float]:
        """All of it; `marched_s`, `core_s`: time and processor time [s] of the coupler; `worked_s`: time [s] in which
        at least one side worked."""
        return self._counts | {
            "marched_s": self._marched + time.perf_counter(),
            "core_s": self._core + time.process_time(),
            "worked_s": self._working.seconds,
        }


def coupling_cost(counts: Mapping[str, float], plan: Plan, clock: Clock) -> dict[str, Any]:
    """What `result.json` says of the coupling's cost, from the `counts` at the end."""
    waited = counts["marched_s"] - counts["worked_s"]
    return {
        "scheme": plan.scheme,
        "windows": clock.count,
        "iterations_mean": counts["iterations"] / clock.count,
        "iterations_most": counts["most"],
        "not_converged": counts["unconverged"],
        "change_left": counts["left"],
        "reasons": plan.reasons,
        "core_s": counts["core_s"],
        "wait_s": waited,
        "overhead_fraction": waited / counts["marched_s"],
    }
