"""Bound of what water of particles holds of a body that moves under it.

A lattice of particles under a pressure p bears shear until it slips, after about a spacing: a body that moves by y in
it is held by a force of up to κ p min(y, dx), whatever its size, the model and the time; the less the narrower it is
across its way. Of what moves the body, F, that is κ p/max(K, F/dx), K the stiffness that the body is held with. Found:
κ 0.06 to 0.27 with h = 1.3 dx, 0.06 to 0.07 with 2 dx (sprung blocks 3 to 9 thicknesses deep, one of which came to rest
at 11.0 mm for 14.7, cantilever_in_water); of a block three times as long as wide that moves lengthwise 0.03. Of one
that a table moves to and fro, without time to settle, 0.41 with 1.3 dx, 0.1 with 2 dx (shaken.py).
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.finding import of_particles
from coupler.preflight.measures.gravity import upward
from coupler.preflight.measures.held import largest_factor, normal_of
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import STATIC_FACTOR, goals_quantity, levels_before, of_a_body, plates_body
from coupler.preflight.measures.shapes import area
from shared.geometry.regions import outline
from shared.geometry.segments import right_of
from shared.schema.probes import FORCES
from shared.schema.scene import Scene

HELD = "water that bears shear"
FEW, MANY = 0.35, 0.1  # κ
MOVED_FEW, MOVED_MANY = 0.55, 0.15  # κ of a body that a table moves: its lattice has no time to settle
MANY_NEIGHBOURS = 2.0  # h/dx


def lattice_hold(scene: Scene, n: Numbers) -> float:
    """The hold of the water over what moves the goal's body, or, of a goal of the water's force, over its weight; 0 of
    bodies that have water on less than two sides, or that do not move in it."""
    plate, g = n.plate, math.hypot(*scene.gravity)
    if n.joint is None or not of_particles(n) or not n.water.rests or plate.wet < 2 or g == 0.0:
        return 0.0
    forces = goals_quantity(scene) in FORCES
    if plate.model == "rigid" or plate.along or not (forces or scene.goal is None or of_a_body(scene)):
        return 0.0
    body = plates_body(scene, plate)
    most = (MANY if scene.fluid.h_over_dx >= MANY_NEIGHBOURS else FEW) * _pressure(scene, n)
    along, stiffness = _held_along(scene, n)
    front = np.ptp(outline(body).reshape(-1, 2) @ right_of(along)) / plate.length
    most *= min(float(front), 1.0)
    push = abs(float(_push(scene, n) @ along))
    if forces:
        moved = min(push / stiffness, n.water.dx) if stiffness > 0.0 else n.water.dx
        return most * moved / (n.water.density * g * area(body))
    resisted = max(stiffness, push / n.water.dx)
    return most / resisted if resisted > 0.0 else 0.0


def hold_of_moved(scene: Scene, n: Numbers, way: float) -> float:
    """Force [N/m] by which the lattice holds the goal's body, which a table moves by `way` [m]; 0 of bodies that have
    water on less than two sides."""
    if n.joint is None or not of_particles(n) or n.plate.wet < 2 or not any(scene.gravity):
        return 0.0
    held = MOVED_MANY if scene.fluid.h_over_dx >= MANY_NEIGHBOURS else MOVED_FEW
    return held * _pressure(scene, n) * min(way, n.water.dx)


def _pressure(scene: Scene, n: Numbers) -> float:
    """Of water at rest [Pa] half-way up the goal's body."""
    body, up = plates_body(scene, n.plate), upward(scene)
    heights = outline(body).reshape(-1, 2) @ up
    depth = max(levels_before(scene, body)) - 0.5 * float(heights.min() + heights.max())
    return n.water.density * math.hypot(*scene.gravity) * max(depth, 0.0)


def _held_along(scene: Scene, n: Numbers) -> tuple[np.ndarray, float]:
    """Direction (2,) in which the goal's body moves, and the stiffness [N/m²] that holds it there."""
    plate, quantity = n.plate, goals_quantity(scene)
    if plate.model == "spring":
        axes = {"x": 0, "y": 1}
        axis = axes.get(quantity.rpartition("-")[2], int(np.argmax(np.abs(scene.gravity))))
        return np.eye(2)[axis], scene.solid.spring.stiffness[axis]
    body = plates_body(scene, plate)
    normal = normal_of(body)
    held = STATIC_FACTOR.get(plate.clamps, 0.0) * plate.stiffness / plate.length**3
    return normal, held


def _push(scene: Scene, n: Numbers) -> np.ndarray:
    """Force (2,) [N/m] of weight less buoyancy and of loads on the goal's body; an estimate."""
    plate, solid, water = n.plate, scene.solid, n.water
    body, gravity = plates_body(scene, plate), np.asarray(scene.gravity)
    force = (float(solid.gravity) * plate.density - water.density) * area(body) * gravity
    for load in solid.loads:
        if load.body == plate.name:
            much = plate.density * area(body) if load.acceleration else plate.length
            force = force + largest_factor(load) * much * np.asarray(load.acceleration or load.traction)
    return force
