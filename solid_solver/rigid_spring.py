"""Model `spring`: rigid bodies in three degrees of freedom on springs and dampers; free at zero stiffness.

The equations are in rigid_floating.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads, SolverFailed
from shared.schema import Scene
from solid_solver.filled import body_probes, filled_bodies, largest_speed
from solid_solver.interface import describe_rigid, kinematics_over_window
from solid_solver.rigid_floating import FloatingBody
from solid_solver.rigid_points import moved

STEPS_PER_PERIOD = 40
"""Steps per period of the fastest spring: only ramps and turning forces need any, the rest is exact."""


class SpringModel:
    """All bodies of the solid (see the module's text)."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = filled_bodies(scene)
        self._floating = [FloatingBody(scene, body) for body in self._bodies]
        self._reference = np.concatenate([body.position for body in self._bodies])
        self._probes = body_probes(scene, self._at_point(), self._of_body())
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
        result = {"time": np.array([self._time])}
        for k, one in enumerate(self._floating):
            result |= {f"pose_{k}": one.pose, f"work_{k}": one.work}
        return result

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

    def _at_point(self):
        def displacement(component):
            def at(k, point):
                one = self._floating[k]
                return lambda: float(moved(point[None] - one.centre, one.pose)[0, 0, component])

            return at

        return {"displacement-x": displacement(0), "displacement-y": displacement(1)}

    def _of_body(self):
        bodies = self._floating
        return {
            "kinetic-energy": lambda k: bodies[k].kinetic(),
            "strain-energy": lambda k: bodies[k].stored(),
            "external-work": lambda k: float(bodies[k].work[0]),
            "dissipated": lambda k: bodies[k].dissipated(),
            "momentum-x": lambda k: float(bodies[k].inertia[0] * bodies[k].pose[1, 0]),
            "momentum-y": lambda k: float(bodies[k].inertia[1] * bodies[k].pose[1, 1]),
            "angular-momentum": lambda k: bodies[k].angular_momentum(),
            "reaction-x": lambda k: float(bodies[k].reaction()[0]),
            "reaction-y": lambda k: float(bodies[k].reaction()[1]),
            "max-speed": lambda k: largest_speed(self._points[1][self._bodies[k].own]),
        }
