"""The solid's probes: displacement of material points, and energies and speeds of bodies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shared.schema import Probe, Scene
from solid_solver.bodies import LatticeBody

Values = Callable[[np.ndarray, np.ndarray], float]


def _displacement(probe: Probe, body: LatticeBody) -> Values:
    _, column, weight = body.point_weights(np.array([probe.point], dtype=float))
    component = 0 if probe.quantity == "displacement-x" else 1
    return lambda displacement, velocity: float(weight @ displacement[column, component])


def _kinetic_energy(body: LatticeBody, density: float) -> Values:
    own = slice(body.first, body.first + len(body.position))
    return lambda displacement, velocity: float(0.5 * density * body.cell * np.sum(velocity[own] ** 2))


def _max_speed(body: LatticeBody) -> Values:
    own = slice(body.first, body.first + len(body.position))
    return lambda displacement, velocity: float(np.sqrt(np.max(np.sum(velocity[own] ** 2, axis=1))))


def solid_probes(scene: Scene, bodies: list[LatticeBody]) -> dict[str, Values]:
    """The probes that belong to the solid, by name: functions of displacement and velocity (n, 2) of the material."""
    named = {b.shape.name: b for b in bodies}
    result: dict[str, Values] = {}
    for probe in scene.probes:
        if probe.body not in named:
            continue
        body = named[probe.body]
        if probe.quantity in ("displacement-x", "displacement-y"):
            result[probe.name] = _displacement(probe, body)
        elif probe.quantity == "kinetic-energy":
            result[probe.name] = _kinetic_energy(body, scene.solid.density)
        elif probe.quantity == "max-speed":
            result[probe.name] = _max_speed(body)
    return result
