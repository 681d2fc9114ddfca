"""Bodies filled with the interface points of a structure, and the probes of models that need no neighbours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from shared.contract import BadInput
from shared.geometry import fill
from shared.schema import Scene
from shared.schema_solid import SolidBody


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


def body_probes(
    scene: Scene,
    at_point: Mapping[str, Callable[[int, np.ndarray], Callable[[], float]]],
    of_body: Mapping[str, Callable[[int], float]],
) -> dict[str, Callable[[], float]]:
    """The probes of the solid that a model can tell, by name, as functions without arguments.

    By quantity: `at_point[quantity](k, point)` makes the function for a material point of body k,
    `of_body[quantity](k)` is the value of body k.
    """
    number = {body.name: k for k, body in enumerate(scene.solid.bodies)}
    result: dict[str, Callable[[], float]] = {}
    for probe in scene.probes:
        k = number.get(probe.body)
        if k is not None and probe.quantity in at_point:
            result[probe.name] = at_point[probe.quantity](k, np.array(probe.point))
        elif k is not None and probe.quantity in of_body:
            result[probe.name] = partial(of_body[probe.quantity], k)
    return result


def nearest_gap(place: np.ndarray, spacing: np.ndarray) -> float:
    """Largest distance of a point at `place` (n, 2) [m] to its nearest one, over the smaller `spacing` (2,)."""
    return float(cKDTree(place).query(place, k=2)[0][:, 1].max() / spacing.min())


def largest_speed(velocity: np.ndarray) -> float:
    """Largest of the speeds [m/s] of points with `velocity` (n, 2)."""
    return float(np.sqrt(np.max(np.sum(velocity**2, axis=1))))
