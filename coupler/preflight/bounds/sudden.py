"""What a load that is switched on at once, or a start at a speed, adds to the error of a goal, relative.

A body that is pushed along its length, or flies along it into its clamp, swings in fronts, whose kinks are worn round
over a length σ: 0.4 σ/L of the peak of a displacement, twice that of an energy's, half of it of its time, or all where
it flies. σ = √(α h L/4) by the particles' viscosity over the way to the far end and back, 2.5 spacings or steps c Δt at
the least (a bar 40 and 80 particles long). Behind a front that jumps, stresses and reactions overshoot by as much as
26 %. What bends shows its fast modes in its reactions: 3 % of a peak, 1.5 % of a beam's, and 1 % +
0.3 t/L of stresses (cantilevers and clamped plates under a sudden pressure: 3 % of one ten times, 3.8 of one five times
as long as thick); and reactions and stresses cross the middle of their extremes, and peak, as often as their fast modes
do. A force at the tip that comes at once bears them so strongly that peaks of reactions have no bound
(13 % off at 6 across), and 0.3 % of those of displacements; nor do stresses and energies where a body starts at a speed
(17 and 10 %, of a beam 6 and 10 %; in a thin cantilever's mode, of reactions 37 and stresses 7 %), whose displacements
feel 2.5 %. They move the time of a peak too: it feels 0.7 of what errs between two clamps, 1.7 of a start at a speed.
Where peaks are as high as one another, or a load grows by half a period or more, the time of the largest may be that of
any.

A ramp over r that ends before the mean begins starts a swing of 1/((ω r/π)² − 1) of that of a load at once, at most.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from coupler.preflight.measures.held import FACES_OF_AXIS, largest_factor, lengthwise
from coupler.preflight.measures.numbers import Numbers
from coupler.preflight.measures.plate import Plate, goals_quantity, of_a_body, plates_body
from coupler.preflight.measures.swing import swing
from shared.geometry.regions import axes_of
from shared.scene.sides import probe_rows
from shared.schema.probes import REACTIONS, STRESSES
from shared.schema.scene import Scene
from shared.schema.solid import RIGID_MODELS, Load

PEAKS = ("min", "max")
ROUNDED, LEAST_SMEARED = 0.4, 2.5
OF_REACTION, OF_BEAMS_REACTION, OF_STRESS = 0.03, 0.015, (0.01, 0.3)
OF_ENERGY = 2.0
OF_SPEED, OF_TIP = 0.025, 0.003
OVERSHOT = 0.26  # of what a front bears
PEAKS_TIME, STARTED_PEAKS_TIME = {1: 0.5, 2: 0.7}, 1.7  # by clamped ends
PERIODS_FEEL = {2: 0.6}  # by clamped ends: found 0.57 to 0.585 of a beam between clamps that leave it its width
RIVAL = 0.9  # of a swing, left after a period, above which what is 5 % off may be another peak's
SECOND_OF = {"speed": 0.09, "tip": 0.03, "pressure": 0.015}
QUICK = 0.05  # of a period: what grows by half of its load in less comes at once


def fast(scene: Scene, plate: Plate) -> str:
    """Why the goal is a matter of fast modes, of which nothing is known; empty where it is not."""
    what, quantity = scene.goal.statistic, goals_quantity(scene)
    if not _peak_at_once(scene, plate, (*PEAKS, "t_min", "t_max", "period")):
        return ""
    speed, tip = at_speed(scene, plate), _at_the_tip(scene, plate)
    loud = quantity in (*REACTIONS, *STRESSES)
    heard = loud and (what not in PEAKS or plate.along or speed or (tip and quantity in REACTIONS))
    if not heard and not (quantity == "strain-energy" and _flies(scene, plate) and not plate.along):
        return ""
    front = "a front that jumps" if plate.along else "fast modes, which what comes at once starts,"
    return f"{front} decides the {what} of a {quantity}; give the load a ramp, or judge a displacement"


def rivals(scene: Scene, n: Numbers) -> bool:
    """Whether the goal is the time of a peak, and others are as high until the end, or a plateau is."""
    plate, fluid = n.plate, scene.fluid
    loads, clamps = _loads(scene, plate), [one for one in scene.solid.clamps if one.body == plate.name]
    driven = any(load.table is not None for load in loads) or any(clamp.motion is not None for clamp in clamps)
    held, first = plate.clamps > 0 or plate.model == "spring", swing(scene, n)
    flows = fluid is not None and not n.water.rests
    if scene.goal.statistic == "t_min" and held and goals_quantity(scene) in ("von-mises", "strain-energy"):
        return True  # nothing, again and again
    if scene.goal.statistic not in ("t_min", "t_max") or driven or not held or first is None or flows:
        return False
    period = 2.0 * math.pi / first.omega
    if any(load.ramp > 0.5 * period for load in loads):
        return True
    second = 1.25 if at_speed(scene, plate) else 1.5  # of its periods
    return scene.end_time > second * period and first.left(period) > RIVAL


def at_speed(scene: Scene, plate: Plate) -> bool:
    """Whether a body that clamps hold starts at a speed, as a whole or in a mode."""
    body = plates_body(scene, plate)
    return _flies(scene, plate) or (body.velocity_mode is not None and _held(scene, plate))


def rings_along(scene: Scene, plate: Plate) -> bool:
    """Whether a force that comes at once presses a plate along its length while another bends it."""
    body = plates_body(scene, plate)
    way, ends = axes_of(body.rotate)[lengthwise(body)[0]], FACES_OF_AXIS[lengthwise(body)[0]]
    at_ends = (one for one in _loads(scene, plate) if one.face in ends and _at_once(one, plate))
    return not plate.along and any(abs(float(np.dot(one.traction, way))) > 0.0 for one in at_ends)


def fast_share(scene: Scene, plate: Plate) -> float:
    """Displacement of the second mode over that of the first, of what starts a swing at once; 1 of what is all fast
    modes'."""
    if plate.model in RIGID_MODELS:
        return 0.0
    quantity, speed, tip = goals_quantity(scene), at_speed(scene, plate), _at_the_tip(scene, plate)
    started_fast = quantity in STRESSES and (plate.along or speed or tip)
    if quantity in REACTIONS or started_fast or (quantity == "strain-energy" and _flies(scene, plate)):
        return 1.0
    if plate.along:
        return 0.0
    return SECOND_OF["speed"] if _flies(scene, plate) else SECOND_OF["tip"] if tip else SECOND_OF["pressure"]


