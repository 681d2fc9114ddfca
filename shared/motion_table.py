"""Prescribed rigid motion by a time table: translation, and rotation about a point, by a monotone cubic."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from shared.schema import Motion


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
