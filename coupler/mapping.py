"""The map H between a structure's interface points and a fluid's ghosts, built once in the reference configuration.

Kinematics go x_g = H x_s: each row reproduces linear fields, hence rigid motion. Forces go F_s = Hᵀ F_g: total force,
total moment and virtual work are kept exactly (Farhat, Lesoinne & Le Tallec, Comput. Methods Appl. Mech. Engrg. 157
(1998) 95). Where a ghost coincides with a point, its row is that of the identity.

Bodies are volumes here: a structure's points and a fluid's ghosts fill the body, and each ghost follows, and loads, the
points nearest to it through the thickness. So a thin plate with water on both sides needs nothing special: the ghosts
of either side load the points below that side, and their difference bends it; both sides move with the plate.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix, identity
from scipy.spatial import cKDTree

from shared.contract import BadInput, Description, Kinematics, Loads, exchange_fields
from shared.jit import njit

_COINCIDENT = 1e-9  # of the structure's spacing
_SUPPORT = 2.1  # of the structure's spacing: radius of the fit round a ghost, a ring of two neighbours on a lattice
_LEAST_SPREAD = 1e-6  # smallest eigenvalue over largest of the moment matrix: below it the points lie on a line


class Mapping:
    """H (ghosts × selected points), and `selection`: the structure's points that it touches."""

    def __init__(self, matrix: csr_matrix, selection: np.ndarray):
        self.matrix, self.selection = matrix, selection
        columns = matrix.T.tocsr()
        share = np.asarray(np.abs(columns).sum(axis=1)).ravel()
        self._rows, self._columns = _compressed(matrix), (*_compressed(columns), share)
        self._identity = matrix.shape[0] == matrix.shape[1] and (matrix != identity(matrix.shape[0])).nnz == 0

    def motion(self, motion: Kinematics) -> Kinematics:
        """Structure → fluid: kinematics of the ghosts."""
        if self._identity:
            return motion
        return Kinematics(*_moved(*self._rows, *exchange_fields(motion).values()))

    def loads(self, loads: Loads) -> Loads:
        """Fluid → structure: forces by the transpose; pressures as the mean over the ghosts that a point serves."""
        if self._identity:
            return loads
        return Loads(*_loaded(*self._columns, loads.pressure, loads.force))


def _compressed(matrix: csr_matrix) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where each row's entries start, their columns and values; unsigned, which compiled loops read twice as fast."""
    return matrix.indptr.astype(np.uint64), matrix.indices.astype(np.uint64), matrix.data


@njit
def _moved(start, column, weight, position, velocity, acceleration, velocity_mean, acceleration_mean):
    """H times each of five fields (n, 2): (5, ghosts, 2). Row k of H has entries start[k] to start[k + 1]."""
    moved = np.empty((5, len(start) - 1, 2))
    fields = (position, velocity, acceleration, velocity_mean, acceleration_mean)
    for n in range(5):
        field, result = fields[n], moved[n]
        for row in range(len(start) - 1):
            x = y = 0.0
            for k in range(start[row], start[row + 1]):
                w, point = weight[k], column[k]
                x += w * field[point, 0]
                y += w * field[point, 1]
            result[row, 0], result[row, 1] = x, y
    return moved


@njit
def _loaded(start, ghost, weight, share, pressure, force):
    """Hᵀ times forces (k, 2), and means of pressures (k,) by the sizes of the weights, which sum up to `share`."""
    mean, total = np.empty(len(share)), np.empty((len(share), 2))
    for point in range(len(share)):
        p = x = y = 0.0
        for k in range(start[point], start[point + 1]):
            w, g = weight[k], ghost[k]
            p += abs(w) * pressure[g]
            x += w * force[g, 0]
            y += w * force[g, 1]
        mean[point], total[point, 0], total[point, 1] = p / share[point], x, y
    return mean, total


def build_mapping(structure: Description, fluid: Description) -> Mapping:
    """The map between `structure`'s points and `fluid`'s ghosts, body by body.

    Raises BadInput where a ghost has too few points round it, or points on one line only, to follow a rotation.
    """
    rows, columns, weights = [], [], []
    for body in np.unique(fluid.body):
        ghosts = np.flatnonzero(fluid.body == body)
        points = np.flatnonzero(structure.body == body)
        if len(points) < 3:
            raise BadInput(
                f"the structure publishes {len(points)} interface point(s) on its body {body}, which has {len(ghosts)} "
                "ghosts in the fluid; at least three points, not on one line, are needed: refine solid.dx"
            )
        tree = cKDTree(structure.position[points])
        for ghost in ghosts:
            near, row = _row(fluid.position[ghost], structure, points, tree)
            rows += [ghost] * len(near)
            columns += list(near)
            weights += list(row)
    selection, local = np.unique(np.array(columns, dtype=np.int64), return_inverse=True)
    shape = (len(fluid.position), len(selection))
    return Mapping(csr_matrix((weights, (rows, local)), shape=shape), selection)


def _row(place: np.ndarray, structure: Description, points: np.ndarray, tree: cKDTree):
    """Columns and weights for one ghost at `place` (2,): moving least squares, exact for 1, x and y."""
    distance, nearest = tree.query(place)
    if distance <= _COINCIDENT * structure.spacing:
        return points[[nearest]], np.ones(1)
    for radius in (_SUPPORT, 2.0 * _SUPPORT):
        reach = max(radius * structure.spacing, 1.5 * distance)
        near = points[sorted(tree.query_ball_point(place, reach))]
        offset = (structure.position[near] - place) / reach
        kernel = (1.0 - (offset**2).sum(axis=1)).clip(1e-12) ** 2
        basis = np.column_stack([np.ones(len(near)), offset])
        moment = basis.T @ (kernel[:, None] * basis)
        values = np.linalg.eigvalsh(moment)
        if values[0] > _LEAST_SPREAD * values[-1]:
            row = kernel * (basis @ np.linalg.solve(moment, np.array([1.0, 0.0, 0.0])))
            row[np.argmax(row)] += 1.0 - row.sum()
            return near, row
    raise BadInput(
        f"the ghost at ({place[0]:.6g}, {place[1]:.6g}) m has only structure points on one line round it, which cannot "
        "tell its rotation; refine solid.dx so that at least two particles lie across every body"
    )
