"""A rigid body in three degrees of freedom on springs and dampers; free at zero stiffness.

Per body, with displacement X of the centre of mass and angle θ from where it stands at t = 0:

    m Ẍ + (c + η m) Ẋ + k X = F,    I θ̈ + (cθ + η I) θ̇ + kθ θ = M(θ).

A step solves these exactly under constant F and M, of loads that change their means. Forces keep their direction while
their points turn with the body; M = Σ F·Δx/Δθ, the difference quotient over the step, so that its work is that of the
forces on their points.
"""

from __future__ import annotations

import math

import numpy as np

from shared.geometry.regions import faces
from shared.geometry.segments import lengths
from shared.jit import njit
from shared.schema.scene import Scene
from solid_solver.filled import FilledBody
from solid_solver.loads import Schedule, schedule

_MOST_ITERATIONS = 50
_FINER = 64  # steps in place of one while a load changes
_TERMS = 14  # of the exponential's series, for arguments below 1/2: exact to rounding


@njit
def propagator(mass, damping, stiffness, dt):
    """Matrix (2, 3) that takes x, ẋ Δt and F Δt²/m at a step's start to x, ẋ Δt at its end: exact for any values."""
    generator = np.zeros((3, 3))
    generator[0, 1] = generator[1, 2] = 1.0
    generator[1, 0], generator[1, 1] = -stiffness * dt * dt / mass, -damping * dt / mass
    largest = max(1.0, abs(generator[1, 0]) + abs(generator[1, 1]) + 1.0)
    halvings = max(0, math.ceil(math.log2(2.0 * largest)))
    generator /= 2.0**halvings
    term, result = np.eye(3), np.eye(3)
    for k in range(1, _TERMS + 1):
        term = term @ generator / k
        result = result + term
    for _ in range(halvings):
        result = result @ result
    return result[:2]


@njit
def _turned(cross, dot, before, after):
    """Moment, a difference quotient between two angles, of forces with Σ o×F = `cross`, Σ o·F = `dot` at angle 0."""
    mean, half = 0.5 * (before + after), 0.5 * (after - before)
    ratio = math.sin(half) / half if abs(half) > 1.0e-4 else 1.0 - half * half / 6.0
    return ratio * (math.cos(mean) * cross - math.sin(mean) * dot)


@njit
def steps(pose, work, inertia, damping, stiffness, forces, dt):
    """Advance `pose` (3, 3) of one body (values, rates, second rates) under `forces` (m, 4) per step: F, Σ o×F, Σ o·F.

    Adds their work to `work` (1,). Returns whether the moments of all steps were found.
    """
    matrices = [propagator(inertia[i], damping[i], stiffness[i], dt) for i in range(3)]
    for fx, fy, cross, dot in forces:
        before = pose[0, 2]
        after = before + dt * pose[1, 2]
        load = np.array([fx, fy, 0.0])
        settled = False
        for _ in range(_MOST_ITERATIONS):
            load[2] = _turned(cross, dot, before, after)
            row = matrices[2][0]
            found = row[0] * before + row[1] * dt * pose[1, 2] + row[2] * dt * dt * load[2] / inertia[2]
            change = abs(found - after)
            after = found
            if change <= 1.0e-14 * (1.0 + abs(after)):
                settled = True
                break
        if not settled:
            return False
        for i in range(3):
            start, push = np.array([pose[0, i], dt * pose[1, i]]), dt * dt * load[i] / inertia[i]
            pose[0, i] = matrices[i][0, 0] * start[0] + matrices[i][0, 1] * start[1] + matrices[i][0, 2] * push
            work[0] += load[i] * (pose[0, i] - start[0])
            pose[1, i] = (matrices[i][1, 0] * start[0] + matrices[i][1, 1] * start[1] + matrices[i][1, 2] * push) / dt
            pose[2, i] = (load[i] - damping[i] * pose[1, i] - stiffness[i] * pose[0, i]) / inertia[i]
    return True


