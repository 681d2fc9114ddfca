"""A participant: a physical model behind the verbs of the contract.

The model knows physics only. `Participant` watches the order of the verbs, chooses the sub-steps at the start of a
window, keeps the copy that `rollback` returns to, writes frames and evaluates probes when a window is accepted.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from shared.clock import Clock, Window
from shared.contract import (
    TAKES,
    Description,
    EarlyModel,
    Exchange,
    Kinematics,
    LeakyModel,
    Loads,
    Model,
    OutOfOrder,
    exchange_fields,
    exchange_shapes,
)
from shared.costs import Costs
from shared.face_loads import FaceLoads
from shared.run.checkpoint import inside, misfit, read_state, under, write_state
from shared.run.results import peak_mib
from shared.run.vtkhdf import FrameWriter
from shared.schema.scene import Scene

log = logging.getLogger("shearwater")

_OUTGROWN = 1.25  # a sub-step this much longer than the stable step at the window's end is noted in the log


class Participant:
    """One side of a run. `output`: path of its VTKHDF file, or None for no frames.

    `faces`: a structure that takes pressures instead of forces integrates them over these.
    """

    def __init__(self, model: Model, name: str, output: Path | None = None, faces: FaceLoads | None = None):
        self.model = model
        self._faces = faces
        self._places: tuple[np.ndarray, np.ndarray] | None = None  # own points at the window's start, and at its end
        self.name = name
        self._output = output
        self._writer: FrameWriter | None = None
        self._early = isinstance(model, EarlyModel)
        self._unsettled: Window | None = None  # what the model has reached the end of, but not settled
        self._stage = "new"  # new → described → ready ⇄ advanced → finished
        self._next = 0  # number of the next window to be accepted
        self._substeps = 0
        self._limit: float | None = None  # stable step [s] where the last window ended, if known
        self._saved: dict[str, np.ndarray] | None = None
        self._costs = Costs()

    # ---- the verbs --------------------------------------------------------------------------------------------

    def describe(self) -> Description:
        """What this side is; allowed at any time before `finish`."""
        self._need(self._stage != "finished", "describe", "the participant has finished")
        if self._stage == "new":
            self._stage = "described"
        return self.model.describe()

    def start(
        self,
        clock: Clock,
        selection: np.ndarray,
        motion: Kinematics | None = None,
        *,
        rollback: bool = False,
        frames: int = 1,
        probe_rows: int = 1,
        resumed: bool = False,
    ) -> tuple[Exchange, dict[str, float]]:
        """Begin at t = 0; returns the own initial data on the selected points and the probes' first row.

        `selection` (k,): the interface points that travel. `frames`, `probe_rows`: numbers of outputs after the
        first, evenly over the run. `resumed`: `load` comes next, so that the first frame stands already.
        """
        self._need(self._stage == "described", "start", "describe must come first, and start only once")
        self._clock, self._selection, self._rollback = clock, np.asarray(selection), rollback
        self._whole = np.array_equal(self._selection, np.arange(len(self.model.describe().position)))
        self._frames, self._probe_rows = frames, probe_rows
        self._points = len(self.model.describe().position)
        own = self.model.begin(motion)
        self.model.check()
        if self._output is not None:
            self._writer = FrameWriter(self._output)
            if not resumed:
                self._writer.append(0.0, self.model.frame())
        self._stage = "ready"
        self._costs.begin()
        if self._faces is not None:
            self._places = own.position.copy(), own.position.copy()
        return self._selected(own), self.model.probe_values()

    def advance(self, window: Window, boundary: Exchange | None, final: bool = False) -> Exchange:
        """Integrate over `window` under the partner's data on the selected points; returns the own data there.

        `final`: this will be accepted, whatever comes of it, so that nothing is kept for `rollback`.
        """
        self._need(self._stage == "ready", "advance", self._why_not_ready())
        self._need(window.index == self._next, "advance", f"window {self._next} is next, not window {window.index}")
        self.settle()
        with self._costs.stepping():
            if window.iteration == 0:
                self._substeps = window.substeps(self.model.stable_step() if self._limit is None else self._limit)
            if self._rollback and self._saved is None and not final:
                self._saved = {name: np.copy(array) for name, array in self.model.state().items()}
            take = self.model.reach if self._early else self.model.advance
            own = take(window.t0, window.t1, self._substeps, self._spread(boundary))
            self.model.check()
        self._unsettled = window
        self._stage = "advanced"
        if self._places is not None:
            self._places = self._places[0], own.position.copy()
        return self._selected(own)

    def settle(self) -> None:
        """Do what the model has left undone of an accepted window, while the partner works; else the next verb does
        it."""
        if self._unsettled is None or self._stage != "ready":
            return
        with self._costs.stepping():
            if self._early:
                self.model.settle()
            self._note_outgrown(self._unsettled)
        self._unsettled = None

    def rollback(self) -> None:
        """Back to the window's start, bit for bit."""
        self._need(self._stage == "advanced", "rollback", "there is no advance to take back")
        self._need(self._rollback, "rollback", "start did not ask for rollback")
        self._need(self._saved is not None, "rollback", "the window was advanced as final")
        self.model.restore(self._saved)
        self._limit, self._unsettled, self._stage = None, None, "ready"

    def accept(self) -> dict[str, float] | None:
        """Make the window final: writes the frame due; returns the probes when a row is due."""
        self._need(self._stage == "advanced", "accept", "there is no advanced window to accept")
        index = self._next
        if self._places is not None:
            self._places = self._places[1], self._places[1]
        self._next, self._saved, self._stage = index + 1, None, "ready"
        frame = self._writer is not None and self._clock.crosses(index, self._frames)
        row = self._clock.crosses(index, self._probe_rows)
        if not frame and not row:
            return None
        self.settle()
        with self._costs.output():
            self.model.check()
            if frame:
                self._writer.append(self._clock.time(index + 1), self.model.frame())
            return self.model.probe_values() if row else None

    def save(self, path: str | Path) -> None:
        """Write the complete state, and what it has cost so far, to the HDF5 file `path`."""
        self._need(self._stage == "ready", "save", self._why_not_ready())
        self.settle()
        with self._costs.output():
            costs = {n: np.array(v) for n, v in self._costs.so_far(self.model.steps()).items()}
            state = under("model", self.model.state()) | under("cost", costs)
            if self._places is not None:
                state["places"] = self._places[0]
            write_state(Path(path), state | {"window": np.array(self._next)})

    def load(self, path: str | Path) -> None:
        """Take the state, and the number of the next window, from the HDF5 file `path`. Raises BadInput."""
        self._need(self._stage == "ready", "load", self._why_not_ready())
        state = read_state(Path(path))
        try:
            self.model.restore(inside("model", state))
            if self._places is not None:
                self._places = (state["places"],) * 2
            self._next = int(state["window"])
            self._costs.go_on_from(inside("cost", state))
        except (KeyError, ValueError) as error:
            raise misfit(path, error) from None
        self._limit = self._saved = None

    def finish(self) -> dict[str, object]:
        """Close the files; returns what this side cost."""
        self._need(self._stage != "finished", "finish", "the participant has finished already")
        self.close()
        self._stage = "finished"
        costs = self._costs.so_far(self.model.steps())
        particles, steps, busy = self.model.particles(), round(costs["steps"]), costs["busy_s"]
        return {
            "model": self.model.describe().model,
            "particles": particles,
            **costs,
            "steps": steps,
            "outgrown_windows": round(costs["outgrown_windows"]),
            "particle_steps_per_s": particles * steps / busy if busy else 0.0,
            "peak_MiB": peak_mib(),
            **(self.model.losses() if isinstance(self.model, LeakyModel) else {}),
        }

    # ---- the books --------------------------------------------------------------------------------------------

    @property
    def spent(self) -> float:
        """Time [s] spent in steps and in output so far."""
        return self._costs.spent

    @property
    def finished(self) -> bool:
        """Whether `finish` has been called."""
        return self._stage == "finished"

    def close(self) -> None:
        """Close the frame file, also after a failure."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def expected_boundary(self) -> Mapping[str, tuple[int, ...]]:
        """Names and shapes of the partner's fields that `advance` needs."""
        return exchange_shapes(TAKES[self.model.role], len(self._selection))

    def _note_outgrown(self, window: Window) -> None:
        """Say so when the state at the window's end wants shorter steps than the window had; the next one has them."""
        step, limit = window.length / self._substeps, self.model.stable_step()
        self._limit = limit
        if step > _OUTGROWN * limit:
            self._costs.outgrown += 1
            log.warning(
                "window %d, t = %.6g s: stable step %.3g s, steps taken %.3g s; the next window takes more of them",
                window.index,
                window.t1,
                limit,
                step,
            )

    def _need(self, holds: bool, verb: str, otherwise: str) -> None:
        if not holds:
            raise OutOfOrder(f"{self.name}: {verb} refused: {otherwise}")

    def _why_not_ready(self) -> str:
        return {
            "new": "describe and start must come first",
            "described": "start must come first",
            "advanced": f"window {self._next} is advanced already: accept it or roll it back first",
            "finished": "the participant has finished",
            "ready": "",
        }[self._stage]

    def _selected(self, exchange: Exchange) -> Exchange:
        """The exchange on the points that travel."""
        if self._whole:
            return exchange
        return type(exchange)(**{n: a.take(self._selection, axis=0) for n, a in exchange_fields(exchange).items()})

    def _spread(self, boundary: Exchange | None) -> Exchange | None:
        """The partner's data on all own points: no load where nothing travels (a fluid's ghosts all travel)."""
        if not isinstance(boundary, Loads) or (self._whole and self._faces is None):
            return boundary
        full = Loads.zero(self._points)
        full.pressure[self._selection] = boundary.pressure
        full.force[self._selection] = boundary.force
        if self._faces is not None:
            return Loads(full.pressure, self._faces.force(full.pressure, self._places[0]))
        return full


def own_faces(scene: Scene, model: Model) -> FaceLoads | None:
    """What a structure of `scene` integrates pressures over, if the scene says so."""
    if model.role == "structure" and scene.coupling.loads == "pressure":
        return FaceLoads(scene, model.describe())
    return None
