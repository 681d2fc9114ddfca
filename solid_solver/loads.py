"""Loads of the scene as accelerations of the particles: tractions, body accelerations, gravity, ramps in time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from shared.geometry import faces
from shared.schema import Load, Scene
from solid_solver.bodies import LatticeBody
from solid_solver.clamps import face_points


def ramp_shares(times: np.ndarray, ramps: np.ndarray) -> np.ndarray:
    """Fractions (m, g) at `times` (m,) [s] of loads that grow over `ramps` (g,) [s]: half a cosine from 0 to 1."""
    progress = np.clip(times[:, None] / ramps[None, :], 0.0, 1.0)
    return 0.5 * (1.0 - np.cos(math.pi * progress))


@dataclass(frozen=True)
class ScheduledLoads:
    """`steady` (n, 2) [m/s²], on from t = 0; `ramped` (g, n, 2) [m/s²] grow from zero over `ramps` (g,) [s]."""

    steady: np.ndarray
    ramps: np.ndarray
    ramped: np.ndarray

    def shares(self, times: np.ndarray) -> np.ndarray:
        """Fractions (m, g) of the ramped loads that act at `times` (m,) [s]."""
        return ramp_shares(times, self.ramps)

    def at(self, time: float) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] by all loads at `time` [s]."""
        return self.steady + np.tensordot(self.shares(np.array([time]))[0], self.ramped, axes=1)


def traction_forces(body: LatticeBody, face: str, traction: tuple[float, float], count: int) -> np.ndarray:
    """Forces (count, 2) [N/m] on all particles from a dead `traction` [Pa] on a face of one body.

    The face's quadrature points share their forces out by the transposed interpolation of displacement, so that the
    work done is that of the traction on the fitted surface motion: total force and moment are exact for shear tractions
    too, although the particles stand half a spacing inside. What a point next to a clamp would put on the fixed
    points goes to the clamp.
    """
    points, lengths = face_points(faces(body.shape)[face], body.axes, body.spacing)
    row, column, weight = body.point_weights(points)
    force = np.zeros((count, 2))
    np.add.at(force, column, (weight * lengths[row])[:, None] * np.asarray(traction))
    return force


def _acceleration(load: Load, body: LatticeBody, count: int, density: float) -> np.ndarray:
    if load.traction is not None:
        return traction_forces(body, load.face, load.traction, count) / (density * body.cell)
    field = np.zeros((count, 2))
    field[body.first : body.first + len(body.position)] = load.acceleration
    return field


def scheduled_loads(scene: Scene, bodies: list[LatticeBody]) -> ScheduledLoads:
    """All loads of the solid, those with equal ramps summed."""
    solid = scene.solid
    count = sum(len(b.position) for b in bodies)
    by_ramp: dict[float, np.ndarray] = {0.0: np.zeros((count, 2))}
    if solid.gravity:
        by_ramp[0.0] += np.asarray(scene.gravity)
    for load in solid.loads:
        body = next(b for b in bodies if b.shape.name == load.body)
        field = by_ramp.setdefault(load.ramp, np.zeros((count, 2)))
        field += _acceleration(load, body, count, solid.density)
    steady = by_ramp.pop(0.0)
    ramps = sorted(by_ramp)
    return ScheduledLoads(steady, np.array(ramps), np.array([by_ramp[r] for r in ramps]).reshape(len(ramps), count, 2))
