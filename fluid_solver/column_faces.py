"""Where columns of water stand: the parts of the structure's faces that a fluid body touches.

Their feet stand in the middles of equal cells, and each column bears what its foot feels. That midpoint rule errs by
second differences over 24, which the outermost four columns at either end of a face take back, of five or more: they
are 9/8, 3/4, 7/6 and 23/24 cells wide. So the work of a pressure on a face that bends is right to fourth order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shared.geometry.particles import fill
from shared.geometry.regions import outline, own_box
from shared.geometry.segments import right_of
from shared.geometry.wetted_faces import load_spacing, wetted_stretches
from shared.schema.geometry import Body
from shared.schema.scene import Scene

_AT_AN_END = np.array([3.0, -6.0, 4.0, -1.0]) / 24.0  # what columns at an end of a face are wider than their cells


@dataclass(frozen=True)
class Patch:
    """Columns on one face: feet `position` (n, 2) [m] a `cell` apart, `width` (n,) of each and common `length` [m],
    `normal` (2,) into the water, `body`: index of the solid body, `lattice` (m, 2): points of the water, `top` [m²/s²]:
    the largest of −g·x over the water, whose level the static pressure is counted from."""

    position: np.ndarray
    cell: float
    width: np.ndarray
    length: float
    normal: np.ndarray
    body: int
    lattice: np.ndarray
    top: float

    def static(self, scene: Scene, points: np.ndarray) -> np.ndarray:
        """Pressure at rest (m,) [Pa] at `points` (m, 2)."""
        if scene.fluid.initial_pressure == "zero":
            return np.zeros(len(points))
        return scene.fluid.density * np.maximum(self.top + points @ np.array(scene.gravity), 0.0)

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Distance (m,) [m] from the region that the columns fill."""
        column, away = self.locate(points)
        beside = np.linalg.norm(points - self.position[column] - away[:, None] * self.normal, axis=1)
        off = np.maximum(-self._height(points), self._height(points) - self.length)
        return np.maximum(beside - 0.5 * self.cell, 0.0) + np.maximum(off, 0.0)

    def locate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nearest column (m,) and the distance (m,) from its foot, within its length."""
        away = np.clip(self._height(points), 0.0, self.length)
        along = (points - self.position[0]) @ right_of(self.normal)
        return np.clip(np.rint(along / self.cell), 0, len(self.position) - 1).astype(int), away

    def _height(self, points: np.ndarray) -> np.ndarray:
        return (points - self.position[0]) @ self.normal


def wetted_patches(scene: Scene) -> list[Patch]:
    """All faces of solid bodies that stand on faces of fluid bodies, which a checked scene has where columns can
    stand."""
    return [patch for body in scene.fluid.bodies for patch in _of_body(scene, body)]


def _of_body(scene: Scene, body: Body) -> list[Patch]:
    gravity, corners = np.array(scene.gravity), outline(body).reshape(-1, 2)
    top, lattice = float(np.max(-corners @ gravity)), fill(body, scene.fluid.dx).position
    found = []
    for s in wetted_stretches(scene, body):
        inward = -right_of(s.along)  # the body is on the left
        count = max(1, round((s.high - s.low) / load_spacing(scene)))
        cell = (s.high - s.low) / count
        feet = s.start + (s.low + (np.arange(count)[:, None] + 0.5) * cell) * s.along
        found.append(Patch(feet, cell, cell * _widths(count), _extent(body, s.side), inward, s.solid, lattice, top))
    return found


def _widths(count: int) -> np.ndarray:
    """Widths (count,) of columns in cells."""
    widths = np.ones(count)
    if count > len(_AT_AN_END):
        widths[: len(_AT_AN_END)] += _AT_AN_END
        widths[-len(_AT_AN_END) :] += _AT_AN_END[::-1]
    return widths


def _extent(body: Body, side: int) -> float:
    """Extent [m] of the rectangle across its outline's segment number `side` (bottom, right, top, left)."""
    lower, upper = own_box(body)
    start, end = outline(body.model_copy(update={"rotate": None}))[side]
    return float((upper - lower)[0 if abs(end[1] - start[1]) > abs(end[0] - start[0]) else 1])
