"""Records of what the two sides are told, for `--replay`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np

from coupler.schemes import Coupled, Outcome
from shared.clock import Clock, Window
from shared.contract import exchange_fields
from shared.run.checkpoint import Checkpoint
from shared.run.recording import Recorder, recording_of


class Recording:
    """Both sides' recordings; `sides` is empty when the scene asks for none."""

    def __init__(self, sides: dict[str, Recorder]):
        self._sides = sides

    def begin(self, c: Coupled, clock: Clock, frames: int, probe_rows: int) -> None:
        """What both sides are told before the first window."""
        info = {"end": clock.end, "windows": clock.count, "rollback": False, "frames": frames, "probe_rows": probe_rows}
        ghosts = np.arange(c.mapping.matrix.shape[0])
        fields = {
            "fluid": {"selection": ghosts, **exchange_fields(c.ghosts)},
            "solid": {"selection": np.asarray(c.mapping.selection)},
        }
        for side, recorder in self._sides.items():
            recorder.add("describe")
            recorder.add("start", info=info, fields=fields[side])

    def add(self, window: Window, outcome: Outcome) -> None:
        """An accepted window: the motion that the fluid followed, the loads that the structure took."""
        told = {"fluid": outcome.ghosts[1], "solid": outcome.used}
        where = {"window": window.index, "t0": window.t0, "t1": window.t1}
        for side, recorder in self._sides.items():
            recorder.add("advance", info={"final": True}, fields=exchange_fields(told[side]), **where)

    def flush(self) -> None:
        """Bring both to the disk."""
        for recorder in self._sides.values():
            recorder.flush()


@contextmanager
def recording(run_dir: Path, wanted: bool, last: Checkpoint | None) -> Iterator[Recording]:
    """The recordings of a run, new or as they were at the checkpoint `last`."""
    with ExitStack() as stack:
        sides = {}
        for side in ("fluid", "solid") if wanted else ():
            sides[side] = Recorder(recording_of(run_dir, side), last and last.window)
            stack.callback(sides[side].close)
        yield Recording(sides)
