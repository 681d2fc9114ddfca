"""Bodies that get into walls or into each other: no force keeps them apart, so what follows would mean nothing.

Found: a disc of twice water's density fell on through the floor of its tank, to eight metres below it.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from scipy.spatial import cKDTree

from shared.contract import Description, SolverFailed
from shared.geometry.motion_table import MotionTable
from shared.geometry.segments import directions, lengths, right_of
from shared.geometry.wall_chains import segments_of
from shared.schema.fluid import Wall
from shared.schema.scene import Scene

_INTO = 0.5  # of dx behind a wall's face: where the outermost ghosts are when the face is a whole dx behind it
_BEYOND = 1.9  # of dx: from here on another face may stand behind
_SAME = 0.5  # of dx between ghosts of two bodies, which are dx apart where these touch


class Touching:
    """The ghosts of all bodies of a `scene`, as the `fluid` describes them."""

    def __init__(self, scene: Scene, fluid: Description):
        self._dx, self._start = scene.fluid.dx, fluid.position
        self._name = [scene.solid.bodies[k].name for k in fluid.body]
        self._walls = [(wall, _behind(wall, 0.0, fluid.position, -np.inf, 0.0)) for wall in scene.walls]
        bodies = [np.flatnonzero(fluid.body == k) for k in np.unique(fluid.body)]
        self._pairs = [pair for pair in combinations(bodies, 2) if self._same(fluid.position, *pair) is None]

    def check(self, time: float, position: np.ndarray) -> None:
        """Raise SolverFailed where ghosts at `position` (n, 2) [m] are behind a wall that they stood before, or within
        another body."""
        for wall, before in self._walls:
            into = before & _behind(wall, time, position, _INTO * self._dx, _BEYOND * self._dx)
            if into.any():
                k = int(np.argmax(into.any(axis=0)))
                raise self._found(time, position[k], k, f"wall '{wall.name}'")
        for one, other in self._pairs:
            if (both := self._same(position, one, other)) is not None:
                raise self._found(time, position[both[0]], both[0], f"'{self._name[both[1]]}'")

    def _same(self, position: np.ndarray, one: np.ndarray, other: np.ndarray) -> tuple[int, int] | None:
        """A ghost each of two bodies that are in one place, if any."""
        distance, nearest = cKDTree(position[other]).query(position[one], distance_upper_bound=_SAME * self._dx)
        k = int(np.argmin(distance))
        return (one[k], other[nearest[k]]) if np.isfinite(distance[k]) else None

    def _found(self, time: float, place: np.ndarray, ghost: int, into: str) -> SolverFailed:
        return SolverFailed(
            f"t = {time:.6g} s: '{self._name[ghost]}' has got into {into} near ({place[0]:.4g}, {place[1]:.4g}) m. "
            "Nothing makes bodies bounce off walls or each other. Let the run end before (end_time), or keep the body "
            "away: by springs, clamps, its density or more room."
        )


def _behind(wall: Wall, time: float, points: np.ndarray, least: float, most: float) -> np.ndarray:
    """Whether, at a `time` [s], each of `points` (n, 2) [m] is between `least` and `most` [m] behind each of a wall's
    segments, (k, n)."""
    if wall.motion is not None:
        table = MotionTable(wall.motion)
        x, y, angle = table.at(time)[0]
        turned = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        points = (points - (x, y) - table.about) @ turned + table.about
    face = segments_of(wall)
    arm, along = points - face[:, :1], directions(face)
    way = np.einsum("knd,kd->kn", arm, along)
    depth = np.einsum("knd,kd->kn", arm, right_of(along))
    beside = np.isinf(least) | ((way > 0.0) & (way < lengths(face)[:, None]))
    return beside & (depth > least) & (depth < most)
