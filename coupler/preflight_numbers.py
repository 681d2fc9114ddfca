"""The numbers that describe a scene before anything is computed, from the scene alone.

Symbols: ρ density, c0 the fluid's sound speed, H the water's depth before the plate, t the plate's thickness, L its
length, D = E t³/(12 (1 − ν²)) its bending stiffness (plane strain), f its first dry frequency, Δt a time step. The
*plate* is the thinnest body of the solid; other shapes are measured by their bounding boxes in their own frames.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupler.preflight_plate import Plate, measure_plate
from coupler.preflight_shapes import outline, own_box
from coupler.preflight_water import Water, measure_water
from shared.regions import axes_of
from shared.schema import Scene

MODE_SHARE = {1: 0.613, 2: 0.690}  # (∫φ)²/(L ∫φ²) of the first mode: share of a column's mass that moves with it
_SPANS = 0.9  # of the water's width: a plate this long moves the whole column


@dataclass(frozen=True)
class Joint:
    """What water and plate are to each other: r = ρ_f H/(ρ_s t), `depth` H [m] of the water along the plate's normal,
    `wet_frequency` [1/s] with the mass of incompressible water, `closes`: the plate spans the water's whole width."""

    mass_ratio: float
    depth: float
    wet_frequency: float | None
    closes: bool


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
    body = next(one for one in scene.solid.bodies if one.name == plate.name)
    extent = np.subtract(*own_box(body)[::-1])
    axis = int(extent[1] > extent[0])
    along, normal = axes_of(body.rotate)[axis], axes_of(body.rotate)[1 - axis]
    corners = np.concatenate([outline(one).reshape(-1, 2) for one in scene.fluid.bodies])
    depth = float(np.ptp(corners @ normal))
    closes = plate.wet == 1 and plate.length >= _SPANS * float(np.ptp(corners @ along))
    wet_frequency = None
    if plate.frequency is not None and plate.clamps:  # a free body moves as a whole first
        # Incompressible water: a plate that closes its column moves all of it, another a layer of L/π on a side.
        layer = depth * MODE_SHARE.get(plate.clamps, 1.0) if closes else min(depth, plate.length / math.pi)
        added = water.density * layer * max(plate.wet, 1)
        wet_frequency = plate.frequency / math.sqrt(1.0 + added / (plate.density * plate.thickness))
    return Joint(water.density * depth / (plate.density * plate.thickness), depth, wet_frequency, closes)
