"""Model `total-lagrangian`: neighbours fixed in the reference state, quadratic fit, energy-consistent forces.

One step, kick-drift-kick with velocities half a step behind inside a window (the equations are in lattice_sweeps.py):

    1. derivatives of the displacement from the fit, strain and its gradient, stress with its viscous part
    2. force by the transposed fit, a = force/ρ + loads
    3. v ← e v + τφ a with e = exp(−ητ), φ = (1 − e)/(ητ): a kick under constant a that solves the damping −η v exactly
    4. u ← u + Δt v
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads, SolverFailed
from shared.jit import use_threads
from shared.schema import Scene
from solid_solver.bodies import lattice_bodies
from solid_solver.carried import Carried
from solid_solver.damping import damped_kick
from solid_solver.energies import WorkBook, trapezoid
from solid_solver.filled import nearest_gap
from solid_solver.initial import start_velocity, stretched
from solid_solver.interface import describe, kinematics_over_window
from solid_solver.lattice import Lattice
from solid_solver.loads import scheduled_loads
from solid_solver.probes import Observed, kinetic_energy, solid_probes, wants_work

PARALLEL_FROM = 3000
"""Particles from which a second thread pays where no fluid is beside."""

PARALLEL_FROM_COUPLED = 20000
"""Particles from which it pays beside a busy fluid: a step is then longer than a time slice lost."""


class TotalLagrangian:
    """The total-Lagrangian solid (see the module's text). Arrays named `_u`, `_v`, `_a` are (2, slots), padded."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = lattice_bodies(scene)
        self._lattice = Lattice(scene.solid, self._bodies)
        count = self._lattice.count
        self._threads = threads if count >= (PARALLEL_FROM_COUPLED if coupled else PARALLEL_FROM) else 1
        self._position = np.concatenate([b.position for b in self._bodies])
        self._mass = scene.solid.density * np.concatenate([np.full(len(b.position), b.cell) for b in self._bodies])
        self._loads = scheduled_loads(scene, self._bodies)
        ramped = [self._lattice.padded(r) for r in self._loads.ramped]
        self._ramped = np.array(ramped).reshape(-1, *self._lattice.u.shape)
        self._probes = solid_probes(scene, self._bodies)
        self._time, self._steps = 0.0, 0
        use_threads(self._threads)
        self._reference_step = self._lattice.linear_step()
        owner = np.repeat(np.arange(len(self._bodies)), [len(b.position) for b in self._bodies])
        self._books = WorkBook(wants_work(scene), owner, self._mass, len(self._bodies))
        self._set_out()
        self._start = np.array([self._kinetic(k) + self._strain_energy(k) for k in range(len(self._bodies))])

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self.stable_step())

    def begin(self, motion: Kinematics | None) -> Kinematics:
        velocity = self._lattice.velocity
        acceleration = self._lattice.acceleration + self._loads.at(0.0) - self._scene.solid.damping * velocity
        place = self._position + self._lattice.displacement
        return Kinematics(place, velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        # The tangent stiffness of St. Venant-Kirchhoff's law along a stretch Λ is (3Λ² − 1)/2 times the linear one.
        return self._reference_step / math.sqrt(0.5 * (3.0 * self._largest_stretch_squared - 1.0))

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        use_threads(self._threads)
        dt = (t1 - t0) / substeps
        start = self._position + self._lattice.displacement, self._lattice.velocity
        if self._carried is not None:
            self._carry(t1)
            acceleration = self._carried.at(t1)[2]
        else:
            force = boundary.force / self._mass[:, None] if isinstance(boundary, Loads) else None
            together = 1 if self._loads.following else substeps
            for first in range(0, substeps, together):
                total = self._kick_drift(t0 + dt * np.arange(first, first + together + 1), dt, force)
            acceleration = self._lattice.public(total)
        self._steps += substeps
        self._time = t1
        self._survey()
        end = self._position + self._lattice.displacement, self._lattice.velocity
        return kinematics_over_window(start, end, acceleration, t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        return {**self._lattice.state(), "work": self._books.done, "time": np.array([self._time])}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        self._lattice.restore(state)
        self._books.done[...] = state["work"]
        self._time = float(state["time"][0])
        self._survey()

    def check(self) -> None:
        if self._worst_det > 0.0:
            return
        place = self._position[self._worst_particle]
        what = "the state is not finite" if math.isnan(self._worst_det) else f"det F = {self._worst_det:.3g}"
        raise SolverFailed(
            f"The solid failed at t = {self._time:.6g} s: {what} at the particle with reference position "
            f"({place[0]:.5g}, {place[1]:.5g}) m, so it is turned inside out or lost. Lower solid.courant (step now at "
            f"most {self.stable_step():.3g} s), refine solid.dx, or check that the loads suit the material."
        )

    def probe_values(self) -> dict[str, float]:
        u, v = self._lattice.displacement, self._lattice.velocity
        seen = Observed(
            displacement=u,
            velocity=v,
            place=self._position + u,
            speed=v,
            strain_energy=self._strain_energy,
            clamp_force=self._clamp_force,
            stress=lambda: self._lattice.stress_fields(self._time),
            gap=lambda k: nearest_gap((self._position + u)[self._bodies[k].own], self._bodies[k].spacing),
            work=self._books.done,
            start=self._start,
        )
        return {name: value(seen) for name, value in self._probes.items()}

    def frame(self) -> Frame:
        u = self._lattice.displacement
        fields = {"displacement": u, "velocity": self._lattice.velocity}
        return Frame(self._position + u, fields | self._lattice.stress_fields(self._time))

    def particles(self) -> int:
        return self._lattice.count

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def _set_out(self) -> None:
        """The state at t = 0: stretched bodies with velocities and internal forces, carried where the motion says."""
        solid = self._scene.solid
        place, velocity = np.empty_like(self._position), np.empty_like(self._position)
        for body in self._bodies:
            centre = body.position.mean(axis=0)
            velocity[body.own] = start_velocity(solid, body.shape, body.position, centre)
            place[body.own] = stretched(body.shape, body.position, centre)
        self._carried = Carried(solid.motion, place) if solid.motion else None
        self._lattice.put(place - self._position, velocity)
        if self._carried is not None:
            self._carry(0.0)
        elif np.any(self._lattice.u):
            self._lattice.find_forces(0.0)
        self._survey()

    def _carry(self, time: float) -> None:
        place, velocity, _ = self._carried.at(time)
        self._lattice.put(place - self._position, velocity)

    def _kick_drift(self, times: np.ndarray, dt: float, force: np.ndarray | None) -> np.ndarray:
        """Steps of `dt` [s] between `times` under a constant `force` (n, 2) [m/s²] beside the scene's loads.

        Returns the acceleration (2, slots) at the last time.
        """
        shares = self._loads.kicks(times)
        eta, lattice = self._scene.solid.damping, self._lattice
        whole, half = damped_kick(eta, dt), damped_kick(eta, 0.5 * dt)
        before, load = lattice.displacement, self._steady(times[0], force, 0.5 * dt)
        lattice.v *= half[0]
        lattice.v += half[1] * (lattice.a + lattice.padded(load) + np.tensordot(shares[0], self._ramped, axes=1))
        lattice.u += dt * lattice.v
        after = self._steady(times[-1], force, -0.5 * dt) if self._loads.following else load
        held = lattice.padded(after)
        lattice.step(times[1:], held, self._ramped, shares[1:], np.array([whole, half]), dt)
        if self._books.wanted:
            mean = 0.5 * (load + after) + np.tensordot(trapezoid(shares), self._loads.ramped, axes=1)
            self._books.add(mean, lattice.displacement - before)
        return lattice.a + held + np.tensordot(shares[-1], self._ramped, axes=1) - eta * lattice.v

    def _steady(self, time: float, force: np.ndarray | None, over: float) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] by loads that are kept over a step, in the present state: the mean from `time` to
        `over` [s] later, or before."""
        steady = self._loads.steady if force is None else self._loads.steady + force
        if self._loads.following:
            steady = steady + self._loads.by_following(time, self._lattice.displacement, (time, time + over))
        return steady

    def _kinetic(self, k: int) -> float:
        body = self._bodies[k]
        return kinetic_energy(self._mass[body.own], self._lattice.velocity[body.own])

    def _strain_energy(self, k: int) -> float:
        return self._lattice.strain_energy(self._time, k)

    def _clamp_force(self, k: int) -> np.ndarray:
        """Force (2,) [N/m] of the clamps on a body: internal forces on particles and fixed points add up to nothing."""
        body = self._bodies[k]
        inside = self._mass[body.own] @ self._lattice.acceleration[body.own]
        return inside - self._loads.on_clamps(self._time, self._lattice.displacement)[k]

    def _survey(self) -> None:
        """Note the smallest det F and the largest stretch of the present state."""
        self._worst_det, self._worst_particle, self._largest_stretch_squared = self._lattice.survey(self._time)
