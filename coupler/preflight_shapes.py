"""Outlines and boxes of a scene's shapes, worked out once: pre-flight looks at the same shapes a hundred times."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from shared import geometry
from shared.schema_geometry import Shape


class _Same:
    """A shape known by identity: shapes never change, and variants of a scene share them."""

    def __init__(self, shape: Shape):
        self.shape = shape

    def __hash__(self) -> int:
        return id(self.shape)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.shape is self.shape


@lru_cache(maxsize=512)
def _outline(same: _Same) -> np.ndarray:
    return geometry.outline(same.shape)


@lru_cache(maxsize=512)
def _box(same: _Same) -> tuple[np.ndarray, np.ndarray]:
    return geometry.own_box(same.shape)


@lru_cache(maxsize=512)
def _area(same: _Same) -> float:
    return geometry.area(same.shape)


@lru_cache(maxsize=512)
def _excess(same: _Same, dx: float) -> float:
    return float(np.sum(geometry.fill(same.shape, dx).volume)) / _area(same) - 1.0


def area(shape: Shape) -> float:
    """As geometry.area."""
    return _area(_Same(shape))


def excess(shape: Shape, dx: float) -> float:
    """What a shape's particles at spacing `dx` [m] hold beyond its area, over the area."""
    return _excess(_Same(shape), dx)


def outline(shape: Shape) -> np.ndarray:
    """As geometry.outline; not to be written into."""
    return _outline(_Same(shape))


def own_box(shape: Shape) -> tuple[np.ndarray, np.ndarray]:
    """As geometry.own_box; not to be written into."""
    return _box(_Same(shape))
