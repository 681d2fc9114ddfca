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

from shared.geometry.regions import (
    axes_of,
    contains,
    distance_to,
    outline_less,
    own_box,
    turn,
)
from shared.geometry.segments import directions, lengths, right_of
from shared.geometry.wall_chains import Chain, chains
from shared.schema.fluid import Wall
from shared.schema.geometry import Shape

_LONGEST_MITRE = 2.0  # how far, over the depth, a layer runs on past a corner: farther ones are out of reach
_OVERLAP = 0.25  # of dx: reach of the later segment past a corner's bisector; without, unlike spacings leave holes
_TIE = 1e-6  # of dx: difference below which two faces are as near as each other
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
    lattice = _lattice(shape, dx, 0.0)
    return _of(lattice, contains(shape, lattice.position))


def surroundings(shape: Shape, dx: float, margin: float) -> Particles:
    """The points of the lattice of `fill` about a shape, as far as `margin` [m] from its bounding box."""
    lattice = _lattice(shape, dx, margin)
    return _of(lattice, ~contains(shape, lattice.position))


def _lattice(shape: Shape, dx: float, margin: float) -> Particles:
    """A lattice that fits a shape's bounding box, and goes on by `margin` [m]."""
    lower, upper = own_box(shape)
    spacing, centres = [], []
    for axis in (0, 1):
        length = upper[axis] - lower[axis]
        count = max(1, math.floor(length / dx + 0.5))
        spacing.append(float(length / count))
        around = math.ceil(margin * count / length) if length > 0.0 else 0
        centres.append(lower[axis] + (np.arange(-around, count + around) + 0.5) * (length / count))
    x, y = np.meshgrid(*centres)
    position = turn(np.c_[x.ravel(), y.ravel()], shape.rotate)
    volume = np.full(len(position), spacing[0] * spacing[1])
    return Particles(position, volume, (spacing[0], spacing[1]), axes_of(shape.rotate))


def _of(lattice: Particles, rows: np.ndarray) -> Particles:
    return Particles(lattice.position[rows], lattice.volume[rows], lattice.spacing, lattice.axes)


def ghosts(shape: Shape, dx: float, depth: float, dry: Sequence[str]) -> Particles:
    """The particles of `fill` no farther than `depth` [m] from a face of the shape that is not named in
    `dry`.
    """
    lattice = fill(shape, dx)
    near = distance_to(outline_less(shape, dry), lattice.position) <= depth
    return _of(lattice, near)


def wall_particles(walls: Sequence[Wall], dx: float, depth: float) -> list[Particles]:
    """Ghost layers behind each of the walls, at (k + 1/2) dx < `depth` [m] to the right of its polyline.

    Cell-centred along each segment, n = round(L/dx). Past a convex corner the layers run on to the corner's
    bisector, so that a rectangular tank whose sides are multiples of dx gets the global lattice. A particle
    is kept only if no other segment is nearer than its own, the one before it by a quarter of dx: layers meet without
    overlap in reflex corners and within thin baffles, and so do those of other walls of like motion: two tanks side by
    side share what is between them. Walls that meet end to start (`wall_chains`) have the same corners as one
    polyline: each has the particles of its own segments. Layers of a wall that stands on another's face end at that
    face, at other open ends they end with the polyline. `spacing` is (dx, dx): segments fit theirs each.
    """
    layers = (np.arange(math.ceil(depth / dx)) + 0.5) * dx
    layers = layers[layers < depth]
    position = [np.empty((0, 2)) for _ in walls]
    volume = [np.empty(0) for _ in walls]
    found = chains(walls, dx)
    for number, chain in enumerate(found):
        motion = walls[chain.owner[0]].motion
        like = [k for k, other in enumerate(found) if k != number and walls[other.owner[0]].motion == motion]
        laid = np.concatenate([np.empty((0, 2)), *(position[k] for k, w in enumerate(walls) if w.motion == motion)])
        for index, wall in enumerate(chain.owner):
            own, depths, cell = _segment_layers(chain, index, layers, dx)
            for k in like:  # halfway between two, the first one's
                deep = depths + (_TIE if k < number else -_TIE) * dx
                mine = ~_beyond(found[k].segments, own, deep, chain.segments[index])
                own, depths = own[mine], depths[mine]
            if len(laid) and len(own):
                nearest, _ = cKDTree(laid).query(own, distance_upper_bound=dx)
                own = own[nearest > _TOO_CLOSE * dx]
            laid = np.concatenate([laid, own])
            position[wall] = np.concatenate([position[wall], own])
            volume[wall] = np.concatenate([volume[wall], np.full(len(own), cell)])
    return [Particles(p, v, (dx, dx), np.eye(2)) for p, v in zip(position, volume, strict=True)]


