"""Model `beam`: slender rectangles as Timoshenko beams, co-rotational, implicit in time.

What is published are the points of the particle lattice, moved with their section, so that a fluid cannot tell a beam
from particles. Forces on them become forces and moments on the beam by the transposed relation. The equations are in
beam_element.py, beam_sweeps.py and beam_points.py.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads, SolverFailed
from shared.schema import Scene
from shared.solid_step import beam_step
from solid_solver.beam_geometry import frequency, make_beam
from solid_solver.beam_motion import MovingBeam
from solid_solver.bodies import nearest_gap
from solid_solver.filled import body_probes, filled_bodies, largest_speed
from solid_solver.interface import describe, kinematics_over_window


class BeamModel:
    """All bodies of the solid as beams (see the module's text)."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = filled_bodies(scene)
        self._beams = [MovingBeam(scene, make_beam(scene, body)) for body in self._bodies]
        self._reference = np.concatenate([body.position for body in self._bodies])
        self._probes = body_probes(scene, self._at_point(), self._of_body())
        self._stable_step = beam_step(max(frequency(m.beam, scene.solid.density) for m in self._beams))
        self._time, self._steps, self._converged = 0.0, 0, True
        self._points = self._moved()

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self._stable_step)

    def begin(self, motion: Kinematics | None) -> Kinematics:
        _, velocity, acceleration = self._points
        return Kinematics(self._reference.copy(), velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        return self._stable_step

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        dt = (t1 - t0) / substeps
        middles = t0 + dt * (np.arange(substeps) + 0.5)
        start = self._reference + self._points[0], self._points[1]
        for moving in self._beams:
            force = boundary.force[moving.beam.body.own] if isinstance(boundary, Loads) else None
            self._converged &= moving.step(middles, dt, force)
        self._steps += substeps
        self._time = t1
        self._points = self._moved()
        end = self._reference + self._points[0], self._points[1]
        return kinematics_over_window(start, end, self._points[2], t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        result = {"time": np.array([self._time])}
        for k, moving in enumerate(self._beams):
            result |= {f"{name}_{k}": array for name, array in moving.arrays().items()}
        return result

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        for name, array in self.state().items():
            array[...] = state[name]
        self._time, self._converged = float(state["time"][0]), True
        self._points = self._moved()

    def check(self) -> None:
        if self._converged and np.isfinite(self._points).all():
            return
        what = (
            "the state is not finite"
            if self._converged
            else "a step found no equilibrium short of tearing or crushing it"
        )
        raise SolverFailed(
            f"The beam failed at t = {self._time:.6g} s: {what}. Its loads are too large for its stiffness within one "
            f"step (now at most {self._stable_step:.3g} s): ramp the loads, shorten coupling.window, or check units."
        )

    def probe_values(self) -> dict[str, float]:
        return {name: value() for name, value in self._probes.items()}

    def frame(self) -> Frame:
        displacement, velocity, _ = self._points
        parts = [moving.middle_stresses() for moving in self._beams]
        fields = {"displacement": displacement, "velocity": velocity}
        fields |= {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        return Frame(self._reference + displacement, fields)

    def particles(self) -> int:
        return sum(len(moving.q) for moving in self._beams)

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def energies(self) -> tuple[float, float]:
        """Kinetic and strain energy [J/m] of all bodies."""
        kinetic, strain = np.sum([moving.energies() for moving in self._beams], axis=0)
        return float(kinetic), float(strain)

    def _gap(self, k: int) -> float:
        body = self._bodies[k]
        return nearest_gap((self._reference + self._points[0])[body.own], body.spacing)

    def _moved(self) -> np.ndarray:
        return np.concatenate([moving.points() for moving in self._beams], axis=1)

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
            "max-speed": lambda k: largest_speed(self._points[1][self._bodies[k].own]),
        }
