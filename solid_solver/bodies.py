"""Elastic bodies as particle lattices, their clamped points, and values at material points.

Index units: position along the lattice's own axes over its spacings, the longer direction of the body first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from shared.contract import BadInput
from shared.geometry.motion_table import MotionTable
from shared.geometry.regions import faces
from shared.kernels import kernel_named
from shared.schema.scene import Scene
from shared.schema.solid import SolidBody
from solid_solver.clamps import FACE_POINT_WEIGHT, face_points
from solid_solver.filled import FilledBody, filled_bodies
from solid_solver.held import FIELDS, MovingClamp
from solid_solver.quadratic_fit import Fit, basis, basis_slope, quadratic_fit
from solid_solver.stencil import fast_axis_first

_ROUNDING = 9  # decimals of index units: equal neighbourhoods must be equal to the bit
_TIE = 1.0e-6  # relative: particles this equally near to a point share in its value


@dataclass(frozen=True)
class LatticeBody(FilledBody):
    """One body whose points are particles, `spacing` and `axes` those of its longer direction first. `index` (n, 2)
    whole numbers and `origin` (2,): index = axes · position / spacing − origin; `clamped` (m, 2): held points [index
    units]; `moving`: the clamps that follow a motion table; `fit`: of the derivatives."""

    index: np.ndarray
    origin: np.ndarray
    clamped: np.ndarray
    moving: tuple[MovingClamp, ...]
    fit: Fit

    @property
    def scale(self) -> np.ndarray:
        """Factors (5,) that turn derivatives by index into derivatives by length."""
        a, b = 1.0 / self.spacing
        return np.array([a, b, a * a, a * b, b * b])

    def to_index(self, points: np.ndarray) -> np.ndarray:
        """Points (m, 2) [m] of the reference configuration in index units."""
        return np.round(points @ self.axes.T / self.spacing - self.origin, _ROUNDING)

    def point_weights(
        self, points: np.ndarray, along: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Weights that give the displacement at material `points` (m, 2) [m]: f(x) = Σ w f[particle].

        With `along` (m, 2), unit vectors: weights of the derivative in their direction [1/m]. Returns rows (the point),
        columns (particle number among all bodies'), weights. From the quadratic fit about the nearest particle, or the
        mean of those equally near; exact for quadratic fields, also on faces. What clamps in motion add:
        `held_weights`.
        """
        number = {tuple(i): k for k, i in enumerate(self.index)}
        rows, columns, weights = [], [], []
        for m, a, share, p in self._fits_about(points, along):
            w = self.fit.coefficient[a] @ p
            if along is None:
                w[np.all(self.fit.offset == 0, axis=1)] += 1.0
            for k in np.flatnonzero(w):
                rows.append(m)
                columns.append(self.first + number[tuple(self.index[a] + self.fit.offset[k])])
                weights.append(w[k] * share)
        return np.array(rows), np.array(columns), np.array(weights)

    def held_weights(self, points: np.ndarray, along: np.ndarray | None = None) -> np.ndarray:
        """Weights (m, 3 clamps) of the fields of clamps in motion at `points` (m, 2) [m], as in `point_weights`."""
        result = np.zeros((len(points), self.fit.held.shape[1]))
        for m, a, share, p in self._fits_about(points, along):
            result[m] += share * (self.fit.held[a] @ p)
        return result

    def _fits_about(self, points: np.ndarray, along: np.ndarray | None):
        """For each point the particles nearest to it: (point, particle, share in the mean, p or its slope there)."""
        towards = None if along is None else along @ self.axes.T / self.spacing
        at = self.to_index(points)
        tree = cKDTree(self.index.astype(float))
        for m, near in enumerate(tree.query(at)[0]):
            owners = sorted(tree.query_ball_point(at[m], near * (1.0 + _TIE) + _TIE))
            for a in owners:
                s = at[m] - self.index[a]
                yield m, a, 1.0 / len(owners), basis(s) if along is None else basis_slope(s, towards[m])


def _lattice(body: FilledBody) -> tuple[np.ndarray, ...]:
    """Index (n, 2), spacing, axes and origin of a filled body, the longer direction first."""
    spacing, axes = body.spacing, body.axes
    scaled = body.position @ axes.T / spacing
    index = np.rint(scaled - scaled[0]).astype(np.int64)
    origin = np.mean(scaled - index, axis=0)
    order = fast_axis_first(index)
    return index[:, order], spacing[order], axes[order], origin[order]


def _held_points(scene: Scene, shape: SolidBody, axes: np.ndarray, spacing: np.ndarray):
    """Points (m, 2) [m] on the clamped faces of a body, the fields (m, 3 clamps) that they move in, those clamps."""
    outline, points, moving, owner = faces(shape), [np.zeros((0, 2))], [], []
    for clamp in (c for c in scene.solid.clamps if c.body == shape.name):
        on_face = face_points(outline[clamp.face], axes, spacing)[0]
        points.append(on_face)
        if clamp.motion is not None:
            owner.append(len(points) - 1)
            moving.append(MovingClamp(MotionTable(clamp.motion), on_face.mean(axis=0)))
    fields = [np.zeros((len(group), FIELDS * len(moving))) for group in points]
    for k, clamp in enumerate(moving):
        fields[owner[k]][:, FIELDS * k : FIELDS * (k + 1)] = clamp.fields(points[owner[k]])
    return np.concatenate(points), np.concatenate(fields), tuple(moving)


def _lattice_body(scene: Scene, filled: FilledBody) -> LatticeBody:
    solid, shape = scene.solid, filled.shape
    index, spacing, axes, origin = _lattice(filled)
    fixed, fields, moving = _held_points(scene, shape, axes, spacing)
    fixed, once = np.unique(np.round(fixed @ axes.T / spacing - origin, _ROUNDING), axis=0, return_index=True)
    fit = quadratic_fit(kernel_named(solid.kernel), solid.h_over_dx, index, fixed, FACE_POINT_WEIGHT, fields[once])
    if fit.deficient.any():
        where = filled.position[np.argmax(fit.deficient)]
        raise BadInput(
            f"Body '{shape.name}' is too thin for its particles at ({where[0]:.4g}, {where[1]:.4g}) m: derivatives "
            f"need three or more particles across, and solid.dx is {solid.dx:g} m. "
            f"Make solid.dx at most a third of the thickness."
        )
    return LatticeBody(shape, filled.first, filled.position, spacing, axes, index, origin, fixed, moving, fit)


def lattice_bodies(scene: Scene) -> list[LatticeBody]:
    """The scene's elastic bodies, particles numbered body by body. Raises BadInput for one too thin to resolve."""
    return [_lattice_body(scene, body) for body in filled_bodies(scene)]
