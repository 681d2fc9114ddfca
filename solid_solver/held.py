"""Fixed points of a body: where its clamps hold them, and how a clamp's motion table moves them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shared.motion_table import MotionTable
from shared.schema import Clamp
from solid_solver.rigid_points import moved


class HeldPoints:
    """Points (m, 2) [m] held by clamps: `groups` of a clamp and its points, in storage order."""

    def __init__(self, groups: Sequence[tuple[Clamp, np.ndarray]]):
        self._parts = [(MotionTable(c.motion) if c.motion else None, points) for c, points in groups]
        self.count = sum(len(points) for _, points in groups)
        self.moving = any(c.motion for c, _ in groups)

    def places(self, times: np.ndarray) -> np.ndarray:
        """Places (k, 2, m) at `times` (k,) [s]; (k, 2, 0) where nothing moves."""
        if not self.moving:
            return np.zeros((len(times), 2, 0))
        return np.array([np.concatenate([_at(table, points, t) for table, points in self._parts]).T for t in times])


def _at(table: MotionTable | None, points: np.ndarray, time: float) -> np.ndarray:
    return points if table is None else points + moved(points - table.about, table.at(time))[0]
