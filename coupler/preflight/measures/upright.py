"""Water beside an upright plate that parts it from something else, from its floor to above its surface.

It gives way upward, to the surface, and not along the tank. With the plate's shape f(z), z from the floor of water of
height H and length T, k_n = (2n − 1) π/2H, what moves along is, over ρ ∫f² of the plate, a layer

    Σ 2 I_n²/(H k_n tanh k_n T) / ∫f²,    I_n = ∫ f cos k_n z dz

(potential flow, no waves: ω² ≫ g/H), 0.54 H beside a wall that moves as one, in a long tank. Sound makes no waves in it
below a frequency of c/4H, and it is felt as far as 1/k_1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight.measures.gravity import upward
from coupler.preflight.measures.held import FACES_OF_AXIS, held_sides, lengthwise, normal_of
from coupler.preflight.measures.plate import (
    LEVEL_PLATE,
    STATIC_FACTOR,
    Plate,
    goals_probe,
    goals_quantity,
    own_load,
    plates_body,
    waters_before,
)
from coupler.preflight.measures.water import UPWARD, Water
from shared.geometry.regions import axes_of, corners_of, own_box, turn
from shared.schema.geometry import Body
from shared.schema.probes import STRESSES
from shared.schema.scene import Scene

SWEPT = {1: 0.4, 2: 0.55}  # area that a plate sweeps over its deflection and length, by clamped ends
_MODES, _POINTS = 40, 400


@dataclass(frozen=True)
class Side:
    """Water on one side of the plate: its `height` over its floor, `length` away from the plate, and how high its floor
    stands over the plate's lower end [m]."""

    height: float
    length: float
    floor: float


def upright(scene: Scene, body: Body, water: Water) -> bool:
    """Whether a body stands upright in water that has a surface."""
    across = abs(float(normal_of(body) @ upward(scene)))
    return any(scene.gravity) and across < UPWARD and (water.waves or (water.rests and not water.boxed))


def parted(scene: Scene, body: Body, water: Water) -> list[Side]:
    """The waters that an upright body parts; none where some flows over or under it."""
    if not upright(scene, body, water):
        return []
    up, slack, found = upward(scene), scene.fluid.dx, []
    own = corners_of([body])
    for normal, waters in waters_before(scene, body, 0.0):
        corners = corners_of(waters)
        low, high = float((corners @ up).min()), float((corners @ up).max())
        if (own @ up).max() < high - slack or (own @ up).min() > low + slack:
            return []
        length = float((corners @ normal).max() - (own @ normal).max())
        found.append(Side(high - low, max(length, scene.fluid.dx), low - float((own @ up).min())))
    return found


def moving_layer(scene: Scene, plate: Plate, sides: list[Side]) -> float:
    """Thickness [m] of the water that moves along with the plate, over all of it."""
    z = (np.arange(_POINTS) + 0.5) / _POINTS
    body, share = plates_body(scene, plate), 0.0
    squares = float(np.mean(_shape(scene, plate, body, z) ** 2)) * plate.length
    for side in sides:
        k = (np.arange(_MODES) + 0.5) * math.pi / side.height
        f = _shape(scene, plate, body, np.clip((side.floor + z * side.height) / plate.length, 0.0, 1.0))
        moved = np.cos(np.outer(k, z * side.height)) @ f * side.height / _POINTS
        share += float(np.sum(2.0 * moved**2 / (side.height * k * np.tanh(k * side.length))))
    return share / squares


def _shape(scene: Scene, plate: Plate, body: Body, share: np.ndarray) -> np.ndarray:
    """How far the plate moves at shares of its length from its lower end on: as a body, or as under a uniform load."""
    if not plate.clamps:
        return np.ones_like(share)
    if plate.clamps == 2:
        return 16.0 * (share * (1.0 - share)) ** 2
    axis = lengthwise(body)[0]
    rises = float(axes_of(body.rotate)[axis] @ upward(scene)) > 0.0
    x = share if FACES_OF_AXIS[axis][0 if rises else 1] in held_sides(scene, body) else 1.0 - share
    return x**2 * (6.0 - 4.0 * x + x**2) / 3.0


