"""Bounds of the error that a choice of models and resolution makes in the scene's goal, relative, and what they add.

Each part is measured on cases with a known answer (cases/results and README.md), with a margin of 1.2 to 2.5 over the
worst found; dx spacing of the fluid. The structure's part, and what its swing adds: preflight_error_solid.py.

    still              0.1 %
                       (neither this nor a column bears a body that floats, this none without weight)
    column             0.1 % of a mean or under a rigid body; 30 % of the swing of a plate that bends, whose water flows
                       sideways too (share of the first mode, coupler/preflight_numbers.py)
    water at rest      dx/H (ctvf), 3 dx/H (wcsph), a tenth with h = 2 dx  still_tank, soft_plate, hydrostatic_plate
                       times buoyancy over what it leaves of the weight of a plate under water
    a body afloat      a waterline within 0.4 dx of the body's thickness besides                  floating rafts
    a body that swings in water of particles 1.5 dx/d (wcsph), 0.5 dx/d (ctvf), d its thickness if that is less
    flow               where water falls and splashes 5 dx/d, d its least extent at t = 0, of its front 1.4 dx/d; 0.5
                       dx/d (ctvf), 1.5 dx/d (wcsph) where it is held and circulates     dam_break_plate, taylor_green,
                       a flap in a splash, by spacings from 3.3 to 0.6 mm: 3.2 to 4.4, scattered by 1
    wave's period      0.25 % and what was found: 7.33 x^1.7 (ctvf), 17.2 x^1.9 (wcsph) too long, x = dx/wavelength, and
                       0.8 % too short at any x, for a lattice under pressure bears shear: the two cancel near x = 0.02;
                       8 % more with less than 40 neighbours, whose lattice bears more            standing_wave
    waves' heights     as flow that is held, and with less than 40 neighbours 20 % more, for such a lattice bears waves
                       of its spacing's height; at any dx                                          a wavemaker
"""

from __future__ import annotations

import math

from coupler.preflight_error_solid import PHASE, SWING, UNKNOWN, of_structure, swing_at_the_end, swing_in_a_mean
from coupler.preflight_finding import PARTICLE_FLUIDS, STEADY
from coupler.preflight_numbers import Numbers
from coupler.preflight_plate import Plate
from coupler.preflight_rules_joint import HELMHOLTZ_REFUSE
from coupler.preflight_rules_water import LOOSE
from shared.schema import Scene
from shared.schema_solid import RIGID_MODELS

Parts = dict[str, float]

STILL = 1e-3
COLUMN = 0.3
REST = {"ctvf": 1.0, "wcsph": 3.0}
CROWD, CROWDED = 2.0, 0.1  # from this h/dx on a lattice of particles bears hardly any shear, and rest is as much better
SMOOTH = {"ctvf": 0.5, "wcsph": 1.5}
WAVE = {"ctvf": (7.33, 1.7), "wcsph": (17.2, 1.9)}
WAVE_LATTICE, WAVE_MARGIN = 0.008, (1.2, 0.0025)
LATTICE, WAVES = 0.08, 0.2  # of a period and of a height, where a lattice bears waves
AFLOAT, WATERLINE = 0.03, 0.4  # weight of the water that a body's motion moves, over its springs' force
FLOW, FRONT = 5.0, 1.4


def error_parts(scene: Scene, n: Numbers) -> Parts:
    """The bounds by source; their sum bounds the error of the goal. Empty without a goal."""
    if scene.goal is None:
        return {}
    parts = {}
    if n.plate is not None:
        parts[scene.solid.model] = of_structure(scene, n)
    if n.water is not None:
        parts[f"fluid {scene.fluid.model}"] = _fluid(scene, n)
    swings = {SWING: swing_in_a_mean(scene, n), PHASE: swing_at_the_end(scene, n, sum(parts.values()))}
    return parts | {name: part for name, part in swings.items() if part > 0.0}


