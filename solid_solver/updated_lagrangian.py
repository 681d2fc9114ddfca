"""Model `ctvf`: the updated-Lagrangian solid with Jaumann rate and iterative shifting (Adepu & Ramachandran).

The equations are in updated_steps.py, updated_material.py, updated_linear.py, updated_quadratic.py and shifting.py.
What is published are material tracers: each particle carries the offset to the material point that it stood on.
"""

from __future__ import annotations

import math

import numpy as np

from shared.contract import SolverFailed
from shared.elasticity import lame, plane_modulus, wave_speed
from shared.jit import use_threads
from shared.schema.scene import Scene
from shared.solid_step import UPDATED_COURANT
from solid_solver.carried import Carried
from solid_solver.damping import damped_kick
from solid_solver.energies import trapezoid
from solid_solver.particle_model import ParticleModel
from solid_solver.updated_fields import AX, RHO, M, U, V, X, Y
from solid_solver.updated_observe import failure, side_by_side, strain_energy, stresses, tracers
from solid_solver.updated_start import start
from solid_solver.updated_stepper import Stepper

PARALLEL_FROM = 3000
"""Particles from which a second thread pays, also beside a busy fluid."""


_BESIDE = 1.2
"""Distance over the spacing within which particles of a lattice stand side by side; across they stand 1.41 apart."""