def levels_pull(scene: Scene, plate: Plate, sides: list[Side]) -> float:
    """What the levels beside the plate, which fall as it gives way and rise where it goes, take off its way, over that:
    their stiffness over the plate's."""
    weight = scene.fluid.density * math.hypot(*scene.gravity)
    if plate.model == "spring":
        body = plates_body(scene, plate)
        normal = normal_of(body)
        held = float(normal**2 @ np.asarray(scene.solid.spring.stiffness[:2]))
        return weight * sum(side.height**2 / side.length for side in sides) / held if held > 0.0 else math.inf
    if not plate.clamps:
        return 0.0
    held = STATIC_FACTOR[plate.clamps] * plate.stiffness / (SWEPT[plate.clamps] * plate.length**2)
    return weight * sum(side.height**3 / side.length for side in sides) / held


def opposed(scene: Scene, plate: Plate) -> float:
    """How often the push of resting water counts in what a plate's own loads leave of it, at the goal's place, as a
    thin beam bends; 1 of level plates (counts_of_water) and of those without loads across them."""
    body = plates_body(scene, plate)
    normal, up, quantity = normal_of(body), upward(scene), goals_quantity(scene)
    own, tip = own_load(scene, body, normal)
    if not plate.clamps or not any(scene.gravity) or abs(float(normal @ up)) >= LEVEL_PLATE or not (own or tip):
        return 1.0
    axis, _, length = lengthwise(body)
    at_lower = plate.clamps == 2 or FACES_OF_AXIS[axis][0] in held_sides(scene, body)
    share = (np.arange(_POINTS) + 0.5) / _POINTS  # of the way from a clamp
    push = pressures(scene, body, share if at_lower else 1.0 - share)
    probe = goals_probe(scene)
    at = 1.0 if plate.clamps == 1 else 0.5
    if probe.point is not None:
        at = (float(turn(probe.point, body.rotate, backward=True)[axis]) - float(own_box(body)[0][axis])) / length
        at = min(max(at if at_lower else 1.0 - at, 0.0), 1.0)
    told = _bent_by(plate.clamps, at, quantity in STRESSES, share)
    of_water, of_own = float(push @ told) / _POINTS, own * float(np.mean(told))
    if plate.clamps == 1:
        of_own += tip / length * float(_bent_by(1, at, quantity in STRESSES, np.ones(1))[0])
    left = abs(of_water + of_own)
    return max(1.0, abs(of_water) / left) if left > 0.0 else math.inf


def pressures(scene: Scene, body: Body, share: np.ndarray) -> np.ndarray:
    """Pressure [Pa] of water at rest on a body along the normal of its long faces, at shares of its length."""
    axis, _, length = lengthwise(body)
    lower, upper = (np.asarray(corner) for corner in own_box(body))
    normal, up, push = normal_of(body), upward(scene), np.zeros(len(share))
    places = np.tile(0.5 * (lower + upper), (len(share), 1))
    places[:, axis] = lower[axis] + length * share
    heights = turn(places, body.rotate) @ up
    for outward, waters in waters_before(scene, body, 0.0):
        surface = float((corners_of(waters) @ up).max())
        depth = np.maximum(surface - heights, 0.0)
        push -= scene.fluid.density * math.hypot(*scene.gravity) * depth * float(outward @ normal)
    return push


def _bent_by(clamps: int, at: float, moment: bool, share: np.ndarray) -> np.ndarray:
    """What a force at shares of a thin beam's length makes of its deflection at another, or of its moment there, over
    what is the same for all."""
    if clamps == 1:
        if moment:
            return np.maximum(share - at, 0.0)
        near, far = np.minimum(share, at), np.maximum(share, at)
        return near**2 * (3.0 * far - near) / 6.0
    near, far = np.minimum(share, at), np.maximum(share, at)
    return (1.0 - far) ** 2 * near**2 * (3.0 * far - 3.0 * far * near - (1.0 - far) * near) / 6.0
