"""Following tractions: they turn and stretch with the face that carries them, as a pressure does.

With t0 the face's direction in the reference state (body on its left), n0 its outward normal, τ and σ the traction's
parts along them, and t = t0 + ∂u/∂s the deformed face's tangent per reference length (not a unit vector), n its
quarter turn clockwise, the force per reference length is τ t + σ n: the same traction per deformed length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from shared.geometry.regions import faces
from shared.geometry.segments import directions, right_of
from shared.schema.solid import Load
from solid_solver.bodies import LatticeBody
from solid_solver.clamps import face_points
from solid_solver.held import MovingClamp, sizes


@dataclass(frozen=True)
class FollowingLoad:
    """One following traction on a face of body number `body`.

    `values`, `slopes` (m, n): weights that give the displacement of the face's m points, and its derivative along the
    face, to which its `moving` clamps add by `held` (m, g); `tangent` (m, 2): t0; `along`, `outward` (m,): τ and σ
    times the length of each point [N/m]; `mass` [kg/m] of a particle.
    """

    body: int
    values: csr_array
    slopes: csr_array
    held: np.ndarray
    moving: tuple[MovingClamp, ...]
    tangent: np.ndarray
    along: np.ndarray
    outward: np.ndarray
    mass: float

    def forces(self, displacement: np.ndarray, time: float) -> np.ndarray:
        """Forces (m, 2) [N/m] on the face's points under a displacement (n, 2) [m] of the particles at `time` [s]."""
        t = self.tangent + self.slopes @ displacement + self.held @ sizes(self.moving, np.array([time]))[0]
        return self.along[:, None] * t + self.outward[:, None] * right_of(t)

    def acceleration(self, displacement: np.ndarray, time: float) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] of the particles."""
        return self.values.T @ self.forces(displacement, time) / self.mass

    def on_clamps(self, displacement: np.ndarray, time: float) -> np.ndarray:
        """Force (2,) [N/m] that goes to clamped faces directly."""
        forces = self.forces(displacement, time)
        return forces.sum(axis=0) - (self.values.T @ forces).sum(axis=0)


def following_load(load: Load, number: int, body: LatticeBody, count: int, density: float) -> FollowingLoad:
    """A `load` of the scene on `body`, which is number `number` of the solid with `count` particles in all."""
    segments = faces(body.shape)[load.face]
    points, lengths, tangents = [], [], []
    for segment in segments:
        at, length = face_points(segment[None], body.axes, body.spacing)
        points.append(at)
        lengths.append(length)
        tangents.append(np.tile(directions(segment), (len(at), 1)))
    points, lengths, tangent = map(np.concatenate, (points, lengths, tangents))
    shape = (len(points), count)
    row, column, weight = body.point_weights(points)
    values = csr_array((weight, (row, column)), shape=shape)
    row, column, weight = body.point_weights(points, tangent)
    slopes = csr_array((weight, (row, column)), shape=shape)
    traction = np.asarray(load.traction)
    return FollowingLoad(
        number,
        values,
        slopes,
        body.held_weights(points, tangent),
        body.moving,
        tangent,
        lengths * (tangent @ traction),
        lengths * (right_of(tangent) @ traction),
        density * body.cell,
    )