class UpdatedLagrangian(ParticleModel):
    """The updated-Lagrangian solid (see the module's text)."""

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        solid, self._s = scene.solid, start(scene)
        self._S, self._slot = self._s.S, self._s.storage.free
        super().__init__(scene, self._s.bodies, self._S[M, self._slot])
        self._ramped = np.array([self._padded(r) for r in self._loads.ramped]).reshape(-1, 2, self._s.storage.slots)
        self._threads = threads if self.particles() >= PARALLEL_FROM else 1
        self._carried = Carried(solid.motion, self._rows(X)) if solid.motion else None
        if self._carried is not None:
            self._to(*self._carried.at(0.0)[:2])
        use_threads(self._threads)
        viscosity = solid.alpha * self._s.h * math.sqrt(self._moduli()[1])
        self._stepper = Stepper(self._s, solid.shifting, viscosity, self._moduli())
        reach = _BESIDE * float(self._s.spacing[self._slot].max())
        self._pairs = side_by_side(self._S[X : Y + 1], self._slot, self._s.storage.extents, reach)
        self._at_once(0.0)
        self._open_books()

    def stable_step(self) -> float:
        solid = self._scene.solid
        courant = UPDATED_COURANT[solid.gradient] if solid.courant == "auto" else solid.courant
        closest = min(1.0, self._stepper.closest())
        return courant * closest * float(self._s.spacing[self._slot].min()) / wave_speed(solid)

    def check(self) -> None:
        found = failure(self._S, self._slot, self._stepper.gauge, self._scene.solid.density, self._pairs)
        if found is None:
            return
        what, particle = found
        place = self._reference[particle]
        raise SolverFailed(
            f"The solid failed at t = {self._time:.6g} s: {what} at the particle with reference position "
            f"({place[0]:.5g}, {place[1]:.5g}) m. Lower solid.courant (step now at most {self.stable_step():.3g} s), "
            f"keep solid.shifting on, {self._better()}or use solid.model = 'total-lagrangian', which cannot fracture."
        )

    def _better(self) -> str:
        """Words on what bears larger strains than the gradient in use."""
        if self._scene.solid.gradient == "quadratic":
            return (
                "raise solid.h_over_dx (to 1.3, or 1.5 at a sharp corner or where a load pulls at a free face), refine "
                "solid.dx, "
            )
        return "use solid.gradient = 'quadratic', which bears larger strains, "

    def particles(self) -> int:
        return len(self._slot) + len(self._s.storage.held)

    # ---- what is told of the state ----------------------------------------------------------------------------

    def _particles(self) -> tuple[np.ndarray, np.ndarray]:
        return self._rows(X), self._rows(U)

    def _published(self) -> tuple[np.ndarray, np.ndarray]:
        return tracers(self._S, self._slot)

    def _displacement(self) -> np.ndarray:
        return self._published()[0] - self._reference

    def _internal(self) -> np.ndarray:
        return self._rows(AX)

    def _strain_energy(self, k: int) -> float:
        return strain_energy(self._S, self._s.storage.extents[k], self._moduli(), self._s.curvature)

    def _fields(self) -> dict[str, np.ndarray]:
        return {"density": self._S[RHO, self._slot], **stresses(self._S, self._slot, self._moduli())}

    def _arrays(self) -> dict[str, np.ndarray]:
        used = self._s.storage.used
        return {"rows": self._S[:, used], "listed_at": self._stepper.listed_at[:, used]}

    def _restored(self) -> None:
        self._stepper.list_pairs(self._stepper.listed_at)

    def _survey(self) -> None:
        self._stepper.look()

    def _rows(self, row: int) -> np.ndarray:
        """The vector in rows `row` and `row` + 1 in the order of the published points, (n, 2)."""
        return np.ascontiguousarray(self._S[row : row + 2, self._slot].T)

    def _padded(self, field: np.ndarray) -> np.ndarray:
        """A field (n, 2) over the slots, (2, slots)."""
        rows = np.zeros((2, self._s.storage.slots))
        rows[:, self._slot] = field.T
        return rows

    def _to(self, place: np.ndarray, velocity: np.ndarray) -> None:
        self._S[X : Y + 1, self._slot], self._S[U : V + 1, self._slot] = place.T, velocity.T

    # ---- the integration --------------------------------------------------------------------------------------

    def _integrate(self, t0: float, t1: float, substeps: int, force: np.ndarray | None) -> np.ndarray:
        dt = (t1 - t0) / substeps
        together = 1 if self._loads.following or self._carried is not None else substeps
        for first in range(0, substeps, together):
            times = t0 + dt * np.arange(first, first + together + 1)
            if self._carried is not None:
                acceleration = self._carry(times[-1], dt)
            else:
                acceleration = self._advance_under(times, dt, force)
        return acceleration

    def _advance_under(self, times: np.ndarray, dt: float, force: np.ndarray | None) -> np.ndarray:
        """Steps of `dt` [s] between `times` under a constant `force` (n, 2) [m/s²] beside the scene's loads.

        Returns the acceleration (n, 2) at the last time.
        """
        shares = self._loads.kicks(times)
        steady = self._loads.steady if force is None else self._loads.steady + force
        before, velocity = self._published()
        if self._loads.following:
            middle = before - self._reference + 0.5 * dt * velocity
            steady = steady + self._loads.by_following(0.5 * (times[0] + times[-1]), middle, (times[0], times[-1]))
        loads, kick = (self._padded(steady), self._ramped, shares), damped_kick(self._scene.solid.damping, 0.5 * dt)
        self._stepper.take(self._s.held.places(times), loads, dt, kick)
        if self._books.wanted:
            mean = steady + np.tensordot(trapezoid(shares), self._loads.ramped, axes=1)
            self._books.add(mean, self._published()[0] - before)
        damping = self._scene.solid.damping * self._rows(U)
        return self._rows(AX) + steady + np.tensordot(shares[-1], self._loads.ramped, axes=1) - damping

    def _carry(self, time: float, dt: float) -> np.ndarray:
        """Carry the particles to where the motion has them at `time` [s] and turn their stress, over one step."""
        place, velocity, acceleration = self._carried.at(time)
        self._S[U : V + 1, self._slot] = (place - self._rows(X)).T / dt
        self._at_once(dt)
        self._to(place, velocity)
        return acceleration

    def _at_once(self, dt: float) -> None:
        """One step of `dt` [s], 0 for forces alone, with the velocities as they are: no kicks."""
        no_load = np.zeros((2, self._s.storage.slots)), self._ramped, np.zeros((2, len(self._ramped)))
        self._stepper.take(np.zeros((2, 2, 0)), no_load, dt, (1.0, 0.0))

    def _moduli(self) -> tuple[float, float, float, float]:
        """G [Pa], c² = K/ρ0 [m²/s²], ρ0 [kg/m³], and E' [Pa] (0 but for the linear gradient: no curvature stress)."""
        solid = self._scene.solid
        lam, mu = lame(solid)
        bending = plane_modulus(solid) if self._s.order == 1 else 0.0
        return mu, (lam + 2.0 * mu / 3.0) / solid.density, solid.density, bending
