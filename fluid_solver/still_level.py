"""The level of water at rest: as high as the volume of a pool needs between the faces that hold it.

Bodies of water that touch are one pool. Its faces on structures move, and what they sweep below the level the water
gains or leaves: where a plate yields the level falls. Areas are ∮ y dz over boundaries, z up and y across, of which
only what lies below the level counts. Above its first level a pool goes on as wide as it is there.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from shared.contract import SolverFailed
from shared.geometry.regions import area_below, contains, outline
from shared.geometry.segments import right_of
from shared.schema.geometry import Body

_BESIDE = 1e-3  # of a side: bodies touch where one holds a point this far off the other's
_ROUNDING = 1e-12  # of the water's height
_LEVEL = 1e-6  # of the water's height: how far its surface may slope, as rounded numbers of a turned scene have it
_FIRST_REACH, _FARTHEST = 1e-3, 1e3  # of the water's height: how far off a level is sought at first, and at last


def pools(bodies: list[Body]) -> list[int]:
    """The pool that each body of water is part of, by the first body in it."""
    pool = list(range(len(bodies)))
    for i, body in enumerate(bodies):
        segments = outline(body)
        along = segments[:, 1] - segments[:, 0]
        beside = segments.mean(axis=1) + _BESIDE * right_of(along)
        for j, other in enumerate(bodies):
            if i != j and contains(other, beside).any():
                low, high = sorted((pool[i], pool[j]))
                pool = [low if k == high else k for k in pool]
    return pool


class Level:
    """One pool's level along `up` (2,), from the outlines (k, 2, 2) [m] of its bodies, and from its faces: links
    (m, 2) between nodes that stand at `nodes` (n, 2) [m] at first, the water on the right."""

    def __init__(self, segments: np.ndarray, links: np.ndarray, nodes: np.ndarray, up: np.ndarray):
        self._axes = np.stack([right_of(up), up], axis=1)
        self._edges, self._links, self._nodes = segments @ self._axes, links, nodes @ self._axes
        z = self._edges[..., 1]
        self.first, self._extent = float(z.max()), float(np.ptp(z))
        on_top = np.all(z > self.first - _LEVEL * self._extent, axis=1)
        self._width = float(np.abs(np.diff(self._edges[on_top, :, 0])).sum())
        self._full = self._held(self.first)

    def at(self, place: np.ndarray, near: float) -> float:
        """The level [m] along `up` with the nodes at `place` (n, 2) [m]; it is sought from `near` [m] on."""
        if self._width == 0.0 or len(self._links) == 0:
            return self.first
        before, now = self._nodes, place @ self._axes
        first, second = self._links.T
        ways = [(now[second], now[first]), (now[first], before[first]), (before[first], before[second]),
                (before[second], now[second])]  # fmt: skip
        start, end = (np.concatenate(ends) for ends in zip(*ways, strict=True))

        def missing(level: float) -> float:
            return self._full - self._held(level) - area_below(start, end, level)

        reach = _FIRST_REACH * self._extent
        while not missing(near - reach) >= 0.0 >= missing(near + reach):
            reach *= 4.0
            if reach > _FARTHEST * self._extent:
                raise SolverFailed(
                    f"no level was found that holds the {self._full:.4g} m² of a pool at rest: its faces make more "
                    "room than it fills, or cross each other. Use fluid.model wcsph or ctvf."
                )
        return brentq(missing, near - reach, near + reach, xtol=_ROUNDING * self._extent)

    def _held(self, level: float) -> float:
        """Area [m²] of the pool below `level` within the faces as they stood at first."""
        return area_below(self._edges[:, 0], self._edges[:, 1], level) + max(level - self.first, 0.0) * self._width
