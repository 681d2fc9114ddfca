"""Loads of the scene as accelerations of the particles: tractions, body accelerations, gravity, and when they act."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shared.geometry.regions import faces
from shared.schema.scene import Scene
from shared.schema.solid import Load
from solid_solver.bodies import LatticeBody
from solid_solver.clamps import face_points
from solid_solver.following import FollowingLoad, following_load


def ramp_shares(times: np.ndarray, ramps: np.ndarray) -> np.ndarray:
    """Fractions (m, g) at `times` (m,) [s] of loads that grow over `ramps` (g,) [s]: half a cosine from 0 to 1."""
    progress = np.clip(times[:, None] / ramps[None, :], 0.0, 1.0)
    return 0.5 * (1.0 - np.cos(math.pi * progress))


@dataclass(frozen=True, order=True)
class Schedule:
    """When a load acts: over a `ramp` [s], or by `factors` at `times` [s]; as it stands, from t = 0 on."""

    ramp: float = 0.0
    times: tuple[float, ...] = ()
    factors: tuple[float, ...] = ()

    def shares(self, times: np.ndarray) -> np.ndarray:
        """The load's factor (m,) at `times` (m,) [s]."""
        if self.times:
            return np.interp(times, self.times, self.factors)
        if self.ramp == 0.0:
            return np.ones(len(times))
        return ramp_shares(times, np.array([self.ramp]))[:, 0]

    def means(self, edges: np.ndarray) -> np.ndarray:
        """The load's mean factor (m,) between successive `edges` (m + 1,) [s]: no pulse is lost between two times."""
        return np.diff(self._integral(edges)) / np.diff(edges)

    def even(self, edges: np.ndarray) -> bool:
        """Whether the factor stays as it is all the way from the first of `edges` [s] to the last."""
        first, last = (self.times[0], self.times[-1]) if self.times else (0.0, self.ramp)
        return edges[-1] <= first or edges[0] >= last

    def _integral(self, times: np.ndarray) -> np.ndarray:
        """Integral (m,) [s] of the factor up to `times` (m,) [s]."""
        if self.times:
            at, factor = np.array(self.times), np.array(self.factors)
            whole = np.concatenate([[0.0], np.cumsum(0.5 * (factor[1:] + factor[:-1]) * np.diff(at))])
            k = np.clip(np.searchsorted(at, times, side="right") - 1, 0, len(at) - 1)
            share = np.where(times < at[0], factor[0], 0.5 * (factor[k] + self.shares(times)))
            return whole[k] + share * (times - at[k])
        if self.ramp == 0.0:
            return times
        within = np.clip(times / self.ramp, 0.0, 1.0)
        return 0.5 * self.ramp * (within - np.sin(math.pi * within) / math.pi) + np.maximum(times - self.ramp, 0.0)


def schedule(load: Load) -> Schedule:
    """The schedule of a load of the scene."""
    if load.table is not None:
        return Schedule(times=tuple(load.table.times), factors=tuple(load.table.factors))
    return Schedule(ramp=load.ramp)


def share_table(schedules: Sequence[Schedule], times: np.ndarray) -> np.ndarray:
    """Factors (m, g) of loads with `schedules` at `times` (m,) [s]."""
    return np.array([s.shares(times) for s in schedules]).reshape(len(schedules), len(times)).T.copy()


def mean_table(schedules: Sequence[Schedule], edges: np.ndarray) -> np.ndarray:
    """Mean factors (m, g) of loads with `schedules` between successive `edges` (m + 1,) [s]."""
    return np.array([s.means(edges) for s in schedules]).reshape(len(schedules), max(len(edges) - 1, 0)).T.copy()


