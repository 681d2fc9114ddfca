"""One beam in motion: its state, and what can be said of it."""

from __future__ import annotations

import numpy as np

from shared.schema.scene import Scene
from solid_solver.beam_element import energies, strain_rates, strains
from solid_solver.beam_ends import BeamEnds
from solid_solver.beam_geometry import Beam, beam_loads
from solid_solver.beam_points import TERMS, add_forces, sections, spread
from solid_solver.beam_sweeps import steps
from solid_solver.initial import start_rotation, start_velocity
from solid_solver.loads import mean_table
from solid_solver.stresses import stress_fields

_MIDDLE = 0.5  # published points stand at the middle of their elements


class MovingBeam:
    """State arrays of the nodes (n + 1, 3), of the elements (n, 3), and the book (3,): see beam_sweeps.py."""

    def __init__(self, scene: Scene, beam: Beam):
        solid, shape, count = scene.solid, beam.body.shape, len(beam.free)
        self.beam, self.eta = beam, solid.damping
        self._poisson = solid.poisson_ratio
        self._steady, self._schedules, self._scheduled = beam_loads(scene, beam)
        self.q, self.v, self.a = (np.zeros((count, 3)) for _ in range(3))
        self.rate, self.book = np.zeros((count - 1, 3)), np.zeros(3)
        nodes = beam.origin + np.outer(beam.h * np.arange(count), beam.axes[0])
        self.v[:, :2] = start_velocity(solid, shape, nodes, beam.body.position.mean(axis=0)) @ beam.axes.T
        self.v[:, 2] = start_rotation(solid, shape, nodes)
        self._ends = BeamEnds(beam)
        self.v[~beam.free] = self._ends.at(np.zeros(1))[0, :, 1][~beam.free[[0, -1]]]
        strain_rates(self.q, self.v, beam.h, self.rate)
        force = self._steady[0] / beam.mass[:, :2] - self.eta * self.v[:, :2]
        self.a[beam.free, :2] = force[beam.free]
        self._middles = np.arange(count - 1), np.full(count - 1, _MIDDLE)
        self._energy_at_start = sum(self.energies())
        self.step(np.empty(0), 1.0, np.zeros((len(beam.element), 2)))  # no step: compiles before the run is timed

    def arrays(self) -> dict[str, np.ndarray]:
        """Everything that the future, and the books, depend on."""
        names = "displacement", "velocity", "acceleration", "strain_rate", "book"
        return dict(zip(names, (self.q, self.v, self.a, self.rate, self.book), strict=True))

    def step(self, middles: np.ndarray, dt: float, force: np.ndarray | None) -> bool:
        """Take steps of `dt` [s] about the times `middles` under `force` (m, 2) on the points; did all converge?"""
        beam, load = self.beam, self._steady
        if force is not None:
            load = load[0].copy(), load[1].copy()
            add_forces(force, beam.element, beam.offset, beam.h, beam.axes, *load)
        ends = self._ends.at(middles + 0.5 * dt)
        edges = np.append(middles - 0.5 * dt, middles[-1:] + 0.5 * dt)
        shares, state = mean_table(self._schedules, edges), (self.q, self.v, self.a, self.rate, self.book)
        section = beam.mass, beam.h, beam.stiffness
        return steps(state, (beam.free, ends), *section, self.eta, dt, load, self._scheduled, shares) > 0

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

    def work(self) -> float:
        """Work of all loads so far [J/m]."""
        return float(self.book[0])

    def dissipated(self) -> float:
        """Work and initial energy less the energy left [J/m]: by damping and by the time integration."""
        return self._energy_at_start + self.work() - sum(self.energies())

    def reaction(self) -> np.ndarray:
        """Mean force (2,) [N/m] of all clamps on the beam over the last step."""
        return self.book[1:] @ self.beam.axes

    def momenta(self) -> tuple[float, float, float]:
        """Momentum along x and y [N s/m], and angular momentum about the origin [N s]."""
        beam = self.beam
        along = beam.h * np.arange(len(beam.free))
        place = beam.origin + np.stack([along + self.q[:, 0], self.q[:, 1]], axis=1) @ beam.axes
        px, py = (beam.mass[:, :2] * (self.v[:, :2] @ beam.axes)).T
        spin = place[:, 0] @ py - place[:, 1] @ px + beam.mass[:, 2] @ self.v[:, 2]
        return float(px.sum()), float(py.sum()), float(spin)

    def stresses(self, element: np.ndarray, share: np.ndarray, offset: np.ndarray) -> dict[str, np.ndarray]:
        """Cauchy stress fields (m,) [Pa] of the material points at their places (see `Beam.place`), each (m,).

        Along the axis from bending and stretching, across it a shear that is parabolic over the section. What an
        element bears it bears at its middle: between middles, and from the last ones to the ends, it goes linearly.
        """
        beam, strain = self.beam, np.empty_like(self.rate)
        strains(self.q, beam.h, strain)
        force = strain * beam.stiffness
        if len(force) > 1:
            place = element + share - _MIDDLE
            first = np.clip(np.floor(place).astype(int), 0, len(force) - 2)
            beyond = (place - first)[:, None]
            force = (1.0 - beyond) * force[first] + beyond * force[first + 1]
        else:
            force = force[element]
        axial = force[:, 0] / beam.thickness - force[:, 2] * offset * 12.0 / beam.thickness**3
        shear = 1.5 * force[:, 1] / beam.thickness * (1.0 - (2.0 * offset / beam.thickness) ** 2)
        theta = (1.0 - share) * self.q[element, 2] + share * self.q[element + 1, 2]
        c, s = (np.stack([np.cos(theta), np.sin(theta)], axis=1) @ beam.axes).T
        xx, yy = axial * c * c - 2.0 * shear * c * s, axial * s * s + 2.0 * shear * c * s
        return stress_fields(xx, yy, self._poisson * axial, axial * c * s + shear * (c * c - s * s))

    def middle_stresses(self) -> dict[str, np.ndarray]:
        """The same at the published points."""
        return self.stresses(self.beam.element, np.full(len(self.beam.element), _MIDDLE), self.beam.offset)

    def _sections(self, element: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        centre, slope = np.empty((len(element), TERMS)), np.empty((len(element), TERMS))
        sections(self.q, self.v, self.a, self.beam.h, element, share, self.beam.axes, centre, slope)
        return centre, slope
