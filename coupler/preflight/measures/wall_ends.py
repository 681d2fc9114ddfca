"""Walls that stop at a structure's corner with nothing behind it.

Ghosts end with an open wall, and a structure's own with its outline: past the corner in which both meet there is
nothing, so that water before it lacks neighbours on one side, is stirred for good, and gets out. Measured, a plate that
hangs from the lid of a full box (ctvf, h = 2 dx): 1 to 3 m/s where the lid stops at the plate's corners, 0.02 where it
runs on by one dx, 0.002 by the kernel's support; a plate that is a tank's side, its floor stopping at the plate's
corner: 1.2 m/s and 4 particles lost, with h = 1.3 dx 0.08 m/s and 2; none where the floor runs on.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from coupler.preflight.measures.gravity import upward
from shared.geometry.regions import contains, corners_of, distance_to, outline
from shared.geometry.segments import directions, lengths, right_of
from shared.geometry.wall_chains import Chain, chains
from shared.kernels import kernel_named
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.scene import Scene

_AT = 0.5  # of dx: a wall that ends as near to a body ends at it
_LOOK = 0.75  # of dx, along the wall and across: where it is looked what is beyond an end


def open_ends(scene: Scene) -> Iterator[tuple[str, str, np.ndarray]]:
    """Of each wall that stops at a body's corner with nothing behind both: its name, the body's, and where (2,) [m]."""
    if scene.fluid is None or scene.fluid.model not in PARTICLE_FLUIDS or scene.solid is None:
        return
    dx, up = scene.fluid.dx, upward(scene)
    level = float((corners_of(scene.fluid.bodies) @ up).max())
    found = chains(scene.walls, dx)
    for chain in found:
        for end, along, behind, wall in _ends(chain):
            aside = _LOOK * dx * (along + behind)
            bodies = [body.name for body in scene.solid.bodies if distance_to(outline(body), end[None])[0] < _AT * dx]
            wet = end @ up < level + _AT * dx and not _within(scene.solid.bodies, end - aside)
            if bodies and wet and not _held(scene, found, end + aside):
                yield scene.walls[wall].name, bodies[0], end


def _ends(chain: Chain) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, int]]:
    """Of each end of a chain that stands on nothing: the place (2,), the way (2,) on past it, the one (2,) behind the
    wall there, and the wall's number."""
    for index, ground, sense in ((0, chain.foot, -1.0), (-1, chain.head, 1.0)):
        if not chain.closed and ground is None:
            segment = chain.segments[index]
            along = directions(segment)
            yield segment[0 if sense < 0.0 else 1], sense * along, right_of(along), int(chain.owner[index])


def _held(scene: Scene, found: list[Chain], point: np.ndarray) -> bool:
    """Whether water, a body or a wall's ghosts are at a `point` (2,)."""
    depth = kernel_named(scene.fluid.kernel).support * scene.fluid.h_over_dx * scene.fluid.dx
    faces = np.concatenate([chain.segments for chain in found])
    along = directions(faces)
    away = point - faces[:, 0]
    s, d = np.sum(away * along, axis=1), np.sum(away * right_of(along), axis=1)
    behind = (s > 0.0) & (s < lengths(faces)) & (d > 0.0) & (d < depth)
    return bool(behind.any()) or _within([*scene.fluid.bodies, *scene.solid.bodies], point)


def _within(shapes, point: np.ndarray) -> bool:
    return any(contains(shape, point[None])[0] for shape in shapes)
