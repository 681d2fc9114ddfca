"""What a coupled run remembers from window to window, put into a checkpoint and taken out of it again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from coupler.schemes import Coupled
from coupler.window import Plan
from shared.clock import Window
from shared.run.checkpoint import Checkpoint, Checkpoints, State, inside, misfit, read_state, under, write_state

PART = "run"
"""The coupler's own part of a checkpoint."""


class Remembers(Protocol):
    """Whatever the future depends on."""

    def state(self) -> State: ...

    def restore(self, state: State) -> None: ...


def remember(
    memory: Mapping[str, Remembers], plan: Plan, checkpoints: Checkpoints, window: Window, notes: Mapping[str, Any]
) -> None:
    """Write the checkpoint before `window`: both sides at the same time, the coupler's own part, then the manifest."""
    folder = checkpoints.begin(window.index)
    c: Coupled = memory["coupled"]
    sides = (c.structure, c.fluid)
    for side in sides:
        side.begin_save(folder / f"{side.name}.h5")
    states = [under(name, one.state()) for name, one in memory.items()]
    write_state(folder / f"{PART}.h5", {name: array for state in states for name, array in state.items()})
    for side in sides:
        side.end_save()
    checkpoints.seal(folder, window.index, window.t0, {**notes, "reasons": plan.reasons})


def recall(memory: Mapping[str, Remembers], plan: Plan, last: Checkpoint) -> dict[str, float]:
    """Go back to the checkpoint `last`; the sides load their own parts. Returns the counts so far. Raises BadInput."""
    path = last.part(PART)
    state = read_state(path)
    try:
        for name, one in memory.items():
            one.restore(inside(name, state))
        plan.reasons[:] = last.notes["reasons"]
        return dict(last.notes["counts"])
    except (KeyError, TypeError, ValueError) as error:
        raise misfit(path, error) from None