@dataclass(frozen=True)
class ScheduledLoads:
    """`steady` (n, 2) [m/s²], on from t = 0; `ramped` (g, n, 2) [m/s²] times their `schedules`' factors.

    `at_clamps` (1 + g, bodies, 2) [N/m]: what loads put on clamped faces directly, the steady ones' first;
    `following` (pairs of load and schedule): loads that depend on the displacement.
    """

    steady: np.ndarray
    schedules: tuple[Schedule, ...]
    ramped: np.ndarray
    at_clamps: np.ndarray
    following: tuple[tuple[FollowingLoad, Schedule], ...]

    def shares(self, times: np.ndarray) -> np.ndarray:
        """Factors (m, g) of the ramped loads at `times` (m,) [s]."""
        return share_table(self.schedules, times)

    def kicks(self, times: np.ndarray) -> np.ndarray:
        """Mean factors (m, g) of the ramped loads about `times` (m,) [s]: from halfway to the one before to halfway to
        the next."""
        return mean_table(self.schedules, np.concatenate([times[:1], 0.5 * (times[1:] + times[:-1]), times[-1:]]))

    def at(self, time: float) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] by all loads of the undeformed bodies at `time` [s]."""
        dead = self.steady + np.tensordot(self.shares(np.array([time]))[0], self.ramped, axes=1)
        return dead + self.by_following(time, np.zeros_like(dead))

    def by_following(self, time: float, displacement: np.ndarray, over: tuple[float, ...] = ()) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] by the following loads under a `displacement` (n, 2) [m] at `time` [s], with their
        mean factors between two times `over`, if given."""
        total = np.zeros_like(self.steady)
        for load, when in self.following:
            share = when.means(np.array(over)) if over else when.shares(np.array([time]))
            total += share[0] * load.acceleration(displacement, time)
        return total

    def on_clamps(self, time: float, displacement: np.ndarray) -> np.ndarray:
        """Force (bodies, 2) [N/m] that the loads put on clamped faces directly."""
        total = self.at_clamps[0] + np.tensordot(self.shares(np.array([time]))[0], self.at_clamps[1:], axes=1)
        for load, when in self.following:
            total[load.body] += when.shares(np.array([time]))[0] * load.on_clamps(displacement, time)
        return total


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


def _dead_load(load: Load, body: LatticeBody, count: int, density: float) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration (count, 2) [m/s²] by one load, and the force (2,) [N/m] that it puts on the clamps directly."""
    if load.traction is None:
        field = np.zeros((count, 2))
        field[body.own] = load.acceleration
        return field, np.zeros(2)
    force = traction_forces(body, load.face, load.traction, count)
    _, lengths = face_points(faces(body.shape)[load.face], body.axes, body.spacing)
    return force / (density * body.cell), lengths.sum() * np.asarray(load.traction) - force.sum(axis=0)


def scheduled_loads(scene: Scene, bodies: list[LatticeBody]) -> ScheduledLoads:
    """All loads of the solid, those with equal schedules summed."""
    solid = scene.solid
    count = sum(len(b.position) for b in bodies)
    dead: dict[Schedule, tuple[np.ndarray, np.ndarray]] = {}
    following = []

    def of(when: Schedule) -> tuple[np.ndarray, np.ndarray]:
        return dead.setdefault(when, (np.zeros((count, 2)), np.zeros((len(bodies), 2))))

    of(Schedule())[0][...] += np.asarray(scene.gravity) if solid.gravity else 0.0
    for load in solid.loads:
        number = next(k for k, b in enumerate(bodies) if b.shape.name == load.body)
        if load.following:
            following.append((following_load(load, number, bodies[number], count, solid.density), schedule(load)))
            continue
        acceleration, clamped = _dead_load(load, bodies[number], count, solid.density)
        field, at_clamps = of(schedule(load))
        field += acceleration
        at_clamps[number] += clamped
    steady, first = dead.pop(Schedule())
    schedules = tuple(sorted(dead))
    ramped = np.array([dead[s][0] for s in schedules]).reshape(len(schedules), count, 2)
    return ScheduledLoads(
        steady, schedules, ramped, np.array([first, *(dead[s][1] for s in schedules)]), tuple(following)
    )
