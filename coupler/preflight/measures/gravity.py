"""Which way is up."""

from __future__ import annotations

import numpy as np

from shared.geometry.segments import right_of
from shared.schema.scene import Scene


def upward(scene: Scene) -> np.ndarray:
    """Direction (2,) against gravity; none without."""
    g = np.asarray(scene.gravity, dtype=float)
    return -g / np.hypot(*g) if g.any() else np.zeros(2)


def across_and_up(up: np.ndarray) -> np.ndarray:
    """Directions (2, 2) across gravity and against it, as columns."""
    return np.stack([right_of(up), up], axis=1)
