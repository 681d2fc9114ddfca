"""What a body's clamps add to the error of the goal, relative, and by how much more it counts in some goals.

Measured against 2-D elasticity (quadratic elements): cantilevers and plates clamped at both ends, 3 to 20 times as long
as thick, 4 to 20 particles across, ν 0 to 0.49; x = clamps × dx/L, t/L thickness over length.

    of particles   give way within about a particle: (0.6 + 1.45 ν) x + 9 x²
    of a beam      hold its section's width too: 0.42 ν²/(1 − ν) t/L per clamp

of the largest deflection. It goes as the distance s from the clamp where the deflection goes as s²: 1/(ξ(2 − ξ)) times
as much of a displacement at ξ = s/L, or s/(L/2) between two clamps; and 1.25 times of a strain energy.
"""

from __future__ import annotations

import math

from coupler.preflight_plate import FACES_OF_AXIS, Plate, goals_probe, lengthwise
from shared.regions import own_box, turn
from shared.schema import Scene
from shared.schema_geometry import Body

SLIP = (0.6, 1.45, 9.0)
WIDTH = 0.42
OF_ENERGY = 1.25


def clamps_slip(scene: Scene, plate: Plate) -> float:
    """Of particles: clamps that give way."""
    clamps = sum(clamp.body == plate.name for clamp in scene.solid.clamps)
    share, (base, slope, square) = clamps * scene.solid.dx / plate.length, SLIP
    return ((base + slope * scene.solid.poisson_ratio) * share + square * share**2) * _counts(scene, plate)


def clamps_width(scene: Scene, plate: Plate) -> float:
    """Of a beam: clamps that leave the section its width."""
    nu = scene.solid.poisson_ratio
    return WIDTH * plate.clamps * nu**2 / (1.0 - nu) * plate.thickness / plate.length * _counts(scene, plate)


def _counts(scene: Scene, plate: Plate) -> float:
    """By how much more what a clamp gives way counts in the goal than in the largest deflection."""
    probe = goals_probe(scene)
    if probe is None or probe.body != plate.name:
        return 1.0
    if probe.quantity == "strain-energy":
        return OF_ENERGY
    if probe.quantity not in ("displacement-x", "displacement-y"):
        return 1.0
    body = next(one for one in scene.solid.bodies if one.name == plate.name)
    nearness = _from_clamps(scene, body, probe.point)
    return 1.0 if nearness is None else 1.0 / (nearness * (2.0 - nearness)) if nearness > 0.0 else math.inf


def _from_clamps(scene: Scene, body: Body, point: tuple[float, float]) -> float | None:
    """Distance of a point from the nearest clamped end over the way to where the body bends most, at most 1; None
    where nothing holds its ends, or a clamp moves it."""
    axis, _, length = lengthwise(body)
    held = [clamp for clamp in scene.solid.clamps if clamp.body == body.name]
    ends = [FACES_OF_AXIS[axis].index(clamp.face) for clamp in held if clamp.face in FACES_OF_AXIS[axis]]
    if not ends or any(clamp.motion is not None for clamp in held):
        return None
    box, along = own_box(body), float(turn(point, body.rotate, backward=True)[axis])
    nearest = min(abs(along - float(box[end][axis])) for end in ends)
    return min(nearest * len(ends) / length, 1.0)
