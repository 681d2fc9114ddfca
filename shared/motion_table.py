"""Prescribed rigid motion by a time table: translation, and rotation about a point, by a monotone cubic."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from shared.schema_geometry import Motion

_SAMPLES = 1001  # times at which a motion's speed is looked at


class MotionTable:
    """A scene's `Motion` as a function of time; held after its last time."""

    def __init__(self, motion: Motion):
        count = len(motion.times)
        shift = np.zeros((count, 2)) if motion.translation is None else np.asarray(motion.translation, dtype=float)
        angle = np.zeros(count) if motion.rotation is None else np.radians(motion.rotation)
        self.about = np.asarray(motion.about, dtype=float)
        self._end = motion.times[-1]
        self._curve = PchipInterpolator(motion.times, np.c_[shift, angle])

    def at(self, time: float) -> np.ndarray:
        """Displacement x, y [m] and angle [rad], their rates and their second rates, by row (3, 3), at `time` [s]."""
        orders = range(3) if time <= self._end else range(1)
        result = np.zeros((3, 3))
        for order in orders:
            result[order] = self._curve(min(time, self._end), order)
        return result

    def displacements(self, times: np.ndarray) -> np.ndarray:
        """Displacement x, y [m] and angle [rad], (k, 3), at `times` (k,) [s]."""
        return self._curve(np.minimum(times, self._end))


def largest_speed(motion: Motion, corners: np.ndarray) -> float:
    """A bound of the speed [m/s] of the points `corners` (n, 2) [m]: translation, and rotation at the farthest."""
    table = MotionTable(motion)
    reach = float(np.hypot(*(np.asarray(corners, dtype=float) - table.about).T).max())
    rates = np.array([table.at(time)[1] for time in np.linspace(0.0, motion.times[-1], _SAMPLES)])
    return float(np.max(np.hypot(rates[:, 0], rates[:, 1]) + reach * np.abs(rates[:, 2])))
