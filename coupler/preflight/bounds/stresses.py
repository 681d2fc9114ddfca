"""Bounds of stresses at a point of a structure, relative, besides those of its stiffness.

of particles       0.8/n of what is not along a slender body, n particles across: across it, sheared, von Mises' in
                   its middle half, a disc's; 2 to 17 % of a cantilever's, 4 to 8 across; of a component of the
                   scene's that is along it and aslant, by the share that is sheared; a beam has none across
                   within 2.5 spacings of a face that bears a traction q, which they take over three rows: found
                   0.31 q too little on the face, 0.12 q half a spacing below, 0.08 q too much two below, at any n;
                   of a stress along a plate 1.1 ν/(1 − ν) q, of others none
                   no bound of a block that is pushed along the face that holds it: found 17 to 150 %
of a beam          q/5 of a load q along it on outer fibres besides bending (Airy): 0.8 (t/L)² half-way between two
                   clamps, t²/(15 s²) at s from a free end, t²/(5 s²) under water
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.measures.held import FACES_OF_AXIS, held_sides, lengthwise, normal_of, pushed_along
from coupler.preflight.measures.plate import Plate, goals_probe, goals_quantity, plates_body
from shared.geometry.limbs import limbs
from shared.geometry.regions import axes_of, faces, own_box, turn
from shared.schema.probes import STRESSES
from shared.schema.scene import Scene
from shared.schema.solid import PARTICLE_MODELS, Load

UNKNOWN = math.inf
ASIDE = 0.8  # of a stress that is not along a slender body, over the particles across
AXIAL = 0.25  # of the stress along a body, from which a component of the scene's is mostly that
SLENDER = 3.0  # length over thickness
ON_FACE, BELOW, ROWS = 0.4, 0.12, 2.5  # of a traction, on its face and from half a spacing below; spacings
ON_ROWS = 0.9  # spacings from a face, below which what crosses a plate that bends is its load's
ALONG_FACE = 1.1  # of a traction, times ν/(1 − ν)


def of_stress(scene: Scene, plate: Plate) -> float:
    """Of a stress of particles; infinite where nothing bounds it."""
    body, (x, y) = plates_body(scene, plate), axes_of(plates_body(scene, plate).rotate)[0]
    slender_one = axial(scene, plate) and not _flat(scene, plate)
    aslant = abs(float(x * y)) if goals_quantity(scene) != "von-mises" else 0.0
    error, near = ASIDE / plate.across * (aslant if slender_one else 1.0), _nearest_load(scene, plate)
    if near is None:
        return error
    if slender_one:
        ends = FACES_OF_AXIS[lengthwise(body)[0]]
        nu = scene.solid.poisson_ratio
        much = 5.0 * ALONG_FACE * nu / (1.0 - nu) * beside_bending(scene, plate) * (plate.thickness / plate.length) ** 2
        return error + (ON_FACE if near[0].face in ends else much)
    shallow = near[1] < ON_ROWS or _flat(scene, plate)
    return error + (BELOW + (ON_FACE - BELOW) * max(1.0 - 2.0 * near[1], 0.0) if shallow else 0.0)


def _flat(scene: Scene, plate: Plate) -> bool:
    """Whether a long face holds a body."""
    body = plates_body(scene, plate)
    return any(side in FACES_OF_AXIS[1 - lengthwise(body)[0]] for side in held_sides(scene, body))


def lost_stress(scene: Scene, plate: Plate) -> str:
    """Why nothing is known of a stress of particles; empty where something is."""
    body, quantity = plates_body(scene, plate), goals_quantity(scene)
    if quantity not in STRESSES or plate.model not in PARTICLE_MODELS or limbs(body) is not None:
        return ""
    axis, thickness, length = lengthwise(body)
    sides, flat = held_sides(scene, body), _flat(scene, plate)
    straight = pushed_along(scene, body, 1 - axis if flat else axis)
    if sides and scene.fluid is None and not straight and (length < SLENDER * thickness or flat):
        return "in a block that is pushed along the face that holds it stresses have no bound: judge a way or an energy"
    near = _nearest_load(scene, plate)
    if near is None or (not flat and (axial(scene, plate) or (length >= SLENDER * thickness and near[1] > ON_ROWS))):
        return ""
    normal = np.abs(normal_of(body) if near[0].face in FACES_OF_AXIS[1 - axis] else axes_of(body.rotate)[axis])
    seen = {"stress-xx": normal[0], "stress-yy": normal[1], "stress-xy": normal.max()}.get(quantity, 0.0)
    push = abs(np.asarray(near[0].traction))
    told = {"stress-xx": push[0], "stress-yy": push[1]}.get(quantity, push[int(np.argmin(normal))])
    if seen > 1.0 - 1e-9 and told > 0.1 * push.max():
        return ""
    return f"within {ROWS:g} spacings of a face that bears a traction, of which a stress errs by a part: probe deeper"


def _nearest_load(scene: Scene, plate: Plate) -> tuple[Load, float] | None:
    """The traction whose face is nearest to the goal's point, and how many spacings; None beyond `ROWS`."""
    body, point = plates_body(scene, plate), goals_probe(scene).point
    own = turn(point, body.rotate, backward=True)
    found = []
    for load in (one for one in scene.solid.loads if one.body == plate.name and one.traction):
        segments = faces(body)[load.face]
        ways, start = segments[:, 1] - segments[:, 0], segments[:, 0]
        share = np.clip(np.sum((own - start) * ways, axis=1) / np.sum(ways**2, axis=1), 0.0, 1.0)
        found.append((float(np.hypot(*(start + share[:, None] * ways - own).T).min()) / scene.solid.dx, load))
    distance, load = min(found, key=lambda one: one[0], default=(math.inf, None))
    return (load, distance) if distance <= ROWS else None


