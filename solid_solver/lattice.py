"""The particles of the total-Lagrangian solid: displacements, velocities and internal forces, and their time steps.

Fields over the padded slots of stencil.py are planes, (2, slots) and (10, slots); the equations are in
lattice_sweeps.py.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shared.elasticity import lame, wave_speed
from shared.schema.solid import Solid
from shared.solid_step import lattice_step, viscous_time
from solid_solver.bodies import LatticeBody
from solid_solver.energies import lattice_energy
from solid_solver.held import sizes
from solid_solver.lattice_sweeps import SCRATCH, SUMS, derivative_sweep, steps
from solid_solver.stencil import lay_out
from solid_solver.strain_gradient import STRAINS, extremes
from solid_solver.stresses import cauchy_fields

POWER_ITERATIONS = 100

TRIAL_STRAIN = 1.0e-7
"""Size of the displacement gradients by which the power iteration probes the linear stiffness."""

_STILL = np.array([[1.0, 0.0], [1.0, 0.0]])  # kicks that move nothing, for forces alone


class Lattice:
    """All bodies' particles, `count` in number. `u`, `v`, `a` (2, slots): displacement, velocity, acceleration by
    internal forces; `strain` (9, slots): of the step before."""

    def __init__(self, solid: Solid, bodies: list[LatticeBody]):
        self._solid, self._bodies = solid, bodies
        layout = lay_out([(b.index, b.fit, b.scale) for b in bodies])
        self._layout, self.slot, self.count = layout, layout.slot, len(layout.slot)
        self._clamps = [clamp for b in bodies for clamp in b.moving]
        self._axes = np.array([b.axes for b in bodies])
        self._axis_of = np.repeat(self._axes, [len(b.position) for b in bodies], axis=0)
        self._moment = np.array([b.spacing**2 / 12.0 for b in bodies])
        self._stress = np.zeros((SUMS, layout.slots))
        self._scratch = np.zeros((max(len(layout.forward.chunk), len(layout.transposed.chunk)), SCRATCH))
        self._viscous_time = viscous_time(solid)
        self.u, self.v, self.a = (np.zeros((2, layout.slots)) for _ in range(3))
        self.strain = np.zeros((STRAINS, layout.slots))

    @property
    def displacement(self) -> np.ndarray:
        """In published order (n, 2) [m], as are velocity and acceleration."""
        return self.public(self.u)

    @property
    def velocity(self) -> np.ndarray:
        return self.public(self.v)

    @property
    def acceleration(self) -> np.ndarray:
        return self.public(self.a)

    def put(self, displacement: np.ndarray, velocity: np.ndarray) -> None:
        """Set both, (n, 2) each."""
        self.u[:, self.slot], self.v[:, self.slot] = displacement.T, velocity.T

    def state(self) -> dict[str, np.ndarray]:
        """Everything that the future depends on."""
        return {"displacement": self.u, "velocity": self.v, "acceleration": self.a, "strain": self.strain}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Back to a copy of `state`."""
        for name, array in self.state().items():
            array[...] = state[name]

    def padded(self, field: np.ndarray) -> np.ndarray:
        """A field (n, 2) over the padded slots, (2, slots)."""
        planes = np.zeros((2, self._layout.slots))
        planes[:, self.slot] = field.T
        return planes

    def public(self, planes: np.ndarray) -> np.ndarray:
        """A field (2, slots) in the order of the published points, (n, 2)."""
        return np.ascontiguousarray(planes[:, self.slot].T)

    def step(self, times: np.ndarray, load, ramped, shares, kicks: np.ndarray, dt: float) -> None:
        """Steps of `dt` [s] that end at `times` (m,): the arguments as in lattice_sweeps.py's `steps`."""
        solid, layout = self._solid, self._layout
        material = (*lame(solid), solid.density, self._viscous_time / dt if dt > 0.0 else 0.0)
        now, planes = (self.u, self.v, self.a), (self._stress, self.strain, self._scratch)
        gathers = tuple(layout.forward), tuple(layout.transposed)
        clamps, loads = (tuple(layout.driven), sizes(self._clamps, times)), (load, ramped, shares)
        steps(now, planes, gathers, clamps, self._axes, self._moment, material, loads, kicks, dt)

    def find_forces(self, time: float) -> None:
        """Internal forces at `time` [s] into `a`; nothing moves."""
        rest = np.zeros_like(self.u)
        self.step(np.array([time]), rest, np.zeros((0, *rest.shape)), np.zeros((1, 0)), _STILL, 0.0)

    def derivatives(self, time: float) -> np.ndarray:
        """Derivatives (10, n) of the displacement at the particles at `time` [s]."""
        planes = np.zeros_like(self._stress)
        self._sweep(time, planes)
        return planes[:, self.slot]

    def strain_energy(self, time: float, k: int) -> float:
        """Strain energy [J/m] of body number `k`."""
        body = self._bodies[k]
        moment = np.tile(self._moment[k], (len(body.position), 1))
        planes = self.derivatives(time)[:, body.own]
        return float(body.cell * lattice_energy(planes, self._axis_of[body.own], moment, *lame(self._solid)).sum())

    def stress_fields(self, time: float) -> dict[str, np.ndarray]:
        """Named Cauchy stress fields (n,) [Pa]."""
        return cauchy_fields(self.derivatives(time), self._axis_of, *lame(self._solid))

    def survey(self, time: float) -> tuple[float, int, float]:
        """Smallest det F, with its particle, and the largest stretch squared, at `time` [s]."""
        self._sweep(time, self._stress)
        return extremes(self._stress, self.slot, self._axis_of)

    def linear_step(self) -> float:
        """Stable step of the unstrained bodies [s]: from the Courant number given, or from ω_max by power iteration."""
        solid = self._solid
        dx = min(float(b.spacing.min()) for b in self._bodies)
        if solid.courant != "auto":
            return solid.courant * dx / wave_speed(solid)
        self.u[:, self.slot] = np.random.default_rng(0).standard_normal((2, self.count))
        omega = 0.0
        for _ in range(POWER_ITERATIONS):
            self.u *= TRIAL_STRAIN * dx / np.max(np.abs(self.u))
            self.find_forces(0.0)
            omega = (np.sum(self.a**2) / np.sum(self.u**2)) ** 0.25
            self.u[...] = self.a
        for field in (self.u, self.v, self.a, self.strain):
            field[...] = 0.0
        return lattice_step(2.0 / omega, self._viscous_time)

    def _sweep(self, time: float, planes: np.ndarray) -> None:
        forward, driven = tuple(self._layout.forward), tuple(self._layout.driven)
        derivative_sweep(self.u, planes, self._scratch, forward, driven, sizes(self._clamps, np.array([time]))[0])
