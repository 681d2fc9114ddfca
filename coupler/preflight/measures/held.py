"""How a body of the solid is held and what pushes it, from the scene alone: the swing that this gives.

A body that all pushes along its length stretches, as a bar; one that is held on a long face shears over its thickness,
and bends a little, or, pushed straight at it, is pressed; others bend, as thin beams. A force N along a cantilever (a
weight W counts as 0.315 W at its tip) changes its bending stiffness by 1 + N/N_E, N_E = π² D/(4 L²) Euler's load. A
body made of limbs, a frame or a ring (shared/geometry/limbs.py), bends as a beam of their thickness and of the length
of all of them.
"""

from __future__ import annotations

import math

import numpy as np

from shared.elasticity import lame, plane_modulus, wave_speed
from shared.geometry.limbs import limbs
from shared.geometry.motion_table import largest_speed
from shared.geometry.regions import axes_of, corners_of, faces, own_box, own_size
from shared.schema.geometry import Body
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS, Load
from shared.solid_step import first_frequency

FACES_OF_AXIS = (("left", "right"), ("bottom", "top"))
_WHOLE = 0.99  # of a side, from which an edge of a polygon is that side
_ALONG = 1e-9  # of a push, that may point elsewhere
_END = 1.5  # of the thickness of a body's limbs: a face no longer than this ends one
END = "end"
LEAST_LEFT = 0.01  # of the bending stiffness of a cantilever that is pressed along its length, for estimates
_WEIGHT = 0.315  # a cantilever buckles under 7.837 D/L² of its own weight, under π²/4 at its tip


def lengthwise(body: Body) -> tuple[int, float, float]:
    """Axis of a body's length in its own frame, its thickness and its length [m]."""
    extent = own_size(body)
    axis = int(extent[1] > extent[0])
    return axis, float(extent[1 - axis]), float(extent[axis])


def normal_of(body: Body) -> np.ndarray:
    """Unit normal (2,) of a body's long faces."""
    return axes_of(body.rotate)[1 - lengthwise(body)[0]]


def slender(scene: Scene, body: Body) -> tuple[float, float]:
    """Thickness and length [m] of a body as it bends: of its limbs where it is elastic and made of them."""
    found = None if scene.solid.model in RIGID_MODELS else limbs(body)
    return lengthwise(body)[1:] if found is None else (found.thickness, found.length)


def held_sides(scene: Scene, body: Body) -> list[str]:
    """The face of each of a body's clamps; of an edge that is a whole side of the body, that side; END of each limb
    that ends in the face."""
    clamps = (clamp for clamp in scene.solid.clamps if clamp.body == body.name)
    return [side for clamp in clamps for side in _limb_ends(body, clamp.face) or [_side(body, clamp.face)]]


def _limb_ends(body: Body, face: str) -> list[str]:
    """END for each stretch of a face if all of them end limbs; nothing of a single one at an end of the body."""
    made_of = limbs(body)
    if made_of is None:
        return []
    segments = faces(body)[face]
    segments = segments[np.argsort(segments[:, 0] @ (segments[0, 1] - segments[0, 0]))]
    apart = np.hypot(*(segments[1:, 0] - segments[:-1, 1]).T) > _ALONG * made_of.length
    stretches = np.split(segments, np.flatnonzero(apart) + 1)
    lengths = [float(np.hypot(*(one[-1, 1] - one[0, 0]))) for one in stretches]
    at_an_end = len(lengths) == 1 and face in FACES_OF_AXIS[lengthwise(body)[0]]
    if at_an_end or max(lengths) > _END * made_of.thickness:
        return []
    return [END] * len(lengths)


def _side(body: Body, face: str) -> str:
    if not face.startswith("edge-") or body.polygon is None:
        return face
    k, (lower, upper) = int(face.removeprefix("edge-")), own_box(body)
    edge = np.array([body.polygon[k], body.polygon[(k + 1) % len(body.polygon)]])
    for axis, names in enumerate(FACES_OF_AXIS):
        whole = abs(float(np.diff(edge[:, 1 - axis])[0])) >= _WHOLE * float(upper[1 - axis] - lower[1 - axis])
        for name, place in zip(names, (lower, upper), strict=True):
            if whole and np.allclose(edge[:, axis], place[axis], rtol=0.0, atol=_ALONG * float(np.max(upper - lower))):
                return name
    return face


def held_ends(scene: Scene, body: Body) -> int:
    """Number of a body's clamped ends; two of more, as a frame may have."""
    ends = (END, *FACES_OF_AXIS[lengthwise(body)[0]])
    return min(sum(side in ends for side in held_sides(scene, body)), 2)


def held_in_part(scene: Scene, body: Body) -> int:
    """Number of a body's clamps that hold an edge which is no whole side."""
    return sum(side.startswith("edge-") for side in held_sides(scene, body))


def sheared(scene: Scene, body: Body) -> float:
    """Deflection by shear under a uniform load, over that by bending: k D/(κ G t L²) = k (t/L)²/5(1 − ν)."""
    thickness, length = slender(scene, body)
    times = {1: 4.0, 2: 48.0}.get(held_ends(scene, body), 0.0)
    return times / (5.0 * (1.0 - scene.solid.poisson_ratio)) * (thickness / length) ** 2


