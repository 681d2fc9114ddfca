"""The map H between a structure's interface points and a fluid's ghosts, built once in the reference configuration.

Kinematics go x_g = H x_s: each row reproduces linear fields, hence rigid motion. Forces go F_s = Hᵀ F_g: total force,
total moment and virtual work are kept exactly (Farhat, Lesoinne & Le Tallec, Comput. Methods Appl. Mech. Engrg. 157
(1998) 95). Where a ghost coincides with a point, its row is that of the identity.

Bodies are volumes here: a structure's points and a fluid's ghosts fill the body, and each ghost follows, and loads, the
points nearest to it through the thickness. So a thin plate with water on both sides needs nothing special: the ghosts
of either side load the points below that side, and their difference bends it; both sides move with the plate.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix, identity
from scipy.spatial import cKDTree

from shared.contract import BadInput, Description, Kinematics, Loads, exchange_fields
from shared.jit import njit
from shared.linear_fit import linear_row

_COINCIDENT = 1e-9  # of the structure's spacing
LEAST_FELT = 0.5  # of what a point serves, that water reaches: with less it stands on the dry side


class Mapping:
    """H (ghosts × selected points), and `selection`: the structure's points that it touches; `weight` (2,) [Pa/m]: how
    pressure changes with place in the fluid at rest, ρ g."""

    def __init__(self, matrix: csr_matrix, selection: np.ndarray, weight: np.ndarray):
        self.matrix, self.selection, self._weight = matrix, selection, weight
        self._rows, self._columns = _compressed(matrix), _compressed(matrix.T.tocsr())
        self._identity = matrix.shape[0] == matrix.shape[1] and (matrix != identity(matrix.shape[0])).nnz == 0

    def motion(self, motion: Kinematics) -> Kinematics:
        """Structure → fluid: kinematics of the ghosts."""
        if self._identity:
            return motion
        return Kinematics(*_moved(*self._rows, *exchange_fields(motion).values()))

    def loads(self, loads: Loads, points: Kinematics, ghosts: Kinematics) -> Loads:
        """Fluid → structure: forces by the transpose; pressures as the mean over the ghosts that a point serves and
        that feel any, each as it would be at the point in fluid at rest; none where most of them feel none. `points`,
        `ghosts`: where they are."""
        if self._identity:
            return loads
        places = points.position, ghosts.position
        return Loads(*_loaded(*self._columns, self._weight, *places, loads.pressure, loads.force))


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
def _loaded(start, ghost, share, weight, points, ghosts, pressure, force):
    """Hᵀ times forces (k, 2), and means of pressures (k,) other than 0, where most are, by the sizes of the
    entries of Hᵀ."""
    mean, total = np.zeros(len(points)), np.zeros((len(points), 2))
    for point in range(len(points)):
        served = felt = p = moved = x = y = 0.0
        for k in range(start[point], start[point + 1]):
            w, g = share[k], ghost[k]
            served += abs(w)
            if pressure[g] != 0.0:
                felt += abs(w)
                p += abs(w) * pressure[g]
                arm = points[point] - ghosts[g]
                moved += abs(w) * (arm[0] * weight[0] + arm[1] * weight[1])
            x += w * force[g, 0]
            y += w * force[g, 1]
        if felt > LEAST_FELT * served:
            mean[point] = max(p + moved, min(p, 0.0)) / felt
        total[point, 0], total[point, 1] = x, y
    return mean, total


def build_mapping(structure: Description, fluid: Description, gravity: Sequence[float] = (0.0, 0.0)) -> Mapping:
    """The map between `structure`'s points and `fluid`'s ghosts, body by body, under `gravity` [m/s²].

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
    weight = fluid.numbers.get("density", 0.0) * np.asarray(gravity, dtype=float)
    return Mapping(csr_matrix((weights, (rows, local)), shape=shape), selection, weight)


def _row(place: np.ndarray, structure: Description, points: np.ndarray, tree: cKDTree):
    """Columns and weights for one ghost at `place` (2,): moving least squares, exact for 1, x and y."""
    distance, nearest = tree.query(place)
    if distance <= _COINCIDENT * structure.spacing:
        return points[[nearest]], np.ones(1)
    fit = linear_row(place, structure.position[points], tree, structure.spacing)
    if fit is None:
        raise BadInput(
            f"the ghost at ({place[0]:.6g}, {place[1]:.6g}) m has only structure points on one line round it, which "
            "cannot tell its rotation; refine solid.dx so that at least two particles lie across every body"
        )
    return points[fit[0]], fit[1]
