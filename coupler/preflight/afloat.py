"""Whether a body floats, and how far it has to go to its equilibrium, from the scene alone."""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.plate import Plate
from coupler.preflight.shapes import area
from shared.geometry import area_below, corners_of, outline
from shared.schema import Scene

AFLOAT = 0.03  # weight of the water that a body's motion moves, over its springs' force
_ROUNDING = 1e-6  # of a body's height


def afloat(scene: Scene, plate: Plate) -> bool:
    """Whether a body rises and sinks with the water's level: that stands at its sides, and its springs along gravity do
    not hold it. A floor, or a body that is under water all over, does not float."""
    g = math.hypot(*scene.gravity)
    if plate.model != "spring" or g == 0.0 or not _pierces(scene):
        return False
    along = sum(k * (part / g) ** 2 for k, part in zip(scene.solid.spring.stiffness, scene.gravity, strict=False))
    return along * AFLOAT < scene.fluid.density * g * plate.length


def _pierces(scene: Scene) -> bool:
    """Whether a surface of the water stands between a solid body's lowest and its highest point."""
    up = -np.array(scene.gravity)
    tops = [float((outline(body).reshape(-1, 2) @ up).max()) for body in scene.fluid.bodies]
    heights = [outline(body).reshape(-1, 2) @ up for body in scene.solid.bodies]
    slack = [_ROUNDING * np.ptp(height) for height in heights]
    return any(h.min() + s < top < h.max() - s for h, s in zip(heights, slack, strict=True) for top in tops)


def to_equilibrium(scene: Scene, name: str) -> float:
    """Way [m] along gravity of the body `name` from where it starts to where buoyancy, weight, loads of its mass and
    springs balance, by the width of its waterline at the start; the water's level moves along."""
    g = math.hypot(*scene.gravity)
    up = -np.asarray(scene.gravity) / g
    frame = np.stack([[up[1], -up[0]], up], axis=1)
    body = next(one for one in scene.solid.bodies if one.name == name)
    water = corners_of(scene.fluid.bodies) @ frame
    level, sides = float(water[:, 1].max()), outline(body) @ frame
    wide, tank = _width(sides, level), float(np.ptp(water[:, 0]))
    rho, own = scene.fluid.density, [load for load in scene.solid.loads if load.body == name and load.acceleration]
    push = float(sum(np.dot(load.acceleration, up) for load in own))
    weight = scene.solid.density * area(body) * ((g if scene.solid.gravity else 0.0) - push)
    held = sum(k * part**2 for k, part in zip(scene.solid.spring.stiffness, up, strict=False))
    stiffness = rho * g * wide / max(1.0 - wide / tank, 1e-9) + held
    lifted = rho * g * area_below(sides[:, 0], sides[:, 1], level)
    return float(abs(lifted - weight) / stiffness) if stiffness > 0.0 else math.inf


def _width(sides: np.ndarray, level: float) -> float:
    """Extent [m] of the segments at a level."""
    x = [
        x0 + (level - y0) / (y1 - y0) * (x1 - x0) for (x0, y0), (x1, y1) in sides if min(y0, y1) < level <= max(y0, y1)
    ]
    return max(x) - min(x) if x else 0.0
