"""The numbers that describe a scene before anything is computed, from the scene alone.

Symbols: ρ density, c0 the fluid's sound speed, H the water's depth before the plate, t the plate's thickness, L its
length, D = E t³/(12 (1 − ν²)) its bending stiffness (plane strain), f its first dry frequency, Δt a time step. The
*plate* is the body that the goal asks about, or else the thinnest; other shapes are measured by their bounding boxes in
their own frames. Where the worst body decides (mass ratio, windows, supports, particles across), t is of the thinnest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight.measures.afloat import carries
from coupler.preflight.measures.held import lengthwise, normal_of
from coupler.preflight.measures.plate import Plate, levels_before, measure_plate, plates_body, waters_before
from coupler.preflight.measures.shapes import area
from coupler.preflight.measures.upright import Side, moving_layer, parted, upright
from coupler.preflight.measures.water import Water, measure_water
from shared.geometry.regions import axes_of, corners_of
from shared.schema.geometry import Body
from shared.schema.scene import Scene

MODE_SHARE = {1: 0.613, 2: 0.690}  # (∫φ)²/(L ∫φ²) of the first mode: share of a column's mass that moves with it
ROUND = 1.5
"""Added mass of a rectangle in wide water over that of the disc across it: 1 of a strip, 1.36 twice as wide as thick,
1.51 of a square (Newman, Marine Hydrodynamics); half at a surface."""
_SPANS = 0.9  # of the water's width: a plate this long moves the whole column


@dataclass(frozen=True)
class Joint:
    """What water and plate are to each other: r = ρ_f H/(ρ_s t), `depth` H [m] of the water along the plate's normal,
    up to the surface beside an upright one, `reach` [m]: how far into it a swing is felt, `moved`: mass that swings
    over the plate's own, `wet_frequency` [1/s] with the mass of incompressible water or, of a sprung body, of its
    column, `closes`: a body spans the water's whole width, `parts`: the waters that an upright plate parts."""

    mass_ratio: float
    depth: float
    reach: float
    moved: float
    wet_frequency: float | None
    closes: bool
    parts: list[Side]


@dataclass(frozen=True)
class Numbers:
    """All numbers of a scene; a side that is absent is None."""

    water: Water | None
    plate: Plate | None
    joint: Joint | None


def scene_numbers(scene: Scene) -> Numbers:
    """The numbers of a checked scene."""
    water = measure_water(scene) if scene.fluid is not None else None
    plate = measure_plate(scene, water) if scene.solid is not None else None
    joint = _joint(scene, water, plate) if water and plate else None
    return Numbers(water, plate, joint)


def _joint(scene: Scene, water: Water, plate: Plate) -> Joint:
    body = plates_body(scene, plate)
    normal = normal_of(body)
    corners = corners_of(scene.fluid.bodies)
    depth = float(np.ptp(corners @ normal))
    sides = parted(scene, body, water)
    if upright(scene, body, water):
        depth = min(depth, water.height)
    closing = [one.name for one in scene.solid.bodies if _closes(scene, one, corners)]
    own, columns = plate.name in closing, water.model == "column" and bool(plate.clamps)
    reach = depth if own or columns or not plate.clamps else min(depth, plate.length / math.pi)
    moved, wet_frequency = 1.0, None
    if plate.frequency is not None and columns:  # each moves with its foot
        moved += water.density * _columns(scene, body) / (plate.density * plate.thickness)
        wet_frequency = plate.frequency / math.sqrt(moved)
    elif plate.frequency is not None and sides and (plate.clamps or plate.model == "spring"):
        depth = max(side.height for side in sides)
        reach = 2.0 * depth / math.pi
        moved += water.density * moving_layer(scene, plate, sides) / (plate.density * plate.thickness)
        wet_frequency = plate.frequency / math.sqrt(moved)
    elif plate.frequency is not None and plate.clamps:  # a free body moves as a whole first
        # Incompressible water: a plate that closes its column moves all of it, another a layer of L/π on a side.
        layer = reach * MODE_SHARE.get(plate.clamps, 1.0) if own else reach
        added = water.density * layer * max(plate.wet, 1)
        moved += added / (plate.density * plate.thickness)
        wet_frequency = plate.frequency / math.sqrt(moved)
    elif plate.frequency is not None and plate.model == "spring" and plate.wet:
        if carries(scene, body) and water.model != "column":
            moved += water.density * sum(area(one) for one in scene.fluid.bodies) / (plate.density * area(body))
            wet_frequency = plate.frequency / math.sqrt(moved)
        elif _in_column(water, plate, closing):
            moved, stiffer = _sprung_in_column(scene, water, plate, depth)
            wet_frequency = plate.frequency * math.sqrt(stiffer / moved)
        else:  # water flows round it
            disc = 0.25 * math.pi * plate.length**2 * min(0.5 * plate.wet, 1.0)
            moved += ROUND * water.density * disc / (plate.density * plate.thickness * plate.length)
    ratio = water.density * depth / (plate.density * plate.thinnest)
    return Joint(ratio, depth, reach, moved, wet_frequency, bool(closing), sides)


def _columns(scene: Scene, body: Body) -> float:
    """Length [m] of the columns on both sides of a body together."""
    before = waters_before(scene, body, 0.0)
    return sum(max(float(np.ptp(corners_of([one]) @ normal)) for one in waters) for normal, waters in before)


def _in_column(water: Water, plate: Plate, closing: list[str]) -> bool:
    """Whether water moves with a sprung body as one column."""
    return water.model == "column" or (plate.name in closing and not water.boxed)


def _sprung_in_column(scene: Scene, water: Water, plate: Plate, depth: float) -> tuple[float, float]:
    """How many times a sprung body's mass and stiffness columns make of them: all their mass with an open end, a third
    of it and their own stiffness ρ c²/H with a closed one."""
    mass, column = plate.density * plate.thickness, plate.wet * water.density * depth
    if scene.fluid.column.far_end == "open":
        return 1.0 + column / mass, 1.0
    stiffer = column * (water.sound_speed / depth) ** 2 / (mass * (2.0 * math.pi * plate.frequency) ** 2)
    return 1.0 + column / (3.0 * mass), 1.0 + stiffer


def _closes(scene: Scene, body: Body, corners: np.ndarray) -> bool:
    """Whether a body with water on one side spans all of it."""
    axis, _, length = lengthwise(body)
    spans = length >= _SPANS * float(np.ptp(corners @ axes_of(body.rotate)[axis]))
    return spans and len(levels_before(scene, body)) == 1
