"""Particles from a scene's shapes and walls.

Particles are cell-centred: the outermost stand half a spacing inside the faces, so that the represented
thickness is the real one. The spacing fits the shape's bounding box per axis, n = round(L/dx). A shape's
rotation turns its lattice too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from shared.regions import area, axes_of, contains, distance_to, faces, outline, own_box, turn
from shared.schema_fluid import Wall
from shared.schema_geometry import Shape

__all__ = [
    "Particles",
    "area",
    "contains",
    "distance_to",
    "faces",
    "fill",
    "ghosts",
    "outline",
    "own_box",
    "wall_particles",
]

_LONGEST_MITRE = 2.0  # how far, over the depth, a layer runs on past a corner: farther ones are out of reach
_OVERLAP = 0.25  # of dx: reach of the later segment past a corner's bisector; without, unlike spacings leave holes
_TOO_CLOSE = 0.5  # distance over dx below which two wall particles are taken as one


@dataclass(frozen=True)
class Particles:
    """A lattice of particles.

    `position` (n, 2) [m]; `volume` (n,) [m²]; `spacing` [m] along the lattice's own two axes; `axes` (2, 2):
    their unit vectors, one per row.
    """

    position: np.ndarray
    volume: np.ndarray
    spacing: tuple[float, float]
    axes: np.ndarray


def fill(shape: Shape, dx: float) -> Particles:
    """Cell-centred particles in a shape at spacing `dx` [m], row by row, x fastest (in the shape's own
    frame).
    """
    lower, upper = own_box(shape)
    spacing, centres = [], []
    for axis in (0, 1):
        length = upper[axis] - lower[axis]
        count = max(1, math.floor(length / dx + 0.5))
        spacing.append(float(length / count))
        centres.append(lower[axis] + (np.arange(count) + 0.5) * (length / count))
    x, y = np.meshgrid(*centres)
    position = turn(np.c_[x.ravel(), y.ravel()], shape.rotate)
    position = position[contains(shape, position)]
    volume = np.full(len(position), spacing[0] * spacing[1])
    return Particles(position, volume, (spacing[0], spacing[1]), axes_of(shape.rotate))


def ghosts(shape: Shape, dx: float, depth: float, dry: Sequence[str]) -> Particles:
    """The particles of `fill` no farther than `depth` [m] from a face of the shape that is not named in
    `dry`.
    """
    lattice = fill(shape, dx)
    wetted = outline(shape)
    named = faces(shape)
    for name in dry:
        same = np.all(wetted[:, None] == named[name][None], axis=(2, 3)).any(axis=1)
        wetted = wetted[~same]
    near = distance_to(wetted, lattice.position) <= depth
    return Particles(lattice.position[near], lattice.volume[near], lattice.spacing, lattice.axes)


def wall_particles(wall: Wall, dx: float, depth: float) -> Particles:
    """Ghost layers behind a wall: at (k + 1/2) dx to the right of the polyline for all (k + 1/2) dx < `depth`
    [m].

    Cell-centred along each segment, n = round(L/dx). Past a convex corner the layers run on to the corner's
    bisector, so that a rectangular tank whose sides are multiples of dx gets the global lattice. A particle
    is kept only if no other segment is nearer than its own: layers meet without overlap in reflex corners and
    within thin baffles. At open ends the layers end with the polyline. `spacing` is (dx, dx): segments fit
    theirs each.
    """
    corners = np.asarray([*wall.polyline, wall.polyline[0]] if wall.closed else wall.polyline, dtype=float)
    segments = np.stack([corners[:-1], corners[1:]], axis=1)
    layers = (np.arange(math.ceil(depth / dx)) + 0.5) * dx
    layers = layers[layers < depth]
    position, volume = np.empty((0, 2)), np.empty(0)
    for index in range(len(segments)):
        own, cell = _segment_layers(segments, index, layers, dx, wall.closed)
        if len(position) and len(own):
            nearest, _ = cKDTree(position).query(own, distance_upper_bound=dx)
            own = own[nearest > _TOO_CLOSE * dx]
        position = np.concatenate([position, own])
        volume = np.concatenate([volume, np.full(len(own), cell)])
    return Particles(position, volume, (dx, dx), np.eye(2))


def _segment_layers(
    segments: np.ndarray, index: int, layers: np.ndarray, dx: float, closed: bool
) -> tuple[np.ndarray, float]:
    """Layer particles (n, 2) [m] of one segment of a wall, cut at its corners; the volume [m²] of each."""
    start, end = segments[index]
    length = np.hypot(*(end - start))
    direction = (end - start) / length
    right = np.array([direction[1], -direction[0]])
    count = max(1, math.floor(length / dx + 0.5))
    spacing = length / count
    before = segments[index - 1] if index > 0 or closed else None
    after = segments[(index + 1) % len(segments)] if index + 1 < len(segments) or closed else None
    first = -_overrun(before, segments[index], layers[-1], spacing)
    last = count + _overrun(segments[index], after, layers[-1], spacing)
    along = (np.arange(first, last) + 0.5) * spacing
    d, s = np.meshgrid(layers, along)
    d, s = d.ravel(), s.ravel()
    points = start + s[:, None] * direction + d[:, None] * right
    tie = 1e-6 * dx
    keep = distance_to(segments, points) >= d - tie
    if before is not None:
        keep &= (points - start) @ _across_bisector(before, segments[index]) > -_OVERLAP * dx
    if after is not None:
        keep &= (points - end) @ _across_bisector(segments[index], after) <= tie
    return points[keep], float(spacing * dx)


def _overrun(before: np.ndarray | None, after: np.ndarray | None, depth: float, spacing: float) -> int:
    """Number of columns by which layers run on past the corner of two segments; none unless it turns left."""
    if before is None or after is None:
        return 0
    a, b = _unit(before), _unit(after)
    cross, dot = a[0] * b[1] - a[1] * b[0], a @ b
    if cross <= 0.0 and dot > -1.0 + 1e-12:
        return 0
    half_tangent = np.tan(0.5 * np.arctan2(abs(cross), dot))
    return math.ceil(depth * min(half_tangent, _LONGEST_MITRE) / spacing + 0.5)


def _across_bisector(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Unit vector (2,) across the bisector of a corner, from the earlier segment to the later one."""
    mean = _unit(before) + _unit(after)
    length = np.hypot(*mean)
    return mean / length if length > 1e-9 else _unit(before)


def _unit(segment: np.ndarray) -> np.ndarray:
    along = segment[1] - segment[0]
    return along / np.hypot(*along)
