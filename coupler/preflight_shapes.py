"""Areas of a scene's shapes and what particles fill of them, worked out once: pre-flight looks at the same shapes a
hundred times."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from shared import geometry
from shared.regions import Same
from shared.schema_geometry import Shape

FEW = 2e4  # cells up to which an error bound counts what particles hold too much


@lru_cache(maxsize=512)
def _area(same: Same) -> float:
    return geometry.area(same.shape)


@lru_cache(maxsize=512)
def _excess(same: Same, dx: float) -> float:
    return float(np.sum(geometry.fill(same.shape, dx).volume)) / _area(same) - 1.0


def area(shape: Shape) -> float:
    """As geometry.area."""
    return _area(Same(shape))


def excess(shape: Shape, dx: float, most: float) -> float:
    """What a shape's particles at spacing `dx` [m] hold beyond its area, over the area; 0 of a rectangle, which they
    fit, and of more than `most` cells, for then it is small."""
    cells = np.prod(np.subtract(*geometry.own_box(shape)[::-1])) / dx**2
    return 0.0 if shape.rectangle is not None or cells > most else _excess(Same(shape), dx)
