"""Held points of a body: where its clamps hold them, and how a clamp's motion table moves them.

A clamp carries its points rigidly: their displacement is that of the clamp's centre plus (R − 1) times their distance
from it, R the rotation: a combination of the fields 1, x − x_c and y − y_c, of sizes that depend on the time alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shared.geometry.motion_table import MotionTable
from shared.schema.solid import Clamp
from solid_solver.rigid_points import moved

FIELDS = 3
"""Fields of one moving clamp."""


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


@dataclass(frozen=True)
class MovingClamp:
    """A clamp that follows its `table`; `centre` (2,) [m] of its points."""

    table: MotionTable
    centre: np.ndarray

    def fields(self, points: np.ndarray) -> np.ndarray:
        """Its fields (m, 3) at reference `points` (m, 2) [m]."""
        return np.column_stack([np.ones(len(points)), points - self.centre])

    def sizes(self, times: np.ndarray) -> np.ndarray:
        """Sizes (k, 3, 2) of its fields in each component of the displacement at `times` (k,) [s]."""
        shift, angle = np.split(self.table.displacements(times), [2], axis=1)
        fall, sine = -2.0 * np.sin(0.5 * angle) ** 2, np.sin(angle)  # cos − 1 without cancellation
        columns = np.stack([np.hstack([fall, sine]), np.hstack([-sine, fall])], axis=1)
        centre = shift + (self.centre - self.table.about) @ columns
        return np.concatenate([centre[:, None], columns], axis=1)


def sizes(clamps: Sequence[MovingClamp], times: np.ndarray) -> np.ndarray:
    """Sizes (k, 3 clamps, 2) of the fields of all `clamps` at `times` (k,) [s]."""
    return np.concatenate([np.zeros((len(times), 0, 2)), *(clamp.sizes(times) for clamp in clamps)], axis=1)
