"""Points of a rigid body: rotation is exact, so that distances between them never change."""

from __future__ import annotations

import math

import numpy as np


def moved(arm: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Displacement, velocity and acceleration, (3, n, 2), of points at `arm` (n, 2) [m] from the centre.

    `pose` (3, 3): the centre's displacement x, y [m] and the angle [rad], their rates, their second rates.
    """
    angle, spin, turn = pose[:, 2]
    c, s = math.cos(angle), math.sin(angle)
    fall = -2.0 * math.sin(0.5 * angle) ** 2  # cos − 1 without cancellation
    carried = arm @ np.array([[fall, s], [-s, fall]])
    radius = arm @ np.array([[c, s], [-s, c]])
    across = np.stack([-radius[:, 1], radius[:, 0]], axis=1)
    return np.stack(
        [
            pose[0, :2] + carried,
            pose[1, :2] + spin * across,
            pose[2, :2] + turn * across - spin * spin * radius,
        ]
    )


def lattice_momenta(mass: float, place: np.ndarray, velocity: np.ndarray) -> tuple[float, float, float]:
    """Momentum along x and y [N s/m], and angular momentum about the origin [N s], of points of `mass` [kg/m] each."""
    spin = np.sum(place[:, 0] * velocity[:, 1] - place[:, 1] * velocity[:, 0])
    return (*(mass * velocity.sum(axis=0)).tolist(), float(mass * spin))
