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
from shared.sides import own_probes, probe_rows
from shared.warm import fill_cache

Factory = Callable[[Scene, bool, int], Model]


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
        fill_cache({side: f"{side}_solver"}, run_dir / "case.toml", scene)
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
