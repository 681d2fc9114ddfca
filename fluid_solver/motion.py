"""Motion of ghosts: walls by the scene's tables, structures by what they say of the window.

A pose (n, 8) holds position, velocity, acceleration and normal of n ghosts: x, y, u, v, ax, ay, nx, ny. Velocity and
acceleration of a wall's are those of its face before the ghost, where the fluid meets it: behind a face that turns the
ghosts move faster, and would drag the fluid so. So is the velocity of a structure's where the fluid sticks to it: it
goes on to the face linearly from the ghosts there.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from fluid_solver.cells import BLOCK
from fluid_solver.fields import AX, AY, FLUID, PARKED, X, Y
from fluid_solver.ghosts import Ghosts, joints
from fluid_solver.hermite import hermite
from shared.contract import Kinematics
from shared.geometry.motion_table import MotionTable
from shared.geometry.wall_chains import chains
from shared.ghost_inertia import ghosts_feel_acceleration
from shared.jit import inline_njit, njit, parallel_njit
from shared.schema.fluid import Wall
from shared.schema.geometry import Motion
from shared.schema.scene import Scene

POSE = 8
_NEAREST = 12  # ghosts of a body that its face's velocity is taken from
_hermite = inline_njit(hermite)


class GhostMotion:
    """Where all ghosts are and how they move: walls by the scene's tables, structures as they say of the window.

    `pose` (n, 8); `x0`, `v0` (m, 2): position [m] and velocity [m/s] of the structures' ghosts at the window's start.
    """

    def __init__(self, scene: Scene, ghosts: Ghosts):
        rest, normal = ghosts.position, ghosts.normal
        self._walls, self._accelerated = ghosts.walls, ghosts_feel_acceleration(scene)
        owner = ghosts.owner[: self._walls]
        self._tables = [
            (rows, WallMotion(wall.motion, rest[rows], ghosts.foot[rows], normal[rows]))
            for rows, wall in ((np.flatnonzero(owner == k), wall) for k, wall in enumerate(scene.walls))
            if wall.motion
        ]
        self.pose = np.zeros((len(rest), POSE))
        self.pose[:, :2], self.pose[:, 6:] = rest, normal
        sliding = np.array([wall.surface_speed for wall in scene.walls])
        if sliding.any():  # a turn of the normal, which points to the right of the polyline, is along it
            self.pose[: self._walls, 2:4] = sliding[owner, None] * np.c_[-normal[:, 1], normal[:, 0]][: self._walls]
            for chain in chains(scene.walls, scene.fluid.dx):
                for first, second, rows in joints(chain, rest[: self._walls], owner):
                    if sliding[first.wall] != sliding[second.wall]:
                        self.pose[rows, 2:4] = 0.0
        self._wall_speed = 0.0  # m/s, of the fastest ghost of a wall
        self._faces = at_feet(ghosts) if scene.fluid.viscosity > 0.0 else None
        self.x0 = rest[self._walls :].copy()
        self.v0 = np.zeros_like(self.x0)

    def still(self, boundary: Kinematics | None) -> bool:
        """Whether no ghost moves."""
        return boundary is None and not self._tables

    def to(self, t0: float, since: float, length: float, boundary: Kinematics | None) -> None:
        """Set `pose` to what it is `since` seconds after the start t0 of a window of `length`."""
        for rows, motion in self._tables:
            self.pose[rows] = motion.pose(t0 + since)
        self._wall_speed = max((motion.speed(t0 + since) for _, motion in self._tables), default=0.0)
        if boundary is not None:
            a = boundary.acceleration_mean if self._accelerated else np.zeros_like(boundary.acceleration_mean)
            end, pose = (boundary.position, boundary.velocity), self.pose[self._walls :]
            structure_pose(since / length, length, self.x0, self.v0, *end, a, pose)
            if self._faces is not None:
                pose[:, 2:4] = self._faces @ pose[:, 2:4]

    def start(self, boundary: Kinematics | None) -> None:
        """A window begins where `boundary` ended."""
        if boundary is not None:
            self.x0[...], self.v0[...] = boundary.position, boundary.velocity

    def speed(self, boundary: Kinematics | None) -> float:
        """Largest speed [m/s] of a ghost that moves."""
        return 0.0 if self.still(boundary) else max(self._wall_speed, fastest(self.pose[self._walls :]))


class WallMotion:
    """A wall's prescribed motion: translation and rotation about a point, by its table."""

    def __init__(self, motion: Motion, reference: np.ndarray, foot: np.ndarray, normal: np.ndarray):
        """`reference`, `foot` (n, 2) [m], `normal` (n, 2): of the wall's ghosts in the reference position."""
        self._table, self._normal = MotionTable(motion), normal
        self._arm, self._foot = reference - self._table.about, foot - self._table.about
        self._reach = float(np.hypot(*self._arm.T).max(initial=0.0))

    def pose(self, time: float) -> np.ndarray:
        """Pose (n, 8) of the ghosts at `time` [s]."""
        (x, y, angle), (u, v, spin), (ax, ay, turn) = self._table.at(time)
        c, s = math.cos(angle), math.sin(angle)
        turned = np.array([[c, s], [-s, c]])
        foot = self._foot @ turned
        across = np.c_[-foot[:, 1], foot[:, 0]]
        return np.c_[
            self._table.about + self._arm @ turned + (x, y),
            spin * across + (u, v),
            turn * across - spin * spin * foot + (ax, ay),
            self._normal @ turned,
        ]

    def speed(self, time: float) -> float:
        """A bound of the ghosts' speed [m/s] at `time` [s]."""
        u, v, spin = self._table.at(time)[1]
        return math.hypot(u, v) + abs(spin) * self._reach