def error_bound(scene: Scene, n: Numbers) -> float | None:
    """Bound of the goal's relative error; None without a goal, infinite where the choice cannot do it."""
    parts = error_parts(scene, n)
    return sum(parts.values()) if parts else None


def _fluid(scene: Scene, n: Numbers) -> float:
    water, steady = n.water, scene.goal.statistic in STEADY
    closed = water.boxed and n.joint is not None and n.joint.closes
    floats = n.plate is not None and afloat(scene, n.plate)
    if water.model == "still":
        weighs = any(scene.gravity)
        return STILL if water.rests and steady and weighs and not closed and not floats else UNKNOWN
    if water.model not in PARTICLE_FLUIDS:
        bends = n.plate is not None and n.plate.model not in RIGID_MODELS
        if not water.rests or floats or (closed and scene.fluid.column.far_end == "open"):
            return UNKNOWN
        return STILL if steady or not bends else COLUMN
    if water.rests:
        if not steady and _radiates(n):
            return UNKNOWN
        if not steady and n.plate is not None and n.plate.model == "spring":
            return SMOOTH[water.model] * water.dx / min(water.width, n.plate.thickness)
        crowded = CROWDED if scene.fluid.h_over_dx >= CROWD else 1.0
        waterline = WATERLINE * water.dx / n.plate.thickness if floats else 0.0
        return REST[water.model] * water.dx / water.height * crowded * _left_of_weight(scene, n) + waterline
    if scene.goal.statistic == "wave-period":
        return _period(water.model, water.dx / _wavelength(scene, n)) + (LATTICE if _stiff(n) else 0.0)
    front = any(probe.name == scene.goal.probe and probe.quantity == "front-x" for probe in scene.probes)
    flow = (SMOOTH[water.model] if water.held else FRONT if front else FLOW) * water.dx / water.width
    return flow + (WAVES if water.waves and not steady and _stiff(n) else 0.0)


def _left_of_weight(scene: Scene, n: Numbers) -> float:
    """Buoyancy over what it leaves of the weight of a plate under water: so many times its error counts in bending."""
    probe = next((one for one in scene.probes if one.name == scene.goal.probe), None)
    if n.plate is None or n.plate.wet < 2 or not scene.solid.gravity or scene.solid.loads:
        return 1.0
    if probe is not None and probe.quantity in ("force-x", "force-y"):
        return 1.0
    left = abs(n.plate.density - n.water.density)
    return max(1.0, n.water.density / left) if left > 0.0 else UNKNOWN


def afloat(scene: Scene, plate: Plate) -> bool:
    """Whether a body rises and sinks with the water's level: its springs along gravity do not hold it."""
    g = math.hypot(*scene.gravity)
    if plate.model != "spring" or g == 0.0:
        return False
    along = sum(k * (part / g) ** 2 for k, part in zip(scene.solid.spring.stiffness, scene.gravity, strict=False))
    return along * AFLOAT < scene.fluid.density * g * plate.length


def _period(model: str, x: float) -> float:
    """Of a wave with `x` = dx/wavelength."""
    factor, power = WAVE[model]
    times, more = WAVE_MARGIN
    return times * abs(factor * x**power - WAVE_LATTICE) + more


def _wavelength(scene: Scene, n: Numbers) -> float:
    """The shortest wave's length [m] that the water starts with; without one its least extent."""
    fields = (body.velocity_field for body in scene.fluid.bodies)
    return min((field.wavelength for field in fields if field is not None), default=n.water.width)


def _stiff(n: Numbers) -> bool:
    return n.water.support < LOOSE * n.water.dx


def _radiates(n: Numbers) -> bool:
    """Whether sound crosses the water too slowly for the plate to feel its mass."""
    if n.joint is None or n.joint.wet_frequency is None:
        return False
    return 2.0 * math.pi * n.joint.wet_frequency * n.joint.depth / n.water.sound_speed > HELMHOLTZ_REFUSE
