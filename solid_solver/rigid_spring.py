"""Model `spring`: rigid bodies in three degrees of freedom on springs and dampers; free at zero stiffness.

Per body, with displacement X of the centre of mass and angle θ from where it stands at t = 0:

    m Ẍ + (c + η m) Ẋ + k X = F,    I θ̈ + (cθ + η I) θ̇ + kθ θ = M(θ).

A step solves these exactly under constant F and M. Forces keep their direction while their points turn with the body;
M = Σ F·Δx/Δθ, the difference quotient over the step, so that its work is that of the forces on their points.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads, SolverFailed
from shared.geometry import faces
from shared.jit import njit
from shared.schema import Scene
from solid_solver.filled import FilledBody, filled_bodies, point_probes
from solid_solver.interface import kinematics_over_window
from solid_solver.loads import ramp_shares
from solid_solver.rigid_points import describe_rigid, moved

STEPS_PER_PERIOD = 40
"""Steps per period of the fastest spring: only ramps and turning forces need any, the rest is exact."""

_MOST_ITERATIONS = 50
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
def steps(pose, inertia, damping, stiffness, forces, dt):
    """Advance `pose` (3, 3) of one body (values, rates, second rates) under `forces` (m, 4) per step: F, Σ o×F, Σ o·F.

    Returns whether the moments of all steps were found.
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
            pose[1, i] = (matrices[i][1, 0] * start[0] + matrices[i][1, 1] * start[1] + matrices[i][1, 2] * push) / dt
            pose[2, i] = (load[i] - damping[i] * pose[1, i] - stiffness[i] * pose[0, i]) / inertia[i]
    return True


class _Floating:
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
        self.damping = np.array(solid.spring.damping) + solid.damping * self.inertia
        self.pose = np.zeros((3, 3))
        self.pose[1, :2] = body.shape.velocity
        self._loads = self._scheduled(scene)
        load = self._load_at(np.array([0.0]))[0]
        force = np.array([load[0], load[1], load[2]])
        self.pose[2] = (force - self.damping * self.pose[1]) / self.inertia
        self.step(np.empty(0), 1.0, None)  # no step: compiles before the run is timed

    def _scheduled(self, scene: Scene) -> list[tuple[float, np.ndarray]]:
        """Ramp time [s] and (F, Σ o×F, Σ o·F) of each load; a traction acts at the middles of its face's segments."""
        mass, solid = self.inertia[0], scene.solid
        loads = [(0.0, np.array([*(mass * np.array(scene.gravity)), 0.0, 0.0]))] if solid.gravity else []
        for load in (one for one in solid.loads if one.body == self.body.shape.name):
            if load.acceleration is not None:
                loads.append((load.ramp, np.array([*(mass * np.array(load.acceleration)), 0.0, 0.0])))
                continue
            segments = faces(self.body.shape)[load.face]
            lengths = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
            loads.append((load.ramp, resultant(segments.mean(axis=1) - self.centre, np.outer(lengths, load.traction))))
        return loads

    def _load_at(self, times: np.ndarray) -> np.ndarray:
        total = np.zeros((len(times), 4))
        for ramp, load in self._loads:
            share = ramp_shares(times, np.array([ramp]))[:, 0] if ramp > 0.0 else np.ones(len(times))
            total += np.outer(share, load)
        return total

    def step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        """Take steps of `dt` [s] about the times `middles` under `force` (n, 2) [N/m] on the points."""
        total = self._load_at(middles)
        if force is not None:
            total += resultant(self.arm, force)
        return steps(self.pose, self.inertia, self.damping, self.stiffness, total, dt)

    def kinetic(self) -> float:
        """Kinetic energy [J/m]."""
        return float(0.5 * self.inertia @ self.pose[1] ** 2)


def resultant(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Fx, Fy, Σ o×F and Σ o·F (4,) of forces (n, 2) at `arm` (n, 2)."""
    cross = np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])
    return np.array([*force.sum(axis=0), cross, np.sum(arm * force)])


class SpringModel:
    """All bodies of the solid (see the module's text)."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = filled_bodies(scene)
        self._floating = [_Floating(scene, body) for body in self._bodies]
        self._reference = np.concatenate([body.position for body in self._bodies])
        self._probes = point_probes(scene, self._displacement, self._kinetic, self._velocity)
        fastest = max(float(np.max(one.stiffness / one.inertia)) for one in self._floating)
        period = 2.0 * math.pi / math.sqrt(fastest) if fastest > 0.0 else math.inf
        self._stable_step = min(scene.end_time, period / STEPS_PER_PERIOD)
        self._time, self._steps, self._settled = 0.0, 0, True
        self._points = self._moved()

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe_rigid(self._scene, self._bodies, self._stable_step)

    def begin(self, motion: Kinematics | None) -> Kinematics:
        _, velocity, acceleration = self._points
        return Kinematics(self._reference.copy(), velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        return self._stable_step

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        dt = (t1 - t0) / substeps
        middles = t0 + dt * (np.arange(substeps) + 0.5)
        start = self._reference + self._points[0], self._points[1]
        for one in self._floating:
            force = boundary.force[one.body.own] if isinstance(boundary, Loads) else None
            self._settled &= one.step(middles, dt, force)
        self._steps += substeps
        self._time = t1
        self._points = self._moved()
        end = self._reference + self._points[0], self._points[1]
        return kinematics_over_window(start, end, self._points[2], t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        return {"time": np.array([self._time])} | {f"pose_{k}": one.pose for k, one in enumerate(self._floating)}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        for name, array in self.state().items():
            array[...] = state[name]
        self._time, self._settled = float(state["time"][0]), True
        self._points = self._moved()

    def check(self) -> None:
        if self._settled and np.isfinite(self._points).all():
            return
        what = "the state is not finite" if self._settled else "the moment of turning forces was not found"
        raise SolverFailed(
            f"The rigid body failed at t = {self._time:.6g} s: {what}. Its loads turn it too far within one step: "
            "shorten coupling.window, ramp the loads, or check density and units."
        )

    def probe_values(self) -> dict[str, float]:
        return {name: value() for name, value in self._probes.items()}

    def frame(self) -> Frame:
        displacement, velocity, _ = self._points
        return Frame(self._reference + displacement, {"displacement": displacement, "velocity": velocity})

    def particles(self) -> int:
        return len(self._reference)

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def _moved(self) -> np.ndarray:
        return np.concatenate([moved(one.arm, one.pose) for one in self._floating], axis=1)

    def _displacement(self, k: int, point: np.ndarray):
        one = self._floating[k]
        return lambda: moved(point[None] - one.centre, one.pose)[0, 0]

    def _kinetic(self, k: int) -> float:
        return self._floating[k].kinetic()

    def _velocity(self, k: int) -> np.ndarray:
        return self._points[1][self._bodies[k].own]
