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
from solid_solver.beam_element import energies, strain_rates, strains
from solid_solver.beam_geometry import Beam, beam_loads, first_period, make_beam
from solid_solver.beam_points import TERMS, add_forces, sections, spread
from solid_solver.beam_sweeps import steps
from solid_solver.filled import filled_bodies, point_probes
from solid_solver.interface import describe, kinematics_over_window
from solid_solver.loads import ramp_shares
from solid_solver.stresses import stress_fields

STEPS_PER_PERIOD = 100
"""Steps per period of the first bending mode: an accuracy limit (period 0.03 % too long, the second mode of a
cantilever 1.2 %); any step is stable."""

_MIDDLE = 0.5  # published points stand at the middle of their elements


class _Moving:
    """One beam and its state: arrays of the nodes (n + 1, 3) and of the elements (n, 3), see beam_sweeps.py."""

    def __init__(self, scene: Scene, beam: Beam):
        count = len(beam.free)
        self.beam, self.eta = beam, scene.solid.damping
        self.steady, self.ramps, self.ramped = beam_loads(scene, beam)
        self.q, self.v, self.a = (np.zeros((count, 3)) for _ in range(3))
        self.rate = np.zeros((count - 1, 3))
        self.v[beam.free, :2] = beam.axes @ np.array(beam.body.shape.velocity)
        strain_rates(self.q, self.v, beam.h, self.rate)
        force = self.steady[0] / beam.mass[:, :2] - self.eta * self.v[:, :2]
        self.a[beam.free, :2] = force[beam.free]
        self._middles = np.arange(count - 1), np.full(count - 1, _MIDDLE)
        self.step(np.empty(0), 1.0, np.zeros((len(beam.element), 2)))  # no step: compiles before the run is timed

    def step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        """Take steps of `dt` [s] about the times `middles` under `force` (m, 2) on the points; did all converge?"""
        beam, load = self.beam, self.steady
        if force is not None:
            load = load[0].copy(), load[1].copy()
            add_forces(force, beam.element, beam.offset, beam.h, beam.axes, *load)
        shares = ramp_shares(middles, self.ramps)
        state = self.q, self.v, self.a, self.rate
        return steps(state, beam.free, beam.mass, beam.h, beam.stiffness, self.eta, dt, load, self.ramped, shares) > 0

    def points(self) -> np.ndarray:
        """Displacement, velocity and acceleration of the published points, (3, m, 2)."""
        out = np.empty((3, len(self.beam.element), 2))
        spread(*self._sections(*self._middles), self.beam.element, self.beam.offset, out)
        return out

    def displacement(self, element: np.ndarray, share: np.ndarray, offset: np.ndarray) -> np.ndarray:
        """Displacement (2,) [m] of the material point at its place (see `Beam.place`), each (1,)."""
        centre, slope = self._sections(element, share)
        return (centre + offset[:, None] * slope)[0, :2]

    def energies(self) -> tuple[float, float]:
        """Kinetic and strain energy [J/m]."""
        return energies(self.q, self.v, self.beam.mass, self.beam.h, self.beam.stiffness)

    def stresses(self) -> dict[str, np.ndarray]:
        """Stress fields (m,) [Pa] at the published points: bending and axial, shear parabolic over the section."""
        beam, strain = self.beam, np.empty_like(self.rate)
        strains(self.q, beam.h, strain)
        force = strain * beam.stiffness
        e, d = beam.element, beam.offset
        axial = force[e, 0] / beam.thickness - force[e, 2] * d * 12.0 / beam.thickness**3
        shear = 1.5 * force[e, 1] / beam.thickness * (1.0 - (2.0 * d / beam.thickness) ** 2)
        theta = 0.5 * (self.q[e, 2] + self.q[e + 1, 2])
        along = np.stack([np.cos(theta), np.sin(theta)], axis=1) @ beam.axes
        c, s = along[:, 0], along[:, 1]
        twice = 2.0 * c * s
        return {
            "sxx": axial * c * c - shear * twice,
            "syy": axial * s * s + shear * twice,
            "sxy": 0.5 * axial * twice + shear * (c * c - s * s),
            "axial": axial,
        }

    def _sections(self, element: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        centre, slope = np.empty((len(element), TERMS)), np.empty((len(element), TERMS))
        sections(self.q, self.v, self.a, self.beam.h, element, share, self.beam.axes, centre, slope)
        return centre, slope


class BeamModel:
    """All bodies of the solid as beams (see the module's text)."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = filled_bodies(scene)
        self._beams = [_Moving(scene, make_beam(scene, body)) for body in self._bodies]
        self._reference = np.concatenate([body.position for body in self._bodies])
        self._probes = point_probes(scene, self._displacement, self._kinetic, self._velocity)
        period = min(first_period(m.beam, scene.solid.density) for m in self._beams)
        self._stable_step = period / STEPS_PER_PERIOD
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
            arrays = moving.q, moving.v, moving.a, moving.rate
            names = "displacement", "velocity", "acceleration", "strain_rate"
            result |= {f"{name}_{k}": array for name, array in zip(names, arrays, strict=True)}
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
        parts = [moving.stresses() for moving in self._beams]
        sxx, syy, sxy, axial = (np.concatenate([p[name] for p in parts]) for name in ("sxx", "syy", "sxy", "axial"))
        fields = {"displacement": displacement, "velocity": velocity, "axial_stress": axial}
        fields |= stress_fields(sxx, syy, self._scene.solid.poisson_ratio * axial, sxy)
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

    def _moved(self) -> np.ndarray:
        return np.concatenate([moving.points() for moving in self._beams], axis=1)

    def _displacement(self, k: int, point: np.ndarray):
        place = self._beams[k].beam.place(point[None])
        return lambda: self._beams[k].displacement(*place)

    def _kinetic(self, k: int) -> float:
        return self._beams[k].energies()[0]

    def _velocity(self, k: int) -> np.ndarray:
        return self._points[1][self._bodies[k].own]
