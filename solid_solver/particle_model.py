"""What both structures of particles share: loads, books, probes, and the contract about a model's own integration.

A model says where its particles are (`_particles`), how far their material has moved (`_displacement`), which shifting
may part from them, and how it integrates (`_integrate`); the contract follows from that.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from shared.contract import Description, Exchange, Frame, Kinematics, Loads
from shared.jit import use_threads
from shared.schema.scene import Scene
from solid_solver.bodies import LatticeBody
from solid_solver.energies import WorkBook
from solid_solver.interface import describe, kinematics_over_window
from solid_solver.loads import scheduled_loads
from solid_solver.probes import (
    angular_momentum,
    body_probes,
    displacement_weights,
    field_weights,
    kinetic_energy,
    largest_speed,
    nearest_gap,
    von_mises,
    wants_work,
)


class ParticleModel(ABC):
    """A structure of particles of `_mass` (n,) [kg/m], which stand at `_reference` (n, 2) [m] when at rest.

    A model sets `_threads`, and ends its own start with `_open_books`.
    """

    role = "structure"

    def __init__(self, scene: Scene, bodies: list[LatticeBody], mass: np.ndarray):
        self._scene, self._bodies, self._mass = scene, bodies, mass
        self._reference = np.concatenate([body.position for body in bodies])
        self._loads = scheduled_loads(scene, bodies)
        self._probes = body_probes(scene, self._at_point(), self._of_body())
        self._time, self._steps = 0.0, 0

    def _open_books(self) -> None:
        """Begin to count the work of the loads, from the energies of the state at t = 0."""
        owner = np.repeat(np.arange(len(self._bodies)), [len(b.position) for b in self._bodies])
        self._books = WorkBook(wants_work(self._scene), owner, self._mass, len(self._bodies))
        self._energy_at_start = [self._kinetic(k) + self._strain_energy(k) for k in range(len(self._bodies))]

    # ---- what a model says ------------------------------------------------------------------------------------

    @abstractmethod
    def _particles(self) -> tuple[np.ndarray, np.ndarray]:
        """Place [m] and velocity [m/s] (n, 2) of the particles."""

    def _published(self) -> tuple[np.ndarray, np.ndarray]:
        """Place [m] and velocity [m/s] (n, 2) of the material points that are published: of the particles, unless they
        shift."""
        return self._particles()

    @abstractmethod
    def _displacement(self) -> np.ndarray:
        """Displacement (n, 2) [m] of the published points."""

    @abstractmethod
    def _internal(self) -> np.ndarray:
        """Acceleration (n, 2) [m/s²] by internal forces."""

    @abstractmethod
    def _integrate(self, t0: float, t1: float, substeps: int, force: np.ndarray | None) -> np.ndarray:
        """Take `substeps` steps from t0 to t1 [s] under a constant `force` (n, 2) [m/s²] beside the scene's loads; the
        acceleration (n, 2) [m/s²] at the end."""

    @abstractmethod
    def _survey(self) -> None:
        """Note what `stable_step` and `check` go by in the present state."""

    @abstractmethod
    def _arrays(self) -> dict[str, np.ndarray]:
        """What the future depends on besides the time and the books (views)."""

    @abstractmethod
    def _strain_energy(self, k: int) -> float:
        """Of body number k [J/m]."""

    @abstractmethod
    def _fields(self) -> dict[str, np.ndarray]:
        """Stresses (n,) [Pa] by name, and what else a frame shows."""

    def _restored(self) -> None:
        """Make anew what follows from `_arrays`."""
        self._survey()

    # ---- the contract -----------------------------------------------------------------------------------------

    def describe(self) -> Description:
        return describe(self._scene, self._bodies, self.stable_step())

    def begin(self, motion: Kinematics | None) -> Kinematics:
        place, velocity = self._particles()
        acceleration = self._internal() + self._loads.at(0.0) - self._scene.solid.damping * velocity
        return Kinematics(place, velocity, acceleration, velocity.copy(), acceleration.copy())

    def advance(self, t0: float, t1: float, substeps: int, boundary: Exchange | None) -> Kinematics:
        use_threads(self._threads)
        force = boundary.force / self._mass[:, None] if isinstance(boundary, Loads) else None
        start = self._published()
        acceleration = self._integrate(t0, t1, substeps, force)
        self._steps += substeps
        self._time = t1
        self._survey()
        return kinematics_over_window(start, self._published(), acceleration, t1 - t0)

    def state(self) -> dict[str, np.ndarray]:
        return {**self._arrays(), "work": self._books.done, "time": np.array([self._time])}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        for name, array in self.state().items():
            array[...] = state[name]
        self._time = float(state["time"][0])
        self._restored()

    def probe_values(self) -> dict[str, float]:
        return {name: value() for name, value in self._probes.items()}

    def frame(self) -> Frame:
        fields = {"displacement": self._displacement(), "velocity": self._published()[1]}
        return Frame(self._particles()[0], fields | self._fields())

    def particles(self) -> int:
        return len(self._mass)

    def steps(self) -> int:
        return self._steps

    # ---- inside -----------------------------------------------------------------------------------------------

    def _kinetic(self, k: int) -> float:
        own = self._bodies[k].own
        return kinetic_energy(self._mass[own], self._particles()[1][own])

    def _momentum(self, k: int, axis: int) -> float:
        own = self._bodies[k].own
        return float(self._mass[own] @ self._particles()[1][own, axis])

    def _angular_momentum(self, k: int) -> float:
        own = self._bodies[k].own
        place, velocity = self._particles()
        return angular_momentum(self._mass[own], place[own], velocity[own])

    def _dissipated(self, k: int) -> float:
        return self._energy_at_start[k] + self._books.done[k] - self._kinetic(k) - self._strain_energy(k)

    def _clamp_force(self, k: int) -> np.ndarray:
        """Force (2,) [N/m] of the clamps on a body: internal forces on particles and fixed points add up to nothing."""
        own = self._bodies[k].own
        direct = self._loads.on_clamps(self._time, self._displacement())[k]
        return self._mass[own] @ self._internal()[own] - direct

    def _at_point(self) -> dict:
        """Quantities of material points, see `body_probes`."""

        def displacement(axis):
            def at(k, point):
                near, weight = displacement_weights(self._bodies[k], point)
                return lambda: float(weight @ self._displacement()[near, axis])

            return at

        def stress(measure, *names):
            def at(k, point):
                near, weight = field_weights(self._bodies[k], point)

                def value():
                    fields = self._fields()
                    return float(measure(*(weight @ fields[name][near] for name in names)))

                return value

            return at

        return {
            "displacement-x": displacement(0),
            "displacement-y": displacement(1),
            "stress-xx": stress(float, "stress_xx"),
            "stress-yy": stress(float, "stress_yy"),
            "stress-xy": stress(float, "stress_xy"),
            "von-mises": stress(von_mises, "stress_xx", "stress_yy", "stress_xy", "pressure"),
        }

    def _of_body(self) -> dict:
        """Quantities of bodies, see `body_probes`."""
        bodies = self._bodies
        return {
            "kinetic-energy": self._kinetic,
            "strain-energy": self._strain_energy,
            "external-work": lambda k: float(self._books.done[k]),
            "dissipated": lambda k: float(self._dissipated(k)),
            "momentum-x": lambda k: self._momentum(k, 0),
            "momentum-y": lambda k: self._momentum(k, 1),
            "angular-momentum": self._angular_momentum,
            "reaction-x": lambda k: float(self._clamp_force(k)[0]),
            "reaction-y": lambda k: float(self._clamp_force(k)[1]),
            "spacing-max": lambda k: nearest_gap(self._particles()[0][bodies[k].own], bodies[k].spacing),
            "max-speed": lambda k: largest_speed(self._published()[1][bodies[k].own]),
        }
