"""Walls too thin for the waters on both sides to be told apart.

Faces that look away from each other share the ghosts between them, and a ghost carries one pressure. Measured, waters
of 0.3 and 0.1 m either side of a wall: half a dx thick it holds nothing back; at one dx the net push is 0.4 to 2.8 %
off in the mean, and swings by a quarter (h = 1.3 dx) and three quarters (h = 2 dx) in water at rest; at two it is
within 1.1 %.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

from shared.geometry.regions import contains
from shared.geometry.segments import directions, lengths, right_of
from shared.geometry.wall_chains import segments_of
from shared.schema.fluid import PARTICLE_FLUIDS
from shared.schema.scene import Scene

THINNEST = 1.9  # of dx, of a structure too: below it the net load of two waters is up to a quarter off
_OPPOSITE = -0.95  # cosine between normals of faces that look away from each other; a spike's tip may be thin
_TOUCHING = 1e-9  # of dx: faces on one line are a wall of no thickness
SPACING = 0.25  # of dx: between points on a face, at most, and off it where there is water if it is wet


def thin_walls(scene: Scene) -> Iterator[tuple[str, float, bool]]:
    """Of each two walls (or one) whose faces stand back to back less than `THINNEST` dx apart: what and where that is,
    the thickness [m], and whether there is water before both."""
    if scene.fluid is None or scene.fluid.model not in PARTICLE_FLUIDS:
        return
    dx = scene.fluid.dx
    if not scene.walls:
        return
    laid = [points_along(segments_of(wall), SPACING * dx) for wall in scene.walls]
    owner = np.repeat(np.arange(len(laid)), [len(points) for points, _ in laid])
    point, normal = (np.concatenate(column) for column in zip(*laid, strict=True))
    one, other = cKDTree(point).query_pairs(THINNEST * dx * (1.0 - 1e-9), output_type="ndarray").T
    between = point[other] - point[one]
    away = np.sum(normal[one] * normal[other], axis=1) < _OPPOSITE
    away &= np.sum(between * normal[one], axis=1) < _TOUCHING * dx
    one, other, between = one[away], other[away], between[away]
    wet = before_water(scene, point, normal)
    both = wet[one] & wet[other]
    thickness = np.maximum(-np.sum(between * normal[one], axis=1), 0.0)
    pairs = np.sort(np.c_[owner[one], owner[other]], axis=1)
    for pair in np.unique(pairs, axis=0):
        mine = np.flatnonzero(np.all(pairs == pair, axis=1))
        k = mine[np.lexsort((thickness[mine], ~both[mine]))[0]]
        names = " and ".join(f"'{scene.walls[number].name}'" for number in dict.fromkeys(pair))
        x, y = point[one[k]]
        what = f"walls[{pair[0]}]: the wall of {names} is {thickness[k]:.3g} m thick near ({x:.4g}, {y:.4g})"
        yield what, float(thickness[k]), bool(both[k])


def points_along(faces: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) [m] along the `faces` (k, 2, 2), `spacing` [m] apart or less, and unit normals (n, 2) to their
    left, seen from start to end."""
    points, normals = [], []
    for face in faces:
        start, end = face
        count = max(1, int(np.ceil(lengths(face) / spacing)))
        points.append(start + (end - start) * ((np.arange(count) + 0.5) / count)[:, None])
        normals.append(np.tile(-right_of(directions(face)), (count, 1)))
    return np.concatenate(points), np.concatenate(normals)


def before_water(scene: Scene, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Which of the `points` (n, 2) [m] on faces with these `normals` have water before them at t = 0."""
    wet = np.zeros(len(points), dtype=bool)
    for water in scene.fluid.bodies:
        wet |= contains(water, points + SPACING * scene.fluid.dx * normals)
    return wet
