"""Model `ctvf`: the updated-Lagrangian solid with Jaumann rate and iterative shifting (Adepu & Ramachandran).

The equations are in updated_sweeps.py, updated_material.py and shifting.py. Clamped faces carry fixed particles that
take part in the stress: on the face, with a whole cell each, under the corrected gradient; columns that fill the
kernel's support beyond the face under the printed one, whose sums need them. What is published are material tracers:
each particle carries the offset to the material point that it stood on at the start.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numba
import numpy as np
from scipy.spatial import cKDTree

from shared.contract import Description, Exchange, Frame, Kinematics, Loads, SolverFailed
from shared.kernels import kernel_named
from shared.schema import Scene
from solid_solver.bodies import lattice_bodies, nearest_gap
from solid_solver.carried import Carried
from solid_solver.clamps import FACE_POINT_WEIGHT, fixed_particles
from solid_solver.energies import WorkBook, stress_energy, trapezoid
from solid_solver.initial import prestrain, start_velocity, stretched
from solid_solver.interface import damped_kick, describe, kinematics_over_window, lame, wave_speed
from solid_solver.loads import scheduled_loads
from solid_solver.probes import Observed, kinetic_energy, solid_probes, wants_work
from solid_solver.shifting import NEEDED, shift, short_range
from solid_solver.stresses import stress_fields
from solid_solver.updated_material import update_material
from solid_solver.updated_quadratic import TERMS, chunks
from solid_solver.updated_sweeps import (
    extreme_density,
    moved_too_far,
    nearest_distances,
    steps,
    velocity_derivatives,
)

ORDERS = {"printed": 0, "linear": 1, "quadratic": 2}
"""Polynomials whose gradient is exact, by `solid.gradient`."""

COURANT = (0.7, 0.7, 0.45)
"""Default step over dx/c_p by the gradient's order. With the linear one 1.0 still runs the clamped beam at α = 1 and
ν = 0 … 0.4; with the quadratic, whose second derivatives are stiffer, 0.5 a strip at ν = 0 … 0.49 and 0.6 does not."""

SKIN = 0.6
"""Width of the neighbour list's skin over the spacing: half of it may be walked before the list is made anew."""

PARALLEL_FROM = 4000
"""Particles from which a second thread pays, also beside a busy fluid."""

FRACTURE_GAP = 2.0
"""Distance to the nearest particle, over the spacing, past which the body has come apart."""

DENSITY_RANGE = 3.0
"""Factor on the reference density, up and down, past which the state is absurd."""


