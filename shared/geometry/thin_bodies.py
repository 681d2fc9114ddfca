"""Structures too thin for their two sides to be told apart.

A ghost carries one pressure. In a plate thinner than the kernel's support it hears the water on both faces, and water
may hear water through it. Measured (two_reservoirs), waters of 0.3 and 0.2 m either side of a plate: the net load is
7 % low at one dx of thickness (ctvf; wcsph 4 %), 3.2 % at two, 2.9 % at three, 2.1 to 2.6 % at four; with h = 2 dx,
whose support is 4 dx wide, 10, 6, 4 and 2.6 %. What is left at four is of the corner under the plate. Without it
(two_levels, h = 1.3 dx) the map thin_plate finds less than 2 % down to 1.87 dx, and at 1.85, 1.75, 1.65 and 1.55 dx the
load is 5, 6, 8 and 10 % high with wcsph, 10, 15, 22 and 26 % with ctvf.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

from shared.geometry.regions import outline
from shared.geometry.thin_walls import SPACING, THINNEST, before_water, points_along
from shared.schema.scene import Scene

_OPPOSITE = -0.7  # cosine between outward normals of faces that look away from each other


def thin_bodies(scene: Scene) -> Iterator[tuple[str, float, bool]]:
    """Of each solid body that is somewhere thinner than `THINNEST` dx: its name, its thickness there [m], and whether
    it stands in water on both faces."""
    dx = scene.fluid.dx
    for body in scene.solid.bodies if scene.solid else []:
        points, normals = points_along(outline(body)[:, ::-1], SPACING * dx)
        pairs = cKDTree(points).query_pairs(THINNEST * dx * (1.0 - 1e-9), output_type="ndarray")
        one, other = pairs[np.sum(normals[pairs[:, 0]] * normals[pairs[:, 1]], axis=1) < _OPPOSITE].T
        if len(one):
            wet = before_water(scene, points, normals)
            both = wet[one] & wet[other]
            thickness = np.hypot(*(points[one] - points[other]).T)
            yield body.name, float(thickness[both if both.any() else ...].min()), bool(both.any())
