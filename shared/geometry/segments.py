"""Straight segments, start and end as rows: what they have a length, a direction and a right-hand side for.

An array of them is (..., 2, 2) [m]. Bodies are on the left of start → end in outlines and faces, so that outward is to
the right; so is the fluid of walls, whose ghosts are to the right.
"""

from __future__ import annotations

import numpy as np


def lengths(segments: np.ndarray) -> np.ndarray:
    """Length (...,) [m] of each of `segments` (..., 2, 2) [m]."""
    along = segments[..., 1, :] - segments[..., 0, :]
    return np.hypot(along[..., 0], along[..., 1])


def directions(segments: np.ndarray) -> np.ndarray:
    """Unit vectors (..., 2) from start to end of `segments` (..., 2, 2) [m], none of which is a point."""
    return (segments[..., 1, :] - segments[..., 0, :]) / lengths(segments)[..., None]


def right_of(vectors: np.ndarray) -> np.ndarray:
    """`vectors` (..., 2) turned by a quarter clockwise: of a segment's direction, the unit normal to its right."""
    return np.stack([vectors[..., 1], -vectors[..., 0]], axis=-1)
