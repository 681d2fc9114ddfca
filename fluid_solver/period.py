"""Periodic intervals of a scene. Symbols: period (2, 2) [m], lower and upper bound along x and y, equal for none."""

from __future__ import annotations

import numpy as np

from shared.schema.scene import Scene


def period_of(scene: Scene) -> np.ndarray:
    """Lower and upper bound (2, 2) [m] of the periodic interval along x and y; both zero where there is none."""
    periodic = scene.fluid.periodic
    return np.array([periodic.x or (0.0, 0.0), periodic.y or (0.0, 0.0)])


def within_period(scene: Scene, position: np.ndarray) -> np.ndarray:
    """Which of the points (n, 2) [m] lie in the period: those beyond would stand on the images of others."""
    period, tie = period_of(scene), 1e-6 * scene.fluid.dx
    inside = (position >= period[:, 0] - tie) & (position < period[:, 1] - tie)
    return np.all(inside | (period[:, 0] == period[:, 1]), axis=1)


def wrapped(position: np.ndarray, period: np.ndarray) -> np.ndarray:
    """The points (n, 2) [m], each as its image within the period."""
    length = period[:, 1] - period[:, 0]
    return np.where(
        length > 0.0, period[:, 0] + np.mod(position - period[:, 0], np.where(length > 0.0, length, 1.0)), position
    )
