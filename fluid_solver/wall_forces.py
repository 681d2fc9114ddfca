"""Forces of the fluid on walls, wall by wall.

The ghosts of a corner stand behind both of its walls, and are pushed along both normals. What pushes them is shared by
direction: f = α n + β m, n and m the normals of the two walls; α n is the force on the first, β m that on the second.
Ghosts of a floor behind a wall that stands on it are shared likewise, also behind one that moves otherwise, as a piston
along its floor: then those that stand behind it now, of a column that its foot passes the part that does. So water at
rest pushes a wall along its normal only, and the sum over the walls is that over the ghosts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fluid_solver.fields import STRUCTURE
from fluid_solver.ghosts import Ghosts, joints
from shared.geometry.regions import distance_to
from shared.geometry.segments import directions, right_of
from shared.geometry.wall_chains import MEET, Chain, Ground, chains, parting
from shared.schema.scene import Scene

_LEAST_SINE = 0.1  # of the turn at a corner: below, about 6°, and beyond 174°, each ghost's force is its owner's


@dataclass(frozen=True)
class _Corner:
    """Two walls' common ghosts. `walls`: in the order of the walk; `rows` (n,) of the ghosts; `first` (2, 2): takes a
    force to the first wall's part of it, in the reference position."""

    walls: tuple[int, int]
    rows: np.ndarray
    first: np.ndarray


class WallForces:
    """What each wall bears of the forces on all ghosts."""

    def __init__(self, scene: Scene, ghosts: Ghosts, support: float):
        """`support` [m]: how far the fluid pushes."""
        self._owner = np.where(ghosts.kind == STRUCTURE, -1, ghosts.owner)
        self._rest, self._normal = ghosts.position, ghosts.normal
        self._dx, self._support = scene.fluid.dx, support
        self._corners = list(_corners(scene, ghosts.position, self._owner, support))
        self._parting = [
            foot
            for foot in parting(scene.walls, scene.fluid.dx)
            if all((self._owner == side.wall).any() for side in foot[:2])
        ]
        self._alone = np.ones(len(self._owner), dtype=bool)  # ghosts of no fixed corner
        for corner in self._corners:
            self._alone[corner.rows] = False

    def on(self, wall: int, force: np.ndarray, position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Force (2,) [N/m] on a wall. `force` (ghosts, 2) [N/m], `position` [m] and `normal` (ghosts, 2): present
        ones."""
        mine = self._owner == wall
        total = np.array([force[mine, axis].sum() for axis in (0, 1)])
        for corner in self._corners:
            if wall in corner.walls:
                turn = _turn(self._normal[corner.rows[0]], normal[corner.rows[0]])
                now = _Corner(corner.walls, corner.rows, turn @ corner.first @ turn.T)
                total = total + self._moved(now, wall, force[corner.rows])
        for ground, own, starts in self._parting:
            if wall in (ground.wall, own.wall):
                total = total + self._at_foot(ground, own, starts, wall, force, position, normal)
        return total

    def _moved(self, corner: _Corner, wall: int, pushed: np.ndarray) -> np.ndarray:
        """What a wall bears (2,) of the forces `pushed` (n, 2) on a corner's ghosts, less those on its own."""
        part = corner.first @ pushed.sum(axis=0)
        if wall == corner.walls[1]:
            part = pushed.sum(axis=0) - part
        return part - pushed[self._owner[corner.rows] == wall].sum(axis=0)

    def _at_foot(self, ground: Ground, own: Ground, starts: bool, wall: int, force, position, normal) -> np.ndarray:
        """`_moved` where the face `own` of a wall stands on the `ground`, as long as it does."""
        floor, face = (self._present(side, position, normal) for side in (ground, own))
        place, sense = (face[0], 1.0) if starts else (face[1], -1.0)
        arm = position - place
        past = np.where(
            self._owner == ground.wall, np.clip(0.5 + sense * arm @ directions(floor) / self._dx, 0.0, 1.0), 0.0
        )
        past[(self._owner == own.wall) & (sense * arm @ directions(face) < 0.0)] = 1.0
        rows = np.flatnonzero((past > 0.0) & self._alone & (np.hypot(*arm.T) < self._support))
        sides = [(ground, floor), (own, face)] if starts else [(own, face), (ground, floor)]
        first = _first_part(*(right_of(directions(now)) for _, now in sides))
        if first is None or distance_to(floor[None], place[None])[0] > MEET * self._dx:
            return np.zeros(2)
        corner = _Corner((sides[0][0].wall, sides[1][0].wall), rows, first)
        return self._moved(corner, wall, past[rows, None] * force[rows])

    def _present(self, side: Ground, position: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """A wall's face (2, 2) [m] where it is now."""
        one = np.argmax(self._owner == side.wall)
        return position[one] + (side.face - self._rest[one]) @ _turn(self._normal[one], normal[one]).T


def _corners(scene: Scene, position: np.ndarray, owner: np.ndarray, support: float) -> Iterator[_Corner]:
    """Corners of unlike walls that have ghosts which both walls share."""
    for chain in chains(scene.walls, scene.fluid.dx):
        for first, second, rows in [*joints(chain, position, owner), *_feet(chain, position, owner, support)]:
            part = _first_part(*(right_of(directions(side.face)) for side in (first, second)))
            if first.wall != second.wall and part is not None and len(rows):
                yield _Corner((first.wall, second.wall), rows, part)


def _first_part(n: np.ndarray, m: np.ndarray) -> np.ndarray | None:
    """What takes a force to its part (2, 2) along `n` (2,), the rest along `m`; None where they are too much alike."""
    sine = n[0] * m[1] - n[1] * m[0]
    return np.outer(n, [m[1], -m[0]]) / sine if sine > _LEAST_SINE else None


def _feet(
    chain: Chain, position: np.ndarray, owner: np.ndarray, support: float
) -> Iterator[tuple[Ground, Ground, np.ndarray]]:
    """Where a chain stands on another wall's face: both in the order of the walk, and the ghosts past both their ends
    that the fluid in the corner reaches: under the chain, up to its other foot, and those that it has run on."""
    ends = [
        (chain.foot, Ground(int(chain.owner[0]), chain.segments[0]), chain.segments[0, 0], 1.0),
        (chain.head, Ground(int(chain.owner[-1]), chain.segments[-1]), chain.segments[-1, 1], -1.0),
    ]
    arms = np.full((2, len(position)), np.inf)
    past = np.ones((2, len(position)), dtype=bool)
    for k, (ground, _, place, sense) in enumerate(ends):
        if ground is not None:
            arms[k] = np.hypot(*(position - place).T)
            past[k] = sense * (position - place) @ directions(ground.face) > 0.0
    nearest = np.argmin(arms, axis=0)
    for k, (ground, own, place, sense) in enumerate(ends):
        if ground is not None:
            run_on = (owner == own.wall) & (sense * (position - place) @ directions(own.face) < 0.0)
            other = ends[1 - k][0]
            under = (owner == ground.wall) & (past.all(axis=0) if other and other.wall == ground.wall else past[k])
            rows = np.flatnonzero((run_on | under) & (nearest == k) & (arms[k] < support))
            yield (ground, own, rows) if sense > 0.0 else (own, ground, rows)


def _turn(rest: np.ndarray, now: np.ndarray) -> np.ndarray:
    """The rotation (2, 2) that takes a unit vector `rest` (2,) to `now`."""
    c, s = rest @ now, rest[0] * now[1] - rest[1] * now[0]
    return np.array([[c, -s], [s, c]])
