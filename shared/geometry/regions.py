"""Regions of the plane made from a scene's shapes: inside test, outline, named faces, distance to the
outline.

A shape stands in its *own frame*; `rotate` then turns it. Shapes nest to any depth. A circle is the inscribed
regular polygon of `CIRCLE_EDGES` edges everywhere (deviation below 1e-4 of its radius), so that inside test
and outline never disagree. Points on an edge follow one rule: left and bottom edges belong to the region,
right and top edges do not, so that touching regions share no point and leave none out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np

from shared.geometry.segments import directions, lengths, right_of
from shared.schema.geometry import Rotation, Shape

SIDES = {"left": (0, -1.0), "right": (0, 1.0), "bottom": (1, -1.0), "top": (1, 1.0)}
"""Faces of a bounding box in its own frame: axis of their outward normal, and its sense."""
CIRCLE_EDGES = 256
_PROBE = 1e-7  # offset from an edge, over the region's size, at which inside and outside are told apart
_ON_LINE = 1e-9  # distance, over the region's size, below which a point lies on a line
_CHUNK = 4_000_000  # point-segment pairs handled at once, keeps scratch arrays below 100 MB


def contains(shape: Shape, points: np.ndarray) -> np.ndarray:
    """Whether each of `points` (m, 2) [m] lies in the shape: (m,) bool."""
    return _contains_own(shape, turn(points, shape.rotate, backward=True))


def outline(shape: Shape) -> np.ndarray:
    """All outer segments (k, 2, 2) [m] as start and end; the body is on the left of start → end."""
    return turn(outline_own(shape), shape.rotate)


def faces(shape: Shape) -> dict[str, np.ndarray]:
    """Named faces as segments (k, 2, 2) [m], directed like `outline`.

    left, right, bottom, top: the outline's segments on that side of the unrotated bounding box, if there are
    any. edge-N: the polygon's edge from corner N to N + 1, numbered as written.
    """
    segments = outline_own(shape)
    lower, upper = own_box(shape)
    tolerance = _ON_LINE * np.max(upper - lower)
    named = {}
    for name, (axis, sense) in SIDES.items():
        side = lower if sense < 0.0 else upper
        on_side = np.all(np.abs(segments[:, :, axis] - side[axis]) <= tolerance, axis=1)
        if on_side.any():
            named[name] = turn(segments[on_side], shape.rotate)
    if shape.polygon is not None:
        edges = turn(_polygon_edges(shape.polygon), shape.rotate)
        named.update({f"edge-{i}": edges[i : i + 1] for i in range(len(edges))})
    return named


def own_box(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner (2,) [m] of the bounding box in the shape's own frame, before its rotation."""
    corners = outline_own(shape).reshape(-1, 2)
    if len(corners) == 0:
        return np.zeros(2), np.zeros(2)
    return corners.min(axis=0), corners.max(axis=0)


def own_size(shape: Shape) -> np.ndarray:
    """Lengths of the sides (2,) [m] of the bounding box in the shape's own frame."""
    lower, upper = own_box(shape)
    return upper - lower


def area(shape: Shape) -> float:
    """Area [m²], by Green's theorem from the outline; 0 for a difference that leaves nothing."""
    (x0, y0), (x1, y1) = np.moveaxis(outline_own(shape), 0, -1)
    return float(0.5 * np.sum(x0 * y1 - x1 * y0))


def area_below(start: np.ndarray, end: np.ndarray, level: float) -> float:
    """Σ ∫ y dz [m²] over straight ways from `start` to `end` (k, 2), y across and z up [m], as far as they lie below
    z = `level`: the area below it of what they go round with the inside on the left (Green's theorem)."""
    (y0, z0), (y1, z1) = start.T, end.T
    slope = np.divide(y1 - y0, z1 - z0, out=np.zeros_like(y0), where=z1 != z0)
    a, b = np.minimum(z0, level), np.minimum(z1, level)
    return float(np.sum((b - a) * (y0 + slope * (0.5 * (a + b) - z0))))