class FloatingBody:
    """One body: its points about the centre of mass, mass and inertia per metre of depth, and its `pose` (3, 3)."""

    def __init__(self, scene: Scene, body: FilledBody):
        solid = scene.solid
        self.body = body
        self.centre = body.position.mean(axis=0)
        self.arm = body.position - self.centre
        mass = solid.density * body.cell * len(body.position)
        of_cells = np.sum(self.arm**2) / len(self.arm) + np.sum(body.spacing**2) / 12.0
        self.inertia = np.array([mass, mass, mass * of_cells])
        self.stiffness = np.array(solid.spring.stiffness)
        self._drag = solid.damping * self.inertia
        self.damping = np.array(solid.spring.damping) + self._drag
        self.pose = np.zeros((3, 3))
        self.pose[1] = [*body.shape.velocity, body.shape.spin]
        self.work = np.zeros(1)
        self._energy_at_start = self.kinetic()
        self._loads = self._scheduled(scene)
        now = sum((when.shares(np.zeros(1)) * load for when, load in self._loads), np.zeros(4))
        force = now[:3]
        self.pose[2] = (force - self.damping * self.pose[1]) / self.inertia
        self.step(np.empty(0), 1.0, None)  # no step: compiles before the run is timed

    def _scheduled(self, scene: Scene) -> list[tuple[Schedule, np.ndarray]]:
        """Schedule and (F, Σ o×F, Σ o·F) of each load; a traction acts at the middles of its face's segments."""
        mass, solid = self.inertia[0], scene.solid
        loads = [(Schedule(), np.array([*(mass * np.array(scene.gravity)), 0.0, 0.0]))] if solid.gravity else []
        for load in (one for one in solid.loads if one.body == self.body.shape.name):
            if load.acceleration is not None:
                loads.append((schedule(load), np.array([*(mass * np.array(load.acceleration)), 0.0, 0.0])))
                continue
            segments = faces(self.body.shape)[load.face]
            force = np.outer(lengths(segments), load.traction)
            loads.append((schedule(load), resultant(segments.mean(axis=1) - self.centre, force)))
        return loads

    def step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        """Take steps of `dt` [s] about the times `middles` under `force` (n, 2) [N/m] on the points; shorter ones while
        a load changes."""
        edges = np.append(middles - 0.5 * dt, middles[-1:] + 0.5 * dt)
        if len(middles) and not all(when.even(edges) for when, _ in self._loads):
            edges = np.linspace(edges[0], edges[-1], len(middles) * _FINER + 1)
            dt /= _FINER
        total = np.zeros((max(len(edges) - 1, 0), 4))
        for when, load in self._loads:
            total += np.outer(when.means(edges), load)
        if force is not None:
            total += resultant(self.arm, force)
        return steps(self.pose, self.work, self.inertia, self.damping, self.stiffness, total, dt)

    def kinetic(self) -> float:
        """Kinetic energy [J/m]."""
        return float(0.5 * self.inertia @ self.pose[1] ** 2)

    def stored(self) -> float:
        """Energy of the springs [J/m]."""
        return float(0.5 * self.stiffness @ self.pose[0] ** 2)

    def dissipated(self) -> float:
        """Work and initial energy less the energy left [J/m]: by the dampers."""
        return self._energy_at_start + float(self.work[0]) - self.kinetic() - self.stored()

    def reaction(self) -> np.ndarray:
        """Force (2,) [N/m] of springs and dampers on the body, without that of solid.damping."""
        dampers = self.damping - self._drag
        return -(self.stiffness * self.pose[0] + dampers * self.pose[1])[:2]

    def angular_momentum(self) -> float:
        """About the origin [N s]."""
        (x, y), (u, v) = self.centre + self.pose[0, :2], self.inertia[0] * self.pose[1, :2]
        return float(x * v - y * u + self.inertia[2] * self.pose[1, 2])


def resultant(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Fx, Fy, Σ o×F and Σ o·F (4,) of forces (n, 2) at `arm` (n, 2)."""
    cross = np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])
    return np.array([*force.sum(axis=0), cross, np.sum(arm * force)])
