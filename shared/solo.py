"""One side alone: the same participant as in a coupled run, stepped without a partner."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from shared.clock import Clock
from shared.contract import BadInput, Kinematics, Model
from shared.participant import Participant
from shared.record import Record
from shared.results import new_run_directory
from shared.schema import Scene

Factory = Callable[[Scene, bool, int], Model]
PROBE_ROWS = 1000
"""Rows of probes.csv over a run where output.probe_interval is "auto"."""


def probe_rows(scene: Scene) -> int:
    """Number of probe rows after the first."""
    interval = scene.output.probe_interval
    return PROBE_ROWS if interval == "auto" else max(1, round(scene.end_time / interval))


def own_probes(scene: Scene, side: str) -> Scene:
    """The scene with the probes of one side, and what refers to them, alone."""
    solid = {b.name for b in scene.solid.bodies} if scene.solid else set()

    def is_solid(p):
        return p.body in solid and p.quantity not in ("force-x", "force-y")

    kept = [p for p in scene.probes if is_solid(p) == (side == "solid")]
    names = {p.name for p in kept}
    goal = scene.goal if scene.goal and scene.goal.probe in names else None
    references = [r for r in scene.references if r.probe in names]
    return scene.model_copy(update={"probes": kept, "references": references, "goal": goal})


def run_alone(
    scene: Scene, case: str, side: str, factory: Factory, out: Path | None, threads: int, quiet: bool
) -> Record:
    """Run the `side` ("fluid" or "solid") of a scene without its partner; returns the finished record.

    A fluid holds the solid bodies still; a structure has no fluid.
    """
    if getattr(scene, side) is None:
        other = "solid" if side == "fluid" else "fluid"
        raise BadInput(f"scene {case!r} has no [{side}] table: run it with {other}-solver, or add the table")
    scene = own_probes(scene, side)
    run_dir = new_run_directory(out, case)
    with Record(run_dir, scene, case, {side: threads}, quiet) as record:
        participant = Participant(factory(scene, False, threads), side, run_dir / f"{side}.vtkhdf")
        try:
            description = participant.describe()
            rows = probe_rows(scene)
            clock = Clock(scene.end_time, max(rows, scene.output.frames))
            still = Kinematics.at_rest(description.position) if side == "fluid" else None
            everything = np.arange(len(description.position))
            _, probes = participant.start(clock, everything, still, frames=scene.output.frames, probe_rows=rows)
            record.at(0.0, probes)
            for window in map(clock.window, range(clock.count)):
                participant.advance(window, still)
                record.at(window.t1, participant.accept())
        finally:
            participant.close()
            cost = participant.finish()
            record.cost |= {"core_s": cost.pop("core_s"), side: cost}
    return record