def distance_to(segments: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Unsigned distance (m,) [m] from each of `points` (m, 2) to the nearest of `segments` (k, 2, 2)."""
    points = np.asarray(points, dtype=float)
    nearest = np.full(len(points), np.inf)
    block = max(1, _CHUNK // max(1, len(segments)))
    start = segments[:, 0]
    along = segments[:, 1] - start
    length_squared = np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
    for first in range(0, len(points) if len(segments) else 0, block):
        offset = points[first : first + block, None, :] - start[None]
        t = np.clip((offset[..., 0] * along[:, 0] + offset[..., 1] * along[:, 1]) / length_squared, 0.0, 1.0)
        x = offset[..., 0] - t * along[:, 0]
        y = offset[..., 1] - t * along[:, 1]
        nearest[first : first + block] = np.sqrt(np.min(x * x + y * y, axis=1))
    return nearest


def axes_of(rotation: Rotation | None) -> np.ndarray:
    """Unit vectors (2, 2), one per row, of a frame turned by `rotation`."""
    if rotation is None:
        return np.eye(2)
    cosine, sine = _cosine_sine(rotation.angle)
    return np.array([[cosine, sine], [-sine, cosine]])


def turn(points: np.ndarray, rotation: Rotation | None, backward: bool = False) -> np.ndarray:
    """Points (..., 2) turned by `rotation`, or back."""
    points = np.asarray(points, dtype=float)
    if rotation is None:
        return points
    axes = axes_of(rotation)
    about = np.asarray(rotation.about)
    return (points - about) @ (axes.T if backward else axes) + about


class Same:
    """A shape known by identity, for what is worked out once: shapes never change, and variants of a scene share them,
    but a list in one keeps it from being hashed."""

    def __init__(self, shape: Shape):
        self.shape = shape

    def __hash__(self) -> int:
        return id(self.shape)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.shape is self.shape


def corners_of(shapes: Iterable[Shape]) -> np.ndarray:
    """Ends (n, 2) [m] of the outlines' segments of all `shapes`."""
    return np.concatenate([outline(shape).reshape(-1, 2) for shape in shapes])


def outline_less(shape: Shape, names: Sequence[str]) -> np.ndarray:
    """The segments of `outline` (k, 2, 2) [m] that are on none of the faces `names`."""
    segments, named = outline(shape), faces(shape)
    for name in names:
        same = np.all(segments[:, None] == named[name][None], axis=(2, 3)).any(axis=1)
        segments = segments[~same]
    return segments


def outline_own(shape: Shape) -> np.ndarray:
    """`outline` in the shape's own frame."""
    return _outline_own(Same(shape)).copy()


@lru_cache(maxsize=512)
def _outline_own(same: Same) -> np.ndarray:
    shape = same.shape
    if shape.rectangle is not None:
        x0, y0, x1, y1 = shape.rectangle
        return _ring([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    if shape.circle is not None:
        angle = 2.0 * math.pi * np.arange(CIRCLE_EDGES) / CIRCLE_EDGES
        return _ring(np.asarray(shape.circle.centre) + shape.circle.radius * np.c_[np.cos(angle), np.sin(angle)])
    if shape.polygon is not None:
        return _polygon_edges(shape.polygon)
    parts = shape.union or shape.difference
    return _clip(shape, np.concatenate([outline(part) for part in parts]))


def _contains_own(shape: Shape, points: np.ndarray) -> np.ndarray:
    if shape.rectangle is not None:
        x0, y0, x1, y1 = shape.rectangle
        x, y = points[:, 0], points[:, 1]
        return (x >= x0) & (x < x1) & (y >= y0) & (y < y1)
    if shape.circle is not None:
        return _in_circle(points - np.asarray(shape.circle.centre), shape.circle.radius)
    if shape.polygon is not None:
        return _in_polygon(_ring(shape.polygon), points)
    if shape.union is not None:
        return np.logical_or.reduce([contains(part, points) for part in shape.union])
    inside = contains(shape.difference[0], points)
    for cut in shape.difference[1:]:
        inside &= ~contains(cut, points)
    return inside


def _in_circle(offset: np.ndarray, radius: float) -> np.ndarray:
    """Inside test against the inscribed polygon: distance along the normal of the edge in whose sector a
    point lies.
    """
    sector = 2.0 * math.pi / CIRCLE_EDGES
    angle = np.arctan2(offset[:, 1], offset[:, 0])
    from_edge_normal = angle - (np.floor(angle / sector) + 0.5) * sector
    return np.hypot(offset[:, 0], offset[:, 1]) * np.cos(from_edge_normal) < radius * math.cos(0.5 * sector)


def _in_polygon(edges: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Crossing number; the half-open comparisons give the edge rule of this module."""
    x, y = points[:, 0], points[:, 1]
    inside = np.zeros(len(points), dtype=bool)
    for (x0, y0), (x1, y1) in edges:
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return inside


def _polygon_edges(corners) -> np.ndarray:
    """Edge N from corner N to N + 1, as written, each directed so that the polygon is on its left."""
    edges = _ring(corners)
    (x0, y0), (x1, y1) = edges[:, 0].T, edges[:, 1].T
    clockwise = np.sum(x0 * y1 - x1 * y0) < 0.0
    return edges[:, ::-1].copy() if clockwise else edges


def _ring(corners) -> np.ndarray:
    corners = np.asarray(corners, dtype=float)
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def _clip(shape: Shape, segments: np.ndarray) -> np.ndarray:
    """The parts of `segments` (k, 2, 2) that bound the region, directed with the region on the left, each
    once.
    """
    size = np.ptp(segments.reshape(-1, 2), axis=0).max()
    pieces = np.concatenate([_split(segment, segments, _ON_LINE * size) for segment in segments])
    pieces = pieces[lengths(pieces) > _PROBE * size]
    middle, right = pieces.mean(axis=1), right_of(directions(pieces)) * (_PROBE * size)
    in_left, in_right = _contains_own(shape, middle - right), _contains_own(shape, middle + right)
    pieces[in_right & ~in_left] = pieces[in_right & ~in_left][:, ::-1]
    pieces, middle = pieces[in_left != in_right], middle[in_left != in_right]
    _, first = np.unique(np.round(middle / (_PROBE * size)), axis=0, return_index=True)
    return pieces[np.sort(first)]


def _split(segment: np.ndarray, others: np.ndarray, tolerance: float) -> np.ndarray:
    """`segment` (2, 2) cut where any of `others` (k, 2, 2) crosses it or ends on it."""
    start, direction, length = segment[0], directions(segment), lengths(segment)
    offset = others - start
    s = offset @ direction
    d = offset[..., 1] * direction[0] - offset[..., 0] * direction[1]
    cuts = [s[np.abs(d) <= tolerance]]
    crossing = (d[:, 0] * d[:, 1] < 0.0) & (np.abs(d).min(axis=1) > tolerance)
    d0, d1 = d[crossing].T
    s0, s1 = s[crossing].T
    cuts.append(s0 + (s1 - s0) * d0 / (d0 - d1))
    at = np.concatenate(cuts)
    at = np.unique(np.r_[0.0, at[(at > tolerance) & (at < length - tolerance)], length])
    at = at[np.r_[True, np.diff(at) > tolerance]]
    at[-1] = length
    corners = start + at[:, None] * direction
    corners[0], corners[-1] = segment
    return np.stack([corners[:-1], corners[1:]], axis=1)


def _cosine_sine(degrees: float) -> tuple[float, float]:
    """Cosine and sine, exact at multiples of a right angle so that a quarter turn maps a lattice onto
    itself.
    """
    quarters, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
