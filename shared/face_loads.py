"""A structure's own integration of pressures over its faces: F = −∫ p n ds on the deformed outline.

Each face of a body that is not clamped is cut into pieces, one for every interface point next to it. A piece carries
the pressure of its point and follows the body: its normal and length are those of the line between the points next to
it along the face. A plate must be thicker than the fluid's kernel reaches, or its dry side feels the wet one's water.
"""

from __future__ import annotations

import math

import numpy as np

from shared.contract import Description
from shared.geometry import faces, fill
from shared.schema import Scene

_NEXT_TO = 0.75  # of the spacing across the face: points nearer than this to a face stand next to it


class FaceLoads:
    """The pieces of all faces: points (k,), pairs of neighbours (k, 2), and length over distance of the neighbours."""

    def __init__(self, scene: Scene, structure: Description):
        pieces = [_of_body(scene, structure, k) for k in range(len(scene.solid.bodies))]
        points, before, after, ratio = (np.concatenate(column) for column in zip(*pieces, strict=True))
        self._points = points.astype(np.int64)
        self._before, self._after = before.astype(np.int64), after.astype(np.int64)
        self._ratio = ratio

    def force(self, pressure: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Force (n, 2) [N/m] on the points at `position` (n, 2) [m] under `pressure` (n,) [Pa] on them."""
        along = (position[self._after] - position[self._before]) * self._ratio[:, None]
        outward = np.stack([along[:, 1], -along[:, 0]], axis=1)  # the body is on the left
        force = np.zeros_like(position)
        np.add.at(force, self._points, -pressure[self._points, None] * outward)
        return force


def _of_body(scene: Scene, structure: Description, k: int):
    """Pieces of body number k: points, neighbours before and after, ratio, each (m,)."""
    body = scene.solid.bodies[k]
    own = np.flatnonzero(structure.body == k)
    spacing = max(fill(body, scene.solid.dx).spacing)
    clamped = {clamp.face for clamp in scene.solid.clamps if clamp.body == body.name}
    result = [[], [], [], []]
    for name, segments in faces(body).items():
        if name in clamped:
            continue
        for start, end in segments:
            length = math.hypot(*(end - start))
            along = (end - start) / length
            s, d = (structure.position[own] - start) @ along, (structure.position[own] - start) @ [-along[1], along[0]]
            near = np.flatnonzero((d > 0.0) & (d < _NEXT_TO * spacing) & (s > 0.0) & (s < length))
            if len(near) < 2:
                continue
            near = near[np.argsort(s[near])]
            edges = np.concatenate([[0.0], 0.5 * (s[near][1:] + s[near][:-1]), [length]])
            row = own[near]
            before, after = np.r_[row[:1], row[:-1]], np.r_[row[1:], row[-1:]]
            apart = np.r_[s[near][1:], s[near][-1:]] - np.r_[s[near][:1], s[near][:-1]]
            for column, values in zip(result, (row, before, after, np.diff(edges) / apart), strict=True):
                column.append(values)
    return [np.concatenate([np.empty(0), *column]) for column in result]
