"""Bodies filled with the interface points that a particle solid would have, for models that need no neighbours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shared.contract import BadInput
from shared.geometry import fill
from shared.schema import Scene, SolidBody


@dataclass(frozen=True)
class FilledBody:
    """One body. `shape`: its table in the scene; `first`: number of its first point among all bodies'; `position`
    (n, 2) [m]; `spacing` (2,) [m] along `axes` (2, 2), unit vectors by row."""

    shape: SolidBody
    first: int
    position: np.ndarray
    spacing: np.ndarray
    axes: np.ndarray

    @property
    def cell(self) -> float:
        """Area that a point stands for [m²]."""
        return float(self.spacing[0] * self.spacing[1])

    @property
    def own(self) -> slice:
        """Its points among all bodies'."""
        return slice(self.first, self.first + len(self.position))


def filled_bodies(scene: Scene) -> list[FilledBody]:
    """The scene's solid bodies at the positions of their particles. Raises BadInput for one that holds none."""
    result, first = [], 0
    for shape in scene.solid.bodies:
        lattice = fill(shape, scene.solid.dx)
        if len(lattice.position) == 0:
            raise BadInput(
                f"Body '{shape.name}' holds no particle at solid.dx = {scene.solid.dx:g} m; make solid.dx smaller."
            )
        result.append(FilledBody(shape, first, lattice.position, np.array(lattice.spacing), lattice.axes))
        first += len(lattice.position)
    return result


def point_probes(
    scene: Scene, displacement: Callable, energy: Callable, velocity: Callable
) -> dict[str, Callable[[], float]]:
    """The probes of the solid, by name, as functions without arguments.

    `displacement(k, point)` gives a function that returns the displacement (2,) [m] of a material point of body k,
    `energy(k)` the body's kinetic energy [J/m], `velocity(k)` its points' velocities (n, 2) [m/s].
    """
    number = {body.name: k for k, body in enumerate(scene.solid.bodies)}
    result: dict[str, Callable[[], float]] = {}
    for probe in scene.probes:
        if probe.body not in number:
            continue
        k = number[probe.body]
        if probe.quantity in ("displacement-x", "displacement-y"):
            at, component = displacement(k, np.array(probe.point)), int(probe.quantity == "displacement-y")
            result[probe.name] = lambda at=at, component=component: float(at()[component])
        elif probe.quantity == "kinetic-energy":
            result[probe.name] = lambda k=k: float(energy(k))
        elif probe.quantity == "max-speed":
            result[probe.name] = lambda k=k: float(np.sqrt(np.max(np.sum(velocity(k) ** 2, axis=1))))
    return result