def times_feel(scene: Scene, plate: Plate) -> float:
    """Share of an error of a stiffness that a time feels: half, but of a peak of what comes at once, and between two
    clamps."""
    if scene.goal.statistic in ("period", "wave-period") and not plate.along:
        return PERIODS_FEEL.get(plate.clamps, 0.5)
    if plate.along or not _peak_at_once(scene, plate, ("t_min", "t_max")):
        return 0.5
    return STARTED_PEAKS_TIME if _flies(scene, plate) else PEAKS_TIME.get(plate.clamps, 0.5)


def started(scene: Scene, plate: Plate, omega: float, until: float) -> float:
    """Share of its swing at `omega` [rad/s] that what moves a plate has started `until` [s], of that of loads that
    come at once."""
    body, loads = plates_body(scene, plate), _loads(scene, plate)
    moved = any(body.velocity) or body.spin or body.velocity_mode is not None or any(body.prestrain)
    carried = any(clamp.motion is not None for clamp in scene.solid.clamps if clamp.body == plate.name)
    grow = all(load.table is None and 0.0 < load.ramp <= until for load in loads)
    weighs = scene.solid.gravity and any(scene.gravity)
    if scene.fluid is not None or moved or carried or weighs or not loads or not grow:
        return 1.0
    slow = (omega * min(load.ramp for load in loads) / math.pi) ** 2
    return 1.0 / max(slow - 1.0, 1.0)


