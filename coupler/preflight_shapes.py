"""Areas of a scene's shapes and what particles fill of them, worked out once: pre-flight looks at the same shapes a
hundred times."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from shared import geometry
from shared.regions import Same
from shared.schema_geometry import Shape


@lru_cache(maxsize=512)
def _area(same: Same) -> float:
    return geometry.area(same.shape)


@lru_cache(maxsize=512)
def _excess(same: Same, dx: float) -> float:
    return float(np.sum(geometry.fill(same.shape, dx).volume)) / _area(same) - 1.0


def area(shape: Shape) -> float:
    """As geometry.area."""
    return _area(Same(shape))


def excess(shape: Shape, dx: float) -> float:
    """What a shape's particles at spacing `dx` [m] hold beyond its area, over the area."""
    return _excess(Same(shape), dx)
