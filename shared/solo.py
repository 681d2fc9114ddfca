"""One side alone: the same participant as in a coupled run, stepped without a partner."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from shared.clock import Clock
from shared.contract import BadInput, Kinematics, Model, ParticipantLost, ShearwaterError
from shared.participant import Participant, own_faces
from shared.run.checkpoint import Checkpoint, Checkpoints
from shared.run.record import Record
from shared.run.recording import BEFORE_WINDOWS, RUN, messages, recording_of
from shared.run.results import new_run_directory
from shared.run.resume import Unfinished
from shared.scene.sides import own_probes, probe_rows
from shared.schema.scene import Scene
from shared.service import Service
from shared.stopping import stopping_between_windows
from shared.warm import fill_cache
from shared.wire import BadMessage, Message, decode

Factory = Callable[[Scene, bool, int], Model]


def run_alone(
    scene: Scene,
    case: str,
    side: str,
    factory: Factory,
    out: Path | None,
    threads: int,
    quiet: bool,
    preflight: Mapping[str, Any] | None = None,
) -> Record:
    """Run the `side` ("fluid" or "solid") of a scene without its partner; returns the finished record.

    A fluid holds the solid bodies still; a structure has no fluid. `preflight`: what the record is to hold of it.
    """
    _need_side(scene, case, side)
    scene = own_probes(scene, side)
    run_dir = new_run_directory(out, case)
    with Record(run_dir, scene, case, {side: threads}, quiet) as record:
        record.preflight |= preflight or {}
        _march(scene, side, factory, threads, record)
    return record


def _need_side(scene: Scene, case: str, side: str) -> None:
    if getattr(scene, side) is None:
        other = "solid" if side == "fluid" else "fluid"
        raise BadInput(f"scene {case!r} has no [{side}] table: run it with {other}-solver, or add the table")


def resume_alone(cut: Unfinished, side: str, factory: Factory, threads: int | None, quiet: bool) -> Record:
    """Go on with a run of `run_alone` from its last checkpoint, to the same bytes."""
    scene, last = cut.scene, cut.last
    threads = threads or last.notes["threads"][side]
    with Record(cut.run_dir, scene, last.notes["case"], {side: threads}, quiet, last, cut.held) as record:
        record.preflight |= last.notes["preflight"]
        _march(scene, side, factory, threads, record, last)
    return record


def replay_alone(
    scene: Scene,
    case: str,
    side: str,
    factory: Factory,
    out: Path | None,
    threads: int,
    quiet: bool,
    recorded: Path,
) -> Record:
    """Run the `side` of a coupled scene as its partner drove it in the run whose directory is `recorded`.

    The frames and probes are those of that run, to the byte, unless the scene has been changed. Raises BadInput where
    the recording does not fit the scene, and ParticipantLost, with all replayed that there is, where it ends too soon.
    """
    _need_side(scene, case, side)
    source = recording_of(recorded, side)
    told = _told(source, scene.end_time)
    scene = own_probes(scene, side)
    run_dir = new_run_directory(out, case)
    with Record(run_dir, scene, case, {side: threads}, quiet) as record:
        fill_cache({side: f"{side}_solver"}, run_dir / "case.toml", scene)
        model = factory(scene, True, threads)
        participant = Participant(model, side, run_dir / f"{side}.vtkhdf", own_faces(scene, model))
        service = Service(participant, RUN)
        with _finishing(participant, record):
            for data in told:
                reply = decode(service.handle(data))
                if reply.verb == "error":
                    raise _refusal(reply, source)
                if reply.verb != "describe":
                    record.at(reply.t1, reply.info.get("probes"))
        if reply.t1 < scene.end_time:
            raise ParticipantLost(
                f"the recording {source} ends at t = {reply.t1:.6g} s of end_time = {scene.end_time:g} s, and the "
                f"replay with it: its run was cut short. Go on with that first: coupler resume {recorded}"
            )
    return record


def _told(source: Path, end_time: float) -> Iterator[bytes]:
    """The messages of the recording `source`. Raises BadInput where it is of a run that ended before `end_time` [s]."""
    told = messages(source)
    first = list(itertools.islice(told, BEFORE_WINDOWS))
    if not first:
        raise BadInput(f"The recording {source} is empty.")
    end = decode(first[-1]).info.get("end", end_time)
    if end_time > end:
        raise BadInput(
            f"The recording {source} is of a run to end_time = {end:g} s; end_time = {end_time:g} s is beyond it. "
            "Replay it with the end_time of its run, or record a longer run."
        )
    return itertools.chain(first, told)


def _refusal(reply: Message, source: Path) -> ShearwaterError:
    text = reply.info["text"]
    if reply.info["kind"] == BadMessage.__name__:
        return BadInput(f"The recording {source} does not fit this scene: {text}. Replay it with the scene of its run.")
    error = ShearwaterError(text)
    error.exit_code = reply.info["exit_code"]
    return error


def _march(
    scene: Scene, side: str, factory: Factory, threads: int, record: Record, last: Checkpoint | None = None
) -> None:
    """From t = 0, or from a checkpoint, to the end."""
    fill_cache({side: f"{side}_solver"}, record.run_dir / "case.toml", scene)
    participant = Participant(factory(scene, False, threads), side, record.run_dir / f"{side}.vtkhdf")
    checkpoints = Checkpoints(record.run_dir, scene.output.checkpoint_every, last)
    with _finishing(participant, record):
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
        with stopping_between_windows() as stop:
            for window in map(clock.window, range(last.window if last else 0, clock.count)):
                if checkpoints.due(stop.asked):
                    folder = checkpoints.begin(window.index)
                    participant.save(folder / f"{side}.h5")
                    checkpoints.seal(folder, window.index, window.t0, record.notes())
                stop.here()
                participant.advance(window, still)
                record.at(window.t1, participant.accept())


@contextlib.contextmanager
def _finishing(participant: Participant, record: Record) -> Iterator[None]:
    """Finish at the end, come what may, and keep what it cost."""
    try:
        yield
    finally:
        cost = participant.finish()
        record.cost |= {"core_s": cost.pop("core_s"), participant.name: cost}
