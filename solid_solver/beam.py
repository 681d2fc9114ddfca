"""Model `beam`: slender rectangles as Timoshenko beams, co-rotational, implicit in time.

What is published are the points of the particle lattice, moved with their section, so that a fluid cannot tell a beam
from particles. Forces on them become forces and moments on the beam by the transposed relation. The equations are in
beam_element.py, beam_sweeps.py and beam_points.py.
"""

from __future__ import annotations

import numpy as np

from shared.contract import SolverFailed
from shared.solid_step import beam_step
from solid_solver.beam_geometry import frequency, make_beam
from solid_solver.beam_motion import MovingBeam
from solid_solver.point_model import PointModel
from solid_solver.probes import nearest_gap


class BeamModel(PointModel):
    """All bodies of the solid as beams (see the module's text)."""

    def _build(self) -> float:
        self._beams = [MovingBeam(self._scene, make_beam(self._scene, body)) for body in self._bodies]
        return beam_step(max(frequency(moving.beam, self._scene.solid.density) for moving in self._beams))

    def _step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        own = [None if force is None else force[moving.beam.body.own] for moving in self._beams]
        return all([moving.step(middles, dt, part) for moving, part in zip(self._beams, own, strict=True)])

    def check(self) -> None:
        if self._sound and np.isfinite(self._points).all():
            return
        what = (
            "the state is not finite" if self._sound else "a step found no equilibrium short of tearing or crushing it"
        )
        raise SolverFailed(
            f"The beam failed at t = {self._time:.6g} s: {what}. Its loads are too large for its stiffness within one "
            f"step (now at most {self._stable_step:.3g} s): ramp the loads, shorten coupling.window, or check units."
        )

    def particles(self) -> int:
        """Number of nodes."""
        return sum(len(moving.q) for moving in self._beams)

    def energies(self) -> tuple[float, float]:
        """Kinetic and strain energy [J/m] of all bodies."""
        kinetic, strain = np.sum([moving.energies() for moving in self._beams], axis=0)
        return float(kinetic), float(strain)

    def _moved(self) -> np.ndarray:
        return np.concatenate([moving.points() for moving in self._beams], axis=1)

    def _arrays(self) -> dict[str, np.ndarray]:
        named = [(k, moving.arrays()) for k, moving in enumerate(self._beams)]
        return {f"{name}_{k}": array for k, arrays in named for name, array in arrays.items()}

    def _stresses(self) -> dict[str, np.ndarray]:
        parts = [moving.middle_stresses() for moving in self._beams]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _gap(self, k: int) -> float:
        body = self._bodies[k]
        return nearest_gap(self._place()[body.own], body.spacing)

    def _at_point(self):
        def displacement(component):
            def at(k, point):
                beam, place = self._beams[k], self._beams[k].beam.place(point[None])
                return lambda: float(beam.displacement(*place)[component])

            return at

        def stress(name):
            def at(k, point):
                beam, place = self._beams[k], self._beams[k].beam.place(point[None])
                return lambda: float(beam.stresses(*place)[name][0])

            return at

        names = {"stress-xx": "stress_xx", "stress-yy": "stress_yy", "stress-xy": "stress_xy", "von-mises": "von_mises"}
        result = {"displacement-x": displacement(0), "displacement-y": displacement(1)}
        return result | {quantity: stress(name) for quantity, name in names.items()}

    def _of_body(self):
        beams = self._beams
        return {
            "kinetic-energy": lambda k: beams[k].energies()[0],
            "strain-energy": lambda k: beams[k].energies()[1],
            "external-work": lambda k: beams[k].work(),
            "dissipated": lambda k: beams[k].dissipated(),
            "momentum-x": lambda k: beams[k].momenta()[0],
            "momentum-y": lambda k: beams[k].momenta()[1],
            "angular-momentum": lambda k: beams[k].momenta()[2],
            "reaction-x": lambda k: float(beams[k].reaction()[0]),
            "reaction-y": lambda k: float(beams[k].reaction()[1]),
            "spacing-max": lambda k: self._gap(k),
        }
