"""What a body's clamps add to the error of the goal, relative, and by how much more it counts in some goals.

Measured against 2-D elasticity (quadratic elements): cantilevers and plates clamped at both ends, 3 to 20 times as long
as thick, 4 to 20 particles across, ν 0 to 0.49; x = clamps × dx/L, t thickness, L length, or what of
it is wet where water at rest alone pushes.

    of particles   give way within about a particle: (0.6 + 1.45 ν) x + 9 x² of clamped ends; (0.27 + 0.1 ν) dx/t of a
                   long face, which counts as an end, x = dx/t, where water pushes along it; (1 + 0.9 ν) dx/t of one
                   that loads push along in a block less than 3 times as wide as high, at its ends, or felt there
                   (found 0.4 to 1.2: 1 to 5 times as wide as high, 6 and 12 across); 1.2 dx/t where they hold a
                   part of a side (ledges of 1 to 6 particles); corners that the limbs of a frame go round, and
                   steps where a body grows thinner, count as ends (found 4.5 % of one half as thick from its middle on)
    of a beam      hold its section's width too: 0.42 ν²/(1 − ν) t/L per clamp

of the largest deflection. It goes as the distance s from the clamp where the deflection goes as s²: 1/(ξ(2 − ξ)) times
as much of a displacement at ξ = s/L, or s/(L/2) between two clamps; and 1.25 times of a strain energy.
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.measures.held import FACES_OF_AXIS, held_in_part, held_sides, lengthwise, normal_of, pushed_along
from coupler.preflight.measures.plate import Plate, goals_probe, plates_body
from shared.geometry.limbs import limbs
from shared.geometry.regions import own_box, turn
from shared.schema.geometry import Body
from shared.schema.scene import Scene

SLIP = (0.6, 1.45, 9.0)
FLAT = (0.27, 0.1)
PUSHED, STOUT = (1.0, 0.9), 3.0
PART = 1.2
_SHARP = 0.7  # sine of a turn of the outline from which it is a corner
ALONG = 0.7  # cosine to a face's normal below which a way is along it
WIDTH = 0.42
OF_ENERGY = 1.25


def clamps_slip(scene: Scene, plate: Plate) -> float:
    """Of particles: clamps that give way."""
    body, nu, dx = plates_body(scene, plate), scene.solid.poisson_ratio, scene.solid.dx
    parts = held_in_part(scene, body)
    made_of = limbs(body)
    joints = plate.clamps + (made_of.corners if made_of else _steps(body) if plate.clamps else 0)
    share, flat = joints * dx / plate.bent, len(held_sides(scene, body)) - plate.clamps - parts
    if flat and _sheared(scene, plate, body):  # such a face is an end
        share, flat = share + flat * dx / plate.thickness, 0
    ends = (SLIP[0] + SLIP[1] * nu) * share + SLIP[2] * share**2
    across = (PUSHED[0] + PUSHED[1] * nu if _pushed_aside(scene, body) else FLAT[0] + FLAT[1] * nu) * flat
    across += PART if parts else 0.0
    return ends * _counts(scene, plate, body) + across * dx / plate.thickness


def _steps(body: Body) -> int:
    """Number of places where a drawn body grows thinner by a step, two inner corners each."""
    if body.polygon is None:
        return 0
    sides = np.diff([*body.polygon, body.polygon[0]], axis=0)
    after = np.roll(sides, -1, axis=0)
    turns = (sides[:, 0] * after[:, 1] - sides[:, 1] * after[:, 0]) / np.hypot(*sides.T) / np.hypot(*after.T)
    inner = turns * np.sign(turns.sum()) < -_SHARP
    return math.ceil(0.5 * int(inner.sum()))


def _sheared(scene: Scene, plate: Plate, body: Body) -> bool:
    """Whether water pushes a body along the long face that holds it, and the goal is how far."""
    probe = goals_probe(scene)
    if scene.fluid is None or probe is None or probe.body != plate.name:
        return False
    way = {"displacement-x": 0, "displacement-y": 1}.get(probe.quantity)
    return way is not None and abs(normal_of(body)[way]) < ALONG


def _pushed_aside(scene: Scene, body: Body) -> bool:
    """Whether a body without water is pushed along the long face that holds it, and stout, pushed at its ends, or the
    goal's point near one."""
    axis, thickness, length = lengthwise(body)
    if scene.fluid is not None or pushed_along(scene, body, 1 - axis):
        return False
    at_ends = any(load.body == body.name and load.face in FACES_OF_AXIS[axis] for load in scene.solid.loads)
    probe, box = goals_probe(scene), own_box(body)
    if probe is None or probe.point is None:
        return at_ends or length < STOUT * thickness
    along = float(turn(probe.point, body.rotate, backward=True)[axis])
    return at_ends or length < STOUT * thickness or min(abs(along - float(end[axis])) for end in box) < thickness


def clamps_width(scene: Scene, plate: Plate) -> float:
    """Of a beam: clamps that leave the section its width."""
    nu = scene.solid.poisson_ratio
    width = WIDTH * plate.clamps * nu**2 / (1.0 - nu) * plate.thickness / plate.bent
    if plate.along and scene.goal is not None and scene.goal.statistic == "period":  # goes as the length
        width *= 2.0
    return width * _counts(scene, plate, plates_body(scene, plate))


def never_moves(scene: Scene, plate: Plate) -> bool:
    """Whether the goal is a displacement where a clamp holds the body."""
    return _counts(scene, plate, plates_body(scene, plate)) == math.inf


def _counts(scene: Scene, plate: Plate, body: Body) -> float:
    """By how much more what a clamp gives way counts in the goal than in the largest deflection."""
    probe = goals_probe(scene)
    if probe is None or probe.body != plate.name:
        return 1.0
    if probe.quantity == "strain-energy":
        return OF_ENERGY
    if probe.quantity not in ("displacement-x", "displacement-y") or plate.along:
        return 1.0
    nearness = _from_clamps(scene, body, probe.point)
    return 1.0 if nearness is None else 1.0 / (nearness * (2.0 - nearness)) if nearness > 0.0 else math.inf


def _from_clamps(scene: Scene, body: Body, point: tuple[float, float]) -> float | None:
    """Distance of a point from the nearest clamped end over the way to where the body bends most, at most 1; None
    where nothing holds its ends, a clamp moves it, or its limbs lead round corners."""
    axis, _, length = lengthwise(body)
    ends = [FACES_OF_AXIS[axis].index(side) for side in held_sides(scene, body) if side in FACES_OF_AXIS[axis]]
    moved = any(clamp.motion is not None for clamp in scene.solid.clamps if clamp.body == body.name)
    if not ends or moved or limbs(body) is not None:
        return None
    box, along = own_box(body), float(turn(point, body.rotate, backward=True)[axis])
    nearest = min(abs(along - float(box[end][axis])) for end in ends)
    return min(nearest * len(ends) / length, 1.0)
