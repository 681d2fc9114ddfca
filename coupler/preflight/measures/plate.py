"""The structure's part of pre-flight: the body that matters as a plate, from the scene alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight.measures.afloat import buoyant_stiffness
from coupler.preflight.measures.gravity import upward
from coupler.preflight.measures.held import (
    FACES_OF_AXIS,
    bending_frequency,
    bending_stiffness,
    held_ends,
    largest_factor,
    lengthwise,
    normal_of,
    pushed_along,
    sheared,
    slender,
    squeezed,
    swing_frequency,
)
from coupler.preflight.measures.pressed import strain_along
from coupler.preflight.measures.shapes import area
from coupler.preflight.measures.water import UPWARD, Water, edge_samples
from shared.elasticity import wave_speed
from shared.geometry.limbs import limbs
from shared.geometry.regions import axes_of, contains, corners_of, outline, own_size
from shared.scene.sides import is_solids
from shared.schema.fluid import FluidBody
from shared.schema.geometry import Body
from shared.schema.probes import Probe
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS
from shared.solid_step import (
    UPDATED_COURANT,
    beam_step,
    expected_limit,
    lattice_step,
    viscous_time,
)

STATIC_FACTOR = {1: 8.0, 2: 384.0}  # k in the largest deflection q L⁴/(k D) under a uniform load
TIP_FACTOR = 3.0  # the same of a cantilever, F L³/(k D) under a force at its tip
LEVEL_PLATE = 0.99  # cosine of its normal's angle to gravity
_WET = 0.5  # of a face's samples before which water stands, from which it counts as wetted


@dataclass(frozen=True)
class Plate:
    """The body that the goal asks about, or else the thinnest of the solid. `bent` [m]: length along which it bends;
    `frequency` [1/s]: of a slender body, by bending alone, or of a rigid one on its springs; `sheared`: what shear adds
    to its deflection, over that; `deflection` [m]: of a slender body under the scene's loads; None where there is no
    such thing. `strain`: under them along the way from the face that holds
    it, pressed below 0; `along`: they push it along its length alone; `squeeze`: what presses it along its length over
    Euler's load; `wet`: number of its long faces with water before them at t = 0; `thinnest` [m]: thickness of the
    thinnest body, the first to fail where an exchange or a spacing does."""

    name: str
    model: str
    density: float
    thickness: float
    length: float
    bent: float
    across: float
    clamps: int
    wave_speed: float
    stiffness: float
    frequency: float | None
    sheared: float
    deflection: float | None
    strain: float
    along: bool
    squeeze: float
    wet: int
    particles: float
    step: float
    damping: float
    thinnest: float

    @property
    def fewest(self) -> float:
        """Particles across the thinnest body."""
        return self.across * self.thinnest / self.thickness


def goals_probe(scene: Scene) -> Probe | None:
    """The probe that the goal is about."""
    return next((one for one in scene.probes if scene.goal is not None and one.name == scene.goal.probe), None)


def goals_quantity(scene: Scene) -> str:
    """What that probe measures; empty without one."""
    probe = goals_probe(scene)
    return "" if probe is None else probe.quantity


def plates_body(scene: Scene, plate: Plate) -> Body:
    """The body that a plate was measured of."""
    return next(body for body in scene.solid.bodies if body.name == plate.name)


def of_a_body(scene: Scene) -> bool:
    """Whether the goal is of what a body of the solid does, and not of the water's push on it."""
    probe = goals_probe(scene)
    return probe is not None and is_solids(scene, probe)


