"""Model `total-lagrangian`: neighbours fixed in the reference state, quadratic fit, energy-consistent forces.

One step, kick-drift-kick with velocities half a step behind inside a window (the equations are in lattice_sweeps.py):

    1. derivatives of the displacement from the fit, strain and its gradient, stress with its viscous part
    2. force by the transposed fit, a = force/ρ + loads
    3. v ← e v + τφ a with e = exp(−ητ), φ = (1 − e)/(ητ): a kick under constant a that solves the damping −η v exactly
    4. u ← u + Δt v
"""

from __future__ import annotations

import math

import numpy as np

from shared.contract import SolverFailed
from shared.jit import use_threads
from shared.schema.scene import Scene
from solid_solver.bodies import lattice_bodies
from solid_solver.carried import Carried
from solid_solver.damping import damped_kick
from solid_solver.energies import trapezoid
from solid_solver.initial import start_velocity, stretched
from solid_solver.lattice import Lattice
from solid_solver.particle_model import ParticleModel

PARALLEL_FROM = 3000
"""Particles from which a second thread pays where no fluid is beside."""

PARALLEL_FROM_COUPLED = 20000
"""Particles from which it pays beside a busy fluid: a step is then longer than a time slice lost."""


class TotalLagrangian(ParticleModel):
    """The total-Lagrangian solid (see the module's text)."""

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        bodies = lattice_bodies(scene)
        mass = scene.solid.density * np.concatenate([np.full(len(b.position), b.cell) for b in bodies])
        super().__init__(scene, bodies, mass)
        self._lattice = Lattice(scene.solid, bodies)
        self._threads = threads if len(mass) >= (PARALLEL_FROM_COUPLED if coupled else PARALLEL_FROM) else 1
        ramped = [self._lattice.padded(r) for r in self._loads.ramped]
        self._ramped = np.array(ramped).reshape(-1, *self._lattice.u.shape)
        use_threads(self._threads)
        self._reference_step = self._lattice.linear_step()
        self._set_out()
        self._open_books()

    def stable_step(self) -> float:
        # The tangent stiffness of St. Venant-Kirchhoff's law along a stretch Λ is (3Λ² − 1)/2 times the linear one.
        return self._reference_step / math.sqrt(0.5 * (3.0 * self._largest_stretch_squared - 1.0))

    def check(self) -> None:
        if self._worst_det > 0.0:
            return
        place = self._reference[self._worst_particle]
        what = "the state is not finite" if math.isnan(self._worst_det) else f"det F = {self._worst_det:.3g}"
        raise SolverFailed(
            f"The solid failed at t = {self._time:.6g} s: {what} at the particle with reference position "
            f"({place[0]:.5g}, {place[1]:.5g}) m, so it is turned inside out or lost. Lower solid.courant (step now at "
            f"most {self.stable_step():.3g} s), refine solid.dx, or check that the loads suit the material."
        )

    # ---- what is told of the state ----------------------------------------------------------------------------

    def _particles(self) -> tuple[np.ndarray, np.ndarray]:
        return self._reference + self._lattice.displacement, self._lattice.velocity

    def _displacement(self) -> np.ndarray:
        return self._lattice.displacement

    def _internal(self) -> np.ndarray:
        return self._lattice.acceleration

    def _strain_energy(self, k: int) -> float:
        return self._lattice.strain_energy(self._time, k)

    def _fields(self) -> dict[str, np.ndarray]:
        return self._lattice.stress_fields(self._time)

    def _arrays(self) -> dict[str, np.ndarray]:
        return self._lattice.state()

    def _survey(self) -> None:
        """Note the smallest det F and the largest stretch of the present state."""
        self._worst_det, self._worst_particle, self._largest_stretch_squared = self._lattice.survey(self._time)

    # ---- the integration --------------------------------------------------------------------------------------

    def _set_out(self) -> None:
        """The state at t = 0: stretched bodies with velocities and internal forces, carried where the motion says."""
        solid = self._scene.solid
        place, velocity = np.empty_like(self._reference), np.empty_like(self._reference)
        for body in self._bodies:
            centre = body.position.mean(axis=0)
            velocity[body.own] = start_velocity(solid, body.shape, body.position, centre)
            place[body.own] = stretched(body.shape, body.position, centre)
        self._carried = Carried(solid.motion, place) if solid.motion else None
        self._lattice.put(place - self._reference, velocity)
        if self._carried is not None:
            self._carry(0.0)
        elif np.any(self._lattice.u):
            self._lattice.find_forces(0.0)
        self._survey()

    def _carry(self, time: float) -> None:
        place, velocity, _ = self._carried.at(time)
        self._lattice.put(place - self._reference, velocity)

    def _integrate(self, t0: float, t1: float, substeps: int, force: np.ndarray | None) -> np.ndarray:
        if self._carried is not None:
            self._carry(t1)
            return self._carried.at(t1)[2]
        dt = (t1 - t0) / substeps
        together = 1 if self._loads.following else substeps
        for first in range(0, substeps, together):
            total = self._kick_drift(t0 + dt * np.arange(first, first + together + 1), dt, force)
        return self._lattice.public(total)

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
