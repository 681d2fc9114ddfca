"""Whether a body floats, drifts or carries the water, and its way to equilibrium, from the scene alone."""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.measures.gravity import across_and_up, upward
from coupler.preflight.measures.held import lengthwise
from coupler.preflight.measures.shapes import area
from coupler.preflight.measures.water import UPWARD, edge_samples
from shared.geometry.regions import area_below, contains, corners_of, outline
from shared.schema.geometry import Body
from shared.schema.scene import Scene

AFLOAT = 0.03  # weight of the water that a body's motion moves, over its springs' force
_ROUNDING = 1e-6  # of a body's height, and of what lifts it


def afloat(scene: Scene, body: Body) -> bool:
    """Whether a body rises and sinks with the water's level: that stands at its sides, and its springs along gravity do
    not hold it. A floor, a tub, or a body that is under water all over, does not float."""
    g = math.hypot(*scene.gravity)
    if scene.solid.model != "spring" or g == 0.0 or not _pierces(scene) or carries(scene, body):
        return False
    along = sum(k * (part / g) ** 2 for k, part in zip(scene.solid.spring.stiffness, scene.gravity, strict=False))
    return along * AFLOAT < scene.fluid.density * g * lengthwise(body)[2]


def adrift(scene: Scene, body: Body, quantity: str) -> bool:
    """Whether nothing but the water's drag and mass tells how a body moves, along the axis of a `quantity` of it or at
    all: neither springs, clamps, a table nor its waterline hold it there."""
    solid, axis = scene.solid, {"x": 0, "y": 1}.get(quantity.rpartition("-")[2])
    if solid.model == "rigid" or solid.motion is not None or any(one.body == body.name for one in solid.clamps):
        return False
    axes = (0, 1) if axis is None else (axis,)
    sprung = solid.model == "spring" and all(solid.spring.stiffness[k] > 0.0 for k in axes)
    upright = axis is None or scene.gravity[axis] != 0.0
    return not sprung and not (upright and (_pierces(scene) or carries(scene, body)))


def carries(scene: Scene, body: Body) -> bool:
    """Whether all the water stands on a body, as in a tub: it rises and sinks with it."""
    middle, outward = edge_samples(scene.fluid.bodies, scene.fluid.dx)
    below = outward @ upward(scene) < -UPWARD
    beneath = middle[below] + scene.fluid.dx * outward[below]
    return any(scene.gravity) and bool(np.all(contains(body, beneath)))


def _pierces(scene: Scene) -> bool:
    """Whether a surface of the water stands between a solid body's lowest and its highest point."""
    up = -np.array(scene.gravity)
    tops = [float((outline(body).reshape(-1, 2) @ up).max()) for body in scene.fluid.bodies]
    heights = [outline(body).reshape(-1, 2) @ up for body in scene.solid.bodies]
    slack = [_ROUNDING * np.ptp(height) for height in heights]
    return any(h.min() + s < top < h.max() - s for h, s in zip(heights, slack, strict=True) for top in tops)


def to_equilibrium(scene: Scene, body: Body) -> float:
    """Way [m] along gravity of a body from where it starts to where buoyancy, weight, loads of its mass and springs
    balance, by the width of its waterline at the start; the water's level moves along."""
    g = math.hypot(*scene.gravity)
    up = upward(scene)
    sides, level = outline(body) @ across_and_up(up), _level(scene, up)
    rho, own = scene.fluid.density, [load for load in scene.solid.loads if load.body == body.name and load.acceleration]
    push = float(sum(np.dot(load.acceleration, up) for load in own))
    weight = scene.solid.density * area(body) * ((g if scene.solid.gravity else 0.0) - push)
    held = sum(k * part**2 for k, part in zip(scene.solid.spring.stiffness, up, strict=False))
    stiffness = buoyant_stiffness(scene, body) + held
    lifted = rho * g * area_below(sides[:, 0], sides[:, 1], level)
    left = abs(lifted - weight)
    if left < _ROUNDING * lifted:
        return 0.0
    return float(left / stiffness) if stiffness > 0.0 else math.inf


def buoyant_stiffness(scene: Scene, body: Body) -> float:
    """Force [N/m per metre of depth] that lifts a body per metre that it sinks: ρ g by the width of its waterline, and
    by as much more as the water's level rises; 0 of one that no surface cuts, that stands on it or carries it."""
    g = math.hypot(*scene.gravity)
    if g == 0.0 or carries(scene, body):
        return 0.0
    up = upward(scene)
    sides, level = outline(body) @ across_and_up(up), _level(scene, up)
    if level - sides[..., 1].min() <= _ROUNDING * np.ptp(sides[..., 1]):
        return 0.0
    wide = _width(sides, level)
    tank = float(np.ptp(corners_of(scene.fluid.bodies) @ across_and_up(up)[:, 0]))
    return scene.fluid.density * g * wide / max(1.0 - wide / tank, 1e-9)


def _level(scene: Scene, up: np.ndarray) -> float:
    """How far the water reaches against gravity [m]."""
    return float((corners_of(scene.fluid.bodies) @ up).max())


def _width(sides: np.ndarray, level: float) -> float:
    """Extent [m] of the segments at a level."""
    x = [
        x0 + (level - y0) / (y1 - y0) * (x1 - x0) for (x0, y0), (x1, y1) in sides if min(y0, y1) < level <= max(y0, y1)
    ]
    return max(x) - min(x) if x else 0.0