def bending_frequency(scene: Scene, body: Body) -> float:
    """First bending frequency [1/s] of a body as a thin beam; held by a part of a side, it may be a cantilever."""
    solid, (thickness, length) = scene.solid, slender(scene, body)
    ends = held_ends(scene, body) or int(bool(held_in_part(scene, body)))
    return first_frequency(ends, length, bending_stiffness(scene, body), solid.density * thickness)


def swing_frequency(scene: Scene, body: Body, squeeze: float) -> float:
    """Frequency [1/s] of the first swing that what pushes a body can start, pressed by a share of Euler's load."""
    solid, axis, (thickness, length) = scene.solid, lengthwise(body)[0], slender(scene, body)
    ends, sides = held_ends(scene, body), held_sides(scene, body)
    flat = sum(side in FACES_OF_AXIS[1 - axis] for side in sides)
    if pushed_along(scene, body, axis):
        return math.sqrt(plane_modulus(solid) / solid.density) / (length * (4.0 if ends == 1 else 2.0))
    if flat and not ends:
        shear = math.sqrt(lame(solid)[1] / solid.density)
        if pushed_along(scene, body, 1 - axis):
            return wave_speed(solid) / (thickness * (4.0 if flat == 1 else 2.0))
        bends = 1.25 * (1.0 - solid.poisson_ratio) * (thickness / length) ** 2 if flat == 1 else 0.0  # over its shear
        return shear / (thickness * (4.0 if flat == 1 else 2.0) * math.sqrt(1.0 + bends))
    return bending_frequency(scene, body) * math.sqrt(left_of_stiffness(squeeze))


def pushed_along(scene: Scene, body: Body, axis: int) -> bool:
    """Whether all that moves a body acts along one axis of its own frame: what stands on its faces at the axis' ends,
    weight and a start."""
    solid = scene.solid
    turned = body.spin or body.velocity_mode is not None
    moved = any(clamp.motion is not None for clamp in solid.clamps if clamp.body == body.name)
    loads = [load for load in solid.loads if load.body == body.name]
    aside = any(load.traction and _side(body, load.face) not in FACES_OF_AXIS[axis] for load in loads)
    if scene.fluid is not None or turned or moved or aside or limbs(body) is not None:
        return False
    pushes = [load.traction or load.acceleration for load in loads]
    pushes += [scene.gravity if solid.gravity else (0.0, 0.0), body.velocity]
    across = axes_of(body.rotate)[1 - axis]
    wrong = (abs(float(np.dot(push, across))) > _ALONG * math.hypot(*push) for push in pushes)
    return any(any(push) for push in pushes) and not any(wrong)


def squeezed(scene: Scene, body: Body, in_water: bool) -> float:
    """What presses a cantilever along its length over Euler's load; below 0 where it is pulled, 0 of other bodies. In
    water on both sides its weight is less by that of the water."""
    solid, (axis, thickness, length) = scene.solid, lengthwise(body)
    sides = [side for side in held_sides(scene, body) if side in FACES_OF_AXIS[axis]]
    if len(sides) != 1:
        return 0.0
    near = FACES_OF_AXIS[axis].index(sides[0])
    towards = axes_of(body.rotate)[axis] * (1.0 if near else -1.0)  # from the tip to the clamp
    mass = _WEIGHT * solid.density * thickness * length
    lifted = scene.fluid.density / solid.density if in_water else 0.0
    push = mass * (float(np.dot(scene.gravity, towards)) if solid.gravity else 0.0) * (1.0 - lifted)
    for load in (one for one in solid.loads if one.body == body.name):
        along = float(np.dot(load.traction or load.acceleration, towards)) * largest_factor(load)
        if load.acceleration:
            push += mass * along
        elif _side(body, load.face) == FACES_OF_AXIS[axis][1 - near]:
            push += thickness * along
    return push * 4.0 * length**2 / (math.pi**2 * bending_stiffness(scene, body))


def left_of_stiffness(squeeze: float) -> float:
    """Bending stiffness of what is pressed by a share `squeeze` of Euler's load, over that of what is not."""
    return max(1.0 - squeeze, LEAST_LEFT)


def damping_drag(scene: Scene, body: Body) -> float:
    """Drag of a damping, −η m u of the velocity u in the scene, on a body that its clamps carry along, over its weight
    and inertia: at least that of coming to its speed over the time of its table."""
    solid = scene.solid
    motions = [clamp.motion for clamp in solid.clamps if clamp.body == body.name and clamp.motion is not None]
    if not motions or solid.model in RIGID_MODELS or solid.damping == 0.0:
        return 0.0
    speed, push = (max(largest_speed(motion, corners_of([body]), order) for motion in motions) for order in (1, 2))
    push = max(push, speed / max(motion.times[-1] for motion in motions))
    push += math.hypot(*scene.gravity) if solid.gravity else 0.0
    return solid.damping * speed / push if push > 0.0 else 0.0


def largest_factor(load: Load) -> float:
    """The factor of a load that is largest in size."""
    return 1.0 if load.table is None else max(load.table.factors, key=abs)


def bending_stiffness(scene: Scene, body: Body) -> float:
    """D = E t³/(12 (1 − ν²)) [N m]; infinite of a rigid body."""
    solid, thickness = scene.solid, slender(scene, body)[0]
    return (solid.youngs_modulus or math.inf) * thickness**3 / (12.0 * (1.0 - solid.poisson_ratio**2))