def beside_bending(scene: Scene, plate: Plate) -> float:
    """Of a stress along a beam, times (L/t)²: q/5 of a load along it over 6 M/t², M = q s²/2 at s from a free end and
    q (L²/24 − z²/2) at z from the middle between two clamps; q s²/6 under water, whose pressure grows from the free end
    on; infinite where M is nothing."""
    body = plates_body(scene, plate)
    axis, _, length = lengthwise(body)
    ends = [side for side in held_sides(scene, body) if side in FACES_OF_AXIS[axis]]
    at_an_end = any(load.face in FACES_OF_AXIS[axis] for load in scene.solid.loads if load.body == body.name)
    if not ends or at_an_end or plate.along or not axial(scene, plate):
        return 0.0
    lower, upper = (float(corner[axis]) for corner in own_box(body))
    place = float(turn(goals_probe(scene).point, body.rotate, backward=True)[axis])
    if len(ends) > 1:
        moment = abs(1.0 / 24.0 - 0.5 * ((place - 0.5 * (lower + upper)) / length) ** 2)
    else:
        share = 0.5 if scene.fluid is None else 1.0 / 6.0
        moment = share * ((place - (lower if ends[0] == FACES_OF_AXIS[axis][1] else upper)) / length) ** 2
    return 1.0 / (30.0 * moment) if moment > 0.0 else UNKNOWN


def axial(scene: Scene, plate: Plate) -> bool:
    """Whether the goal's stress is mostly the one along a slender body: not across it, nor sheared."""
    probe, body = goals_probe(scene), plates_body(scene, plate)
    axis, thickness, length = lengthwise(body)
    if length < SLENDER * thickness or limbs(body) is not None:
        return False
    x, y = axes_of(body.rotate)[axis]
    if probe.quantity == "von-mises":
        middle = 0.5 * sum(float(corner[1 - axis]) for corner in own_box(body))
        return abs(float(turn(probe.point, body.rotate, backward=True)[1 - axis]) - middle) > 0.25 * thickness
    return {"stress-xx": x * x, "stress-yy": y * y, "stress-xy": abs(x * y)}[probe.quantity] > AXIAL
