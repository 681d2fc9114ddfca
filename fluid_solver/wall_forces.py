"""Forces of the fluid on walls, wall by wall.

The ghosts of a corner stand behind both of its walls, and are pushed along both normals. What pushes them is shared by
direction: f = α n + β m, n and m the normals of the two walls; α n is the force on the first, β m that on the second.
So water at rest pushes a free-slip wall along its normal only, and the sum over the walls is that over the ghosts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fluid_solver.fields import STRUCTURE
from fluid_solver.initial import Ghosts
from shared.geometry import distance_to
from shared.schema import Scene
from shared.wall_chains import chains

_LEAST_SINE = 0.1  # of the turn at a corner: below, about 6°, and beyond 174°, each ghost's force is its owner's


@dataclass(frozen=True)
class _Corner:
    """Two walls' common ghosts: `walls`, `rows` (n,) of the ghosts, `first` (2, 2): takes a force to the first wall's
    part of it, at rest."""

    walls: tuple[int, int]
    rows: np.ndarray
    first: np.ndarray


class WallForces:
    """What each wall bears of the forces on all ghosts."""

    def __init__(self, scene: Scene, ghosts: Ghosts):
        self._owner = np.where(ghosts.kind == STRUCTURE, -1, ghosts.owner)
        self._normal = ghosts.normal
        self._corners = list(_corners(scene, ghosts.position, self._owner))

    def on(self, wall: int, force: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Force (2,) [N/m] on a wall. `force` (ghosts, 2) [N/m], `normal` (ghosts, 2): present ones."""
        mine = self._owner == wall
        total = np.array([force[mine, axis].sum() for axis in (0, 1)])
        for corner in self._corners:
            if wall in corner.walls:
                pushed, owner = force[corner.rows], self._owner[corner.rows]
                turn = _turn(self._normal[corner.rows[0]], normal[corner.rows[0]])
                part = turn @ corner.first @ turn.T @ pushed.sum(axis=0)
                if wall == corner.walls[1]:
                    part = pushed.sum(axis=0) - part
                total = total + part - pushed[owner == wall].sum(axis=0)
        return total


def _corners(scene: Scene, position: np.ndarray, owner: np.ndarray) -> Iterator[_Corner]:
    """Corners of unlike walls that have ghosts which both walls share."""
    for chain in chains(scene.walls, scene.fluid.dx):
        count = len(chain.segments)
        mine = np.flatnonzero(np.isin(owner, chain.owner))
        distance = distance_to(chain.segments, position[mine])
        for k in range(count if chain.closed else count - 1):
            after = (k + 1) % count
            walls = int(chain.owner[k]), int(chain.owner[after])
            n, m = (_normal_of(chain.segments[i]) for i in (k, after))
            sine = n[0] * m[1] - n[1] * m[0]
            arm = np.hypot(*(position[mine] - chain.segments[after, 0]).T)
            rows = mine[(arm <= distance * (1.0 + 1e-9)) & np.isin(owner[mine], walls)]
            if walls[0] != walls[1] and sine > _LEAST_SINE and len(rows):
                yield _Corner(walls, rows, np.outer(n, [m[1], -m[0]]) / sine)


def _normal_of(segment: np.ndarray) -> np.ndarray:
    """Unit vector (2,) to the right of a segment's walk."""
    along = (segment[1] - segment[0]) / np.hypot(*(segment[1] - segment[0]))
    return np.array([along[1], -along[0]])


def _turn(rest: np.ndarray, now: np.ndarray) -> np.ndarray:
    """The rotation (2, 2) that takes a unit vector `rest` (2,) to `now`."""
    c, s = rest @ now, rest[0] * now[1] - rest[1] * now[0]
    return np.array([[c, -s], [s, c]])