def measure_plate(scene: Scene, water: Water | None) -> Plate:
    """The plate of a scene with a structure, beside its `water` if there is any."""
    solid, probe = scene.solid, goals_probe(scene)
    thinnest = min(solid.bodies, key=lambda one: slender(scene, one)[0])
    asked = (one for one in solid.bodies if probe is not None and one.name == probe.body)
    body = next(asked, thinnest)
    axis, (thickness, length) = lengthwise(body)[0], slender(scene, body)
    ends = held_ends(scene, body)
    elastic = solid.youngs_modulus is not None and solid.model not in RIGID_MODELS
    stiffness = bending_stiffness(scene, body)
    frequency = deflection = None
    levels = levels_before(scene, body) if water is not None else []
    squeeze = squeezed(scene, body, len(levels) == 2) if elastic else 0.0
    if elastic:
        frequency = swing_frequency(scene, body, squeeze)
    damping = solid.damping
    if solid.model == "spring":
        frequency, damping = _sprung(scene, body)
    strain = strain_along(scene, body, water, len(levels))
    along = elastic and pushed_along(scene, body, axis)
    if along and ends:
        deflection = abs(strain) * length
    elif elastic and ends:
        uniform, tip = _load(scene, body, normal_of(body), water, levels)
        bending = uniform * length / STATIC_FACTOR[ends] + (tip / TIP_FACTOR if ends == 1 else 0.0)
        deflection = abs(bending) * length**3 / stiffness
    return Plate(
        name=body.name,
        model=solid.model,
        density=solid.density,
        thickness=thickness,
        length=length,
        bent=min(length, _bent(scene, body, water)),
        across=thickness / solid.dx,
        clamps=ends,
        wave_speed=wave_speed(solid) if solid.youngs_modulus is not None else math.inf,
        stiffness=stiffness,
        frequency=frequency,
        sheared=sheared(scene, body) if elastic and not along else 0.0,
        deflection=deflection,
        strain=strain,
        along=along,
        squeeze=squeeze,
        wet=len(levels),
        particles=_solid_particles(scene),
        step=_solid_step(scene, ends),
        damping=damping,
        thinnest=slender(scene, thinnest)[0],
    )


def _sprung(scene: Scene, body: Body) -> tuple[float | None, float]:
    """Frequency [1/s] and damping [1/s] of a body on its springs: along the axis that the goal asks about, where
    buoyancy holds it too if that is gravity's; else of the stiffest of those that water before one of its faces, or
    anything, can push against. None and 0 without."""
    spring, mass = scene.solid.spring, scene.solid.density * area(body)
    probe = goals_probe(scene)
    asked = {"x": 0, "y": 1}.get(goals_quantity(scene).rpartition("-")[2])
    held, pushed = np.array(spring.stiffness[:2]), np.eye(2)
    if scene.fluid is not None:
        held = held + buoyant_stiffness(scene, body) * upward(scene) ** 2
    if asked is not None and probe.body == body.name:
        pushed = pushed[[asked]]
    elif scene.fluid is not None:
        middle, outward = edge_samples([body], scene.fluid.dx)
        wet = np.any([contains(water, middle + scene.fluid.dx * outward) for water in scene.fluid.bodies], axis=0)
        pushed = outward[wet] if wet.any() else pushed
    stiffness = pushed**2 @ held
    damping = pushed**2 @ np.array(spring.damping[:2])
    k = int(np.argmax(stiffness))
    return (math.sqrt(stiffness[k] / mass) / (2.0 * math.pi), damping[k] / mass) if stiffness[k] > 0.0 else (None, 0.0)


def _solid_particles(scene: Scene) -> float:
    """Particles, or nodes of beams, that the solid steps."""
    solid = scene.solid
    if solid.model == "beam":
        return sum(float(own_size(body).max()) / solid.dx + 1.0 for body in solid.bodies)
    return sum(area(body) for body in solid.bodies) / solid.dx**2


def _solid_step(scene: Scene, clamps: int) -> float:
    """As the model will choose it, where a lattice's largest frequency is an expectation (shared/solid_step.py)."""
    solid = scene.solid
    if solid.model == "beam":
        return beam_step(max(bending_frequency(scene, body) for body in solid.bodies))
    if solid.model in RIGID_MODELS:
        return scene.end_time
    spacing_time = solid.dx / wave_speed(solid)
    if solid.courant != "auto":
        return solid.courant * spacing_time
    if solid.model == "ctvf":
        return UPDATED_COURANT[solid.gradient] * spacing_time
    return lattice_step(expected_limit(clamps, solid.poisson_ratio) * spacing_time, viscous_time(solid))


