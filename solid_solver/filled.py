"""Bodies filled with the interface points of a structure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shared.contract import BadInput
from shared.geometry.particles import fill
from shared.schema.scene import Scene
from shared.schema.solid import SolidBody


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
