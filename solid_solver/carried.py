"""Bodies of particles that a prescribed rigid motion carries, from the places to which they are stretched at t = 0."""

from __future__ import annotations

import numpy as np

from shared.geometry.motion_table import MotionTable
from shared.schema.geometry import Motion
from solid_solver.rigid_points import moved


class Carried:
    """The motion of points whose places at t = 0, before the motion, are `place` (n, 2) [m]."""

    def __init__(self, motion: Motion, place: np.ndarray):
        self._table = MotionTable(motion)
        self._place = place

    def at(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Place, velocity and acceleration, each (n, 2), at `time` [s]."""
        displacement, velocity, acceleration = moved(self._place - self._table.about, self._table.at(time))
        return self._place + displacement, velocity, acceleration
