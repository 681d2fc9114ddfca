"""Ghosts of walls and structures as they are laid at t = 0, at the fluid's dx."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fluid_solver.fields import FREE_SLIP, NO_SLIP, STRUCTURE
from fluid_solver.period import within_period
from shared.geometry.particles import ghosts as body_ghosts
from shared.geometry.particles import wall_particles
from shared.geometry.regions import contains, distance_to, outline, outline_less
from shared.geometry.wall_chains import Chain, Ground, chains
from shared.schema.scene import Scene

_ROUNDING = 1e-9  # of a distance
_OWNED = 0.25  # of dx: wall particles this close to a solid body are the body's


@dataclass(frozen=True)
class Ghosts:
    """Walls, then structures: position (n, 2), volume, kind (n,), owner (n,): index of the wall or of the body, and
    foot (n, 2): the nearest point of the wall's face, or of the structure's in its reference state."""

    position: np.ndarray
    volume: np.ndarray
    kind: np.ndarray
    owner: np.ndarray
    foot: np.ndarray

    @property
    def normal(self) -> np.ndarray:
        """Unit vectors (n, 2) from the wall's face to the ghosts; zero for structures, which bend."""
        arm, bends = self.position - self.foot, self.kind == STRUCTURE
        return np.where(bends[:, None], 0.0, arm) / np.where(bends, 1.0, np.hypot(*arm.T))[:, None]

    @property
    def walls(self) -> int:
        """Number of wall particles, which come first."""
        return int(np.count_nonzero(self.kind != STRUCTURE))


def lay_ghosts(scene: Scene, support: float) -> Ghosts:
    """Ghost layers of all walls and of all solid bodies, at the fluid's dx; where both lie the body owns."""
    dx = scene.fluid.dx
    bodies = scene.solid.bodies if scene.solid else []
    parts = []
    faces = {k: chain.segments for chain in chains(scene.walls, dx) for k in chain.owner}
    for index, (wall, layers) in enumerate(zip(scene.walls, wall_particles(scene.walls, dx, support), strict=True)):
        keep = within_period(scene, layers.position)
        for body in bodies:
            keep &= ~contains(body, layers.position)
            keep &= distance_to(outline(body), layers.position) >= _OWNED * dx
        kind = FREE_SLIP if wall.slip == "free" else NO_SLIP
        position = layers.position[keep]
        parts.append(_part(position, layers.volume[keep], kind, index, wall_foot(faces[index], position)))
    for index, body in enumerate(bodies):
        dry = [clamp.face for clamp in scene.solid.clamps if clamp.body == body.name]
        inside = body_ghosts(body, dx, support, dry)
        keep = within_period(scene, inside.position)
        position = inside.position[keep]
        foot = wall_foot(outline_less(body, dry), position)
        parts.append(_part(position, inside.volume[keep], STRUCTURE, index, foot))
    if not parts:
        return Ghosts(*_part(np.empty((0, 2)), np.empty(0), STRUCTURE, 0, np.empty((0, 2))))
    return Ghosts(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def joints(chain: Chain, position: np.ndarray, owner: np.ndarray) -> Iterator[tuple[Ground, Ground, np.ndarray]]:
    """Where segments meet: both, and the ghosts to which the corner is the nearest of the chain."""
    faces = [Ground(int(k), face) for k, face in zip(chain.owner, chain.segments, strict=True)]
    mine = np.flatnonzero(np.isin(owner, chain.owner))
    nearest = distance_to(chain.segments, position[mine])
    for first, second in itertools.pairwise([*faces, faces[0]] if chain.closed else faces):
        arm = np.hypot(*(position[mine] - second.face[0]).T)
        both = np.isin(owner[mine], (first.wall, second.wall))
        yield first, second, mine[(arm <= nearest * (1.0 + _ROUNDING)) & both]


def wall_foot(face: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Nearest points (n, 2) of a face (k, 2, 2) to `points` (n, 2)."""
    nearest = np.full(len(points), np.inf)
    foot = points.copy()
    for start, end in face:
        along = np.clip((points - start) @ (end - start) / np.sum((end - start) ** 2), 0.0, 1.0)
        here = start + along[:, None] * (end - start)
        distance = np.hypot(*(points - here).T)
        closer = distance < nearest
        nearest[closer], foot[closer] = distance[closer], here[closer]
    return foot


def _part(position, volume, kind, owner, foot):
    n = len(position)
    return position, volume, np.full(n, kind, dtype=np.int8), np.full(n, owner), foot
