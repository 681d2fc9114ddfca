"""A structure's own integration of pressures over its faces: F = −∫ p n ds on the deformed outline.

The outline, but for its clamped faces, is cut into pieces about as long as the spacing. Their ends follow the points
round them, by moving least squares; each carries the pressure of the point next to it, to which its force goes. The
pressure of a point is that of water which reached so far; from there to the piece it changes as water's at rest does,
by ρ g, so that the net of resting water is its weight: taken as it is, half a spacing behind every face, the buoyancy
of a block ten spacings high was a tenth too small. A plate must be thicker than the fluid's kernel reaches, or its dry
side feels the wet one's water.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix, vstack
from scipy.spatial import cKDTree

from shared.contract import BadInput, Description
from shared.geometry.particles import fill
from shared.geometry.regions import outline_less
from shared.geometry.segments import lengths, right_of
from shared.linear_fit import linear_row
from shared.schema.scene import Scene


class FaceLoads:
    """The pieces of all faces: starts and ends of theirs as means of the points, and the points next to them."""

    def __init__(self, scene: Scene, structure: Description):
        pieces = [_of_body(scene, structure, k) for k in range(len(scene.solid.bodies))]
        starts, ends, points = zip(*pieces, strict=True)
        self._starts, self._ends, self._points = vstack(starts), vstack(ends), np.concatenate(points)
        self._weight = scene.fluid.density * np.asarray(scene.gravity)  # Pa/m

    def force(self, pressure: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Force (n, 2) [N/m] on the points at `position` (n, 2) [m] under `pressure` (n,) [Pa] on them."""
        start, end, p = self._starts @ position, self._ends @ position, pressure[self._points]
        along = end - start
        outward = right_of(along)  # the body is on the left
        p = carried(p, (0.5 * (start + end) - position[self._points]) @ self._weight)
        force = np.zeros_like(position)
        np.add.at(force, self._points, -p[:, None] * outward)
        return force


def carried(pressure: np.ndarray, change: np.ndarray) -> np.ndarray:
    """`pressure` (n,) [Pa] elsewhere, where water at rest has a `change` (n,) [Pa] more of it; none where there is
    none, for water is out of reach, and tension only where there was some."""
    return np.where(pressure == 0.0, 0.0, np.maximum(pressure + change, np.minimum(pressure, 0.0)))


def _of_body(scene: Scene, structure: Description, k: int) -> tuple[csr_matrix, csr_matrix, np.ndarray]:
    """Pieces of body number k: weights (m, n) of all points in their starts and ends, and points (m,)."""
    body = scene.solid.bodies[k]
    own = np.flatnonzero(structure.body == k)
    tree, spacing = cKDTree(structure.position[own]), max(fill(body, scene.solid.dx).spacing)
    clamped = {clamp.face for clamp in scene.solid.clamps if clamp.body == body.name}
    starts, ends = [], []
    for face in outline_less(body, sorted(clamped)):
        start, end = face
        pieces = max(1, round(float(lengths(face)) / spacing))
        nodes = start + np.linspace(0.0, 1.0, pieces + 1)[:, None] * (end - start)
        starts, ends = [*starts, *nodes[:-1]], [*ends, *nodes[1:]]
    starts, ends = np.reshape(starts, (-1, 2)), np.reshape(ends, (-1, 2))
    _, nearest = tree.query(0.5 * (starts + ends))
    weights = [_weights(places, structure, own, tree) for places in (starts, ends)]
    return *weights, own[nearest]


def _weights(places: np.ndarray, structure: Description, own: np.ndarray, tree: cKDTree) -> csr_matrix:
    """Weights (m, n) of all points in `places` (m, 2) on the body of the points `own`."""
    rows, columns, weights = [], [], []
    for row, place in enumerate(places):
        fit = linear_row(place, structure.position[own], tree, structure.spacing)
        if fit is None:
            raise BadInput(
                f'coupling.loads = "pressure": round ({place[0]:.6g}, {place[1]:.6g}) m the structure has points on '
                "one line only, which its faces cannot follow; refine solid.dx so that two lie across every body"
            )
        near, values = fit
        rows += [row] * len(near)
        columns += list(own[near])
        weights += list(values)
    return csr_matrix((weights, (rows, columns)), shape=(len(places), len(structure.position)))
