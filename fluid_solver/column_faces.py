"""Where columns of water stand: the parts of the structure's faces that a fluid body touches."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from shared.contract import BadInput
from shared.geometry import fill, outline, own_box
from shared.schema import Scene
from shared.schema_geometry import Body

_TOUCHING = 1e-6  # of dx: faces this near to each other touch
_PARALLEL = 1e-9  # sine of the angle between faces that touch


@dataclass(frozen=True)
class Patch:
    """Columns on one face: feet `position` (n, 2) [m], `width` of each and common `length` [m], `normal` (2,) into the
    water, `body`: index of the solid body, `lattice` (m, 2): points of the water, `top` [m²/s²]: the largest of −g·x
    over the water, whose level the static pressure is counted from."""

    position: np.ndarray
    width: float
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
        return np.maximum(beside - 0.5 * self.width, 0.0) + np.maximum(off, 0.0)

    def locate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nearest column (m,) and the distance (m,) from its foot, within its length."""
        away = np.clip(self._height(points), 0.0, self.length)
        on_face = points - self._height(points)[:, None] * self.normal
        gaps = np.linalg.norm(on_face[:, None] - self.position[None], axis=2)
        return np.argmin(gaps, axis=1), away

    def _height(self, points: np.ndarray) -> np.ndarray:
        return (points - self.position[0]) @ self.normal


def wetted_patches(scene: Scene) -> list[Patch]:
    """All faces of solid bodies that stand on faces of fluid bodies.

    Raises BadInput where a fluid body is no rectangle, touches no solid, or touches solids at two opposite faces.
    """
    return [patch for body in scene.fluid.bodies for patch in _of_body(scene, body)]


def _of_body(scene: Scene, body: Body) -> list[Patch]:
    if body.rectangle is None:
        raise BadInput(f"fluid body '{body.name}' is no rectangle, which model column needs; use model wcsph or ctvf.")
    gravity, corners = np.array(scene.gravity), outline(body).reshape(-1, 2)
    top, lattice = float(np.max(-corners @ gravity)), fill(body, scene.fluid.dx).position
    found = []
    for side, (start, end) in enumerate(outline(body)):
        along = (end - start) / math.hypot(*(end - start))
        inward = np.array([-along[1], along[0]])  # the body is on the left
        length = _extent(body, side)
        for k, solid in enumerate(scene.solid.bodies if scene.solid else []):
            for piece in _common(start, along, math.hypot(*(end - start)), outline(solid), scene.fluid.dx):
                count = max(1, round((piece[1] - piece[0]) / scene.fluid.dx))
                width = (piece[1] - piece[0]) / count
                feet = start + (piece[0] + (np.arange(count)[:, None] + 0.5) * width) * along
                found.append((side, Patch(feet, width, length, inward, k, lattice, top)))
    sides = {side for side, _ in found}
    if not sides or {0, 2} <= sides or {1, 3} <= sides:
        where = "touches no face of a solid body" if not sides else "touches solid bodies at two opposite faces"
        raise BadInput(
            f"fluid body '{body.name}' {where}: model column is water between one wetted face and a far end. Let the "
            "body share one face with the structure, or use model wcsph or ctvf."
        )
    return [patch for _, patch in found]


def _extent(body: Body, side: int) -> float:
    """Extent [m] of the rectangle across its outline's segment number `side` (bottom, right, top, left)."""
    lower, upper = own_box(body)
    start, end = outline(body.model_copy(update={"rotate": None}))[side]
    return float((upper - lower)[0 if abs(end[1] - start[1]) > abs(end[0] - start[0]) else 1])


def _common(start, along, length: float, segments: np.ndarray, dx: float) -> list[tuple[float, float]]:
    """Parts, as intervals along a face from `start` in direction `along`, that lie on one of `segments` (k, 2, 2)."""
    across = np.array([-along[1], along[0]])
    parts = []
    for a, b in segments:
        direction = (b - a) / math.hypot(*(b - a))
        if abs(direction @ across) > _PARALLEL or abs((a - start) @ across) > _TOUCHING * dx:
            continue
        low, high = sorted(((a - start) @ along, (b - start) @ along))
        low, high = max(low, 0.0), min(high, length)
        if high - low > _TOUCHING * dx:
            parts.append((low, high))
    return parts