def keep_room(walls: list[Wall]) -> bool:
    """Whether the walls leave as much room between them as they move: all move as one, or who moves is closed."""
    return all(wall.motion == walls[0].motion for wall in walls) or all(w.closed for w in walls if w.motion)


def at_feet(ghosts: Ghosts) -> csr_array:
    """Weights (m, m) that give the velocity at the feet of the structures' m ghosts from the ghosts' own: linear fits
    to the ghosts of the body nearest to each foot, exact for what turns, and for what strains evenly."""
    rows, columns, weights = [], [], []
    owner, kept = ghosts.owner[ghosts.walls :], ghosts.position[ghosts.walls :]
    for body in np.unique(owner):
        own = np.flatnonzero(owner == body)
        place, foot = kept[own], ghosts.foot[ghosts.walls :][own]
        near = cKDTree(place).query(foot, k=min(_NEAREST, len(own)))[1].reshape(len(own), -1)
        middle = place[near].mean(axis=1, keepdims=True)
        slope = np.linalg.pinv(place[near] - middle)  # of least size: none across a single row
        rows.append(np.repeat(own, near.shape[1]))
        columns.append(own[near].ravel())
        weights.append((1.0 / near.shape[1] + np.einsum("aj,ajk->ak", foot - middle[:, 0], slope)).ravel())
    shape = (len(owner), len(owner))
    if not rows:
        return csr_array(shape)
    return csr_array((np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), shape=shape)


@njit
def fastest(pose):
    """Largest speed [m/s] in `pose` (n, 8)."""
    u2 = 0.0
    for i in range(len(pose)):
        u2 = max(u2, pose[i, 2] * pose[i, 2] + pose[i, 3] * pose[i, 3])
    return math.sqrt(u2)


@njit
def structure_pose(s, length, x0, v0, x1, v1, acceleration, pose):
    """Pose of structure ghosts at the fraction `s` of a window of `length` [s], in place in `pose` (n, 8).

    Cubic Hermite from start and end positions and velocities (n, 2), so that the wall never jumps; acceleration the
    mean over the window: the raw one destabilises light structures.
    """
    for i in range(len(x0)):
        for k in range(2):
            pose[i, k], pose[i, 2 + k] = _hermite(s, length, x0[i, k], v0[i, k], x1[i, k], v1[i, k])
            pose[i, 4 + k] = acceleration[i, k]


@parallel_njit
def place_ghosts(S, kind, ids, count, grid, first, pose):
    """Set position and acceleration of all ghosts from `pose` (ghosts, 8), by id less `first`.

    In a periodic direction a ghost keeps to the image that its cell holds.
    """
    for block in numba.prange((count + BLOCK - 1) // BLOCK):
        for i in range(block * BLOCK, min(block * BLOCK + BLOCK, count)):
            if kind[i] != FLUID and kind[i] != PARKED:
                at = ids[i] - first
                S[X, i] = nearest_image(pose[at, 0], S[X, i], grid.period_x)
                S[Y, i] = nearest_image(pose[at, 1], S[Y, i], grid.period_y)
                S[AX, i] = pose[at, 4]
                S[AY, i] = pose[at, 5]


@inline_njit
def nearest_image(x, near, period):
    """`x` [m], or that of its images a whole number of periods away that is nearest to `near`."""
    return x + period * np.rint((near - x) / period) if period > 0.0 else x
