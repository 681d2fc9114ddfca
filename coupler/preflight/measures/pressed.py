"""Strain along the way from the face that holds a body, and what the material's law makes of it.

A load's stress over the modulus is s, below 0 where it presses; along a body that its ends hold the modulus is
E/(1 − ν²), over one that a long face holds λ + 2μ. The laws are one for small s alone:

    total-lagrangian   St. Venant-Kirchhoff, s = λ(λ² − 1)/2 of a stretch λ: soft when pressed (10 % at s = −0.06, 43 %
                       at −0.15), and s by what errs besides; it bears 1/(3√3) = 0.192 at most, 4/27 = 0.148 of what
                       comes at once
    ctvf               stress by the rate of strain, as ln λ: stiff when pressed, up to s of itself     beds of gel
    beam               linear; against the first 1.5 s
"""

from __future__ import annotations

import math

import numpy as np

from coupler.preflight.measures.held import FACES_OF_AXIS, held_ends, held_sides, largest_factor, lengthwise
from coupler.preflight.measures.water import Water
from shared.elasticity import lame, plane_modulus
from shared.geometry.regions import axes_of, own_size
from shared.schema.geometry import Body
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS

MOST, AT_ONCE = 1.0 / (3.0 * math.sqrt(3.0)), 4.0 / 27.0
_BEFORE = 1.0 - 1e-9  # of what gives way
_LAW = {"ctvf": 1.0, "beam": 1.5}


def law_error(model: str, strain: float) -> float:
    """What the law of `model` makes of a linear `strain`, over it; infinite where the body gives way."""
    if model != "total-lagrangian":
        return _LAW.get(model, 0.0) * abs(strain)
    if strain <= -AT_ONCE:
        return math.inf
    stretch = _stretch(strain)
    return abs(2.0 / (stretch * (1.0 + stretch)) - 1.0)  # (stretch − 1) over strain, of a strain of 0 too


def with_law(model: str, strain: float, error: float) -> float:
    """An `error` beside a linear `strain`, and what the law makes of both: where it is soft, more of either."""
    if model != "total-lagrangian" or not -AT_ONCE < strain < 0.0:
        return error + law_error(model, strain)
    return (1.0 + error) * (1.0 + law_error(model, max(strain * (1.0 + error), _BEFORE * -AT_ONCE))) - 1.0


def _stretch(strain: float) -> float:
    """The root λ of λ³ − λ = 2 s that is 1 without a load."""
    third = 3.0 * math.sqrt(3.0) * strain
    turned = math.cos(math.acos(third) / 3.0) if third <= 1.0 else math.cosh(math.acosh(third) / 3.0)
    return 2.0 / math.sqrt(3.0) * turned


def strain_along(scene: Scene, body: Body, water: Water | None, wet: int) -> float:
    """Linear strain that end loads, weight and, where one of its long faces is `wet`, water put along the way from the
    face that holds a body at its clamp; an estimate. 0 of one that none holds."""
    solid, (axis, _, _), sides = scene.solid, lengthwise(body), held_sides(scene, body)
    if solid.youngs_modulus is None or solid.model in RIGID_MODELS or not sides:
        return 0.0
    modulus = plane_modulus(solid)
    flat = [side for side in sides if side in FACES_OF_AXIS[1 - axis]]
    if len(flat) == 1 and not held_ends(scene, body):
        axis = 1 - axis
        lam, mu = lame(solid)
        modulus = lam + 2.0 * mu
    held = [side for side in sides if side in FACES_OF_AXIS[axis]]
    outward = axes_of(body.rotate)[axis] * (-1.0 if held == [FACES_OF_AXIS[axis][1]] else 1.0)
    length, g = float(own_size(body)[axis]) / max(len(held), 1), np.asarray(scene.gravity)  # two ends bear half each
    stress = float(g @ outward) * solid.density * length if solid.gravity else 0.0
    for one in (one for one in solid.loads if one.body == body.name):
        push = float(np.dot(one.traction or one.acceleration, outward)) * largest_factor(one)
        if one.acceleration:
            stress += push * solid.density * length
        elif one.face in FACES_OF_AXIS[axis] and one.face not in held:
            stress += push
    if held == flat and flat and wet and water is not None:
        stress -= water.density * (float(np.hypot(*g)) * water.height if water.rests else water.speed**2)
    return stress / modulus
