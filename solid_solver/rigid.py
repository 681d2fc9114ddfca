"""Model `rigid`: bodies that stand still, or all follow one prescribed motion, whatever the loads."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics
from shared.motion_table import MotionTable
from shared.schema import Scene
from solid_solver.filled import body_probes, filled_bodies, largest_speed
from solid_solver.interface import describe_rigid, kinematics_over_window
from solid_solver.rigid_points import lattice_momenta, moved


class Rigid:
    """All bodies of the solid (see the module's text). The state is the time alone."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = filled_bodies(scene)
        self._reference = np.concatenate([body.position for body in self._bodies])
        self._table = MotionTable(scene.solid.motion) if scene.solid.motion else None
        self._probes = body_probes(scene, self._at_point(), self._of_body())
        self._steps = 0
        self._go_to(0.0)

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe_rigid(self._scene, self._bodies, self.stable_step())

    def begin(self, motion: Kinematics | None) -> Kinematics:
        displacement, velocity, acceleration = self._points
        return Kinematics(self._reference + displacement, velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        return self._scene.end_time  # nothing is integrated

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        start = self._reference + self._points[0], self._points[1]
        self._go_to(t1)
        self._steps += substeps
        end = self._reference + self._points[0], self._points[1]
        return kinematics_over_window(start, end, self._points[2], t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        return {"time": np.array([self._time])}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        self._go_to(float(state["time"][0]))

    def check(self) -> None:
        """Nothing can fail: the motion is the scene's."""

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

    def _go_to(self, time: float) -> None:
        self._time = time
        self._points = self._moved(self._reference)

    def _moved(self, points: np.ndarray) -> np.ndarray:
        if self._table is None:
            return np.zeros((3, *points.shape))
        return moved(points - self._table.about, self._table.at(self._time))

    def _at_point(self):
        return {
            "displacement-x": lambda k, point: lambda: float(self._moved(point[None])[0, 0, 0]),
            "displacement-y": lambda k, point: lambda: float(self._moved(point[None])[0, 0, 1]),
        }

    def _of_body(self):
        def momenta(k):
            body = self._bodies[k]
            place = self._reference[body.own] + self._points[0][body.own]
            return lattice_momenta(self._scene.solid.density * body.cell, place, self._velocity(k))

        return {
            "kinetic-energy": self._kinetic,
            "momentum-x": lambda k: momenta(k)[0],
            "momentum-y": lambda k: momenta(k)[1],
            "angular-momentum": lambda k: momenta(k)[2],
            "max-speed": lambda k: largest_speed(self._velocity(k)),
        }

    def _kinetic(self, k: int) -> float:
        body = self._bodies[k]
        return 0.5 * self._scene.solid.density * body.cell * float(np.sum(self._velocity(k) ** 2))

    def _velocity(self, k: int) -> np.ndarray:
        return self._points[1][self._bodies[k].own]
