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
from solid_solver.bodies import lattice_bodies
from solid_solver.clamps import fixed_particles
from solid_solver.interface import damped_kick, describe, kinematics_over_window, lame, wave_speed
from solid_solver.loads import scheduled_loads
from solid_solver.probes import solid_probes
from solid_solver.shifting import NEEDED, shift, short_range
from solid_solver.stresses import stress_fields
from solid_solver.updated_sweeps import extreme_density, moved_too_far, nearest_distances, steps

COURANT = 0.7
"""Default step over dx/c_p: 1.0 still runs the clamped beam at α = 1 and ν = 0 … 0.4."""

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
        beyond = 0.0 if solid.gradient == "linear" else self._kernel.support * solid.h_over_dx
        fixed = [fixed_particles(b, solid.clamps, beyond) for b in self._bodies]
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
        self._u[:, : self._free] = np.repeat([b.shape.velocity for b in self._bodies], sizes, axis=0).T
        self._volume = self._mass / solid.density
        self._rho, self._stress = np.full(count, solid.density), np.zeros((4, count))
        self._curvature = np.zeros((2, count))
        self._offset = np.zeros((2, count))
        self._sums = np.zeros((6, count)), np.zeros((7, count)), np.zeros((6, count))  # derivatives, correction, flux
        self._crowding, self._nearest = np.zeros(self._free), np.zeros(self._free)
        self._loads = scheduled_loads(scene, self._bodies)
        self._ramped = np.ascontiguousarray(self._loads.ramped.transpose(0, 2, 1))
        self._probes = solid_probes(scene, self._bodies)
        self._threads = threads if count >= PARALLEL_FROM else 1
        self._time, self._steps = 0.0, 0
        self._find_neighbours(self._x)
        self._survey()

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self.stable_step())

    def begin(self, motion: Kinematics | None) -> Kinematics:
        velocity = self._u[:, : self._free].T.copy()
        acceleration = self._loads.at(0.0) - self._scene.solid.damping * velocity
        return Kinematics(self._reference.copy(), velocity, acceleration, velocity.copy(), acceleration.copy())

    def stable_step(self) -> float:
        solid = self._scene.solid
        courant = COURANT if solid.courant == "auto" else solid.courant
        closest = min(1.0, float(self._nearest.min())) * float(self._spacing[: self._free].min())
        return courant * closest / wave_speed(solid)

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        numba.set_num_threads(self._threads)
        dt = (t1 - t0) / substeps
        shares = self._loads.shares(t0 + dt * np.arange(substeps + 1))
        steady = self._loads.steady
        if isinstance(boundary, Loads):
            steady = steady + boundary.force / self._mass[: self._free, None]
        start = self._tracers()
        self._take_steps((np.ascontiguousarray(steady.T), self._ramped, shares), substeps, dt)
        self._steps += substeps
        self._time = t1
        self._survey()
        end = self._tracers()
        damping = self._scene.solid.damping * self._u[:, : self._free].T
        total = self._a.T + steady + np.tensordot(shares[-1], self._loads.ramped, axes=1) - damping
        return kinematics_over_window(start, end, total, t1 - t0)

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
        return {name: value(position - self._reference, velocity) for name, value in self._probes.items()}

    def frame(self) -> Frame:
        free, solid = self._free, self._scene.solid
        lam, mu = lame(solid)
        pressure = (lam + 2.0 * mu / 3.0) / solid.density * (self._rho[:free] - solid.density)
        xx, xy, yy, zz = self._stress[:, :free]
        position, velocity = self._tracers()
        fields = {"displacement": position - self._reference, "velocity": velocity, "density": self._rho[:free].copy()}
        return Frame(
            self._x[:, :free].T.copy(), fields | stress_fields(xx - pressure, yy - pressure, zz - pressure, xy.copy())
        )

    def particles(self) -> int:
        return self._x.shape[1]

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

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
        lam, mu = lame(solid)
        c_squared = (lam + 2.0 * mu / 3.0) / solid.density
        viscosity = solid.alpha * self._h * math.sqrt(c_squared)
        crowded = short_range(NEEDED) if solid.shifting else math.inf
        corrected = solid.gradient == "linear"
        bending = solid.youngs_modulus / (1.0 - solid.poisson_ratio**2) if corrected else 0.0
        numbers = dt, viscosity, (mu, c_squared, solid.density, bending), corrected
        material = self._mass, self._volume, self._rho, self._stress, self._curvature, self._offset
        sums, kernel = (*self._sums, self._crowding), (self._kernel.code, self._h)
        kick = damped_kick(solid.damping, 0.5 * dt)
        done = 0
        while done < substeps:
            if moved_too_far(self._x, self._u, self._built, self._allowed, dt):
                self._find_neighbours(self._x)
            pairs = self._first, self._neighbour, self._built, self._allowed
            counters = *numbers, done, self._spacing, crowded
            done, due = steps((self._x, self._u, self._a), material, sums, pairs, kernel, loads, kick, counters)
            if due:
                shift(self._x, self._u, material, self._sums[1], self._spacing, self._free, *pairs[:2], *kernel)
