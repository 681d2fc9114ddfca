"""Areas of a scene's shapes and what particles fill of them, worked out once: pre-flight looks at the same shapes a
hundred times."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.spatial import ConvexHull

from shared.geometry import regions
from shared.geometry.particles import fill
from shared.geometry.regions import Same, corners_of, outline_own, own_size
from shared.schema.geometry import Shape

_SLANT = 1e-6  # of dx: a face that leaves its line by less lies along it
CROWDED = 0.03  # of the rows in a gap: water at rest is stirred at 0.067, and its forces swing by twice themselves
FEW = 2e4  # cells up to which an error bound counts what particles hold too much


@lru_cache(maxsize=512)
def _area(same: Same) -> float:
    return regions.area(same.shape)


@lru_cache(maxsize=512)
def _excess(same: Same, dx: float) -> float:
    return float(np.sum(fill(same.shape, dx).volume)) / _area(same) - 1.0


def area(shape: Shape) -> float:
    """As regions.area."""
    return _area(Same(shape))


def least_extent(shape: Shape) -> float:
    """Least distance [m] of two parallel lines that a shape lies between; one of them lies along its hull."""
    if shape.rectangle is not None:
        return float(own_size(shape).min())
    hull = ConvexHull(corners_of([shape]))
    return float(np.ptp(hull.points[hull.vertices] @ hull.equations[:, :2].T, axis=0).min())


def cells(shape: Shape, dx: float) -> float:
    """Cells of spacing `dx` [m] in a shape's bounding box."""
    return float(np.prod(own_size(shape))) / dx**2


def excess(shape: Shape, dx: float, most: float) -> float:
    """What a shape's particles at spacing `dx` [m] hold beyond its area, over the area; 0 of a rectangle, which they
    fit, and of more than `most` cells, for then it is small."""
    return 0.0 if shape.rectangle is not None or cells(shape, dx) > most else _excess(Same(shape), dx)


@lru_cache(maxsize=512)
def _excess_of_inertia(same: Same, dx: float) -> float:
    (x0, y0), (x1, y1) = np.moveaxis(regions.outline(same.shape), 0, -1)
    cross = x0 * y1 - x1 * y0
    centre = np.array([cross @ (x0 + x1), cross @ (y0 + y1)]) / (6.0 * _area(same))
    polar = cross @ (x0**2 + x0 * x1 + x1**2 + y0**2 + y0 * y1 + y1**2) / 12.0
    particles = fill(same.shape, dx)
    arm = particles.position - np.average(particles.position, axis=0, weights=particles.volume)
    return float(particles.volume @ np.sum(arm**2, axis=1)) / (polar - _area(same) * centre @ centre) - 1.0


def excess_of_inertia(shape: Shape, dx: float, most: float) -> float:
    """What the polar moment of a shape's particles, as points, is beyond its own, over it; 0 of more than `most`
    cells."""
    return 0.0 if cells(shape, dx) > most else _excess_of_inertia(Same(shape), dx)


@lru_cache(maxsize=512)
def _crowding(same: Same, dx: float) -> float:
    faces, worst = outline_own(same.shape), 0.0
    for axis in (0, 1):
        along = faces[np.abs(np.diff(faces[:, :, axis], axis=1))[:, 0] < _SLANT * dx]
        places = np.unique(np.round(along[:, 0, axis] / (_SLANT * dx))) * (_SLANT * dx)
        if len(places) < 2:
            continue
        count = max(1.0, np.floor(np.ptp(faces[:, :, axis]) / dx + 0.5))
        gaps = np.diff(places) * count / np.ptp(faces[:, :, axis])
        ends = np.cumsum(np.r_[0.5, gaps])
        held = np.floor(ends[1:] + _SLANT) - np.floor(ends[:-1] + _SLANT)
        worst = max(worst, *np.abs(held / gaps - 1.0))
    return worst


def crowding(shape: Shape, dx: float) -> float:
    """By how much the rows of particles between two neighbouring faces along a shape's lattice are too many or too few
    for their distance, over it: where it is most."""
    return 0.0 if shape.rectangle is not None else _crowding(Same(shape), dx)
