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

import numba
import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads, SolverFailed
from shared.schema import Scene
from solid_solver.bodies import LatticeBody, lattice_bodies, nearest_gap
from solid_solver.carried import Carried
from solid_solver.energies import WorkBook, lattice_energy, trapezoid
from solid_solver.initial import start_velocity, stretched
from solid_solver.interface import damped_kick, describe, kinematics_over_window, lame, viscous_time, wave_speed
from solid_solver.lattice_sweeps import SCRATCH, SUMS, derivative_sweep, steps
from solid_solver.loads import scheduled_loads
from solid_solver.probes import Observed, kinetic_energy, solid_probes, wants_work
from solid_solver.stencil import lay_out
from solid_solver.strain_gradient import STRAINS, extremes
from solid_solver.stresses import cauchy_fields

COURANT_OF_LIMIT = 0.85
"""Default step over the limit, which comes from the largest frequency ω_max, found for each scene by power iteration:
2/ω_max is 0.73 dx/c_p for a plain block (0.64 for a plate 4 particles across, 0.54 for 3). The rest is for the
iteration's own error."""

POWER_ITERATIONS = 100

TRIAL_STRAIN = 1.0e-7
"""Size of the displacement gradients by which the power iteration probes the linear stiffness."""

PARALLEL_FROM = 3000
"""Particles from which a second thread pays where no fluid is beside."""

PARALLEL_FROM_COUPLED = 20000
"""Particles from which it pays beside a busy fluid: a step is then longer than a time slice lost."""


_STILL = np.array([[1.0, 0.0], [1.0, 0.0]])  # kicks that move nothing, for forces alone


