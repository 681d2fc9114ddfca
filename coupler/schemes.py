"""Coupling schemes, each readable as the order of events in one window."""

from __future__ import annotations

from collections.abc import Iterator

from coupler.ledger import Ledger
from coupler.mapping import Mapping
from coupler.prediction import Predictor
from coupler.remote import Remote
from shared.clock import Clock, Window
from shared.contract import Kinematics, Loads

Probes = dict[str, float]


def serial_explicit(
    fluid: Remote,
    structure: Remote,
    mapping: Mapping,
    clock: Clock,
    motion: Kinematics,
    loads: Loads,
    order: int,
    ledger: Ledger,
) -> Iterator[tuple[Window, Probes | None]]:
    """Structure first, under a predicted mean load; then the fluid on the structure's true motion; no iteration.

    `motion`: the points at t = 0; `loads`: the ghosts' loads at t = 0; `order` of the prediction. Yields each accepted
    window with the probes' row, or None where no row is due. Stability: DESIGN's serial protocol on an absorbing
    column holds up to α = ρ_f c Δt/(ρ_s t) = 2, 1.155, 0.709 for order 0, 1, 2.
    """
    past = Predictor(order, mapping.loads(loads))
    ghosts = mapping.motion(motion)
    for window in map(clock.window, range(clock.count)):
        # 1. predict the mean load
        predicted = past.predict()
        # 2. the structure moves under it
        moved = structure.advance(window, predicted)
        # 3. the fluid follows the true motion
        ghosts_moved = mapping.motion(moved)
        found = fluid.advance(window, ghosts_moved)
        mapped = mapping.loads(found)
        # 4. accept
        probes = accept(structure, fluid)
        past.add(mapped)
        ledger.record(window, 1, predicted, mapped, found, (motion, moved), (ghosts, ghosts_moved))
        motion, ghosts = moved, ghosts_moved
        yield window, probes


def accept(*sides: Remote) -> Probes | None:
    """All sides make the window final, at the same time; their probes as one row, or None when none is due."""
    for side in sides:
        side.begin_accept()
    due = [row for row in [side.end_accept() for side in sides] if row is not None]
    return {name: value for row in due for name, value in row.items()} if due else None