class UpdatedLagrangian:
    """The updated-Lagrangian solid (see the module's text). Free particles come first, then the fixed ones."""

    role = "structure"

    def __init__(self, scene: Scene, coupled: bool, threads: int):
        solid = scene.solid
        self._scene, self._coupled = scene, coupled
        self._bodies = lattice_bodies(scene)
        self._kernel = kernel_named(solid.kernel)
        self._reference = np.concatenate([b.position for b in self._bodies])
        self._free = len(self._reference)
        self._order = ORDERS[solid.gradient]
        beyond = 0.0 if self._order else self._kernel.support * solid.h_over_dx
        share = FACE_POINT_WEIGHT if self._order == 2 else 1.0
        fixed = [fixed_particles(b, solid.clamps, beyond, share) for b in self._bodies]
        sizes = [len(b.position) for b in self._bodies]
        self._body = np.repeat(np.tile(np.arange(len(sizes)), 2), [*sizes, *(len(p) for p, _ in fixed)])
        self._spacing = np.array([b.spacing.min() for b in self._bodies])[self._body]
        if not beyond:
            self._spacing[self._free :] *= 0.5  # the outermost particles stand half a spacing from the face
        self._h = solid.h_over_dx * max(math.sqrt(b.cell) for b in self._bodies)
        areas = [np.full(n, b.cell) for n, b in zip(sizes, self._bodies, strict=True)]
        self._mass = solid.density * np.concatenate([*areas, *(area for _, area in fixed)])
        self._x = np.ascontiguousarray(np.concatenate([self._reference, *(points for points, _ in fixed)]).T)
        count = self._x.shape[1]
        self._u, self._a = np.zeros((2, count)), np.zeros((2, self._free))
        self._volume = self._mass / solid.density
        self._rho, self._stress = np.full(count, solid.density), np.zeros((4, count))
        self._curvature = np.zeros((6 if self._order == 2 else 2, count))
        self._offset = np.zeros((2, count))
        self._sums = np.zeros((10, count)), np.zeros((7, count)), np.zeros((10, count))  # derivatives, correction, flux
        fitted = count if self._order == 2 else 0
        self._fits = np.zeros((TERMS * TERMS, fitted)), np.zeros((chunks(fitted), TERMS, 2 * TERMS))
        self._crowding, self._nearest = np.zeros(self._free), np.zeros(self._free)
        self._loads = scheduled_loads(scene, self._bodies)
        self._ramped = np.ascontiguousarray(self._loads.ramped.transpose(0, 2, 1))
        self._probes = solid_probes(scene, self._bodies)
        self._threads = threads if count >= PARALLEL_FROM else 1
        self._time, self._steps = 0.0, 0
        own = self._body[: self._free]
        self._books = WorkBook(wants_work(scene), own, self._mass[: self._free], len(self._bodies))
        self._set_out()
        self._start = np.array([self._kinetic(k) + self._strain_energy(k) for k in range(len(self._bodies))])

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self.stable_step())

    def begin(self, motion: Kinematics | None) -> Kinematics:
        velocity = self._u[:, : self._free].T.copy()
        acceleration = self._loads.at(0.0) - self._scene.solid.damping * velocity
        return Kinematics(
            self._x[:, : self._free].T.copy(), velocity, acceleration, velocity.copy(), acceleration.copy()
        )

    def stable_step(self) -> float:
        solid = self._scene.solid
        courant = COURANT[self._order] if solid.courant == "auto" else solid.courant
        closest = min(1.0, float(self._nearest.min())) * float(self._spacing[: self._free].min())
        return courant * closest / wave_speed(solid)

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        numba.set_num_threads(self._threads)
        dt = (t1 - t0) / substeps
        start = self._tracers()
        force = boundary.force / self._mass[: self._free, None] if isinstance(boundary, Loads) else None
        together = 1 if self._loads.following or self._carried is not None else substeps
        for first in range(0, substeps, together):
            times = t0 + dt * np.arange(first, first + together + 1)
            if self._carried is not None:
                acceleration = self._carry(times[-1], dt)
            else:
                acceleration = self._advance_under(times, dt, force)
        self._steps += substeps
        self._time = t1
        self._survey()
        return kinematics_over_window(start, self._tracers(), acceleration, t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        return {
            "position": self._x,
            "velocity": self._u,
            "acceleration": self._a,
            "density": self._rho,
            "stress": self._stress,
            "curvature_stress": self._curvature,
            "offset": self._offset,
            "derivatives": self._sums[0],
            "correction": self._sums[1],
            "listed_at": self._built,
            "work": self._books.done,
            "time": np.array([self._time]),
        }

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        for name, array in self.state().items():
            array[...] = state[name]
        self._time = float(state["time"][0])
        np.divide(self._mass, self._rho, out=self._volume)
        self._find_neighbours(state["listed_at"])
        self._survey()

    def check(self) -> None:
        density = self._scene.solid.density
        low, high, lowest, highest = extreme_density(self._rho, self._stress)
        gap = self._nearest
        if math.isnan(low):
            what, particle = "the state is not finite", lowest
        elif low < density / DENSITY_RANGE or high > density * DENSITY_RANGE:
            particle = lowest if low < density / DENSITY_RANGE else highest
            what = f"the density is {self._rho[particle]:.3g} kg/m³"
        elif gap.max() > FRACTURE_GAP:
            particle = int(np.argmax(gap))
            what = f"the nearest particle is {gap[particle]:.2g} spacings away (fracture)"
        else:
            return
        place = self._reference[min(particle, self._free - 1)]
        raise SolverFailed(
            f"The solid failed at t = {self._time:.6g} s: {what} at the particle with reference position "
            f"({place[0]:.5g}, {place[1]:.5g}) m. Lower solid.courant (step now at most {self.stable_step():.3g} s), "
            f"keep solid.shifting on, refine solid.dx, or use solid.model = 'total-lagrangian', which cannot fracture."
        )

    def probe_values(self) -> dict[str, float]:
        position, velocity = self._tracers()
        seen = Observed(
            displacement=position - self._reference,
            velocity=velocity,
            place=self._x[:, : self._free].T,
            speed=self._u[:, : self._free].T,
            strain_energy=self._strain_energy,
            clamp_force=self._clamp_force,
            stress=self._stress_fields,
            gap=self._gap,
            work=self._books.done,
            start=self._start,
        )
        return {name: value(seen) for name, value in self._probes.items()}

    def frame(self) -> Frame:
        position, velocity = self._tracers()
        density = self._rho[: self._free].copy()
        fields = {"displacement": position - self._reference, "velocity": velocity, "density": density}
        return Frame(self._x[:, : self._free].T.copy(), fields | self._stress_fields())

    def particles(self) -> int:
        return self._x.shape[1]

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def _set_out(self) -> None:
        """The state at t = 0: stretched bodies with stress and velocity, carried where the motion says."""
        solid, free = self._scene.solid, self._free
        mu = lame(solid)[1]
        for body in self._bodies:
            centre, strain = body.position.mean(axis=0), prestrain(body.shape)
            trace = float(np.trace(strain))
            self._u[:, body.own] = start_velocity(solid, body.shape, body.position, centre).T
            self._x[:, body.own] = stretched(body.shape, body.position, centre).T
            third = trace / 3.0
            deviator = [strain[0, 0] - third, strain[0, 1], strain[1, 1] - third, -third]
            self._stress[:, body.own] = 2.0 * mu * np.array(deviator)[:, None]
            self._rho[body.own] = solid.density * (1.0 - trace)
        np.divide(self._mass, self._rho, out=self._volume)
        self._carried = Carried(solid.motion, self._x[:, :free].T.copy()) if solid.motion else None
        if self._carried is not None:
            place, velocity, _ = self._carried.at(0.0)
            self._x[:, :free], self._u[:, :free] = place.T, velocity.T
        self._find_neighbours(self._x)
        self._survey()

    def _advance_under(self, times: np.ndarray, dt: float, force: np.ndarray | None) -> np.ndarray:
        """Steps of `dt` [s] between `times` under a constant `force` (n, 2) [m/s²] beside the scene's loads.

        Returns the acceleration (n, 2) at the last time.
        """
        shares = self._loads.shares(times)
        steady = self._loads.steady if force is None else self._loads.steady + force
        before, velocity = self._tracers()
        if self._loads.following:
            middle = before - self._reference + 0.5 * dt * velocity
            steady = steady + self._loads.by_following(0.5 * (times[0] + times[-1]), middle)
        self._take_steps((np.ascontiguousarray(steady.T), self._ramped, shares), len(times) - 1, dt)
        if self._books.wanted:
            mean = steady + np.tensordot(trapezoid(shares), self._loads.ramped, axes=1)
            self._books.add(mean, self._tracers()[0] - before)
        damping = self._scene.solid.damping * self._u[:, : self._free].T
        return self._a.T + steady + np.tensordot(shares[-1], self._loads.ramped, axes=1) - damping

    def _carry(self, time: float, dt: float) -> np.ndarray:
        """Carry the particles to where the motion has them at `time` [s] and turn their stress, over one step."""
        free = self._free
        place, velocity, acceleration = self._carried.at(time)
        self._u[:, :free] = (place.T - self._x[:, :free]) / dt
        self._x[:, :free] += 0.5 * dt * self._u[:, :free]
        if moved_too_far(self._x, self._u, self._built, self._allowed, 0.0):
            self._find_neighbours(self._x)
        derivatives, correction, flux = self._sums
        pairs, kernel = (self._first, self._neighbour), (self._kernel.code, self._h)
        velocity_derivatives(self._x, self._u, self._volume, *pairs, *kernel, self._order > 0, derivatives, correction)
        material = self._mass, self._volume, self._rho, self._stress, self._curvature, self._offset
        update_material(*material, derivatives, correction, flux, self._moduli(), dt)
        self._x[:, :free], self._u[:, :free] = place.T, velocity.T
        return acceleration

    def _moduli(self) -> tuple[float, float, float, float]:
        """G [Pa], c² = K/ρ0 [m²/s²], ρ0 [kg/m³], and E' [Pa] (0 with the gradient as printed: no curvature stress)."""
        solid = self._scene.solid
        lam, mu = lame(solid)
        nu = solid.poisson_ratio
        bending = solid.youngs_modulus / (1.0 - nu**2) if self._order == 1 else 0.0
        return mu, (lam + 2.0 * mu / 3.0) / solid.density, solid.density, bending

    def _kinetic(self, k: int) -> float:
        own = self._bodies[k].own
        return kinetic_energy(self._mass[own], self._u[:, own].T)

    def _strain_energy(self, k: int) -> float:
        """Energy [J/m] of a body's stresses, those at its fixed particles included where they act."""
        shear, c_squared, density, bending = self._moduli()
        pressure = c_squared * (self._rho - density)
        moduli = shear, c_squared * density, bending
        energy = stress_energy(self._stress, pressure, self._curvature, self._volume, moduli)
        acting = self._free if self._order == 2 else len(energy)
        return float(energy[:acting][self._body[:acting] == k].sum())

    def _clamp_force(self, k: int) -> np.ndarray:
        """Force (2,) [N/m] of the clamps on a body: forces between particles are equal and opposite."""
        own = self._bodies[k].own
        direct = self._loads.on_clamps(self._time, self._tracers()[0] - self._reference)
        return self._a[:, own] @ self._mass[own] - direct[k]

    def _gap(self, k: int) -> float:
        own = self._bodies[k].own
        return nearest_gap(self._x[:, own].T, self._bodies[k].spacing)

    def _stress_fields(self) -> dict[str, np.ndarray]:
        _, c_squared, density, _ = self._moduli()
        pressure = c_squared * (self._rho[: self._free] - density)
        xx, xy, yy, zz = self._stress[:, : self._free]
        return stress_fields(xx - pressure, yy - pressure, zz - pressure, xy.copy())

    def _tracers(self) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity (free, 2) of the material tracers."""
        free = self._free
        e, g = self._offset[:, :free], self._sums[0][:, :free]
        across = np.stack([g[0] * e[0] + g[1] * e[1], g[2] * e[0] + g[3] * e[1]])
        return (self._x[:, :free] + e).T.copy(), (self._u[:, :free] + across).T.copy()

    def _find_neighbours(self, at: np.ndarray) -> None:
        """Make the neighbour list (first, neighbour) for positions `at` (2, n), pairs of one body only, sorted."""
        skin = SKIN * min(float(b.spacing.min()) for b in self._bodies)
        pairs = cKDTree(at.T).query_pairs(self._kernel.support * self._h + skin, output_type="ndarray")
        pairs = pairs[self._body[pairs[:, 0]] == self._body[pairs[:, 1]]]
        a, b = np.concatenate([pairs, pairs[:, ::-1]]).T
        order = np.lexsort((b, a))
        self._neighbour = b[order].astype(np.uint32)
        self._first = np.concatenate([[0], np.cumsum(np.bincount(a, minlength=at.shape[1]))])
        self._built = at.copy()
        self._allowed = 0.5 * skin

    def _survey(self) -> None:
        """Note how close the particles are."""
        nearest_distances(self._x, self._first, self._neighbour, self._spacing, self._nearest)

    def _take_steps(self, loads: tuple, substeps: int, dt: float) -> None:
        """Advance by all sub-steps, making neighbour lists and shifting in between as needed."""
        solid = self._scene.solid
        moduli = self._moduli()
        viscosity = solid.alpha * self._h * math.sqrt(moduli[1])
        crowded = short_range(NEEDED) if solid.shifting else math.inf
        numbers = dt, viscosity, moduli, self._order
        material = self._mass, self._volume, self._rho, self._stress, self._curvature, self._offset
        sums, kernel = (*self._sums, self._crowding, *self._fits), (self._kernel.code, self._h)
        kick = damped_kick(solid.damping, 0.5 * dt)
        done = 0
        while done < substeps:
            if moved_too_far(self._x, self._u, self._built, self._allowed, dt):
                self._find_neighbours(self._x)
            pairs = self._first, self._neighbour, self._built, self._allowed
            counters = *numbers, done, self._spacing, crowded
            done, due = steps((self._x, self._u, self._a), material, sums, pairs, kernel, loads, kick, counters)
            if due:
                if self._order == 2:  # what is carried along needs the linear correction
                    pairs_now = self._x, self._u, self._volume, *pairs[:2], *kernel, True
                    velocity_derivatives(*pairs_now, np.empty_like(self._sums[0]), self._sums[1])
                shift(self._x, self._u, material, self._sums[1], self._spacing, self._free, *pairs[:2], *kernel)
