"""Model `rigid`: bodies that stand still, or all follow one prescribed motion, whatever the loads."""

from __future__ import annotations

import numpy as np

from shared.geometry.motion_table import MotionTable
from solid_solver.point_model import PointModel
from solid_solver.rigid_points import lattice_momenta, moved


class Rigid(PointModel):
    """All bodies of the solid (see the module's text). The state is the time alone."""

    def _build(self) -> float:
        self._table = MotionTable(self._scene.solid.motion) if self._scene.solid.motion else None
        return self._scene.end_time  # nothing is integrated

    def _step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        return True

    def check(self) -> None:
        """Nothing can fail: the motion is the scene's."""

    def _moved(self) -> np.ndarray:
        return self._carried(self._reference)

    def _carried(self, points: np.ndarray) -> np.ndarray:
        """Displacement, velocity and acceleration (3, m, 2) of reference `points` (m, 2) [m]."""
        if self._table is None:
            return np.zeros((3, *points.shape))
        return moved(points - self._table.about, self._table.at(self._time))

    def _at_point(self):
        return {
            "displacement-x": lambda k, point: lambda: float(self._carried(point[None])[0, 0, 0]),
            "displacement-y": lambda k, point: lambda: float(self._carried(point[None])[0, 0, 1]),
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
        }

    def _kinetic(self, k: int) -> float:
        return 0.5 * self._scene.solid.density * self._bodies[k].cell * float(np.sum(self._velocity(k) ** 2))