def _bent(scene: Scene, body: Body, water: Water | None) -> float:
    """How far [m] along a body what pushes it bends it: where water at rest alone does as far as that can reach; where
    anything else does, of a swing and of a frame, no less than all of it."""
    swings = scene.goal is not None and scene.goal.statistic in ("period", "wave-period")
    loaded = any(load.body == body.name for load in scene.solid.loads)
    if water is None or not water.rests or not any(scene.gravity) or swings or loaded or limbs(body) is not None:
        return math.inf
    return float(np.ptp(corners_of(scene.fluid.bodies) @ axes_of(body.rotate)[lengthwise(body)[0]]))


def levels_before(scene: Scene, body: Body) -> list[float]:
    """Of each of the body's long faces with water before half of them or more at t = 0, how far that water reaches
    against gravity [m]."""
    up = upward(scene)
    return [max(float((outline(one) @ up).max()) for one in waters) for _, waters in waters_before(scene, body)]


def waters_before(scene: Scene, body: Body, least: float = _WET) -> list[tuple[np.ndarray, list[FluidBody]]]:
    """The outward normal (2,) of each of the body's long faces with water before a share of it, `least`, and more at
    t = 0, and that water."""
    dx = scene.fluid.dx
    middle, outward = edge_samples([body], dx)
    normal = normal_of(body)
    found = []
    for sense in (-1.0, 1.0):
        points = (middle + dx * outward)[outward @ normal * sense > UPWARD]
        inside = [contains(water, points) for water in scene.fluid.bodies]
        before = np.any(inside, axis=0)
        if before.any() and before.mean() >= least:
            waters = [water for water, one in zip(scene.fluid.bodies, inside, strict=True) if one.any()]
            found.append((sense * normal, waters))
    return found


def counts_of_water(scene: Scene, plate: Plate, water: Water) -> float:
    """How many times the push of water at rest on one side of a level plate counts in what its weight and loads leave
    of it; 1 of other plates."""
    body = plates_body(scene, plate)
    normal, up, before = normal_of(body), upward(scene), waters_before(scene, body)
    if not water.rests or len(before) != 1 or abs(float(normal @ up)) < LEVEL_PLATE:
        return 1.0
    outward, waters = before[0]
    face = float((outline(body) @ up).mean()) + 0.5 * plate.thickness * float(outward @ up)
    depth = max(float((outline(one) @ up).max()) for one in waters) - face
    push = -water.density * math.hypot(*scene.gravity) * depth * float(outward @ normal)
    left = abs(own_load(scene, body, normal)[0] + push)
    return max(1.0, abs(push) / left) if left > 0.0 else math.inf


def _load(
    scene: Scene, body: Body, normal: np.ndarray, water: Water | None, levels: list[float]
) -> tuple[float, float]:
    """Uniform load [Pa] on the plate along its normal, by loads, weight and water, of which between two waters the
    difference of their levels counts, and the force [N/m] on its end faces; an estimate."""
    load, tip = own_load(scene, body, normal)
    if water is None:
        return load, tip
    g = math.hypot(*scene.gravity)
    if len(levels) == 2:
        pressure = water.density * g * abs(levels[0] - levels[1])
    else:
        pressure = water.density * (g * water.height if water.rests else water.speed**2)
    return abs(load) + pressure, abs(tip)


def own_load(scene: Scene, body: Body, normal: np.ndarray) -> tuple[float, float]:
    """The same of weight and loads alone, with their signs."""
    solid, axis, thickness = scene.solid, lengthwise(body)[0], slender(scene, body)[0]
    load = float(np.dot(scene.gravity, normal)) * solid.density * thickness if solid.gravity else 0.0
    tip = 0.0
    for one in solid.loads:
        if one.body == body.name:
            along = float(np.dot(one.traction or one.acceleration, normal)) * largest_factor(one)
            if one.face in FACES_OF_AXIS[axis]:
                tip += along * thickness
            else:
                load += along if one.traction else along * solid.density * thickness
    return load, tip
