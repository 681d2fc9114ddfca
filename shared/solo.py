"""One side alone: the same participant as in a coupled run, stepped without a partner."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from shared.checkpoint import Checkpoint, Checkpoints
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
        _march(scene, side, factory, threads, record)
    return record


def resume_alone(
    run_dir: Path, last: Checkpoint, scene: Scene, side: str, factory: Factory, threads: int | None, quiet: bool
) -> Record:
    """Go on with a run of `run_alone` from its checkpoint `last`, to the same bytes."""
    threads = threads or last.notes["threads"][side]
    with Record(run_dir, scene, last.notes["case"], {side: threads}, quiet, last) as record:
        _march(scene, side, factory, threads, record, last)
    return record


def _march(
    scene: Scene, side: str, factory: Factory, threads: int, record: Record, last: Checkpoint | None = None
) -> None:
    """From t = 0, or from a checkpoint, to the end."""
    fill_cache({side: f"{side}_solver"}, record.run_dir / "case.toml", scene)
    participant = Participant(factory(scene, False, threads), side, record.run_dir / f"{side}.vtkhdf")
    checkpoints = Checkpoints(record.run_dir, scene.output.checkpoint_every, last)
    try:
        description = participant.describe()
        rows, frames = probe_rows(scene), scene.output.frames
        clock = Clock(scene.end_time, max(rows, frames))
        still = Kinematics.at_rest(description.position) if side == "fluid" else None
        everything = np.arange(len(description.position))
        resumed = last is not None
        _, probes = participant.start(clock, everything, still, frames=frames, probe_rows=rows, resumed=resumed)
        if last is None:
            record.at(0.0, probes)
        else:
            participant.load(last.part(side))
        for window in map(clock.window, range(last.window if last else 0, clock.count)):
            if checkpoints.due():
                folder = checkpoints.begin(window.index)
                participant.save(folder / f"{side}.h5")
                checkpoints.seal(folder, window.index, window.t0, record.notes())
            participant.advance(window, still)
            record.at(window.t1, participant.accept())
    finally:
        participant.close()
        cost = participant.finish()
        record.cost |= {"core_s": cost.pop("core_s"), side: cost}
