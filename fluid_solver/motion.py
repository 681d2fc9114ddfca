"""Motion of ghosts: walls by the scene's tables, structures by what they say of the window.

A pose (n, 8) holds position, velocity, acceleration and normal of n ghosts: x, y, u, v, ax, ay, nx, ny.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from scipy.interpolate import PchipInterpolator

from fluid_solver.cells import BLOCK
from fluid_solver.fields import AX, AY, FLUID, PARKED, U, V, X, Y
from shared.jit import inline_njit, njit, parallel_njit
from shared.schema import Motion

POSE = 8


class WallMotion:
    """A wall's prescribed motion: translation and rotation about a point, a monotone cubic through the table."""

    def __init__(self, motion: Motion, reference: np.ndarray, normal: np.ndarray):
        """`reference` (n, 2) [m], `normal` (n, 2): of the wall's ghosts in the reference position."""
        self._normal = normal
        self._arm = reference - np.asarray(motion.about)
        self._about = np.asarray(motion.about)
        self._end = motion.times[-1]
        self._curve = _curve(motion)

    def pose(self, time: float) -> np.ndarray:
        """Pose (n, 8) of the ghosts at `time` [s]."""
        (x, y, angle), (u, v, spin), (ax, ay, turn) = (self._at(time, order) for order in range(3))
        c, s = math.cos(angle), math.sin(angle)
        turned = np.array([[c, s], [-s, c]])
        arm = self._arm @ turned
        across = np.c_[-arm[:, 1], arm[:, 0]]
        return np.c_[
            self._about + arm + (x, y),
            spin * across + (u, v),
            turn * across - spin * spin * arm + (ax, ay),
            self._normal @ turned,
        ]

    def _at(self, time: float, order: int) -> np.ndarray:
        if time > self._end and order > 0:
            return np.zeros(3)
        return self._curve(min(time, self._end), order)


def largest_speed(motion: Motion) -> float:
    """Largest translation speed [m/s] of a motion."""
    times = np.linspace(0.0, motion.times[-1], 1001)
    return float(np.hypot(*_curve(motion)(times, 1)[:, :2].T).max())


def _curve(motion: Motion) -> PchipInterpolator:
    """x, y [m] and angle [rad] over time."""
    n = len(motion.times)
    shift = np.zeros((n, 2)) if motion.translation is None else np.asarray(motion.translation, dtype=float)
    angle = np.zeros(n) if motion.rotation is None else np.radians(motion.rotation)
    return PchipInterpolator(motion.times, np.c_[shift, angle])


@njit
def structure_pose(s, length, x0, v0, x1, v1, acceleration, pose):
    """Pose of structure ghosts at the fraction `s` of a window of `length` [s], in place in `pose` (n, 8).

    Cubic Hermite from start and end positions and velocities (n, 2), so that the wall never jumps; acceleration the
    mean over the window: the raw one destabilises light structures.
    """
    for i in range(len(x0)):
        for k in range(2):
            a = 2.0 * (x0[i, k] - x1[i, k]) + length * (v0[i, k] + v1[i, k])
            b = 3.0 * (x1[i, k] - x0[i, k]) - length * (2.0 * v0[i, k] + v1[i, k])
            pose[i, k] = x0[i, k] + s * (length * v0[i, k] + s * (b + s * a))
            pose[i, 2 + k] = v0[i, k] + s * (2.0 * b + 3.0 * s * a) / length
            pose[i, 4 + k] = acceleration[i, k]


@parallel_njit
def place_ghosts(S, kind, ids, count, grid, first, pose):
    """Set position, velocity and acceleration of all ghosts from `pose` (ghosts, 8), by id less `first`.

    In a periodic direction a ghost keeps to the image that its cell holds.
    """
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] != FLUID and kind[i] != PARKED:
                at = ids[i] - first
                S[X, i] = nearest_image(pose[at, 0], S[X, i], grid.period_x)
                S[Y, i] = nearest_image(pose[at, 1], S[Y, i], grid.period_y)
                S[U, i] = pose[at, 2]
                S[V, i] = pose[at, 3]
                S[AX, i] = pose[at, 4]
                S[AY, i] = pose[at, 5]


@inline_njit
def nearest_image(x, near, period):
    """`x` [m], or that of its images a whole number of periods away that is nearest to `near`."""
    return x + period * np.rint((near - x) / period) if period > 0.0 else x
