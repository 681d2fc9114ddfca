"""What the models share that step no particles: a beam's sections or a rigid body carry the points of the lattice.

A model says what moves (`_build`), how it takes its steps (`_step`), and where its points then are (`_moved`); the
contract follows from that.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads
from shared.schema.scene import Scene
from solid_solver.filled import filled_bodies
from solid_solver.interface import describe, kinematics_over_window
from solid_solver.probes import body_probes, largest_speed


class PointModel(ABC):
    """A structure whose points stand at `_reference` (n, 2) [m] when at rest; `_points` (3, n, 2): their present
    displacement, velocity and acceleration; `_sound`: whether all steps could be taken."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene, self._bodies = scene, filled_bodies(scene)
        self._reference = np.concatenate([body.position for body in self._bodies])
        self._time, self._steps, self._sound = 0.0, 0, True
        self._stable_step = self._build()
        of_body = {"max-speed": lambda k: largest_speed(self._velocity(k)), **self._of_body()}
        self._probes = body_probes(scene, self._at_point(), of_body)
        self._points = self._moved()

    # ---- what a model says ------------------------------------------------------------------------------------

    @abstractmethod
    def _build(self) -> float:
        """Make what moves; the stable step [s]."""

    @abstractmethod
    def _step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        """Take steps of `dt` [s] about the times `middles` under `force` (n, 2) [N/m] on the points; whether all could
        be taken."""

    @abstractmethod
    def _moved(self) -> np.ndarray:
        """Displacement, velocity and acceleration (3, n, 2) of the points."""

    def _arrays(self) -> dict[str, np.ndarray]:
        """What the future depends on besides the time (views)."""
        return {}

    @abstractmethod
    def _at_point(self) -> dict:
        """Quantities of material points, see `body_probes`."""

    @abstractmethod
    def _of_body(self) -> dict:
        """Quantities of bodies, see `body_probes`."""

    def _stresses(self) -> dict[str, np.ndarray]:
        """Stress fields (n,) [Pa] of a frame."""
        return {}

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self._stable_step)

    def begin(self, motion: Kinematics | None) -> Kinematics:
        _, velocity, acceleration = self._points
        return Kinematics(self._place(), velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        return self._stable_step

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        dt = (t1 - t0) / substeps
        start = self._place(), self._points[1]
        force = boundary.force if isinstance(boundary, Loads) else None
        self._sound &= self._step(t0 + dt * (np.arange(substeps) + 0.5), dt, force)
        self._steps += substeps
        self._time = t1
        self._points = self._moved()
        return kinematics_over_window(start, (self._place(), self._points[1]), self._points[2], t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        return {"time": np.array([self._time]), **self._arrays()}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        for name, array in self._arrays().items():
            array[...] = state[name]
        self._time, self._sound = float(state["time"][0]), True
        self._points = self._moved()

    def probe_values(self) -> dict[str, float]:
        return {name: value() for name, value in self._probes.items()}

    def frame(self) -> Frame:
        displacement, velocity, _ = self._points
        return Frame(self._place(), {"displacement": displacement, "velocity": velocity, **self._stresses()})

    def particles(self) -> int:
        return len(self._reference)

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def _place(self) -> np.ndarray:
        return self._reference + self._points[0]

    def _velocity(self, k: int) -> np.ndarray:
        """Velocity (m, 2) [m/s] of the points of body number k."""
        return self._points[1][self._bodies[k].own]
