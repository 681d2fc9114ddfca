"""Model `spring`: rigid bodies in three degrees of freedom on springs and dampers; free at zero stiffness.

The equations are in rigid_floating.py.
"""

from __future__ import annotations

import math

import numpy as np

from shared.contract import SolverFailed
from solid_solver.point_model import PointModel
from solid_solver.rigid_floating import FloatingBody
from solid_solver.rigid_points import moved

STEPS_PER_PERIOD = 40
"""Steps per period of the fastest spring: only ramps and turning forces need any, the rest is exact."""


class SpringModel(PointModel):
    """All bodies of the solid (see the module's text)."""

    def _build(self) -> float:
        self._floating = [FloatingBody(self._scene, body) for body in self._bodies]
        fastest = max(float(np.max(one.stiffness / one.inertia)) for one in self._floating)
        period = 2.0 * math.pi / math.sqrt(fastest) if fastest > 0.0 else math.inf
        return min(self._scene.end_time, period / STEPS_PER_PERIOD)

    def _step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        return all([one.step(middles, dt, None if force is None else force[one.body.own]) for one in self._floating])

    def check(self) -> None:
        if self._sound and np.isfinite(self._points).all():
            return
        what = "the state is not finite" if self._sound else "the moment of turning forces was not found"
        raise SolverFailed(
            f"The rigid body failed at t = {self._time:.6g} s: {what}. Its loads turn it too far within one step: "
            "shorten coupling.window, ramp the loads, or check density and units."
        )

    def _moved(self) -> np.ndarray:
        return np.concatenate([moved(one.arm, one.pose) for one in self._floating], axis=1)

    def _arrays(self) -> dict[str, np.ndarray]:
        return {
            f"{name}_{k}": array
            for k, one in enumerate(self._floating)
            for name, array in (("pose", one.pose), ("work", one.work))
        }

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
        }
