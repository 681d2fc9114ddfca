"""Moving least squares among points: weights that give back 1, x and y exactly, and with them every rigid motion."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

SUPPORT = 2.1  # of the points' spacing: radius of the fit round a place, a ring of two neighbours on a lattice
_LEAST_SPREAD = 1e-6  # smallest eigenvalue over largest of the moment matrix: below it the points lie on a line


def linear_row(place: np.ndarray, position: np.ndarray, tree: cKDTree, spacing: float):
    """Points near `place` (2,) among those at `position` (n, 2), of `tree`, and their weights there: (m,) each.

    None where all points near it lie on one line, which cannot tell its rotation.
    """
    distance, _ = tree.query(place)
    for radius in (SUPPORT, 2.0 * SUPPORT):
        reach = max(radius * spacing, 1.5 * distance)
        near = np.array(sorted(tree.query_ball_point(place, reach)))
        offset = (position[near] - place) / reach
        kernel = (1.0 - (offset**2).sum(axis=1)).clip(1e-12) ** 2
        basis = np.column_stack([np.ones(len(near)), offset])
        moment = basis.T @ (kernel[:, None] * basis)
        values = np.linalg.eigvalsh(moment)
        if values[0] > _LEAST_SPREAD * values[-1]:
            row = kernel * (basis @ np.linalg.solve(moment, np.array([1.0, 0.0, 0.0])))
            row[np.argmax(row)] += 1.0 - row.sum()
            return near, row
    return None