def sudden_error(scene: Scene, plate: Plate) -> float:
    """Of a peak, and of the period of a start at a speed; 0 of other statistics, and of loads that grow."""
    what = scene.goal.statistic
    if what == "period" and _flies(scene, plate) and not plate.along and plate.model not in RIGID_MODELS:
        return SECOND_OF["speed"] / (2.0 * math.pi * scene.end_time * plate.frequency)
    if not _peak_at_once(scene, plate, (*PEAKS, "t_min", "t_max") if plate.along else PEAKS):
        return 0.0
    if not plate.along:
        if not of_a_body(scene):
            return 0.0
        reaction = OF_BEAMS_REACTION if plate.model == "beam" else OF_REACTION
        of_way = OF_SPEED if _flies(scene, plate) else OF_TIP if _at_the_tip(scene, plate) else 0.0
        reaction += OVERSHOT * _share_along(scene, plate)
        stress = OF_STRESS[0] + OF_STRESS[1] * plate.thickness / plate.length
        heard = {**dict.fromkeys(REACTIONS, reaction), **dict.fromkeys(STRESSES, stress)}
        return heard.get(goals_quantity(scene), of_way)
    if not plate.clamps:
        return 0.0
    solid, crossed = scene.solid, plate.length * plate.frequency * (4.0 if plate.clamps == 1 else 2.0)
    if plate.model == "beam":
        step = min(plate.step, scene.end_time / probe_rows(scene))
        smeared = LEAST_SMEARED * max(solid.dx, crossed * step)
    else:
        worn = math.sqrt(0.25 * solid.alpha * solid.h_over_dx * solid.dx * plate.length)
        smeared = max(worn, LEAST_SMEARED * solid.dx)
    much = min(ROUNDED * smeared / plate.length, 1.0)
    if what not in PEAKS:
        return much * (1.0 if _flies(scene, plate) else 0.5)
    return much * (OF_ENERGY if goals_quantity(scene) == "strain-energy" else 1.0)


def _share_along(scene: Scene, plate: Plate) -> float:
    """Of a reaction what its body's weight and loads push along its length, at most 1."""
    body, solid, axis = plates_body(scene, plate), scene.solid, {"reaction-x": 0, "reaction-y": 1}
    if goals_quantity(scene) not in axis:
        return 0.0
    ends, mass = FACES_OF_AXIS[lengthwise(body)[0]], plate.density * plate.thickness * plate.length
    push = float(solid.gravity) * mass * np.asarray(scene.gravity)
    for load in _loads(scene, plate):
        much = mass if load.acceleration else plate.thickness if load.face in ends else plate.length
        push = push + much * largest_factor(load) * np.asarray(load.acceleration or load.traction)
    way, component = axes_of(body.rotate)[lengthwise(body)[0]], axis[goals_quantity(scene)]
    along = abs(float(push @ way) * float(way[component]))
    return min(along / abs(push[component]), 1.0) if push[component] else 0.0


def _loads(scene: Scene, plate: Plate) -> list[Load]:
    return [load for load in scene.solid.loads if load.body == plate.name]


def _held(scene: Scene, plate: Plate) -> bool:
    return any(clamp.body == plate.name for clamp in scene.solid.clamps)


def _flies(scene: Scene, plate: Plate) -> bool:
    """Whether a body that clamps hold starts at a speed."""
    body = plates_body(scene, plate)
    return _held(scene, plate) and (any(body.velocity) or body.spin != 0.0)


def _at_the_tip(scene: Scene, plate: Plate) -> bool:
    """Whether a force on an end of a plate that bends comes at once."""
    ends = FACES_OF_AXIS[lengthwise(plates_body(scene, plate))[0]]
    return not plate.along and any(one.face in ends and _at_once(one, plate) for one in _loads(scene, plate))


def _at_once(load: Load, plate: Plate) -> bool:
    quick = QUICK / plate.frequency
    if load.table is None:
        return load.ramp < quick
    times, factors = np.array(load.table.times), np.array(load.table.factors)
    grown = np.abs(np.interp(times + quick, times, factors) - factors).max()
    return factors[0] != 0.0 or grown > 0.5 * np.abs(factors).max()


def _peak_at_once(scene: Scene, plate: Plate, peaks: Sequence[str]) -> bool:
    if plate.model in RIGID_MODELS or scene.goal.statistic not in peaks:
        return False
    at_once = any(_at_once(load, plate) for load in _loads(scene, plate)) or at_speed(scene, plate)
    return at_once or (scene.solid.gravity and any(scene.gravity))