class TotalLagrangian:
    """The total-Lagrangian solid (see the module's text). Arrays named `_u`, `_v`, `_a` are (2, slots), padded."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        self._scene = scene
        self._bodies = lattice_bodies(scene)
        layout = lay_out([(b.index, b.fit, b.scale) for b in self._bodies])
        self._layout, self._slot = layout, layout.slot
        self._count = len(layout.slot)
        self._threads = threads if self._count >= (PARALLEL_FROM_COUPLED if coupled else PARALLEL_FROM) else 1
        self._position = np.concatenate([b.position for b in self._bodies])
        self._mass = scene.solid.density * np.concatenate([np.full(len(b.position), b.cell) for b in self._bodies])
        self._axes = np.array([b.axes for b in self._bodies])
        self._axis_of = np.repeat(self._axes, [len(b.position) for b in self._bodies], axis=0)
        self._moment = np.array([b.spacing**2 / 12.0 for b in self._bodies])
        self._stress = np.zeros((SUMS, layout.slots))
        self._strain = np.zeros((STRAINS, layout.slots))
        self._viscous_time = viscous_time(scene.solid)
        self._scratch = np.zeros((max(len(layout.forward.chunk), len(layout.transposed.chunk)), SCRATCH))
        self._loads = scheduled_loads(scene, self._bodies)
        self._ramped = np.array([self._padded(r) for r in self._loads.ramped]).reshape(-1, 2, layout.slots)
        self._probes = solid_probes(scene, self._bodies)
        self._u, self._v, self._a = (np.zeros((2, layout.slots)) for _ in range(3))
        self._time, self._steps = 0.0, 0
        self._reference_step = self._linear_step()
        owner = np.repeat(np.arange(len(self._bodies)), [len(b.position) for b in self._bodies])
        self._books = WorkBook(wants_work(scene), owner, self._mass, len(self._bodies))
        self._set_out()
        self._start = np.array([self._kinetic(k) + self._strain_energy(k) for k in range(len(self._bodies))])

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self.stable_step())

    def begin(self, motion: Kinematics | None) -> Kinematics:
        velocity = self._public(self._v)
        acceleration = self._public(self._a) + self._loads.at(0.0) - self._scene.solid.damping * velocity
        place = self._position + self._public(self._u)
        return Kinematics(place, velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        # The tangent stiffness of St. Venant-Kirchhoff's law along a stretch Λ is (3Λ² − 1)/2 times the linear one.
        return self._reference_step / math.sqrt(0.5 * (3.0 * self._largest_stretch_squared - 1.0))

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        numba.set_num_threads(self._threads)
        dt = (t1 - t0) / substeps
        start = self._position + self._public(self._u), self._public(self._v)
        if self._carried is not None:
            self._carry(t1)
            acceleration = self._carried.at(t1)[2]
        else:
            force = boundary.force / self._mass[:, None] if isinstance(boundary, Loads) else None
            together = 1 if self._loads.following else substeps
            for first in range(0, substeps, together):
                total = self._kick_drift(t0 + dt * np.arange(first, first + together + 1), dt, force)
            acceleration = self._public(total)
        self._steps += substeps
        self._time = t1
        self._survey()
        end = self._position + self._public(self._u), self._public(self._v)
        return kinematics_over_window(start, end, acceleration, t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        fields = {"displacement": self._u, "velocity": self._v, "acceleration": self._a, "strain": self._strain}
        return {**fields, "work": self._books.done, "time": np.array([self._time])}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        self._u[...], self._v[...], self._a[...] = state["displacement"], state["velocity"], state["acceleration"]
        self._strain[...], self._books.done[...] = state["strain"], state["work"]
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
        u, v = self._public(self._u), self._public(self._v)
        seen = Observed(
            displacement=u,
            velocity=v,
            place=self._position + u,
            speed=v,
            strain_energy=self._strain_energy,
            clamp_force=self._clamp_force,
            stress=self._stress_fields,
            gap=lambda k: nearest_gap((self._position + u)[self._bodies[k].own], self._bodies[k].spacing),
            work=self._books.done,
            start=self._start,
        )
        return {name: value(seen) for name, value in self._probes.items()}

    def frame(self) -> Frame:
        u = self._public(self._u)
        return Frame(self._position + u, {"displacement": u, "velocity": self._public(self._v)} | self._stress_fields())

    def particles(self) -> int:
        return self._count

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def _set_out(self) -> None:
        """The state at t = 0: stretched bodies with velocities and internal forces, carried where the motion says."""
        solid = self._scene.solid
        place = np.empty_like(self._position)
        for body in self._bodies:
            centre = body.position.mean(axis=0)
            self._v[:, self._slots(body)] = start_velocity(solid, body.shape, body.position, centre).T
            place[body.own] = stretched(body.shape, body.position, centre)
        self._carried = Carried(solid.motion, place) if solid.motion else None
        self._u[:, self._slot] = (place - self._position).T
        if self._carried is not None:
            self._carry(0.0)
        elif np.any(self._u):
            self._step(np.zeros_like(self._u), np.zeros((1, len(self._ramped))), _STILL, 0.0)
        self._survey()

    def _carry(self, time: float) -> None:
        place, velocity, _ = self._carried.at(time)
        self._u[:, self._slot], self._v[:, self._slot] = (place - self._position).T, velocity.T

    def _kick_drift(self, times: np.ndarray, dt: float, force: np.ndarray | None) -> np.ndarray:
        """Steps of `dt` [s] between `times` under a constant `force` (n, 2) [m/s²] beside the scene's loads.

        Returns the acceleration (2, slots) at the last time.
        """
        shares = self._loads.shares(times)
        eta = self._scene.solid.damping
        whole, half = damped_kick(eta, dt), damped_kick(eta, 0.5 * dt)
        before, load = self._public(self._u), self._steady(times[0], force)
        self._v *= half[0]
        self._v += half[1] * (self._a + self._padded(load) + np.tensordot(shares[0], self._ramped, axes=1))
        self._u += dt * self._v
        after = self._steady(times[-1], force) if self._loads.following else load
        held = self._padded(after)
        self._step(held, shares[1:], np.array([whole, half]), dt)
        if self._books.wanted:
            mean = 0.5 * (load + after) + np.tensordot(trapezoid(shares), self._loads.ramped, axes=1)
            self._books.add(mean, self._public(self._u) - before)
        return self._a + held + np.tensordot(shares[-1], self._ramped, axes=1) - eta * self._v

    def _steady(self, time: float, force: np.ndarray | None) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] by loads that are kept over a step, in the present state."""
        steady = self._loads.steady if force is None else self._loads.steady + force
        if self._loads.following:
            steady = steady + self._loads.by_following(time, self._public(self._u))
        return steady

    def _slots(self, body: LatticeBody) -> np.ndarray:
        return self._slot[body.own]

    def _kinetic(self, k: int) -> float:
        body = self._bodies[k]
        return kinetic_energy(self._mass[body.own], self._v[:, self._slots(body)].T)

    def _planes(self) -> np.ndarray:
        """Derivatives (10, n) of the displacement at the particles."""
        planes = np.zeros_like(self._stress)
        derivative_sweep(self._u, planes, self._scratch, tuple(self._layout.forward))
        return planes[:, self._slot]

    def _strain_energy(self, k: int) -> float:
        body = self._bodies[k]
        moment = np.tile(self._moment[k], (len(body.position), 1))
        density = lattice_energy(self._planes()[:, body.own], self._axis_of[body.own], moment, *lame(self._scene.solid))
        return float(body.cell * density.sum())

    def _clamp_force(self, k: int) -> np.ndarray:
        """Force (2,) [N/m] of the clamps on a body: internal forces on particles and fixed points add up to nothing."""
        body = self._bodies[k]
        inside = self._a[:, self._slots(body)] @ self._mass[body.own]
        return inside - self._loads.on_clamps(self._time, self._public(self._u))[k]

    def _stress_fields(self) -> dict[str, np.ndarray]:
        return cauchy_fields(self._planes(), self._axis_of, *lame(self._scene.solid))

    def _padded(self, field: np.ndarray) -> np.ndarray:
        """A field (n, 2) over the padded slots, (2, slots)."""
        planes = np.zeros((2, self._layout.slots))
        planes[:, self._slot] = field.T
        return planes

    def _public(self, planes: np.ndarray) -> np.ndarray:
        """A field (2, slots) in the order of the published points, (n, 2)."""
        return np.ascontiguousarray(planes[:, self._slot].T)

    def _step(self, load: np.ndarray, shares: np.ndarray, kicks: np.ndarray, dt: float) -> None:
        solid, layout = self._scene.solid, self._layout
        material = (*lame(solid), solid.density, self._viscous_time / dt if dt > 0.0 else 0.0)
        now, planes = (self._u, self._v, self._a), (self._stress, self._strain, self._scratch)
        gathers = tuple(layout.forward), tuple(layout.transposed)
        loads = load, self._ramped, shares
        steps(now, planes, gathers, self._axes, self._moment, material, loads, kicks, dt)

    def _linear_step(self) -> float:
        """Stable step of the unstrained bodies [s]: from the Courant number given, or from ω_max by power iteration."""
        solid = self._scene.solid
        dx = min(float(b.spacing.min()) for b in self._bodies)
        if solid.courant != "auto":
            return solid.courant * dx / wave_speed(solid)
        numba.set_num_threads(self._threads)
        self._u[:, self._slot] = np.random.default_rng(0).standard_normal((2, self._count))
        rest, shares = np.zeros_like(self._u), np.zeros((1, len(self._ramped)))
        omega_squared = 0.0
        for _ in range(POWER_ITERATIONS):
            self._u *= TRIAL_STRAIN * dx / np.max(np.abs(self._u))
            self._step(rest, shares, _STILL, 0.0)
            omega_squared = math.sqrt(np.sum(self._a**2) / np.sum(self._u**2))
            self._u[...] = self._a
        for field in (self._u, self._v, self._a, self._strain):
            field[...] = 0.0
        # Of v' = v − Δt ω²(x + τ v), x' = x + Δt v': Δt² + 2 τ Δt < 4/ω².
        tau = self._viscous_time
        return COURANT_OF_LIMIT * (math.sqrt(tau**2 + 4.0 / omega_squared) - tau)

    def _survey(self) -> None:
        """Note the smallest det F and the largest stretch of the present state."""
        derivative_sweep(self._u, self._stress, self._scratch, tuple(self._layout.forward))
        found = extremes(self._stress, self._slot, self._axis_of)
        self._worst_det, self._worst_particle, self._largest_stretch_squared = found
