"""Bound of what walls take of water's push on a structure that stands in a corner with them, relative.

Ghosts of a wall and of a structure's face that meet in a corner share what presses there: of the water's force on the
structure, and of the reaction of its clamps, a strip of 0.34 to 0.44 dx is missing at each such end (floors 20 and 40
spacings long, a gate with its foot on the floor of water 20 deep, h = 2 dx; 0.19 with 1.3 dx), whatever the model; 0.35
to 0.58 dx of a plate that closes a box of water, whose clamps bear what little the water leaves. What bends feels
little of it, for it stands at the clamps.
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.finding import of_particles
from coupler.preflight.measures.gravity import upward
from coupler.preflight.measures.held import lengthwise, normal_of
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import STATIC_FACTOR, goals_probe, goals_quantity, own_load, plates_body
from coupler.preflight.measures.shapes import area
from coupler.preflight.measures.upright import SWEPT, pressures
from shared.geometry.regions import contains, corners_of, distance_to, outline
from shared.schema.probes import FORCES, REACTIONS
from shared.schema.scene import Scene

CORNERS = "corners with walls"
STRIP, OF_FEW = 0.5, 0.25  # of dx, with h = 2 dx and with fewer neighbours
IN_A_BOX = 0.6  # of dx, with any
MANY = 2.0  # h/dx
_AT = 0.5  # of dx: a corner as near to a wall stands on it
_AROUND = 0.75 * np.array([(x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)])  # of dx
_POINTS = 200


def corner_strips(scene: Scene, n: Numbers) -> float:
    """Of a mean force of water of particles at rest on a body, or its clamps' reaction; 0 of other goals."""
    quantity, probe = goals_quantity(scene), goals_probe(scene)
    if not of_particles(n) or not n.water.rests or n.plate is None or n.joint is None:
        return 0.0
    if quantity not in (*FORCES, *REACTIONS) or probe.body != n.plate.name:
        return 0.0
    if not any(scene.gravity):
        return _of_a_box(scene, n) if n.water.boxed and n.joint.closes and n.plate.clamps == 2 else 0.0
    body, up, dx = plates_body(scene, n.plate), upward(scene), scene.fluid.dx
    walls = np.concatenate([_segments(wall.polyline, wall.closed) for wall in scene.walls]) if scene.walls else None
    normal = normal_of(body)
    across = abs(float(normal[int(quantity.endswith("y"))]))
    if walls is None or across == 0.0:
        return 0.0
    corners = outline(body)[:, 0]
    middle, lost = 0.5 * (corners.min(axis=0) + corners.max(axis=0)), 0.0
    for corner in corners[distance_to(walls, corners) < _AT * dx]:
        before = [water for water in scene.fluid.bodies if contains(water, corner + dx * _AROUND).any()]
        depths = [float((corners_of([water]) @ up).max() - corner @ up) for water in before]
        lost += math.copysign(
            max(depths, default=0.0), float((corner - middle) @ normal)
        )  # one side's less the other's
    strip = STRIP if scene.fluid.h_over_dx >= MANY else OF_FEW
    lost = abs(lost) * strip * dx * scene.fluid.density * math.hypot(*scene.gravity)
    length = lengthwise(body)[2]
    push = length * float(np.mean(pressures(scene, body, (np.arange(_POINTS) + 0.5) / _POINTS)))
    if quantity in REACTIONS:
        uniform, tip = own_load(scene, body, normal)
        push += uniform * length + tip
    return lost / abs(push) if push else 0.0


def _of_a_box(scene: Scene, n: Numbers) -> float:
    """Of water in a box that a plate between two clamps closes, which bears k/(1 + k) of what presses the plate, k how
    many times as stiff it is, and leaves 1/(1 + k) to the clamps."""
    plate, volume = n.plate, sum(area(water) for water in scene.fluid.bodies)
    yields = (1.0 + plate.sheared) * plate.length**4 / (STATIC_FACTOR[2] * plate.stiffness)  # m per Pa
    stiffer = n.water.density * n.water.sound_speed**2 * SWEPT[2] * plate.length * yields / volume
    lost = 2.0 * IN_A_BOX * n.water.dx / plate.length
    return lost * (stiffer if goals_quantity(scene) in REACTIONS else 1.0)


def _segments(polyline: list[tuple[float, float]], closed: bool) -> np.ndarray:
    corners = np.asarray([*polyline, polyline[0]] if closed else polyline, dtype=float)
    return np.stack([corners[:-1], corners[1:]], axis=1)