def _beyond(faces: np.ndarray, points: np.ndarray, depths: np.ndarray, segment: np.ndarray) -> np.ndarray:
    """Whether each of `points` (n, 2), that deep (n,) [m] behind a `segment`, is nearer than that behind one of the
    `faces` (k, 2, 2), or has come out before one that looks away from the segment."""
    along, length = directions(segment), lengths(segment)
    foot = segment[0] + np.clip((points - segment[0]) @ along, 0.0, length)[:, None] * along
    found = np.zeros(len(points), dtype=bool)
    for face in faces:
        start, along, right = face[0], directions(face), right_of(directions(face))
        s, d = (points - start) @ along, (points - start) @ right
        beside = (s > 0.0) & (s < lengths(face))
        found |= beside & (d < depths) & ((d > 0.0) | ((foot - start) @ right > _TIE * depths))
    return found


def _segment_layers(chain: Chain, index: int, layers: np.ndarray, dx: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Layer particles (n, 2) [m] of one segment of a chain, cut at its corners; how deep (n,) [m] they stand; the
    volume [m²] of each."""
    segment = chain.segments[index]
    (start, end), length, direction = segment, lengths(segment), directions(segment)
    right = right_of(direction)
    count = max(1, math.floor(length / dx + 0.5))
    spacing = length / count
    before, after = _cuts(chain, index)
    first = -_columns(before, layers[-1], spacing)
    last = count + _columns(after, layers[-1], spacing)
    along = (np.arange(first, last) + 0.5) * spacing
    d, s = np.meshgrid(layers, along)
    d, s = d.ravel(), s.ravel()
    points = start + s[:, None] * direction + d[:, None] * right
    tie = _TIE * dx
    keep = distance_to(chain.segments, points) >= d - tie
    if before is not None:  # a spacing that differs from dx would leave a hole along the bisector
        others = np.delete(chain.segments, index - 1, axis=0)
        keep = (distance_to(others, points) >= d - tie) & (
            distance_to(chain.segments[index - 1][None], points) >= d - _OVERLAP * dx
        )
    if before is not None:
        keep &= (points - start) @ before.across > -before.reach * dx
    if after is not None:
        keep &= (points - end) @ after.across <= tie
    return points[keep], d[keep], float(spacing * dx)


@dataclass(frozen=True)
class _Cut:
    """Where layers end at one end of a segment.

    `across` (2,): unit vector across the cut, along the walk; `overrun`: how far, over the depth, the layers run on
    past the segment; `reach`: how far, over dx, they begin before the cut.
    """

    across: np.ndarray
    overrun: float
    reach: float


def _cuts(chain: Chain, index: int) -> tuple[_Cut | None, _Cut | None]:
    """Cuts at the start and at the end of a segment; None: layers end with the segment."""
    segments, count = chain.segments, len(chain.segments)
    here = segments[index]
    if index > 0 or chain.closed:
        before = _bisector(segments[index - 1], here)
    else:
        before = None if chain.foot is None else _face_cut(here, chain.foot.face, 1.0)
    if index + 1 < count or chain.closed:
        return before, _bisector(here, segments[(index + 1) % count])
    return before, None if chain.head is None else _face_cut(here, chain.head.face, -1.0)


def _bisector(before: np.ndarray, after: np.ndarray) -> _Cut:
    """The cut along the bisector of a corner; layers run on to it unless it turns right."""
    a, b = directions(before), directions(after)
    mean = a + b
    length = np.hypot(*mean)
    across = mean / length if length > 1e-9 else a
    cross, dot = a[0] * b[1] - a[1] * b[0], a @ b
    if cross <= 0.0 and dot > -1.0 + 1e-12:
        return _Cut(across, 0.0, _OVERLAP)
    return _Cut(across, float(np.tan(0.5 * np.arctan2(abs(cross), dot))), _OVERLAP)


def _face_cut(segment: np.ndarray, face: np.ndarray, sense: float) -> _Cut:
    """The cut along a `face` on which `segment` stands; `sense`: 1 where it starts there, -1 where it ends."""
    along, up = directions(segment), -right_of(directions(face))
    right = right_of(along)
    return _Cut(sense * up, max(0.0, float(right @ up / abs(along @ up))), 0.0)


def _columns(cut: _Cut | None, depth: float, spacing: float) -> int:
    """Number of columns by which layers run on past the end of their segment."""
    if cut is None or cut.overrun == 0.0:
        return 0
    return math.ceil(depth * min(cut.overrun, _LONGEST_MITRE) / spacing + 0.5)
